//! Names of scenes: files of any name, and standard input.

use crate::{Place, Run};
use std::{
    io::Write,
    process::{Output, Stdio},
};
use steradian::image::Image;

const PBRT: &str = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nCamera \"perspective\" \"float fov\" 60\nWorldBegin\n\
                    LightSource \"infinite\"\nInclude \"ball.txt\"\n";
const BALL: &str = "Translate 0 0 3\nShape \"sphere\"\n";
const XML: &str =
    "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/><shape type='sphere'/></scene>";
const OBJ: &str = "# a triangle\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn piped(place: &Place, arguments: &[&str], input: &[u8]) -> Run {
    let mut command = place.command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: status.code().unwrap_or(-1), stdout: text(stdout), stderr: text(stderr) }
}

/// Standard input is read as what it looks like or is said to be; what it names is looked for in the current folder.
#[test]
fn scenes_come_from_standard_input() {
    let place = Place::new();
    place.file("ball.txt", BALL).file("s.pbrt", PBRT);
    let quick = ["--size", "8x8", "--spp", "2", "--json"];
    for (name, text) in [("pbrt", PBRT), ("xml", XML), ("obj", OBJ)] {
        let out = format!("{name}.exr");
        for format in [&[][..], &["--format", name]] {
            let run = piped(&place, &[&["render", "-", "-o", &out][..], &quick, format].concat(), text.as_bytes());
            assert_eq!(run.code, 0, "{name} {format:?}: {}", run.stderr);
            assert_eq!(run.json()["scene"], "standard input");
        }
    }
    // The same picture as from a file, and default names.
    place.succeed(&[&["render", "s.pbrt", "-o", "file.exr"][..], &quick].concat());
    let same = place.picture("file.exr").channel("G") == place.picture("pbrt.exr").channel("G");
    assert!(same);
    let run = piped(&place, &[&["render", "-"][..], &quick].concat(), PBRT.as_bytes());
    assert!(run.code == 0 && place.path("scene.exr").is_file() && place.path("scene.png").is_file(), "{}", run.stderr);
    let told = piped(&place, &["info", "-", "--json"], XML.as_bytes());
    assert_eq!(told.json()["format"], "mitsuba");

    let run = piped(&place, &["render", "-", "-o", "a.exr"], b"WorldBegin Shape \"spere\"");
    assert!(run.code == 2 && run.stderr.contains("standard input:1:"), "{}", run.stderr);
    let run = piped(&place, &["render", "-", "--format", "xml", "-o", "a.exr"], PBRT.as_bytes());
    assert!(run.code == 2 && run.stderr.contains("standard input"), "{}", run.stderr);
    assert_eq!(piped(&place, &["render", "-", "--format", "blend"], b"").code, 2);
}

/// File systems of Unix have names that are no UTF-8.
#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_utf8() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};
    let place = Place::new();
    place.file("ball.txt", BALL);
    let folder = place.0.path();
    std::fs::write(folder.join(OsStr::from_bytes(b"r\xe9union.pbrt")), PBRT).unwrap();
    let run = |command: &str, more: &[&str]| {
        let output = place.command(&[command]).arg(OsStr::from_bytes(b"r\xe9union.pbrt")).args(more).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run("info", &[]);
    run("render", &["--spp", "1", "--quiet"]);
    for name in [&b"r\xe9union.exr"[..], b"r\xe9union.png"] {
        assert!(folder.join(OsStr::from_bytes(name)).is_file());
    }
    run("render", &["--spp", "1", "--json", "-o", "a.exr"]);
}

/// Only the part that is rendered counts for memory.
#[test]
fn a_crop_of_a_vast_frame_renders() {
    let place = Place::new();
    let vast = ["render", "--spp", "1", "--json", "-o", "a.exr", "--size"];
    for (size, crop) in [("20000x20000", "9996,9996,10004,10004"), ("1000000x1000000", "600000,700000,600008,700008")] {
        let told = place.succeed(&[&vast[..], &[size, "--crop", crop]].concat()).json();
        assert_eq!((&told["width"], &told["height"]), (&8.into(), &8.into()));
        assert!(told["peak_rss_bytes"].as_u64().is_none_or(|bytes| bytes < 500 << 20), "{told}");
        assert!(place.picture("a.exr").channel("G").unwrap().iter().any(|v| *v > 0.0), "{size}");
    }
    place.refuse(2, &[&vast[..], &["20000x20000"]].concat(), &["20000 x 20000", "crop"]);
    place.refuse(2, &[&vast[..], &["20000x20000", "--crop", "0,0,19999,19999"]].concat(), &["19999 x 19999"]);
}

/// Slips on the command line are answered with what is right, in words of this program.
#[test]
fn slips_are_answered_plainly() {
    let place = Place::new();
    place.file("ball.pbrt", "WorldBegin\nShape \"sphere\"\n");
    for (arguments, about) in [
        (&["--spp", "-4"][..], &["a number of samples is a whole number from 1 to"][..]),
        (&["--spp", "many"], &["a number of samples"]),
        (&["--tonemap", "filmic"], &["unknown tone curve `filmic` (known: none, "]),
        (&["-o", "out.pnh"], &["did you mean 'png'?", ".exr"]),
        (&["--integrator", "path:maxdepth=3"], &["did you mean 'max_depth'?"]),
        (&["--integrator", "raycast:reuse=4"], &["'reuse=4' of integrator 'raycast'"]),
    ] {
        place.refuse(2, &[&["render", "ball.pbrt"][..], arguments].concat(), about);
    }
    let small = ["render", "ball.pbrt", "--size", "4x4", "-o", "a.exr"];
    let run = place.succeed(&[&small[..], &["--spp", "1k", "--tonemap", "agx", "--json"]].concat());
    assert!(run.stderr.contains("--tonemap and --exposure have no effect"), "{}", run.stderr);
    assert_eq!(run.json()["spp"].as_f64(), Some(1000.0));
    place.refuse(2, &["material", "none.xml:gold", "--albedo"], &["none.xml"]);
}

/// A mistyped parameter is told, and refused with `--strict`.
#[test]
fn strict_refuses_what_is_not_used() {
    let place = Place::new();
    place.file("slip.pbrt", "Camera \"perspective\" \"float fovv\" 40\nWorldBegin\nShape \"sphere\"\n");
    place.file(
        "slip.xml",
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"fovv\" value=\"40\"/></sensor>\
        <shape type=\"sphere\"/></scene>",
    );
    place.file("ball.pbrt", "WorldBegin\nShape \"sphere\"\n");
    for (scene, more, about) in [
        ("slip.pbrt", "-q", "did you mean 'fov'?"),
        ("slip.xml", "-q", "fovv"),
        ("ball.pbrt", "-Dsp=4", "'sp' has no effect"),
    ] {
        let small = ["render", scene, "--size", "4x4", "--spp", "1", "-o", "a.exr", more];
        place.succeed(&small);
        place.refuse(2, &[&small[..], &["--strict"]].concat(), &[about, "unused, which --strict refuses"]);
    }
}

/// First attempts of a newcomer are answered with a command that works.
#[test]
fn first_steps_are_answered_with_an_example() {
    let place = Place::new();
    place.file("ball.pbrt", "WorldBegin\nShape \"sphere\"\n");
    for (arguments, about) in [
        (&["info"][..], &["example: steradian info builtin:cornell-box"][..]),
        (&["compare", "a.exr"], &["example: steradian compare A.exr B.exr"]),
        (&["ball.pbrt"], &["example: steradian render ball.pbrt"]),
        (&["render", "bal.pbrt"], &["cannot find the scene 'bal.pbrt'", "did you mean 'ball.pbrt'?"]),
        (&["info", "ball"], &["did you mean 'ball.pbrt'?"]),
        (&["render", "none.gltf"], &["builtin:cornell-box"]),
        (&["vision", "ball.pbrt"], &["is a file", "steradian vision cones ball.pbrt"]),
        (&["vision", "-p", "x=1"], &["of which experiment?", "steradian vision chromaticity"]),
        (&["vision", "night"], &["steradian vision night PICTURE.png -o night.png"]),
        (&["vision", "chroma"], &["did you mean 'chromaticity'?"]),
        (&["optics", "prism", "-p", "3"], &["NAME=VALUE, such as"]),
    ] {
        place.refuse(2, arguments, about);
    }
    assert!(place.succeed(&["geometry"]).stdout.contains("steradian geometry coordinates -o coordinates.svg"));
}

/// A picture is told by its size and what its channels hold; rendering one is answered with what reads pictures.
#[test]
fn pictures_are_told_too() {
    let place = Place::new();
    let rgb: Vec<[f32; 3]> = (0..6).map(|i| [i as f32, 0.5, if i == 0 { f32::NAN } else { 2.0 }]).collect();
    let image = Image::from_rgb(3, 2, &rgb).unwrap();
    steradian::image::write(&place.path("a.exr"), &image, &steradian::image::WriteOptions::default()).unwrap();
    let told = place.succeed(&["info", "a.exr", "--json"]).json();
    assert_eq!((&told["format"], &told["width"], &told["height"]), (&"EXR".into(), &3.into(), &2.into()));
    let channel = |name: &str| told["channels"].as_array().unwrap().iter().find(|c| c["name"] == name).unwrap().clone();
    let red = channel("R");
    assert_eq!(
        (red["least"].as_f64(), red["mean"].as_f64(), red["greatest"].as_f64()),
        (Some(0.0), Some(2.5), Some(5.0))
    );
    assert_eq!((channel("B")["not_finite"].as_u64(), channel("B")["least"].as_f64()), (Some(1), Some(2.0)));
    let text = place.succeed(&["info", "a.exr"]).stdout;
    assert!(text.starts_with("a.exr: EXR, 3 x 2 pixels") && text.contains("1 not finite"), "{text}");
    place.file("broken.png", "no picture");
    place.refuse(2, &["info", "broken.png"], &["broken.png"]);
    place.refuse(2, &["render", "a.exr"], &["is a picture", "steradian info"]);
    place.refuse(2, &["info", "none.png"], &["no picture 'none.png'"]);
}

//! Outputs: never over what is read, never lost, never late to fail.

use crate::{Place, Run};
use std::path::Path;
use steradian::image::{Image, WriteOptions, write};

/// A picture of 4 × 4 pixels.
fn paint(path: &Path) {
    let pixels: Vec<[f32; 3]> = (0..16).map(|i| [0.1 + i as f32 / 20.0, 0.5, 0.25]).collect();
    write(path, &Image::from_rgb(4, 4, &pixels).unwrap(), &WriteOptions::default()).unwrap();
}

const SPECTRUM: &str = "400 0.1\n500 0.5\n700 0.9\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                   property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

const SKY: &str = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nCamera \"perspective\"\nWorldBegin\n\
     LightSource \"infinite\" \"string filename\" \"sky.exr\"\nTexture \"w\" \"spectrum\" \"imagemap\" \"string filename\" \
     \"wall.png\"\nMaterial \"diffuse\" \"texture reflectance\" \"w\"\nShape \"plymesh\" \"string filename\" \"part.ply\"\n\
     Material \"diffuse\" \"spectrum reflectance\" \"red.spd\"\nInclude \"more.pbrt\"\n";

/// A model with a texture of its own name, a scene with a sky of its own name, and one of each kind of file that scenes
/// name.
fn place() -> Place {
    let place = Place::new();
    paint(&place.path("spot.png"));
    paint(&place.path("sky.exr"));
    paint(&place.path("wall.png"));
    place
        .file("spot.obj", "mtllib spot.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n")
        .file("spot.mtl", "newmtl m\nmap_Kd spot.png\n")
        .file("red.spd", SPECTRUM)
        .file("part.ply", PLY)
        .file("more.pbrt", "Shape \"sphere\"\n")
        .file("sky.pbrt", SKY)
        .file(
            "room.xml",
            "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/><shape type='ply'>\
             <string name='filename' value='part.ply'/><bsdf type='diffuse'><spectrum name='reflectance' filename='red.spd'/></bsdf>\
             </shape></scene>",
        );
    place
}

const QUICK: [&str; 5] = ["--spp", "1", "--size", "8x8", "--json"];

/// All files of the place.
fn contents(place: &Place) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = std::fs::read_dir(place.0.path())
        .unwrap()
        .map(|e| e.unwrap())
        .map(|e| (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap()))
        .collect();
    files.sort();
    files
}

#[test]
fn nothing_that_is_read_is_overwritten() {
    let place = place();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("wall.png", place.path("link.png")).unwrap();
        std::fs::hard_link(place.path("wall.png"), place.path("hard.png")).unwrap();
    }
    let before = contents(&place);
    let refused = |arguments: &[&str], file: &str| place.refuse(2, arguments, &[file, "overwritten"]);
    let render = |scene: &str, more: &[&str], file: &str| {
        refused(&[&["render", scene][..], &QUICK, more].concat(), file);
    };
    render("spot.obj", &["-o", "spot.png"], "spot.png");
    render("spot.obj", &["-o", "new.exr", "-o", "./spot.png"], "spot.png");
    render("sky.pbrt", &["-o", "sky.exr"], "sky.exr");
    render("sky.pbrt", &["-o", "wall.png"], "wall.png");
    render("sky.pbrt", &["-o", "new.png", "--resume", "red.spd"], "red.spd");
    render("sky.pbrt", &["-o", "new.png", "--resume", "part.ply"], "part.ply");
    render("sky.pbrt", &["-o", "new.png", "--resume", "more.pbrt"], "more.pbrt");
    render("sky.pbrt", &["-o", "new.png", "--resume", "sky.pbrt"], "sky.pbrt");
    for file in ["part.ply", "red.spd", "room.xml"] {
        render("room.xml", &["-o", "new.png", "--resume", file], file);
    }
    #[cfg(unix)]
    for name in ["link.png", "hard.png"] {
        render("sky.pbrt", &["-o", name], "wall.png");
    }
    let material = |more: &[&str], file: &str| refused(&[&["material"][..], more].concat(), file);
    material(&["diffuse", "-p", "reflectance=wall.png", "--picture", "wall.png"], "wall.png");
    material(&["diffuse", "-p", "reflectance=wall.png", "--plot", "wall.png"], "wall.png");
    material(&["diffuse", "-p", "reflectance=wall.png", "--table", "wall.png"], "wall.png");
    material(&["sky.pbrt:default", "--table", "red.spd"], "red.spd");
    refused(&["convert", "wall.png", "wall.png"], "wall.png");
    refused(&["signal", "wall.png", "-o", "wall.png"], "wall.png");
    assert_eq!(contents(&place), before);
}

/// Default names that are taken by what is read step aside, and the program says so.
#[test]
fn default_names_step_aside() {
    let place = place();
    let before = contents(&place);
    for (scene, read) in [("spot.obj", "spot.png"), ("sky.pbrt", "sky.exr")] {
        let Run { stdout, stderr, .. } = place.succeed(&[&["render", scene][..], &QUICK].concat());
        let stem = scene.split('.').next().unwrap();
        assert!(stderr.contains(read) && stderr.contains(&format!("{stem}.render.png")), "{stderr}");
        for extension in ["exr", "png"] {
            let name = format!("{stem}.render.{extension}");
            assert!(stdout.contains(&name) && place.picture(&name).width() == 8, "{stdout}");
        }
    }
    let after = contents(&place);
    assert!(before.iter().all(|file| after.contains(file)));
    assert_eq!(after.len(), before.len() + 4);
}

/// Obstacles to writing a picture are told before it is rendered: a render of hours would not end within this test.
#[test]
fn places_that_cannot_be_written_are_refused_beforehand() {
    let place = place();
    let endless = ["render", "--size", "64x64", "--spp", "10000000", "--quiet"];
    let refuse = |code: i32, more: &[&str], about: &[&str]| place.refuse(code, &[&endless[..], more].concat(), about);
    let long = "n".repeat(252) + ".exr";
    refuse(1, &["-o", &long], &["nnn"]);
    refuse(1, &["-o", "none/a.exr"], &["none/a.exr", "no folder"]);
    refuse(1, &["-o", "a.png", "--resume", &long], &["nnn"]);
    refuse(2, &["-o", "state.exr", "--resume", "./state.exr"], &["state.exr", "overwrite"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("loop.exr", place.path("loop.exr")).unwrap();
        refuse(1, &["-o", "loop.exr"], &["loop.exr"]);
        assert!(std::process::Command::new("mkfifo").arg(place.path("pipe")).status().unwrap().success());
        refuse(2, &["-o", "a.png", "--resume", "pipe"], &["pipe", "not a regular file"]);
    }
}

/// Commands that write files, each with an output that is read, and with two outputs that are one file.
const CLASHES: &[(&str, &[&str], &[&str])] = &[
    ("render", &["sky.pbrt", "-o", "wall.png"], &["sky.pbrt", "-o", "n.png", "-o", "./n.png"]),
    (
        "render",
        &["sky.pbrt", "-o", "n.png", "--resume", "sky.exr"],
        &["sky.pbrt", "-o", "n.exr", "--resume", "./n.exr"],
    ),
    (
        "render",
        &["sky.pbrt", "--integrator", "radiosity:solution=wall.png", "-o", "n.png"],
        &["sky.pbrt", "--integrator", "radiosity:solution=n.exr", "-o", "./n.exr"],
    ),
    ("verify", &["path.pbrt", "-o", "."], &["sky.pbrt", "-o", ".", "--html", "path.exr"]),
    ("info", &["sky.pbrt", "--thumbnail", "wall.png"], &[]),
    (
        "material",
        &["diffuse", "-p", "reflectance=wall.png", "--picture", "wall.png"],
        &["diffuse", "--plot", "n.svg", "--table", "./n.svg"],
    ),
    (
        "material",
        &["diffuse", "--eval", "pairs.json", "--plot", "pairs.json"],
        &["diffuse", "--plot", "n.png", "--picture", "./n.png"],
    ),
    ("material", &["diffuse", "--geometry", "part.ply", "--table", "part.ply"], &[]),
    (
        "bake",
        &["normals", "sky.pbrt", "sky.pbrt", "-o", "sky.exr"],
        &["normals", "sky.pbrt", "sky.pbrt", "-o", "n.png", "--height", "./n.png"],
    ),
    ("bake", &["light", "sky.pbrt", "-o", "wall.png"], &[]),
    ("unwrap", &["part.ply", "-o", "part.ply"], &[]),
    ("compare", &["wall.png", "wall.png", "-o", "wall.png"], &[]),
    ("bench", &["render", "sky.pbrt", "--html", "wall.png"], &["render", "sky.pbrt", "--html", "n", "--csv", "./n"]),
    (
        "compare",
        &["wall.png", "sky.exr", "--html", "sky.exr"],
        &["wall.png", "wall.png", "--html", "n", "--csv", "./n"],
    ),
    (
        "compare",
        &["wall.png", "wall.png", "--csv", "wall.png"],
        &["wall.png", "wall.png", "-o", "n.png", "--csv", "./n.png"],
    ),
    ("convert", &["wall.png", "wall.png"], &[]),
    ("convert", &["sky.pbrt", "sky.pbrt"], &["sky.pbrt", "n.steradian", "--report", "./n.steradian"]),
    ("convert", &["sky.pbrt", "n.xml", "--report", "wall.png"], &[]),
    ("denoise", &["wall.png", "-o", "wall.png"], &["wall.png", "-o", "n.png", "-o", "./n.png"]),
    ("denoise", &["sky.exr", "--half", "wall.png", "-o", "wall.png"], &[]),
    ("merge", &["wall.png", "wall.png", "-o", "wall.png"], &["wall.png", "wall.png", "-o", "n.png", "-o", "./n.png"]),
    (
        "farm",
        &["sky.pbrt", "--chunks", "1", "-o", ".", "--picture", "sky.exr"],
        &["sky.pbrt", "--chunks", "1", "-o", ".", "--picture", "n.png", "--picture", "./n.png"],
    ),
    ("signal", &["wall.png", "-o", "wall.png"], &["wall.png", "-o", "n.png", "-o", "./n.png"]),
    ("vision", &["cones", "wall.png", "-o", "wall.png"], &["cones", "wall.png", "-o", "n.png", "-o", "./n.png"]),
    (
        "vision",
        &["glare", "wall.png", "-o", "wall.png"],
        &["contrast-sensitivity", "-o", "n.svg", "--table", "./n.svg"],
    ),
    ("geometry", &["conic", "wall.png", "-o", "wall.png"], &["conic", "-o", "n.svg", "--table", "./n.svg"]),
    ("optics", &["rainbow", "wall.png", "-o", "wall.png"], &["rainbow", "-o", "n.svg", "--table", "./n.svg"]),
    ("estimate", &["importance", "wall.png", "-o", "wall.png"], &["importance", "-o", "n.svg", "--table", "./n.svg"]),
];

/// Commands that write nothing but to stdout, the one whose pages save nothing but new files (tests of
/// `steradian-server`), those that write to the folder of a job or to a new one alone, and that which writes archives,
/// which no scene names.
const WITHOUT_FILES: [&str; 11] =
    ["list", "meter", "completions", "man", "help", "view", "plan", "chunk", "pack", "exercise", "new"];

/// One guard holds for all commands: what is read stays, and each output has a file of its own.
#[test]
fn no_command_overwrites_what_it_reads_or_writes() {
    let place = place();
    place.file("pairs.json", "[]").file("path.pbrt", &SKY.replace("sky.exr", "path.exr"));
    paint(&place.path("path.exr"));
    let before = contents(&place);
    for (command, over_input, over_output) in CLASHES {
        place.refuse(2, &[&[*command][..], over_input].concat(), &["overwritten"]);
        if !over_output.is_empty() {
            place.refuse(2, &[&[*command][..], over_output].concat(), &["are one file"]);
        }
        assert!(contents(&place) == before, "{command} {over_input:?} {over_output:?}");
    }
    let help = place.succeed(&["--help"]).stdout;
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    for command in
        commands.filter_map(|line| line.strip_prefix("  ")?.split(' ').next().filter(|name| !name.is_empty()))
    {
        let is_known = WITHOUT_FILES.contains(&command) || CLASHES.iter().any(|clash| clash.0 == command);
        assert!(is_known, "'{command}' is in no table");
    }
}

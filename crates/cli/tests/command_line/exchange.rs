//! `steradian convert` for scenes, and thumbnails.

use crate::Place;
use base64::{Engine as _, prelude::BASE64_STANDARD};
use std::{
    collections::BTreeMap,
    io::Write,
    path::{Path, PathBuf},
    process::Stdio,
};

const BALL: &str = "Film \"rgb\" \"integer xresolution\" [40] \"integer yresolution\" [20]\nLookAt 0 0 -5 0 0 0 0 1 0\n\
    Camera \"perspective\" \"float fov\" [40]\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n\
    Material \"diffuse\" \"rgb reflectance\" [.5 .2 .1]\nShape \"sphere\"\n";

#[test]
fn a_scene_becomes_our_own_with_a_report_and_a_comparison() {
    let place = Place::new();
    place.file("s.pbrt", &BALL.replace("WorldBegin", "Sampler \"zsobol\"\nWorldBegin"));
    let run = place.succeed(&["convert", "s.pbrt", "s.steradian", "--report", "s.md", "--check"]);
    for word in ["1.000000 1.000000 1.000000", "largest difference 0.000e0"] {
        assert!(run.stderr.contains(word), "{}", run.stderr);
    }
    let report = std::fs::read_to_string(place.path("s.md")).unwrap();
    for word in ["| material | `diffuse` | 1 |", "## Approximated\n\nNothing.", "## Compared"] {
        assert!(report.contains(word), "{word} is not in\n{report}");
    }
    for (scene, picture) in [("s.pbrt", "a.exr"), ("s.steradian", "b.exr")] {
        place.succeed(&["render", scene, "--spp", "2", "-q", "-o", picture]);
    }
    place.succeed(&["compare", "a.exr", "b.exr", "--fail-above", "max_abs=0"]);
}

#[test]
fn conversion_of_scenes_refuses_what_it_cannot_do() {
    let place = Place::new();
    place.file("s.pbrt", BALL).file("bad.pbrt", "Film 3");
    place.succeed(&["convert", "s.pbrt", "s.steradian"]);
    place.refuse(2, &["convert", "s.steradian", "s.steradian"], &["would be overwritten"]);
    place.refuse(2, &["convert", "bad.pbrt", "bad.steradian"], &["has errors"]);
    assert!(!place.path("bad.steradian").exists());
    place.refuse(2, &["convert", "s.pbrt", "s.obj"], &["as .steradian"]);
    place.file(
        "lossy.pbrt",
        &BALL.replace("Material \"diffuse\" \"rgb reflectance\" [.5 .2 .1]", "Material \"coatedconductor\""),
    );
    place.refuse(2, &["convert", "lossy.pbrt", "lossy.xml", "--strict"], &["coated_conductor", "--strict"]);
    assert!(!place.path("lossy.xml").exists());
    place.file("box.pbrt", &format!("PixelFilter \"box\"\n{BALL}"));
    place.succeed(&["convert", "box.pbrt", "own.xml", "--check", "--strict"]);
    place.refuse(2, &["convert", "own.xml", "own.xml"], &["would be overwritten"]);
    place.refuse(2, &["convert", "a.exr", "a.png", "--check"], &["--check"]);
    place.refuse(1, &["convert", "s.pbrt", "no/s.steradian"], &["no/s.steradian"]);
}

#[test]
fn a_thumbnail_has_the_shape_of_the_frame() {
    let place = Place::new();
    place.file("s.pbrt", BALL);
    place.succeed(&["info", "s.pbrt", "--thumbnail", "t.png"]);
    let picture = place.picture("t.png");
    assert_eq!((picture.width(), picture.height()), (256, 128));
    place.refuse(2, &["info", "s.pbrt", "--thumbnail", "t.what"], &["t.what"]);
}

/// A triangle that becomes three times as high within a second.
const SLIDE: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}], "samplers": [{"input": 1, "output": 2}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
 {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
 {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
 {"buffer": 0, "byteOffset": 44, "byteLength": 24}],
"buffers": [{"byteLength": 68, "uri": "data:application/octet-stream;base64,BYTES"}]}"#;

#[test]
fn frames_of_an_animation_are_pictures_by_number() {
    let place = Place::new();
    let floats = [-1.0_f32, -1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 1.0];
    place.file("s.gltf", &SLIDE.replace("BYTES", &BASE64_STANDARD.encode(floats.map(f32::to_le_bytes).concat())));
    let size = ["--size", "24x18", "--spp", "1", "-q"];
    place.succeed(&[&["render", "s.gltf", "--frames", "0..1", "--fps", "1", "-o", "f.exr"][..], &size[..]].concat());
    assert_ne!(place.picture("f.0000.exr"), place.picture("f.0001.exr"));
    place.succeed(&[&["render", "s.gltf", "-D", "at=1", "-o", "one.exr"][..], &size[..]].concat());
    place.succeed(&["compare", "one.exr", "f.0001.exr", "--fail-above", "max_abs=0"]);
    place.refuse(2, &["render", "s.gltf", "--frames", "3..1"], &["A..B"]);
    place.refuse(2, &["render", "--frames", "0..1"], &["gltf"]);
}

/// [`SLIDE`] 4 units before a camera with an angle of view of 90°.
pub fn seen_slide() -> String {
    let floats = [-1.0_f32, -1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 1.0];
    let camera = r#""cameras": [{"type": "perspective", "perspective": {"yfov": 1.5707963, "znear": 0.01}}], "meshes""#;
    SLIDE
        .replace("BYTES", &BASE64_STANDARD.encode(floats.map(f32::to_le_bytes).concat()))
        .replace(r#""nodes": [0]"#, r#""nodes": [0, 1]"#)
        .replace(r#"{"mesh": 0}"#, r#"{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]}"#)
        .replace(r#""meshes""#, camera)
}

/// The layer of motion of a triangle that becomes three times as high within a second: at height y it has come from y
/// (1 − 2/3n) in a frame of 1/n s, the last one, as a camera 4 units before it sees it.
#[test]
fn motion_of_an_animation_is_its_speed() {
    let place = Place::new();
    place.file("s.gltf", &seen_slide());
    for rate in [2_u16, 5, 24] {
        let (frames, fps) = (format!("0..{rate}"), rate.to_string());
        let render = ["render", "s.gltf", "--frames", &frames, "--fps", &fps, "--size", "48x36", "--spp", "1", "-q"];
        place.succeed(&[&render[..], &["--exr", "float", "--aov", "motion,position,ids", "-o", "f.exr"]].concat());
        let picture = place.picture(&format!("f.{rate:04}.exr"));
        let plane = |name: &str| picture.channel(name).unwrap();
        let is_seen = |k: &usize| plane("object_id.Y")[*k] > 0.0 && plane("P.Z")[*k].abs() < 1e-3;
        let seen: Vec<usize> = (0..48 * 36).filter(is_seen).collect();
        for k in &seen {
            // 18 pixels are as high as far.
            let expected = -plane("P.Y")[*k] * 2.0 / (3.0 * f32::from(rate)) * 18.0 / 4.0;
            let [x, y, z] = ["X", "Y", "Z"].map(|axis| plane(&format!("motion.{axis}"))[*k]);
            assert!((y - expected).abs() < 1e-3 && x.abs() < 1e-3 && z.abs() < 1e-3, "{x} {y} {z} for {expected}");
        }
        assert!(seen.len() > 100, "{}", seen.len());
        assert!(place.picture("f.0000.exr").channel("motion.Y").unwrap().iter().all(|m| *m == 0.0));
    }
    place.refuse(2, &["render", "s.gltf", "--aov", "motion", "-o", "f.exr"], &["motion", "--frames"]);
    place.succeed(&["render", "s.gltf", "--frames", "0..0", "--size", "8x8", "--aov", "all", "-q", "-o", "all.exr"]);
    assert!(place.picture("all.0000.exr").channel("motion.X").is_none());
}

/// A mesh that no format holds in place, of a size.
fn cloth(size: f32) -> String {
    let n = 12;
    let points = (0..n * n).map(|i| format!("{} {} 0", size * (i % n) as f32 - 1.0, size * (i / n) as f32 - 1.0));
    let quads = (0..n * n).filter(|i| i % n + 1 < n && i / n + 1 < n);
    let corners = quads.map(|i| format!("{i} {} {} {i} {} {}", i + 1, i + n + 1, i + n + 1, i + n));
    let (points, corners) = (points.collect::<Vec<_>>().join(" "), corners.collect::<Vec<_>>().join(" "));
    format!("Shape \"trianglemesh\" \"point3 P\" [{points}] \"integer indices\" [{corners}]\n")
}

/// All files below a folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let each = |path: PathBuf| match path.is_dir() {
        true => files(&path),
        false => [(path.clone(), std::fs::read(&path).unwrap())].into(),
    };
    entries.flat_map(each).collect()
}

/// Documents of one stem share folders; none changes what another one names.
#[test]
fn what_lies_beside_a_document_is_its_own() {
    let place = Place::new();
    place.file("small.pbrt", &format!("{BALL}{}", cloth(0.1))).file("large.pbrt", &format!("{BALL}{}", cloth(0.3)));
    let mut before = files(place.0.path());
    for (scene, extension) in ["steradian", "xml", "pbrt", "gltf", "glb"]
        .map(|e| ("small.pbrt", e))
        .into_iter()
        .chain([("large.pbrt", "steradian"), ("large.pbrt", "xml"), ("large.pbrt", "gltf")])
    {
        let name = format!("a.{extension}");
        place.succeed(&["convert", scene, &name]);
        let after = files(place.0.path());
        for (path, bytes) in before.iter().filter(|(path, _)| !path.ends_with(&name)) {
            assert_eq!(after.get(path), Some(bytes), "{scene} as {name} changes {}", path.display());
        }
        before = after;
    }
    assert!(before.len() > 10, "meshes are files beside the documents");
    // A document beside its own meshes is converted in place.
    place.succeed(&["convert", "a.pbrt", "a.xml"]);
    // What cannot be written leaves nothing: neither files nor folders.
    std::fs::create_dir(place.path("b.pbrt")).unwrap();
    let before = files(place.0.path());
    place.refuse(1, &["convert", "small.pbrt", "b.pbrt"], &["b.pbrt"]);
    assert!(files(place.0.path()) == before && !place.path("b.meshes").exists());
}

/// Standard input and -D are read as `render` reads them.
#[test]
fn scenes_are_converted_from_standard_input() {
    let place = Place::new();
    let xml = "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'><integer name='width' value='$w'/>\
               </film></sensor><emitter type='constant'/></scene>";
    place.file("s.xml", xml);
    let mut command = place.command(&["convert", "-", "piped.steradian", "-D", "w=31"]);
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(xml.as_bytes()).unwrap();
    assert!(child.wait().unwrap().success());
    place.succeed(&["convert", "s.xml", "file.steradian", "-D", "w=31"]);
    place.succeed(&["convert", "builtin:cornell-box", "box.pbrt"]);
    let [piped, file] = ["piped.steradian", "file.steradian"].map(|f| std::fs::read_to_string(place.path(f)).unwrap());
    assert!(piped.contains("31") && piped == file, "{piped}\n{file}");
}

/// The report counts as exact what no message is about, and a message is printed once, with the number of its places.
#[test]
fn a_report_counts_what_is_exact() {
    let place = Place::new();
    let coats = "Material \"coatedconductor\" Shape \"sphere\"\n".repeat(4);
    place.file("s.pbrt", &format!("{BALL}{coats}"));
    let run = place.succeed(&["convert", "s.pbrt", "s.xml", "--report", "s.md"]);
    let report = std::fs::read_to_string(place.path("s.md")).unwrap();
    assert!(
        report.contains("| material | `diffuse` | 1 |") && !report.contains("| material | `coated_conductor`"),
        "{report}"
    );
    assert_eq!(run.stderr.matches("the coat of 'coated_conductor'").count(), 1, "{}", run.stderr);
    assert!(run.stderr.contains("at 3 more places"), "{}", run.stderr);
}

/// A turntable sees a model from all sides, as `azimuth` does, and films hold its frames.
#[test]
fn models_are_turned_and_films_made() {
    let place = Place::new();
    place.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    let small = ["render", "a.obj", "--size", "24x18", "--integrator", "raster", "--spp", "1"];
    let turn = [&small[..], &["-D", "azimuth=30", "--turntable", "3", "--fps", "10"]].concat();
    let said = place.succeed(&[&turn[..], &["-o", "t.png", "-o", "t.gif", "-o", "t.apng"]].concat()).stderr;
    assert!(said.contains("frame 3 of 3") && said.contains("wrote t.gif, t.apng"), "{said}");
    for (frame, side) in [(0, "30"), (1, "150"), (2, "270")] {
        place.succeed(&[&small[..], &["-D", &format!("azimuth={side}"), "-o", "side.png"]].concat());
        let [turned, side] = [format!("t.{frame:04}.png"), "side.png".into()].map(|name| place.picture(&name));
        assert_eq!(turned.channel("G"), side.channel("G"), "{frame}");
    }
    let film = std::fs::read(place.path("t.apng")).unwrap();
    assert!(film.windows(8).any(|w| w == [b'a', b'c', b'T', b'L', 0, 0, 0, 3]));
    assert!(std::fs::read(place.path("t.gif")).unwrap().starts_with(b"GIF89a"));
    // The film alone leaves no pictures beside it.
    let alone = Place::new();
    alone.file("a.obj", &std::fs::read_to_string(place.path("a.obj")).unwrap());
    alone.succeed(&[&turn[..], &["-o", "t.gif"]].concat());
    assert_eq!(std::fs::read_dir(&alone.0).unwrap().count(), 2);
    place.refuse(2, &[&small[..], &["-o", "t.gif"]].concat(), &["--turntable"]);
    place.refuse(2, &["render", "builtin:cornell-box", "--turntable", "3"], &["model or a glTF scene"]);
    place.refuse(2, &[&turn[..], &["--look-at", "0,0,5,0,0,0,0,1,0"]].concat(), &["--turntable"]);
    place.refuse(2, &[&turn[..], &["--frames", "0..2"]].concat(), &["--turntable"]);
    let mut without = place.command(&[&turn[..], &["-o", "t.mp4"]].concat());
    let refused = without.env("PATH", "/nowhere").output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("ffmpeg"));
}

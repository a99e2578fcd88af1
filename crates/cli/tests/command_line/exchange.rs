//! `steradian convert` for scenes, and thumbnails.

use crate::Place;

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
    place.file("s.gltf", &SLIDE.replace("BYTES", &base64(&floats.map(f32::to_le_bytes).concat())));
    let size = ["--size", "24x18", "--spp", "1", "-q"];
    place.succeed(&[&["render", "s.gltf", "--frames", "0..1", "--fps", "1", "-o", "f.exr"][..], &size[..]].concat());
    assert_ne!(place.picture("f.0000.exr"), place.picture("f.0001.exr"));
    place.succeed(&[&["render", "s.gltf", "-D", "at=1", "-o", "one.exr"][..], &size[..]].concat());
    place.succeed(&["compare", "one.exr", "f.0001.exr", "--fail-above", "max_abs=0"]);
    place.refuse(2, &["render", "s.gltf", "--frames", "3..1"], &["A..B"]);
    place.refuse(2, &["render", "--frames", "0..1"], &["gltf"]);
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = |c: &[u8]| {
        let n = c.iter().chain([&0, &0]).take(3).fold(0, |n, b| n << 8 | usize::from(*b));
        let all: Vec<char> = (0..4).rev().map(|i| char::from(DIGITS[n >> (6 * i) & 63])).collect();
        all.into_iter().enumerate().map(|(i, d)| if i > c.len() { '=' } else { d }).collect::<String>()
    };
    bytes.chunks(3).map(digits).collect()
}

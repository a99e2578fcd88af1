//! `steradian unwrap`: what is written is read back, and faults are told.

use crate::Place;
use steradian::{formats::Options, scene::Mesh};

/// A square pyramid without its base.
const PYRAMID: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

fn mesh(place: &Place, name: &str) -> Mesh {
    let loaded = steradian::load(place.path(name), &Options::default());
    assert!(!loaded.diagnostics.has_errors(), "{name}");
    let numbers = loaded.desc.shapes.iter().filter_map(|shape| shape.mesh);
    let meshes = numbers.map(|m| (*loaded.desc.meshes[m]).clone());
    meshes.max_by_key(|m| m.triangles.len()).expect("a mesh")
}

#[test]
fn files_of_all_kinds_have_the_same_atlas() {
    let place = Place::new();
    place.file("pyramid.obj", PYRAMID);
    let mut seen = Vec::new();
    for name in ["a.ply", "a.obj", "a.glb"] {
        let said = place.succeed(&["unwrap", "pyramid.obj", "-o", name, "--resolution", "64", "--json"]).stdout;
        assert!(said.contains("\"charts\":4") && said.contains("\"degenerate\":0"), "{said}");
        let mesh = mesh(&place, name);
        let from_top = name == "a.glb";
        let uv = |i: u32| mesh.uvs[i as usize];
        seen.push(
            mesh.triangles.iter().map(|t| t.map(|i| [uv(i)[0], (uv(i)[1] - f32::from(from_top)).abs()])).collect(),
        );
    }
    let seen: Vec<Vec<[[f32; 2]; 3]>> = seen;
    assert_eq!(seen[0].len(), 4);
    assert!(seen[0] == seen[1] && seen[0] == seen[2], "{seen:?}");
    place.succeed(&["unwrap", "a.ply", "-o", "b.ply", "--seams", "keep", "--picture", "b.png", "--resolution", "64"]);
    assert_eq!(place.picture("b.png").width(), 128);
}

#[test]
fn faults_are_told() {
    let place = Place::new();
    place.file("pyramid.obj", PYRAMID).file("point.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n");
    let refuse = |line: &[&str], about: &[&str]| place.refuse(2, &[&["unwrap"][..], line].concat(), about);
    refuse(&["pyramid.obj", "-o", "a.stl"], &["a.stl", ".ply"]);
    refuse(&["pyramid.obj", "-o", "a.ply", "--second"], &["--second"]);
    refuse(&["pyramid.obj", "-o", "a.ply", "--resolution", "1"], &["resolution"]);
    refuse(&["pyramid.obj", "-o", "a.ply", "--seam-angle", "nan"], &["angle of seams"]);
    refuse(&["none.obj", "-o", "a.ply"], &["none.obj"]);
    refuse(&["point.obj", "-o", "a.ply"], &["point.obj"]);
    assert!(!place.path("a.ply").exists(), "nothing is written");
}

//! Whole scenes: the published ones, and small ones for what directives mean, what is wrong in them, and what must not
//! break.

mod directives;
mod faults;
mod law;
mod models;
mod published;
mod robust;
mod told;

use super::*;
use steradian_math::DVec3;
use steradian_scene::{Diagnostic, Node, Severity, Transform};

/// Imports a text; files are looked for in `folder`.
fn load_in(folder: &Path, text: &str) -> Import {
    import_text("scene.pbrt", text, folder, &Options::default())
}

fn load(text: &str) -> Import {
    load_in(Path::new("."), text)
}

/// Imports a world without anything to complain about.
fn world(body: &str) -> SceneDesc {
    let import = load(&format!("WorldBegin\n{body}"));
    let messages: Vec<String> = import.diagnostics.iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
    import.desc
}

/// Imports options and an empty world without anything to complain about.
fn options(body: &str) -> SceneDesc {
    let import = load(&format!("{body}\nWorldBegin"));
    let messages: Vec<String> = import.diagnostics.iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
    import.desc
}

fn errors(import: &Import) -> Vec<&Diagnostic> {
    import.diagnostics.iter().filter(|d| d.severity == Severity::Error).collect()
}

/// The only shape's node.
fn shape(desc: &SceneDesc) -> &Node {
    assert_eq!(desc.shapes.len(), 1);
    desc.node(desc.shapes[0].node)
}

/// The material of the only shape.
fn material(desc: &SceneDesc) -> &Node {
    desc.node(desc.shapes[0].material.unwrap())
}

/// The only light.
fn light(desc: &SceneDesc) -> &Node {
    assert_eq!(desc.lights.len(), 1);
    desc.node(desc.lights[0])
}

fn camera(desc: &SceneDesc) -> &Node {
    desc.node(desc.cameras[0])
}

fn image_of(t: Transform, p: [f64; 3]) -> [f64; 3] {
    t.point(DVec3::from(p)).to_array()
}

fn assert_near(a: [f64; 3], b: [f64; 3]) {
    assert!((DVec3::from(a) - DVec3::from(b)).length() < 1e-9, "{a:?} is not {b:?}");
}

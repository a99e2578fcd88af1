//! Tests of the whole reader.

#![expect(clippy::print_stdout, reason = "says what was skipped")]

mod families;
mod faults;
mod language;
mod law;
mod real_scenes;
mod shapes;
mod told;

use super::import_text;
use crate::{Import, Options};
use std::path::{Path, PathBuf};
use steradian_scene::{Diagnostic, Node, NodeId, SceneDesc, Severity, Value};

/// A file or folder of the collection of test scenes.
fn shared(sub: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")).join(sub)
}

/// Reads what stands inside a scene of version 3, placed on line 1.
fn read(inside: &str) -> Import {
    import_text(&format!("<scene version=\"3.0.0\">{inside}</scene>"), Path::new("test.xml"), &Options::default())
}

/// A scene that must be free of errors.
fn good(inside: &str) -> SceneDesc {
    let import = read(inside);
    assert_eq!(errors(&import), Vec::<String>::new(), "{inside}");
    import.desc
}

fn errors(import: &Import) -> Vec<String> {
    import.diagnostics.iter().filter(|d| d.severity == Severity::Error).map(Diagnostic::to_string).collect()
}

/// The material of the only shape, a sphere with this BSDF.
fn material(bsdf: &str) -> (SceneDesc, Node) {
    let desc = good(&format!("<shape type=\"sphere\">{bsdf}</shape>"));
    let node = desc.node(desc.shapes[0].material.unwrap()).clone();
    (desc, node)
}

fn child<'d>(desc: &'d SceneDesc, node: &Node, name: &str) -> &'d Node {
    desc.node(node.node(name).unwrap_or_else(|| panic!("{name} of {node:?}")))
}

fn rgb(v: [f64; 3]) -> Value {
    Value::Spectrum(steradian_scene::SpectrumValue::Rgb(v, Default::default()))
}

fn only<'d>(desc: &'d SceneDesc, ids: &[NodeId]) -> &'d Node {
    assert_eq!(ids.len(), 1);
    desc.node(ids[0])
}

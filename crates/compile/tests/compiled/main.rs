//! Results of compiling descriptions: one program, since each takes long to link.

mod bad_values;
mod colors_agree;
mod emission;
mod families;
mod light_sampling;
mod normal_maps;
#[path = "../../examples/one_shape/mod.rs"]
mod one_shape;
mod schema;
mod sky;
mod test_cards;
mod textures;

use steradian_compile::{Options, compile};
use steradian_scene::{Node, NodeId, SceneDesc, Value};
use steradian_schema::{Condition, Model, Parameter, Type};

/// Adds to a node of a model what must be there for a parameter to be looked at: its parts, which are two materials,
/// and what the parameter counts with.
fn prepare(node: &mut Node, model: &Model, parts: [NodeId; 2], of: Option<&Parameter>) {
    for p in model.parameters {
        match p.kind {
            Type::Material => _ = node.set(p.name, parts[0], None),
            Type::Materials => _ = node.set(p.name, Value::Nodes(parts.to_vec()), None),
            _ => {}
        }
    }
    match of.map_or(Condition::Always, |p| p.condition) {
        Condition::Always => {}
        Condition::Is(name, word) => _ = node.set(name, word, None),
        Condition::Given(name) => {
            let other = model.parameter(name).expect("a parameter of the model");
            match other.kind {
                Type::Map => node.set(name, Value::Node(parts[0]), None),
                _ => node.set(name, 4.0_f64.clamp(other.range.0, other.range.1), None),
            };
        }
    }
}

/// The messages that compiling a description gives, none of which is of a fault of the schema.
fn said(desc: &SceneDesc, options: &Options) -> Vec<String> {
    let said: Vec<_> = compile(desc, options).diagnostics.iter().map(|m| m.message.clone()).collect();
    assert!(!said.iter().any(|m| m.contains("the schema lacks")), "{said:?}");
    said
}

//! Results of compiling descriptions: one program, since each takes long to link.

mod bad_values;
mod colors_agree;
mod emission;
mod families;
mod light_sampling;
mod one_shape;
mod schema;
mod sky;
mod test_cards;
mod textures;

use steradian_scene::{Node, NodeId, Value};
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
            let (low, high) = model.parameter(name).expect("a parameter of the model").range;
            node.set(name, 4.0_f64.clamp(low, high), None);
        }
    }
}

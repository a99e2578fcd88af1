//! The schema of materials is what the compiler reads, and its ranges are what the compiler checks.

use super::{prepare, said};
use steradian_compile::Options;
use steradian_math::spectra::ColorMode;
use steradian_scene::{Family, Node, SceneDesc, Shape, Value};
use steradian_schema::{Type, material::MATERIALS};

/// The messages that compiling a material with one parameter gives.
fn messages(kind: &str, parameter: &str, value: Value) -> Vec<String> {
    messages_in(None, kind, parameter, value)
}

/// As [`messages`], in a colour mode.
fn messages_in(mode: Option<ColorMode>, kind: &str, parameter: &str, value: Value) -> Vec<String> {
    let mut d = SceneDesc::default();
    let mut node = Node::new(Family::Material, kind, None);
    let inner = d.add(Node::new(Family::Material, "diffuse", None));
    let model = Family::Material.model(kind).expect("a kind of material");
    prepare(&mut node, model, [inner; 2], model.parameter(parameter));
    let id = d.add(node.with(parameter, value));
    let sphere = d.add(Node::new(Family::Shape, "sphere", None));
    d.shapes.push(Shape { material: Some(id), ..Shape::new(sphere) });
    said(&d, &Options { mode, ..Options::default() })
}

/// Parameters named by the table are those that the compiler reads: a value that nothing can use is noticed.
#[test]
fn every_parameter_is_read() {
    for e in MATERIALS {
        for p in e.parameters {
            let nonsense = if p.kind == Type::List { Value::Bool(true) } else { Value::Ints(vec![1, 2, 3]) };
            let said = messages(e.kind, p.name, nonsense);
            assert!(said.iter().any(|m| m.contains(p.name)), "{}: {} is not read: {said:?}", e.kind, p.name);
        }
    }
}

/// Numbers outside their range are reported, with the parameter's name or the number.
#[test]
fn ranges_are_checked() {
    for e in MATERIALS {
        for p in e.parameters.iter().filter(|p| p.kind.is_numeric()) {
            for (bound, outside) in [(p.range.0, p.range.0 - 1.0), (p.range.1, p.range.1 + 6.0)] {
                if bound.is_finite() {
                    let said = messages(e.kind, p.name, Value::Float(outside));
                    assert!(
                        said.iter().any(|m| m.contains(p.name) || m.contains(&outside.to_string())),
                        "{}: {} = {outside}: {said:?}",
                        e.kind,
                        p.name
                    );
                }
            }
        }
    }
}

/// Every default that a material reads is in the schema, whichever parameter is given, in both colour modes.
#[test]
fn every_default_is_in_the_schema() {
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        for model in MATERIALS {
            for p in model.all() {
                let words = p.words().map(Value::from);
                let number = p.kind.is_numeric().then(|| Value::from(p.default_number().unwrap_or(p.range.0.max(1.0))));
                for value in words.chain(number) {
                    messages_in(Some(mode), model.kind, p.name, value);
                }
            }
        }
    }
}

//! The catalogue of materials is what the compiler reads, and its ranges are what the compiler checks.

use steradian_compile::{Options, compile};
use steradian_core::material::catalog::{Kind, MATERIALS, entry};
use steradian_scene::{Family, Node, SceneDesc, Shape, Value};

/// The messages that compiling a material with one parameter gives.
fn messages(kind: &str, parameter: &str, value: Value) -> Vec<String> {
    let mut d = SceneDesc::default();
    let mut node = Node::new(Family::Material, kind, None);
    // What must be there for the rest to be looked at.
    let inner = d.add(Node::new(Family::Material, "diffuse", None));
    for p in entry(kind).map_or(&[][..], |e| e.parameters) {
        match p.kind {
            Kind::Material => node = node.with(p.name, Value::Node(inner)),
            Kind::Materials => node = node.with(p.name, Value::Nodes(vec![inner, inner])),
            _ => {}
        }
    }
    let described = entry(kind).and_then(|e| e.parameters.iter().find(|p| p.name == parameter));
    if let Some((name, needed)) = described.and_then(|p| p.needs) {
        let value = needed.parse::<f64>().map_or_else(|_| Value::String(needed.into()), Value::Float);
        node = node.with(name, value);
    }
    let id = d.add(node.with(parameter, value));
    let sphere = d.add(Node::new(Family::Shape, "sphere", None));
    d.shapes.push(Shape { material: Some(id), ..Shape::new(sphere) });
    compile(&d, &Options::default()).diagnostics.iter().map(|m| m.message.clone()).collect()
}

/// What the table names is what the compiler reads: a value that nothing can use is noticed.
#[test]
fn every_parameter_is_read() {
    for e in MATERIALS {
        for p in e.parameters {
            let nonsense = if p.kind == Kind::List { Value::Bool(true) } else { Value::Ints(vec![1, 2, 3]) };
            let said = messages(e.name, p.name, nonsense);
            assert!(said.iter().any(|m| m.contains(p.name)), "{}: {} is not read: {said:?}", e.name, p.name);
        }
    }
}

/// Numbers outside their range are reported, with the parameter's name or the number.
#[test]
fn ranges_are_checked() {
    for e in MATERIALS {
        for p in e.parameters.iter().filter(|p| matches!(p.kind, Kind::Texture | Kind::Number | Kind::Spectrum)) {
            for (bound, outside) in [(p.range.0, p.range.0 - 1.0), (p.range.1, p.range.1 + 6.0)] {
                if bound.is_finite() {
                    let said = messages(e.name, p.name, Value::Float(outside));
                    assert!(
                        said.iter().any(|m| m.contains(p.name) || m.contains(&outside.to_string())),
                        "{}: {} = {outside}: {said:?}",
                        e.name,
                        p.name
                    );
                }
            }
        }
    }
}

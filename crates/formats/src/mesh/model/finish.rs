//! Materials that the user gives to surfaces without one: `-D material=gold`, `-D material=plastic:alpha_u=0.3`.

use steradian_scene::{ColorSpace, Family, Node, NodeId, SceneDesc, SpectrumValue, Value};

/// Finishes by name: a kind of material and its parameters.
const FINISHES: [(&str, &str); 9] = [
    ("clay", "diffuse:reflectance=0.62,0.58,0.54"),
    ("plastic", "plastic:diffuse_reflectance=0.55,0.05,0.04:alpha_u=0.08"),
    ("gloss", "plastic:diffuse_reflectance=0.75,0.74,0.72:alpha_u=0.1"),
    ("glass", "dielectric:eta=1.5"),
    ("chrome", "conductor:reflectance=0.55,0.56,0.56:alpha_u=0.01"),
    ("silver", "conductor:eta=metal-Ag-eta:k=metal-Ag-k:alpha_u=0.08"),
    ("gold", "conductor:eta=metal-Au-eta:k=metal-Au-k:alpha_u=0.1"),
    ("copper", "conductor:eta=metal-Cu-eta:k=metal-Cu-k:alpha_u=0.12"),
    ("rubber", "plastic:diffuse_reflectance=0.025,0.025,0.027:alpha_u=0.4"),
];
/// Kinds that have one side.
const ONE_SIDED: [&str; 4] = ["diffuse", "plastic", "conductor", "coated_diffuse"];

/// The node of a material that the user names.
fn node(word: &str) -> Result<Node, String> {
    let named = FINISHES.iter().find(|(name, _)| *name == word).map_or(word, |(_, text)| text);
    let mut parts = named.split(':');
    let kind = parts.next().unwrap_or_default();
    let mut node = Node::new(Family::Material, kind, None);
    node.name = Some("material".into());
    let mut is_plain = named == word;
    for part in parts {
        is_plain = false;
        let Some((name, text)) = part.split_once('=').filter(|(name, text)| !name.is_empty() && !text.is_empty())
        else {
            return Err(format!("'material' is KIND:parameter=value:…, and '{part}' is no parameter=value"));
        };
        node.set(name, value(text), None);
    }
    let names = FINISHES.map(|f| f.0).join(", ");
    match is_plain && !KINDS.contains(&kind) {
        true => Err(format!("'material' is one of {names}, or KIND:parameter=value:…, not '{word}'")),
        false => Ok(node),
    }
}

/// Kinds that say enough without parameters.
const KINDS: [&str; 7] = ["diffuse", "conductor", "dielectric", "thin_dielectric", "principled", "openpbr", "sheen"];

/// A number, a colour, true or false, or a spectrum or word by its name.
fn value(text: &str) -> Value {
    let numbers: Option<Vec<f64>> = text.split(',').map(|v| v.parse().ok().filter(|v: &f64| v.is_finite())).collect();
    match (numbers.as_deref(), text) {
        (Some([one]), _) => Value::Float(*one),
        (Some([r, g, b]), _) => Value::Spectrum(SpectrumValue::Rgb([*r, *g, *b], ColorSpace::Srgb)),
        (Some(list), _) => Value::Floats(list.to_vec()),
        (None, "true" | "false") => Value::Bool(text == "true"),
        (None, _) if text.starts_with("metal-") || text.starts_with("glass-") || text.starts_with("stdillum-") => {
            Value::Spectrum(SpectrumValue::Named(text.into()))
        }
        (None, _) => Value::String(text.into()),
    }
}

/// Gives surfaces without a material the one that the user names.
pub(super) fn apply(desc: &mut SceneDesc, word: &str) -> Result<(), String> {
    let node = node(word)?;
    let is_one_sided = ONE_SIDED.contains(&node.kind.as_str());
    let mut material: NodeId = desc.add(node);
    if is_one_sided {
        material = desc.add(Node::new(Family::Material, "two_sided", None).with("front", material));
    }
    desc.shapes.iter_mut().filter(|s| s.material.is_none()).for_each(|s| s.material = Some(material));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finishes_are_read_or_refused() {
        for (name, text) in FINISHES {
            let node = node(name).expect("it is a finish");
            assert!(text.starts_with(&node.kind) && !node.params.is_empty(), "{name}");
        }
        let node = node("plastic:diffuse_reflectance=0.8,0.2,0.1:alpha_u=0.3:nonlinear=true").expect("it is a kind");
        let red = SpectrumValue::Rgb([0.8, 0.2, 0.1], ColorSpace::Srgb);
        assert_eq!(node.get("diffuse_reflectance"), Some(&Value::Spectrum(red)));
        assert_eq!((node.float("alpha_u"), node.get("nonlinear")), (Some(0.3), Some(&Value::Bool(true))));
        for (word, message) in [
            ("godl", "'material' is one of clay, plastic, gloss,"),
            ("conductor:alpha_u", "'alpha_u' is no parameter=value"),
        ] {
            assert!(super::node(word).is_err_and(|e| e.contains(message)), "{word}");
        }
    }
}

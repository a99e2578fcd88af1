//! Brings objects of files before version 2 to today's names, as Mitsuba itself does when it reads them.

use super::graph::{Graph, Object, Raw};
use steradian_math::{DVec3, Transform};

/// `toWorld` → `to_world`, `intIOR` → `int_ior`.
fn snake_case(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 4);
    let mut previous = ' ';
    for c in name.chars() {
        if c.is_ascii_uppercase() && previous.is_ascii_lowercase() {
            out.push('_');
        }
        // A run of capitals after the underscore is one word.
        let in_word = previous.is_ascii_lowercase() || (previous.is_ascii_uppercase() && out.contains('_'));
        out.push(if in_word { c.to_ascii_lowercase() } else { c });
        previous = c;
    }
    out
}

/// Upgrades every object that needs it.
pub(super) fn upgrade(graph: &mut Graph) {
    for object in graph.objects.iter_mut().filter(|o| o.legacy) {
        for prop in &mut object.props {
            prop.name = snake_case(&prop.name);
        }
        if object.plugin == "diffuse" {
            rename(object, "diffuse_reflectance", "reflectance");
        }
        uv_transform(object);
    }
}

fn rename(object: &mut Object, from: &str, to: &str) {
    for prop in object.props.iter_mut().filter(|p| p.name == from) {
        prop.name = to.into();
    }
}

/// `uoffset`, `voffset`, `uscale`, `vscale` become `to_uv`.
fn uv_transform(object: &mut Object) {
    let number = |name: &str, missing: f64| {
        let value = object.props.iter().find(|p| p.name == name).map(|p| &p.value);
        match value {
            Some(Raw::Float(v)) => *v,
            Some(Raw::Int(v)) => *v as f64,
            _ => missing,
        }
    };
    let offset = DVec3::new(number("uoffset", 0.0), number("voffset", 0.0), 0.0);
    let scale = DVec3::new(number("uscale", 1.0), number("vscale", 1.0), 1.0);
    let old = ["uoffset", "voffset", "uscale", "vscale"];
    let Some(first) = object.props.iter().position(|p| old.contains(&p.name.as_str())) else { return };
    let mut prop = object.props[first].clone();
    object.props.retain(|p| !old.contains(&p.name.as_str()));
    prop.name = "to_uv".into();
    prop.value = Raw::Transform(Transform::scale(scale) * Transform::translate(offset));
    object.props.push(prop);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_snake_case() {
        let cases = [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("extIOR", "ext_ior"),
            ("sigmaT", "sigma_t"),
            ("maxDepth", "max_depth"),
            ("flipTexCoords", "flip_tex_coords"),
            ("reflectance", "reflectance"),
            ("B", "B"),
        ];
        for (old, new) in cases {
            assert_eq!(snake_case(old), new);
        }
    }
}

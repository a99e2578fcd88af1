//! The operations inside `<transform>`.

use super::{
    parse::{Attr, Attributes},
    values,
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Span, names};

/// Their element names.
pub(super) const OPERATIONS: [&str; 5] = ["translate", "rotate", "scale", "lookat", "matrix"];

type Fault = (Option<Span>, String);

/// A vector from the attributes `x`, `y`, `z` (each `missing` where absent) or from `value` (one or three numbers).
pub(super) fn vector(attributes: &Attributes<'_>, missing: f64) -> Result<[f64; 3], String> {
    let parts = ["x", "y", "z"].map(|name| attributes.get(name));
    match attributes.get("value") {
        Some(_) if parts.iter().any(Option::is_some) => Err("'value' excludes 'x', 'y' and 'z'".into()),
        Some(value) => values::triple(&value.value),
        None => {
            let part = |i: usize| parts[i].map_or(Ok(missing), |a: &Attr<'_>| values::number(&a.value));
            Ok([part(0)?, part(1)?, part(2)?])
        }
    }
}

/// Tests for a `<rotate>` of Mitsuba 3 that is no pure rotation: its axis is not of unit length.
pub(super) fn stretches(tag: &str, attributes: &Attributes<'_>, legacy: bool) -> bool {
    let axis = vector(attributes, 0.0).map_or(DVec3::Z, DVec3::from);
    tag == "rotate" && !legacy && (axis.length() - 1.0).abs() > 1e-3
}

/// Rodrigues' formula, `cosθ I + (1 − cosθ) a aᵀ + sinθ [a]×`, with the axis as it stands: Mitsuba 3 does not bring it
/// to unit length, so that another one stretches and shears.
fn rotation(a: DVec3, angle: f64) -> Transform {
    let (sin, cos) = angle.sin_cos();
    let column = |e: DVec3| e * cos + a * (a.dot(e) * (1.0 - cos)) + a.cross(e) * sin;
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(column);
    Transform::from_columns([x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, 0.0, 0.0, 0.0, 1.0])
}

/// The map that one operation stands for, or what is wrong with it and where.
pub(super) fn operation(tag: &str, attributes: &Attributes<'_>, legacy: bool) -> Result<Transform, Fault> {
    let tag = if legacy && tag == "lookAt" { "lookat" } else { tag };
    let (known, needed): (&[&str], &[&str]) = match tag {
        "translate" | "scale" => (&["x", "y", "z", "value"], &[]),
        "rotate" => (&["x", "y", "z", "value", "angle"], &["angle"]),
        "lookat" => (&["origin", "target", "up"], &["origin", "target"]),
        "matrix" => (&["value"], &["value"]),
        _ => {
            let help = names::did_you_mean(tag, OPERATIONS).map(|h| format!(", {h}")).unwrap_or_default();
            return Err((None, format!("<{tag}> is no operation of a transform{help}")));
        }
    };
    if let Some(a) = attributes.list.iter().find(|a| !known.contains(&a.name)) {
        return Err((Some(a.name_span), format!("<{tag}> has no attribute '{}'", a.name)));
    }
    if let Some(n) = needed.iter().find(|n| attributes.get(n).is_none()) {
        return Err((None, format!("<{tag}> needs the attribute '{n}'")));
    }
    let located = |name: &str, message: String| -> Fault { (attributes.get(name).map(|a| a.value_span), message) };
    let xyz = |missing: f64| {
        let first = attributes.list.iter().find(|a| ["value", "x", "y", "z"].contains(&a.name));
        vector(attributes, missing).map(DVec3::from).map_err(|e| (first.map(|a| a.value_span), e))
    };
    match tag {
        "translate" => Ok(Transform::translate(xyz(0.0)?)),
        "scale" => {
            let factors = xyz(1.0)?;
            if factors.x == 0.0 || factors.y == 0.0 || factors.z == 0.0 {
                return Err((attributes.list.first().map(|a| a.value_span), "a scale of zero cannot be undone".into()));
            }
            Ok(Transform::scale(factors))
        }
        "rotate" => {
            let axis = xyz(0.0)?;
            if axis == DVec3::ZERO {
                return Err((None, "the axis of the rotation is zero".into()));
            }
            let angle = attributes.text("angle").map_or(Ok(0.0), values::number);
            let angle = angle.map_err(|e| located("angle", e))?.to_radians();
            Ok(if legacy { Transform::rotate(axis, angle) } else { rotation(axis, angle) })
        }
        "lookat" => {
            let point = |name: &str| -> Result<DVec3, Fault> {
                let text = attributes.text(name).unwrap_or("0 0 0");
                match values::numbers(text).map_err(|e| located(name, e))?[..] {
                    [x, y, z] => Ok(DVec3::new(x, y, z)),
                    ref other => Err(located(name, format!("'{name}' needs three numbers, not {}", other.len()))),
                }
            };
            let (origin, target) = (point("origin")?, point("target")?);
            let mut up = point("up")?;
            if up == DVec3::ZERO {
                let forward = (target - origin).try_normalize();
                up = forward
                    .ok_or_else(|| located("target", "'origin' and 'target' are the same point".into()))?
                    .any_orthonormal_vector();
            }
            let fault = || located("target", "'target' equals 'origin', or 'up' is parallel to the view".into());
            Transform::look_at(origin, target, up).ok_or_else(fault)
        }
        _ => {
            let value = attributes.text("value").unwrap_or_default();
            let matrix = values::matrix(value).map_err(|e| located("value", e))?;
            if matrix.inverse().is_none() {
                return Err(located("value", "the matrix cannot be inverted".into()));
            }
            Ok(matrix)
        }
    }
}

//! Checks of accessor values: their declared bounds, and the constraints of each use.

use super::{
    Issues,
    document::{Document, index, list},
    elements::Data,
    graph::UNIT_TOLERANCE,
};
use serde_json::Value;
use std::collections::BTreeMap;

/// Constraint of a use on each element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Role {
    /// Vectors of unit length.
    Unit,
    /// Tangents: vectors of unit length with a sign.
    Tangent,
    /// From 0 to 1.
    Clamped,
    /// Times that increase from 0 on.
    Times,
    /// Quaternions of unit length, the middle ones of three where they are splines.
    Rotations { splines: bool },
    /// Matrices with the last row 0 0 0 1.
    Affine,
    /// Below a count of vertices.
    Indices,
}

/// The first place of each use, and the least number of vertices that indices have.
type Roles = BTreeMap<(usize, Role), (String, u64)>;

pub(super) fn check(document: &Document<'_>, data: &mut Data<'_>, issues: &mut Issues) {
    data.check_sparse(document, issues);
    for k in 0..document.accessors.len() {
        check_bounds(document, data, k, issues);
    }
    for ((accessor, role), (place, vertices)) in roles(document) {
        check_role(document, data, (accessor, role, vertices), &place, issues);
    }
}

fn roles(document: &Document<'_>) -> Roles {
    let mut roles = Roles::new();
    let mut add = |object: &Value, name: &str, role: Role, place: &dyn Fn() -> String, vertices: u64| {
        if let Some((accessor, _)) = document.accessor(object, name) {
            let (_, least) = roles.entry((accessor, role)).or_insert_with(|| (place(), vertices));
            *least = vertices.min(*least);
        }
    };
    for (k, mesh) in document.list("meshes").iter().enumerate() {
        for (n, primitive) in list(mesh, "primitives").iter().enumerate() {
            let at = || format!("/meshes/{k}/primitives/{n}");
            let attributes = &primitive["attributes"];
            let vertices = document.accessor(attributes, "POSITION").map_or(u64::MAX, |(_, a)| a.count);
            add(primitive, "indices", Role::Indices, &|| at() + "/indices", vertices);
            for name in attributes.as_object().into_iter().flatten().map(|(name, _)| name) {
                let role = match name.as_str() {
                    "NORMAL" => Role::Unit,
                    "TANGENT" => Role::Tangent,
                    _ if name.starts_with("COLOR_") => Role::Clamped,
                    _ => continue,
                };
                add(attributes, name, role, &|| format!("{}/attributes/{name}", at()), 0);
            }
        }
    }
    for (k, skin) in document.list("skins").iter().enumerate() {
        let name = "inverseBindMatrices";
        add(skin, name, Role::Affine, &|| format!("/skins/{k}/{name}"), 0);
    }
    for (k, animation) in document.list("animations").iter().enumerate() {
        for (n, sampler) in list(animation, "samplers").iter().enumerate() {
            add(sampler, "input", Role::Times, &|| format!("/animations/{k}/samplers/{n}/input"), 0);
        }
        for (n, channel) in list(animation, "channels").iter().enumerate() {
            let sampler = index(channel, "sampler").and_then(|s| list(animation, "samplers").get(s));
            if let (Some(sampler), Some("rotation")) = (sampler, channel["target"]["path"].as_str()) {
                let role = Role::Rotations { splines: sampler["interpolation"] == "CUBICSPLINE" };
                add(sampler, "output", role, &|| format!("/animations/{k}/channels/{n}/sampler"), 0);
            }
        }
    }
    roles
}

/// Numbers are finite, and `min` and `max` are what they say.
fn check_bounds(document: &Document<'_>, data: &mut Data<'_>, number: usize, issues: &mut Issues) {
    let (accessor, value) = (&document.accessors[number], &document.list("accessors")[number]);
    // What has no data is zero, unless an extension brings data.
    if accessor.view.is_none() && value.get("sparse").is_none() {
        return;
    }
    if accessor.component != 5126 && value.get("min").is_none() && value.get("max").is_none() {
        return;
    }
    let channels = accessor.channels();
    let bound = |name: &str| -> Vec<Option<f64>> {
        // As the numbers are stored: in single precision.
        let stored = |v: f64| if accessor.component == 5126 { f64::from(v as f32) } else { v };
        let declared = list(value, name);
        let is_whole = declared.len() == channels;
        (0..channels).map(|k| declared.get(k).filter(|_| is_whole)?.as_f64().map(stored)).collect()
    };
    let declared = [bound("min"), bound("max")];
    let (mut found, mut beyond) = ([[f64::INFINITY; 16], [f64::NEG_INFINITY; 16]], [[0usize; 16]; 2]);
    let mut strange: Option<(usize, f64, usize)> = None;
    let seen = data.visit(document, number, true, |k, values| {
        for (c, v) in values.iter().enumerate() {
            if !v.is_finite() {
                strange.get_or_insert((k, *v, 0)).2 += 1;
                continue;
            }
            (found[0][c], found[1][c]) = (found[0][c].min(*v), found[1][c].max(*v));
            beyond[0][c] += usize::from(declared[0][c].is_some_and(|least| *v < least));
            beyond[1][c] += usize::from(declared[1][c].is_some_and(|most| *v > most));
        }
    });
    if seen.is_none() {
        return;
    }
    let place = format!("/accessors/{number}");
    if let Some((k, v, count)) = strange {
        issues.add(&place, format!("element {k} is {v}; {count} of its numbers are not finite"));
    }
    for (side, (name, word)) in [("min", "less"), ("max", "more")].into_iter().enumerate() {
        for c in 0..channels {
            let Some(bound) = declared[side][c].filter(|b| found[side][c].is_finite() && *b != found[side][c]) else {
                continue;
            };
            let message = match beyond[side][c] {
                0 => format!("{bound} is declared, but no element reaches it: the right value is {}", found[side][c]),
                n => format!("{bound} is declared, but {n} elements are {word}: the right value is {}", found[side][c]),
            };
            issues.add(format!("{place}/{name}/{c}"), message);
        }
    }
}

/// Reports the first element that breaks a rule, and how many do.
fn check_role(
    document: &Document<'_>,
    data: &mut Data<'_>,
    (number, role, vertices): (usize, Role, u64),
    place: &str,
    issues: &mut Issues,
) {
    let accessor = &document.accessors[number];
    let restart = match accessor.component {
        5121 => 255.0,
        5123 => 65535.0,
        _ => f64::from(u32::MAX),
    };
    let mut found: BTreeMap<&str, (usize, f64, usize)> = BTreeMap::new();
    let mut before = f64::NEG_INFINITY;
    let length = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
    data.visit(document, number, false, |k, values| {
        let mut broken = |rule: &'static str, value: f64| found.entry(rule).or_insert((k, value, 0)).2 += 1;
        let is_unit = |length: f64| (length - 1.0).abs() <= UNIT_TOLERANCE;
        match role {
            Role::Unit | Role::Tangent => {
                let long = length(&values[..values.len().min(3)]);
                if !is_unit(long) {
                    broken("must have length 1, not", long);
                }
                if let Some(sign) = values.get(3).filter(|sign| role == Role::Tangent && sign.abs() != 1.0) {
                    broken("must have the sign 1 or -1 as its fourth number, not", *sign);
                }
            }
            Role::Clamped => {
                if let Some(v) = values.iter().find(|v| !(0.0..=1.0).contains(*v)) {
                    broken("must be from 0 to 1, not", *v);
                }
            }
            Role::Times => {
                if values[0] < 0.0 {
                    broken("must not be negative, as a time, but is", values[0]);
                }
                if values[0] <= before {
                    broken("must be more than the time before, but is", values[0]);
                }
                before = values[0];
            }
            Role::Rotations { splines } => {
                let long = length(values);
                if (!splines || k % 3 == 1) && !is_unit(long) {
                    broken("must be a rotation of length 1, not", long);
                }
            }
            Role::Affine => {
                let row = [(3, 0.0), (7, 0.0), (11, 0.0), (15, 1.0)];
                if let Some((c, _)) = row.iter().find(|(c, right)| values.get(*c).is_some_and(|v| v != right)) {
                    broken("must have the fourth row 0 0 0 1, but in it stands", values[*c]);
                }
            }
            Role::Indices => {
                if values[0] == restart {
                    broken("must not restart a primitive, as does", values[0]);
                } else if values[0] >= vertices as f64 {
                    broken("refers to a vertex that is not there:", values[0]);
                }
            }
        }
    });
    for (rule, (k, value, count)) in found {
        let count = if count > 1 { format!(", and so do {} more", count - 1) } else { String::new() };
        issues.add(place, format!("element {k} {rule} {value}{count}"));
    }
}

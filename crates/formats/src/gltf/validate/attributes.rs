//! Names and formats of vertex attributes (specification, 3.7.2.1 and 3.7.2.2; KHR_mesh_quantization).

use super::{
    Issues,
    document::{Accessor, Document, wrong_format},
};

/// Attribute semantic, parsed from its name.
#[derive(Clone, Copy, Debug)]
pub(super) enum Semantic<'a> {
    Single(&'a str),
    /// With a number after it.
    Indexed(&'a str, u64),
    /// Application-specific; its name begins with an underscore.
    Own,
}

impl<'a> Semantic<'a> {
    pub fn of(name: &'a str) -> Option<Self> {
        if name.starts_with('_') {
            return Some(Self::Own);
        }
        if matches!(name, "POSITION" | "NORMAL" | "TANGENT") {
            return Some(Self::Single(name));
        }
        let (semantic, set) = name.split_once('_')?;
        let is_number = set == "0" || !set.starts_with('0') && set.bytes().all(|b| b.is_ascii_digit());
        let is_known = matches!(semantic, "TEXCOORD" | "COLOR" | "JOINTS" | "WEIGHTS");
        (is_known && is_number).then_some(Self::Indexed(semantic, set.parse().ok()?))
    }

    pub fn can_morph(self) -> bool {
        !matches!(self, Self::Indexed("JOINTS" | "WEIGHTS", _))
    }
}

const FLOAT: (u64, bool) = (5126, false);
const UNSIGNED_NORMALIZED: [(u64, bool); 2] = [(5121, true), (5123, true)];
const SIGNED_NORMALIZED: [(u64, bool); 2] = [(5120, true), (5122, true)];
const INTEGERS: [(u64, bool); 4] = [(5120, false), (5121, false), (5122, false), (5123, false)];

/// Says so where an attribute has a format that it may not have.
pub(super) fn check_format(
    document: &Document<'_>,
    name: &str,
    accessor: &Accessor<'_>,
    is_morph: bool,
    place: &str,
    issues: &mut Issues,
) {
    if accessor.component == 5125 {
        issues.add(place, "vertex attributes cannot be UNSIGNED_INT");
        return;
    }
    let is_quantized = document.uses("KHR_mesh_quantization");
    let mut components = vec![FLOAT];
    let (kinds, right): (&[&str], &str) = match Semantic::of(name) {
        Some(Semantic::Single("TANGENT")) if !is_morph => (&["VEC4"], "VEC4 of FLOAT"),
        Some(Semantic::Single(_)) => (&["VEC3"], "VEC3 of FLOAT"),
        Some(Semantic::Indexed("TEXCOORD", _)) => (&["VEC2"], "VEC2 of FLOAT or normalized unsigned integers"),
        Some(Semantic::Indexed("COLOR", _)) => {
            (&["VEC3", "VEC4"], "VEC3 or VEC4 of FLOAT or normalized unsigned integers")
        }
        Some(Semantic::Indexed("JOINTS", _)) => (&["VEC4"], "VEC4 of UNSIGNED_BYTE or UNSIGNED_SHORT"),
        Some(Semantic::Indexed(..)) => (&["VEC4"], "VEC4 of FLOAT or normalized unsigned integers"),
        Some(Semantic::Own) | None => return,
    };
    match Semantic::of(name) {
        Some(Semantic::Indexed("JOINTS", _)) => components = vec![(5121, false), (5123, false)],
        Some(Semantic::Indexed(semantic, _)) => {
            components.extend(UNSIGNED_NORMALIZED);
            if is_morph || is_quantized && semantic == "TEXCOORD" {
                components.extend(SIGNED_NORMALIZED);
            }
            if is_quantized && semantic == "TEXCOORD" {
                components.extend(INTEGERS);
            }
        }
        Some(Semantic::Single("POSITION")) if is_quantized => {
            components.extend(INTEGERS);
            components.extend(SIGNED_NORMALIZED);
            components.extend(UNSIGNED_NORMALIZED);
        }
        Some(Semantic::Single(_)) if is_quantized => components.extend(SIGNED_NORMALIZED),
        _ => {}
    }
    if !accessor.is(kinds, &components) {
        wrong_format(issues, place, accessor, right);
    }
}

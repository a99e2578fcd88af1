//! Meshes: attributes, indices, morph targets, and what materials need of them.

use super::{
    Issues,
    attributes::{Semantic, check_format},
    document::{Document, index, list, number, wrong_format},
    usage::{Use, Uses},
};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Most sets of coordinates of a material that are looked for.
const MOST_SETS: usize = 16;

/// Vertex attributes that a material requires of its primitives.
struct Needs {
    /// Sets of texture coordinates, and the member of the material that needs each.
    sets: BTreeMap<u64, String>,
    tangents: bool,
}

pub(super) fn check(document: &Document<'_>, uses: &mut Uses, issues: &mut Issues) {
    let needs: Vec<Needs> = document.list("materials").iter().map(needs).collect();
    for (k, mesh) in document.list("meshes").iter().enumerate() {
        let place = format!("/meshes/{k}");
        let targets = list(mesh, "primitives").first().map_or(0, |p| list(p, "targets").len());
        for (n, primitive) in list(mesh, "primitives").iter().enumerate() {
            let place = format!("{place}/primitives/{n}");
            check_primitive(document, primitive, &place, uses, issues);
            let own = list(primitive, "targets").len();
            if own != targets {
                let place = if own == 0 { place.clone() } else { format!("{place}/targets") };
                issues.add(place, format!("{own} morph targets stand here, but the first primitive has {targets}"));
            }
            if let Some(needs) = index(primitive, "material").and_then(|m| needs.get(m)) {
                check_material(primitive, needs, &format!("{place}/material"), issues);
            }
            check_variants(primitive, &place, issues);
        }
        let weights = list(mesh, "weights").len();
        if mesh.get("weights").is_some() && weights != targets {
            issues.add(format!("{place}/weights"), format!("{weights} weights stand here for {targets} morph targets"));
        }
    }
}

/// Number of morph targets of a mesh.
pub(super) fn targets(mesh: &Value) -> usize {
    list(mesh, "primitives").first().map_or(0, |p| list(p, "targets").len())
}

fn check_primitive(document: &Document<'_>, primitive: &Value, place: &str, uses: &mut Uses, issues: &mut Issues) {
    let Some(attributes) = primitive["attributes"].as_object() else { return };
    let at = format!("{place}/attributes");
    let mut sets: BTreeMap<&str, BTreeSet<u64>> = BTreeMap::new();
    let mut count = document.accessor(&primitive["attributes"], "POSITION").map(|(_, a)| a.count);
    for (name, value) in attributes {
        let own = format!("{at}/{}", name.replace('~', "~0").replace('/', "~1"));
        match Semantic::of(name) {
            Some(Semantic::Indexed(semantic, set)) => drop(sets.entry(semantic).or_default().insert(set)),
            Some(_) => {}
            None => issues
                .add(&own, format!("'{}' is no name of an attribute; own names start with '_'", super::shown(name))),
        }
        let Some((number, accessor)) =
            value.as_u64().and_then(|v| Some((v as usize, document.accessors.get(v as usize)?)))
        else {
            continue;
        };
        uses.accessor(document, number, Use::Attribute, &own, issues);
        check_format(document, name, accessor, false, &own, issues);
        if name == "POSITION" && !document.has_bounds(number) {
            issues.add(&own, format!("accessor {number} holds positions and needs 'min' and 'max'"));
        }
        let first = *count.get_or_insert(accessor.count);
        if accessor.count != first {
            issues.add(&own, format!("{} elements stand here, but other attributes have {first}", accessor.count));
        }
    }
    for (semantic, met) in &sets {
        if met.last().is_some_and(|last| *last + 1 != met.len() as u64) {
            issues.add(&at, format!("the sets of '{semantic}' must be numbered from 0 without gaps"));
        }
    }
    let sets_of = |name: &str| sets.get(name).map_or(0, BTreeSet::len);
    let (joints, weights) = (sets_of("JOINTS"), sets_of("WEIGHTS"));
    if joints != weights {
        issues.add(&at, format!("there are {joints} sets of 'JOINTS', but {weights} of 'WEIGHTS'"));
    }
    if let Some((number, accessor)) = document.accessor(primitive, "indices") {
        let at = format!("{place}/indices");
        uses.accessor(document, number, Use::Indices, &at, issues);
        if !accessor.is(&["SCALAR"], &[(5121, false), (5123, false), (5125, false)]) {
            wrong_format(issues, &at, accessor, "SCALAR of UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT");
        }
    }
    for (k, target) in list(primitive, "targets").iter().enumerate() {
        check_target(document, primitive, target, &format!("{place}/targets/{k}"), uses, issues);
    }
}

fn check_target(
    document: &Document<'_>,
    primitive: &Value,
    target: &Value,
    place: &str,
    uses: &mut Uses,
    issues: &mut Issues,
) {
    for name in target.as_object().into_iter().flatten().map(|(name, _)| name) {
        let own = format!("{place}/{}", name.replace('~', "~0").replace('/', "~1"));
        if !Semantic::of(name).is_some_and(Semantic::can_morph) {
            issues.add(&own, format!("'{}' is no name of an attribute of a morph target", super::shown(name)));
        }
        let base = primitive["attributes"].get(name);
        if base.is_none() {
            issues.add(&own, "the primitive has no attribute of this name to morph");
        }
        let Some((number, accessor)) = document.accessor(target, name) else { continue };
        uses.accessor(document, number, Use::Attribute, &own, issues);
        check_format(document, name, accessor, true, &own, issues);
        if name == "POSITION" && !document.has_bounds(number) {
            issues.add(&own, format!("accessor {number} holds positions and needs 'min' and 'max'"));
        }
        if let Some((_, base)) = document.accessor(&primitive["attributes"], name)
            && base.count != accessor.count
        {
            issues.add(&own, format!("{} elements stand here, but the primitive has {}", accessor.count, base.count));
        }
    }
}

fn check_material(primitive: &Value, needs: &Needs, place: &str, issues: &mut Issues) {
    let attributes = &primitive["attributes"];
    for (set, member) in &needs.sets {
        if attributes.get(format!("TEXCOORD_{set}")).is_none() {
            issues.add(place, format!("'{member}' of the material needs the attribute 'TEXCOORD_{set}'"));
        }
    }
    if needs.tangents && (attributes.get("TANGENT").is_none() || attributes.get("NORMAL").is_none()) {
        issues.add(place, "the material needs the attributes 'NORMAL' and 'TANGENT', or a normal texture");
    }
}

fn needs(material: &Value) -> Needs {
    let mut sets = BTreeMap::new();
    let mut open = vec![("", material)];
    while let Some((name, value)) = open.pop() {
        let Some(members) = value.as_object() else { continue };
        if name.ends_with("Texture") && members.contains_key("index") && sets.len() < MOST_SETS {
            let transformed = value.pointer("/extensions/KHR_texture_transform/texCoord").and_then(Value::as_u64);
            sets.entry(transformed.unwrap_or_else(|| number(value, "texCoord"))).or_insert_with(|| name.to_owned());
        } else {
            open.extend(members.iter().filter(|(k, _)| *k != "extras").map(|(k, v)| (k.as_str(), v)));
        }
    }
    let extensions = &material["extensions"];
    let tangents = extensions["KHR_materials_clearcoat"].get("clearcoatNormalTexture").is_some()
        || extensions["KHR_materials_anisotropy"].is_object();
    Needs { sets, tangents: tangents && material.get("normalTexture").is_none() }
}

/// A variant has one material.
fn check_variants(primitive: &Value, place: &str, issues: &mut Issues) {
    let Some(extension) = primitive.pointer("/extensions/KHR_materials_variants") else { return };
    let mut met = BTreeSet::new();
    for (k, mapping) in list(extension, "mappings").iter().enumerate() {
        for (n, variant) in list(mapping, "variants").iter().enumerate() {
            if variant.as_u64().is_some_and(|v| !met.insert(v)) {
                let place = format!("{place}/extensions/KHR_materials_variants/mappings/{k}/variants/{n}");
                issues.add(place, format!("variant {variant} has a material already"));
            }
        }
    }
}

//! Joints and weights of vertices.

use super::{
    Issues,
    document::{Document, index, list},
    elements::Data,
};
use std::collections::{BTreeMap, HashSet};

/// Tolerance of the sum of joint weights, which should be 1.
const SUM_TOLERANCE: f64 = 1e-5;
/// Most sets that are looked at.
const MOST_SETS: usize = 4;

pub(super) fn check(document: &Document<'_>, data: &mut Data<'_>, issues: &mut Issues) {
    // The least number of joints of the skins that each mesh is used with.
    let mut joints_of: BTreeMap<usize, usize> = BTreeMap::new();
    for node in document.list("nodes") {
        if let (Some(mesh), Some((_, skin))) = (index(node, "mesh"), document.item(node, "skin", "skins")) {
            let joints = list(skin, "joints").len();
            joints_of.entry(mesh).and_modify(|least| *least = joints.min(*least)).or_insert(joints);
        }
    }
    let mut known = HashSet::new();
    for (k, mesh) in document.list("meshes").iter().enumerate() {
        let limit = joints_of.get(&k).copied().unwrap_or(usize::MAX);
        for (n, primitive) in list(mesh, "primitives").iter().enumerate() {
            let attributes = &primitive["attributes"];
            let sets = |name: &str| -> Vec<usize> {
                (0..MOST_SETS).map_while(|s| Some(document.accessor(attributes, &format!("{name}_{s}"))?.0)).collect()
            };
            let (joints, weights) = (sets("JOINTS"), sets("WEIGHTS"));
            if !joints.is_empty()
                && joints.len() == weights.len()
                && known.insert((joints.clone(), weights.clone(), limit))
            {
                let place = format!("/meshes/{k}/primitives/{n}/attributes");
                check_sets(document, data, (&joints, &weights, limit), &place, issues);
            }
        }
    }
}

fn check_sets(
    document: &Document<'_>,
    data: &mut Data<'_>,
    (joints, weights, limit): (&[usize], &[usize], usize),
    place: &str,
    issues: &mut Issues,
) {
    let mut read = |accessor: usize| -> Option<Vec<[f32; 4]>> {
        let mut values = Vec::new();
        let keep = |_: usize, v: &[f64]| values.push(std::array::from_fn(|k| v.get(k).copied().unwrap_or(0.0) as f32));
        data.visit(document, accessor, false, keep)?;
        Some(values)
    };
    let all = |read: &mut dyn FnMut(usize) -> Option<Vec<[f32; 4]>>, sets: &[usize]| -> Option<Vec<Vec<[f32; 4]>>> {
        sets.iter().map(|s| read(*s)).collect()
    };
    let (Some(joints), Some(weights)) = (all(&mut read, joints), all(&mut read, weights)) else { return };
    let count = joints.iter().chain(&weights).map(Vec::len).min().unwrap_or(0);
    let mut found: BTreeMap<(String, &str), (usize, f64, usize)> = BTreeMap::new();
    for k in 0..count {
        let mut broken = |name: &str, set: usize, rule: &'static str, value: f64| {
            found.entry((format!("{place}/{name}_{set}"), rule)).or_insert((k, value, 0)).2 += 1;
        };
        let mut sum = 0.0;
        let mut met: Vec<f32> = Vec::new();
        for set in 0..joints.len() {
            for (joint, weight) in joints[set][k].into_iter().zip(weights[set][k]) {
                sum += f64::from(weight);
                if weight < 0.0 {
                    broken("WEIGHTS", set, "has a negative weight,", weight.into());
                }
                if joint as usize >= limit {
                    broken("JOINTS", set, "refers to a joint that its skin does not have:", joint.into());
                }
                if weight != 0.0 && met.contains(&joint) {
                    broken("JOINTS", set, "has a joint twice:", joint.into());
                }
                met.push(if weight == 0.0 { -1.0 } else { joint });
            }
        }
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            broken("WEIGHTS", 0, "must have weights of the sum 1, not", sum);
        }
    }
    for ((place, rule), (k, value, count)) in found {
        let count = if count > 1 { format!(", and so do {} more", count - 1) } else { String::new() };
        issues.add(place, format!("element {k} {rule} {value}{count}"));
    }
}

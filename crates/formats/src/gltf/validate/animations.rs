//! Animations: what channels move, and the key frames of their samplers.

use super::{
    Issues,
    document::{Document, list, wrong_format},
    meshes,
    usage::{Use, Uses},
};
use serde_json::Value;
use std::collections::HashMap;

const NUMBERS: &[(u64, bool)] = &[(5126, false), (5120, true), (5121, true), (5122, true), (5123, true)];

pub(super) fn check(document: &Document<'_>, uses: &mut Uses, issues: &mut Issues) {
    // Whether each output has been used for splines.
    let mut splines: HashMap<usize, bool> = HashMap::new();
    for (k, animation) in document.list("animations").iter().enumerate() {
        let samplers = list(animation, "samplers");
        for (n, sampler) in samplers.iter().enumerate() {
            let place = format!("/animations/{k}/samplers/{n}");
            check_input(document, sampler, &format!("{place}/input"), uses, issues);
            if let Some((number, _)) = document.accessor(sampler, "output") {
                let place = format!("{place}/output");
                uses.accessor(document, number, Use::AnimationOutput, &place, issues);
                if *splines.entry(number).or_insert(is_spline(sampler)) != is_spline(sampler) {
                    issues.add(
                        place,
                        format!("accessor {number} cannot hold splines and values of other samplers at once"),
                    );
                }
            }
        }
        let mut targets = HashMap::new();
        for (n, channel) in list(animation, "channels").iter().enumerate() {
            let place = format!("/animations/{k}/channels/{n}");
            check_target(document, &channel["target"], &format!("{place}/target"), issues);
            if let Some(key) = key(&channel["target"]) {
                let first = *targets.entry(key).or_insert(n);
                if first != n {
                    issues.add(
                        format!("{place}/target"),
                        format!("channel {first} of this animation has the same target"),
                    );
                }
            }
            let Some(number) = channel["sampler"].as_u64() else { continue };
            match samplers.get(number as usize) {
                Some(sampler) => check_output(document, sampler, channel, &format!("{place}/sampler"), issues),
                None => issues.add(
                    format!("{place}/sampler"),
                    format!("there is no samplers[{number}] in this animation: there are {}", samplers.len()),
                ),
            }
        }
    }
}

fn is_spline(sampler: &Value) -> bool {
    sampler["interpolation"] == "CUBICSPLINE"
}

/// Identity of a channel's target: node and path, or an animation pointer.
fn key(target: &Value) -> Option<(u64, &str)> {
    match target.pointer("/extensions/KHR_animation_pointer/pointer").and_then(Value::as_str) {
        Some(pointer) => Some((u64::MAX, pointer)),
        None => Some((target["node"].as_u64()?, target["path"].as_str()?)),
    }
}

fn check_target(document: &Document<'_>, target: &Value, place: &str, issues: &mut Issues) {
    let path = target["path"].as_str().unwrap_or_default();
    if let Some(pointer) = target.pointer("/extensions/KHR_animation_pointer") {
        let place = format!("{place}/extensions/KHR_animation_pointer");
        if target.get("node").is_some() {
            issues.add(&place, "a target with this extension has no 'node'");
        }
        if path != "pointer" {
            issues.add(&place, "a target with this extension has the path 'pointer'");
        }
        if pointer["pointer"].as_str().is_some_and(|p| !p.starts_with('/') && !p.is_empty()) {
            issues.add(format!("{place}/pointer"), "a JSON pointer begins with '/'");
        }
        return;
    }
    let Some((number, node)) = document.item(target, "node", "nodes") else { return };
    if path != "weights" && node.get("matrix").is_some() {
        issues
            .add(place, format!("node {number} has a matrix: its translation, rotation and scale cannot be animated"));
    }
    let morphs = document.item(node, "mesh", "meshes").map_or(0, |(_, mesh)| meshes::targets(mesh));
    if path == "weights" && morphs == 0 {
        issues.add(place, format!("node {number} has no morph targets whose weights could be animated"));
    }
}

fn check_input(document: &Document<'_>, sampler: &Value, place: &str, uses: &mut Uses, issues: &mut Issues) {
    let Some((number, accessor)) = document.accessor(sampler, "input") else { return };
    uses.accessor(document, number, Use::AnimationInput, place, issues);
    if !accessor.is(&["SCALAR"], &[(5126, false)]) {
        wrong_format(issues, place, accessor, "SCALAR of FLOAT");
    }
    if !document.has_bounds(number) {
        issues.add(place, format!("accessor {number} holds times and needs 'min' and 'max'"));
    }
    if is_spline(sampler) && accessor.count < 2 {
        issues.add(place, format!("a spline has at least 2 key frames, not {}", accessor.count));
    }
}

/// The output has the format that the target needs, and values for each key frame.
fn check_output(document: &Document<'_>, sampler: &Value, channel: &Value, place: &str, issues: &mut Issues) {
    let Some((_, output)) = document.accessor(sampler, "output") else { return };
    let target = &channel["target"];
    let (is_right, right, each) = match target["path"].as_str() {
        Some("translation" | "scale") => (output.is(&["VEC3"], &[(5126, false)]), "VEC3 of FLOAT", 1),
        Some("rotation") => (output.is(&["VEC4"], NUMBERS), "VEC4 of FLOAT or normalized integers", 1),
        Some("weights") => {
            let mesh = document.item(target, "node", "nodes").and_then(|(_, n)| document.item(n, "mesh", "meshes"));
            let each = mesh.map_or(0, |(_, mesh)| meshes::targets(mesh));
            (output.is(&["SCALAR"], NUMBERS), "SCALAR of FLOAT or normalized integers", each as u64)
        }
        _ => return,
    };
    if !is_right {
        wrong_format(issues, place, output, right);
    }
    let Some((_, input)) = document.accessor(sampler, "input") else { return };
    let expected = input.count.saturating_mul(if is_spline(sampler) { 3 } else { 1 }).saturating_mul(each);
    if expected > 0 && output.count != expected {
        issues.add(
            place,
            format!("{} values stand in the output for {expected} of {} key frames", output.count, input.count),
        );
    }
}

//! Poses the scene: what animations say of a moment replaces the values of the document (glTF 2.0, 3.11;
//! KHR_animation_pointer).

use super::{Reader, json::At};
use serde_json::{Value, json};
use steradian_scene::Animation;

/// Property set by an animation channel: its JSON pointer and value.
type Change = (String, Value);

/// Replaces animated values by those at the moment that `-D at=SECONDS` names, or `later`, seconds; without it the
/// scene stays as it stands in the document.
pub(super) fn pose(reader: &mut Reader<'_>, root: &mut Value, later: f64) {
    let at = At::root(root);
    let Some(time) = seconds(reader, &at, "at") else { return };
    let time = time + later;
    let wanted = reader.options.defines.get("animation").cloned();
    let mut changes: Vec<Change> = Vec::new();
    let mut found = wanted.is_none();
    for animation in at.list("animations") {
        if wanted.as_ref().is_some_and(|w| animation.label().as_ref() != Some(w)) {
            continue;
        }
        found = true;
        for channel in animation.list("channels") {
            changes.extend(change(reader, &at, &animation, &channel, time));
        }
    }
    if !found {
        let names: Vec<_> = at.list("animations").filter_map(|a| a.label()).collect();
        reader.error(
            &at,
            format!("there is no animation '{}'; there are: {}", wanted.unwrap_or_default(), names.join(", ")),
        );
    }
    for (pointer, value) in changes {
        set(root, &pointer, value);
    }
}

/// The animations of a document.
pub(super) fn list(reader: &mut Reader<'_>, root: &At<'_>) -> Vec<Animation> {
    let mut animations = Vec::new();
    for animation in root.list("animations") {
        let mut times = [f64::INFINITY, f64::NEG_INFINITY];
        for sampler in animation.list("samplers") {
            // Faults are told where the animation is used.
            let said = reader.import.diagnostics.clone();
            let keys = reader.floats::<1>(root, &sampler, "input").unwrap_or_default();
            reader.import.diagnostics = said;
            for t in keys.as_flattened().iter().map(|t| f64::from(*t)).filter(|t| t.is_finite()) {
                times = [times[0].min(t), times[1].max(t)];
            }
        }
        if times[0] <= times[1] {
            let channels = animation.list("channels").count();
            let name = animation.text("name").map(str::to_owned);
            animations.push(Animation { name, times, channels });
        }
    }
    animations
}

/// Exposure time in seconds, from `-D shutter=SECONDS`.
pub(super) fn shutter(reader: &mut Reader<'_>, root: &At<'_>) -> Option<f64> {
    let shutter = seconds(reader, root, "shutter")?;
    if reader.options.defines.contains_key("at") && shutter >= 0.0 {
        return Some(shutter).filter(|s| *s > 0.0);
    }
    reader.error(
        root,
        "'shutter' is how long the picture of the moment 'at' is exposed, seconds: it needs -D at=SECONDS",
    );
    None
}

/// A define that is a time.
fn seconds(reader: &mut Reader<'_>, root: &At<'_>, name: &str) -> Option<f64> {
    let text = reader.options.defines.get(name)?.clone();
    let time = text.trim().trim_end_matches('s').parse::<f64>().ok().filter(|t| t.is_finite());
    if time.is_none() {
        reader.error(root, format!("'{name}={text}' is not a time in seconds"));
    }
    time
}

/// Property and value set by a channel; `None` where it targets nothing, or after a fault was reported.
fn change(reader: &mut Reader<'_>, root: &At<'_>, animation: &At<'_>, channel: &At<'_>, time: f64) -> Option<Change> {
    let target = channel.get("target")?;
    let path = target.text("path")?;
    let pointer = if path == "pointer" {
        let pointer = target.extension("KHR_animation_pointer")?.text("pointer")?.to_owned();
        pointer.starts_with('/').then_some(pointer)?
    } else {
        target.get("node")?;
        let (node, _) = reader.index(root, &target, "node", "nodes")?;
        format!("/nodes/{node}/{path}")
    };
    let number = channel.get("sampler").and_then(|s| s.value.as_u64()).and_then(|s| usize::try_from(s).ok());
    let sampler = number.and_then(|n| animation.get("samplers")?.item(n));
    let Some(sampler) = sampler else {
        reader.error(channel, "this channel has no sampler");
        return None;
    };
    let times: Vec<f32> = reader.floats::<1>(root, &sampler, "input")?.into_iter().map(|[t]| t).collect();
    if times.is_empty() || times.windows(2).any(|w| w[0] > w[1]) {
        reader.error(&sampler, "the times of key frames must increase");
        return None;
    }
    let (_, output) = reader.index(root, &sampler, "output", "accessors")?;
    let (values, width) = match output.text("type") {
        Some("SCALAR") => (reader.floats::<1>(root, &sampler, "output")?.into_flattened(), 1),
        Some("VEC2") => (reader.floats::<2>(root, &sampler, "output")?.into_flattened(), 2),
        Some("VEC3") => (reader.floats::<3>(root, &sampler, "output")?.into_flattened(), 3),
        _ => (reader.floats::<4>(root, &sampler, "output")?.into_flattened(), 4),
    };
    let interpolation = sampler.text("interpolation").unwrap_or("LINEAR");
    let per_key = if interpolation == "CUBICSPLINE" { 3 } else { 1 };
    // Weights of morph targets: several numbers for each key.
    let width = if path == "weights" { values.len() / (times.len() * per_key) } else { width };
    if width == 0 || values.len() != times.len() * per_key * width {
        let message = format!("{} numbers are no {} key frames", values.len(), times.len());
        reader.error(&sampler, message);
        return None;
    }
    let is_rotation = path == "rotation" || pointer.ends_with("/rotation");
    let result = sample(&times, &values, width, interpolation, is_rotation, time);
    let value = if width == 1 && path != "weights" { json!(result[0]) } else { json!(result) };
    Some((pointer, value))
}

/// The value at a time, held beyond the first and last key.
fn sample(times: &[f32], values: &[f32], width: usize, interpolation: &str, is_rotation: bool, time: f64) -> Vec<f64> {
    let is_cubic = interpolation == "CUBICSPLINE";
    let per_key = if is_cubic { 3 * width } else { width };
    let key = |k: usize, part: usize| -> Vec<f64> {
        let start = k * per_key + part * width;
        values[start..start + width].iter().map(|v| f64::from(*v)).collect()
    };
    let middle = usize::from(is_cubic);
    let next = times.partition_point(|t| f64::from(*t) <= time);
    if next == 0 {
        return key(0, middle);
    }
    if next == times.len() || interpolation == "STEP" {
        return key(next - 1, middle);
    }
    let (t0, t1) = (f64::from(times[next - 1]), f64::from(times[next]));
    let length = t1 - t0;
    let u = (time - t0) / length;
    let (a, b) = (key(next - 1, middle), key(next, middle));
    let mix = |f: &dyn Fn(usize) -> f64| (0..width).map(f).collect::<Vec<_>>();
    let result = if is_cubic {
        let (out, into) = (key(next - 1, 2), key(next, 0));
        let (u2, u3) = (u * u, u * u * u);
        mix(&|k| {
            (2.0 * u3 - 3.0 * u2 + 1.0) * a[k]
                + length * (u3 - 2.0 * u2 + u) * out[k]
                + (3.0 * u2 - 2.0 * u3) * b[k]
                + length * (u3 - u2) * into[k]
        })
    } else if is_rotation && width == 4 {
        let dot: f64 = (0..4).map(|k| a[k] * b[k]).sum();
        let (sign, angle) = (dot.signum(), dot.abs().min(1.0).acos());
        if angle.sin() < 1e-6 {
            mix(&|k| a[k] + (sign * b[k] - a[k]) * u)
        } else {
            let (wa, wb) = (((1.0 - u) * angle).sin() / angle.sin(), sign * (u * angle).sin() / angle.sin());
            mix(&|k| wa * a[k] + wb * b[k])
        }
    } else {
        mix(&|k| a[k] + (b[k] - a[k]) * u)
    };
    if is_rotation && width == 4 {
        let norm = result.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-30);
        return result.into_iter().map(|v| v / norm).collect();
    }
    result
}

/// Sets a value, making the objects on the way; arrays are not lengthened.
fn set(root: &mut Value, pointer: &str, value: Value) {
    let mut at = root;
    for token in pointer.split('/').skip(1) {
        let token = token.replace("~1", "/").replace("~0", "~");
        at = match at {
            Value::Array(items) => match token.parse().ok().and_then(|k: usize| items.get_mut(k)) {
                Some(item) => item,
                None => return,
            },
            Value::Object(members) => members.entry(token).or_insert(Value::Null),
            Value::Null => {
                *at = json!({});
                match at.as_object_mut() {
                    Some(members) => members.entry(token).or_insert(Value::Null),
                    None => return,
                }
            }
            _ => return,
        };
    }
    *at = value;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_frames_are_interpolated() {
        let (times, values) = ([0.0, 1.0, 3.0], [0.0, 10.0, 30.0]);
        let at = |kind: &str, t: f64| sample(&times, &values, 1, kind, false, t)[0];
        assert_eq!(
            (at("LINEAR", -1.0), at("LINEAR", 0.25), at("LINEAR", 2.0), at("LINEAR", 9.0)),
            (0.0, 2.5, 20.0, 30.0)
        );
        assert_eq!((at("STEP", 0.99), at("STEP", 1.0)), (0.0, 10.0));
        // Hermite: equal slopes of 1 through (0, 0) and (1, 1) are a line.
        let line = [1.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        assert!((sample(&[0.0, 1.0], &line, 1, "CUBICSPLINE", false, 0.3)[0] - 0.3).abs() < 1e-6);
        // Half way between no turn and a quarter turn about z; the longer way round is not taken.
        let h = std::f32::consts::FRAC_1_SQRT_2;
        for sign in [1.0, -1.0] {
            let turns = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, sign * h, sign * h];
            let q = sample(&[0.0, 1.0], &turns, 4, "LINEAR", true, 0.5);
            assert!((q[2] - (std::f64::consts::PI / 8.0).sin()).abs() < 1e-6, "{q:?}");
        }
    }

    #[test]
    fn pointers_set_values() {
        let mut root = json!({ "nodes": [{}, { "rotation": [0, 0, 0, 1] }] });
        set(&mut root, "/nodes/0/translation", json!([1.0, 2.0, 3.0]));
        set(&mut root, "/nodes/1/extensions/KHR_x/a~1b", json!(5));
        set(&mut root, "/nodes/7/scale", json!(1));
        assert_eq!(root["nodes"][0]["translation"][1], 2.0);
        assert_eq!(root["nodes"][1]["extensions"]["KHR_x"]["a/b"], 5);
    }
}

//! Values of parameters: from items, and back to text.

use super::parse::{Item, Kind, is_word};
use std::fmt::Write;
use steradian_math::{DVec3, Transform};
use steradian_scene::{ColorSpace, NodeId, Span, SpectrumValue, Value};

/// Names of colour spaces.
const SPACES: [(&str, ColorSpace); 4] = [
    ("srgb", ColorSpace::Srgb),
    ("dci-p3", ColorSpace::DciP3),
    ("rec2020", ColorSpace::Rec2020),
    ("aces", ColorSpace::Aces),
];

/// The parameter whose lists are whole numbers.
const WHOLE: &str = "crop";

/// First keys of the maps that are values.
pub(super) const VALUES: [&str; 15] = [
    "rgb",
    "spectrum",
    "wavelengths",
    "blackbody",
    "file",
    "floats",
    "ints",
    "matrix",
    "translate",
    "scale",
    "rotate",
    "yaw_pitch_roll",
    "shear",
    "look_at",
    "ref",
];

/// A fault with its place and advice.
pub(super) type Slip = (String, Span);

fn slip<T>(item: &Item, wanted: &str) -> Result<T, Slip> {
    Err((format!("{wanted} is expected here, not {}", item.kind.noun()), item.span))
}

pub(super) fn number(item: &Item) -> Result<f64, Slip> {
    match item.kind {
        Kind::Int(v) => Ok(v as f64),
        Kind::Float(v) => Ok(v),
        _ => slip(item, "a number"),
    }
}

pub(super) fn numbers(item: &Item) -> Result<Vec<f64>, Slip> {
    match &item.kind {
        Kind::List(items) => items.iter().map(number).collect(),
        _ => slip(item, "a list of numbers"),
    }
}

pub(super) fn text(item: &Item) -> Result<&str, Slip> {
    match &item.kind {
        Kind::Text(text) => Ok(text),
        _ => slip(item, "a text"),
    }
}

pub(super) fn array<const N: usize>(item: &Item) -> Result<[f64; N], Slip> {
    let found = numbers(item)?;
    let n = found.len();
    found.try_into().map_err(|_| (format!("{N} numbers are expected here, not {n}"), item.span))
}

/// A colour by its three numbers.
pub(super) fn color(name: &str, item: &Item) -> Result<Value, Slip> {
    let found = numbers(item)?;
    let rgb = <[f64; 3]>::try_from(found)
        .map_err(|found| (format!("'{name}' takes a colour of 3 numbers, not a list of {}", found.len()), item.span))?;
    Ok(Value::Spectrum(SpectrumValue::Rgb(rgb, ColorSpace::Srgb)))
}

/// A value that refers to nothing: all but nodes and files.
pub(super) fn plain(name: &str, item: &Item) -> Result<Value, Slip> {
    Ok(match &item.kind {
        Kind::Null => return slip(item, "a value"),
        Kind::Bool(v) => Value::Bool(*v),
        Kind::Int(v) => Value::Int(*v),
        Kind::Float(v) => Value::Float(*v),
        Kind::Text(v) => Value::String(v.clone()),
        Kind::List(items) if is_transform(items) => Value::Transform(transform(item)?),
        Kind::List(_) if name == WHOLE => Value::Ints(whole(item)?),
        Kind::List(items) if items.len() == 3 => Value::Vec3(array(item)?),
        Kind::List(_) => Value::Floats(numbers(item)?),
        Kind::Map(pairs) => {
            let Some((key, first)) = pairs.first() else { return slip(item, "a value") };
            let known: &[&str] = match key.text.as_str() {
                "rgb" => &["rgb", "space"],
                "wavelengths" => &["wavelengths", "values"],
                "rotate" => &["rotate", "degrees"],
                "look_at" => &["look_at", "from", "up"],
                "spectrum" | "blackbody" | "floats" | "ints" | "matrix" | "translate" | "scale" | "yaw_pitch_roll"
                | "shear" => &[key.text.as_str()],
                other => {
                    let hint = steradian_scene::names::did_you_mean(other, VALUES).unwrap_or_default();
                    let known = VALUES.join(", ");
                    return Err((format!("'{other}' begins no kind of value; known are {known} {hint}"), key.span));
                }
            };
            if let Some((key, _)) = pairs.iter().find(|(k, _)| !known.contains(&k.text.as_str())) {
                return Err((format!("'{}' does not belong here; known are {}", key.text, known.join(", ")), key.span));
            }
            let second = |name: &str| pairs.iter().find(|(k, _)| k.text == name).map(|(_, item)| item);
            match key.text.as_str() {
                "rgb" => {
                    let space = match second("space") {
                        None => ColorSpace::Srgb,
                        Some(item) => {
                            let named = text(item)?;
                            let found = SPACES.iter().find(|(name, _)| *name == named);
                            let names = SPACES.map(|(name, _)| name).join(", ");
                            found.ok_or_else(|| (format!("no colour space '{named}'; known are {names}"), item.span))?.1
                        }
                    };
                    Value::Spectrum(SpectrumValue::Rgb(array(first)?, space))
                }
                "spectrum" => Value::Spectrum(match &first.kind {
                    Kind::Text(name) => SpectrumValue::Named(name.clone()),
                    _ => SpectrumValue::Constant(number(first)?),
                }),
                "wavelengths" => {
                    let Some(values) = second("values") else {
                        return Err(("'wavelengths' lacks its 'values'".into(), key.span));
                    };
                    let single = |item| numbers(item).map(|v| v.into_iter().map(|v| v as f32).collect::<Vec<_>>());
                    let (lambdas, values) = (single(first)?, single(values)?);
                    if lambdas.len() != values.len() || !lambdas.windows(2).all(|w| w[0] < w[1]) || lambdas.is_empty() {
                        let why = "as many values as wavelengths are expected, and wavelengths that grow";
                        return Err((why.into(), item.span));
                    }
                    Value::Spectrum(SpectrumValue::Sampled { lambdas, values })
                }
                "blackbody" => Value::Spectrum(SpectrumValue::Blackbody(number(first)?)),
                "floats" => Value::Floats(numbers(first)?),
                "ints" => Value::Ints(whole(first)?),
                _ => Value::Transform(transform(item)?),
            }
        }
    })
}

fn whole(item: &Item) -> Result<Vec<i64>, Slip> {
    let Kind::List(items) = &item.kind else { return slip(item, "a list of whole numbers") };
    let one = |item: &Item| match item.kind {
        Kind::Int(v) => Ok(v),
        _ => slip(item, "a whole number"),
    };
    items.iter().map(one).collect()
}

fn is_transform(items: &[Item]) -> bool {
    const STEPS: [&str; 7] = ["matrix", "translate", "scale", "rotate", "yaw_pitch_roll", "shear", "look_at"];
    let first = match items.first().map(|item| &item.kind) {
        Some(Kind::Map(pairs)) => pairs.first(),
        _ => None,
    };
    first.is_some_and(|(key, _)| STEPS.contains(&key.text.as_str()))
}

/// One map, or a list of maps of which the first is applied first.
pub(super) fn transform(item: &Item) -> Result<Transform, Slip> {
    let steps = match &item.kind {
        Kind::List(items) => items.as_slice(),
        _ => std::slice::from_ref(item),
    };
    // The first one as it is: a product with the identity would lose the signs of zeros.
    let Some((first, others)) = steps.split_first() else { return Ok(Transform::IDENTITY) };
    let all = others.iter().try_fold(step(first)?, |all, item| Ok::<_, Slip>(step(item)? * all))?;
    if all.is_finite() { Ok(all) } else { Err(("this transform is not finite".into(), item.span)) }
}

fn step(item: &Item) -> Result<Transform, Slip> {
    let wanted = "'translate', 'scale', 'rotate', 'yaw_pitch_roll', 'shear', 'look_at' or 'matrix'";
    let Kind::Map(pairs) = &item.kind else { return slip(item, wanted) };
    let Some((key, first)) = pairs.first() else { return slip(item, wanted) };
    let other = |name: &str| pairs.iter().find(|(k, _)| k.text == name).map(|(_, item)| item);
    let missing = |name: &str| (format!("'{}' lacks its '{name}'", key.text), key.span);
    Ok(match key.text.as_str() {
        "matrix" => Transform::from_rows(array(first)?),
        "translate" => Transform::translate(array(first)?.into()),
        "scale" => Transform::scale(match &first.kind {
            Kind::List(_) => array(first)?.into(),
            _ => DVec3::splat(number(first)?),
        }),
        "rotate" => {
            let degrees = number(other("degrees").ok_or_else(|| missing("degrees"))?)?;
            let axis = DVec3::from(array(first)?);
            if axis.try_normalize().is_none() {
                return Err(("this axis has no direction".into(), first.span));
            }
            Transform::rotate(axis, degrees.to_radians())
        }
        "yaw_pitch_roll" => {
            let [yaw, pitch, roll] = array(first)?.map(f64::to_radians);
            Transform::yaw_pitch_roll(yaw, pitch, roll)
        }
        "shear" => {
            let [xy, xz, yx, yz, zx, zy] = array(first)?;
            let rows = [[1.0, xy, xz, 0.0], [yx, 1.0, yz, 0.0], [zx, zy, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
            let sheared = Transform::from_rows(std::array::from_fn(|i| rows[i / 4][i % 4]));
            if sheared.inverse().is_none() {
                return Err(("this shear leaves no volume".into(), first.span));
            }
            sheared
        }
        "look_at" => {
            let from = array(other("from").ok_or_else(|| missing("from"))?)?;
            let up = other("up").map_or(Ok([0.0, 1.0, 0.0]), array)?;
            Transform::look_at(from.into(), array(first)?.into(), up.into())
                .ok_or_else(|| ("'from', the target and 'up' do not span a plane".into(), item.span))?
        }
        other => return Err((format!("{wanted} is expected here, not '{other}'"), key.span)),
    })
}

/// The text of a value; nodes are written by `node`.
pub(super) fn write(out: &mut String, name: &str, value: &Value, node: &mut dyn FnMut(&mut String, NodeId)) {
    let list = |out: &mut String, v: &[f64]| float_list(out, v.iter().copied());
    match value {
        Value::Bool(v) => push(out, v),
        Value::Int(v) => push(out, v),
        Value::Float(v) => float(out, *v),
        Value::String(v) => string(out, v),
        Value::Path(v) => {
            out.push_str("{file: ");
            string(out, &v.to_string_lossy());
            out.push('}');
        }
        Value::Vec3(v) => list(out, v),
        Value::Floats(v) if v.len() == 3 || name == WHOLE => {
            out.push_str("{floats: ");
            list(out, v);
            out.push('}');
        }
        Value::Floats(v) => list(out, v),
        Value::Ints(v) if name == WHOLE => int_list(out, v),
        Value::Ints(v) => {
            out.push_str("{ints: ");
            int_list(out, v);
            out.push('}');
        }
        Value::Transform(t) => matrix(out, t),
        Value::Spectrum(s) => spectrum(out, s),
        Value::Node(id) => node(out, *id),
        Value::Nodes(ids) => {
            out.push('[');
            for (i, id) in ids.iter().enumerate() {
                out.push_str(if i > 0 { ", " } else { "" });
                node(out, *id);
            }
            out.push(']');
        }
    }
}

fn spectrum(out: &mut String, s: &SpectrumValue) {
    match s {
        SpectrumValue::Constant(v) => {
            out.push_str("{spectrum: ");
            float(out, *v);
        }
        SpectrumValue::Named(v) => {
            out.push_str("{spectrum: ");
            string(out, v);
        }
        SpectrumValue::Rgb(rgb, space) => {
            out.push_str("{rgb: ");
            float_list(out, rgb.iter().copied());
            if let Some((name, _)) = SPACES[1..].iter().find(|s| s.1 == *space) {
                out.push_str(", space: ");
                out.push_str(name);
            }
        }
        SpectrumValue::Sampled { lambdas, values } => {
            out.push_str("{wavelengths: ");
            single_list(out, lambdas.iter().copied());
            out.push_str(", values: ");
            single_list(out, values.iter().copied());
        }
        SpectrumValue::Blackbody(v) => {
            out.push_str("{blackbody: ");
            float(out, *v);
        }
    }
    out.push('}');
}

pub(super) fn matrix(out: &mut String, t: &Transform) {
    out.push_str("{matrix: ");
    float_list(out, t.matrix.transpose().to_cols_array().into_iter());
    out.push('}');
}

fn push(out: &mut String, v: impl std::fmt::Display) {
    let _ = write!(out, "{v}");
}

/// The shortest number that reads as the same, always with a mark of a real number.
fn float(out: &mut String, v: f64) {
    if v.is_nan() {
        out.push_str("null");
    } else if v.is_infinite() {
        out.push_str(if v > 0.0 { "1e999" } else { "-1e999" });
    } else {
        let _ = write!(out, "{v:?}");
    }
}

/// The shortest number of an element of a list, where whole numbers need no mark.
fn bare(out: &mut String, v: f64) {
    if v.fract() == 0.0 && v.abs() < 1e15 && !(v == 0.0 && v.is_sign_negative()) {
        let _ = write!(out, "{v:.0}");
    } else {
        float(out, v);
    }
}

pub(super) fn float_list(out: &mut String, values: impl Iterator<Item = f64>) {
    out.push('[');
    for (i, v) in values.enumerate() {
        out.push_str(if i > 0 { ", " } else { "" });
        bare(out, v);
    }
    out.push(']');
}

/// Numbers of single precision, as short as these need.
pub(super) fn single_list(out: &mut String, values: impl Iterator<Item = f32>) {
    out.push('[');
    for (i, v) in values.enumerate() {
        out.push_str(if i > 0 { ", " } else { "" });
        if v.fract() == 0.0 && v.abs() < 1e7 || !v.is_finite() {
            bare(out, f64::from(v));
        } else {
            // Read in double precision and rounded again: the shortest digits may be too few for that.
            let short = format!("{v:?}");
            match short.parse::<f64>() {
                Ok(read) if read as f32 == v => out.push_str(&short),
                _ => float(out, f64::from(v)),
            }
        }
    }
    out.push(']');
}

pub(super) fn int_list(out: &mut String, values: &[i64]) {
    let words: Vec<String> = values.iter().map(i64::to_string).collect();
    let _ = write!(out, "[{}]", words.join(", "));
}

/// A text: bare where it is a word, else in quotes.
pub(super) fn string(out: &mut String, v: &str) {
    if is_word(v.as_bytes()) && !matches!(v, "true" | "false" | "null") {
        out.push_str(v);
    } else {
        quoted(out, v);
    }
}

pub(super) fn quoted(out: &mut String, v: &str) {
    out.push('"');
    for c in v.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if (c as u32) < 32 => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
}

//! A material at a glance, as text: its parameters and a summary of what it does.

use crate::failure::Failure;
use serde::Serialize;
use std::fmt::Write;
use steradian::{
    instruments::summary::Summary,
    scene::{Family, Node, SceneDesc, SpectrumValue, Value, names},
    schema::{Parameter, Type},
};

/// A parameter and its value, as text.
#[derive(Debug, Serialize)]
pub struct Setting {
    name: &'static str,
    value: String,
    is_default: bool,
    default: &'static str,
    unit: &'static str,
    range: [Option<f64>; 2],
    values: String,
    meaning: String,
    #[serde(skip)]
    limits: String,
}

/// Everyday names of materials, with the kinds and parameters that they stand for here.
const EVERYDAY: [(&str, &str); 16] = [
    ("gold", "conductor -p eta=metal-Au-eta k=metal-Au-k alpha_u=0.2"),
    ("silver", "conductor -p eta=metal-Ag-eta k=metal-Ag-k alpha_u=0.2"),
    ("copper", "conductor -p eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.2"),
    ("aluminium", "conductor -p eta=metal-Al-eta k=metal-Al-k alpha_u=0.2"),
    ("aluminum", "conductor -p eta=metal-Al-eta k=metal-Al-k alpha_u=0.2"),
    ("brass", "conductor -p eta=metal-CuZn-eta k=metal-CuZn-k alpha_u=0.2"),
    ("metal", "conductor -p eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.2"),
    ("mirror", "conductor"),
    ("glass", "dielectric -p eta=1.5"),
    ("water", "dielectric -p eta=1.33"),
    ("matte", "diffuse -p reflectance=0.8"),
    ("matt", "diffuse -p reflectance=0.8"),
    ("lambertian", "diffuse -p reflectance=0.8"),
    ("paint", "plastic -p diffuse_reflectance=0.7,0.1,0.1 alpha_u=0.2"),
    ("skin", "subsurface"),
    ("fabric", "principled -p sheen=1"),
];

/// Refuses an unknown kind of material.
///
/// # Errors
/// Where it is not: with the nearest kind, or the kind that an everyday name means.
pub fn known(name: &str) -> Result<(), Failure> {
    let kinds = || Family::Material.kinds();
    if kinds().any(|k| k == name) {
        return Ok(());
    }
    let folded = name.to_lowercase();
    let everyday = EVERYDAY.iter().find(|e| e.0 == folded).map(|e| format!("; try: steradian material {}", e.1));
    let hint = everyday.or_else(|| names::did_you_mean(name, kinds()).map(|h| format!("; {h}"))).unwrap_or_default();
    let known = kinds().collect::<Vec<_>>().join(", ");
    Err(Failure::bad_input(format!("there is no material '{name}'{hint} (known: {known})")))
}

/// Parameters that have to be given for a kind to be measured.
pub fn needed(kind: &str) -> impl Iterator<Item = &'static Parameter> {
    let model = Family::Material.model(kind);
    model.into_iter().flat_map(|m| m.all()).filter(|p| p.default == "needed")
}

/// A command that gives what is needed of a kind.
pub fn example(kind: &str) -> String {
    let value = |p: &Parameter| match p.kind {
        Type::Material => "plastic",
        Type::Materials => "'diffuse|conductor'",
        Type::File => "FILE",
        Type::Map => "PICTURE.png",
        _ => "0.5",
    };
    let given: String = needed(kind).map(|p| format!(" {}={}", p.name, value(p))).collect();
    format!("steradian material {kind} -p{given}")
}

/// All that can be set of a material, as it is.
pub fn settings(node: &Node, desc: &SceneDesc) -> Vec<Setting> {
    let Some(model) = Family::Material.model(&node.kind) else { return Vec::new() };
    let bound = |v: f64| Some(v).filter(|v| v.is_finite());
    let parameters = model.all().map(|p| {
        let given = node.get(p.name).map(|v| shown(v, desc));
        Setting {
            name: p.name,
            is_default: given.is_none(),
            value: given.unwrap_or_else(|| p.usual_default().into()),
            default: p.default,
            unit: p.unit,
            range: [bound(p.range.0), bound(p.range.1)],
            values: p.values(),
            meaning: p.meaning(),
            limits: limits(p),
        }
    });
    parameters.collect()
}

/// A range, or the words that a parameter may be.
fn limits(p: &Parameter) -> String {
    match p.range_text() {
        text if text.is_empty() => p.words().collect::<Vec<_>>().join("|"),
        text => text.trim_start_matches("in ").to_owned(),
    }
}

/// A value as it is written on the command line, where it can be.
fn shown(value: &Value, desc: &SceneDesc) -> String {
    let list = |v: &[f64]| v.iter().map(|v| short(*v)).collect::<Vec<_>>().join(",");
    let called = |id| {
        let node = desc.node(id);
        node.name.clone().filter(|n| !n.is_empty()).unwrap_or_else(|| node.kind.clone())
    };
    match value {
        Value::Bool(v) => v.to_string(),
        Value::Int(v) => v.to_string(),
        Value::Float(v) | Value::Spectrum(SpectrumValue::Constant(v)) => short(*v),
        Value::String(v) | Value::Spectrum(SpectrumValue::Named(v)) => v.clone(),
        Value::Path(v) => v.display().to_string(),
        Value::Vec3(v) | Value::Spectrum(SpectrumValue::Rgb(v, _)) => list(v),
        Value::Floats(v) => list(v),
        Value::Ints(v) => v.iter().map(i64::to_string).collect::<Vec<_>>().join(","),
        Value::Transform(_) => "a transform".into(),
        Value::Spectrum(SpectrumValue::Sampled { lambdas, .. }) => match lambdas[..] {
            [first, .., last] => format!("spectrum {first}–{last} nm"),
            _ => "spectrum".into(),
        },
        Value::Spectrum(SpectrumValue::Blackbody(kelvin)) => format!("black body {kelvin} K"),
        Value::Node(id) => called(*id),
        Value::Nodes(ids) => ids.iter().map(|id| called(*id)).collect::<Vec<_>>().join("|"),
    }
}

/// A number in at most six digits.
fn short(v: f64) -> String {
    let text = format!("{v:.6}");
    let cut = text.trim_end_matches('0').trim_end_matches('.');
    if v != 0.0 && v.abs() < 1e-5 { format!("{v:e}") } else { cut.into() }
}

/// The kind, a table of parameters, and the summary.
pub fn text(out: &mut String, kind: &str, settings: &[Setting], summary: Option<&Summary>) {
    if let Some(model) = Family::Material.model(kind) {
        let _ = writeln!(out, "{kind}: {}\nsource: {}\n", model.doc, model.source);
    }
    table(out, settings);
    let Some(s) = summary else { return };
    let percent = |v: f64| format!("{} %", (100.0 * v).round());
    let lobes = s.lobes.iter().map(|l| format!("{} {}", l.name, percent(l.share))).collect::<Vec<_>>().join(", ");
    let lobes = if lobes.is_empty() { "none: it absorbs all light".into() } else { lobes };
    let _ = writeln!(out, "lobes            {lobes}{}", if s.lobes.is_empty() { "" } else { " (of light at 45°)" });
    let _ = writeln!(out, "transmits        {}", if s.is_transmitting { "yes" } else { "no" });
    let most = format!("at most {:.4} of a colour is scattered", s.largest_albedo);
    let _ = writeln!(out, "conserves energy {} ({most})", if s.conserves_energy { "yes" } else { "NO" });
    let row = |name: &str, f: &dyn Fn(usize) -> String| {
        format!("{name:17}{}", [0, 1, 2].map(|k| format!("{:>8}", f(k))).concat())
    };
    let _ = writeln!(out, "{}", row("white light at", &|k| format!("{}°", s.white[k].theta)));
    let _ = writeln!(out, "{}", row("  reflectance", &|k| format!("{:.4}", s.white[k].reflectance)));
    if s.is_transmitting {
        let _ = writeln!(out, "{}", row("  transmittance", &|k| format!("{:.4}", s.white[k].transmittance)));
    }
}

/// Columns as wide as what is in them.
fn table(out: &mut String, settings: &[Setting]) {
    let heading = ["parameter", "value", "", "unit", "range", "meaning"];
    let rows = settings.iter().map(|s| {
        let origin = if s.is_default { "default" } else { "set" };
        [s.name, &s.value, origin, s.unit, &s.limits, &s.meaning]
    });
    let rows: Vec<[&str; 6]> = std::iter::once(heading).chain(rows).collect();
    let widths: [usize; 6] =
        std::array::from_fn(|c| rows.iter().map(|r| r[c].chars().count()).filter(|w| *w <= 40).max().unwrap_or(0));
    for row in rows {
        let mut line = String::new();
        for (cell, width) in row.into_iter().zip(widths).filter(|c| c.1 > 0) {
            let pad = width.saturating_sub(cell.chars().count()) + 2;
            let _ = write!(line, "{cell}{:pad$}", "");
        }
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out.push('\n');
}

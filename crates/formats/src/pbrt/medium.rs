//! `MakeNamedMedium`.

use super::{
    build::{Build, Field},
    dict::Dict,
    preset,
    scene::Scene,
    spectrum::Role,
};
use steradian_math::spectra::cie::CIE_Y_INTEGRAL;
use steradian_scene::{Family, Node, NodeId, SpectrumValue, Transform, names};

pub(super) const KINDS: [&str; 5] = ["homogeneous", "uniformgrid", "rgbgrid", "cloud", "nanovdb"];

/// Translates a medium; `ctm` takes its space to the world.
pub(super) fn translate(scene: &mut Scene, dict: &Dict, kind: &str, ctm: Transform) -> Option<NodeId> {
    let mut b = Build::new(scene, dict, Family::Medium, kind);
    match kind {
        "homogeneous" => homogeneous(&mut b),
        "uniformgrid" => {
            b.fields(&[
                Field::Floats("density"),
                Field::Floats("temperature"),
                Field::Floats("Lescale"),
                Field::OptionalSpectrum("Le", Role::Illuminant),
            ]);
            temperature(&mut b);
            coefficients(&mut b);
            bounds(&mut b);
            grid(&mut b, "density", 1);
            if b.node.get("temperature").is_some() {
                if b.node.get("Le").is_some() {
                    b.error("Le", "a medium glows by 'Le' or by 'temperature', not by both");
                }
                photometric(&mut b);
            }
        }
        "rgbgrid" => {
            b.fields(&[
                Field::Colors("sigma_a"),
                Field::Colors("sigma_s"),
                Field::Colors("Le"),
                Field::Float("Lescale", 1.0),
                Field::Float("scale", 1.0),
            ]);
            bounds(&mut b);
            let which = if b.node.get("sigma_a").is_some() { "sigma_a" } else { "sigma_s" };
            grid(&mut b, which, 3);
            photometric(&mut b);
        }
        "cloud" => {
            b.fields(&[
                Field::Float("density", 1.0),
                Field::Float("wispiness", 1.0),
                Field::Float("frequency", 5.0),
                Field::Spectrum("sigma_a", Role::Unbounded, 1.0),
                Field::Spectrum("sigma_s", Role::Unbounded, 1.0),
            ]);
            bounds(&mut b);
        }
        "nanovdb" => {
            b.node.kind = "vdb".into();
            b.fields(&[Field::Float("Lescale", 1.0)]);
            b.required_file("filename", "file");
            b.text("gridname", "grid", None);
            b.text("temperaturename", "temperature_grid", None);
            temperature(&mut b);
            coefficients(&mut b);
            photometric(&mut b);
        }
        _ => {
            let help = names::did_you_mean(kind, KINDS);
            let span = dict.span_of("type");
            scene.report.error_help(span, format!("unknown medium '{kind}'"), help);
            return None;
        }
    }
    if kind != "homogeneous" {
        b.set("to_world", ctm);
    }
    phase(&mut b);
    Some(b.finish())
}

fn homogeneous(b: &mut Build) {
    let named = b.dict.text(&mut b.scene.report, "preset").filter(|(n, _)| !n.is_empty());
    match named.map(|(name, span)| (name, span, preset::scattering(name))) {
        Some((_, _, Some((sigma_a, sigma_s)))) => {
            b.set("sigma_a", sigma_a);
            b.set("sigma_s", sigma_s);
            b.float("scale", "scale", 1.0);
        }
        unknown => {
            if let Some((name, span, _)) = unknown {
                let help = names::did_you_mean(name, preset::names());
                b.scene.report.error_help(span, format!("unknown medium preset '{name}'"), help);
            }
            coefficients(b);
        }
    }
    b.spectrum("Le", "Le", Role::Illuminant, None);
    b.float("Lescale", "Lescale", None);
}

fn coefficients(b: &mut Build) {
    for coefficient in ["sigma_a", "sigma_s"] {
        b.spectrum(coefficient, coefficient, Role::Unbounded, SpectrumValue::Constant(1.0));
    }
    b.float("scale", "scale", 1.0);
}

/// `temperaturecutoff` is the older name of the offset.
fn temperature(b: &mut Build) {
    b.float("temperaturecutoff", "temperatureoffset", None);
    b.float("temperatureoffset", "temperatureoffset", None);
    b.float("temperaturescale", "temperaturescale", 1.0);
}

/// pbrt makes `Le` of one spectrum of luminance one, but not the emission of grids of temperatures and colours; its
/// film weighs with ȳ, ours with ȳ/∫ȳ.
fn photometric(b: &mut Build) {
    match b.node.floats("Lescale") {
        Some(list) => b.set("Lescale", list.iter().map(|v| v * CIE_Y_INTEGRAL).collect::<Vec<_>>()),
        None => b.set("Lescale", b.node.float("Lescale").unwrap_or(1.0) * CIE_Y_INTEGRAL),
    }
}

fn bounds(b: &mut Build) {
    b.fields(&[Field::Point("p0", [0.0; 3]), Field::Point("p1", [1.0; 3])]);
}

/// Checks that a grid has as many values as its resolution says.
fn grid(b: &mut Build, values: &'static str, channels: usize) {
    b.fields(&[Field::Int("nx", 1), Field::Int("ny", 1), Field::Int("nz", 1)]);
    let size = ["nx", "ny", "nz"].map(|n| b.node.int(n).unwrap_or(0).max(0) as u64);
    let wanted = size.iter().fold(channels as u64, |p, &n| p.saturating_mul(n));
    let found = b.node.floats(values).map_or(0, <[f64]>::len) as u64;
    if found != wanted || found == 0 {
        let [x, y, z] = size;
        b.error(values, format!("a grid of {x}×{y}×{z} needs {wanted} numbers in '{values}', found {found}"));
    }
}

fn phase(b: &mut Build) {
    let g = b.dict.float_or(&mut b.scene.report, "g", 0.0);
    if !(-1.0..=1.0).contains(&g) {
        return b.error("g", "parameter 'g' must be within [-1, 1]");
    }
    let phase = match g {
        0.0 => Node::new(Family::Phase, "isotropic", None),
        g => Node::new(Family::Phase, "hg", Some(b.dict.span_of("g"))).with("g", g),
    };
    let id = b.scene.desc.add(phase);
    b.set("phase", id);
}

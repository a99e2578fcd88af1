//! `Texture "name" "float|spectrum" "class"`.

use super::{
    build::{Build, Field},
    dict::Dict,
    param::Type,
    scene::Scene,
    spectrum::Role,
};
use std::path::Path;
use steradian_scene::{Family, NodeId, SpectrumValue, Transform, names};

/// Type of a texture's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Values {
    Float,
    Spectrum,
}

impl Values {
    pub fn name(self) -> &'static str {
        match self {
            Self::Float => "float",
            Self::Spectrum => "spectrum",
        }
    }
}

pub(super) const CLASSES: [&str; 13] = [
    "constant",
    "imagemap",
    "checkerboard",
    "scale",
    "mix",
    "directionmix",
    "bilerp",
    "dots",
    "fbm",
    "marble",
    "windy",
    "wrinkled",
    "ptex",
];

/// Classes that read a file; pbrt makes them first, so other textures may refer to them before they are defined.
pub(super) fn is_file(class: &str) -> bool {
    class == "imagemap" || class == "ptex"
}

/// Translates one texture; `ctm` takes texture space to the world.
pub(super) fn translate(scene: &mut Scene, dict: &Dict, values: Values, ctm: Transform) -> Option<NodeId> {
    let class = dict.kind.as_str();
    let kind = match class {
        "imagemap" => "image",
        "directionmix" => "direction_mix",
        _ => class,
    };
    let mut b = Build::new(scene, dict, Family::Texture, kind);
    match class {
        "constant" => value(&mut b, values, "value", "value", 1.0),
        "imagemap" => image(&mut b, values, ctm),
        "checkerboard" => {
            operand(&mut b, values, "tex1", "a", 1.0);
            operand(&mut b, values, "tex2", "b", 0.0);
            b.int("dimension", "dimension", 2);
            match b.node.int("dimension") {
                Some(2) => mapping(&mut b, ctm),
                Some(3) => solid(&mut b, ctm),
                _ => b.error("dimension", "a checkerboard has 2 or 3 dimensions"),
            }
        }
        "scale" => {
            operand(&mut b, values, "tex", "texture", 1.0);
            b.float_texture("scale", "scale", 1.0);
        }
        "mix" => {
            operand(&mut b, values, "tex1", "a", 0.0);
            operand(&mut b, values, "tex2", "b", 1.0);
            b.float_texture("amount", "amount", 0.5);
        }
        "directionmix" => {
            operand(&mut b, values, "tex1", "a", 0.0);
            operand(&mut b, values, "tex2", "b", 1.0);
            b.vec3("dir", "dir", Type::Vector3, [0.0, 1.0, 0.0]);
            solid(&mut b, ctm);
        }
        "bilerp" => {
            for (corner, default) in [("v00", 0.0), ("v01", 1.0), ("v10", 0.0), ("v11", 1.0)] {
                value(&mut b, values, corner, corner, default);
            }
            mapping(&mut b, ctm);
        }
        "dots" => {
            operand(&mut b, values, "inside", "b", 1.0);
            operand(&mut b, values, "outside", "a", 0.0);
            mapping(&mut b, ctm);
        }
        "fbm" | "wrinkled" if values == Values::Float => {
            b.fields(&[Field::Int("octaves", 8), Field::Float("roughness", 0.5)]);
            solid(&mut b, ctm);
        }
        "windy" if values == Values::Float => solid(&mut b, ctm),
        "marble" if values == Values::Spectrum => {
            b.fields(&[
                Field::Int("octaves", 8),
                Field::Float("roughness", 0.5),
                Field::Float("scale", 1.0),
                Field::Float("variation", 0.2),
            ]);
            solid(&mut b, ctm);
        }
        "ptex" => {
            let help = "bake it to an image over uv and use 'imagemap'";
            scene.report.error_help(dict.span, "Ptex textures are not supported", Some(help.into()));
            return None;
        }
        _ if b.own().is_some() => mapping(&mut b, ctm),
        _ => {
            let (message, help) = match CLASSES.contains(&class) {
                true => (format!("there is no '{class}' texture of type {}", values.name()), None),
                false => (format!("unknown texture '{class}'"), names::did_you_mean(class, CLASSES)),
            };
            scene.report.error_help(dict.span, message, help);
            return None;
        }
    }
    Some(b.finish())
}

/// A constant of the texture's type.
fn value(b: &mut Build, values: Values, from: &'static str, to: &str, default: f64) {
    match values {
        Values::Float => b.float(from, to, default),
        // Which bounds hold is known where the texture is used.
        Values::Spectrum => b.spectrum(from, to, Role::Unbounded, SpectrumValue::Constant(default)),
    }
}

/// A texture or constant of the texture's type.
fn operand(b: &mut Build, values: Values, from: &'static str, to: &str, default: f64) {
    match values {
        Values::Float => b.float_texture(from, to, default),
        Values::Spectrum => b.spectrum_texture(from, to, Role::Unbounded, SpectrumValue::Constant(default)),
    };
}

fn image(b: &mut Build, values: Values, ctm: Transform) {
    b.required_file("filename", "file");
    let filters =
        [("point", "nearest"), ("bilinear", "bilinear"), ("trilinear", "trilinear"), ("ewa", "ewa"), ("EWA", "ewa")];
    b.choice("filter", "filter", &filters, "bilinear");
    let wraps = [("repeat", "repeat"), ("clamp", "clamp"), ("black", "black"), ("octahedralsphere", "octahedral")];
    b.choice("wrap", "wrap_u", &wraps, "repeat");
    let wrap = b.node.string("wrap_u").unwrap_or("repeat").to_string();
    b.set("wrap_v", wrap);
    encoding(b);
    b.float("maxanisotropy", "max_anisotropy", None);
    b.float("scale", "scale", 1.0);
    b.bool("invert", "invert", false);
    b.set("origin", "bottom");
    // Numbers need no colour, but pbrt decodes them where the file has an encoding.
    b.set("raw", values == Values::Float && b.node.string("encoding") == Some("linear"));
    mapping(b, ctm);
}

/// pbrt obeys `encoding` in PNG files only (and takes sRGB there by default); other files of bytes are sRGB, and files
/// of floats are linear.
fn encoding(b: &mut Build) {
    let extension = b.node.path("file").and_then(Path::extension).map(|e| e.to_string_lossy().to_lowercase());
    let asked = b.dict.text(&mut b.scene.report, "encoding");
    let linear = matches!(extension.as_deref(), Some("exr" | "hdr" | "pfm"));
    match asked {
        _ if linear => b.set("encoding", "linear"),
        Some((word, span)) if extension.as_deref() == Some("png") => match parse_encoding(word) {
            Some(Encoding::Word(w)) => _ = b.node.set("encoding", w, Some(span)),
            Some(Encoding::Gamma(g)) => _ = b.node.set("encoding", g, Some(span)),
            None => {
                let message = format!("unknown encoding '{word}'; known are 'sRGB', 'linear' and 'gamma <exponent>'");
                b.scene.report.error(span, message);
            }
        },
        _ => b.set("encoding", "srgb"),
    }
    let own = if linear { "linear" } else { "sRGB" };
    if let Some((_, span)) = asked.filter(|(word, _)| *word != own && extension.as_deref() != Some("png")) {
        let why = format!("it counts for PNG files only, and others like this one are {own}");
        b.scene.report.no_effect(span, "'encoding' of texture 'imagemap'", &why);
    }
}

enum Encoding {
    Word(&'static str),
    Gamma(f64),
}

fn parse_encoding(word: &str) -> Option<Encoding> {
    match word {
        "sRGB" => Some(Encoding::Word("srgb")),
        "linear" => Some(Encoding::Word("linear")),
        _ => {
            let gamma: f64 = word.trim().strip_prefix("gamma")?.trim().parse().ok()?;
            (gamma.is_finite() && gamma > 0.0).then_some(Encoding::Gamma(gamma))
        }
    }
}

/// Mapping of a two-dimensional texture.
fn mapping(b: &mut Build, ctm: Transform) {
    let mappings = [("uv", "uv"), ("spherical", "spherical"), ("cylindrical", "cylindrical"), ("planar", "planar")];
    b.choice("mapping", "mapping", &mappings, "uv");
    let mapping = b.node.string("mapping").unwrap_or("uv").to_string();
    if mapping == "uv" {
        b.float("uscale", "scale_u", 1.0);
        b.float("vscale", "scale_v", 1.0);
    } else {
        texture_from_world(b, ctm);
    }
    if mapping == "planar" {
        b.vec3("v1", "v1", Type::Vector3, [1.0, 0.0, 0.0]);
        b.vec3("v2", "v2", Type::Vector3, [0.0, 1.0, 0.0]);
    }
    if mapping == "uv" || mapping == "planar" {
        b.float("udelta", "delta_u", 0.0);
        b.float("vdelta", "delta_v", 0.0);
    }
}

/// Mapping of a three-dimensional texture.
fn solid(b: &mut Build, ctm: Transform) {
    texture_from_world(b, ctm);
}

fn texture_from_world(b: &mut Build, ctm: Transform) {
    match ctm.inverse() {
        Some(inverse) => b.set("texture_from_world", inverse),
        None => {
            let span = b.span();
            b.scene.report.error(span, "the transform in force at the texture cannot be inverted");
        }
    }
}

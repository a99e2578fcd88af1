//! `Material` and `MakeNamedMaterial`.

use super::{
    build::{Build, Field},
    dict::Dict,
    param::Type,
    scene::Scene,
    spectrum::Role,
};
use steradian_scene::{Family, Node, NodeId, SpectrumValue, Value, names};

/// Kinds of pbrt-v4.
pub(super) const KINDS: [&str; 12] = [
    "diffuse",
    "conductor",
    "dielectric",
    "thindielectric",
    "coateddiffuse",
    "coatedconductor",
    "diffusetransmission",
    "hair",
    "measured",
    "subsurface",
    "mix",
    "interface",
];

/// Kinds of pbrt-v3 that pbrt-v4 has under another name.
const OLD_KINDS: [(&str, &str); 10] = [
    ("matte", "diffuse"),
    ("glass", "dielectric"),
    ("metal", "conductor"),
    ("mirror", "conductor"),
    ("plastic", "coateddiffuse"),
    ("substrate", "coateddiffuse"),
    ("uber", "coateddiffuse"),
    ("translucent", "diffusetransmission"),
    ("kdsubsurface", "subsurface"),
    ("disney", "diffuse"),
];

/// Translates the material `kind`; the names of others are looked up among those defined before it.
pub(super) fn translate(scene: &mut Scene, dict: &Dict, kind: &str) -> Option<NodeId> {
    let ours = match kind {
        "thindielectric" => "thin_dielectric",
        "coateddiffuse" => "coated_diffuse",
        "coatedconductor" => "coated_conductor",
        "diffusetransmission" => "diffuse_transmission",
        "" | "none" => "interface",
        other => other,
    };
    let mut b = Build::new(scene, dict, Family::Material, ours);
    match kind {
        "diffuse" => _ = b.spectrum_texture("reflectance", "reflectance", Role::Albedo, grey(0.5)),
        "conductor" => {
            conductor(&mut b);
            roughness(&mut b);
        }
        "dielectric" => {
            b.number_or_spectrum("eta", "eta", 1.5);
            roughness(&mut b);
        }
        "thindielectric" => b.number_or_spectrum("eta", "eta", 1.5),
        "coateddiffuse" => {
            b.spectrum_texture("reflectance", "reflectance", Role::Albedo, grey(0.5));
            b.number_or_spectrum("eta", "eta", 1.5);
            roughness(&mut b);
            b.float_texture("thickness", "thickness", 0.01);
            b.spectrum_texture("albedo", "albedo", Role::Albedo, grey(0.0));
            b.float_texture("g", "g", 0.0);
            b.int("maxdepth", "max_depth", 10);
            b.int("nsamples", "samples", 1);
        }
        "coatedconductor" => coated_conductor(&mut b),
        "diffusetransmission" => diffuse_transmission(&mut b),
        "hair" => b.fields(&[
            Field::OptionalSpectrumTexture("sigma_a", Role::Unbounded),
            Field::OptionalSpectrumTexture("reflectance", Role::Albedo),
            Field::OptionalSpectrumTexture("color", Role::Albedo),
            Field::OptionalFloatTexture("eumelanin"),
            Field::OptionalFloatTexture("pheomelanin"),
            Field::FloatTexture("eta", 1.55),
            Field::FloatTexture("beta_m", 0.3),
            Field::FloatTexture("beta_n", 0.3),
            Field::FloatTexture("alpha", 2.0),
        ]),
        "measured" => b.required_file("filename", "file"),
        "subsurface" => subsurface(&mut b),
        "mix" => mix(&mut b),
        "interface" | "" | "none" => {}
        _ if b.own().is_some() => {}
        _ => {
            let help = match OLD_KINDS.iter().find(|(old, _)| *old == kind) {
                Some((_, new)) => Some(format!("'{kind}' is of pbrt-v3; the nearest of pbrt-v4 is '{new}'")),
                None => names::did_you_mean(kind, KINDS),
            };
            scene.report.error_help(dict.span, format!("unknown material '{kind}'"), help);
            return None;
        }
    }
    if !matches!(kind, "mix" | "interface" | "" | "none" | "hair") {
        wrappers(&mut b);
    }
    Some(b.finish())
}

fn grey(v: f64) -> SpectrumValue {
    SpectrumValue::Constant(v)
}

/// `uroughness` and `vroughness`, each standing in by `roughness`, and whether they are squared.
fn roughness(b: &mut Build) {
    for (from, to) in [("uroughness", "alpha_u"), ("vroughness", "alpha_v")] {
        if !b.float_texture(from, to, None) {
            b.float_texture("roughness", to, 0.0);
        }
    }
    b.bool("remaproughness", "remap_roughness", true);
}

/// `scale` multiplies both colours.
fn diffuse_transmission(b: &mut Build) {
    let scale = b.dict.float_or(&mut b.scene.report, "scale", 1.0);
    for name in ["reflectance", "transmittance"] {
        b.spectrum_texture(name, name, Role::Albedo, grey(0.25));
        if scale == 1.0 {
            continue;
        }
        let scaled = match b.node.get(name).cloned() {
            Some(Value::Spectrum(SpectrumValue::Constant(v))) => grey(v * scale).into(),
            Some(Value::Spectrum(SpectrumValue::Rgb(v, space))) => {
                SpectrumValue::Rgb(v.map(|c| c * scale), space).into()
            }
            Some(value) => {
                let mut texture = Node::new(Family::Texture, "scale", Some(b.dict.span_of("scale")));
                texture.set("texture", value, None).set("scale", scale, None);
                Value::Node(b.scene.desc.add(texture))
            }
            None => continue,
        };
        b.set(name, scaled);
    }
}

fn copper(part: &str) -> SpectrumValue {
    SpectrumValue::Named(format!("metal-Cu-{part}"))
}

/// Index of refraction and absorption, or a reflectance; copper if neither is given.
fn conductor(b: &mut Build) {
    let eta = b.spectrum_texture("eta", "eta", Role::Unbounded, None);
    let k = b.spectrum_texture("k", "k", Role::Unbounded, None);
    let reflectance = b.spectrum_texture("reflectance", "reflectance", Role::Albedo, None);
    metal_defaults(b, eta, k, reflectance, ["eta", "k"]);
}

fn metal_defaults(b: &mut Build, eta: bool, k: bool, reflectance: bool, names: [&str; 2]) {
    if reflectance {
        if eta || k {
            let [eta, k] = names;
            b.error("reflectance", format!("a conductor has either 'reflectance' or '{eta}' and '{k}', not both"));
        }
        return;
    }
    if !eta {
        b.set(names[0], copper("eta"));
    }
    if !k {
        b.set(names[1], copper("k"));
    }
}

fn coated_conductor(b: &mut Build) {
    for (both, u, v) in [
        ("interface.roughness", "interface.uroughness", "interface.vroughness"),
        ("conductor.roughness", "conductor.uroughness", "conductor.vroughness"),
    ] {
        for one in [u, v] {
            if !b.float_texture(one, one, None) {
                b.float_texture(both, one, 0.0);
            }
        }
    }
    let eta = b.spectrum_texture("conductor.eta", "conductor.eta", Role::Unbounded, None);
    let k = b.spectrum_texture("conductor.k", "conductor.k", Role::Unbounded, None);
    let reflectance = b.spectrum_texture("reflectance", "reflectance", Role::Albedo, None);
    metal_defaults(b, eta, k, reflectance, ["conductor.eta", "conductor.k"]);
    b.fields(&[
        Field::FloatTexture("thickness", 0.01),
        Field::Index("interface.eta", 1.5),
        Field::FloatTexture("g", 0.0),
        Field::SpectrumTexture("albedo", Role::Albedo, 0.0),
    ]);
    b.int("maxdepth", "max_depth", 10);
    b.int("nsamples", "samples", 1);
    b.bool("remaproughness", "remap_roughness", true);
}

/// By name, by coefficients, or by reflectance and mean free path; whole milk if nothing is given.
fn subsurface(b: &mut Build) {
    b.fields(&[Field::Float("g", 0.0), Field::Float("scale", 1.0), Field::Float("eta", 1.33), Field::Text("name")]);
    let named = b.node.string("name").filter(|n| !n.is_empty()).map(str::to_string);
    if let Some(name) = named {
        match super::preset::scattering(&name) {
            Some((sigma_a, sigma_s)) => {
                b.set("sigma_a", sigma_a);
                b.set("sigma_s", sigma_s);
                b.set("g", 0.0);
            }
            None => {
                let help = names::did_you_mean(&name, super::preset::names());
                let span = b.dict.span_of("name");
                b.scene.report.error_help(span, format!("unknown scattering medium '{name}'"), help);
            }
        }
    } else {
        let sigma_a = b.spectrum_texture("sigma_a", "sigma_a", Role::Unbounded, None);
        let sigma_s = b.spectrum_texture("sigma_s", "sigma_s", Role::Unbounded, None);
        let reflectance = b.spectrum_texture("reflectance", "reflectance", Role::Albedo, None);
        b.spectrum_texture("mfp", "mfp", Role::Unbounded, reflectance.then_some(grey(1.0)));
        if sigma_a != sigma_s {
            b.error(if sigma_a { "sigma_a" } else { "sigma_s" }, "give both 'sigma_a' and 'sigma_s' or neither");
        } else if !sigma_a
            && !reflectance
            && let Some((sigma_a, sigma_s)) = super::preset::scattering("Wholemilk")
        {
            b.set("sigma_a", sigma_a);
            b.set("sigma_s", sigma_s);
        }
    }
    b.node.set("method", "photon_beam", None);
    roughness(b);
}

/// Chooses between two named materials.
fn mix(b: &mut Build) {
    b.float_texture("amount", "amount", 0.5);
    let span = b.dict.span;
    let Some((two, at)) = b.dict.texts(&mut b.scene.report, "materials") else {
        return b.scene.report.error(span, "material 'mix' needs \"string materials\" [ \"first\" \"second\" ]");
    };
    if two.len() != 2 {
        return b.scene.report.error(at, format!("material 'mix' takes two materials, found {}", two.len()));
    }
    let mut nodes = Vec::new();
    for name in two {
        let Some(id) = b.scene.named_material(name, at) else { return };
        if b.scene.desc.node(id).kind == "interface" {
            let message = format!("'{name}' is an 'interface', which cannot be mixed");
            return b.scene.report.error(at, message);
        }
        nodes.push(id);
    }
    b.node.set("materials", nodes, Some(at));
}

/// Displacement (which pbrt renders as a change of the normal) and normal maps.
fn wrappers(b: &mut Build) {
    if b.dict.has("displacement", &[Type::Texture]) {
        b.float_texture("displacement", "displacement", None);
    } else if b.dict.has("displacement", &[Type::Float]) {
        // The same height everywhere changes nothing.
        b.dict.float(&mut b.scene.report, "displacement");
    }
    if let Some((name, span)) = b.dict.text(&mut b.scene.report, "normalmap").filter(|(n, _)| !n.is_empty()) {
        match b.scene.search.find(name) {
            Ok(path) => {
                let mut map = Node::new(Family::Texture, "image", Some(span));
                map.set("file", path, Some(span));
                for (key, value) in [
                    ("filter", Value::from("bilinear")),
                    ("wrap_u", "repeat".into()),
                    ("wrap_v", "repeat".into()),
                    ("encoding", "linear".into()),
                    ("raw", true.into()),
                    ("origin", "bottom".into()),
                ] {
                    map.set(key, value, None);
                }
                let id = b.scene.desc.add(map);
                b.node.set("normal_map", id, Some(span));
            }
            Err(fault) => b.scene.report.error(span, fault.to_string()),
        }
    }
    if b.node.get("normal_map").or(b.node.get("displacement")).is_some() {
        b.node.set("detail_facing", "leaking", None);
    }
}

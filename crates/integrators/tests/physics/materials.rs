//! A material of every registered kind.

use crate::stage::{diffuse, material, rgb, white};
use steradian_bsdf::measured::synthetic::METAL;
use steradian_scene::{Node, NodeId, SceneDesc, SpectrumValue, Value};
use steradian_schema::material::MATERIALS;

/// A material to put on a stage.
pub struct Case {
    pub label: &'static str,
    /// Its kind in the registry.
    pub kind: &'static str,
    pub make: fn(&mut SceneDesc) -> NodeId,
    /// True if all light that comes goes on, so that it cannot be told from its surroundings in a furnace.
    pub lossless: bool,
}

fn metal(desc: &mut SceneDesc, alpha: [f64; 2]) -> NodeId {
    let named = |s: &str| Value::Spectrum(SpectrumValue::Named(s.into()));
    desc.add(
        material("conductor")
            .with("eta", named("metal-Au-eta"))
            .with("k", named("metal-Au-k"))
            .with("alpha_u", alpha[0])
            .with("alpha_v", alpha[1]),
    )
}

fn pair(desc: &mut SceneDesc, a: Node, b: Node) -> [NodeId; 2] {
    [desc.add(a), desc.add(b)]
}

/// A table of angles, written once.
fn measured_file() -> &'static str {
    static ONCE: std::sync::Once = std::sync::Once::new();
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/measured.txt");
    ONCE.call_once(|| {
        std::fs::write(path, METAL.angles([15.0, 30.0], &[0.0])).expect("the folder for tests can be written")
    });
    path
}

fn case(label: &'static str, kind: &'static str, lossless: bool, make: fn(&mut SceneDesc) -> NodeId) -> Case {
    Case { label, kind, make, lossless }
}

/// Single surfaces: diffuse, metal and glass.
fn surfaces() -> Vec<Case> {
    vec![
        case("diffuse, white", "diffuse", true, |d| d.add(diffuse(1.0))),
        case("diffuse, coloured", "diffuse", false, |d| {
            d.add(material("diffuse").with("reflectance", rgb([0.8, 0.4, 0.1])))
        }),
        case("mirror", "conductor", true, |d| d.add(material("conductor"))),
        case("mirror, tinted", "conductor", false, |d| {
            d.add(material("conductor").with("specular_reflectance", rgb([0.9, 0.6, 0.3])))
        }),
        case("gold", "conductor", false, |d| metal(d, [0.0; 2])),
        case("gold, GGX 0.3", "conductor", false, |d| metal(d, [0.3; 2])),
        case("gold, anisotropic", "conductor", false, |d| metal(d, [0.4, 0.15])),
        case("rough metal from reflectance", "conductor", false, |d| {
            d.add(
                material("conductor")
                    .with("reflectance", rgb([0.9, 0.7, 0.4]))
                    .with("alpha_u", 0.25)
                    .with("distribution", "beckmann"),
            )
        }),
        case("glass", "dielectric", true, |d| d.add(material("dielectric").with("eta", 1.5))),
        case("index one", "dielectric", true, |d| d.add(material("dielectric").with("eta", 1.0))),
        case("rough glass", "dielectric", false, |d| {
            d.add(material("dielectric").with("eta", 1.5).with("alpha_u", 0.3))
        }),
        case("stained glass", "dielectric", false, |d| {
            d.add(material("dielectric").with("eta", 1.33).with("specular_transmittance", rgb([0.2, 0.8, 0.4])))
        }),
        // It loses nothing, but keeps one wavelength alone: its colour noise is not that of its surroundings.
        case("dispersive glass", "dielectric", false, |d| {
            d.add(material("dielectric").with("eta", Value::Spectrum(SpectrumValue::Named("glass-SF11".into()))))
        }),
        case("pane", "thin_dielectric", true, |d| d.add(material("thin_dielectric").with("eta", 1.5))),
        case("polariser", "polarizer", false, |d| d.add(material("polarizer").with("theta", 30.0))),
        case("quarter-wave plate", "retarder", true, |d| d.add(material("retarder"))),
    ]
}

/// Coats, light through thin layers, and materials made of others.
fn compounds() -> Vec<Case> {
    vec![
        case("smooth coat", "coated_diffuse", false, |d| {
            d.add(material("coated_diffuse").with("reflectance", white(0.6)))
        }),
        case("rough coat", "coated_diffuse", false, |d| {
            d.add(material("coated_diffuse").with("reflectance", white(0.6)).with("alpha_u", 0.25))
        }),
        case("plastic", "plastic", false, |d| {
            d.add(material("plastic").with("diffuse_reflectance", rgb([0.2, 0.7, 0.3])))
        }),
        case("rough plastic", "plastic", false, |d| {
            d.add(
                material("plastic")
                    .with("diffuse_reflectance", white(0.5))
                    .with("alpha_u", 0.2)
                    .with("nonlinear", true),
            )
        }),
        case("paper", "diffuse_transmission", true, |d| {
            d.add(material("diffuse_transmission").with("reflectance", white(0.5)).with("transmittance", white(0.5)))
        }),
        case("leaf", "diffuse_transmission", false, |d| {
            let n = material("diffuse_transmission");
            d.add(n.with("reflectance", rgb([0.1, 0.4, 0.1])).with("transmittance", rgb([0.2, 0.3, 0.05])))
        }),
        case("white on both sides", "two_sided", true, |d| {
            let [front, back] = pair(d, diffuse(1.0), material("conductor"));
            d.add(material("two_sided").with("front", front).with("back", back))
        }),
        case("half masked", "mask", true, |d| {
            let inner = d.add(diffuse(1.0));
            d.add(material("mask").with("opacity", 0.5).with("material", inner))
        }),
        case("mirror and white", "mix", true, |d| {
            let parts = pair(d, diffuse(1.0), material("conductor"));
            d.add(material("mix").with("materials", Value::Nodes(parts.into())).with("amount", 0.3))
        }),
        case("two diffuse parts", "mix", false, |d| {
            let parts = pair(d, diffuse(0.8), diffuse(0.2));
            d.add(material("mix").with("materials", Value::Nodes(parts.into())).with("amount", 0.25))
        }),
        case("table of a metal", "measured", false, |d| {
            d.add(material("measured").with("file", Value::Path(measured_file().into())))
        }),
        case("nothing", "interface", true, |d| d.add(material("interface"))),
    ]
}

/// Models by the names of their authors and programs, and special effects.
fn models() -> Vec<Case> {
    vec![
        // These two lose nothing, but their samples do not all weigh one.
        case("rough white", "oren_nayar", false, |d| {
            d.add(material("oren_nayar").with("reflectance", white(1.0)).with("roughness", 0.8))
        }),
        case("clay", "oren_nayar", false, |d| {
            d.add(
                material("oren_nayar")
                    .with("reflectance", rgb([0.6, 0.4, 0.3]))
                    .with("form", "full")
                    .with("sigma", 0.5),
            )
        }),
        case("velvet", "minnaert", false, |d| {
            d.add(material("minnaert").with("reflectance", white(0.7)).with("k", 1.5))
        }),
        case("Phong", "phong", false, |d| d.add(material("phong"))),
        case("Lafortune", "lafortune", false, |d| d.add(material("lafortune").with("exponent", 8.0))),
        case("Blinn–Phong", "blinn_phong", false, |d| d.add(material("blinn_phong"))),
        case("Ward, brushed", "ward", false, |d| d.add(material("ward").with("alpha_u", 0.3).with("alpha_v", 0.1))),
        case("Cook–Torrance", "cook_torrance", false, |d| d.add(material("cook_torrance"))),
        case("white under a film", "cook_torrance", false, |d| {
            let m = material("cook_torrance").with("diffuse_reflectance", white(1.0)).with("coupling", "fresnel");
            d.add(m.with("specular_reflectance", white(1.0)).with("alpha_u", 0.0).with("film_thickness", 400.0))
        }),
        case("compensated mirror", "conductor", false, |d| {
            d.add(material("conductor").with("alpha_u", 0.5).with("compensation", "kulla_conty"))
        }),
        case("hair", "hair", false, |d| d.add(material("hair").with("round", true))),
        case("white hair", "hair", true, |d| d.add(material("hair").with("sigma_a", white(0.0)).with("round", true))),
        case("varnished copper", "coated_conductor", false, |d| {
            d.add(material("coated_conductor").with("conductor.uroughness", 0.3))
        }),
        case("milk over grey", "coated_diffuse", false, |d| {
            d.add(material("coated_diffuse").with("albedo", white(0.8)).with("thickness", 0.4).with("g", 0.3))
        }),
        case("Disney's", "principled", false, |d| d.add(material("principled").with("spec_trans", 0.3))),
        case("Disney's paper", "principledthin", false, |d| d.add(material("principledthin").with("diff_trans", 0.8))),
        case("glTF's", "metallic_roughness", false, |d| {
            d.add(material("metallic_roughness").with("metallic", 0.0).with("roughness", 0.4).with("clearcoat", 0.5))
        }),
        case("OpenPBR's", "openpbr", false, |d| {
            d.add(material("openpbr").with("transmission_weight", 0.5).with("fuzz_weight", 0.4))
        }),
        case("velvet with sheen", "sheen", false, |d| d.add(material("sheen"))),
        case("tempered metal", "conductor", false, |d| {
            d.add(
                material("conductor")
                    .with("permittivity", -9.0)
                    .with("conductivity", 2e5)
                    .with("film_thickness", 250.0),
            )
        }),
    ]
}

/// Kinds that paths alone follow, whose light does not leave where or as it came: they have tests of their own.
const FOR_PATHS_ALONE: [&str; 2] = ["fluorescent", "subsurface"];

/// A kind of spectral mode alone, which RGB mode approximates: see [`super::grating`].
const SPECTRAL_ALONE: &str = "grating";

/// All cases. Fails if a registered kind has none.
pub fn cases() -> Vec<Case> {
    let cases: Vec<Case> = [surfaces(), compounds(), models()].into_iter().flatten().collect();
    let has_own_tests = |kind: &&str| FOR_PATHS_ALONE.contains(kind) || *kind == SPECTRAL_ALONE;
    for kind in MATERIALS.iter().map(|m| m.kind).filter(|kind| !has_own_tests(kind)) {
        assert!(cases.iter().any(|c| c.kind == kind), "material '{kind}' has no case");
    }
    cases
}

//! OpenPBR's surface in scenes: the light and the medium that it says itself, its coat's darkening, its rough base.

use std::sync::Arc;
use steradian::{
    CompileOptions, Quality, Scene,
    bsdf::{Bsdf, OrenNayar, OrenNayarForm, TransportMode, fresnel},
    compile,
    formats::Options,
    load,
    math::{Spectrum, Vec3, spectra::ColorMode},
    render,
};

/// The middle of a unit ball, seen along −z through one small pixel.
fn middle(material: &str, light: &str, spp: u32) -> [f64; 3] {
    let scene = scene(material, light);
    let picture = render(&scene, &Quality { spp: Some(spp), seed: Some(3), ..Quality::default() }).expect("a picture");
    ["R", "G", "B"].map(|name| f64::from(picture.channel(name).expect("a colour")[0]))
}

fn scene(material: &str, light: &str) -> Arc<Scene> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.steradian");
    let text = format!(
        "steradian: 1
         film: {{film: rgb, width: 1, height: 1}}
         filter: {{filter: box}}
         camera: {{camera: perspective, fov: 0.1, to_world: {{look_at: [0 0 0], from: [0 0 5]}}}}
         shapes: [{{shape: sphere, radius: 1, material: {{material: openpbr, {material}}}}}]
         lights: [{light}]"
    );
    std::fs::write(&path, text).expect("written");
    let loaded = load(&path, &Options::default());
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let compiled = compile(&loaded.desc, &options);
    assert!(compiled.diagnostics.is_empty(), "{:?}", compiled.diagnostics);
    Arc::new(compiled.scene.expect("a scene"))
}

const SKY: &str = "{light: environment, radiance: {rgb: [1, 1, 1]}}";
/// Light along the line of sight.
const LAMP: &str = "{light: distant, radiance: {rgb: [1, 1, 1]}, direction: [0 0 -1]}";

fn is_near(seen: [f64; 3], expected: [f64; 3], relative: f64) {
    let near = seen.iter().zip(expected).all(|(a, b)| (a - b).abs() <= relative * b.abs() + 1e-6);
    assert!(near, "{seen:?}, expected {expected:?}");
}

/// Light on its way through the ball becomes `transmission_color` to the power of the way over the depth.
#[test]
fn light_becomes_the_colour_of_the_medium_on_its_depth() {
    let clear = "base_weight: 0, specular_weight: 0, specular_ior: 1, transmission_weight: 1, specular_roughness: 0";
    let tinted =
        |depth: f64| format!("{clear}, transmission_color: {{rgb: [0.25, 0.5, 1]}}, transmission_depth: {depth}");
    is_near(middle(&tinted(2.0), SKY, 64), [0.25, 0.5, 1.0], 2e-3);
    is_near(middle(&tinted(4.0), SKY, 64), [0.5, 0.5_f64.sqrt(), 1.0], 2e-3);
    // A white scatterer in an even sky takes nothing away; a colour of the surface counts at both of its sides.
    let white = format!("{clear}, transmission_color: 0.25, transmission_depth: 2, transmission_scatter: 8");
    is_near(middle(&white, SKY, 256), [1.0; 3], 5e-3);
    is_near(middle(&format!("{clear}, transmission_color: 0.5"), SKY, 64), [0.25; 3], 2e-3);
}

/// Emission is seen through the coat, and there is no light beside it.
#[test]
fn surfaces_shine_through_their_coat() {
    let glow = "base_weight: 0, specular_weight: 0, emission_luminance: 2, emission_color: {rgb: [1, 0.5, 0.25]}";
    is_near(middle(glow, "", 4), [2.0, 1.0, 0.5], 1e-4);
    let coated = format!("{glow}, coat_weight: 1, coat_ior: 1, coat_color: {{rgb: [0.25, 1, 0.0625]}}");
    is_near(middle(&coated, "", 4), [1.0, 1.0, 0.125], 1e-4);
}

/// The factor that a coat darkens a diffuse base by, in the closed form of the specification.
#[test]
fn coats_darken_what_is_not_white() {
    let coated = |albedo: f64, darkening: f64| {
        let surface = format!("base_color: {albedo}, specular_weight: 0, coat_weight: 1, coat_darkening: {darkening}");
        middle(&surface, LAMP, 16)[0]
    };
    let eta = 1.6_f32;
    let mean = f64::from(fresnel::dielectric_diffuse(eta));
    let back = 1.0 - (1.0 - mean) / f64::from(eta * eta);
    for albedo in [0.2, 0.5, 0.9] {
        let expected = (1.0 - back) / (1.0 - albedo * back);
        let ratio = coated(albedo, 1.0) / coated(albedo, 0.0);
        assert!((ratio / expected - 1.0).abs() < 5e-3, "{albedo}: {ratio}, expected {expected}");
        let half = coated(albedo, 0.5) / coated(albedo, 0.0);
        assert!((half / (0.5 + 0.5 * expected) - 1.0).abs() < 5e-3, "{albedo}: {half}");
    }
    assert!((coated(1.0, 1.0) / coated(1.0, 0.0) - 1.0).abs() < 5e-3);
}

/// The rough base alone is the energy-preserving form of Oren and Nayar's surface, and a white one under gloss loses
/// nothing to roughness.
#[test]
fn rough_bases_are_those_of_eon() {
    let slanted = "{light: distant, radiance: {rgb: [1, 1, 1]}, direction: [-2 0 -1]}";
    for roughness in [0.0, 0.3, 1.0] {
        let openpbr = middle(
            &format!("base_color: {{rgb: [0.9, 0.5, 0.1]}}, specular_weight: 0, base_diffuse_roughness: {roughness}"),
            slanted,
            4,
        );
        let wo = Vec3::new(0.0, 0.0, 1.0);
        let wi = Vec3::new(2.0, 0.0, 1.0).normalize();
        let steps = (roughness * 127.0_f32).round() / 127.0;
        let form = OrenNayarForm::EnergyPreserving;
        let albedo = Spectrum::rgb(0.9, 0.5, 0.1);
        let eon = OrenNayar::new(albedo, steps, form);
        let value = Bsdf::OrenNayar(eon).eval(wo, wi, TransportMode::Radiance);
        let expected = value.value.to_rgb().map(f64::from);
        is_near(openpbr, expected, 2e-3);
    }
}

/// Other formats get the light and the medium as those of the shape.
#[test]
fn light_and_media_survive_conversion() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.steradian");
    let text = "steradian: 1
        camera: {camera: perspective, fov: 10, to_world: {look_at: [0 0 0], from: [0 0 5]}}
        shapes: [
          {shape: sphere, radius: 1, material: {material: openpbr, transmission_weight: 1, transmission_depth: 2,
             transmission_color: {rgb: [0.25, 0.5, 1]}}}
          {shape: sphere, radius: 0.1, center: [0 3 0], material: {material: openpbr, emission_luminance: 7}}
        ]";
    std::fs::write(&path, text).expect("written");
    let desc = load(&path, &Options::default()).desc;
    for (name, light, medium) in [("a.pbrt", "AreaLightSource", "\"homogeneous\""), ("a.xml", "<emitter", "<medium")] {
        let written = steradian::formats::write::write(&desc, &folder.path().join(name)).expect("written");
        let text = String::from_utf8(written.bytes).expect("text");
        assert!(text.contains(light) && text.contains(medium), "{name}: {text}");
    }
    let own = steradian::formats::write::write(&desc, &folder.path().join("a.steradian")).expect("written");
    let text = String::from_utf8(own.bytes).expect("text");
    assert!(text.contains("emission_luminance: 7") && !text.contains("homogeneous"), "{text}");
}

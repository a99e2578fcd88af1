//! Light that enters a surface and leaves it elsewhere.

use crate::subsurface::seen;
use std::sync::Arc;
use steradian::{CompileOptions, Quality, Scene, compile, formats::Options, load, render};

/// A ball, seen from afar under an even sky of one, so that each point of its face counts by its cosine.
fn ball(material: &str) -> Arc<Scene> {
    scene(&format!(
        "shapes: [{{shape: sphere, radius: 1, {material}}}]
         lights: [{{light: environment, radiance: {{rgb: [1, 1, 1]}}}}]"
    ))
}

fn scene(world: &str) -> Arc<Scene> {
    let text = crate::subsurface::text("volpath", world);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.steradian");
    std::fs::write(&path, text).expect("written");
    let loaded = load(&path, &Options::default());
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    let options = CompileOptions { mode: Some(steradian::math::spectra::ColorMode::Rgb), ..CompileOptions::default() };
    let compiled = compile(&loaded.desc, &options);
    assert!(compiled.diagnostics.is_empty(), "{:?}", compiled.diagnostics);
    Arc::new(compiled.scene.expect("a scene"))
}

fn below(method: &str, what: &str) -> String {
    format!("material: {{material: subsurface, method: {method}, eta: 1.33, {what}}}")
}

const COEFFICIENTS: &str = "sigma_a: {rgb: [0.02, 0.1, 0.5]}, sigma_s: {rgb: [2, 3, 4]}, g: 0.3";

/// A walk at random below a surface brings, over the whole face of a ball under an even sky, exactly what `volpath`
/// finds in a ball of glass that is filled with the medium: the two differ only in the directions in which light passes
/// the surface, whose mean the face takes. Within 5σ of the frames, and by less than 0.004.
#[test]
fn walks_bring_what_the_medium_brings() {
    let walk = seen(&ball(&below("random_walk", COEFFICIENTS)), 64);
    let filled = ball(&format!(
        "material: {{material: dielectric, eta: 1.33}}, interior: {{medium: homogeneous, {COEFFICIENTS}}}"
    ));
    let filled = seen(&filled, 64);
    for ((a, va), (b, vb)) in walk.into_iter().zip(filled) {
        assert!((a - b).abs() < 5.0 * (va + vb).sqrt() && (a - b).abs() < 4e-3, "{walk:?} {filled:?}");
    }
}

/// Without absorption below all light comes back: a ball is not seen before an even sky.
#[test]
fn nothing_is_lost_where_nothing_is_absorbed() {
    for what in ["sigma_a: 0, sigma_s: {rgb: [1, 3, 9]}", "reflectance: 1, mfp: 0.2, g: -0.4"] {
        for (mean, variance) in seen(&ball(&below("random_walk", what)), 16) {
            assert!((mean - 1.0).abs() < 5.0 * variance.sqrt().max(2e-4), "{what}: {mean} ± {}", variance.sqrt());
        }
    }
}

/// In a ball that is large against the mean free path all methods bring nearly the same; of the light that enters the
/// part `reflectance` comes back, where that is asked for. A profile leaves out what diffusion does, by some per cent.
#[test]
fn methods_agree_on_dense_media() {
    let reflected_by_surface = {
        let black = seen(&ball(&below("random_walk", "sigma_a: 1000, sigma_s: 0")), 16);
        black[0].0
    };
    for (method, allowed) in
        [("random_walk", 0.015), ("photon_beam", 0.03), ("dipole", 0.03), ("normalized_diffusion", 0.03)]
    {
        let found = seen(&ball(&below(method, "reflectance: {rgb: [0.8, 0.5, 0.2]}, mfp: 0.005")), 16);
        // Of the face, π/4 of the picture, what is not reflected at the surface enters.
        let entered = 1.0 - reflected_by_surface;
        for ((mean, _), expected) in found.into_iter().zip([0.8, 0.5, 0.2]) {
            let albedo = (mean - reflected_by_surface) / entered;
            assert!((albedo - expected).abs() < allowed, "{method}: {albedo}, not {expected}");
        }
    }
}

/// Methods that do not follow light below surfaces refuse it by name, and the picture of the pipeline shows what looks
/// alike from afar.
#[test]
fn other_methods_say_that_they_do_not_follow_it() {
    let scene = ball(&below("photon_beam", "reflectance: 0.6, mfp: 0.01"));
    for name in ["bdpt", "light", "vcm", "sppm", "photon", "pssmlt", "mmlt", "whitted", "stokes"] {
        let quality = Quality { integrator: Some(name.into()), spp: Some(1), ..Quality::default() };
        let refusal = render(&scene, &quality).expect_err("it is refused").to_string();
        assert!(refusal.contains("below surfaces") && refusal.contains(name), "{refusal}");
    }
    let quality = Quality { integrator: Some("raster".into()), spp: Some(4), ..Quality::default() };
    let left_out = quality.render(&scene).expect("a method").left_out(&scene).expect("it is told");
    assert!(left_out.approximated().contains("below surfaces"), "{left_out:?}");
    let picture = render(&scene, &quality).expect("a picture");
    let middle = picture.channel("G").expect("green")[12 * 24 + 12];
    assert!((middle - 0.6).abs() < 0.1, "{middle}");
}

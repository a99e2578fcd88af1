//! Irradiance caching against path tracing.

use crate::{
    shot::{Shot, is_exactly, mean},
    stage::{Stage, cuboid, diffuse, light, sphere, white},
};
use std::f64::consts::FRAC_1_PI;
use steradian_core::{ColorMode, Scene};
use steradian_integrators::{Control, Film};

/// A room with a block and a lamp below its ceiling.
fn room() -> Scene {
    let mut stage = Stage::new();
    stage.solid(sphere([0.0, 0.0, 0.0], 2.0), diffuse(0.7));
    let grey = stage.add(diffuse(0.5));
    stage.place_mesh(cuboid([-0.5, -1.8, 0.2], [0.5, -0.8, 1.0])).material = Some(grey);
    stage.lamp(sphere([0.2, 1.2, 0.2], 0.3), 5.0);
    stage.film(16, 16).look([0.0, 0.2, -1.7], [0.0, -0.3, 0.5], 60.0);
    stage.scene()
}

fn film(scene: &Scene, options: &str, shot: Shot) -> Film {
    let method = shot.method(scene, options);
    let mut session = shot.session_of(scene, &*method);
    session.step(u32::MAX, &Control::default());
    session.film()
}

/// relMSE of green.
fn error(film: &Film, right: &Film) -> f64 {
    let pairs = || film.pixels.iter().zip(&right.pixels).map(|(a, b)| (a.mean()[1], b.mean()[1]));
    pairs().map(|(a, b)| (a - b).powi(2) / (b * b + 0.01)).sum::<f64>() / pairs().count() as f64
}

/// The picture is that of paths, with less error for as many samples of pixels. Where records reach far, gradients
/// lower the error.
#[test]
fn rooms_are_those_of_paths() {
    let scene = room();
    let right = Shot::of("path", 1500).roulette_after(2).take(&scene);
    let cached = |options: &str| film(&scene, options, Shot::of("irradiance-cache", 64).roulette_after(2));
    let with = cached("rays=1024,error=0.8,min_spacing=1");
    let without = cached("rays=1024,error=0.8,min_spacing=1,gradients=false");
    let (a, b) = (mean(&with).mean[1], mean(&right).mean[1]);
    assert!((a / b - 1.0).abs() < 0.02, "{a}, not {b}");
    let [exact, flat] = [&with, &without].map(|film| error(film, &right));
    let paths = error(&Shot::of("path", 64).roulette_after(2).take(&scene), &right);
    assert!(exact < 0.5 * paths && exact < flat, "{exact}, without gradients {flat}, paths {paths}");
}

/// A ball of the reflectance ρ about a point light of intensity I at its middle: every bounce adds ρ times the
/// irradiance I/R² of the one before, the same everywhere, and the gradients are zero. In spectral renders the
/// indirect part keeps the colour of the light but for its features between the wavelengths of records.
#[test]
fn balls_are_alike_everywhere() {
    let (rho, intensity, radius, bounces) = (0.5, 3.0, 2.0, 5);
    let mut stage = Stage::new();
    stage.solid(sphere([0.0, 0.0, 0.0], radius), diffuse(rho));
    stage.light(light("point").with("intensity", white(intensity)));
    stage.film(8, 8).look([0.0, 0.2, -1.7], [0.0, -0.3, 0.5], 60.0);
    let right = (1..=bounces).map(|k| rho.powi(k)).sum::<f64>() * FRAC_1_PI * intensity / (radius * radius);
    let shot = Shot::of("irradiance-cache", 4).depth(bounces as u32);
    is_exactly(&film(&stage.scene(), "rays=64", shot), "ball", [right; 3]);
    let scene = stage.scene_in(ColorMode::Spectral);
    let many = Shot { spp: 256, ..shot };
    let [cached, paths] =
        [film(&scene, "rays=16,wavelengths=64", many), Shot { integrator: "path", ..many }.take(&scene)];
    for (a, b) in mean(&cached).mean.into_iter().zip(mean(&paths).mean) {
        assert!((a / b - 1.0).abs() < 0.01, "{a}, not {b}");
    }
}

/// Options that no record can have are refused with numbers; without records the picture is that of paths.
#[test]
fn options_have_bounds() {
    let scene = room();
    let shot = Shot::of("irradiance-cache", 1);
    for options in ["min_spacing=9,max_spacing=3", "records=10000000"] {
        let method = shot.method(&scene, options);
        let plan =
            steradian_integrators::Plan::new(steradian_core::sampler::Sampler { kind: shot.sampler, spp: 1, seed: 1 });
        let refused = method.session(std::sync::Arc::new(scene.clone()), plan).err();
        assert!(refused.is_some_and(|r| r.to_string().contains(char::is_numeric)), "{options}");
    }
    let paths = Shot::of("path", 4).take(&scene);
    let none = film(&scene, "records=0", Shot::of("irradiance-cache", 4));
    crate::shot::same_bits(&paths, &none, "without records");
}

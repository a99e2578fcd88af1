//! Samples that are the mean of several paths, where a pilot tells that this pays.

use crate::{
    shot::{Shot, mean, same_bits},
    stage::{Stage, material, rectangle, sphere, white},
};
use steradian_core::{Scene, film::Crop, sampler::SamplerKind};
use steradian_integrators::Control;

/// A rough ball before a sky that has no noise.
fn ball() -> Scene {
    let mut stage = Stage::new();
    stage.solid(
        sphere([0.0; 3], 1.0),
        material("conductor").with("reflectance", white(0.8)).with("alpha_u", 0.6).with("alpha_v", 0.6),
    );
    stage.mesh_lamp(rectangle([4.0, 3.0, -2.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.0]), 90.0);
    stage.sky(0.5).film(256, 256).look([0.0, 0.0, -10.0], [0.0; 3], 40.0);
    stage.scene()
}

/// The relative squared error of a film by its own samples, summed, and the rays it took.
fn err(shot: Shot, scene: &Scene) -> (f64, f64) {
    let mut session = shot.session(scene);
    session.step(u32::MAX, &Control::default());
    let rays = session.counters().rays as f64;
    (session.error().unwrap().powi(2), rays)
}

/// The mean is that of even paths, at less variance × cost; all pixels have the samples that were asked for, and
/// neither crops nor threads nor steps change a bit.
#[test]
fn splitting_pays_and_changes_nothing_else() {
    let scene = ball();
    let even = Shot { sampler: SamplerKind::Sobol, ..Shot::of("path", 16) };
    let split = Shot { effort: None, ..even };
    let (film, other) = (split.take(&scene), even.seed(2).take(&scene));
    mean(&film).agrees("a ball", mean(&other), 1e-3);
    assert!(film.pixels.iter().all(|p| p.samples == 16));

    let (more, less) = (err(even, &scene), err(split, &scene));
    assert!(less.1 > more.1, "no pixel has more paths");
    let gain = (more.0 * more.1) / (less.0 * less.1);
    assert!(gain > 1.5, "{gain}");

    same_bits(&film, &Shot { threads: 3, ..split }.take(&scene), "three threads");
    let mut session = split.session(&scene);
    for n in [3, 5, 100] {
        session.step(n, &Control::default());
    }
    same_bits(&film, &session.film(), "three steps");
    let crop = Crop { x0: 90, y0: 100, x1: 131, y1: 117 };
    let cropped = scene.clone().changed(|parts| parts.film.crop = crop);
    let part = split.take(&cropped);
    for (k, p) in part.pixels.iter().enumerate() {
        let (x, y) = (90 + k % 41, 100 + k / 41);
        assert_eq!(film.pixels[y * 256 + x].sum.map(f64::to_bits), p.sum.map(f64::to_bits), "pixel {x}, {y}");
    }
}

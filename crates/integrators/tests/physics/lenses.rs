//! Cameras with lenses of several elements: what they do to light, in pictures.

use crate::{
    shot::{SIGMAS, Shot},
    stage::{Stage, diffuse, look_at, plane},
};
use std::f64::consts::PI;
use steradian_core::ColorMode;
use steradian_scene::{Family, Node};

/// A biconvex lens of about 60 mm with a stop of 2 mm behind it, its glass with or without dispersion, before a film of
/// 8 × 6 pixels and a diagonal of 40 mm.
fn camera(abbe: f64) -> Node {
    let elements = vec![60.0, 1.0, 1.5, 20.0, -60.0, 1.0, 1.0, 20.0, 0.0, 50.0, 0.0, 2.0];
    Node::new(Family::Camera, "realistic", None)
        .with("elements", elements)
        .with("abbe", vec![abbe, 0.0, 0.0])
        .with("film_diagonal", 40.0)
        .with("focus_distance", 100.0)
}

/// M130: a uniform environment lights the film by the solid angle of the stop, weighted with the cosine there: the
/// fourth power of the cosine; with dispersion, too, where light of each wavelength goes its own way.
#[test]
fn a_uniform_environment_falls_off_by_the_fourth_power_of_the_cosine() {
    for (mode, abbe) in [(ColorMode::Rgb, 0.0), (ColorMode::Spectral, 0.0), (ColorMode::Spectral, 30.0)] {
        let mut stage = Stage::new();
        stage.sky(2.0).film(8, 6).camera(camera(abbe));
        let scene = stage.scene_in(mode);
        let film = Shot::of("path", 4000).take(&scene);
        // Where the stop is: the focal length by the lensmaker's equation, and the principal plane of a thick lens.
        let f = 1.0 / (0.5 * (2.0 / 60.0 - 0.5 / (1.5 * 3600.0)));
        let principal = f * 0.5 / (1.5 * 60.0);
        let stop_to_film = f * 100_000.0 / (100_000.0 - f) - principal - 1.0;
        for y in 0..6 {
            for x in 0..8 {
                let p = &film.pixels[8 * y + x];
                // The mean over the pixel of a side of 4 mm, by the midpoint rule.
                let mut expected = 0.0;
                for k in 0..64 {
                    let at = |i: usize, n: usize, k: usize| (i as f64 + (k as f64 + 0.5) / 8.0 - 0.5 * n as f64) * 4.0;
                    let r2 = at(x, 8, k % 8).powi(2) + at(y, 6, k / 8).powi(2);
                    let s2 = stop_to_film * stop_to_film;
                    expected += 2.0 * PI / s2 * (s2 / (s2 + r2)).powi(2) / 64.0;
                }
                // The stop of 1 mm radius is a disk, not a point: 2 (1/59)² at most.
                let (m, s) = (p.mean()[1], p.variance_of_mean()[1].sqrt());
                let what = format!("{mode:?}, Abbe {abbe}, pixel {x} {y}: {m} ± {s} for {expected}");
                assert!((m - expected).abs() <= SIGMAS * s + 2e-3 * expected && s < 0.05 * expected, "{what}");
            }
        }
    }
}

/// Methods that need the way from a point back to the film refuse such a camera and say why.
#[test]
fn what_needs_an_inverse_refuses() {
    let mut stage = Stage::new();
    stage.sky(1.0).film(4, 4).camera(camera(0.0).with("to_world", look_at([0.0, 1.0, 0.0], [0.0, 0.5, 1.0])));
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.5));
    let scene = stage.scene();
    for name in ["light", "bdpt", "vcm", "sppm", "photon", "pssmlt", "mmlt"] {
        let refusal = Shot::of(name, 1).limit(&scene).expect("a refusal");
        assert!(refusal.contains("lens of several elements"), "{name}: {refusal}");
    }
    assert!(Shot::of("path", 1).limit(&scene).is_none());
}

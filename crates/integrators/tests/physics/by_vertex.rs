//! Roulette and splitting by what is known of vertices.

use crate::{
    reuse::{lenses, quadrants},
    shot::{Shot, same_bits},
    stage::medium,
    stage::{sphere, white},
};
use steradian_core::{ColorMode, sampler::SamplerKind};

/// The mean is that of throughput's roulette, alone and shared, with glass and mirrors, in RGB and spectral mode, where
/// paths lose wavelengths.
#[test]
fn effort_by_vertex_is_unbiased() {
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        let scene = lenses().scene_in(mode);
        let shot = Shot { sampler: SamplerKind::Sobol, ..Shot::of("path", 32).depth(6) };
        let even = quadrants(shot.reuse(16), &scene, 24);
        for reuse in [1, 16] {
            let by_vertex = quadrants(Shot { by_vertex: true, ..shot.reuse(reuse) }, &scene, 16);
            for (q, (a, b)) in by_vertex.iter().zip(&even).enumerate() {
                a.agrees(&format!("{mode:?}, {reuse} paths, quadrant {q}"), *b, 0.1);
            }
        }
    }
}

/// The same in a medium.
#[test]
fn effort_by_vertex_is_unbiased_in_media() {
    let mut stage = lenses();
    let what = stage.add(medium(white(0.1), white(0.6)));
    let ball = stage.place(sphere([0.0, 1.2, 0.0], 0.5));
    (ball.interior, ball.is_medium_boundary) = (Some(what), true);
    let scene = stage.scene();
    let shot = Shot { sampler: SamplerKind::Sobol, ..Shot::of("volpath", 32).depth(6) };
    let even = quadrants(shot.reuse(16), &scene, 24);
    let by_vertex = quadrants(Shot { by_vertex: true, ..shot.reuse(16) }, &scene, 16);
    for (q, (a, b)) in by_vertex.iter().zip(&even).enumerate() {
        a.agrees(&format!("quadrant {q}"), *b, 0.1);
    }
}

/// It changes the picture, and neither the recursive form nor the number of threads changes a bit of that.
#[test]
fn effort_by_vertex_is_the_same_on_every_run() {
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        let scene = lenses().scene_in(mode);
        for reuse in [1, 16] {
            let shot = Shot { by_vertex: true, ..Shot::of("path", 4) }.depth(8).reuse(reuse);
            let film = shot.take(&scene);
            let what = format!("{mode:?}, {reuse} paths");
            same_bits(&film, &Shot { integrator: "path-recursive", ..shot }.take(&scene), &what);
            same_bits(&film, &Shot { threads: 3, ..shot }.take(&scene), &what);
            let even = Shot { by_vertex: false, ..shot }.take(&scene);
            assert!(film.pixels.iter().zip(&even.pixels).any(|(a, b)| a.mean() != b.mean()), "{what}");
        }
    }
}

//! The film: what a pixel measures, and how well it knows it.

use crate::{
    shot::{SIGMAS, Shot, is_exactly, mean},
    stage::{Stage, diffuse, light, plane, rectangle, shape, white},
};
use steradian_core::{
    Scene,
    sampler::{SAMPLERS, SamplerKind},
};
use steradian_math::Vec2;
use steradian_scene::{Family, Node};

/// A picture of a half plane of radiance one whose edge runs at `x = edge` pixels, upright, by parallel projection: one
/// unit is one pixel.
fn step_edge(filter: &str, edge: f64) -> Stage {
    let mut stage = Stage::new();
    stage.mesh_lamp(rectangle([edge - 8.0 - 100.0, -50.0, 1.0], [0.0, 100.0, 0.0], [100.0, 0.0, 0.0]), 1.0);
    let filter = stage.add(Node::new(Family::Filter, filter, None));
    stage.desc.filter = Some(filter);
    let camera = Node::new(Family::Camera, "orthographic", None).with("screen_window", vec![-8.0, 8.0, -1.0, 1.0]);
    stage.film(16, 2).camera(camera);
    stage
}

/// M165: a step edge under every registered filter is its integral up to the edge, in every column: 4σ; far from the
/// edge a filter of one sign is exactly black and white.
#[test]
fn filters_on_a_step_edge() {
    for name in Family::Filter.kinds() {
        for edge in [8.0, 8.3, 7.5] {
            let scene = step_edge(name, edge).scene();
            let film = Shot::of("path", 8_000).take(&scene);
            let filter = &scene.film().filter;
            // The integral over an axis, by the midpoint rule; the other axis cancels.
            let integral = |to: f64| {
                let (n, r) = (40_000, 8.0);
                let h = (to + r) / f64::from(n);
                (0..n)
                    .map(|i| f64::from(filter.evaluate(Vec2::new((-r + (f64::from(i) + 0.5) * h) as f32, 0.0))) * h)
                    .sum::<f64>()
            };
            let whole = integral(8.0);
            for x in 0..16 {
                let expected = integral(edge - (f64::from(x) + 0.5)) / whole;
                for y in 0..2 {
                    let p = &film.pixels[(16 * y + x) as usize];
                    let (m, s) = (p.mean()[0], p.variance_of_mean()[0].sqrt());
                    assert!(s < 0.02, "{name}: too noisy, {s}");
                    // Tabulated densities are known to 10⁻³.
                    assert!(
                        (m - expected).abs() <= SIGMAS * s + 1e-3,
                        "{name}, edge at {edge}, column {x}: {m} for {expected}"
                    );
                }
            }
        }
    }
}

/// M165: no filter changes the mean of a constant picture: exact for those that are sampled without weights, else 4σ.
#[test]
fn filters_keep_constants() {
    for name in Family::Filter.kinds() {
        let scene = step_edge(name, 60.0).scene();
        let film = Shot::of("path", 2_000).take(&scene);
        mean(&film).is_near_grey(name, 1.0, 1e-2);
        if ["box", "tent"].contains(&name) {
            is_exactly(&film, name, [1.0; 3]);
        }
    }
}

/// M154: error bars tell the truth: intervals of 1.96 standard errors around the mean of independent samples hold the
/// true value in 95 % of 6 400 pixels, within 4σ of the binomial and half a percent for the skewness of 200 samples.
#[test]
fn error_bars_cover_the_truth() {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
    // A disk over a point, r = h = 1: E = π/2; half of it is found by each way of sampling.
    let lamp = stage.lamp(shape("disk").with("radius", 1.0).with("height", 1.0), 1.0);
    lamp.reverse_orientation = true;
    stage.probe([0.1, 0.0, 0.5], [0.0; 3]).film(80, 80);
    let film = Shot::of("direct", 200).take(&stage.scene());
    let inside =
        film.pixels.iter().filter(|p| (p.mean()[0] - 0.5).abs() < 1.96 * p.variance_of_mean()[0].sqrt()).count();
    let n = film.pixels.len() as f64;
    let (share, sigma) = (inside as f64 / n, (0.95_f64 * 0.05 / n).sqrt());
    assert!((share - 0.95).abs() < SIGMAS * sigma + 0.005, "{share} of the intervals hold the truth");
}

/// A white plane below a disk of unit radiance, radius and height, whose form factor there is r²/(r² + h²) = ½.
fn below_a_disk() -> Scene {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
    let lamp = stage.lamp(shape("disk").with("radius", 1.0).with("height", 1.0), 1.0);
    lamp.reverse_orientation = true;
    stage.probe([0.1, 0.0, 0.5], [0.0; 3]).film(24, 24);
    stage.scene()
}

/// M153, M154: the error falls as the samples grow, for every sampler: about as n^−½ for independent ones, no slower
/// for the others. Root mean square over pixels against the closed form π/2.
#[test]
fn errors_fall_with_samples() {
    let scene = below_a_disk();
    for (name, sampler) in SAMPLERS.iter().filter(|(name, _)| *name != "fixed") {
        let error = |spp| {
            let film = Shot { sampler: *sampler, ..Shot::of("direct", spp) }.take(&scene);
            let squares: f64 = film.pixels.iter().map(|p| (p.mean()[0] - 0.5).powi(2)).sum();
            (squares / film.pixels.len() as f64).sqrt()
        };
        let (few, many) = (error(16), error(256));
        // Independent samples gain a factor of four.
        let gain = few / many;
        assert!(gain > 3.4, "{name}: {few} with 16 samples, {many} with 256");
        if *name == "independent" {
            assert!(gain < 4.6, "{name}: {few} with 16 samples, {many} with 256");
        } else {
            // The place on the lamp has bases 31 and 37 of Halton's, which take more than 16 samples.
            assert!((few < 0.03 || *name == "halton") && gain > 4.5, "{name}: {few} with 16 samples, {many} with 256");
        }
    }
}

/// M153: with one list of numbers for all pixels, neighbours err alike, which shows as a pattern; with independent ones
/// they do not. Correlation of the errors of neighbours against the closed form.
#[test]
fn one_list_for_all_pixels_makes_patterns() {
    let scene = below_a_disk();
    for (sampler, least, most) in [(SamplerKind::Fixed, 0.99, 1.01), (SamplerKind::Independent, -0.2, 0.2)] {
        // Four seeds, since one list has one error.
        let (mut together, mut squares) = (0.0, 0.0);
        for seed in 0..4 {
            let film = Shot { sampler, seed, ..Shot::of("direct", 16) }.take(&scene);
            let errors: Vec<f64> = film.pixels.iter().map(|p| p.mean()[0] - 0.5).collect();
            together += errors.windows(2).map(|e| e[0] * e[1]).sum::<f64>();
            squares += errors.windows(2).map(|e| e[0] * e[0]).sum::<f64>();
        }
        let correlation = together / squares;
        assert!((least..=most).contains(&correlation), "{sampler:?}: {correlation}");
    }
}

/// A sample that is brighter than `max_component` is scaled down to it, and no other. Exact.
#[test]
fn clamping_is_per_sample() {
    for (radiance, expected) in [(5.0, 2.0), (1.5, 1.5)] {
        let mut stage = Stage::new();
        stage.sky(radiance).look([0.0; 3], [0.0, 0.0, 1.0], 40.0);
        let film =
            Node::new(Family::Film, "rgb", None).with("width", 4_i64).with("height", 4_i64).with("max_component", 2.0);
        stage.desc.film = Some(stage.desc.add(film));
        is_exactly(&Shot::of("path", 4).take(&stage.scene()), "clamped sky", [expected; 3]);
    }
}

/// Lights can be hidden from the camera, and go on lighting. Exact.
#[test]
fn hidden_emitters_still_shine() {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(0.5));
    stage.light(light("environment").with("radiance", white(1.0)));
    stage.probe([0.0, 0.0, 3.0], [0.0, 0.0, 9.0]);
    let hidden = Shot { hide_emitters: true, ..Shot::of("path", 4) };
    is_exactly(&hidden.take(&stage.scene()), "hidden sky", [0.0; 3]);
    stage.probe([0.0, 0.0, 3.0], [0.0, 0.0, 0.0]);
    is_exactly(&hidden.take(&stage.scene()), "floor under a hidden sky", [0.5; 3]);
}

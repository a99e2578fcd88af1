//! Different ways through the space of paths lead to the same picture.

use crate::{
    shot::{Estimate, Shot, mean},
    stage::{
        Stage, cuboid, diffuse, found_by_scattering_alone, light, material, plane, rectangle, rgb, shape, sphere, white,
    },
};
use steradian_core::Scene;
use steradian_integrators::Film;
use steradian_math::{DVec3, Transform};

/// A room with a lamp and things that reflect in several ways; light goes round in it many times.
fn room(glass: bool) -> Stage {
    let mut stage = Stage::new();
    let wall = stage.add(material("diffuse").with("reflectance", rgb([0.8, 0.6, 0.4])));
    let walls = stage.place_mesh(cuboid([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]));
    (walls.material, walls.reverse_orientation) = (Some(wall), true);
    stage.mesh_lamp(rectangle([-0.6, 1.95, -0.6], [1.2, 0.0, 0.0], [0.0, 0.0, 1.2]), 3.0);
    let rough = material("conductor").with("reflectance", white(0.9)).with("alpha_u", 0.25);
    stage.solid(sphere([-0.45, 0.4, 0.2], 0.4), rough);
    let other = if glass {
        material("dielectric").with("eta", 1.5)
    } else {
        material("plastic").with("diffuse_reflectance", white(0.6))
    };
    stage.solid(sphere([0.45, 0.35, -0.2], 0.35), other);
    stage.film(12, 12).look([0.1, 1.0, -0.95], [0.0, 0.7, 1.0], 80.0);
    stage
}

/// The sum over pixels of the variance of a sample.
fn variance(film: &Film) -> f64 {
    film.pixels.iter().map(|p| p.variance_of_mean()[0] * f64::from(p.samples)).sum()
}

#[track_caller]
fn quadrants_agree(what: &str, a: &Film, b: &Film, precision: f64) {
    let part = |f: &Film, k: usize| -> Estimate {
        let pixels = f.pixels.chunks(f.pixels.len() / 4).nth(k).expect("four parts").to_vec();
        mean(&Film { pixels, ..f.clone() })
    };
    for k in 0..4 {
        part(a, k).agrees(&format!("{what}, part {k}"), part(b, k), precision);
    }
}

/// M150, M151: next-event estimation on every bounce with multiple importance sampling gives what brute force gives,
/// which meets the lamp by scattering alone: 4σ; and its variance is many times lower.
#[test]
fn next_event_estimation_equals_brute_force() {
    let scene = room(false).scene();
    let with = Shot::of("path", 1024).depth(4).take(&scene);
    let without = Shot::of("path", 4096).depth(4).seed(2).take(&found_by_scattering_alone(scene));
    quadrants_agree("brute force", &with, &without, 0.02);
    assert!(variance(&with) * 3.0 < variance(&without), "{} against {}", variance(&with), variance(&without));
}

/// M74, M151: a constant environment (found by scattering) and a sphere of a thousand metres around the scene that
/// emits the same (found both ways) are one and the same light: 4σ.
#[test]
fn an_environment_equals_a_large_sphere() {
    let lit = |by_sphere: bool| {
        let mut stage = Stage::new();
        stage.solid(shape("disk").with("radius", 2.0), diffuse(0.7)).world_from_object =
            Transform::rotate(DVec3::X, -std::f64::consts::FRAC_PI_2);
        stage.solid(sphere([0.0, 0.6, 0.0], 0.5), material("plastic").with("diffuse_reflectance", white(0.5)));
        stage.solid(
            sphere([0.9, 0.4, 0.3], 0.4),
            material("conductor").with("reflectance", white(0.9)).with("alpha_u", 0.3),
        );
        if by_sphere {
            stage.lamp(sphere([0.0; 3], 1000.0), 1.0).reverse_orientation = true;
        } else {
            stage.sky(1.0);
        }
        stage.film(12, 12).look([0.0, 1.5, -4.0], [0.2, 0.4, 0.0], 35.0);
        Shot::of("path", 600).depth(5).take(&stage.scene())
    };
    quadrants_agree("surroundings", &lit(false), &lit(true), 0.01);
}

/// Four glossy plates that each reflect a lamp to the camera; the power of the lamp does not depend on its radius
/// (after Veach 1997, fig. 9.2).
fn plates(radius: f64) -> Scene {
    let mut stage = Stage::new();
    stage.lamp(sphere([0.0, 4.0, 0.0], radius), 0.3 / (radius * radius));
    // Each is tilted so that its middle mirrors the camera at (0, 2, 15) to the lamp.
    for (i, alpha) in [0.02, 0.07, 0.2, 0.45].into_iter().enumerate() {
        let z = 3.0 + 1.6 * i as f64;
        let p = DVec3::new(0.0, -1.5 - 0.5 * i as f64, z);
        let half =
            ((DVec3::new(0.0, 4.0, 0.0) - p).normalize() + (DVec3::new(0.0, 2.0, 15.0) - p).normalize()).normalize();
        let across = DVec3::X.cross(half).normalize();
        let corner = p - DVec3::X * 1.5 - across * 0.5;
        let mesh = rectangle(corner.to_array(), [3.0, 0.0, 0.0], across.to_array());
        let plate = stage.add(material("conductor").with("reflectance", white(0.8)).with("alpha_u", alpha));
        stage.place_mesh(mesh).material = Some(plate);
    }
    // The lamp itself is above the frame: it has no spread, whatever the technique.
    stage.film(24, 16).look([0.0, 2.0, 15.0], [0.0, -2.6, 4.5], 18.0);
    stage.scene()
}

/// M150: Veach's experiment: scattering, light sampling, and both with the power heuristic have the same mean (4σ).
/// Small lamps are a matter for light sampling, large ones in smooth plates for scattering; together they are nearly as
/// good as the better, and over all better than either.
#[test]
fn multiple_importance_sampling_beats_either_technique() {
    let mut sum = [0.0; 3];
    for radius in [0.1_f64, 0.3, 0.9, 2.0] {
        let scene = plates(radius);
        let lights = Shot::of("whitted", 400).take(&scene);
        let both = Shot::of("direct", 400).seed(2).take(&scene);
        let scattering = Shot::of("direct", 2000).seed(3).take(&found_by_scattering_alone(scene));
        mean(&both).agrees("light sampling", mean(&lights), 0.05);
        mean(&both).agrees("scattering", mean(&scattering), 0.08);
        let [v, l, s] = [&both, &lights, &scattering].map(variance);
        assert!(v < 1.2 * l.min(s), "lamp of {radius}: variance {v} together, {l} by lights, {s} by scattering");
        [v, l, s].iter().zip(&mut sum).for_each(|(v, sum)| *sum += v);
    }
    assert!(sum[0] < 0.5 * sum[1] && sum[0] < 0.5 * sum[2], "variances over all: {sum:?}");
}

/// M155: Russian roulette changes the noise, not the mean: from the first event on, late, and never. 4σ, in a room with
/// glass.
#[test]
fn roulette_is_unbiased() {
    let scene = room(true).scene();
    let never = Shot::of("path", 700).depth(64).roulette_after(u32::MAX).take(&scene);
    for (events, seed) in [(0, 5), (1, 6), (4, 7)] {
        let played = Shot::of("path", 1400).depth(64).roulette_after(events).seed(seed).take(&scene);
        quadrants_agree(&format!("roulette after {events}"), &played, &never, 0.02);
    }
}

/// M163: each bounce adds light, less than the one before, for `path` and `volpath`, and paths of
/// forty bounces have the whole within 4σ; `direct` is `path` cut after one event, bit for bit.
#[test]
fn bounces_add_up() {
    let scene = room(false).scene();
    let up_to = |k: u32| mean(&Shot::of("path", 300).depth(k).seed(u64::from(k) + 40).take(&scene));
    for integrator in ["path", "volpath"] {
        // The same seed: what there is of shorter paths is the same.
        let seen = |k: u32| mean(&Shot::of(integrator, 100).depth(k).reuse(1).take(&scene)).mean[0];
        let added: Vec<f64> = (1..5).map(|k| seen(k) - seen(k - 1)).collect();
        assert!(added.windows(2).all(|pair| 0.0 < pair[1] && pair[1] < pair[0]), "{integrator}: {added:?}");
    }
    let film = |integrator| Shot::of(integrator, 16).depth(1).take(&scene);
    crate::shot::same_bits(&film("path"), &film("direct"), "direct");
    let whole = mean(&Shot::of("path", 300).roulette_after(3).seed(77).take(&scene));
    whole.agrees("forty bounces", up_to(40), 0.01);
}

/// M150: `path` and `volpath` are one where there is no medium: 4σ. Behind a pane too: passing it is an event for
/// `path` alone, so depth is not limited, and light that only a light sample can find (of a point) stays away from it.
#[test]
fn volpath_equals_path_without_media() {
    for pane in [false, true] {
        let mut stage = room(true);
        if pane {
            stage.solid(plane([0.0, 0.0, 1.0], 0.9), material("thin_dielectric"));
        } else {
            stage.light(light("point").with("position", [0.0, 1.0, 0.0]).with("intensity", white(0.2)));
        }
        let scene = stage.scene();
        let path = Shot::of("path", 800).take(&scene);
        let volpath = Shot::of("volpath", 800).seed(3).take(&scene);
        quadrants_agree(&format!("volpath, pane: {pane}"), &path, &volpath, 0.03);
    }
}

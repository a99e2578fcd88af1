//! Mirrors and glass: closed forms for chains of reflections and refractions.

use crate::{
    shot::{Shot, is_exactly, mean},
    stage::{Stage, cuboid, diffuse, material, plane, rectangle, rgb, shape, sphere, white},
};
use steradian_core::Scene;
use steradian_scene::Node;

/// Fresnel's reflectance for unpolarised light from outside of an index.
fn fresnel(degrees: f64, eta: f64) -> f64 {
    let (sin_i, cos_i) = degrees.to_radians().sin_cos();
    let sin_t = sin_i / eta;
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// A slab, or a pane, across z = 0 between a luminous plane of radiance one above and one of `below` underneath, probed
/// at an angle.
fn slab(what: Node, thickness: Option<f64>, degrees: f64, below: f64) -> Scene {
    let mut stage = Stage::new();
    let made_of = stage.add(what);
    let e = 1e3;
    match thickness {
        Some(d) => stage.place_mesh(cuboid([-e, -e, -d], [e, e, 0.0])).material = Some(made_of),
        None => {
            stage.place_mesh(rectangle([-e, -e, 0.0], [2.0 * e, 0.0, 0.0], [0.0, 2.0 * e, 0.0])).material =
                Some(made_of)
        }
    }
    stage.lamp(plane([0.0, 0.0, -1.0], -10.0), 1.0);
    stage.lamp(plane([0.0, 0.0, 1.0], -10.0), below);
    let (sin, cos) = f64::to_radians(degrees).sin_cos();
    stage.probe([0.2 + 3.0 * sin, 0.1, 3.0 * cos], [0.2, 0.1, 0.0]);
    stage.scene()
}

/// M91, M95: a slab of glass reflects R = 2F/(1 + F) of all its internal reflections and transmits the rest, and so
/// does a pane without thickness; nothing is lost. By both branches at every surface (`whitted`), where the series is
/// cut below rounding, and by paths within 4σ.
#[test]
fn glass_slab() {
    for eta in [1.5, 1.33, 2.4] {
        for degrees in [0.0, 45.0, 70.0, 85.0] {
            let f = fresnel(degrees, eta);
            let r = 2.0 * f / (1.0 + f);
            for (kind, thickness) in [("dielectric", Some(0.02)), ("thin_dielectric", None)] {
                let what = || material(kind).with("eta", eta);
                let name = format!("{kind} of {eta} at {degrees}°");
                for (below, expected) in [(0.0, r), (3.0, r + 3.0 * (1.0 - r)), (1.0, 1.0)] {
                    let scene = slab(what(), thickness, degrees, below);
                    // A path of sixteen events at most: F¹⁶ is lost.
                    let whitted = mean(&Shot::of("whitted", 1).take(&scene)).mean[0];
                    let lost = if thickness.is_some() { f.powi(15) * (1.0 + below) } else { 0.0 };
                    assert!(
                        (whitted - expected).abs() < 2e-4 + lost,
                        "{name}, {below} below: {whitted} for {expected}"
                    );
                    let path = mean(&Shot::of("path", 12_000).roulette_after(30).take(&scene));
                    path.is_near_grey(&name, expected, 0.05);
                }
            }
        }
    }
}

/// M95: radiance inside of glass is n² times that outside: a lamp within a block of glass is seen through its face as
/// if it stood in the open, less F. By both branches, exact; the reflected part is black.
#[test]
fn radiance_is_compressed_and_expanded_again() {
    let eta = 1.5;
    let mut stage = Stage::new();
    let glass = stage.add(material("dielectric").with("eta", eta));
    stage.place_mesh(cuboid([-5.0; 3], [5.0; 3])).material = Some(glass);
    stage.lamp(shape("disk").with("radius", 4.0), 1.0);
    stage.probe([0.3, 0.2, 20.0], [0.3, 0.2, 0.0]);
    // Seen from outside, radiance that was one inside is 1/n² outside (E13).
    let film = Shot::of("whitted", 1).take(&stage.scene());
    is_exactly(&film, "lamp in glass", [(1.0 - fresnel(0.0, eta)) / (eta * eta); 3]);
}

/// M83, M95: a probe through a plane of glass meets what Snell's law says: a lamp's edge behind water is where it
/// should be.
#[test]
fn refraction_displaces() {
    let eta = 1.33;
    for degrees in [20.0_f64, 50.0, 75.0] {
        // Water fills z < 0; the lamp is a half plane at depth 2 that begins at the refracted ray's foot, give or take.
        let foot = 2.0 * (degrees.to_radians().sin() / eta).asin().tan();
        for (margin, lit) in [(1e-3, true), (-1e-3, false)] {
            let mut stage = Stage::new();
            let water = stage.add(material("dielectric").with("eta", eta));
            stage.place_mesh(cuboid([-50.0, -50.0, -3.0], [50.0, 50.0, 0.0])).material = Some(water);
            stage.mesh_lamp(rectangle([-40.0, -40.0, -2.0], [40.0 - foot + margin, 0.0, 0.0], [0.0, 80.0, 0.0]), 1.0);
            // Looking towards −x.
            let (sin, cos) = degrees.to_radians().sin_cos();
            stage.probe([3.0 * sin, 0.0, 3.0 * cos], [0.0; 3]);
            let seen = mean(&Shot::of("whitted", 1).take(&stage.scene())).mean[0];
            assert_eq!(seen > 0.1, lit, "{degrees}°, margin {margin}: {seen}");
        }
    }
}

/// M95: nested dielectrics: a bubble of index 1/1.5 in a ball of glass, and a ball of oil in one of water, in a
/// furnace: one everywhere. Exact but for light that goes round for long.
#[test]
fn nested_dielectrics_lose_nothing() {
    for (outer, inner) in [(1.5, 1.0 / 1.5), (1.33, 1.47 / 1.33), (1.5, 1.0)] {
        let mut stage = Stage::new();
        stage.solid(sphere([0.0; 3], 1.0), material("dielectric").with("eta", outer));
        stage.solid(sphere([0.2, 0.1, 0.0], 0.6), material("dielectric").with("eta", inner));
        stage.sky(1.0).film(12, 12).look([0.0, 0.0, -4.0], [0.0; 3], 27.0);
        let film = Shot::of("path", 64).roulette_after(1000).take(&stage.scene());
        is_exactly(&film, &format!("{inner} in {outer}"), [1.0; 3]);
        // Index one within is not there: both branches see the outer ball alone.
        let volpath = Shot::of("volpath", 64).roulette_after(1000).take(&stage.scene());
        is_exactly(&volpath, &format!("{inner} in {outer}, volpath"), [1.0; 3]);
    }
}

/// M158: between two facing mirrors a ray that goes down the corridor at an angle is reflected as often as its unfolded
/// straight line crosses a wall, and loses a factor each time. Exact, for `whitted` and for paths.
#[test]
fn facing_mirrors() {
    let (length, r) = (20.0_f64, [0.9, 0.7, 0.5]);
    for degrees in [0.0_f64, 5.0, 17.0, 31.0] {
        let mut stage = Stage::new();
        for side in [1.0, -1.0] {
            stage.solid(plane([side, 0.0, 0.0], -1.0), material("conductor").with("specular_reflectance", rgb(r)));
        }
        stage.lamp(plane([0.0, 0.0, -1.0], -length), 2.0);
        let (sin, cos) = degrees.to_radians().sin_cos();
        stage.probe([0.1, 0.0, 0.0], [0.1 + sin, 0.0, cos]);
        let scene = stage.scene();
        // From x = 0.1 to x = 0.1 + length·tan; walls at odd numbers.
        let crossings = ((0.1 + length * sin / cos + 1.0) / 2.0).floor() as i32;
        let expected = r.map(|r: f64| 2.0 * r.powi(crossings));
        for integrator in ["whitted", "path", "volpath"] {
            is_exactly(
                &Shot::of(integrator, 4).roulette_after(100).take(&scene),
                &format!("{integrator}, {degrees}°"),
                expected,
            );
        }
        // With one event too few the corridor ends in the dark.
        if crossings > 0 {
            let cut = Shot::of("whitted", 1).depth(crossings as u32 - 1).take(&scene);
            is_exactly(&cut, "cut short", [0.0; 3]);
        }
    }
}

/// M158: Whitted's shading: a diffuse surface under a point light, seen in a mirror, with a shadow: closed forms.
/// Exact.
#[test]
fn whitted_shading_in_a_mirror() {
    for shaded in [false, true] {
        let mut stage = Stage::new();
        stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.6));
        stage.solid(plane([-1.0, 0.0, 0.0], -3.0), material("conductor").with("specular_reflectance", white(0.8)));
        stage.light(crate::stage::light("point").with("position", [1.0, 2.0, 0.0]).with("intensity", white(5.0)));
        if shaded {
            stage.solid(sphere([1.0, 1.0, 0.0], 0.3), diffuse(0.1));
        }
        // The mirror at x = 3 shows the point (1, 0, 0) at (5, 0, 0).
        stage.probe([2.0, 1.0, 1.0], [5.0, 0.0, 0.0]);
        let expected = if shaded { 0.0 } else { 0.8 * 0.6 / std::f64::consts::PI * 5.0 / 4.0 };
        is_exactly(&Shot::of("whitted", 2).take(&stage.scene()), "floor in a mirror", [expected; 3]);
        is_exactly(&Shot::of("path", 2).depth(2).take(&stage.scene()), "the same by a path", [expected; 3]);
    }
}

/// M156: `raycast` gives the reflectance of the first surface, whatever lights it; emission is added, and where nothing
/// is the sky. Exact.
#[test]
fn raycast_shows_the_first_surface() {
    let color = [0.7, 0.3, 0.1];
    let mut stage = Stage::new();
    stage.solid(sphere([0.0; 3], 1.0), material("diffuse").with("reflectance", rgb(color)));
    stage.solid(sphere([0.0, 0.0, 5.0], 3.0), diffuse(0.9));
    stage.sky(0.25).probe([0.0, 0.0, -5.0], [0.0; 3]);
    is_exactly(&Shot::of("raycast", 2).take(&stage.scene()), "ball", color);
    stage.probe([0.0, 0.0, -5.0], [9.0, 0.0, 0.0]);
    is_exactly(&Shot::of("raycast", 2).take(&stage.scene()), "sky", [0.25; 3]);
    // An interface is passed.
    stage.solid(sphere([0.0; 3], 1.5), material("interface"));
    stage.probe([0.0, 0.0, -5.0], [0.1, 0.0, 0.0]);
    is_exactly(&Shot::of("raycast", 2).take(&stage.scene()), "ball within an interface", color);
    let mut stage = Stage::new();
    stage.lamp(sphere([0.0; 3], 1.0), 4.0);
    stage.probe([0.0, 0.0, -5.0], [0.0; 3]);
    is_exactly(&Shot::of("raycast", 2).take(&stage.scene()), "lamp", [4.0; 3]);
}

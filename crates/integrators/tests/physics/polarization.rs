//! Polarised light (M131): Brewster's angle, crossed mirrors, and agreement with unpolarised transport where nothing
//! polarises twice. Filters: Malus's law, wave plates, circular polarisers.

use crate::{
    shot::{Shot, mean},
    stage::{Stage, diffuse, material, plane, rectangle, rgb, sphere},
};
use steradian_core::Scene;
use steradian_scene::Node;

/// Brewster's angle of glass of index 1.5, and the reflectance there.
fn brewster() -> (f64, f64) {
    let theta = 1.5f64.atan();
    let s = (theta.cos() - 1.5 * (1.0 - (theta.sin() / 1.5).powi(2)).sqrt())
        / (theta.cos() + 1.5 * (1.0 - (theta.sin() / 1.5).powi(2)).sqrt());
    (theta, 0.5 * s * s)
}

/// A sheet of glass across the origin over a black floor, under a white sky, seen at Brewster's angle.
fn sheet(theta: f64) -> Stage {
    let mut stage = Stage::new();
    let glass = stage.add(material("dielectric").with("eta", 1.5));
    stage.place_mesh(rectangle([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0])).material = Some(glass);
    stage.solid(plane([0.0, 0.0, 1.0], -1.0), diffuse(0.0));
    stage.sky(1.0);
    stage.probe([3.0 * theta.sin(), 0.0, 3.0 * theta.cos()], [0.0; 3]);
    stage
}

#[test]
fn a_sheet_at_brewsters_angle_polarises_all_that_it_reflects() {
    let (theta, f) = brewster();
    let scene = sheet(theta).scene();
    let take = |name| mean(&Shot::of(name, 40_000).take(&scene));
    take("stokes").is_near("S0", [f; 3], 0.03);
    // Light swings across the plane of incidence, which stands upright in the picture's horizontal.
    take("stokes-s1").is_near("S1", [-f; 3], 0.03);
    for name in ["stokes-s2", "stokes-s3"] {
        assert!(take(name).mean.iter().all(|v| v.abs() < 1e-5), "{name}");
    }
}

/// Light that one sheet has polarised meets a second at Brewster's angle, whose plane of incidence is the same or
/// turned by 90°.
fn two_sheets(crossed: bool) -> Scene {
    let (theta, _) = brewster();
    let mut stage = sheet(theta);
    let (sin, cos) = theta.sin_cos();
    let along = [-sin, 0.0, cos];
    let aside = if crossed { [0.0, 1.0, 0.0] } else { [cos, 0.0, sin] };
    let n: [f64; 3] = std::array::from_fn(|i| -cos * along[i] + sin * aside[i]);
    // Two directions in the sheet, so that their cross product is the normal.
    let across =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let t = across(along, aside);
    let u = across(n, t);
    let square = |distance: f64, half: f64| {
        let corner = std::array::from_fn(|i| 6.0 * along[i] - distance * n[i] - half * (t[i] + u[i]));
        rectangle(corner, t.map(|v| 2.0 * half * v), u.map(|v| 2.0 * half * v))
    };
    let (front, back) = (square(0.0, 1.5), square(0.5, 4.0));
    let glass = stage.add(material("dielectric").with("eta", 1.5));
    stage.place_mesh(front).material = Some(glass);
    let black = stage.add(diffuse(0.0));
    stage.place_mesh(back).material = Some(black);
    stage.scene()
}

#[test]
fn crossed_sheets_are_black_and_parallel_ones_are_not() {
    let (_, f) = brewster();
    let take = |name, crossed| mean(&Shot::of(name, 300_000).roulette_after(30).take(&two_sheets(crossed)));
    // Unpolarised transport does not see the difference.
    for crossed in [false, true] {
        take("path", crossed).is_near("path", [f * f; 3], 0.06);
    }
    take("stokes", false).is_near("parallel", [2.0 * f * f; 3], 0.06);
    let black = take("stokes", true).mean[0];
    assert!(black < 1e-4 * f * f, "crossed: {black}");
}

/// Equal random numbers take equal paths: the radiance of light that is polarised at most once on its way from a matt
/// surface or a lamp is that of `path`.
#[test]
fn radiance_is_that_of_path_where_nothing_polarises_twice() {
    let mut stage = Stage::new();
    stage.film(12, 8);
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.6));
    let gold =
        material("conductor").with("eta", rgb([0.2, 0.4, 1.3])).with("k", rgb([3.2, 2.4, 1.8])).with("alpha_u", 0.2);
    stage.solid(sphere([0.0, 1.0, 0.0], 1.0), gold);
    stage.sky(0.4);
    stage.lamp(sphere([2.0, 4.0, -2.0], 0.5), 6.0);
    stage.look([0.0, 2.0, -5.0], [0.0, 0.8, 0.0], 45.0);
    let scene = stage.scene();
    let take = |name| Shot::of(name, 32).roulette_after(1000).depth(6).take(&scene);
    let (path, stokes, s1) = (take("path"), take("stokes"), take("stokes-s1"));
    let mut polarised = 0;
    for ((a, b), s1) in path.pixels.iter().zip(&stokes.pixels).zip(&s1.pixels) {
        for c in 0..3 {
            assert!(
                (a.mean()[c] - b.mean()[c]).abs() <= 1e-4 * a.mean()[c].abs() + 1e-6,
                "{:?} {:?}",
                a.mean(),
                b.mean()
            );
            assert!(s1.mean()[c].abs() <= b.mean()[c] + 1e-6);
        }
        polarised += usize::from(s1.mean()[0].abs() > 1e-3);
    }
    assert!(polarised > 10, "the metal polarises: {polarised} pixels");
}

/// Filters before a white sky, the first one nearest to it: unit squares across z whose ∂p/∂u is x, with the normal
/// towards the camera.
fn filters(plates: &[Node]) -> Stage {
    let mut stage = Stage::new();
    for (i, plate) in plates.iter().enumerate() {
        let id = stage.add(plate.clone());
        let corner = [-0.5, -0.5, 0.1 * i as f64];
        stage.place_mesh(rectangle(corner, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])).material = Some(id);
    }
    stage.sky(1.0);
    stage.probe([0.03, -0.02, 3.0], [0.03, -0.02, 0.0]);
    stage
}

fn polarizer(theta: f64) -> Node {
    material("polarizer").with("theta", theta)
}

fn circular(form: &str) -> Node {
    material("polarizer").with("form", form)
}

fn passes(name: &'static str, plates: &[Node]) -> f64 {
    mean(&Shot::of(name, 64).roulette_after(30).take(&filters(plates).scene())).mean[0]
}

fn is_part(what: &str, found: f64, expected: f64) {
    assert!((found - expected).abs() < 2e-6, "{what}: {found} is not {expected}");
}

#[test]
fn two_polarisers_keep_to_the_law_of_malus() {
    for degrees in [0.0f64, 30.0, 45.0, 60.0, 90.0, -30.0] {
        let both = [polarizer(20.0), polarizer(20.0 + degrees)];
        is_part("Malus", passes("stokes", &both), 0.5 * degrees.to_radians().cos().powi(2));
        for name in ["path", "volpath"] {
            is_part(name, passes(name, &both), 0.25);
        }
    }
}

#[test]
fn what_is_between_crossed_polarisers_lets_light_pass_again() {
    let between = |plate: Node| passes("stokes", &[polarizer(0.0), plate, polarizer(90.0)]);
    let retarder = |theta: f64, delta: f64| material("retarder").with("theta", theta).with("delta", delta);
    is_part("a third polariser", between(polarizer(45.0)), 0.125);
    is_part("a quarter-wave plate", between(retarder(45.0, 90.0)), 0.25);
    is_part("a half-wave plate", between(retarder(45.0, 180.0)), 0.5);
    is_part("a half-wave plate along an axis", between(retarder(90.0, 180.0)), 0.0);
    is_part("a plate by itself", passes("stokes", &[retarder(45.0, 90.0)]), 1.0);
    is_part("what path sees", passes("path", &[retarder(45.0, 90.0)]), 1.0);
}

#[test]
fn circular_polarisers_pass_one_hand() {
    let (right, left) = (circular("right_circular"), circular("left_circular"));
    for (one, other, expected) in [(&right, &right, 0.5), (&left, &left, 0.5), (&right, &left, 0.0)] {
        is_part("two of them", passes("stokes", &[one.clone(), other.clone()]), expected);
    }
    is_part("S3 of right", passes("stokes-s3", std::slice::from_ref(&right)), 0.5);
    // Light along the diagonal, whose part along the fast axis x is ahead, becomes left-circular.
    let made = [polarizer(45.0), material("retarder")];
    is_part("S3 of a quarter-wave plate", passes("stokes-s3", &made), -0.5);
    let analysed = |last: &Node| passes("stokes", &[made[0].clone(), made[1].clone(), last.clone()]);
    is_part("left", analysed(&left), 0.5);
    is_part("right", analysed(&right), 0.0);
}

/// A polariser by itself passes half of what a matt floor sends, tinted, and `limits` tell that methods other than
/// `stokes` know no more than that.
#[test]
fn unpolarised_methods_say_that_they_are() {
    let scene = filters(&[polarizer(0.0).with("transmittance", rgb([1.0, 0.5, 0.2]))]).scene();
    for name in ["path", "volpath", "stokes"] {
        mean(&Shot::of(name, 64).take(&scene)).is_near(name, [0.5, 0.25, 0.1], 1e-4);
    }
    assert!(Shot::of("path", 1).limit(&scene).is_some_and(|l| l.contains("polarisation")));
    assert!(Shot::of("stokes", 1).limit(&scene).is_none());
}

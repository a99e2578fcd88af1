//! Light samples of media that glow: irradiance in closed form, and equilibrium.

use crate::{
    shot::{Shot, mean},
    stage::{Stage, cuboid, diffuse, icosphere, light, medium, plane, rgb, sphere, white},
};
use std::f64::consts::PI;
use steradian_core::{ColorMode, Scene};
use steradian_integrators::Depth;
use steradian_integrators::meter::{Receiver, Settings, read};
use steradian_math::Vec3;
use steradian_scene::{Family, Node, Value};

/// A medium that glows within a shape that scatters nothing.
fn fill(stage: &mut Stage, node: Node, inside: Node) {
    let (inside, clear) = (stage.add(inside), stage.add(Node::new(Family::Material, "interface", None)));
    let body = stage.place(node);
    (body.material, body.interior, body.is_medium_boundary) = (Some(clear), Some(inside), true);
}

/// A floor under a ball of radius 0.5 at a height of 2.
fn lit_floor(inside: Node, mode: ColorMode) -> Scene {
    let mut stage = Stage::new();
    fill(&mut stage, sphere([0.3, 0.0, 2.0], 0.5), inside);
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(0.5));
    stage.probe([-1.0, 0.0, 0.3], [0.0, 0.0, 0.0]);
    stage.scene_in(mode)
}

/// Irradiance of the origin by a ball of radius 0.5 about (0.3, 0, 2) that absorbs `sigma` and gives off what a black
/// body of radiance 1 does: `∫ (1 − e^(−σ chord)) cosθ dω`, of which the cosine to the ball's middle is a factor.
fn irradiance(sigma: f64) -> f64 {
    let d = 0.3f64.hypot(2.0);
    let most = (0.5 / d).asin();
    let n = 20_000;
    let ring = |k: i32| {
        let angle = most * (f64::from(k) + 0.5) / f64::from(n);
        let chord = 2.0 * (0.25 - (d * angle.sin()).powi(2)).max(0.0).sqrt();
        (1.0 - (-sigma * chord).exp()) * angle.cos() * angle.sin() * 2.0 * PI * most / f64::from(n)
    };
    (0..n).map(ring).sum::<f64>() * 2.0 / d
}

/// A ball that glows lights a floor as the integral over its chords says, thin or dense, in both colour modes; thin, as
/// all of it in its middle would (Newton's shell theorem). By chance one in forty rays would find it: that no more
/// samples are needed tells that it is looked for.
#[test]
fn a_ball_that_glows_lights_a_floor() {
    let glow = |sigma: f64| medium(white(sigma), white(0.0)).with("Le", rgb([1.0; 3]));
    let thin = 1e-4 * 4.0 / 3.0 * PI * 0.125 * 2.0 / 0.3f64.hypot(2.0).powi(3);
    assert!((irradiance(1e-4) / thin - 1.0).abs() < 1e-3);
    for sigma in [1e-4, 2.0, 30.0] {
        for mode in [ColorMode::Rgb, ColorMode::Spectral] {
            let seen = mean(&Shot::of("volpath", 2000).depth(1).take(&lit_floor(glow(sigma), mode)));
            seen.is_near_grey(&format!("σ = {sigma}, {mode:?}"), 0.5 / PI * irradiance(sigma), 0.03);
        }
    }
}

/// So it is by a meter, and where the ball is a grid of one density, and where two media share the light.
#[test]
fn meters_and_grids_look_for_glow_as_well() {
    let depth = Depth { max: u32::MAX, roulette_after: 8, hide_emitters: false };
    let settings = Settings { samples: 1 << 13, error: None, seed: 3, media: true, depth };
    let received = |scene: &Scene| read(scene, &Receiver::Plane(Vec3::Z * 1e-3, Vec3::Z), &settings).rgb[1];
    let homogeneous = medium(white(2.0), white(0.0)).with("Le", rgb([1.0; 3]));
    let grid = Node::new(Family::Medium, "uniformgrid", None).with("density", vec![1.0]);
    let grid = grid.with("p0", Value::Vec3([-1e4; 3])).with("p1", Value::Vec3([1e4; 3]));
    let grid = grid.with("sigma_a", white(2.0)).with("sigma_s", white(0.0)).with("Le", rgb([1.0; 3]));
    let lumps: Vec<f64> = (0..512).map(|i| if i % 5 == 0 { 2.0 } else { 0.0 }).collect();
    let mut lumpy = Node::new(Family::Medium, "uniformgrid", None).with("density", lumps);
    for n in ["nx", "ny", "nz"] {
        lumpy.set(n, 8, None);
    }
    let lumpy = lumpy.with("p0", Value::Vec3([-0.2, -0.5, 1.5])).with("p1", Value::Vec3([0.8, 0.5, 2.5]));
    let lumpy = lumpy.with("sigma_a", white(2.0)).with("sigma_s", white(0.0)).with("Le", rgb([1.0; 3]));
    let expected = irradiance(2.0);
    let one = received(&lit_floor(homogeneous.clone(), ColorMode::Rgb));
    assert!((one.value - expected).abs() < 2.0 * one.plus_minus && one.plus_minus < 0.02 * expected, "{one:?}");
    // A grid as wide as this has all of its cells but a few where the ball is not: what it finds is found by chance.
    let wide = received(&lit_floor(grid, ColorMode::Rgb));
    assert!((wide.value - expected).abs() < 2.0 * wide.plus_minus, "{wide:?}");
    let lumps = received(&lit_floor(lumpy.clone(), ColorMode::Rgb));
    assert!(lumps.plus_minus < 0.03 * lumps.value && lumps.value < expected, "{lumps:?}");
    // Both: each as alone, since they do not hide each other from the origin.
    let mut stage = Stage::new();
    fill(&mut stage, sphere([0.3, 0.0, 2.0], 0.5), lumpy);
    fill(&mut stage, sphere([-1.0, 0.0, 2.0], 0.5), homogeneous.clone());
    stage.probe([-1.0, 0.0, 0.3], [0.0, 0.0, 0.0]);
    let both = received(&stage.scene());
    let mut stage = Stage::new();
    fill(&mut stage, sphere([-1.0, 0.0, 2.0], 0.5), homogeneous);
    stage.probe([-1.0, 0.0, 0.3], [0.0, 0.0, 0.0]);
    let second = received(&stage.scene());
    let spread = both.plus_minus.hypot(lumps.plus_minus).hypot(second.plus_minus);
    assert!((both.value - lumps.value - second.value).abs() < 2.0 * spread, "{both:?} {lumps:?} {second:?}");
    assert!(spread < 0.05 * both.value);
}

/// In equilibrium radiance is 1 everywhere: under a sky of 1 a medium that scatters, and gives off as much as it takes,
/// around a ball that reflects one half and emits the other, cannot be seen; the same everywhere and lumpy.
#[test]
fn what_is_in_equilibrium_cannot_be_seen() {
    let lumps: Vec<f64> = (0..216).map(|i| f64::from(i % 7) * 0.3).collect();
    let mut lumpy = Node::new(Family::Medium, "uniformgrid", None).with("density", lumps);
    for n in ["nx", "ny", "nz"] {
        lumpy.set(n, 6, None);
    }
    let lumpy = lumpy.with("p0", Value::Vec3([-1.2; 3])).with("p1", Value::Vec3([1.2; 3]));
    let even = Node::new(Family::Medium, "homogeneous", None);
    for (what, node) in [("even", even), ("lumpy", lumpy)] {
        let node = node.with("sigma_a", rgb([0.5, 1.0, 0.2])).with("sigma_s", rgb([0.8, 0.3, 1.5])).with("g", 0.4);
        let node = node.with("Le", rgb([1.0; 3]));
        let mut stage = Stage::new();
        let (inside, clear) = (stage.add(node), stage.add(Node::new(Family::Material, "interface", None)));
        let body = stage.place_mesh(cuboid([-1.1; 3], [1.1; 3]));
        (body.material, body.interior, body.is_medium_boundary) = (Some(clear), Some(inside), true);
        let half = stage.add(diffuse(0.5));
        let emission = stage.add(light("area").with("radiance", white(0.5)));
        let ball = stage.place_mesh(icosphere([0.1, 0.0, 0.0], 0.5, 2));
        (ball.material, ball.emission) = (Some(half), Some(emission));
        ball.interior = None;
        stage.sky(1.0);
        stage.film(4, 4).look([0.0, 0.0, -3.0], [0.0; 3], 40.0);
        let scene = stage.scene();
        mean(&Shot::of("volpath", 3000).depth(300).take(&scene)).is_near_grey(what, 1.0, 0.01);
    }
}

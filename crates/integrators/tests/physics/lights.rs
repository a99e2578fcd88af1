//! Laws of light that hold for any scene: radiance along a ray, cosine and distance laws, superposition.

use crate::{
    shot::{Estimate, Shot, is_exactly, mean},
    stage::{Stage, cuboid, diffuse, light, look_at, material, plane, rectangle, shape, sphere, white},
};
use std::f64::consts::PI;
use steradian_core::Scene;
use steradian_math::{hash::HashRng, spectra::photometry::photometric_from_y};
use steradian_scene::Node;

/// M67: the radiance of an emitter, and of a lit wall, does not depend on the distance of the camera, from 10⁻³ to 10⁵.
/// Exact.
#[test]
fn radiance_is_invariant_along_a_ray() {
    for distance in [1e-3, 0.1, 1.0, 30.0, 1e3, 1e5] {
        let mut stage = Stage::new();
        stage.lamp(plane([0.0, 0.0, 1.0], 0.0), 2.5);
        stage.probe([0.2, 0.1, distance], [0.2, 0.1, 0.0]);
        is_exactly(&Shot::of("path", 4).take(&stage.scene()), "emitter", [2.5; 3]);
        let mut stage = Stage::new();
        stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(0.8));
        stage.light(light("distant").with("direction", [0.0, 0.6, -0.8]).with("radiance", white(5.0)));
        stage.probe([0.2, 0.1, distance], [0.2, 0.1, 0.0]);
        is_exactly(&Shot::of("path", 4).depth(1).take(&stage.scene()), "lit wall", [5.0 * 0.8 * 0.8 / PI; 3]);
    }
}

/// M71: parallel light of irradiance E at an angle θ gives L = ρ/π E cos θ at any distance, and nothing from behind.
/// Exact.
#[test]
fn cosine_law_of_parallel_light() {
    for degrees in [0.0_f64, 30.0, 60.0, 89.0, 91.0, 180.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        for x in [0.0, -1e4] {
            let mut stage = Stage::new();
            stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.5));
            stage.light(light("distant").with("direction", [sin, -cos, 0.0]).with("radiance", white(3.0)));
            stage.probe([x, 2.0, 1.0], [x, 0.0, 0.0]);
            let film = Shot::of("path", 4).depth(1).take(&stage.scene());
            is_exactly(&film, &format!("{degrees}° at {x}"), [0.5 / PI * 3.0 * cos.max(0.0); 3]);
        }
    }
}

/// M69: the light of a point falls with the square of the distance and the cosine of the angle. Exact.
#[test]
fn inverse_square_law() {
    for (height, aside) in [(0.01, 0.0), (1.0, 2.0), (50.0, 80.0), (1e4, 1.0)] {
        let (height, aside): (f64, f64) = (height, aside);
        let mut stage = Stage::new();
        stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
        stage.light(light("point").with("intensity", white(7.0)).with("position", [aside, 0.0, height]));
        stage.probe([0.1 * height, 0.2 * height, 0.5 * height], [0.0; 3]);
        let d2 = height * height + aside * aside;
        let expected = 7.0 / PI * height / d2.sqrt() / d2;
        is_exactly(&Shot::of("direct", 4).take(&stage.scene()), "point light", [expected; 3]);
    }
}

/// M70: a spot light is full within its inner cone, dark outside of the outer one, and falls off between them as its
/// kind says; with `power` its intensity integrates to that flux over the sphere (E39). Irradiance is measured on a
/// plane across the axis.
#[test]
fn spot_light_falloff_and_flux() {
    let (outer, inner) = (40.0_f64, 25.0_f64);
    let share = |kind: &str, theta: f64| {
        let (c, ci, co) = (theta.cos(), inner.to_radians().cos(), outer.to_radians().cos());
        match kind {
            _ if c >= ci => 1.0,
            _ if c <= co => 0.0,
            "linear" => (outer.to_radians() - theta) / (outer - inner).to_radians(),
            _ => {
                let t = (c - co) / (ci - co);
                t * t * (3.0 - 2.0 * t)
            }
        }
    };
    for kind in ["smoothstep", "linear"] {
        let spot = || {
            light("spot")
                .with("cone_angle", outer)
                .with("falloff_start", inner)
                .with("falloff", kind)
                .with("to_world", look_at([1.0, 2.0, 3.0], [1.0, 2.0, 0.0]))
        };
        let intensity_at = |node: Node, theta: f64| {
            let mut stage = Stage::new();
            stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
            let p = [1.0 + 3.0 * theta.tan(), 2.0, 0.0];
            stage.light(node).probe([p[0], p[1], 1.0], p);
            // E = I cos θ / d², d = 3 / cos θ.
            mean(&Shot::of("direct", 1).take(&stage.scene())).times(PI * 9.0 / theta.cos().powi(3)).mean[0]
        };
        for degrees in [0.0, 10.0, 24.9, 27.0, 32.0, 38.0, 40.1, 60.0] {
            let theta = f64::to_radians(degrees);
            let got = intensity_at(spot().with("intensity", white(2.0)), theta);
            assert!((got - 2.0 * share(kind, theta)).abs() < 1e-3, "{kind} at {degrees}°: {got}");
        }
        // ∫ I dω by the midpoint rule in the cosine.
        let n = 400;
        let h = (1.0 - outer.to_radians().cos()) / f64::from(n);
        let node = || spot().with("intensity", white(1.0)).with("power", 10.0 * photometric_from_y(1.0));
        let flux: f64 =
            (0..n).map(|i| intensity_at(node(), (1.0 - (f64::from(i) + 0.5) * h).acos()) * 2.0 * PI * h).sum();
        assert!((flux - 10.0).abs() < 0.02, "{kind}: flux {flux}");
    }
}

/// The lights of a test scene, by number.
const LIGHTS: [fn(&mut Stage); 6] = [
    |s| {
        s.light(light("point").with("position", [0.5, 1.5, -0.5]).with("intensity", white(1.5)));
    },
    |s| {
        s.light(light("distant").with("direction", [0.3, -1.0, 0.2]).with("radiance", white(0.7)));
    },
    |s| {
        s.mesh_lamp(rectangle([-0.5, 1.9, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 2.0);
    },
    |s| {
        s.lamp(sphere([-1.2, 0.3, 0.4], 0.2), 5.0);
    },
    |s| {
        s.sky(0.3);
    },
    |s| {
        let at = look_at([1.5, 1.8, 1.5], [0.0, 0.0, 0.0]);
        s.light(
            light("spot")
                .with("intensity", white(4.0))
                .with("cone_angle", 30.0)
                .with("falloff_start", 20.0)
                .with("to_world", at),
        );
    },
];

/// A scene with things of several materials, lit by some of [`LIGHTS`]. Lamps that are off stay as black bodies, so
/// that all scenes block light alike.
fn still_life(on: impl Fn(usize) -> bool) -> Scene {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.6));
    let box_color = stage.add(diffuse(0.8));
    stage.place_mesh(cuboid([-0.6, 0.0, -0.2], [-0.1, 0.7, 0.3])).material = Some(box_color);
    stage.solid(
        sphere([0.5, 0.4, 0.1], 0.4),
        material("conductor").with("reflectance", white(0.8)).with("alpha_u", 0.3),
    );
    stage.solid(sphere([0.1, 0.25, 0.9], 0.25), material("plastic").with("diffuse_reflectance", white(0.5)));
    for (i, add) in LIGHTS.iter().enumerate() {
        let lamps = stage.desc.shapes.len();
        let lights = stage.desc.lights.len();
        add(&mut stage);
        if !on(i) {
            stage.desc.shapes[lamps..].iter_mut().for_each(|s| s.emission = None);
            stage.desc.lights.truncate(lights);
        }
    }
    stage.film(24, 16).look([0.3, 1.4, 4.0], [0.0, 0.4, 0.0], 40.0);
    stage.scene()
}

/// M75, M76: the picture with all lights is the sum of the pictures with each of them alone, for any choice among
/// lights: 4σ, for the whole picture and for its parts.
#[test]
fn superposition_of_lights() {
    let parts = |film: &steradian_integrators::Film| -> Vec<Estimate> {
        film.pixels
            .chunks(48)
            .map(|p| mean(&steradian_integrators::Film { pixels: p.to_vec(), ..film.clone() }))
            .collect()
    };
    let shot = Shot::of("path", 400).depth(3);
    let together = parts(&shot.take(&still_life(|_| true)));
    let mut sum = vec![Estimate { mean: [0.0; 3], sigma: [0.0; 3] }; together.len()];
    for i in 0..LIGHTS.len() {
        let alone = parts(&shot.seed(10 + i as u64).take(&still_life(|k| k == i)));
        sum.iter_mut().zip(alone).for_each(|(s, a)| *s = s.plus(a));
    }
    for (i, (all, sum)) in together.iter().zip(&sum).enumerate() {
        all.agrees(&format!("rows {} and {}", 2 * i, 2 * i + 1), *sum, 0.02);
    }
    // In two halves.
    let even = mean(&shot.seed(30).take(&still_life(|k| k % 2 == 0)));
    let odd = mean(&shot.seed(31).take(&still_life(|k| k % 2 == 1)));
    mean(&shot.seed(32).take(&still_life(|_| true))).agrees("two halves", even.plus(odd), 0.01);
}

/// M76: twice the radiance of every light gives twice every sample, bit for bit: powers of two pass through all
/// arithmetic, and no decision depends on the brightness.
#[test]
fn linearity_is_exact() {
    let lit = |k: f64| {
        let mut stage = Stage::new();
        stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.6));
        stage.solid(
            sphere([0.4, 0.5, 0.0], 0.5),
            material("conductor").with("reflectance", white(0.75)).with("alpha_u", 0.2),
        );
        stage.light(light("point").with("position", [0.5, 1.5, -0.5]).with("intensity", white(1.5 * k)));
        stage.mesh_lamp(rectangle([-0.5, 1.9, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 2.0 * k);
        stage.sky(0.25 * k).film(16, 16).look([0.3, 1.4, 4.0], [0.0, 0.4, 0.0], 40.0);
        Shot::of("path", 32).roulette_after(1).take(&stage.scene())
    };
    let (once, twice) = (lit(1.0), lit(2.0));
    for (a, b) in once.pixels.iter().zip(&twice.pixels) {
        assert_eq!(a.sum.map(|v| v * 2.0), b.sum);
        assert_eq!(a.sum_squares.map(|v| v * 4.0), b.sum_squares);
    }
}

/// M75: sixty lights of many sizes, chosen by the tree: the mean is that of asking every light at every point
/// (`whitted`, in which no choice is made), and the closed form Σ I cos θ/d² for those that are points. 4σ.
#[test]
fn many_lights() {
    let mut rng = HashRng::new(77);
    let mut next = |lo: f64, hi: f64| lo + (hi - lo) * f64::from(rng.next_f32());
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
    stage.probe([0.1, 0.2, 0.05], [0.0; 3]);
    let mut irradiance = 0.0;
    for _ in 0..40 {
        let p = [next(-5.0, 5.0), next(-5.0, 5.0), next(0.1, 4.0)];
        let intensity = next(0.01, 1.0).powi(4);
        let d2: f64 = p.iter().map(|v| v * v).sum();
        irradiance += intensity * p[2] / d2.sqrt() / d2;
        stage.light(light("point").with("position", p).with("intensity", white(intensity)));
    }
    let points = stage.scene();
    mean(&Shot::of("path", 40_000).depth(1).take(&points)).times(PI).is_near_grey(
        "points by the tree",
        irradiance,
        0.01,
    );
    is_exactly(&Shot::of("whitted", 1).take(&points), "points one by one", [irradiance / PI; 3]);
    for _ in 0..20 {
        let corner = [next(-4.0, 4.0), next(-4.0, 4.0), next(0.3, 3.0)];
        let (ex, ey) = ([0.0, next(0.05, 1.0), 0.0], [next(0.05, 1.0), 0.0, 0.0]);
        stage.mesh_lamp(rectangle(corner, ex, ey), next(0.1, 2.0));
    }
    // Some that are out of sight: below the ground, and turned away.
    stage.lamp(sphere([1.0, 0.0, -3.0], 1.0), 10.0);
    stage.lamp(shape("disk").with("height", 0.4).with("radius", 0.3), 10.0);
    let scene = stage.scene();
    let one_by_one = mean(&Shot::of("whitted", 4_000).take(&scene));
    let by_tree = mean(&Shot::of("path", 60_000).depth(1).take(&scene));
    by_tree.agrees("tree against all lights", one_by_one, 0.01);
}

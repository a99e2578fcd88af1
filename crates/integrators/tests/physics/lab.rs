//! The closed-form values of the path-tracing lab's box.

use crate::{
    shot::{Shot, is_exactly},
    stage::{Stage, diffuse, light, plane, sphere, white},
};

/// The lab's box of half width one with its two spheres, walls of one reflectance, and a point light of intensity one
/// at (0, ½, 0).
fn lab_box(reflectance: f64) -> Stage {
    let mut stage = Stage::new();
    for n in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]] {
        stage.solid(plane(n, -1.0), diffuse(reflectance));
    }
    stage.solid(sphere([-0.5, -0.7, 0.25], 0.3), diffuse(0.7));
    stage.solid(sphere([0.5, -0.7, -0.25], 0.3), diffuse(0.7));
    stage.light(light("point").with("position", [0.0, 0.5, 0.0]).with("intensity", white(1.0)));
    stage
}

/// M69, M157, M164: the middle of the back wall has L = 0.22776401 ρ and the floor below the light L = 0.14147106 ρ:
/// the light's intensity times cos θ / (π d²). Exact: a point light has no spread.
#[test]
fn direct_light_of_the_lab_box() {
    for reflectance in [1.0, 0.75] {
        for (to, expected) in [([0.0, 0.0, 1.0], 0.227_764_01), ([0.0, -1.0, 0.0], 0.141_471_06)] {
            let mut stage = lab_box(reflectance);
            stage.probe([0.0, 0.0, -3.5], to);
            let scene = stage.scene();
            for integrator in ["direct", "whitted"] {
                let film = Shot::of(integrator, 16).take(&scene);
                is_exactly(&film, &format!("{integrator} at {to:?}"), [expected * reflectance; 3]);
            }
        }
    }
}

/// M75: what the spheres hide from the light is black without interreflection. Exact.
#[test]
fn shadows_of_the_lab_box_are_black() {
    // On the line from the light past a sphere's centre to the floor.
    for center in [[-0.5, -0.7, 0.25], [0.5, -0.7, -0.25]] {
        let t = 1.5 / (0.5 - center[1]);
        let shadow = [center[0] * t, -1.0, center[2] * t];
        let mut stage = lab_box(0.8);
        // Looked at from the side that no sphere stands on.
        stage.probe([shadow[0] * 1.05, -0.9, shadow[2] * 1.6], shadow);
        is_exactly(&Shot::of("direct", 4).take(&stage.scene()), "shadow", [0.0; 3]);
    }
}

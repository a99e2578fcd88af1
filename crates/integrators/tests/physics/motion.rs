//! Motion while the shutter is open: pictures are the mean over the exposure, and every path sees one moment.

use crate::{
    shot::{Shot, mean, same_bits},
    stage::{Stage, diffuse, light, rectangle, rgb, sphere, white},
};
use steradian_core::Scene;
use steradian_math::DVec3;
use steradian_scene::{Family, Group, Instance, Movement, Node, Transform};

/// Lets the shape that was placed last move.
fn moves(stage: &mut Stage, start: Transform, end: Transform, times: [f64; 2]) {
    let shape = stage.desc.shapes.pop().expect("a shape");
    stage.desc.groups.push(Group { name: String::new(), shapes: vec![shape] });
    let group = stage.desc.groups.len() - 1;
    let movement = Some(Movement { end, times });
    stage.desc.instances.push(Instance { movement, ..Instance::new(group, start) });
}

fn shift(x: f64) -> Transform {
    Transform::translate(DVec3::new(x, 0.0, 0.0))
}

/// A black square of edge 1 in z = 0 before a white sky, seen from z = -4 by parallel rays.
fn square(start: Transform, end: Transform, times: [f64; 2]) -> Stage {
    let mut stage = Stage::new();
    let black = stage.add(diffuse(0.0));
    stage.place_mesh(rectangle([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])).material = Some(black);
    moves(&mut stage, start, end, times);
    stage.sky(1.0);
    stage
}

/// Rows of the picture of a camera whose window is [-2, 2] × [-0.4, 0.4].
fn row(scene: &Scene, integrator: &'static str) -> Vec<f64> {
    let film = Shot::of(integrator, 4096).take(scene);
    (0..32).map(|x| film.pixels[x].mean()[0]).collect()
}

fn camera() -> Node {
    Node::new(Family::Camera, "orthographic", None)
        .with("screen_window", vec![-2.0, 2.0, -0.4, 0.4])
        .with("to_world", Transform::translate(DVec3::new(0.0, 0.0, -4.0)))
        .with("shutter_open", 2.0)
        .with("shutter_close", 4.0)
}

/// Share of the time and of a column of pixels in which a square, whose middle goes from -1 to 1 while the shutter is
/// open for the middle half of the time, shows the sky.
fn uncovered(column: usize) -> f64 {
    const STEPS: usize = 20_000;
    let [left, right] = [column, column + 1].map(|x| x as f64 / 8.0 - 2.0);
    let covered = |step: usize| {
        let middle = (step as f64 + 0.5) / STEPS as f64 - 0.5;
        ((middle + 0.5).min(right) - (middle - 0.5).max(left)).max(0.0) / (right - left)
    };
    1.0 - (0..STEPS).map(covered).sum::<f64>() / STEPS as f64
}

/// A square that passes covers each pixel as long as it is before it; so does one that stands still before a camera
/// that passes. Its motion lasts from 1 to 5, the exposure from 2 to 4.
#[test]
fn a_square_that_passes_covers_its_share() {
    let passing = || {
        let mut stage = square(shift(-1.0), shift(1.0), [1.0, 5.0]);
        stage.film(32, 1).camera(camera());
        stage.scene()
    };
    let passed = || {
        let mut stage = square(Transform::IDENTITY, Transform::IDENTITY, [0.0, 1.0]);
        let at = |x: f64| Transform::translate(DVec3::new(x, 0.0, -4.0));
        let node = camera().with("to_world", at(1.0)).with("to_world_end", at(-1.0));
        stage.film(32, 1).camera(node.with("motion_times", vec![1.0, 5.0]));
        stage.scene()
    };
    for (name, scene) in [("the square moves", passing()), ("the camera moves", passed())] {
        assert!(scene.moves() && scene.is_timed());
        for integrator in ["path", "volpath", "direct", "raycast"] {
            for (x, seen) in row(&scene, integrator).into_iter().enumerate() {
                let expected = uncovered(x);
                // Independent samples would have 0.008.
                assert!((seen - expected).abs() < 0.02, "{name}, {integrator}, column {x}: {seen}, not {expected}");
            }
        }
    }
}

/// A shutter that is open for no time, or a motion that is over before, shows one moment.
#[test]
fn an_instant_is_sharp() {
    let still = |at: f64| {
        let mut stage = square(shift(at), shift(at), [0.0, 1.0]);
        stage.film(32, 1).camera(camera());
        let scene = stage.scene();
        assert!(!scene.moves() && !scene.is_timed());
        Shot::of("direct", 4).take(&scene)
    };
    for (times, shutter, at) in
        [([0.0, 1.0], [2.0, 4.0], 0.5), ([2.0, 6.0], [3.0, 3.0], 0.125), ([5.0, 6.0], [2.0, 4.0], 0.0)]
    {
        let mut stage = square(shift(0.0), shift(0.5), times);
        let node = camera().with("shutter_open", shutter[0]).with("shutter_close", shutter[1]);
        stage.film(32, 1).camera(node);
        same_bits(&Shot::of("direct", 4).take(&stage.scene()), &still(at), "a still");
    }
}

/// A plate uncovers the view of a floor just when another one covers its lamp: no path sees both, so the floor stays
/// black, though each is open for half of the time. When both open at once it has half of the light. Photons and
/// bidirectional paths find the same.
#[test]
fn a_path_sees_one_moment() {
    let scene = |lamp_opens_first: bool| {
        let mut stage = Stage::new();
        let (floor, black) = (stage.add(diffuse(0.5)), stage.add(diffuse(0.0)));
        stage.place_mesh(rectangle([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0])).material = Some(floor);
        let mut plate = |x: f64, open_first: bool| {
            // Its edge passes x in the middle of the exposure.
            stage.place_mesh(rectangle([0.0, 1.0, -50.0], [0.0, 0.0, 100.0], [100.0, 0.0, 0.0])).material = Some(black);
            let (low, high) = (x - 30.0, x + 30.0);
            let (start, end) = if open_first { (high, low) } else { (low, high) };
            moves(&mut stage, shift(start), shift(end), [0.0, 1.0]);
        };
        // To the right of x the plate covers: that over the lamp at x = 12, that of the camera at x = -12, whose view
        // crosses its height at -7.2, is mirrored.
        plate(6.0, lamp_opens_first);
        let black = stage.add(diffuse(0.0));
        stage.place_mesh(rectangle([-100.0, 1.2, -50.0], [0.0, 0.0, 100.0], [100.0, 0.0, 0.0])).material = Some(black);
        moves(&mut stage, shift(-37.2), shift(22.8), [0.0, 1.0]);
        stage.light(light("point").with("position", [12.0, 2.0, 0.0]).with("intensity", white(1000.0)));
        stage.probe([-12.0, 2.0, 0.0], [0.0; 3]);
        stage.scene()
    };
    // I cos / d² ρ/π
    let d2: f64 = 148.0;
    let whole = 1000.0 * (2.0 / d2.sqrt()) / d2 * 0.5 / std::f64::consts::PI;
    for integrator in ["path", "volpath", "direct", "bdpt"] {
        let [first, last] = [true, false].map(|first| mean(&Shot::of(integrator, 16_384).take(&scene(first))));
        first.is_near_grey(&format!("{integrator}: both open in the first half"), 0.5 * whole, 0.01);
        assert!(last.mean[0] < 1e-3 * whole, "{integrator}: {:?}", last.mean);
    }
}

/// With something that turns and grows, all integrators that can do so find the same mean, also where paths share.
#[test]
fn integrators_agree_on_moving_things() {
    let mut stage = Stage::new();
    let grey = stage.add(diffuse(0.6));
    stage.place_mesh(rectangle([-2.0, 0.0, 2.0], [4.0, 0.0, 0.0], [0.0, 0.0, -4.0])).material = Some(grey);
    stage.mesh_lamp(rectangle([-0.5, 3.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 8.0);
    let red = stage.add(diffuse(0.5));
    stage.desc.nodes[red.0 as usize].set("reflectance", rgb([0.8, 0.2, 0.1]), None);
    stage.place(sphere([0.4, 0.5, 0.0], 0.4)).material = Some(red);
    let turn = Transform::rotate(DVec3::Y, 1.5) * Transform::scale(DVec3::new(1.2, 0.8, 1.0));
    moves(&mut stage, Transform::IDENTITY, turn, [0.0, 1.0]);
    stage.film(8, 8).look([0.0, 1.5, -3.0], [0.0, 0.4, 0.0], 45.0);
    let scene = stage.scene();
    let shot = |name| mean(&Shot::of(name, 4096).depth(4).take(&scene));
    let path = shot("path");
    for name in ["volpath", "bdpt", "light", "vcm", "sppm", "photon", "pssmlt", "mmlt"] {
        shot(name).agrees(name, path, 0.03);
    }
    mean(&Shot::of("path", 4096).depth(4).reuse(16).take(&scene)).agrees("sharing", path, 0.03);
}

//! Gratings: what a furnace shows of them, and one method against another.

use crate::{
    shot::{Estimate, Shot, mean},
    stage::{Stage, material, plane, shape, sphere, white},
};
use steradian_core::ColorMode;
use steradian_scene::{Node, Value};

/// A disk seen from straight above, under an even sky.
fn disk(made_of: Node) -> Stage {
    let mut stage = Stage::new();
    stage.solid(shape("disk").with("radius", 3.0), made_of);
    stage.sky(1.0).film(8, 8).look([0.0, 0.0, 9.0], [0.0, 0.0, 0.0], 4.0);
    stage
}

fn listed(efficiencies: &[f64]) -> Node {
    material("grating").with("efficiencies", Value::from(efficiencies.to_vec()))
}

/// At normal incidence first orders of a CD propagate at all wavelengths, those of a spacing of 360 nm at none (λ > d):
/// what is seen under an even sky is the sum of the efficiencies of those that do, without and with a blur.
#[test]
fn under_an_even_sky_the_orders_that_propagate_are_seen() {
    for alpha in [0.0, 0.01] {
        for (made_of, expected) in [
            (listed(&[1.0]), 1.0),
            (listed(&[0.1, 0.5, 0.3]), 0.9),
            (listed(&[0.2, 0.1, 0.5, 0.1, 0.1]).with("lines", 2778.0), 0.5),
        ] {
            let made_of = made_of.with("alpha_u", alpha);
            let film = Shot::of("path", 3000).take(&disk(made_of).scene_in(ColorMode::Spectral));
            mean(&film).is_near_grey(&format!("α = {alpha}, {expected}"), expected, 0.01);
        }
    }
}

/// A blurred grating under a lamp: paths from both ends find as much light.
#[test]
fn methods_agree_on_a_blurred_grating() {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), material("diffuse").with("reflectance", white(0.3)));
    let gold = material("grating").with("alpha_u", 0.1).with("alpha_v", 0.06).with("reflectance", white(0.9));
    stage.solid(sphere([0.0, 0.8, 0.0], 0.8), gold);
    stage.lamp(sphere([1.5, 3.0, -2.0], 0.5), 6.0);
    stage.film(6, 6).look([0.0, 2.0, -4.0], [0.0, 0.7, 0.0], 40.0);
    let scene = stage.scene_in(ColorMode::Spectral);
    let paths = mean(&Shot::of("path", 12_000).depth(4).take(&scene));
    let both = mean(&Shot::of("bdpt", 6000).depth(4).seed(2).take(&scene));
    let difference = both.plus(paths.times(-1.0));
    // Held against the mean of either, so that a difference of zero is what is expected.
    difference.plus(Estimate { mean: paths.mean, sigma: [0.0; 3] }).is_near("bdpt", paths.mean, 0.02);
}

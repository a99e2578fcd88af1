//! Ambient occlusion against closed forms.

use crate::{
    shot::{Shot, is_exactly, mean},
    stage::{Stage, diffuse, plane, rectangle},
};
use steradian_math::spectra::ColorMode;

/// M172: on an open floor all of the sky is seen, at the foot of an endless wall half of it, and past a wall of height
/// h in a distance d all but `½ (1 − d / √(d² + h²))`.
#[test]
fn walls_hide_their_part_of_the_sky() {
    let floor = || {
        let mut stage = Stage::new();
        stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(0.5));
        stage.probe([-1.0, 0.0, 1.0], [0.0, 0.0, 0.0]);
        stage
    };
    is_exactly(&Shot::of("ao", 64).take(&floor().scene()), "an open floor", [1.0; 3]);
    // White is white in spectra too.
    let spectral = mean(&Shot::of("ao", 20_000).take(&floor().scene_in(ColorMode::Spectral)));
    spectral.is_near("an open floor in spectra", [1.0; 3], 0.01);
    let mut corner = floor();
    corner.solid(plane([-1.0, 0.0, 0.0], -1e-3), diffuse(0.5));
    mean(&Shot::of("ao", 100_000).take(&corner.scene())).is_near_grey("the foot of a wall", 0.5, 0.01);
    let mut low = floor();
    let made_of = low.add(diffuse(0.5));
    low.place_mesh(rectangle([1.0, -300.0, 0.0], [0.0, 600.0, 0.0], [0.0, 0.0, 2.0])).material = Some(made_of);
    let open = 1.0 - 0.5 * (1.0 - 1.0 / 5.0_f64.sqrt());
    mean(&Shot::of("ao", 100_000).take(&low.scene())).is_near_grey("a low wall", open, 0.01);
}

//! A test card: a picture in which every orientation, flip and wrap is told from every other, and its values can be
//! computed.

use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::{Vec2, Vec3};

/// Cells of the card along each side.
const CELLS: f32 = 8.0;

/// The colour of the card at (x, y), x to the right and y down from the top left corner of the picture, in [0, 1]²: red
/// grows to the right and green downwards, checked with blue; a white arrow points right along the top and one down
/// along the left, from a black square in the corner; the right arrow's head is half as long again.
pub fn orientation(p: Vec2) -> Vec3 {
    let cell = (p * CELLS).floor();
    let q = p * CELLS;
    let checked = (cell.x + cell.y).rem_euclid(2.0);
    let arrow = |along: f32, across: f32, head: f32| {
        let shaft = (1.0..5.0).contains(&along) && (0.25..0.75).contains(&across);
        let tip = (5.0..5.0 + head).contains(&along) && (across - 0.5).abs() < 0.5 * (5.0 + head - along) / head;
        shaft || tip
    };
    if q.x < 1.0 && q.y < 1.0 {
        Vec3::ZERO
    } else if arrow(q.x, q.y, 1.5) || arrow(q.y, q.x, 1.0) {
        Vec3::ONE
    } else {
        Vec3::new(p.x, p.y, 0.25 + 0.25 * checked)
    }
}

/// The card as a picture of n × n texels, sampled at their middles.
pub fn texels(n: usize) -> Texels {
    let n = n.clamp(1, 4096);
    let at = |i: usize| (i as f32 + 0.5) / n as f32;
    let rows = (0..n).flat_map(|y| (0..n).map(move |x| Vec2::new(at(x), at(y))));
    Texels {
        width: n,
        height: n,
        channels: 3,
        data: TexelData::F32(rows.flat_map(|p| orientation(p).to_array()).collect()),
        encoding: Encoding::Linear,
        metadata: Default::default(),
    }
}

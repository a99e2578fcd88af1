//! Shapes of a program's own.

use glam::{DVec2, DVec3};
use std::{fmt::Debug, iter};

/// Most hits of one ray that are asked for, where the first ones do not count (holes by opacity).
const MOST_HITS: usize = 64;

/// A shape of a program's own: a surface in a box, in object space, where a function of the point is zero.
pub trait OwnShape: Debug + Send + Sync {
    /// Corners of the box, the least and the greatest; nothing is outside.
    fn corners(&self) -> [DVec3; 2];

    /// The function at a point and its gradient. Normals point to where it grows; of points near the surface the
    /// value over the length of the gradient is the distance.
    fn sample(&self, p: DVec3) -> (f64, DVec3);

    /// The least `t` in the range at which `origin + t·direction` is on the surface. Directions have any length.
    fn first(&self, origin: DVec3, direction: DVec3, range: [f64; 2]) -> Option<f64>;

    /// Parameters of a point of the surface, for textures.
    fn uv(&self, _p: DVec3) -> DVec2 {
        DVec2::ZERO
    }

    /// ∂p/∂u and ∂p/∂v; zero where there are no parameters.
    fn derivatives(&self, _p: DVec3) -> [DVec3; 2] {
        [DVec3::ZERO; 2]
    }
}

/// The hits of a ray up to a distance, in their order.
pub(super) fn roots(shape: &dyn OwnShape, origin: DVec3, direction: DVec3, length: f64) -> impl Iterator<Item = f64> {
    let next = move |from: f64| {
        let found = shape.first(origin, direction, [from, length])?;
        (found >= from && found <= length).then_some(found)
    };
    // The next one lies beyond the rounding of this one.
    iter::successors(next(0.0), move |t| next(t + (t.abs() + length) * 1e-9)).take(MOST_HITS)
}

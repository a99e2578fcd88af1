//! The disc of the sun: where it is, and directions within it.

use std::f32::consts::TAU;
use steradian_math::{Frame, Vec2, Vec3, warp};

/// A disc around a direction.
#[derive(Clone, Debug)]
pub(super) struct Disc {
    frame: Frame,
    one_minus_cos: f32,
    /// Square of the sine of half the aperture.
    sin2: f32,
}

impl Disc {
    /// A disc around a direction, by its whole angle in degrees.
    pub(super) fn new(middle: Vec3, aperture: f32) -> Self {
        // 1 − cos by the half-angle formula, without cancellation.
        let half = (0.5 * aperture.to_radians()).sin();
        let quarter = (0.5 * (0.5 * aperture).to_radians()).sin();
        let one_minus_cos = 2.0 * quarter * quarter;
        Self { frame: Frame::from_z(middle), one_minus_cos, sin2: half * half }
    }

    /// The square of the cosine at which the sun's surface is seen; `None` beside the disc.
    pub(super) fn mu2(&self, w: Vec3) -> Option<f32> {
        // Chord between the directions: |w − z|²/2 = 1 − cos.
        let x = 0.5 * (w - self.frame.z).length_squared();
        (x <= self.one_minus_cos).then(|| (1.0 - x * (2.0 - x) / self.sin2).max(0.0))
    }

    /// A direction, and its density per solid angle.
    pub(super) fn sample(&self, u: Vec2) -> (Vec3, f32) {
        // Uniform over the cone that the disc subtends.
        let w = self.frame.to_world(warp::uniform_cone(u, self.one_minus_cos));
        (w, warp::uniform_cone_pdf(self.one_minus_cos))
    }

    /// The density of [`Disc::sample`].
    pub(super) fn pdf(&self, w: Vec3) -> f32 {
        self.mu2(w).map_or(0.0, |_| warp::uniform_cone_pdf(self.one_minus_cos))
    }

    /// The integral of an even radiance over its solid angle.
    pub(super) fn integral(&self, radiance: f32) -> f32 {
        radiance * TAU * self.one_minus_cos
    }

    /// Ratio of its solid angle to that of another disc.
    pub(super) fn relative_to(&self, other: &Self) -> f32 {
        self.one_minus_cos / other.one_minus_cos
    }
}

/// A polynomial by its coefficients, that of the constant first.
pub(super) fn polynomial(c: &[f32], x: f32) -> f32 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

//! Directions drawn by more than scattering alone.

use steradian_bsdf::BsdfSample;
use steradian_core::material::Scattering;
use steradian_math::{Frame, Vec2, Vec3};

/// Guide of paths: it knows where light comes from, and draws directions that lead there.
pub trait Guide {
    /// Draws a direction at `p`, as [`Scattering::sample`] does, by the surface or by what is known.
    fn sample(
        &self,
        p: Vec3,
        frame: &Frame,
        wo: Vec3,
        scattering: &Scattering<'_>,
        u: f32,
        u2: Vec2,
    ) -> Option<GuidedDirection>;
}

/// The guide of paths that have none.
#[derive(Clone, Copy, Debug)]
pub enum NoGuide {}

impl Guide for NoGuide {
    fn sample(&self, _: Vec3, _: &Frame, _: Vec3, _: &Scattering<'_>, _: f32, _: Vec2) -> Option<GuidedDirection> {
        match *self {}
    }
}

/// A direction drawn by the surface or by a guide. The density that the sample states is that of the surface alone,
/// which other techniques are held against; its weight has that of both.
#[derive(Clone, Copy, Debug)]
pub struct GuidedDirection {
    /// The direction.
    pub sample: BsdfSample,
    /// The density by the surface over that by both.
    pub ratio: f32,
}

impl GuidedDirection {
    /// Drawn by the surface alone.
    #[inline]
    pub fn by_surface(sample: BsdfSample) -> Self {
        Self { sample, ratio: 1.0 }
    }
}

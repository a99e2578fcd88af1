//! Directions drawn by more than scattering alone: one sample of the mixture of two densities,
//!
//! `p(ω) = (1 − s) p_scattering(ω) + s p_guide(ω)`,
//!
//! weighted by `f |cosθ| / p` (one-sample balance heuristic, Veach 1997, sec. 9.2.4). The mean is right whatever the
//! guide knows.

use crate::Vertex;
use std::convert::Infallible;
use steradian_bsdf::{BsdfSample, Lobe};
use steradian_math::{Vec2, Vec3};

/// Guide of paths: knowledge of where light comes from.
pub trait Guide {
    /// Density of directions at a vertex that a path reached after so many scattering events; `None` where scattering
    /// alone draws them.
    fn at(&self, vertex: &Vertex<'_>, events: u32) -> Option<impl Directions>;
}

/// Density of unit directions in world space at a point.
pub trait Directions {
    /// Probability `s` that this density draws the direction, in (0, 1).
    fn share(&self) -> f32;

    /// A direction, by a number that chooses among parts and two for the place in one.
    fn sample(&self, u: f32, u2: Vec2) -> Vec3;

    /// Density of a direction, sr⁻¹.
    fn pdf(&self, w: Vec3) -> f32;
}

/// The guide of paths that have none.
#[derive(Clone, Copy, Debug)]
pub enum NoGuide {}

impl Guide for NoGuide {
    fn at(&self, _: &Vertex<'_>, _: u32) -> Option<impl Directions> {
        None::<Infallible>
    }
}

impl Directions for Infallible {
    fn share(&self) -> f32 {
        match *self {}
    }

    fn sample(&self, _: f32, _: Vec2) -> Vec3 {
        match *self {}
    }

    fn pdf(&self, _: Vec3) -> f32 {
        match *self {}
    }
}

/// A direction drawn by scattering or by a guide. The density that the sample states is that of scattering alone, which
/// other techniques are held against; its weight has that of both.
#[derive(Clone, Copy, Debug)]
pub struct GuidedDirection {
    /// The direction.
    pub sample: BsdfSample,
    /// The density by scattering over that by both.
    pub ratio: f32,
}

impl GuidedDirection {
    /// Drawn by scattering alone.
    #[inline]
    pub fn by_surface(sample: BsdfSample) -> Self {
        Self { sample, ratio: 1.0 }
    }

    /// Drawn at a vertex by the mixture of both densities.
    #[inline]
    pub fn by_mixture(v: &Vertex<'_>, guide: &impl Directions, u: f32, u2: Vec2) -> Option<Self> {
        let share = guide.share();
        // With probability s the guide draws; f |cosθ| and the density of scattering follow from the direction.
        if u < share {
            let w = guide.sample(u / share, u2);
            let e = v.eval(w);
            if e.value.is_black() {
                return None;
            }
            let pdf = e.pdf + share * (guide.pdf(w) - e.pdf);
            let wi = v.local(w);
            let side = if v.is_reflection(wi) { Lobe::REFLECTION } else { Lobe::TRANSMISSION };
            let lobe = side.with(Lobe::GLOSSY);
            let sample = BsdfSample { wi, weight: e.value / pdf, pdf: e.pdf, lobe, eta: 1.0 };
            return Some(Self { sample, ratio: e.pdf / pdf });
        }
        // Else scattering draws. A direction of a specular lobe has no density, and no other way leads to it.
        let s = v.draw((u - share) / (1.0 - share), u2)?;
        let ratio = if s.lobe.is_specular() {
            1.0 / (1.0 - share)
        } else {
            s.pdf / (s.pdf + share * (guide.pdf(v.world(s.wi)) - s.pdf))
        };
        Some(Self { sample: BsdfSample { weight: s.weight * ratio, ..s }, ratio })
    }
}

//! Lambertian reflection: `f = ρ/π`, the same in every direction.

use super::{BsdfEval, BsdfSample, Lobe, sample_cosine_hemisphere};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3};

/// An ideal diffuse reflector.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Albedo ρ, in `[0, 1]`.
    pub reflectance: Spectrum,
}

impl Diffuse {
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let pdf = wi.z * FRAC_1_PI;
        BsdfEval { value: self.reflectance * pdf, pdf }
    }

    pub(super) fn sample(&self, wo: Vec3, u2: Vec2) -> Option<BsdfSample> {
        if wo.z <= 0.0 || self.reflectance.is_black() {
            return None;
        }
        let wi = sample_cosine_hemisphere(u2)?;
        Some(BsdfSample {
            wi,
            weight: self.reflectance,
            pdf: wi.z * FRAC_1_PI,
            lobe: Lobe::REFLECTION.with(Lobe::DIFFUSE),
            eta: 1.0,
        })
    }
}

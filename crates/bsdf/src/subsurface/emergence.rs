//! Emergence of light from below a surface.

use super::profile::moment;
use crate::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode, fresnel,
    registry::{Case, Model, Visitor},
    sample_cosine_hemisphere,
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3};

/// Diffuse light from within, as much of it in each direction as the interface lets through: `(1 − F(ω_i))/(c π)`, of
/// which all is 1.
#[derive(Clone, Copy, Debug)]
pub struct Emergence {
    /// Index of the medium below relative to the one above.
    eta: f32,
    /// `1/c`.
    scale: f32,
}

impl Emergence {
    /// At the surface of a medium of this index relative to the one above, held in [0.05, 20]; 1 where it is none.
    pub fn new(eta: f32) -> Self {
        let eta = if eta > 0.0 { eta.clamp(0.05, 20.0) } else { 1.0 };
        // c = 1 − 2 ∫ F μ dμ, so that all of the light leaves.
        Self { eta, scale: (1.0 / (1.0 - 2.0 * moment(f64::from(eta), 1))) as f32 }
    }

    /// Index of the medium below relative to the one above.
    pub fn eta(&self) -> f32 {
        self.eta
    }

    /// The part of diffuse light from within that is reflected at the surface: what passes from within is what passes
    /// from outside, over η².
    pub fn diffuse_reflected_within(&self) -> f32 {
        // Reciprocity of the interface: (1 − F_within) η² = 1 − F_outside, for diffuse light.
        1.0 - 1.0 / (self.scale * self.eta * self.eta)
    }

    /// The part of light from within that is reflected at the surface, by its cosine.
    #[inline]
    pub fn reflected_within(&self, cos: f32) -> f32 {
        fresnel::dielectric(-cos.abs(), self.eta)
    }

    /// The direction within into which light is refracted that comes from one outside, both in the frame of the
    /// surface.
    #[inline]
    pub fn refracted(&self, w: Vec3) -> Option<Vec3> {
        // At a matched index light goes straight on.
        if (self.eta - 1.0).abs() < 1e-4 { Some(-w) } else { Some(fresnel::refract(w, Vec3::Z, self.eta)?.0) }
    }

    /// At least what [`Emergence::passed`] gives for any cosine.
    pub(super) fn most_passed(&self) -> f32 {
        self.scale
    }

    /// `(1 − F)/c` for a cosine outside.
    #[inline]
    pub fn passed(&self, cos: f32) -> f32 {
        (1.0 - fresnel::dielectric(cos, self.eta)) * self.scale
    }
}

impl Scatter for Emergence {
    const MODELS: &'static [Model] =
        &[Model::new("emergence", "light that leaves a medium below a surface", cases).not_reciprocal()];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        // Lambertian lobe times the Fresnel transmittance, drawn by the cosine.
        let pdf = wi.z * FRAC_1_PI;
        BsdfEval { value: Spectrum::splat(self.passed(wi.z) * pdf), pdf }
    }

    fn sample(&self, wo: Vec3, _: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = sample_cosine_hemisphere(u2)?;
        self.eval(wo, wi, mode).drawn_above(wi, Lobe::REFLECTION.with(Lobe::DIFFUSE))
    }

    fn albedo_estimate(&self, _: Vec3) -> Spectrum {
        Spectrum::ONE
    }

    fn is_reciprocal(&self) -> bool {
        false
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, eta| visit(Case { label, bsdf: Bsdf::Emergence(Emergence::new(eta)), lossless: true });
    case("skin", 1.4);
    case("glass", 1.5);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Diffuse light from within is reflected by 0.472 at an index of 1.33 and 0.596 at 1.5 (Egan and Hilgeman 1979).
    #[test]
    fn diffuse_light_is_reflected_within_as_published() {
        for (eta, expected) in [(1.0, 0.0), (1.33, 0.472), (1.5, 0.596)] {
            let found = Emergence::new(eta).diffuse_reflected_within();
            assert!((found - expected).abs() < 2e-3, "{found}");
        }
    }
}

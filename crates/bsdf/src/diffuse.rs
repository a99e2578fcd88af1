//! Lambertian reflection: `f = ρ/π`, the same in every direction.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode,
    registry::{Case, GREY, Model, Visitor},
    sample_cosine_hemisphere,
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3};

/// An ideal diffuse reflector.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Albedo ρ, in `[0, 1]`.
    pub reflectance: Spectrum,
}

impl Scatter for Diffuse {
    const MODELS: &'static [Model] = &[Model::new("diffuse", "Lambertian reflection", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let pdf = wi.z * FRAC_1_PI;
        BsdfEval { value: self.reflectance * pdf, pdf }
    }

    fn sample(&self, wo: Vec3, _: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
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

    #[inline]
    fn albedo_estimate(&self, _: Vec3) -> Spectrum {
        self.reflectance
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case =
        |label, reflectance, lossless| visit(Case { label, bsdf: Bsdf::Diffuse(Diffuse { reflectance }), lossless });
    case("coloured", GREY, false);
    case("white", Spectrum::ONE, true);
}

//! Lambertian reflection and transmission: `f = ρ/π` on the side of `wo`, `τ/π` on the other. Leaves, paper,
//! lampshades.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode,
    registry::{Case, GREY, Model, Visitor},
    sample_cosine_hemisphere,
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3};

/// An ideal diffuser that reflects and transmits, the same from both sides.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseTransmission {
    /// Reflected fraction ρ, in `[0, 1]`.
    pub reflectance: Spectrum,
    /// Transmitted fraction τ, in `[0, 1]`; `ρ + τ ≤ 1` conserves energy.
    pub transmittance: Spectrum,
}

impl DiffuseTransmission {
    /// Probability with which a sample is reflected; `None` for a black surface.
    fn reflection_probability(&self) -> Option<f32> {
        let (r, t) = (self.reflectance.max_element(), self.transmittance.max_element());
        (r + t > 0.0).then(|| r / (r + t))
    }
}

impl Scatter for DiffuseTransmission {
    const MODELS: &'static [Model] =
        &[Model::new("diffuse-transmission", "Lambertian reflection and transmission", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        let Some(pr) = self.reflection_probability() else { return BsdfEval::ZERO };
        if wo.z == 0.0 || wi.z == 0.0 {
            return BsdfEval::ZERO;
        }
        let cosine = wi.z.abs() * FRAC_1_PI;
        let (albedo, p) = if wo.z * wi.z > 0.0 { (self.reflectance, pr) } else { (self.transmittance, 1.0 - pr) };
        BsdfEval { value: albedo * cosine, pdf: p * cosine }
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        let pr = self.reflection_probability()?;
        if wo.z == 0.0 {
            return None;
        }
        let mut wi = sample_cosine_hemisphere(u2)?;
        let cosine = wi.z * FRAC_1_PI;
        let reflect = u < pr;
        if (wo.z > 0.0) != reflect {
            wi.z = -wi.z;
        }
        let (albedo, p, side) = if reflect {
            (self.reflectance, pr, Lobe::REFLECTION)
        } else {
            (self.transmittance, 1.0 - pr, Lobe::TRANSMISSION)
        };
        if p <= 0.0 {
            return None;
        }
        Some(BsdfSample { wi, weight: albedo / p, pdf: p * cosine, lobe: side.with(Lobe::DIFFUSE), eta: 1.0 })
    }

    #[inline]
    fn albedo_estimate(&self, _: Vec3) -> Spectrum {
        self.reflectance + self.transmittance
    }

    #[inline]
    fn transmits(&self) -> bool {
        true
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, reflectance, transmittance, lossless| {
        visit(Case {
            label,
            bsdf: Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance, transmittance }),
            lossless,
        });
    };
    case("half and half", Spectrum::splat(0.5), Spectrum::splat(0.5), true);
    case("coloured", GREY * 0.5, GREY * 0.2, false);
    case("transmits only", Spectrum::ZERO, GREY, false);
}

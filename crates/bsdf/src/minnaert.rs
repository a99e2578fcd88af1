//! Minnaert's law of planetary discs (1941, "The reciprocity principle in lunar photometry"): `f = ρ (k+1)/2π · (cosθ_o
//! cosθ_i)^(k−1)`.
//!
//! `k ≥ 0` is the limb darkening: 1 is Lambert, more darkens the limb (velvet at the least), less brightens it (the
//! full Moon has about ½). The albedo is `ρ cos^(k−1) θ_o`, so a surface with `k < 1` sends back more than it gets at
//! grazing angles: such values are empirical.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode,
    phong::FRAC_1_TAU,
    registry::{Case, GREY, Model, Recipe, Visitor, WHITE},
    scatter::Scatter,
};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    elementary::{Exponent, pow, sin_cos_turns},
};

/// A reflector after Minnaert.
#[derive(Clone, Copy, Debug)]
pub struct Minnaert {
    reflectance: Spectrum,
    exponent: Exponent,
    /// `k − 1`.
    less: Exponent,
    /// `1/(k + 1)`.
    inverse: f32,
}

impl Minnaert {
    /// Albedo at normal incidence ρ in `[0, 1]`, limb darkening `k` in `[0, 100]`; values outside are brought back.
    pub fn new(reflectance: Spectrum, exponent: f32) -> Self {
        let exponent = if exponent > 0.0 { exponent.min(100.0) } else { 0.0 };
        Self {
            reflectance: reflectance.clamp(0.0, 1.0),
            exponent: Exponent::new(exponent),
            less: Exponent::new(exponent - 1.0),
            inverse: 1.0 / (exponent + 1.0),
        }
    }

    /// `∫ f cosθ_i dω_i`, held where `k < 1` makes it grow without bound.
    fn albedo(&self, cos_o: f32) -> Spectrum {
        self.reflectance * self.less.power(f64::from(cos_o)).min(1e6)
    }

    /// By the power of the cosine.
    #[inline]
    fn density(&self, power: f32) -> f32 {
        (self.exponent.value() + 1.0) * FRAC_1_TAU * power
    }
}

impl Scatter for Minnaert {
    const MODELS: &'static [Model] = &[
        Model::new("minnaert", "diffuse reflection with a darkened limb", cases),
        Model::new("minnaert-bright-limb", "Minnaert below k = 1", bright_limb_cases).gains_energy(),
    ];
    const RECIPES: &'static [Recipe] =
        &[Recipe::new("minnaert", |i| Bsdf::Minnaert(Self::new(i.colors[0], i.numbers[0])))];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let pdf = self.density(self.exponent.power(f64::from(wi.z)));
        BsdfEval { value: self.albedo(wo.z) * pdf, pdf }
    }

    fn sample(&self, wo: Vec3, _: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 || self.reflectance.is_black() {
            return None;
        }
        // cosᵏ⁺¹ is uniform.
        let cos = pow(1.0 - u2.y, self.inverse);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = sin_cos_turns(u2.x);
        let wi = Vec3::new(sin * cos_phi, sin * sin_phi, cos);
        let pdf = self.density((1.0 - u2.y) / cos);
        let lobe = Lobe::REFLECTION.with(Lobe::DIFFUSE);
        (cos > 0.0 && pdf > 0.0).then(|| BsdfSample { wi, weight: self.albedo(wo.z), pdf, lobe, eta: 1.0 })
    }

    fn albedo_estimate(&self, _: Vec3) -> Spectrum {
        self.reflectance
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, reflectance, k, lossless| {
        visit(Case { label, bsdf: Bsdf::Minnaert(Minnaert::new(reflectance, k)), lossless });
    };
    case("Lambert", WHITE, 1.0, true);
    case("dark limb", GREY, 1.7, false);
    case("velvet the wrong way", WHITE, 30.0, false);
}

fn bright_limb_cases(visit: &mut Visitor<'_>) {
    let bsdf = Bsdf::Minnaert(Minnaert::new(WHITE, 0.5));
    visit(Case { label: "the full Moon", bsdf, lossless: false });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponent_of_one_is_lambert_and_the_moon_has_no_limb_darkening() {
        let (wo, wi) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, -0.8, 0.6));
        let lambert = Minnaert::new(Spectrum::splat(0.3), 1.0).eval(wo, wi, TransportMode::Radiance).value[0];
        assert!((lambert - 0.3 * 0.6 / std::f32::consts::PI).abs() < 1e-7);
        // At full Moon every point of the disc has wi = wo: with k = ½ it looks equally bright, f cosθ_i the same.
        let moon = Minnaert::new(Spectrum::splat(0.1), 0.5);
        let at = |cos: f32| {
            let w = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            moon.eval(w, w, TransportMode::Radiance).value[0]
        };
        assert!((at(0.9) - at(0.1)).abs() < 1e-6);
    }
}

//! The classical sum: a Lambertian part and a glossy lobe, `f = k_d/π + k_s f_lobe`.

use super::{
    BsdfEval, BsdfSample, Lobe, TransportMode,
    registry::{Model, Recipe},
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Chance, Spectrum, Vec2, Vec3, warp::cosine_hemisphere};

/// A reflecting lobe above the surface; both directions are.
pub trait GlossyLobe: Copy {
    /// The model, or its forms, with cases for the laws.
    const MODELS: &'static [Model];
    /// Recipes that make the model from parameters alone.
    const RECIPES: &'static [Recipe];

    /// True if the lobe of reflectance one sends back no more light than it gets, so that `k_d + k_s ≤ 1` bounds the
    /// sum.
    fn conserves(&self) -> bool;

    /// True if the lobe is the same with the directions exchanged.
    fn is_reciprocal(&self) -> bool {
        true
    }

    /// `f cosθ_i` for reflectance one, and the density with which `sample` draws `wi` (both sr⁻¹).
    fn eval(&self, wo: Vec3, wi: Vec3) -> (f32, f32);

    /// A direction, not necessarily above the surface, with what `eval` says of it.
    fn sample(&self, wo: Vec3, u2: Vec2) -> (Vec3, f32, f32);
}

/// A lobe beside Lambertian reflection.
#[derive(Clone, Copy, Debug)]
pub struct LobeOverDiffuse<L> {
    diffuse: Spectrum,
    specular: Spectrum,
    lobe: L,
    /// The probability of sampling the lobe.
    glossy: f32,
}

impl<L: GlossyLobe> LobeOverDiffuse<L> {
    /// `k_d` and `k_s`, each held in `[0, 1]`; where they exceed one together both are scaled down, if the lobe
    /// conserves energy.
    pub(super) fn of(diffuse: Spectrum, specular: Spectrum, lobe: L) -> Self {
        let (mut diffuse, mut specular) = (diffuse.clamp(0.0, 1.0), specular.clamp(0.0, 1.0));
        if lobe.conserves() {
            let over = (diffuse + specular).map(|sum| 1.0 / sum.max(1.0));
            (diffuse, specular) = (diffuse * over, specular * over);
        }
        let (d, s) = (diffuse.max_element(), specular.max_element());
        Self { diffuse, specular, lobe, glossy: if s > 0.0 { s / (d + s) } else { 0.0 } }
    }

    #[inline(always)]
    fn eval_lobe(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        if self.glossy > 0.0 { self.lobe.eval(wo, wi) } else { (0.0, 0.0) }
    }

    /// The sum of both parts where the lobe has this value and density.
    #[inline]
    fn sum(&self, wi: Vec3, value: f32, pdf: f32) -> BsdfEval {
        let cosine = wi.z * FRAC_1_PI;
        BsdfEval {
            value: self.diffuse * cosine + self.specular * value,
            pdf: (1.0 - self.glossy) * cosine + self.glossy * pdf,
        }
    }
}

impl<L: GlossyLobe> Scatter for LobeOverDiffuse<L> {
    const MODELS: &'static [Model] = L::MODELS;
    const RECIPES: &'static [Recipe] = L::RECIPES;

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let (value, pdf) = self.eval_lobe(wo, wi);
        if (value + pdf).is_finite() { self.sum(wi, value, pdf) } else { BsdfEval::ZERO }
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (wi, (value, pdf), shape) = if Chance::from(u) < Chance::from(self.glossy) {
            let (wi, value, pdf) = self.lobe.sample(wo, u2);
            (wi, (value, pdf), Lobe::GLOSSY)
        } else {
            let wi = cosine_hemisphere(u2);
            (wi, self.eval_lobe(wo, wi), Lobe::DIFFUSE)
        };
        self.sum(wi, value, pdf).drawn_above(wi, Lobe::REFLECTION.with(shape))
    }

    fn albedo_estimate(&self, _: Vec3) -> Spectrum {
        (self.diffuse + self.specular).clamp(0.0, 1.0)
    }

    fn is_reciprocal(&self) -> bool {
        self.lobe.is_reciprocal()
    }
}

//! Blinn–Phong: a power of the cosine between the normal and the half vector (Blinn 1977).
//!
//! ```text
//! normalised  f = k_d/π + k_s (n+2)(n+4) / (8π (2^(−n/2) + n)) · cos^n θ_h
//! empirical   f = k_d/π + k_s cos^n θ_h / cosθ_i                                 as Phong's of 1975
//! ```
//!
//! The normalisation makes the albedo one at normal incidence, where it is largest (Giesen 2009, "Phong and Blinn–Phong
//! normalization factors"); it is reciprocal. The empirical form is neither reciprocal nor bounded by its `k_s`. A
//! Blinn–Phong lobe is as wide as a Phong lobe of about a quarter of its exponent. Exponents are in `[0, 10⁶]`.

use super::{
    Bsdf,
    lobe_over_diffuse::{GlossyLobe, LobeOverDiffuse},
    phong::{FRAC_1_TAU, exponent_in_range},
    registry::{BLACK, Case, GREY, Model, Recipe, Visitor, WHITE},
};
use std::f32::consts::{LN_2, PI};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    elementary::{Exponent, exp, pow_and_excess, sin_cos_turns},
};

/// A lobe in the half vector.
#[derive(Clone, Copy, Debug)]
pub struct HalfVectorLobe {
    exponent: f32,
    /// `−n/2`.
    of_secant2: Exponent,
    /// `1/(n + 1)`.
    inverse: f32,
    /// Normalisation of the value over `cosⁿ cosθ_i`; none in the empirical form.
    normalisation: Option<f32>,
}

/// Blinn–Phong reflection.
pub type BlinnPhong = LobeOverDiffuse<HalfVectorLobe>;

impl BlinnPhong {
    /// The normalised, reciprocal form.
    pub fn normalised(diffuse: Spectrum, specular: Spectrum, exponent: f32) -> Self {
        Self::of(diffuse, specular, HalfVectorLobe::new(exponent, false))
    }

    /// The form without normalisation.
    pub fn empirical(diffuse: Spectrum, specular: Spectrum, exponent: f32) -> Self {
        Self::of(diffuse, specular, HalfVectorLobe::new(exponent, true))
    }
}

impl GlossyLobe for HalfVectorLobe {
    const MODELS: &'static [Model] = &[
        Model::new("blinn-phong", "normalised cosine lobe in the half vector", cases),
        Model::new("blinn-phong-empirical", "without normalisation", empirical_cases).not_reciprocal().gains_energy(),
    ];
    const RECIPES: &'static [Recipe] = &[Recipe::new("blinn_phong", |i| {
        let make = [BlinnPhong::normalised, BlinnPhong::empirical][i.choice as usize];
        Bsdf::BlinnPhong(make(i.colors[0], i.colors[1], i.numbers[0]))
    })];

    fn conserves(&self) -> bool {
        self.normalisation.is_some()
    }

    fn is_reciprocal(&self) -> bool {
        self.normalisation.is_some()
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let h = wo + wi;
        let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
        let power = self.of_secant2.power(1.0 + f64::from(tan2));
        (self.value(power, wi), self.density(power, 0.5 * h.length()))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3, u2: Vec2) -> (Vec3, f32, f32) {
        // cosⁿ⁺¹θ_h is uniform; the half vector as long as 1/cosθ_h.
        let uniform = 1.0 - u2.y;
        let (length2, tan2) = pow_and_excess(uniform, -2.0 * self.inverse);
        let (tan, azimuth) = (tan2.max(0.0).sqrt(), Vec2::from(sin_cos_turns(u2.x)));
        let projected = wo.z + tan * azimuth.dot(wo.truncate());
        // Facets seen from behind send light below the surface.
        let twice = projected * (2.0 / length2);
        let wi = ((twice * tan) * azimuth - wo.truncate()).extend(twice - wo.z);
        (wi, self.value(uniform * length2.sqrt(), wi), self.density(uniform * length2, projected))
    }
}

impl HalfVectorLobe {
    fn new(exponent: f32, empirical: bool) -> Self {
        let n = exponent_in_range(exponent);
        let normalisation = (n + 2.0) * (n + 4.0) / (8.0 * PI * (exp(-0.5 * LN_2 * n) + n));
        Self {
            exponent: n,
            of_secant2: Exponent::new(-0.5 * n),
            inverse: 1.0 / (n + 1.0),
            normalisation: (!empirical).then_some(normalisation),
        }
    }

    /// By `cos^n θ_h`.
    #[inline(always)]
    fn value(&self, power: f32, wi: Vec3) -> f32 {
        self.normalisation.map_or(power, |k| k * power * wi.z)
    }

    /// By `cos^n θ_h` and the cosine between direction and half vector, or both as many times as large.
    #[inline(always)]
    fn density(&self, power: f32, cos_o: f32) -> f32 {
        (self.exponent + 1.0) * (0.25 * FRAC_1_TAU) * power / cos_o.max(1e-6)
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, value| visit(Case { label, bsdf: Bsdf::BlinnPhong(value), lossless: false });
    case("exponent 0", BlinnPhong::normalised(BLACK, WHITE, 0.0));
    case("exponent 2, white", BlinnPhong::normalised(BLACK, WHITE, 2.0));
    case("exponent 40, coloured", BlinnPhong::normalised(GREY, WHITE - GREY, 40.0));
    case("exponent 800", BlinnPhong::normalised(GREY * 0.2, WHITE * 0.5, 800.0));
}

fn empirical_cases(visit: &mut Visitor<'_>) {
    let bsdf = Bsdf::BlinnPhong(BlinnPhong::empirical(GREY * 0.5, WHITE, 5.0));
    visit(Case { label: "exponent 5", bsdf, lossless: false });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scatter, TransportMode};

    #[test]
    fn the_albedo_is_one_at_normal_incidence_and_less_at_others() {
        for n in [0.0, 2.0, 20.0, 200.0] {
            let m = BlinnPhong::normalised(Spectrum::ZERO, Spectrum::ONE, n);
            let albedo = |degrees: f32| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let wo = Vec3::new(sin, 0.0, cos);
                steradian_testkit::integrate_sphere(
                    |w| f64::from(m.eval(wo, w, TransportMode::Radiance).value[0]),
                    1e-4,
                )
            };
            assert!((albedo(0.0) - 1.0).abs() < 1e-3, "n = {n}: {}", albedo(0.0));
            assert!([30.0, 60.0, 85.0].iter().all(|&d| albedo(d) < 1.0 + 1e-3), "n = {n}");
        }
    }
}

//! Rough diffuse surfaces of Lambertian V-grooves (Oren & Nayar 1994), in four forms.
//!
//! With `s = wo·wi − cosθ_o cosθ_i` (the cosine of the azimuth times both sines) and `t = max(cosθ_o, cosθ_i)` where `s
//! > 0`, else 1:
//!
//! ```text
//! qualitative         f = ρ/π (A + B max(0, s)/t),  A = 1 − ½σ²/(σ² + 0.33),  B = 0.45σ²/(σ² + 0.09)        eq. 30
//! full                f = L₁ + L₂, with light between facets                                                eqs. 27–29
//! Fujii               f = ρ/π (1 + r s/t) / (1 + (½ − 2/3π) r)
//! energy-preserving   Fujii's + ρ_ms/π (1 − E(θ_o))(1 − E(θ_i))/(1 − ⟨E⟩),  ρ_ms = ρ²⟨E⟩/(1 − ρ(1 − ⟨E⟩))
//! ```
//!
//! Fujii's form is from his note "A tiny improvement of Oren–Nayar reflectance model"; the energy-preserving one is EON
//! of Portsmouth, Kutz & Hill (2025, "EON: A practical energy-preserving rough diffuse BRDF", JCGT 14), with its exact
//! albedo `E`. White loses nothing in EON alone. `σ` is the standard deviation of the facets' slope angle in radians,
//! in `[0, π/2]`; `r` is in `[0, 1]`. EON's authors draw from a fitted lobe; here directions are drawn by the cosine.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode,
    registry::{Case, GREY, Model, Recipe, Visitor, WHITE},
    sample_cosine_hemisphere,
    scatter::Scatter,
};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, PI};
use steradian_math::{Spectrum, Vec2, Vec3, elementary::acos};

/// Which of the forms.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum OrenNayarForm {
    /// The paper's simple form.
    Qualitative,
    /// The paper's full form.
    Full,
    /// Fujii's.
    Fujii,
    /// EON.
    EnergyPreserving,
}

/// A rough diffuse reflector.
#[derive(Clone, Copy, Debug)]
pub struct OrenNayar {
    reflectance: Spectrum,
    /// `ρ_ms/(1 − ⟨E⟩)` of EON.
    lost: Spectrum,
    roughness: f32,
    /// The factors of ρ and of `ρ s/t` of all forms but the full one.
    flat: f32,
    azimuthal: f32,
    form: OrenNayarForm,
}

/// `½ − 2/(3π)`.
const C1: f32 = 0.5 - 2.0 / (3.0 * PI);
/// `2/3 − 28/(15π)`.
const C2: f32 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

impl OrenNayar {
    /// A reflector of albedo ρ and roughness σ (the first two forms, radians) or `r` (the others); held in their
    /// ranges.
    pub fn new(reflectance: Spectrum, roughness: f32, form: OrenNayarForm) -> Self {
        use OrenNayarForm::{EnergyPreserving, Fujii, Full, Qualitative};
        let largest = if matches!(form, Qualitative | Full) { FRAC_PI_2 } else { 1.0 };
        let roughness = if roughness > 0.0 { roughness.min(largest) } else { 0.0 };
        let (reflectance, s2) = (reflectance.clamp(0.0, 1.0), roughness * roughness);
        let scale = 1.0 / (1.0 + C1 * roughness);
        let (flat, azimuthal) = match form {
            Qualitative | Full => (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09)),
            Fujii | EnergyPreserving => (scale, scale * roughness),
        };
        let mean = scale * (1.0 + C2 * roughness);
        let scattered_on = reflectance.map(|rho| rho * rho * mean / (1.0 - rho * (1.0 - mean)));
        Self { reflectance, lost: scattered_on / (1.0 - mean).max(1e-7), roughness, flat, azimuthal, form }
    }

    /// `π f`.
    fn times_pi(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        let (rho, s) = (self.reflectance, wo.x * wi.x + wo.y * wi.y);
        let highest = wo.z.max(wi.z);
        match self.form {
            OrenNayarForm::Qualitative => rho * (self.flat + self.azimuthal * s.max(0.0) / highest),
            OrenNayarForm::Full => self.full(wo, wi, s),
            OrenNayarForm::Fujii => rho * self.fujii(s, highest),
            OrenNayarForm::EnergyPreserving => {
                let albedo = |w: Vec3| self.flat + self.azimuthal * FRAC_1_PI * excess(w.z);
                let lost = ((1.0 - albedo(wo)) * (1.0 - albedo(wi))).max(0.0);
                rho * self.fujii(s, highest) + self.lost * lost
            }
        }
    }

    fn fujii(&self, s: f32, highest: f32) -> f32 {
        let t = if s > 0.0 { highest } else { 1.0 };
        self.flat + self.azimuthal * s / t
    }

    fn full(&self, wo: Vec3, wi: Vec3, s: f32) -> Spectrum {
        let s2 = self.roughness * self.roughness;
        // α is the larger of the two angles from the normal, β the smaller.
        let sin2 = |w: Vec3| w.x * w.x + w.y * w.y;
        let (cos_a, cos_b) = (wo.z.min(wi.z).min(1.0), wo.z.max(wi.z).min(1.0));
        let (sin_a, sin_b) = (sin2(wo).max(sin2(wi)).sqrt(), sin2(wo).min(sin2(wi)).sqrt());
        let (alpha, beta) = (acos(cos_a), acos(cos_b));
        let sines = sin_a * sin_b;
        let cos_phi = if sines > 1e-9 { (s / sines).clamp(-1.0, 1.0) } else { 0.0 };
        let (steep, quarter) = (s2 / (s2 + 0.09), 2.0 * beta * FRAC_1_PI);
        let c2 = self.azimuthal * if cos_phi >= 0.0 { sin_a } else { sin_a - quarter * quarter * quarter };
        let c3 = 0.125 * steep * (4.0 * alpha * beta * FRAC_1_PI * FRAC_1_PI).powi(2);
        // tan of half the sum of the angles grows only to the tangent of the smaller one's complement.
        let half = (sin_a + sin_b) / (cos_a + cos_b).max(1e-4);
        let tan_beta = sin_b / cos_b.max(1e-4);
        let direct = (self.flat + cos_phi * c2 * tan_beta + (1.0 - cos_phi.abs()) * c3 * half).max(0.0);
        let between = 0.17 * s2 / (s2 + 0.13) * (1.0 - cos_phi * quarter * quarter);
        self.reflectance * direct + self.reflectance * self.reflectance * between
    }
}

impl Scatter for OrenNayar {
    const MODELS: &'static [Model] = &[Model::new("oren-nayar", "rough diffuse reflection", cases)];
    const RECIPES: &'static [Recipe] = &[Recipe::new("oren_nayar", |i| {
        use OrenNayarForm::{EnergyPreserving, Fujii, Full, Qualitative};
        let [roughness, sigma, ..] = i.numbers;
        let (form, width) =
            [(EnergyPreserving, roughness), (Fujii, roughness), (Qualitative, sigma), (Full, sigma)][i.choice as usize];
        Bsdf::OrenNayar(Self::new(i.colors[0], width, form))
    })];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let pdf = wi.z * FRAC_1_PI;
        BsdfEval { value: self.times_pi(wo, wi) * pdf, pdf }
    }

    fn sample(&self, wo: Vec3, _: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 || self.reflectance.is_black() {
            return None;
        }
        let wi = sample_cosine_hemisphere(u2)?;
        let lobe = Lobe::REFLECTION.with(Lobe::DIFFUSE);
        Some(BsdfSample { wi, weight: self.times_pi(wo, wi), pdf: wi.z * FRAC_1_PI, lobe, eta: 1.0 })
    }

    fn albedo_estimate(&self, _: Vec3) -> Spectrum {
        self.reflectance
    }
}

/// Energy-preserving reflection over that of a Lambertian surface of the same albedo `rho`, at roughness `r` in [0, 1].
/// Directions on one side.
#[inline]
pub(super) fn over_lambert(rho: Spectrum, r: f32, wo: Vec3, wi: Vec3) -> Spectrum {
    let scale = 1.0 / (1.0 + C1 * r);
    let mean = scale * (1.0 + C2 * r);
    let (s, highest) = (wo.x * wi.x + wo.y * wi.y, wo.z.abs().max(wi.z.abs()));
    let fujii = scale * (1.0 + r * s / if s > 0.0 { highest } else { 1.0 });
    let albedo = |w: Vec3| scale * (1.0 + r * FRAC_1_PI * excess(w.z.abs()));
    let lost = ((1.0 - albedo(wo)) * (1.0 - albedo(wi))).max(0.0) / (1.0 - mean).max(1e-7);
    rho.map(|rho| fujii + rho * mean / (1.0 - rho * (1.0 - mean)) * lost)
}

/// `G(θ) = sinθ (θ − sinθ cosθ) + ⅔ (tanθ (1 − sin³θ) − sinθ)` of EON's albedo, without the tangent's pole.
fn excess(cos: f32) -> f32 {
    let cos = cos.clamp(0.0, 1.0);
    let sin = (1.0 - cos * cos).sqrt();
    let theta = acos(cos);
    let tangent = sin * cos * (1.0 + sin + sin * sin) / (1.0 + sin);
    sin * (theta - sin * cos) + 2.0 / 3.0 * (tangent - sin)
}

fn cases(visit: &mut Visitor<'_>) {
    use OrenNayarForm::{EnergyPreserving, Fujii, Full, Qualitative};
    let mut case = |label, reflectance, roughness, form, lossless| {
        visit(Case { label, bsdf: Bsdf::OrenNayar(OrenNayar::new(reflectance, roughness, form)), lossless });
    };
    case("qualitative, 0.3", GREY, 0.3, Qualitative, false);
    case("qualitative, white, 90°", WHITE, 10.0, Qualitative, false);
    case("full, 0.5", GREY, 0.5, Full, false);
    case("full, white, 90°", WHITE, 10.0, Full, false);
    case("Fujii, 0.7", GREY, 0.7, Fujii, false);
    case("Fujii, white, 1", WHITE, 1.0, Fujii, false);
    case("EON, coloured", GREY, 0.6, EnergyPreserving, false);
    case("EON, white, smooth", WHITE, 0.0, EnergyPreserving, true);
    case("EON, white, 0.5", WHITE, 0.5, EnergyPreserving, true);
    case("EON, white, 1", WHITE, 1.0, EnergyPreserving, true);
}

#[cfg(test)]
mod tests {
    use super::*;
    use OrenNayarForm::{EnergyPreserving, Fujii, Full, Qualitative};

    fn direction(degrees: f32, phi: f32) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    }

    #[test]
    fn without_roughness_all_forms_are_lambertian() {
        let (wo, wi) = (direction(50.0, 0.3), direction(20.0, 2.0));
        for form in [Qualitative, Full, Fujii, EnergyPreserving] {
            let e = OrenNayar::new(Spectrum::splat(0.6), 0.0, form).eval(wo, wi, TransportMode::Radiance);
            assert!((e.value[0] - 0.6 * wi.z * FRAC_1_PI).abs() < 1e-6, "{form:?}");
        }
    }

    /// At σ = 30° A = 0.7731 and B = 0.3388: a rough surface looks flat and glows backwards.
    #[test]
    fn the_qualitative_form_has_the_papers_constants() {
        let m = OrenNayar::new(Spectrum::ONE, 30f32.to_radians(), Qualitative);
        let (w, opposite) = (direction(60.0, 0.0), direction(60.0, PI));
        let (a, b) = (0.7731, 0.3388);
        assert!((m.times_pi(w, opposite)[0] - a).abs() < 1e-3);
        // sin 60° tan 60° = 1.5.
        assert!((m.times_pi(w, w)[0] - (a + 1.5 * b)).abs() < 1e-3);
    }

    #[test]
    fn the_closed_albedo_is_that_of_the_single_scattering() {
        let m = OrenNayar::new(Spectrum::ONE, 0.8, Fujii);
        for degrees in [0.0, 40.0, 75.0, 88.0] {
            let wo = direction(degrees, 0.0);
            let albedo = steradian_testkit::integrate_sphere(
                |w| f64::from(m.eval(wo, w, TransportMode::Radiance).value[0]),
                1e-3,
            );
            let closed = (1.0 + 0.8 * FRAC_1_PI * excess(wo.z)) / (1.0 + C1 * 0.8);
            assert!((albedo - f64::from(closed)).abs() < 2e-3, "{degrees}°: {albedo} is not {closed}");
        }
    }
}

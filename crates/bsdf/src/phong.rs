//! Cosine lobes around a transformed direction: Phong and Lafortune.
//!
//! ```text
//! modified Phong   f = k_d/π + k_s (n+2)/2π · max(0, cosα)^n             cosα = R(wo)·wi;  Lafortune & Willems 1994
//! empirical Phong  f = k_d/π + k_s max(0, cosα)^n / cosθ_i              Phong 1975, as a BRDF: see below
//! Lafortune        f = k_d/π + k_s (n+2)/2π · max(0, C_x x x' + C_y y y' + C_z z z')^n Lafortune et al. 1997, one lobe
//! ```
//!
//! The modified form is reciprocal and its albedo at most `k_d + k_s`. The empirical form is what the illumination
//! model of 1975 says of a point light, `L = L_i k_s cos^n α`: neither reciprocal nor, below `n = 2π − 1`, bounded by
//! its `k_s`. Lafortune's coefficients lie in `[−1, 1]`: (−1, −1, 1) is Phong, less in `z` makes the lobe lean towards
//! grazing, a positive `x` and `y` throw light back. Exponents are in `[0, 10⁶]`.

use super::{
    Bsdf,
    lobe_over_diffuse::{GlossyLobe, LobeOverDiffuse},
    registry::{BLACK, Case, GREY, Model, Recipe, Visitor, WHITE},
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{
    Spectrum, Vec2, Vec3,
    elementary::{Exponent, pow_and_excess, sin_cos_turns},
};

/// `1/2π`.
pub(super) const FRAC_1_TAU: f32 = 0.5 * FRAC_1_PI;

/// A cosine lobe.
#[derive(Clone, Copy, Debug)]
pub struct CosineLobe {
    coefficients: Vec3,
    exponent: Exponent,
    /// `n/2`.
    half: Exponent,
    /// `1/(n + 1)`.
    inverse: f32,
    empirical: bool,
    /// True if the coefficients are those of the mirror direction.
    is_mirror: bool,
}

/// Phong's model and its relatives.
pub type Phong = LobeOverDiffuse<CosineLobe>;

/// An exponent brought into its range.
pub(super) fn exponent_in_range(n: f32) -> f32 {
    if n > 0.0 { n.min(1e6) } else { 0.0 }
}

impl Phong {
    /// Phong's mirror direction.
    pub const MIRROR: Vec3 = Vec3::new(-1.0, -1.0, 1.0);

    /// The normalised, reciprocal form.
    pub fn modified(diffuse: Spectrum, specular: Spectrum, exponent: f32) -> Self {
        Self::lafortune(diffuse, specular, Self::MIRROR, exponent)
    }

    /// The form of 1975.
    pub fn empirical(diffuse: Spectrum, specular: Spectrum, exponent: f32) -> Self {
        Self::of(diffuse, specular, CosineLobe::new(Self::MIRROR, exponent, true))
    }

    /// One lobe of Lafortune's, with coefficients held in `[−1, 1]`.
    pub fn lafortune(diffuse: Spectrum, specular: Spectrum, coefficients: Vec3, exponent: f32) -> Self {
        let coefficients =
            if coefficients.is_finite() { coefficients.clamp(-Vec3::ONE, Vec3::ONE) } else { Self::MIRROR };
        Self::of(diffuse, specular, CosineLobe::new(coefficients, exponent, false))
    }
}

impl CosineLobe {
    fn new(coefficients: Vec3, exponent: f32, empirical: bool) -> Self {
        let exponent = exponent_in_range(exponent);
        let (inverse, is_mirror) = (1.0 / (exponent + 1.0), coefficients == Phong::MIRROR);
        let (exponent, half) = (Exponent::new(exponent), Exponent::new(0.5 * exponent));
        Self { coefficients, exponent, half, inverse, empirical, is_mirror }
    }

    /// The lobe's axis and the squared length of the transformed direction.
    fn axis(&self, wo: Vec3) -> Option<(Vec3, f32)> {
        if self.is_mirror {
            return Some((Vec3::new(-wo.x, -wo.y, wo.z), 1.0));
        }
        let d = self.coefficients * wo;
        let length2 = d.length_squared();
        (length2 > 1e-12).then(|| (d * (1.0 / length2.sqrt()), length2))
    }
}

impl GlossyLobe for CosineLobe {
    const MODELS: &'static [Model] = &[
        Model::new("phong", "normalised cosine lobe around the mirror direction", cases),
        Model::new("phong-empirical", "Phong of 1975", empirical_cases).not_reciprocal().gains_energy(),
        Model::new("lafortune", "cosine lobe around a transformed direction", lafortune_cases),
    ];
    const RECIPES: &'static [Recipe] = &[
        Recipe::new("phong", |i| {
            let make = [Phong::modified, Phong::empirical][i.choice as usize];
            Bsdf::Phong(make(i.colors[0], i.colors[1], i.numbers[0]))
        }),
        Recipe::new("lafortune", |i| Bsdf::Phong(Phong::lafortune(i.colors[0], i.colors[1], i.vector, i.numbers[0])))
            .anisotropic(),
    ];

    fn conserves(&self) -> bool {
        !self.empirical
    }

    fn is_reciprocal(&self) -> bool {
        !self.empirical
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let Some((axis, length2)) = self.axis(wo) else { return (0.0, 0.0) };
        // By the distance of the unit vectors: the cosine itself is too coarse for large exponents.
        let versine = 0.5 * (axis - wi).length_squared();
        let power = self.exponent.power(1.0 - f64::from(versine.min(0.999_999_9)));
        self.of_powers(if versine < 1.0 { power } else { 0.0 }, self.size(length2), wi)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3, u2: Vec2) -> (Vec3, f32, f32) {
        let Some((axis, length2)) = self.axis(wo) else { return (Vec3::ZERO, 0.0, 0.0) };
        // cosⁿ⁺¹α is uniform; the angle by 1 − cosα, which is small for large exponents.
        let uniform = 1.0 - u2.y;
        let (cos, excess) = pow_and_excess(uniform, self.inverse);
        let sin = (-excess * (2.0 + excess)).max(0.0).sqrt();
        let wi = about(axis, cos, sin, Vec2::from(sin_cos_turns(u2.x)));
        let (value, pdf) = self.of_powers(uniform / cos, self.size(length2), wi);
        (wi, value, pdf)
    }
}

/// The direction at an angle from an axis. The azimuth is turned with the normal the shortest way to the axis; for one
/// that points down both are mirrored.
#[inline(always)]
fn about(axis: Vec3, cos: f32, sin: f32, azimuth: Vec2) -> Vec3 {
    let flat = axis.truncate();
    let off = azimuth.dot(flat);
    let along = cos - sin * (off / (1.0 + axis.z.abs()));
    (sin * azimuth + along * flat).extend(cos * axis.z - sin * (off * 1f32.copysign(axis.z)))
}

impl CosineLobe {
    /// The power of the transformed direction's length, by its square.
    #[inline(always)]
    fn size(&self, length2: f32) -> f32 {
        if self.is_mirror { 1.0 } else { self.half.power(f64::from(length2)) }
    }

    /// Value and density by `cosⁿα` and the same power of the transformed direction's length.
    #[inline(always)]
    fn of_powers(&self, power: f32, size: f32, wi: Vec3) -> (f32, f32) {
        let value =
            if self.empirical { power } else { (self.exponent.value() + 2.0) * FRAC_1_TAU * power * size * wi.z };
        (value, (self.exponent.value() + 1.0) * FRAC_1_TAU * power)
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, value| visit(Case { label, bsdf: Bsdf::Phong(value), lossless: false });
    case("exponent 0", Phong::modified(BLACK, WHITE, 0.0));
    case("exponent 30, Mitsuba's default", Phong::modified(Spectrum::splat(0.5), Spectrum::splat(0.2), 30.0));
    case("exponent 1000, coloured", Phong::modified(GREY, WHITE - GREY, 1000.0));
    case("too much of both", Phong::modified(WHITE, WHITE, 5.0));
    case("diffuse alone", Phong::modified(GREY, BLACK, 10.0));
}

fn empirical_cases(visit: &mut Visitor<'_>) {
    let bsdf = Bsdf::Phong(Phong::empirical(GREY * 0.5, WHITE, 3.0));
    visit(Case { label: "exponent 3", bsdf, lossless: false });
}

fn lafortune_cases(visit: &mut Visitor<'_>) {
    let mut case = |label, coefficients, n| {
        let value = Phong::lafortune(GREY * 0.3, WHITE * 0.6, coefficients, n);
        visit(Case { label, bsdf: Bsdf::Phong(value), lossless: false });
    };
    case("leaning to grazing", Vec3::new(-1.0, -1.0, 0.6), 10.0);
    case("back where it came from", Vec3::ONE, 20.0);
    case("anisotropic", Vec3::new(-0.95, -0.5, 0.9), 15.0);
    case("none", Vec3::ZERO, 15.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scatter, TransportMode};
    use std::f32::consts::TAU;

    fn direction(degrees: f32, phi: f32) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    }

    fn albedo(m: &Phong, degrees: f32) -> f64 {
        let wo = direction(degrees, 0.7);
        steradian_testkit::integrate_sphere(|w| f64::from(m.eval(wo, w, TransportMode::Radiance).value[0]), 1e-4)
    }

    /// `(n+2)/2π` makes the albedo at normal incidence one (M84), and less at others.
    #[test]
    fn the_normalised_lobe_reflects_all_at_normal_incidence() {
        for n in [0.0, 1.0, 10.0, 100.0] {
            let m = Phong::modified(Spectrum::ZERO, Spectrum::ONE, n);
            assert!((albedo(&m, 0.0) - 1.0).abs() < 1e-3, "n = {n}: {}", albedo(&m, 0.0));
            assert!(albedo(&m, 80.0) < 1.0);
        }
    }

    /// The empirical lobe sends `2π/(n+1)` back at normal incidence, and is another one backwards.
    #[test]
    fn the_empirical_lobe_neither_conserves_nor_reciprocates() {
        let m = Phong::empirical(Spectrum::ZERO, Spectrum::ONE, 2.0);
        assert!((albedo(&m, 0.0) - f64::from(TAU) / 3.0).abs() < 2e-3);
        let (a, b) = (direction(20.0, 0.0), direction(60.0, 3.0));
        let f = |wo, wi: Vec3| m.eval(wo, wi, TransportMode::Radiance).value[0] / wi.z;
        assert!((f(a, b) / f(b, a) - a.z / b.z).abs() < 1e-4);
    }

    #[test]
    fn lafortunes_lobe_with_phongs_coefficients_is_phongs() {
        let (a, b) = (direction(30.0, 0.2), direction(40.0, 3.0));
        let phong = Phong::modified(Spectrum::ZERO, Spectrum::ONE, 20.0).eval(a, b, TransportMode::Radiance).value;
        let near = Phong::lafortune(Spectrum::ZERO, Spectrum::ONE, Vec3::new(-1.0, -1.0, 0.999_999), 20.0);
        assert!((near.eval(a, b, TransportMode::Radiance).value[0] - phong[0]).abs() < 1e-3 * phong[0]);
        let retro = Phong::lafortune(Spectrum::ZERO, Spectrum::ONE, Vec3::ONE, 20.0);
        assert!(
            retro.eval(a, a, TransportMode::Radiance).value[0]
                > 10.0 * retro.eval(a, b, TransportMode::Radiance).value[0]
        );
    }
}

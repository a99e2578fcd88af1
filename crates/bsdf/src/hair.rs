//! A fibre of hair or fur, seen from near enough that its width matters (Chiang, Bitterli, Tappan, Burley 2016, "A
//! Practical and Controllable Hair and Fur Model for Production Path Tracing"), as pbrt-v4 and Mitsuba 3 have it.
//!
//! The fibre is a dielectric cylinder along `x`; `θ` is the angle of a direction out of the normal plane, `φ` its angle
//! in that plane, and `h = sin γ_o ∈ [−1, 1]` how far off its axis it is met. Light that is reflected (`p = 0`), that
//! passes through (1), and that is reflected inside (2, and all further orders together) makes the four lobes of
//!
//! ```text
//! f |cosθ_i| = Σ_p M_p(θ_o, θ_i) A_p(θ_o, h) N_p(φ_i − φ_o)
//! M_p = exp(−sinθ_i sinθ_o/v) I₀(cosθ_i cosθ_o/v) / (2v sinh(1/v))          d'Eon et al. 2011, eq. 7
//! A_0 = F,  A_1 = (1 − F)² T,  A_2 = A_1 T F,  A_3 = A_2 T F/(1 − T F),  T = exp(−2 σ_a cosγ_t/cosθ_t)
//! N_p = logistic density of scale s about Φ = 2pγ_t − 2γ_o + pπ, cut to (−π, π);  uniform for p = 3
//! v_0 = (0.726 β_m + 0.812 β_m² + 3.7 β_m²⁰)²,  v_1 = v_0/4,  v_2 = v_3 = 4 v_0
//! s   = √(π/8) (0.265 β_n + 1.194 β_n² + 5.372 β_n²²)
//! ```
//!
//! where the scales of the cuticle tilt `θ_o` by `−2α`, `α`, `4α` for `p = 0, 1, 2` (Chiang et al., section 4.1.2; the
//! tilts are those of the implementations named). σ_a is per radius of the fibre.
//!
//! The model keeps all energy that it does not absorb, but is not reciprocal: `A_p` and the tilts look at `wo` alone.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode, fresnel,
    registry::{Case, Model, Visitor},
    scatter::Scatter,
};
use std::f32::consts::{PI, TAU};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    elementary::{atan2, sin_cos_turns},
};

/// Orders of scattering with a lobe of their own; what is left is the last lobe.
const ORDERS: usize = 3;

/// Absorption (per fibre radius, linear Rec.709) of unit concentration of eumelanin, which is brown to black (d'Eon et
/// al. 2011).
pub const EUMELANIN: [f32; 3] = [0.419, 0.697, 1.37];
/// Absorption (per fibre radius, linear Rec.709) of unit concentration of pheomelanin, which is yellow to red (d'Eon et
/// al. 2011).
pub const PHEOMELANIN: [f32; 3] = [0.187, 0.4, 1.05];

/// A point of a fibre.
#[derive(Clone, Copy, Debug)]
pub struct Hair {
    sigma_a: Spectrum,
    eta: f32,
    /// Longitudinal variance of the first lobe.
    v0: f32,
    /// Azimuthal scale of the logistic lobes, and how much of each lies within half a turn of its middle.
    s: f32,
    within: f32,
    /// Sine and cosine of the tilt of the scales.
    tilt: [f32; 2],
    offset: Offset,
}

/// Offset at which a ray meets a fibre, and the axis of the shading frame along which the fibre lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// `h`, of a fibre along `x` (pbrt: twice the curve's `v`, less one).
    Given(f32),
    /// Fibre along `y` whose surface is really round: `h` is the sine of the angle between normal and `wo` around it
    /// (Mitsuba).
    FromNormal,
}

/// Quantities that depend on `wo` alone.
struct Outgoing {
    sin: f32,
    cos: f32,
    phi: f32,
    gamma_o: f32,
    gamma_t: f32,
    /// `A_p`.
    a: [Spectrum; ORDERS + 1],
    /// The probabilities of choosing each lobe.
    chance: [f32; ORDERS + 1],
}

impl Hair {
    /// A fibre met at `offset`, with absorption `sigma_a` (per radius, at least 0), index of refraction `eta` (clamped
    /// to at least 1), longitudinal and azimuthal roughness `beta_m`, `beta_n` (clamped to `[0.01, 1]` as in pbrt),
    /// scales tilted by `alpha` (degrees, clamped to a right angle).
    pub fn new(offset: Offset, sigma_a: Spectrum, eta: f32, beta_m: f32, beta_n: f32, alpha: f32) -> Self {
        let roughness = |b: f32| if b > 0.01 { b.min(1.0) } else { 0.01 };
        let (m, n) = (roughness(beta_m), roughness(beta_n));
        // Variance of the first lobe from the roughness (Chiang et al. 2016, a fit).
        let sqrt_v0 = 0.726 * m + 0.812 * m * m + 3.7 * m.powi(20);
        // Scale of the logistic distribution from the azimuthal roughness, a fit likewise.
        let s = (PI / 8.0).sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22));
        let alpha = if alpha.is_finite() { alpha.clamp(-90.0, 90.0) } else { 0.0 };
        let offset = match offset {
            Offset::Given(h) if h.abs() <= 1.0 => Offset::Given(h),
            Offset::Given(h) => Offset::Given(if h.is_nan() { 0.0 } else { h.signum() }),
            Offset::FromNormal => Offset::FromNormal,
        };
        Self {
            sigma_a: sigma_a.map(|s| if s > 0.0 { s.min(1e8) } else { 0.0 }),
            eta: if eta > 1.0 { eta.min(100.0) } else { 1.0 },
            v0: sqrt_v0 * sqrt_v0,
            s,
            // Normalise the logistic to (−π, π), outside of which it is cut off.
            within: logistic_cdf(PI, s) - logistic_cdf(-PI, s),
            tilt: alpha.to_radians().sin_cos().into(),
            offset,
        }
    }

    /// The absorption that gives a mass of hair the colour `albedo` by multiple scattering (Chiang et al. 2016, eq. 9,
    /// a fit).
    pub fn sigma_a_of_color(albedo: Spectrum, beta_n: f32) -> Spectrum {
        let n = if beta_n > 0.01 { beta_n.min(1.0) } else { 0.01 };
        // Horner's rule for the polynomial of the fit; σ_a = (ln albedo/fit)².
        let fit = [0.245, 5.574, -10.73, 2.532, -0.215, 5.969].into_iter().fold(0.0, |sum, c| sum * n + c);
        albedo.map(|c| (c.clamp(1e-6, 1.0).ln() / fit).powi(2))
    }

    /// The direction in the frame whose `x` is the fibre.
    #[inline]
    fn along_fibre(&self, w: Vec3) -> Vec3 {
        if self.offset == Offset::FromNormal { Vec3::new(w.y, -w.x, w.z) } else { w }
    }

    #[inline]
    fn outgoing(&self, wo: Vec3) -> Outgoing {
        // Angle out of the normal plane, and the offset h at which the fibre is met.
        let cos = (wo.y * wo.y + wo.z * wo.z).sqrt();
        let h = match self.offset {
            Offset::Given(h) => h,
            Offset::FromNormal if cos > 0.0 => -wo.y / cos,
            Offset::FromNormal => 0.0,
        };
        let sin_t = wo.x / self.eta;
        // The plane across the fibre sees a larger index (Marschner et al. 2003, Bravais' index). The smallest number
        // keeps 0/0 out.
        let across = (self.eta * self.eta - wo.x * wo.x).max(0.0).sqrt().max(f32::MIN_POSITIVE);
        let sin_gamma_t = (h * cos / across).clamp(-1.0, 1.0);
        // Length of the chord through the cylinder in radii: 2 cos γ_t/cos θ_t.
        let path = 2.0 * safe_cos(sin_gamma_t) / safe_cos(sin_t).max(1e-6);
        let t = (self.sigma_a * -path).exp();
        // Fresnel reflectance by cos θ_o cos γ_o, the cosine with the normal of the cylinder.
        let f = fresnel::dielectric(cos * safe_cos(h), self.eta);
        // Attenuations A_1 to A_3: two crossings, one inner reflection more, and the geometric series of the rest.
        let once = t * ((1.0 - f) * (1.0 - f));
        let twice = once * t * f;
        let rest = twice * t.map(|t| f * t / (1.0 - f * t).max(1e-10));
        let a = [Spectrum::splat(f), once, twice, rest];
        // Choose lobes in proportion to their mean attenuation.
        let mut chance = a.map(Spectrum::mean);
        let sum: f32 = chance.iter().sum();
        if sum > 0.0 {
            chance = chance.map(|c| c / sum);
        }
        Outgoing { sin: wo.x, cos, phi: atan2(wo.z, wo.y), gamma_o: h.asin(), gamma_t: sin_gamma_t.asin(), a, chance }
    }

    /// Longitudinal variance of a lobe.
    #[inline]
    fn variance(&self, p: usize) -> f32 {
        self.v0 * [1.0, 0.25, 4.0, 4.0][p]
    }

    /// Sine and cosine of `θ_o` as a lobe sees it over the tilted scales.
    #[inline]
    fn tilted(&self, o: &Outgoing, p: usize) -> (f32, f32) {
        // Tilts by multiples of α, by the formulae for double angles.
        let double = |(s, c): (f32, f32)| (2.0 * s * c, c * c - s * s);
        let alpha = (self.tilt[0], self.tilt[1]);
        let (s, c) = match p {
            0 => double((-alpha.0, alpha.1)),
            1 => alpha,
            2 => double(double(alpha)),
            _ => (0.0, 1.0),
        };
        (o.sin * c + o.cos * s, (o.cos * c - o.sin * s).abs())
    }

    /// `M_p N_p` of each lobe.
    #[inline]
    fn lobes(&self, o: &Outgoing, wi: Vec3) -> [f32; ORDERS + 1] {
        let (sin_i, cos_i) = (wi.x, (wi.y * wi.y + wi.z * wi.z).sqrt());
        // Azimuth relative to wo, against the deflection of each order by a smooth fibre.
        let turn = atan2(wi.z, wi.y) - o.phi;
        std::array::from_fn(|p| {
            let (sin_o, cos_o) = self.tilted(o, p);
            let n =
                if p < ORDERS { logistic(wrap(turn - specular_turn(p, o)), self.s) / self.within } else { 1.0 / TAU };
            longitudinal(sin_i, cos_i, sin_o, cos_o, self.variance(p)) * n
        })
    }

    fn eval_at(&self, o: &Outgoing, wi: Vec3) -> BsdfEval {
        let lobes = self.lobes(o, wi);
        let mut e = BsdfEval::ZERO;
        // f·|cos θ_i| = Σ A_p M_p N_p; the density has the chances of the lobes in place of A_p.
        for ((lobe, a), chance) in lobes.into_iter().zip(o.a).zip(o.chance) {
            e.value += a * lobe;
            e.pdf += chance * lobe;
        }
        e
    }
}

impl Scatter for Hair {
    const MODELS: &'static [Model] = &[Model::new("hair", "a fibre of hair or fur", cases).not_reciprocal()];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        self.eval_at(&self.outgoing(self.along_fibre(wo)), self.along_fibre(wi))
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        let o = self.outgoing(self.along_fibre(wo));
        // The lobe; what is left of the number turns the direction about the cone of `θ_o`.
        let (mut p, mut u) = (0, u);
        while p < ORDERS && u >= o.chance[p] {
            u -= o.chance[p];
            p += 1;
        }
        if o.chance[p] <= 0.0 {
            return None;
        }
        let u = (u / o.chance[p]).clamp(0.0, 1.0);
        // d'Eon et al. 2013, "Importance sampling for physically-based hair fiber models", eq. 6 and 7.
        let (sin_o, cos_o) = self.tilted(&o, p);
        let v = self.variance(p);
        let cos = (1.0 + v * ((u2.x + (1.0 - u2.x) * (-2.0 / v).exp()).max(1e-30)).ln()).clamp(-1.0, 1.0);
        let sin_i = (-cos * sin_o + safe_cos(cos) * sin_cos_turns(u).1 * cos_o).clamp(-1.0, 1.0);
        let cos_i = safe_cos(sin_i);
        // Azimuth: the deflection of a smooth fibre, spread by the cut logistic; uniform for the last lobe.
        let turn = if p < ORDERS { specular_turn(p, &o) + sample_trimmed_logistic(u2.y, self.s) } else { TAU * u2.y };
        let (sin_phi, cos_phi) = sin_cos_turns((o.phi + turn) / TAU);
        let local = Vec3::new(sin_i, cos_i * cos_phi, cos_i * sin_phi);
        let e = self.eval_at(&o, local);
        let wi = if self.offset == Offset::FromNormal { Vec3::new(-local.y, local.x, local.z) } else { local };
        let side = if wo.z * wi.z < 0.0 { Lobe::TRANSMISSION } else { Lobe::REFLECTION };
        e.drawn(wi, side.with(Lobe::GLOSSY), 1.0)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let o = self.outgoing(self.along_fibre(wo));
        (o.a[0] + o.a[1] + o.a[2] + o.a[3]).clamp(0.0, 1.0)
    }

    #[inline]
    fn transmits(&self) -> bool {
        true
    }

    #[inline]
    fn is_reciprocal(&self) -> bool {
        false
    }
}

/// `√(1 − x²)`.
#[inline]
fn safe_cos(x: f32) -> f32 {
    (1.0 - x * x).max(0.0).sqrt()
}

/// By how much a smooth fibre turns light of order `p` around itself.
#[inline]
fn specular_turn(p: usize, o: &Outgoing) -> f32 {
    let p = p as f32;
    2.0 * p * o.gamma_t - 2.0 * o.gamma_o + p * PI
}

/// An angle brought to `[−π, π]`.
#[inline]
fn wrap(x: f32) -> f32 {
    x - TAU * (x / TAU).round()
}

/// `M_p`: a von Mises–Fisher lobe seen in `θ`, of unit integral with `cosθ_i dθ_i`. The exponentials of `I₀` and of
/// `2 sinh(1/v) = e^(1/v) (1 − e^(−2/v))` are taken together, which neither overflows nor loses digits.
#[inline]
fn longitudinal(sin_i: f32, cos_i: f32, sin_o: f32, cos_o: f32, v: f32) -> f32 {
    let (power, factor) = bessel_i0(cos_i * cos_o / v);
    factor * (power - (sin_i * sin_o + 1.0) / v).exp() / (v * (1.0 - (-2.0 / v).exp()))
}

/// `I₀(x) = factor · e^power` for `x ≥ 0`, within 3·10⁻⁷ (Abramowitz & Stegun 1964, 9.8.1 and 9.8.2).
#[inline]
fn bessel_i0(x: f32) -> (f32, f32) {
    if x < 3.75 {
        let t = (x / 3.75) * (x / 3.75);
        let c = [0.004_581_3, 0.036_076_8, 0.265_973_2, 1.206_749_2, 3.089_942_4, 3.515_622_9, 1.0];
        return (0.0, c.into_iter().fold(0.0, |sum: f32, c| sum * t + c));
    }
    let t = 3.75 / x;
    let c = [
        0.003_923_77,
        -0.016_476_33,
        0.026_355_37,
        -0.020_577_06,
        0.009_162_81,
        -0.001_575_65,
        0.002_253_19,
        0.013_285_92,
        0.398_942_3,
    ];
    (x, c.into_iter().fold(0.0, |sum: f32, c| sum * t + c) / x.sqrt())
}

/// The logistic distribution function at `x`.
#[inline]
fn logistic_cdf(x: f32, s: f32) -> f32 {
    1.0 / (1.0 + (-x / s).exp())
}

/// The logistic density of scale `s`.
#[inline]
fn logistic(x: f32, s: f32) -> f32 {
    let e = (-x.abs() / s).exp();
    e / (s * (1.0 + e) * (1.0 + e))
}

#[inline]
fn sample_trimmed_logistic(u: f32, s: f32) -> f32 {
    // Invert the distribution function between its values at −π and π.
    let low = logistic_cdf(-PI, s);
    let c = low + u * (logistic_cdf(PI, s) - low);
    let x = -s * (1.0 / c - 1.0).ln();
    if x.is_nan() { 0.0 } else { x.clamp(-PI, PI) }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, h, sigma_a, eta, beta_m, beta_n, alpha, lossless| {
        let bsdf = Bsdf::Hair(Hair::new(h, sigma_a, eta, beta_m, beta_n, alpha));
        visit(Case { label, bsdf, lossless });
    };
    use Offset::{FromNormal, Given};
    let brown = Spectrum::new([0.54, 0.91, 1.78, 1.0]);
    case("brown", Given(0.3), brown, 1.55, 0.3, 0.3, 2.0, false);
    case("white", Given(-0.6), Spectrum::ZERO, 1.55, 0.3, 0.3, 2.0, true);
    case("white, rough", Given(0.9), Spectrum::ZERO, 1.55, 1.0, 1.0, 0.0, true);
    case("white, on the axis", Given(0.0), Spectrum::ZERO, 1.3, 0.5, 0.2, 0.0, true);
    case("smooth", Given(0.5), brown * 0.2, 1.55, 0.1, 0.15, 3.0, false);
    case("at the edge", Given(1.0), brown, 1.55, 0.3, 0.3, 2.0, false);
    case("index 1", Given(0.4), Spectrum::ZERO, 1.0, 0.4, 0.4, 0.0, true);
    case("round surface", FromNormal, brown, 1.55, 0.25, 0.3, 2.0, false);
    case("round and white", FromNormal, Spectrum::ZERO, 1.55, 0.4, 0.5, 2.0, true);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bessel_function_has_its_tabulated_values() {
        // By the series Σ (x/2)²ᵏ/k!² in double precision.
        for (x, i0) in [(0.0, 1.0), (1.0, 1.266_066), (3.7, 8.738_618), (5.0, 27.239_872), (12.0, 18_948.926)] {
            let (power, factor) = bessel_i0(x);
            let found = factor * power.exp();
            assert!((found / i0 - 1.0).abs() < 2e-5, "I0({x}) = {found}, not {i0}");
        }
    }

    #[test]
    fn absorption_of_a_color_gives_white_none() {
        let s = Hair::sigma_a_of_color(Spectrum::new([1.0, 0.5, 0.1, 0.0]), 0.3);
        assert_eq!(s[0], 0.0);
        // (ln 0.5/(5.969 − 0.0645 + 0.22788 − 0.28971 + 0.04515 + 0.0006))² by hand.
        assert!((s[1] - 0.013_848).abs() < 2e-5, "{s:?}");
        assert!(s[2] > s[1] && s[3].is_finite());
    }

    #[test]
    fn a_fibre_that_is_really_round_is_met_where_its_normal_says() {
        // The normal plane of a fibre along y; wo at 30° from the normal, on either side: h = ±1/2, mirrored pictures
        // of one another.
        let sigma = Spectrum::splat(0.3);
        let round = Hair::new(Offset::FromNormal, sigma, 1.55, 0.3, 0.3, 0.0);
        for (x, h) in [(0.5, 0.5), (-0.5, -0.5)] {
            let wo = Vec3::new(x, 0.0, 0.75f32.sqrt());
            let given = Hair::new(Offset::Given(h), sigma, 1.55, 0.3, 0.3, 0.0);
            for wi in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.6, -0.64), Vec3::new(0.0, 0.8, 0.6)] {
                let turned = |w: Vec3| Vec3::new(w.y, -w.x, w.z);
                let (a, b) = (
                    round.eval(wo, wi, TransportMode::Radiance),
                    given.eval(turned(wo), turned(wi), TransportMode::Radiance),
                );
                assert!((a.pdf - b.pdf).abs() < 1e-5 * b.pdf, "{a:?} {b:?}");
            }
            // Reflection by the normal is where the first lobe has its middle: more light goes there than a little
            // beside.
            let mirrored = Vec3::new(-x, 0.0, wo.z);
            let black = Hair::new(Offset::FromNormal, Spectrum::splat(1e3), 1.55, 0.1, 0.1, 0.0);
            let beside = [Vec3::new(x, 0.0, wo.z), Vec3::new(0.0, 0.0, 1.0), Vec3::new(-x, 0.3, wo.z).normalize()];
            for w in beside {
                assert!(
                    black.eval(wo, mirrored, TransportMode::Radiance).value[0]
                        > black.eval(wo, w, TransportMode::Radiance).value[0]
                );
            }
        }
    }
}

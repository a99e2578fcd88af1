//! Distributions of microfacet normals: the density `D(m)` over the hemisphere and how to draw from it.
//!
//! All are normalised by `∫ D(m) cosθ_m dm = 1`. With the stretched slopes `s = tan²θ_m (cos²φ/α_x² + sin²φ/α_y²)`:
//!
//! ```text
//! GGX          D = 1 / (π α_x α_y cos⁴θ_m (1 + s)²)                        Trowbridge & Reitz 1975; Walter et al. 2007
//! Beckmann     D = exp(−s) / (π α_x α_y cos⁴θ_m)                           Beckmann & Spizzichino 1963
//! Student's t  D = 1 / (π α_x α_y cos⁴θ_m (1 + s/(γ−1))^γ)                 Ribardière et al. 2017: γ = 2 is GGX, γ → ∞ Beckmann
//! Blinn        D = √((n_x+2)(n_y+2))/2π · cos^n θ_m,  n = n_x cos²φ + n_y sin²φ     Blinn 1977; Ashikhmin & Shirley 2000
//! Gaussian     D = N(α) exp(−(θ_m/α)²)                                     Torrance & Sparrow 1967; N numerically
//! ```
//!
//! Blinn's exponents follow from `n = 2/α² − 2` (not below 0), which makes the lobe as wide as Beckmann's of that α
//! (Walter et al. 2007, 5.1; Mitsuba 0.6's `phong`). The Gaussian knows no directions: it takes `α = √(α_x α_y)`.

use std::{
    f32::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU},
    sync::LazyLock,
};
use steradian_math::{
    Vec2, Vec3,
    elementary::{atan2, exp, exp_m1, ln, ln_1p, sin_cos, sin_cos_turns},
};

/// The shape of the distribution of facet normals.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum NormalDistribution {
    /// Trowbridge–Reitz, known as GGX: long tails.
    Ggx,
    /// Beckmann: Gaussian slopes.
    Beckmann,
    /// Slopes by Student's t-distribution, with a tail between GGX's and Beckmann's, or longer.
    StudentT(Tail),
    /// A power of the cosine.
    Blinn,
    /// Gaussian in the angle.
    Gaussian,
}

/// The tail parameter γ of [`NormalDistribution::StudentT`], in one byte: `γ − 1` in steps of 1/32 octave.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Tail(u8);

/// The step at γ = 2.
const GGX_STEP: f32 = 20.0;

impl Tail {
    /// Smallest γ: below 1.5 the mean slope has no bound and no surface is like that.
    pub const MIN: f32 = 1.65;
    /// Largest γ, where the distribution is Beckmann's within a per cent.
    pub const MAX: f32 = 100.0;

    /// From γ, held in `[1.65, 100]`; NaN counts as 2.
    pub fn new(gamma: f32) -> Self {
        let gamma = if gamma.is_nan() { 2.0 } else { gamma.clamp(Self::MIN, Self::MAX) };
        Self((32.0 * (gamma - 1.0).log2() + GGX_STEP).round() as u8)
    }

    /// γ.
    #[inline]
    pub fn gamma(self) -> f32 {
        1.0 + ((f32::from(self.0) - GGX_STEP) / 32.0).exp2()
    }
}

/// Blinn's exponent for a roughness.
#[inline]
fn exponent(alpha: f32) -> f32 {
    (2.0 / (alpha * alpha) - 2.0).max(0.0)
}

/// Both exponents for the roughness along the axes.
#[inline]
fn exponents(alpha: Vec2) -> (f32, f32) {
    (exponent(alpha.x), exponent(alpha.y))
}

impl NormalDistribution {
    /// `D(m)` for `m` in the upper hemisphere and roughness `alpha` along the two tangents (sr⁻¹).
    #[inline]
    pub(super) fn density(self, alpha: Vec2, m: Vec3) -> f32 {
        if self == Self::Ggx {
            let root = ggx_root(alpha, m, 1.0);
            return FRAC_1_PI * alpha.x * alpha.y * (root * root);
        }
        let (x, y, area, cos2) = (m.x * alpha.y, m.y * alpha.x, alpha.x * alpha.y, m.z * m.z);
        let slopes = (x * x + y * y) / (area * area);
        if self == Self::Beckmann {
            return if cos2 < 1e-10 { 0.0 } else { beckmann_density(alpha, exp(-slopes / cos2), cos2) };
        }
        self.density_of_others(alpha, m, slopes, cos2)
    }

    #[inline(never)]
    fn density_of_others(self, alpha: Vec2, m: Vec3, slopes: f32, cos2: f32) -> f32 {
        match self {
            Self::StudentT(tail) => {
                if cos2 < 1e-10 {
                    return 0.0;
                }
                let gamma = tail.gamma();
                let log_power = -gamma * ln_1p(slopes / (cos2 * (gamma - 1.0)));
                exp(log_power) / (PI * alpha.x * alpha.y * cos2 * cos2)
            }
            Self::Blinn => {
                let (nx, ny) = exponents(alpha);
                let sin2 = m.x * m.x + m.y * m.y;
                if cos2 < 1e-10 {
                    return if nx.max(ny) == 0.0 { 1.0 / PI } else { 0.0 };
                }
                let n = if sin2 > 0.0 { (nx * m.x * m.x + ny * m.y * m.y) / sin2 } else { 0.0 };
                // ln cosθ by the tangent: the cosine itself is too coarse for narrow lobes.
                let log_cos = -0.5 * ln_1p(sin2 / cos2);
                ((nx + 2.0) * (ny + 2.0)).sqrt() / TAU * exp(n * log_cos)
            }
            _ => {
                let alpha = (alpha.x * alpha.y).sqrt();
                let x = angle(m) / alpha;
                gaussian_normalisation(alpha) * exp(-x * x)
            }
        }
    }

    /// Draws a normal with the density [`NormalDistribution::sampled_density`]: `m_x/m_z` and `m_y/m_z`, which may be
    /// infinite.
    #[inline]
    pub(super) fn sample(self, alpha: Vec2, u: Vec2) -> Vec2 {
        let (sin_phi, cos_phi) = sin_cos_turns(u.x);
        let tail = 1.0 - u.y;
        let tan2 = match self {
            Self::Ggx => u.y / tail,
            Self::Beckmann => -ln(tail),
            Self::StudentT(t) => {
                let k = t.gamma() - 1.0;
                k * exp_m1(-ln(tail) / k)
            }
            Self::Blinn => {
                // The azimuth has a density in proportion to 1/(n(φ) + 2).
                let (nx, ny) = exponents(alpha);
                let d = Vec2::new((ny + 2.0).sqrt() * cos_phi, (nx + 2.0).sqrt() * sin_phi).normalize_or(Vec2::X);
                let n = nx * d.x * d.x + ny * d.y * d.y;
                let tan = exp_m1(-2.0 * ln(tail) / (n + 2.0)).max(0.0).sqrt();
                return tan * d;
            }
            Self::Gaussian => {
                let alpha = (alpha.x * alpha.y).sqrt();
                let theta = alpha * (-ln_1p(-u.y * gaussian_range(alpha))).max(0.0).sqrt();
                let (sin, cos) = sin_cos(theta.min(FRAC_PI_2));
                return sin / cos.max(1e-6) * Vec2::new(cos_phi, sin_phi);
            }
        };
        let r = tan2.max(0.0).sqrt();
        alpha * r * Vec2::new(cos_phi, sin_phi)
    }

    /// The density with which [`NormalDistribution::sample`] draws `m`: `D(m) cosθ_m`, but for the Gaussian, of which
    /// `θ exp(−(θ/α)²)` is what can be inverted (sr⁻¹). By `D(m)`, which is `d`.
    #[inline]
    pub(super) fn sampled_density(self, alpha: Vec2, m: Vec3, d: f32) -> f32 {
        if self != Self::Gaussian {
            return d * m.z;
        }
        let alpha = (alpha.x * alpha.y).sqrt();
        let (sin, theta) = ((m.x * m.x + m.y * m.y).sqrt(), angle(m));
        let theta_over_sin = if sin > 1e-6 { theta / sin } else { 1.0 };
        let x = theta / alpha;
        theta_over_sin * exp(-x * x) / (PI * alpha * alpha * gaussian_range(alpha))
    }
}

/// `D` of Beckmann by `exp(−s)` and the square of the cosine.
#[inline]
pub(super) fn beckmann_density(alpha: Vec2, exponential: f32, cos2: f32) -> f32 {
    exponential / (PI * alpha.x * alpha.y * (cos2 * cos2))
}

/// `√(π D/(α_x α_y))` of GGX for a normal of any length, whose square is given. Both sides of the fraction are taken
/// times `(α_x α_y)²`, which spares divisions.
#[inline(always)]
pub(super) fn ggx_root(alpha: Vec2, m: Vec3, length2: f32) -> f32 {
    let area = alpha.x * alpha.y;
    let (x, y, z) = (m.x * alpha.y, m.y * alpha.x, m.z * area);
    area * length2 / (x * x + y * y + z * z)
}

/// The angle between `m` and the z axis.
#[inline]
fn angle(m: Vec3) -> f32 {
    atan2((m.x * m.x + m.y * m.y).sqrt(), m.z)
}

/// `1 − exp(−(π/2α)²)`: the part of a Gaussian in the plane that lies inside the hemisphere's range of angles.
#[inline]
fn gaussian_range(alpha: f32) -> f32 {
    let x = FRAC_PI_2 / alpha;
    -exp_m1(-x * x)
}

/// `N(α)` with `1/N = 2π ∫ exp(−(θ/α)²) sinθ cosθ dθ`, from a table over `α/(1 + α)` of `N·π α²`, which tends to one
/// for small α and grows with its square.
#[inline]
fn gaussian_normalisation(alpha: f32) -> f32 {
    static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| {
        (0..=GAUSSIAN_STEPS)
            .map(|i| {
                let t = f64::from(i) / f64::from(GAUSSIAN_STEPS);
                let alpha = t / (1.0 - t).max(1e-3);
                (gaussian_integral(alpha.max(1e-6)) * (1.0 + alpha * alpha) / (alpha * alpha).max(1e-12)) as f32
            })
            .collect()
    });
    let t = (alpha / (1.0 + alpha)).clamp(0.0, 1.0) * GAUSSIAN_STEPS as f32;
    let i = (t as usize).min(GAUSSIAN_STEPS as usize - 1);
    let integral = TABLE[i] + (TABLE[i + 1] - TABLE[i]) * (t - i as f32);
    (1.0 + alpha * alpha) / (PI * alpha * alpha * integral)
}

const GAUSSIAN_STEPS: u32 = 512;

/// `2 ∫₀^{π/2} exp(−(θ/α)²) sinθ cosθ dθ` by the midpoint rule over the part that matters.
fn gaussian_integral(alpha: f64) -> f64 {
    const N: u32 = 2000;
    let end = std::f64::consts::FRAC_PI_2.min(7.0 * alpha);
    let step = end / f64::from(N);
    let f = |theta: f64| (-(theta / alpha).powi(2)).exp() * (2.0 * theta).sin();
    (0..N).map(|i| f((f64::from(i) + 0.5) * step)).sum::<f64>() * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use NormalDistribution::{Beckmann, Blinn, Gaussian, Ggx, StudentT};

    fn all() -> Vec<NormalDistribution> {
        vec![Ggx, Beckmann, Blinn, Gaussian, StudentT(Tail::new(1.7)), StudentT(Tail::new(3.0))]
    }

    /// `∫ g(m) dm` over the hemisphere, in the tangent over α so that narrow lobes are resolved.
    fn integrate(alpha: f32, g: impl Fn(Vec3) -> f32) -> f64 {
        let (n, sectors) = (4000, 32);
        let mut sum = 0.0f64;
        for i in 0..n {
            // tanθ = α v/(1 − v), so that 0..1 covers all angles.
            let v = (i as f64 + 0.5) / n as f64;
            let t = f64::from(alpha) * v / (1.0 - v);
            let dt = f64::from(alpha) / (1.0 - v).powi(2) / n as f64;
            let (cos2, theta_dt) = (1.0 / (1.0 + t * t), 1.0 / (1.0 + t * t));
            let (sin, cos) = (t * cos2.sqrt(), cos2.sqrt());
            for j in 0..sectors {
                let phi = std::f64::consts::TAU * (j as f64 + 0.5) / sectors as f64;
                let m = Vec3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, cos as f32);
                sum += f64::from(g(m)) * sin * theta_dt * dt * std::f64::consts::TAU / sectors as f64;
            }
        }
        sum
    }

    #[test]
    fn projected_facets_cover_the_surface_once() {
        for d in all() {
            for alpha in [1e-3f32, 0.05, 0.3, 0.6, 1.0, 3.0] {
                let a = Vec2::splat(alpha);
                let area = integrate(alpha, |m| d.density(a, m) * m.z);
                assert!((area - 1.0).abs() < 1e-3, "{d:?}, α = {alpha}: {area}");
                let drawn = integrate(alpha, |m| d.sampled_density(a, m, d.density(a, m)));
                assert!((drawn - 1.0).abs() < 1e-3, "{d:?}, α = {alpha}: ∫pdf = {drawn}");
            }
            let a = Vec2::new(0.2, 0.5);
            let area = integrate(0.4, |m| d.density(a, m) * m.z);
            assert!((area - 1.0).abs() < 2e-3, "{d:?}, anisotropic: {area}");
        }
    }

    /// The lectures' forms without normalisation (E5) cover the surface less or more than once.
    #[test]
    fn the_unnormalised_forms_do_not() {
        let gaussian = |m: f32| integrate(m, |n| (-(angle(n) / m).powi(2)).exp() * n.z);
        let blinn = |m: f32| {
            let power = std::f32::consts::LN_2.copysign(-1.0) / m.cos().ln();
            integrate(m, |n| n.z.powf(power) * n.z)
        };
        for (value, printed) in
            [(blinn(0.3), 0.366), (gaussian(0.3), 0.266), (blinn(0.6), 1.12), (gaussian(0.6), 0.895)]
        {
            assert!((value - printed).abs() < 6e-3, "{value} is not {printed}");
        }
    }

    #[test]
    fn the_tail_runs_from_ggx_to_beckmann() {
        let a = Vec2::new(0.3, 0.4);
        for m in [Vec3::Z, Vec3::new(0.3, 0.1, 0.9).normalize(), Vec3::new(0.5, -0.8, 0.4).normalize()] {
            let (t, g) = (StudentT(Tail::new(2.0)).density(a, m), Ggx.density(a, m));
            assert!((t - g).abs() < 1e-4 * g, "{t} is not {g}");
        }
        let m = Vec3::new(0.2, 0.1, 0.97).normalize();
        let (t, b) = (StudentT(Tail::new(100.0)).density(a, m), Beckmann.density(a, m));
        assert!((t - b).abs() < 0.02 * b, "{t} is not {b}");
        assert_eq!(Tail::new(f32::NAN).gamma(), 2.0);
        assert!((Tail::new(-3.0).gamma() - 1.65).abs() < 0.01 && Tail::new(f32::INFINITY).gamma() > 98.0);
    }
}

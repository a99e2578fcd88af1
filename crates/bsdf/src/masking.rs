//! Masking and shadowing of microfacets: which part of them a direction sees.
//!
//! **Smith** (1967; Heitz 2014): `G₁ = 1/(1 + Λ)`, the heights of facets independent of their normals; `cosθ(1 + Λ)` is
//! the area that is seen, which stays finite towards grazing. With `a = cotθ/α(φ)`:
//!
//! ```text
//! GGX          Λ = (√(1 + a⁻²) − 1)/2
//! Beckmann     Λ = exp(−a²)/(2a√π) − erfc(a)/2
//! Student's t  Λ = c (γ−1+a²)^(3/2−γ) / ((2γ−3) a) − ½ I_z(γ−1, ½),
//!              c = (γ−1)^γ Γ(γ−½) / (√π Γ(γ)),  z = (γ−1)/(γ−1+a²)
//! others       Λ from tables: the facets' area projected along the direction, over the surface's, less one
//! ```
//!
//! (Ribardière et al. 2017 give the third by a hypergeometric function; `I` is the regularised incomplete beta
//! function.) Blinn's lobe of two exponents uses the table of the roughness along the direction, which is approximate.
//!
//! **V-groove** (Torrance & Sparrow 1967; Heitz 2014, 3): every facet faces its mirror image across a groove,
//! `G₁(w, m) = min(1, 2 cosθ_m cosθ_w / (w·m))`.

use super::{NormalDistribution, gaussian::erfc_scaled};
use std::{f32::consts::PI, sync::LazyLock};
use steradian_math::{Vec2, Vec3, elementary::exp};

/// Combination of masking and shadowing into `G₂`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Shadowing {
    /// `1/(1 + Λ(wo) + Λ(wi))`: high facets are both visible and lit (Heitz 2014, eq. 99); pbrt-v4's choice.
    HeightCorrelated,
    /// `G₁(wo)·G₁(wi)` (Walter et al. 2007, eq. 23); Mitsuba's choice.
    Separable,
    /// The grooves of Torrance and Sparrow: `min(G₁(wo), G₁(wi))`, and `max(0, G₁(wo) + G₁(wi) − 1)` for transmission.
    VGroove,
}

/// The part of the facets of normal `m` that `w` sees in V-grooves.
#[inline]
pub(super) fn v_groove(w: Vec3, m: Vec3) -> f32 {
    let projected = w.dot(m).abs();
    if projected <= 0.0 { 1.0 } else { (2.0 * m.z * w.z.abs() / projected).min(1.0) }
}

/// The facets' area that `w` sees, projected on it, per area of the surface: `|cosθ| (1 + Λ)`.
#[inline]
pub(super) fn projected_area(distribution: NormalDistribution, alpha: Vec2, w: Vec3) -> f32 {
    let (x, y) = (alpha.x * w.x, alpha.y * w.y);
    let (tilted2, cos) = (x * x + y * y, w.z.abs());
    match distribution {
        NormalDistribution::Ggx => 0.5 * (cos + (tilted2 + cos * cos).sqrt()),
        NormalDistribution::Beckmann => beckmann_area(tilted2.sqrt(), cos),
        _ => area_by_slopes(distribution, alpha, w, tilted2),
    }
}

/// Beckmann's, where `tilted = α(φ) sinθ`.
fn beckmann_area(tilted: f32, cos: f32) -> f32 {
    // Beyond a = 4 less than 10⁻⁸ is masked, and the two terms cancel.
    if cos > 4.0 * tilted {
        return cos;
    }
    let a = cos / tilted;
    cos + tilted * (exp(-a * a) * (0.5 / PI.sqrt() - 0.5 * a * erfc_scaled(a))).max(0.0)
}

#[inline(never)]
fn area_by_slopes(distribution: NormalDistribution, alpha: Vec2, w: Vec3, tilted2: f32) -> f32 {
    let (sin2, cos2) = (w.x * w.x + w.y * w.y, w.z * w.z);
    let (table, along) = match distribution {
        NormalDistribution::StudentT(tail) => {
            return w.z.abs() * (1.0 + student_lambda(tail.gamma(), tilted2 / cos2));
        }
        NormalDistribution::Blinn => (&*BLINN, (tilted2 / sin2).sqrt()),
        _ => (&*GAUSSIAN, (alpha.x * alpha.y).sqrt()),
    };
    if sin2 <= 1e-12 || cos2 == 0.0 {
        return w.z.abs();
    }
    let a = (cos2 / sin2).sqrt() / along;
    w.z.abs() * (1.0 + table.eval(a, along) / a)
}

fn student_lambda(gamma: f32, inv_a2: f32) -> f32 {
    if inv_a2 < 1e-6 {
        return 0.0;
    }
    let (k, a2) = (gamma - 1.0, 1.0 / inv_a2);
    let log_c = gamma * k.ln() - 0.5 * PI.ln() + ln_gamma(gamma - 0.5) - ln_gamma(gamma);
    let log_power = (1.5 - gamma) * (k + a2).ln();
    let visible = (log_c + log_power).exp() / ((2.0 * gamma - 3.0) * a2.sqrt());
    (visible - 0.5 * incomplete_beta(k, 0.5, k / (k + a2))).max(0.0)
}

/// `ln Γ(x)` for `x > 0` (Lanczos 1964, with the six coefficients of Press et al. 1992, 6.1).
fn ln_gamma(x: f32) -> f32 {
    const C: [f64; 6] = [
        76.180_091_729_471_46,
        -86.505_320_329_416_77,
        24.014_098_240_830_91,
        -1.231_739_572_450_155,
        0.120_865_097_386_617_9e-2,
        -0.539_523_938_495_3e-5,
    ];
    let x = f64::from(x);
    let t = x + 5.5;
    let series = C.iter().enumerate().fold(1.000_000_000_190_015, |s, (i, c)| s + c / (x + 1.0 + i as f64));
    ((x + 0.5) * t.ln() - t + (2.506_628_274_631_000_5 * series / x).ln()) as f32
}

/// The regularised incomplete beta function `I_x(a, b)` by its continued fraction (DLMF 8.17.22, evaluated by Lentz's
/// method).
fn incomplete_beta(a: f32, b: f32, x: f32) -> f32 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p()).exp() / a;
    let tiny = |v: f32| if v.abs() < 1e-30 { 1e-30 } else { v };
    let (mut c, mut d) = (1.0f32, 1.0 / tiny(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in 1..200 {
        let m = m as f32;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / tiny(1.0 + even * d);
        c = tiny(1.0 + even / c);
        fraction *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / tiny(1.0 + odd * d);
        c = tiny(1.0 + odd / c);
        let step = d * c;
        fraction *= step;
        if (step - 1.0).abs() < 1e-7 {
            break;
        }
    }
    front * fraction
}

/// `a·Λ` over `a/(1 + a)` and `α/(1 + α)`: finite towards grazing, where Λ is not.
struct Table(Vec<f32>);

const COTANGENTS: usize = 65;
const ALPHAS: usize = 49;

static BLINN: LazyLock<Table> = LazyLock::new(|| Table::new(NormalDistribution::Blinn));
static GAUSSIAN: LazyLock<Table> = LazyLock::new(|| Table::new(NormalDistribution::Gaussian));

impl Table {
    fn new(distribution: NormalDistribution) -> Self {
        // The last rows stand for the largest roughness there is, the last columns for straight above.
        let from_unit = |i: usize, n: usize, max: f64| {
            let t = i as f64 / (n - 1) as f64;
            if i + 1 == n { max } else { (t / (1.0 - t)).min(max) }
        };
        let values = (0..ALPHAS).flat_map(|j| {
            let alpha = from_unit(j, ALPHAS, 40.0).max(1e-4);
            (0..COTANGENTS).map(move |i| projected_excess(distribution, from_unit(i, COTANGENTS, 1e3), alpha) as f32)
        });
        Self(values.collect())
    }

    fn eval(&self, a: f32, alpha: f32) -> f32 {
        let place = |v: f32, n: usize| {
            let x = (v / (1.0 + v)).clamp(0.0, 1.0) * (n - 1) as f32;
            let i = (x as usize).min(n - 2);
            (i, x - i as f32)
        };
        let ((i, s), (j, t)) = (place(a, COTANGENTS), place(alpha, ALPHAS));
        let row = |j: usize| {
            let r = &self.0[j * COTANGENTS + i..];
            r[0] + (r[1] - r[0]) * s
        };
        let (below, above) = (row(j), row(j + 1));
        below + (above - below) * t
    }
}

/// `a·Λ` of an isotropic distribution at `cotθ = aα`: the facets' area projected along the direction exceeds the
/// surface's by that of those turned away, `∫ D(m) max(0, −w·m) dm`, whose integral over the azimuth is known.
fn projected_excess(distribution: NormalDistribution, a: f64, alpha: f64) -> f64 {
    const N: usize = 400;
    let tan_w = 1.0 / (a * alpha).max(1e-12);
    let cos_w = 1.0 / (1.0 + tan_w * tan_w).sqrt();
    let sin_w = (1.0 - cos_w * cos_w).max(0.0).sqrt();
    let mut sum = 0.0;
    for i in 0..N {
        // Facets steeper than the direction: tanθ_m = α(a + v/(1 − v)).
        let v = (i as f64 + 0.5) / N as f64;
        let tan = alpha * (a + v / (1.0 - v));
        let d_tan = alpha / (1.0 - v).powi(2) / N as f64;
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        let sin = tan * cos;
        let d = f64::from(distribution.density(Vec2::splat(alpha as f32), Vec3::new(sin as f32, 0.0, cos as f32)));
        let (c, s) = (cos_w * cos, sin_w * sin);
        if s <= c {
            continue;
        }
        let turned = 2.0 * ((s * s - c * c).sqrt() - c * (c / s).acos());
        sum += d * turned * sin * cos * cos * d_tan;
    }
    // Λ = sum/cosθ and a = cosθ/(α sinθ).
    sum / (alpha * sin_w).max(1e-12)
}

#[cfg(test)]
mod tests {
    use super::{super::normal_distribution::Tail, *};
    use NormalDistribution::{Beckmann, Blinn, Gaussian, Ggx, StudentT};

    /// The area of the facets that face `w`, projected on it, by brute force.
    fn area_by_force(d: NormalDistribution, alpha: Vec2, w: Vec3) -> f64 {
        let (n, sectors) = (1500, 96);
        let scale = f64::from(alpha.x.max(alpha.y));
        let mut sum = 0.0;
        for i in 0..n {
            let v = (f64::from(i) + 0.5) / f64::from(n);
            let t = scale * v / (1.0 - v);
            let dt = scale / (1.0 - v).powi(2) / f64::from(n);
            let cos = 1.0 / (1.0 + t * t).sqrt();
            for j in 0..sectors {
                let phi = std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(sectors);
                let m = steradian_math::DVec3::new(t * cos * phi.cos(), t * cos * phi.sin(), cos).as_vec3();
                let area = f64::from(d.density(alpha, m)) * f64::from(w.dot(m).max(0.0));
                sum += area * t * cos * cos * cos * dt * std::f64::consts::TAU / f64::from(sectors);
            }
        }
        sum
    }

    #[test]
    fn smiths_function_is_the_projected_area_of_the_facets() {
        let student = |g| StudentT(Tail::new(g));
        for d in [Ggx, Beckmann, Blinn, Gaussian, student(1.8), student(2.0), student(4.0)] {
            for alpha in [0.1f32, 0.5, 1.0, 2.0] {
                for degrees in [20.0f32, 60.0, 80.0, 89.0] {
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    let w = Vec3::new(sin * 0.6, sin * 0.8, cos);
                    let exact = area_by_force(d, Vec2::splat(alpha), w) / f64::from(cos) - 1.0;
                    let lambda = f64::from(projected_area(d, Vec2::splat(alpha), w)) / f64::from(w.z) - 1.0;
                    let close = (lambda - exact).abs() < 2e-2 * exact + 2e-3;
                    assert!(close, "{d:?}, α = {alpha}, {degrees}°: {lambda} is not {exact}");
                }
            }
        }
    }

    #[test]
    fn special_functions_have_their_values() {
        assert!((ln_gamma(0.5) - PI.sqrt().ln()).abs() < 1e-6 && (ln_gamma(5.0) - 24f32.ln()).abs() < 1e-6);
        // I_x(1, ½) = 1 − √(1 − x); I_½(2, 2) = ½.
        for x in [0.1f32, 0.5, 0.9, 0.999] {
            assert!((incomplete_beta(1.0, 0.5, x) - (1.0 - (1.0 - x).sqrt())).abs() < 1e-5);
        }
        assert!((incomplete_beta(2.0, 2.0, 0.5) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn grooves_hide_nothing_from_above_and_all_at_grazing() {
        let m = Vec3::new(0.3, 0.0, 0.95).normalize();
        assert_eq!(v_groove(Vec3::Z, m), 1.0);
        let grazing = Vec3::new(1.0, 0.0, 1e-4).normalize();
        assert!(v_groove(grazing, m) < 1e-3);
    }
}

//! Real spherical harmonics: values, projection, and convolution with zonal kernels such as the clamped cosine.
//!
//! `y_lm(θ, φ) = N_lm P_l^|m|(cosθ) · {√2 cos mφ, 1, √2 sin |m|φ}` for `m > 0`, `= 0`, `< 0`, orthonormal over the
//! sphere, without the Condon–Shortley phase. (Sloan, "Stupid Spherical Harmonics Tricks", 2008; Ramamoorthi and
//! Hanrahan 2001.) Rotations mix the harmonics of one degree alone ([`Rotation`]).

use crate::{Mat3, Vec3};
use std::f32::consts::PI;

/// Highest degree that is evaluated; beyond it `f32` factorials lose too much.
pub const MAX_DEGREE: usize = 12;

/// Calls `each(l, m, y_lm(w))` for every harmonic up to a degree (at most [`MAX_DEGREE`]).
#[inline]
pub fn visit(degree: usize, w: Vec3, mut each: impl FnMut(usize, i32, f32)) {
    let degree = degree.min(MAX_DEGREE);
    // sinᵐθ (cos mφ, sin mφ) is the m-th power of x + iy; P_l^m without sinᵐθ follows by recurrence in l.
    let (mut re, mut im) = (1.0f32, 0.0f32);
    let mut p_mm = (1.0 / (4.0 * PI)).sqrt();
    for m in 0..=degree {
        if m > 0 {
            (re, im) = (re * w.x - im * w.y, re * w.y + im * w.x);
            p_mm *= ((2 * m + 1) as f32 / (2 * m) as f32).sqrt();
        }
        let (mut before, mut p) = (0.0, p_mm);
        for l in m..=degree {
            if l > m {
                // The normalised recurrence (Press et al., Numerical Recipes, 6.7).
                let (lf, mf) = (l as f32, m as f32);
                let a = ((4.0 * lf * lf - 1.0) / (lf * lf - mf * mf)).sqrt();
                let k = lf - 1.0;
                let b = if l > m + 1 { ((k * k - mf * mf) / (4.0 * k * k - 1.0)).sqrt() } else { 0.0 };
                (before, p) = (p, a * (w.z * p - b * before));
            }
            if m == 0 {
                each(l, 0, p);
            } else {
                let root2 = std::f32::consts::SQRT_2;
                each(l, m as i32, root2 * p * re);
                each(l, -(m as i32), root2 * p * im);
            }
        }
    }
}

/// Place of a harmonic in a list of all.
pub const fn index(l: usize, m: i32) -> usize {
    (l * (l + 1)).wrapping_add_signed(m as isize)
}

/// All values up to a degree, by [`index`].
pub fn values(degree: usize, w: Vec3) -> Vec<f32> {
    let degree = degree.min(MAX_DEGREE);
    let mut out = vec![0.0; (degree + 1) * (degree + 1)];
    visit(degree, w, |l, m, y| out[index(l, m)] = y);
    out
}

/// Coefficients of the clamped cosine by degree, as a convolution: irradiance has the coefficients `A_l L_lm`
/// (Ramamoorthi and Hanrahan 2001, equation 8).
pub fn clamped_cosine(l: usize) -> f32 {
    match l {
        0 => PI,
        1 => 2.0 * PI / 3.0,
        l if l % 2 == 1 => 0.0,
        l => {
            // 2π (−1)^(l/2−1) / ((l+2)(l−1)) · l! / (2^l (l/2)!²), the last factor as a product that cannot overflow.
            let central: f32 = (1..=l / 2).map(|i| (2 * i - 1) as f32 / (2 * i) as f32).product();
            let sign = if l / 2 % 2 == 1 { 1.0 } else { -1.0 };
            2.0 * PI * sign / ((l + 2) * (l - 1)) as f32 * central
        }
    }
}

/// Coefficients of what is left of a function after averaging it around every direction with a kernel given by its
/// factor per degree.
pub fn convolve(coefficients: &[f32], kernel: impl Fn(usize) -> f32) -> Vec<f32> {
    let degree = |i: usize| (i as f32 + 0.5).sqrt() as usize;
    coefficients.iter().enumerate().map(|(i, c)| c * kernel(degree(i))).collect()
}

/// Coefficients up to a degree (at most [`MAX_DEGREE`]) of a function of directions, by [`index`]: ∫ f y_lm dω. The
/// function is asked at `2n²` directions, Gauss–Legendre nodes in the cosine times even steps in azimuth, which is
/// exact for polynomials of degree `2n − 1 − degree`.
pub fn project(degree: usize, n: usize, f: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; (degree.min(MAX_DEGREE) + 1).pow(2)];
    for (z, weight) in crate::quadrature::gauss_legendre(n) {
        let r = (1.0 - z * z).sqrt();
        let area = (weight * std::f64::consts::PI / n as f64) as f32;
        for a in 0..2 * n {
            let (sin, cos) = (std::f64::consts::PI * (a as f64 + 0.5) / n as f64).sin_cos();
            let w = Vec3::new((r * cos) as f32, (r * sin) as f32, z as f32);
            let value = f(w) * area;
            visit(degree, w, |l, m, y| sums[index(l, m)] += value * y);
        }
    }
    sums
}

/// Rotation of coefficients: a matrix of 2l + 1 rows for each degree l (Ivanic and Ruedenberg, "Rotation matrices for
/// real spherical harmonics", 1996, with the additions and corrections of 1998).
#[derive(Clone, Debug)]
pub struct Rotation {
    /// Matrices by degree and rows, orders from −l to l.
    bands: Vec<Vec<f64>>,
}

impl Rotation {
    /// The rotation of functions by a rotation matrix, up to a degree: f becomes w ↦ f(R⁻¹ w).
    pub fn new(degree: usize, rotation: Mat3) -> Self {
        // Degree 1: the harmonics of orders −1, 0, 1 are y, z, x but for a factor.
        let axis = |m: i32| [1, 2, 0][(m + 1) as usize];
        let m = rotation.as_dmat3();
        let first = (-1..=1).flat_map(|row| (-1..=1).map(move |column| m.col(axis(column))[axis(row)])).collect();
        let mut bands = vec![vec![1.0], first];
        // Each further degree follows from the one before and from degree 1.
        for l in 2..=degree.min(MAX_DEGREE) {
            let band = next_band(l as i32, &bands[1], &bands[l - 1]);
            bands.push(band);
        }
        bands.truncate(degree + 1);
        Self { bands }
    }

    /// The coefficients of the rotated function; those beyond the degree of the rotation are left out.
    pub fn apply(&self, coefficients: &[Vec3]) -> Vec<Vec3> {
        let bands = self.bands.iter().enumerate().filter(|(l, _)| (l + 1) * (l + 1) <= coefficients.len());
        bands
            .flat_map(|(l, band)| {
                let size = 2 * l + 1;
                let from = &coefficients[l * l..l * l + size];
                band.chunks_exact(size)
                    .map(move |row| from.iter().zip(row).fold(Vec3::ZERO, |sum, (c, factor)| sum + *c * *factor as f32))
            })
            .collect()
    }
}

/// The matrix of degree `l` by those of degrees 1 and l − 1 (Ivanic and Ruedenberg 1996, table 1 and equation 8.1).
fn next_band(l: i32, first: &[f64], before: &[f64]) -> Vec<f64> {
    let one = |i: i32, j: i32| first[(3 * (i + 1) + j + 1) as usize];
    let lower = |a: i32, b: i32| before[((2 * l - 1) * (a + l - 1) + b + l - 1) as usize];
    // P(i; a, b) of table 2.
    let p = |i: i32, a: i32, b: i32| match b {
        b if b == l => one(i, 1) * lower(a, l - 1) - one(i, -1) * lower(a, 1 - l),
        b if b == -l => one(i, 1) * lower(a, 1 - l) + one(i, -1) * lower(a, l - 1),
        b => one(i, 0) * lower(a, b),
    };
    let entry = |m: i32, n: i32| {
        let denominator = f64::from(if n.abs() == l { 2 * l * (2 * l - 1) } else { (l + n) * (l - n) });
        let root = |numerator: i32| (f64::from(numerator) / denominator).sqrt();
        let mut sum = 0.0;
        // Each term only where its factor is not zero, since P has no value there.
        if m.abs() < l {
            sum += root((l + m) * (l - m)) * p(0, m, n);
        }
        let k = m.abs();
        let v = 0.5 * root((l + k - 1) * (l + k));
        sum += match m {
            0 => -v * std::f64::consts::SQRT_2 * (p(1, 1, n) + p(-1, -1, n)),
            1 => v * std::f64::consts::SQRT_2 * p(1, 0, n),
            -1 => v * std::f64::consts::SQRT_2 * p(-1, 0, n),
            m if m > 0 => v * (p(1, m - 1, n) - p(-1, 1 - m, n)),
            m => v * (p(1, m + 1, n) + p(-1, -m - 1, n)),
        };
        if m != 0 && k < l - 1 {
            let w = -0.5 * root((l - k - 1) * (l - k));
            sum += w * if m > 0 { p(1, m + 1, n) + p(-1, -m - 1, n) } else { p(1, m - 1, n) - p(-1, 1 - m, n) };
        }
        sum
    };
    (-l..=l).flat_map(|m| (-l..=l).map(move |n| (m, n))).map(|(m, n)| entry(m, n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss_legendre;

    /// M109: a rotated projection is the projection of the rotated function, to degree 8; rotations keep the norm of
    /// each degree.
    #[test]
    fn rotations_turn_functions() {
        let f = |w: Vec3| {
            let peak = (3.0 * w.dot(Vec3::new(0.6, 0.48, 0.64))).exp();
            Vec3::new(peak, w.x * w.y + w.z, (w.z - 0.3 * w.x).powi(5))
        };
        let coefficients = project(8, 24, f);
        for (axis, angle) in [(Vec3::X, 0.4f32), (Vec3::Z, -2.0), (Vec3::new(0.36, -0.48, 0.8), 1.7)] {
            let turn = Mat3::from_axis_angle(axis, angle);
            let rotated = Rotation::new(8, turn).apply(&coefficients);
            let right = project(8, 24, |w| f(turn.transpose() * w));
            for (i, (found, right)) in rotated.iter().zip(&right).enumerate() {
                assert!((*found - *right).abs().max_element() < 2e-5, "{axis} {i}: {found} {right}");
            }
            for l in 0..=8 {
                let norm = |c: &[Vec3]| c[l * l..(l + 1) * (l + 1)].iter().map(|c| c.length_squared()).sum::<f32>();
                assert!((norm(&rotated) - norm(&coefficients)).abs() < 1e-4 * norm(&coefficients).max(1e-3));
            }
        }
        // What is beyond the degree of the rotation is left out.
        assert_eq!(Rotation::new(1, Mat3::IDENTITY).apply(&coefficients), coefficients[..4]);
        assert_eq!(Rotation::new(0, Mat3::IDENTITY).apply(&coefficients), coefficients[..1]);
    }

    /// ∫ over the sphere, exact for polynomials of the degrees used here.
    fn integrate(f: impl Fn(Vec3) -> f64) -> f64 {
        let n = 64;
        let mut sum = 0.0;
        for (z, w) in gauss_legendre(32) {
            for a in 0..n {
                let phi = std::f64::consts::TAU * f64::from(a) / f64::from(n);
                let r = (1.0 - z * z).sqrt();
                sum += w / f64::from(n) * f(Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32));
            }
        }
        sum * std::f64::consts::TAU
    }

    #[test]
    fn they_are_orthonormal() {
        let degree = 6;
        let count = (degree + 1) * (degree + 1);
        for i in 0..count {
            for j in 0..=i {
                let dot = integrate(|w| {
                    let y = values(degree, w);
                    f64::from(y[i]) * f64::from(y[j])
                });
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-5, "{i} {j}: {dot}");
            }
        }
    }

    /// M109: nine coefficients give the irradiance of any sky to about a hundredth of its largest value (Ramamoorthi
    /// and Hanrahan 2001).
    #[test]
    fn nine_coefficients_are_enough_for_irradiance() {
        let sky = |w: Vec3| 1.0 + 0.8 * f64::from(w.z) + 0.5 * f64::from(w.x * w.y) + 0.3 * f64::from(w.x).powi(3);
        let exact = |n: Vec3| integrate_fine(|w| sky(w) * f64::from(w.dot(n).max(0.0)));
        let light: Vec<f32> = (0..9).map(|i| integrate(|w| sky(w) * f64::from(values(2, w)[i])) as f32).collect();
        let irradiance = convolve(&light, clamped_cosine);
        for n in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.48, 0.6, 0.64)] {
            let found: f32 = values(2, n).iter().zip(&irradiance).map(|(y, c)| y * c).sum();
            let exact = exact(n);
            assert!((f64::from(found) - exact).abs() < 0.01 * std::f64::consts::PI, "{n}: {found} {exact}");
        }
    }

    fn integrate_fine(f: impl Fn(Vec3) -> f64) -> f64 {
        let (n, m) = (400, 800);
        let mut sum = 0.0;
        for i in 0..n {
            let z = (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
            let r = (1.0 - z * z).sqrt();
            for a in 0..m {
                let phi = std::f64::consts::TAU * (f64::from(a) + 0.5) / f64::from(m);
                sum += f(Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32));
            }
        }
        sum * 4.0 * std::f64::consts::PI / f64::from(n * m)
    }

    #[test]
    fn the_clamped_cosine_has_its_published_coefficients() {
        for (l, a) in [(0, PI), (1, 2.094395), (2, PI / 4.0), (3, 0.0), (4, -0.130900), (5, 0.0), (6, 0.049087)] {
            assert!((clamped_cosine(l) - a).abs() < 1e-5, "{l}");
        }
    }
}

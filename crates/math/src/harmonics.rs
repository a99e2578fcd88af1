//! Real spherical harmonics: values, projection, and convolution with zonal kernels such as the clamped cosine.
//!
//! `y_lm(θ, φ) = N_lm P_l^|m|(cosθ) · {√2 cos mφ, 1, √2 sin |m|φ}` for `m > 0`, `= 0`, `< 0`, orthonormal over the
//! sphere, without the Condon–Shortley phase. (Sloan, "Stupid Spherical Harmonics Tricks", 2008; Ramamoorthi and
//! Hanrahan 2001.)

use crate::Vec3;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss_legendre;

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

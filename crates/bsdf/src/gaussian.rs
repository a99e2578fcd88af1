//! The error function and its inverse in single precision, for Gaussian slopes.

use steradian_math::elementary::{exp, ln};

/// `exp(x²) erfc(x)` for `x ≥ 0`; times `exp(−x²)` the absolute error is below 2·10⁻⁷ (Abramowitz & Stegun 1964,
/// 7.1.26).
#[inline]
pub(super) fn erfc_scaled(x: f32) -> f32 {
    const P: f32 = 0.327_591_1;
    const A: [f32; 5] = [1.061_405_4, -1.453_152, 1.421_413_7, -0.284_496_74, 0.254_829_6];
    let t = 1.0 / (1.0 + P * x);
    A.iter().fold(0.0, |acc, a| acc * t + a) * t
}

/// `erf(x)`, absolute error below 2·10⁻⁷.
#[inline]
pub(super) fn erf(x: f32) -> f32 {
    (1.0 - erfc_scaled(x.abs()) * exp(-x * x)).copysign(x)
}

/// The inverse of `erf` on `(−1, 1)`, relative error about 10⁻⁶ (Giles 2010, "Approximating the erfinv function").
#[inline]
pub(super) fn erf_inv(x: f32) -> f32 {
    const CENTRAL: [f32; 9] = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_387_7e-6,
        -4.391_506_5e-6,
        0.000_218_580_87,
        -0.001_253_725,
        -0.004_177_681_6,
        0.246_640_73,
        1.501_409_4,
    ];
    const TAIL: [f32; 9] = [
        -0.000_200_214_26,
        0.000_100_950_56,
        0.001_349_343_2,
        -0.003_673_428_4,
        0.005_739_507_7,
        -0.007_622_461_3,
        0.009_438_870_5,
        1.001_674,
        2.832_976_8,
    ];
    let x = x.clamp(-1.0 + f32::EPSILON * 0.5, 1.0 - f32::EPSILON * 0.5);
    let w = -ln((1.0 - x) * (1.0 + x));
    let (w, c) = if w < 5.0 { (w - 2.5, &CENTRAL) } else { (w.sqrt() - 3.0, &TAIL) };
    c.iter().fold(0.0, |acc, c| acc * w + c) * x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabulated_values_and_the_inverse() {
        // DLMF table 7.
        for (x, y) in [(0.0, 0.0), (0.5, 0.520_499_9), (1.0, 0.842_700_8), (2.0, 0.995_322_3), (-1.5, -0.966_105_1)] {
            assert!((erf(x) - y).abs() < 3e-7, "erf({x}) = {}", erf(x));
        }
        for i in -280..=280 {
            let x = i as f32 * 0.01;
            let slack = 1e-4 + 3e-7 * (x * x).exp();
            assert!((erf_inv(erf(x)) - x).abs() < slack, "{x} became {}", erf_inv(erf(x)));
        }
        assert!(erf_inv(1.0).is_finite() && erf_inv(-1.0).is_finite());
    }
}

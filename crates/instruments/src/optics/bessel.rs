//! Bessel functions of the first kind, by their integral `J_n(x) = 1/π ∫₀^π cos(nτ − x sin τ) dτ` (Abramowitz, Stegun,
//! eq. 9.1.21). The integrand is smooth and periodic, so the trapezoidal rule converges faster than any power of the
//! number of its points.

use std::f64::consts::PI;

/// `J_n(x)`, to about 1e-14 for |x| up to 10⁴.
pub fn bessel_j(n: u32, x: f64) -> f64 {
    let points = 64 + 2 * n as usize + x.abs().min(1e5) as usize;
    let f = |k: usize| {
        let t = PI * k as f64 / points as f64;
        (f64::from(n) * t - x * t.sin()).cos()
    };
    let ends = 0.5 * (f(0) + f(points));
    (ends + (1..points).map(f).sum::<f64>()) / points as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz, Stegun, tables 9.1 and 9.5.
    #[test]
    fn values_and_zeros_in_print() {
        assert!((bessel_j(0, 1.0) - 0.765_197_686_557_966_6).abs() < 1e-15);
        assert!((bessel_j(1, 2.0) - 0.576_724_807_756_873_4).abs() < 1e-15);
        assert!((bessel_j(1, 50.0) + 0.097_511_828_125_175_1).abs() < 1e-13);
        for zero in [3.831_705_970_207_512, 7.015_586_669_815_619, 10.173_468_135_062_722] {
            assert!(bessel_j(1, zero).abs() < 1e-14);
        }
    }
}

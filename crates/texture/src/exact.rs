//! Elementary functions from sums, products, quotients and square roots alone: the same bits on every machine, which
//! the system's mathematics library does not promise. Errors are below 10⁻¹², so that results are right in `f32`.

// Comparisons are negated on purpose: NaN takes the way of the exception.
#![expect(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN takes the branch, too")]

use std::f64::consts::{FRAC_PI_2, LN_2, PI, TAU};

/// `sin(2π x)`. Large arguments keep the precision that they came with.
pub fn sin_turns(x: f64) -> f64 {
    if !x.is_finite() {
        return 0.0;
    }
    // To a quarter turn about zero: sin(π − a) = sin(a).
    let r = x - x.round();
    let r = if r > 0.25 {
        0.5 - r
    } else if r < -0.25 {
        -0.5 - r
    } else {
        r
    };
    let a = r * TAU;
    let q = a * a;
    // The Taylor series up to a¹⁹/19!.
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..=9 {
        term *= -q / f64::from(2 * k * (2 * k + 1));
        sum += term;
    }
    a * sum
}

/// `sin(x)`, x in radians.
pub fn sin(x: f64) -> f64 {
    sin_turns(x / TAU)
}

/// `cos(x)`, x in radians.
pub fn cos(x: f64) -> f64 {
    sin_turns(x / TAU + 0.25)
}

/// The angle of the vector (x, y) in (−π, π]; zero for the zero vector.
pub fn atan2(y: f64, x: f64) -> f64 {
    // Beyond all bounds there is no angle worth having.
    let (ax, ay) = (x.abs(), y.abs());
    let (lo, hi) = (ax.min(ay), ax.max(ay));
    if x.is_nan() || y.is_nan() || hi == 0.0 || !lo.is_finite() {
        return 0.0;
    }
    let ratio = if hi.is_finite() { lo / hi } else { 0.0 };
    // Two halvings bring the angle below π/16, where the series converges fast.
    let half = |t: f64| t / (1.0 + (1.0 + t * t).sqrt());
    let t = half(half(ratio));
    let q = t * t;
    let mut sum = 0.0;
    for k in (0..10).rev() {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        sum = sum * q + sign / f64::from(2 * k + 1);
    }
    let mut angle = 4.0 * t * sum;
    if ay > ax {
        angle = FRAC_PI_2 - angle;
    }
    if x < 0.0 {
        angle = PI - angle;
    }
    if y < 0.0 { -angle } else { angle }
}

/// `log₂(x)` for x > 0; −1075 for zero and below, 1024 for infinity.
pub fn log2(x: f64) -> f64 {
    if x == f64::INFINITY {
        return 1024.0;
    }
    if !(x >= f64::MIN_POSITIVE) {
        return -1075.0;
    }
    let bits = x.to_bits();
    let mut exponent = (bits >> 52) as i64 - 1023;
    let mut m = f64::from_bits((bits & ((1 << 52) - 1)) | (1023 << 52));
    if m > std::f64::consts::SQRT_2 {
        m *= 0.5;
        exponent += 1;
    }
    // ln m = 2 artanh((m − 1)/(m + 1)).
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    let mut sum = 0.0;
    for k in (0..9).rev() {
        sum = sum * q + 1.0 / f64::from(2 * k + 1);
    }
    exponent as f64 + 2.0 * s * sum / LN_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_agree_with_the_library() {
        let mut x = -40.0;
        while x < 40.0 {
            assert!((sin(x) - x.sin()).abs() < 1e-12, "sin {x}");
            assert!((cos(x) - x.cos()).abs() < 1e-12, "cos {x}");
            assert!((atan2(x, 0.37 - x * x * 0.1) - x.atan2(0.37 - x * x * 0.1)).abs() < 1e-12, "atan2 {x}");
            let e = x.exp();
            assert!((log2(e) - e.log2()).abs() < 1e-10, "log2 {e}: {} {}", log2(e), e.log2());
            x += 0.0137;
        }
    }

    #[test]
    fn ends_of_the_range() {
        assert_eq!((atan2(0.0, 0.0), atan2(0.0, -1.0), atan2(-0.0, 1.0)), (0.0, PI, 0.0));
        assert!((atan2(1.0, 0.0) - FRAC_PI_2).abs() < 1e-15 && (atan2(-1.0, 0.0) + FRAC_PI_2).abs() < 1e-15);
        assert_eq!((atan2(f64::NAN, 1.0), atan2(1.0, f64::INFINITY)), (0.0, 0.0));
        assert_eq!((log2(0.0), log2(1.0), log2(8.0), log2(f64::INFINITY)), (-1075.0, 0.0, 3.0, 1024.0));
        assert_eq!((sin_turns(f64::INFINITY), sin_turns(0.5)), (0.0, 0.0));
        assert!((sin_turns(0.25) - 1.0).abs() < 1e-15);
    }
}

//! Falloff of weights with differences.

use std::f32::consts::LOG2_E;

/// Powers of two from here on are 0. Their squares, by which variances are weighed, are normal numbers.
const LAST: f32 = 40.0;
/// 1.5 · 2²³. A number that it is added to is rounded to an integer, which the lowest bits then hold.
const ROUND: f32 = 12_582_912.0;

/// e^−x for x ≥ 0, to a part of 1.1·10⁻⁴: 1 at 0, and 0 from 28 on and for NaN.
#[inline(always)]
pub(crate) fn falloff(x: f32) -> f32 {
    let y = x * LOG2_E;
    let y = if y < LAST { y } else { 127.0 };
    let rounded = y + ROUND;
    let part = y - (rounded - ROUND);
    // 2^−part from −1/2 to 1/2, fitted such that there is no step where the integer changes.
    let power = 1.0 + part * (-0.693_283 + part * (0.242_212_08 + part * -0.055_009_384));
    let scale = f32::from_bits(127u32.wrapping_sub(rounded.to_bits()) << 23);
    power * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_near_the_exponential() {
        assert_eq!(falloff(0.0), 1.0);
        let mut last = 1.0;
        for k in 0..270_000 {
            let x = k as f32 * 1e-4;
            let (found, expected) = (falloff(x), f64::from(-x).exp());
            assert!((f64::from(found) / expected - 1.0).abs() < 1.1e-4, "{found} for {expected} at {x}");
            assert!(found <= last * (1.0 + 3e-7), "{found} after {last} at {x}");
            last = found;
        }
    }

    #[test]
    fn it_is_nothing_far_out() {
        for x in [28.0, 87.0, 1e3, 1e30, f32::MAX, f32::INFINITY, f32::NAN] {
            assert_eq!(falloff(x).to_bits(), 0, "{x}");
        }
    }
}

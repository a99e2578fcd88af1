//! Elementary functions in single precision that the system's library is slow at, from sums, products and quotients, to be inlined; with
//! the same bits on every machine, which that library does not promise.
//!
//! Range reduction and polynomials are those of the Cephes library (Moshier 1989) or Taylor's, summed in pairs, which waits less; errors are
//! a few units in the last place of the result, as the tests have it.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, LOG2_E, PI, TAU};

/// Added and taken away again, this rounds a number below 2²² to the nearest integer, which the low bits of the sum hold.
const ROUND: f32 = 12_582_912.0;

/// `ln 2` in two parts, of which the first has few bits, so that its products with small integers are exact.
const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];

/// The nearest integer to a number below 2²² in magnitude, twice: as a number and as an integer.
#[inline]
fn nearest(x: f32) -> (f32, i32) {
    let shifted = x + ROUND;
    (shifted - ROUND, shifted.to_bits().wrapping_sub(ROUND.to_bits()) as i32)
}

/// `eˣ − 1`, exact to the last digits near zero.
#[inline]
pub fn exp_m1(x: f32) -> f32 {
    if x < -17.0 {
        return -1.0;
    }
    if x > 88.0 {
        return f32::INFINITY;
    }
    // x = k ln 2 + r, eˣ = 2ᵏ eʳ.
    let (k, n) = nearest(x * LOG2_E);
    let r = (x - k * LN_2[0]) - k * LN_2[1];
    let (r2, scale) = (r * r, f32::from_bits(((n + 127) << 23) as u32));
    let tail =
        (0.5 + r * (1.0 / 6.0)) + r2 * ((1.0 / 24.0 + r * (1.0 / 120.0)) + r2 * (1.0 / 720.0 + r * (1.0 / 5040.0)));
    scale * (r + r2 * tail) + (scale - 1.0)
}

/// The power of two and the rest of `x = m 2ᵉ`, with `m` between √½ and √2.
#[inline]
fn split(x: f32) -> (f32, f32) {
    let bits = x.to_bits() as i32;
    let e = (bits - 0x3f35_04f3) >> 23;
    (f32::from_bits((bits - (e << 23)) as u32), e as f32)
}

/// `e ln 2 + ln(1 + f)` for `f` between √½ − 1 and √2 − 1.
#[inline]
fn ln_from(f: f32, e: f32) -> f32 {
    let z = f / (2.0 + f);
    let q = z * z;
    let series = (1.0 / 3.0 + q * 0.2) + q * q * ((1.0 / 7.0 + q * (1.0 / 9.0)) + q * q * (1.0 / 11.0));
    e * LN_2[0] + (e * LN_2[1] + 2.0 * (z + z * q * series))
}

/// `ln(1 + x)` for finite `x`, exact to the last digits near zero; −∞ up to −1.
#[inline]
pub fn ln_1p(x: f32) -> f32 {
    if x <= -1.0 {
        return f32::NEG_INFINITY;
    }
    let (m, e) = split(1.0 + x);
    ln_from(if e == 0.0 { x } else { m - 1.0 }, e)
}

/// Sine and cosine of `a` within ±π/4.
#[inline]
fn octant(a: f32) -> (f32, f32) {
    let q = a * a;
    let sin = ((-1.951_529_6e-4 * q + 8.332_161e-3) * q - 1.666_665_5e-1) * q * a + a;
    let cos = ((2.443_315_7e-5 * q - 1.388_731_6e-3) * q + 4.166_664_6e-2) * q * q - 0.5 * q + 1.0;
    (sin, cos)
}

/// Sine and cosine of `2π turns`, for up to a million turns.
#[inline]
pub fn sin_cos_turns(turns: f32) -> (f32, f32) {
    let (quarters, n) = nearest(4.0 * turns);
    let (sin, cos) = octant((turns - 0.25 * quarters) * TAU);
    let (sin, cos) = if n & 1 == 0 { (sin, cos) } else { (cos, -sin) };
    if n & 2 == 0 { (sin, cos) } else { (-sin, -cos) }
}

/// Sine and cosine of `¼π x` for `x` within ±1.
#[inline]
pub fn sin_cos_octant(x: f32) -> (f32, f32) {
    octant(x * FRAC_PI_4)
}

/// The angle of the vector `(x, y)` in `[−π, π]`; zero for the zero vector.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let (lo, hi) = if ax < ay { (ax, ay) } else { (ay, ax) };
    if hi == 0.0 {
        return 0.0;
    }
    // Beyond tan(π/8) an eighth of the circle is taken off.
    let (t, offset) = if lo > 0.414_213_56 * hi { ((lo - hi) / (lo + hi), FRAC_PI_4) } else { (lo / hi, 0.0) };
    let q = t * t;
    let series = [8.053_745e-2, -1.387_768_6e-1, 1.997_771e-1, -3.333_295e-1].into_iter().fold(0.0, |s, c| s * q + c);
    let angle = offset + (series * q * t + t);
    let angle = if ax < ay { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    angle.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest relative error against double precision, of numbers spread over a range.
    fn worst(range: (f32, f32), f: fn(f32) -> f32, truth: fn(f64) -> f64) -> f64 {
        let n = 200_000;
        (0..=n)
            .map(|i| range.0 + (range.1 - range.0) * i as f32 / n as f32)
            .map(|x| {
                let t = truth(f64::from(x));
                if t == 0.0 { f64::from(f(x)).abs() } else { (f64::from(f(x)) / t - 1.0).abs() }
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn exponentials_and_logarithms_are_right_to_the_last_digits() {
        for range in [(-1e-3, 1e-3), (-1.0, 1.0), (-20.0, 20.0)] {
            assert!(worst(range, exp_m1, f64::exp_m1) < 4e-7, "{range:?}: {}", worst(range, exp_m1, f64::exp_m1));
        }
        for range in [(-1e-4, 1e-4), (-0.99, 3.0), (0.0, 1e6)] {
            assert!(worst(range, ln_1p, f64::ln_1p) < 4e-7, "{range:?}: {}", worst(range, ln_1p, f64::ln_1p));
        }
        assert_eq!((exp_m1(-200.0), exp_m1(200.0), ln_1p(-1.0)), (-1.0, f32::INFINITY, f32::NEG_INFINITY));
        assert!(exp_m1(f32::NAN).is_nan());
    }

    #[test]
    fn angles_are_right_to_the_last_digits() {
        for i in -4000..=4000 {
            let x = i as f32 * 1e-3;
            let (s, c) = sin_cos_turns(x);
            let (t, u) = (f64::from(x) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(s) - t).abs() < 2e-7 && (f64::from(c) - u).abs() < 2e-7, "{x} turns: {s} {c}");
            let y = (i % 37) as f32 * 0.1 - 1.8;
            let (found, truth) = (f64::from(atan2(y, x)), f64::from(y).atan2(f64::from(x)));
            assert!((found - truth).abs() < 5e-7, "({x}, {y}): {found} {truth}");
        }
        let (s, c) = sin_cos_octant(1.0);
        assert!((s - c).abs() < 2e-7 && (s * s + c * c - 1.0).abs() < 2e-7);
        assert_eq!(atan2(0.0, 0.0), 0.0);
    }
}

//! Whole numbers below floats, without the library's `floor`, which is a call on processors that are not known to have
//! SSE 4.1, and without conversions that have to look for numbers out of range.

#![allow(clippy::needless_range_loop, reason = "loops over lanes are unrolled for certain this way")]

use glam::Vec4;

/// Where numbers are held, 2²²: floats have hardly any fractions there.
pub const FAR: f32 = 4_194_304.0;

/// Numbers within ±2²² get the spacing 1 by the addition of this, 1.5 · 2²³: their last bits are whole numbers then.
const SHIFT: f32 = 12_582_912.0;

/// For each lane the greatest whole number that is not above it, and what it is above that; lanes are held at ±2²², and
/// NaN at one of these.
#[inline(always)]
pub fn split(x: Vec4) -> ([i32; 4], Vec4) {
    let x = x.max(Vec4::splat(-FAR)).min(Vec4::splat(FAR));
    let nearest = (x + SHIFT) - SHIFT;
    let whole = nearest - Vec4::select(nearest.cmpgt(x), Vec4::ONE, Vec4::ZERO);
    let bits = (whole + SHIFT).to_array();
    let mut integers = [0; 4];
    for k in 0..4 {
        integers[k] = bits[k].to_bits() as i32 - SHIFT.to_bits() as i32;
    }
    (integers, x - whole)
}

/// The greatest whole number that is not above `x`, held at ±2²².
#[inline(always)]
pub fn floor(x: f32) -> i32 {
    split(Vec4::splat(x)).0[0]
}

/// The least whole number that is not below `x`, held at ±2²².
#[inline(always)]
pub fn ceil(x: f32) -> i32 {
    -floor(-x)
}

/// The whole number nearest to `x`, which is within ±2²².
#[inline(always)]
pub fn nearest(x: f32) -> i32 {
    (x + SHIFT).to_bits() as i32 - SHIFT.to_bits() as i32
}

/// What `x` is above the greatest whole number that is not above it; NaN for infinity.
#[inline(always)]
pub fn fraction(x: f32) -> f32 {
    if x.abs() < FAR { x - floor(x) as f32 } else { x - x.floor() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_the_library_has_it() {
        let mut x = 1e-30_f32;
        while x < 1e30 {
            for x in [x, -x, x.round(), -x.round(), x.round() + 0.5, 0.5 - x.round()] {
                assert_eq!(floor(x), x.clamp(-FAR, FAR).floor() as i32, "{x}");
                assert_eq!(fraction(x), x - x.floor(), "{x}");
            }
            x *= 1.37;
        }
        let far = FAR as i32;
        assert_eq!((floor(f32::NEG_INFINITY), floor(f32::INFINITY), floor(f32::NAN).abs()), (-far, far, far));
        assert!(fraction(f32::INFINITY).is_nan() && fraction(f32::NAN).is_nan());
    }
}

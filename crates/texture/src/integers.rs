//! Whole numbers below floats, without the library's `floor`, which is a call on processors that are not known to have
//! SSE 4.1, and without conversions that have to look for numbers out of range.

use steradian_math::Vec4;

/// Limit to which numbers are clamped, 2²²: floats have hardly any fractions there.
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

/// For each lane the texel whose centre comes before the place `x` (texel centres are at halves), and how far the place
/// is beyond it, in `[0, 1]`: at a centre it may be the texel before that one and 1, which is the same place. Quicker
/// than [`split`]; lanes that are not within ±2²², and NaN, give some number that is not in `[0, 2²²)`.
#[inline(always)]
pub fn before(x: Vec4) -> ([i32; 4], Vec4) {
    let shifted = x + (SHIFT - 1.0);
    let bits = shifted.to_array();
    let mut integers = [0; 4];
    for k in 0..4 {
        integers[k] = (bits[k].to_bits() as i32).wrapping_sub(SHIFT.to_bits() as i32);
    }
    (integers, (x - 0.5) - (shifted - SHIFT))
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

/// Fractional part of `x`: its distance above the greatest integer that is not above it; NaN for infinity.
#[inline(always)]
pub fn fraction(x: f32) -> f32 {
    if x.abs() < FAR { x - floor(x) as f32 } else { x - x.floor() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_before_places() {
        for i in 0..4000 {
            let x = i as f32 * 0.313 - 100.0;
            for x in [x, x.floor() + 0.5, x.floor()] {
                let ([i, ..], t) = before(Vec4::splat(x));
                assert!((0.0..=1.0).contains(&t.x) && i as f32 + 0.5 + t.x == x, "{x}: {i} {}", t.x);
            }
        }
        let far = [FAR, 1e7, 1e10, f32::MAX, f32::INFINITY, f32::NAN];
        for x in far.into_iter().chain(far.map(|x| -x)) {
            let ([i, ..], _) = before(Vec4::splat(2.0 * x));
            assert!(!(0..FAR as i32).contains(&i), "{x}: {i}");
        }
    }

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

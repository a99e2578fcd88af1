//! Levels of detail: which sizes of a picture a footprint is looked up in (E43: by lengths in texels, not in periods).

/// The finer of the two levels for a length in texels of the picture, and how far towards the coarser one, in `[0, 1]`:
/// log₂ of the length.
#[inline(always)]
pub fn level_of(length: f32, count: usize) -> (usize, f32) {
    // NaN is no length.
    if length > 1.0 {
        let (exponent, t) = log2(length);
        within(exponent as usize, t, count)
    } else {
        (0, 0.0)
    }
}

/// [`level_of`] for the square of a length, and as many levels as there may be; `None` for lengths that are not above
/// one.
#[inline(always)]
pub fn level_of_square(square: f32) -> Option<(usize, f32)> {
    // NaN is no length.
    if square <= 1.0 || square.is_nan() {
        return None;
    }
    let i = ((square.to_bits() >> 23) as i32 - 127) >> 1;
    // In units of 2ⁱ, less one.
    let m = square.sqrt() * f32::from_bits(((127 - i) as u32) << 23) - 1.0;
    Some((i as usize, log2_of_significand(m)))
}

#[inline(always)]
fn within(i: usize, t: f32, count: usize) -> (usize, f32) {
    if i + 1 >= count { (count - 1, 0.0) } else { (i, t) }
}

/// log₂ of a number from 1 on: its whole part, and its fraction to 4·10⁻⁷ and rounding, in `[0, 1]`. Exact for powers
/// of two, so that it is continuous there; 128 for infinity.
#[inline(always)]
fn log2(x: f32) -> (i32, f32) {
    let bits = x.to_bits();
    let m = f32::from_bits((bits & 0x7f_ffff) | 0x3f80_0000) - 1.0;
    ((bits >> 23) as i32 - 127, log2_of_significand(m))
}

/// log₂(1 + m) for m in `[0, 1]`.
#[inline(always)]
fn log2_of_significand(m: f32) -> f32 {
    // The minimax polynomial for (log₂(1 + m) − m) / (m (1 − m)).
    const Q: [f32; 6] = [0.442_666_76, -0.277_891_4, 0.195_448_46, -0.129_719_44, 0.063_332_654, -0.015_208_775];
    let m2 = m * m;
    let q = (Q[0] + m * Q[1]) + m2 * ((Q[2] + m * Q[3]) + m2 * (Q[4] + m * Q[5]));
    m + (m - m2) * q
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_are_near_the_exact_ones_and_never_fall() {
        let mut last = 0.0;
        for bits in (1.0_f32.to_bits()..1e6_f32.to_bits()).step_by(997) {
            let x = f32::from_bits(bits);
            let (whole, t) = log2(x);
            let seen = whole as f32 + t;
            assert!((f64::from(seen) - f64::from(x).log2()).abs() < 2e-6, "{x}: {seen}");
            assert!(seen >= last - 1e-6, "{x}");
            last = seen;
        }
        (0..127).for_each(|k| assert_eq!(log2(2_f32.powi(k)), (k, 0.0)));
    }

    #[test]
    fn squares_lead_to_the_same_levels() {
        for length in [1.000_01, 1.5, 1.999_999_9, 2.0, 2.000_000_2, 7.9, 8.0, 300.0, 1e12, 1e18] {
            let ((i, s), (j, t)) = (level_of(length, 99), level_of_square(length * length).unwrap());
            assert!((i as f32 + s - j as f32 - t).abs() < 1e-5 && (0.0..=1.0).contains(&t), "{length}");
        }
        for strange in [f32::NAN, 0.0, -1.0, 1.0] {
            assert_eq!((level_of(strange, 9), level_of_square(strange)), ((0, 0.0), None));
        }
        assert_eq!(level_of(f32::INFINITY, 9), (8, 0.0));
        assert_eq!(level_of_square(f32::INFINITY).unwrap().0, 64);
    }
}

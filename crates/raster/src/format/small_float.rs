//! Unsigned floats of 10 and 11 bits, and three mantissas with one exponent (OpenGL 4.6, sections 2.3.4.3 and 8.5.2;
//! `EXT_texture_shared_exponent`).

/// An unsigned float with 5 bits of exponent and `mantissa` bits, rounded to nearest even; negative values give 0, NaN
/// NaN, and what is beyond the largest finite value infinity.
pub(super) fn encode_unsigned(value: f32, mantissa: u32) -> u32 {
    let infinity = 31 << mantissa;
    if value.is_nan() {
        return infinity | 1;
    }
    if value <= 0.0 {
        return 0;
    }
    // The smallest exponent is −14; below it steps are 2^(−14 − mantissa), all exact in f64.
    let value = f64::from(value);
    let exponent = ((value.to_bits() >> 52) as i32 - 1023).max(-14);
    if exponent > 15 {
        return infinity;
    }
    let steps = (value * 2f64.powi(mantissa as i32 - exponent)).round_ties_even() as u32;
    // `steps` includes the hidden bit, which carries into the exponent when it is rounded up; denormals have none.
    let biased = (exponent + 14) as u32;
    ((biased << mantissa) + steps).min(infinity)
}

/// The value of such bits.
pub(super) fn decode_unsigned(bits: u32, mantissa: u32) -> f32 {
    let fraction = (bits & ((1 << mantissa) - 1)) as f32;
    let scale = (1u32 << mantissa) as f32;
    match bits >> mantissa {
        0 => fraction / scale * 2f32.powi(-14),
        31 if fraction == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        exponent => (1.0 + fraction / scale) * 2f32.powi(exponent as i32 - 15),
    }
}

const MANTISSA: i32 = 9;
const BIAS: i32 = 15;
/// The largest value: (2⁹ − 1)/2⁹ · 2¹⁶.
const LARGEST: f32 = 65408.0;

/// Red, green and blue in 9 + 9 + 9 + 5 bits. Negative values and NaN give 0.
pub(super) fn encode_shared(rgb: [f32; 3]) -> u32 {
    let rgb = rgb.map(|x| if x > 0.0 { x.min(LARGEST) } else { 0.0 });
    let largest = rgb[0].max(rgb[1]).max(rgb[2]);
    let log = if largest > 0.0 { (largest.to_bits() >> 23) as i32 - 127 } else { -127 };
    let mut exponent = log.max(-BIAS - 1) + 1 + BIAS;
    let step = |exponent: i32| 2f64.powi(exponent - BIAS - MANTISSA);
    let round = |x: f32, exponent: i32| (f64::from(x) / step(exponent) + 0.5).floor() as u32;
    if round(largest, exponent) == 1 << MANTISSA {
        exponent += 1;
    }
    let [r, g, b] = rgb.map(|x| round(x, exponent));
    r | g << 9 | b << 18 | (exponent as u32) << 27
}

/// The values of such bits.
pub(super) fn decode_shared(bits: u32) -> [f32; 3] {
    let step = 2f32.powi((bits >> 27) as i32 - BIAS - MANTISSA);
    [bits, bits >> 9, bits >> 18].map(|m| (m & 511) as f32 * step)
}

//! Values to bits and back.

use glam::Vec4;
use half::f16;
use steradian_image::encoding::{srgb8_decode, srgb8_encode};

use super::{Format, Numeric, small_float, table::Order};

/// Rounds c·x to the nearest integer, ties to even, for x clamped to [−1, 1] or [0, 1]; NaN gives 0.
#[inline]
fn normalized(x: f32, low: f32, scale: f64) -> f64 {
    if x.is_nan() { 0.0 } else { (f64::from(x.clamp(low, 1.0)) * scale).round_ties_even() }
}

#[inline]
const fn low_bits(bits: u8) -> u32 {
    if bits >= 32 { !0 } else { (1 << bits) - 1 }
}

/// The nearest of 256 levels of each channel, of two the upper one; NaN gives 0.
#[inline(always)]
pub(crate) fn encode_rgba8(color: Vec4) -> [u8; 4] {
    // The largest is 255.5 rounded down.
    let levels = color.max(Vec4::ZERO).min(Vec4::ONE) * 255.0 + 0.5;
    // Floats from 2²³ on have no bits below one: the sum is rounded to a whole number, which its lowest bits are. One
    // less where that was up.
    let shift = Vec4::splat(8_388_608.0);
    let rounded = levels + shift;
    let down = rounded - Vec4::select((rounded - shift).cmpgt(levels), Vec4::ONE, Vec4::ZERO);
    let level = |x: f32| x.to_bits() as u8;
    [level(down.x), level(down.y), level(down.z), level(down.w)]
}

/// Shares of 255. The quotient is rounded as a division would, since 257/65536 times a level is exact, and the rest of
/// 1/255, which is 257/65535, is small.
#[inline(always)]
pub(crate) fn decode_rgba8([r, g, b, a]: [u8; 4]) -> Vec4 {
    const HIGH: f32 = 257.0 / 65536.0;
    const LOW: f32 = HIGH / 65535.0;
    let levels = Vec4::new(f32::from(r), f32::from(g), f32::from(b), f32::from(a));
    levels * HIGH + levels * LOW
}

/// The bits of one channel. `value` holds integers as bits.
#[inline]
fn encode_channel(numeric: Numeric, bits: u8, value: f32) -> u32 {
    match numeric {
        Numeric::Unorm | Numeric::Srgb => normalized(value, 0.0, f64::from(low_bits(bits))) as u32,
        Numeric::Snorm => {
            (normalized(value, -1.0, f64::from(low_bits(bits - 1))) as i32).cast_unsigned() & low_bits(bits)
        }
        Numeric::Uint => value.to_bits().min(low_bits(bits)),
        Numeric::Sint => {
            let largest = low_bits(bits - 1).cast_signed();
            value.to_bits().cast_signed().clamp(-largest - 1, largest).cast_unsigned() & low_bits(bits)
        }
        Numeric::Float => match bits {
            32 => value.to_bits(),
            16 => u32::from(f16::from_f32(value).to_bits()),
            _ => small_float::encode_unsigned(value, u32::from(bits) - 5),
        },
        Numeric::Depth | Numeric::DepthStencil if bits == 32 => value.to_bits(),
        Numeric::Depth | Numeric::DepthStencil => normalized(value, 0.0, f64::from(low_bits(bits))) as u32,
        Numeric::Stencil => value.to_bits() & 255,
        Numeric::SharedExponent => 0,
    }
}

/// The value of the bits of one channel.
#[inline]
fn decode_channel(numeric: Numeric, bits: u8, stored: u32) -> f32 {
    let signed = || (stored << (32 - bits)).cast_signed() >> (32 - bits);
    match numeric {
        Numeric::Unorm | Numeric::Srgb => (f64::from(stored) / f64::from(low_bits(bits))) as f32,
        Numeric::Snorm => (f64::from(signed()) / f64::from(low_bits(bits - 1))).max(-1.0) as f32,
        Numeric::Uint | Numeric::Stencil => f32::from_bits(stored),
        Numeric::Sint => f32::from_bits(signed().cast_unsigned()),
        Numeric::Float => match bits {
            32 => f32::from_bits(stored),
            16 => f16::from_bits(stored as u16).to_f32(),
            _ => small_float::decode_unsigned(stored, u32::from(bits) - 5),
        },
        Numeric::Depth | Numeric::DepthStencil if bits == 32 => f32::from_bits(stored),
        Numeric::Depth | Numeric::DepthStencil => (f64::from(stored) / f64::from(low_bits(bits))) as f32,
        Numeric::SharedExponent => 0.0,
    }
}

impl Format {
    /// The texel of a colour, in the low bits. Integers are handed over as bits ([`f32::from_bits`]) and clamped;
    /// floats in normalised formats are clamped and rounded to nearest.
    pub fn encode(self, color: Vec4) -> u128 {
        let (numeric, bits, order) = self.layout();
        let color = color.to_array();
        match numeric {
            Numeric::SharedExponent => return u128::from(small_float::encode_shared([color[0], color[1], color[2]])),
            Numeric::DepthStencil => {
                let stencil = u128::from(color[1].to_bits() & 255);
                return u128::from(encode_channel(numeric, bits[0], color[0])) | stencil << bits[0];
            }
            _ => {}
        }
        let mut texel = 0;
        let mut shift = 0;
        for channel in channels(order) {
            if bits[channel] > 0 {
                let stored = if numeric == Numeric::Srgb && channel < 3 {
                    u32::from(srgb8_encode(color[channel]))
                } else {
                    encode_channel(numeric, bits[channel], color[channel])
                };
                texel |= u128::from(stored) << shift;
                shift += bits[channel];
            }
        }
        texel
    }

    /// The colour of a texel. Channels that are not there are 0, alpha 1 (in integer formats the integers 0 and 1).
    pub fn decode(self, texel: u128) -> Vec4 {
        let (numeric, bits, order) = self.layout();
        let one = if self.class() == crate::output::Class::Float { 1.0 } else { f32::from_bits(1) };
        match numeric {
            Numeric::SharedExponent => {
                let [r, g, b] = small_float::decode_shared(texel as u32);
                return Vec4::new(r, g, b, 1.0);
            }
            Numeric::DepthStencil => {
                let depth = decode_channel(numeric, bits[0], texel as u32 & low_bits(bits[0]));
                return Vec4::new(depth, f32::from_bits((texel >> bits[0]) as u32 & 255), 0.0, one);
            }
            _ => {}
        }
        let mut color = [0.0, 0.0, 0.0, one];
        let mut shift = 0;
        for channel in channels(order) {
            if bits[channel] > 0 {
                let stored = (texel >> shift) as u32 & low_bits(bits[channel]);
                color[channel] = if numeric == Numeric::Srgb && channel < 3 {
                    srgb8_decode(stored as u8)
                } else {
                    decode_channel(numeric, bits[channel], stored)
                };
                shift += bits[channel];
            }
        }
        Vec4::from_array(color)
    }

    /// Writes the texel of a colour into the first bytes of `texel`.
    #[inline]
    pub fn write(self, color: Vec4, texel: &mut [u8]) {
        match self {
            Self::Rgba8Unorm => {
                texel[..4].copy_from_slice(&encode_rgba8(color));
            }
            Self::Rgba32Float => {
                for (bytes, x) in texel.chunks_exact_mut(4).zip(color.to_array()) {
                    bytes.copy_from_slice(&x.to_le_bytes());
                }
            }
            Self::R32Float => texel[..4].copy_from_slice(&color.x.to_le_bytes()),
            _ => {
                let bytes = self.bytes();
                texel[..bytes].copy_from_slice(&self.encode(color).to_le_bytes()[..bytes]);
            }
        }
    }

    /// The colour of the texel in the first bytes of `texel`.
    #[inline]
    pub fn read(self, texel: &[u8]) -> Vec4 {
        match self {
            Self::Rgba8Unorm => decode_rgba8([texel[0], texel[1], texel[2], texel[3]]),
            Self::Rgba32Float => {
                Vec4::from_array(std::array::from_fn(|i| f32::from_le_bytes([0, 1, 2, 3].map(|b| texel[4 * i + b]))))
            }
            _ => {
                let mut bytes = [0; 16];
                bytes[..self.bytes()].copy_from_slice(&texel[..self.bytes()]);
                self.decode(u128::from_le_bytes(bytes))
            }
        }
    }
}

/// Red, green, blue and alpha in the order of their bits, lowest first.
const fn channels(order: Order) -> [usize; 4] {
    match order {
        Order::Rgba => [0, 1, 2, 3],
        Order::Bgra => [2, 1, 0, 3],
        Order::Abgr => [3, 2, 1, 0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(a: f32, b: f32) -> bool {
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    /// Bits of formats with channels up to 16 bits return from a trip through floats, but for NaN payloads and the
    /// second −1 of Snorm (M190).
    #[test]
    fn every_8_and_16_bit_code_returns() {
        for &format in Format::ALL {
            let (numeric, bits, order) = format.layout();
            if bits.iter().any(|&b| b > 16) || numeric == Numeric::SharedExponent {
                continue;
            }
            let mut shift = 0;
            for channel in channels(order).into_iter().filter(|&c| bits[c] > 0) {
                for code in 0..1u128 << bits[channel] {
                    let texel = code << shift;
                    let color = format.decode(texel);
                    let back = format.encode(color);
                    let other = format.decode(back);
                    assert!((0..4).all(|i| same(color[i], other[i])), "{format:?} {texel:x} {back:x}");
                    let signed_lowest = numeric == Numeric::Snorm && code == 1 << (bits[channel] - 1);
                    if !signed_lowest && !color.is_nan() {
                        assert_eq!(back, texel, "{format:?} channel {channel}");
                    }
                }
                shift += bits[channel];
            }
        }
    }

    /// All 2³² texels of shared exponents would take long: all mantissas with all exponents in each channel, others
    /// zero.
    #[test]
    fn shared_exponents_return_as_values() {
        for exponent in 0..32u32 {
            for mantissa in 0..512u32 {
                for channel in 0..3 {
                    let texel = u128::from(exponent << 27 | mantissa << (9 * channel));
                    let color = Format::Rgb9E5.decode(texel);
                    let expected = f64::from(mantissa) * 2f64.powi(exponent as i32 - 24);
                    assert_eq!(f64::from(color[channel]), expected);
                    assert_eq!(Format::Rgb9E5.decode(Format::Rgb9E5.encode(color)), color);
                }
            }
        }
        // Values from the extension's text: rounding carries into the exponent, and what is too large is clamped.
        assert_eq!(Format::Rgb9E5.decode(Format::Rgb9E5.encode(Vec4::splat(1e9))).x, 65408.0);
        assert_eq!(Format::Rgb9E5.decode(Format::Rgb9E5.encode(Vec4::splat(1.9999))).x, 2.0);
    }

    /// The six sized formats of OpenGL's table 8.12 that no other API has: each code of each channel, with the others
    /// zero and with the others full, returns, and its value is its share of the largest.
    #[test]
    fn codes_of_the_classic_formats_are_shares_of_the_largest() {
        use Format::{Rgb4Unorm, Rgb5Unorm, Rgb10Unorm, Rgb12Unorm, Rgba2Unorm, Rgba12Unorm};
        for (format, bits, channels) in [
            (Rgb4Unorm, 4, 3),
            (Rgb5Unorm, 5, 3),
            (Rgb10Unorm, 10, 3),
            (Rgb12Unorm, 12, 3),
            (Rgba2Unorm, 2, 4),
            (Rgba12Unorm, 12, 4),
        ] {
            let largest = (1u32 << bits) - 1;
            for (channel, code, rest) in
                (0..channels).flat_map(|c| (0..=largest).flat_map(move |code| [(c, code, 0.0), (c, code, 1.0)]))
            {
                let mut color = Vec4::splat(rest);
                color[channel] = code as f32 / largest as f32;
                let mut bytes = [0xee; 16];
                format.write(color, &mut bytes);
                assert_eq!(bytes[format.bytes()], 0xee);
                let expected = if channels == 3 { color.with_w(1.0) } else { color };
                assert_eq!(format.read(&bytes), expected, "{format:?}");
            }
        }
    }

    /// The nearest code is chosen: for each pair of neighbouring codes, what lies below the middle goes down and what
    /// lies above up.
    #[test]
    fn the_nearest_code_is_chosen() {
        for &(format, mantissa) in
            &[(Format::R16Float, 10), (Format::R8Unorm, 0), (Format::R16Unorm, 0), (Format::R8Snorm, 0)]
        {
            let largest = if mantissa > 0 {
                0x7bff
            } else {
                (1u32 << (format.bits()[0] - u8::from(format.numeric() == Numeric::Snorm))) - 1
            };
            for code in 0..largest {
                let value = |code: u32| f64::from(format.decode(u128::from(code)).x);
                let middle = 0.5 * (value(code) + value(code + 1));
                let step = (value(code + 1) - value(code)) * 0.05;
                assert_eq!(format.encode(Vec4::splat((middle - step) as f32)), u128::from(code), "{format:?}");
                assert_eq!(format.encode(Vec4::splat((middle + step) as f32)), u128::from(code + 1), "{format:?}");
            }
        }
    }

    #[test]
    fn levels_are_shares_of_255() {
        for level in 0..=255u8 {
            let share = Vec4::splat(f32::from(level) / 255.0);
            assert_eq!(decode_rgba8([level; 4]), share);
            assert_eq!(encode_rgba8(share), [level; 4]);
        }
        let odd = Vec4::new(f32::NAN, f32::INFINITY, -1.0, 0.5019);
        assert_eq!(encode_rgba8(odd), [0, 255, 0, 128]);
    }

    #[test]
    fn quick_ways_give_the_bits_of_the_general_one() {
        let mut bytes = [0; 16];
        for i in 0..=2000 {
            let x = i as f32 / 1000.0 - 0.5;
            let color = Vec4::new(x, 1.0 - x, 0.5 * x, 0.25);
            for format in [Format::Rgba8Unorm, Format::Rgba32Float, Format::R32Float] {
                format.write(color, &mut bytes);
                let bytes_used = format.bytes();
                let general = format.encode(color);
                for b in 0..bytes_used {
                    // Halfway between two codes either is nearest.
                    let level = color[b % 4] * 255.0;
                    let tie = format == Format::Rgba8Unorm && (level - level.floor() - 0.5).abs() < 1e-4;
                    let difference = i32::from(bytes[b]) - i32::from(general.to_le_bytes()[b]);
                    assert!(difference.abs() <= i32::from(tie), "{format:?} {color}");
                }
                let mut padded = [0; 16];
                padded[..bytes_used].copy_from_slice(&bytes[..bytes_used]);
                assert_eq!(format.read(&bytes), format.decode(u128::from_le_bytes(padded)));
            }
        }
    }

    #[test]
    fn packed_formats_lie_as_in_opengl() {
        let red = Vec4::new(1.0, 0.0, 0.0, 0.0);
        assert_eq!(Format::Rgb565Unorm.encode(red), 0xf800);
        assert_eq!(Format::Rgba4Unorm.encode(red), 0xf000);
        assert_eq!(Format::Rgb5A1Unorm.encode(red.with_w(1.0)), 0xf801);
        assert_eq!(Format::Rgb332Unorm.encode(red), 0xe0);
        assert_eq!((Format::Rgb4Unorm.encode(red), Format::Rgb4Unorm.bytes()), (0xf00, 2));
        assert_eq!((Format::Rgb5Unorm.encode(red), Format::Rgb5Unorm.bytes()), (0x7c00, 2));
        assert_eq!((Format::Rgba2Unorm.encode(red.with_w(1.0)), Format::Rgba2Unorm.bytes()), (0xc3, 1));
        assert_eq!((Format::Rgb10Unorm.encode(Vec4::X), Format::Rgb10Unorm.bytes()), (0x3ff, 4));
        assert_eq!((Format::Rgb12Unorm.encode(Vec4::Z), Format::Rgb12Unorm.bytes()), (0xf_ff00_0000, 5));
        assert_eq!((Format::Rgba12Unorm.encode(Vec4::W), Format::Rgba12Unorm.bytes()), (0xfff0_0000_0000, 6));
        assert_eq!(Format::Rgb10A2Unorm.encode(red.with_w(1.0)), 0xc000_03ff);
        assert_eq!(Format::Bgra8Unorm.encode(red.with_w(1.0)), 0xffff_0000);
        assert_eq!(Format::Rg11B10Float.encode(Vec4::ONE), 0x3c0 | 0x3c0 << 11 | 0x1e0 << 22);
        assert_eq!(Format::Depth24Stencil8.encode(Vec4::new(1.0, f32::from_bits(7), 0.0, 0.0)), 0x07ff_ffff);
    }

    /// Values beyond the range of a format are clamped, and NaN becomes zero in formats without it.
    #[test]
    fn values_beyond_are_clamped() {
        for &format in Format::ALL {
            for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -5.0, 1e30, f32::MIN_POSITIVE] {
                let color = format.decode(format.encode(Vec4::splat(x)));
                if matches!(format.numeric(), Numeric::Unorm | Numeric::Snorm | Numeric::Srgb | Numeric::SharedExponent)
                {
                    assert!(color.is_finite(), "{format:?} {x} {color}");
                }
            }
        }
        let bits = |x: i32| f32::from_bits(x.cast_unsigned());
        assert_eq!(
            Format::R8Sint.decode(Format::R8Sint.encode(Vec4::splat(bits(-1000)))).x.to_bits().cast_signed(),
            -128
        );
        assert_eq!(Format::R8Uint.decode(Format::R8Uint.encode(Vec4::splat(bits(1000)))).x.to_bits(), 255);
    }
}

//! Transfer functions: how stored values stand for linear ones (IEC 61966-2-1 for sRGB).

use std::sync::OnceLock;

/// Encoding of a file's colour samples, relative to linear values. Alpha is linear always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    /// The piecewise sRGB curve.
    Srgb,
    /// Stored values are linear.
    Linear,
    /// linear = stored^γ.
    Gamma(f32),
}

impl Encoding {
    /// The linear value of a stored one.
    #[inline]
    pub fn decode(self, stored: f32) -> f32 {
        match self {
            Self::Srgb => srgb_decode(stored),
            Self::Linear => stored,
            Self::Gamma(gamma) => signed_power(stored, gamma),
        }
    }

    /// The stored value of a linear one.
    #[inline]
    pub fn encode(self, linear: f32) -> f32 {
        match self {
            Self::Srgb => srgb_encode(linear),
            Self::Linear => linear,
            Self::Gamma(gamma) => signed_power(linear, 1.0 / gamma),
        }
    }

    /// The linear values of all 256 8-bit codes.
    pub fn table8(self) -> [f32; 256] {
        match self {
            Self::Srgb => *srgb_table(),
            _ => std::array::from_fn(|code| self.decode(code as f32 / 255.0)),
        }
    }
}

/// Powers that keep the sign, so that a stray negative value does not become NaN.
#[inline]
fn signed_power(x: f32, exponent: f32) -> f32 {
    x.abs().powf(exponent).copysign(x)
}

/// sRGB-encodes a linear value; exact piecewise curve, odd extension below zero, no clamping above one.
#[inline]
pub fn srgb_encode(linear: f32) -> f32 {
    let x = linear.abs();
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    encoded.copysign(linear)
}

/// The linear value of an sRGB-encoded one; exact piecewise curve, odd extension below zero, no clamping above one.
#[inline]
pub fn srgb_decode(encoded: f32) -> f32 {
    let x = encoded.abs();
    let linear = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
    linear.copysign(encoded)
}

/// The linear value of an 8-bit sRGB code.
#[inline]
pub fn srgb8_decode(code: u8) -> f32 {
    srgb_table()[usize::from(code)]
}

/// The nearest 8-bit sRGB code of a linear value, clamped to [0, 1]; NaN gives 0.
#[inline]
pub fn srgb8_encode(linear: f32) -> u8 {
    quantize8(srgb_encode(linear))
}

/// Rounds a display value in [0, 1] to 8 bits; values outside are clamped, NaN gives 0.
#[inline]
pub fn quantize8(display: f32) -> u8 {
    (display.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Rounds a display value in [0, 1] to 16 bits; values outside are clamped, NaN gives 0.
#[inline]
pub fn quantize16(display: f32) -> u16 {
    (f64::from(display.clamp(0.0, 1.0)) * 65535.0 + 0.5) as u16
}

fn srgb_table() -> &'static [f32; 256] {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    TABLE.get_or_init(|| std::array::from_fn(|code| srgb_decode(code as f32 / 255.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_values() {
        assert!((srgb_encode(0.5) - 0.735_357).abs() < 1e-6);
        assert!((srgb_encode(0.18) - 0.461_356).abs() < 1e-6);
        assert!((srgb_decode(188.0 / 255.0) - 0.502_886).abs() < 1e-5);
    }

    #[test]
    fn every_8_bit_code_survives() {
        for code in 0..=255u8 {
            assert_eq!(srgb8_encode(srgb8_decode(code)), code);
            let gamma = Encoding::Gamma(2.2);
            assert_eq!(quantize8(gamma.encode(gamma.table8()[usize::from(code)])), code);
        }
    }

    #[test]
    fn curve_is_monotone_and_inverse() {
        let mut last = -1.0;
        for i in 0..=100_000 {
            let x = i as f32 / 50_000.0;
            let y = srgb_encode(x);
            assert!(y > last, "at {x}");
            assert!((srgb_decode(y) - x).abs() < 1e-5);
            last = y;
        }
        assert_eq!(srgb_encode(-0.5), -srgb_encode(0.5));
    }

    #[test]
    fn quantizing_strange_values() {
        assert_eq!((quantize8(f32::NAN), quantize8(f32::INFINITY), quantize8(-1.0)), (0, 255, 0));
        assert_eq!((quantize16(f32::NAN), quantize16(f32::INFINITY), quantize16(0.5)), (0, 65535, 32768));
    }
}

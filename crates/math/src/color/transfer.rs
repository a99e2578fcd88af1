//! The sRGB transfer function (IEC 61966-2-1): linear light ↔ encoded values, both in [0, 1].
//!
//! Two segments: a line near black, then `1.055 v^(1/2.4) − 0.055`. Values outside [0, 1] follow the same curves
//! (negative ones the line), so that a round trip is the identity; clamping is the business of whoever quantises.

/// Encodes linear light.
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Decodes to linear light.
pub fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear light as an encoded byte, clamped to [0, 1] and rounded; NaN gives 0.
pub fn srgb_encode_u8(linear: f32) -> u8 {
    // `as` saturates and maps NaN to zero.
    (srgb_encode(linear.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8
}

/// The linear light of an encoded byte.
pub fn srgb_decode_u8(encoded: u8) -> f32 {
    srgb_decode(f32::from(encoded) / 255.0)
}

/// The linear light of each of the 256 encoded bytes, for decoding images.
pub fn srgb_decode_table() -> [f32; 256] {
    std::array::from_fn(|i| srgb_decode(i as f32 / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert!((srgb_encode(0.5) - 0.735357).abs() < 1e-6);
        assert!((srgb_encode(0.18) - 0.461356).abs() < 1e-6);
        assert_eq!((srgb_encode(0.0), srgb_decode(0.0)), (0.0, 0.0));
        assert!((srgb_encode(1.0) - 1.0).abs() < 1e-6 && (srgb_decode(1.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn bytes_survive_a_round_trip() {
        for b in 0..=255u8 {
            assert_eq!(srgb_encode_u8(srgb_decode_u8(b)), b);
            assert_eq!(srgb_decode_table()[b as usize], srgb_decode_u8(b));
        }
        assert_eq!([-1.0, 2.0, f32::NAN].map(srgb_encode_u8), [0, 255, 0]);
    }

    #[test]
    fn floats_survive_a_round_trip_on_both_segments() {
        for i in -100..3000 {
            let v = i as f32 * 0.001;
            assert!((srgb_decode(srgb_encode(v)) - v).abs() < 1e-6 * v.abs().max(1.0), "{v}");
        }
    }
}

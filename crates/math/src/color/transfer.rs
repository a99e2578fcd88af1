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
            let linear = srgb_decode(f32::from(b) / 255.0);
            assert_eq!((srgb_encode(linear) * 255.0).round(), f32::from(b));
        }
    }

    #[test]
    fn floats_survive_a_round_trip_on_both_segments() {
        for i in -100..3000 {
            let v = i as f32 * 0.001;
            assert!((srgb_decode(srgb_encode(v)) - v).abs() < 1e-6 * v.abs().max(1.0), "{v}");
        }
    }
}

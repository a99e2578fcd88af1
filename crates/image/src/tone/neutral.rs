//! Khronos PBR Neutral tone mapper (specification of 2024): base colours under grey light come out as they went in;
//! only highlights are compressed and, the brighter the more, desaturated.

use super::Curve;
use crate::encoding::srgb_encode;

/// Value at which compression starts.
const START: f32 = 0.8 - 0.04;
/// Speed of the desaturation.
const DESATURATION: f32 = 0.15;

pub(super) const PBR_NEUTRAL: Curve = Curve {
    name: "pbr-neutral",
    doc: "Khronos PBR Neutral: true base colours, compressed highlights",
    encoding: "sRGB",
    parameters: &[],
    map: |rgb, _| neutral(rgb).map(|v| srgb_encode(v.clamp(0.0, 1.0))),
};

fn neutral(rgb: [f32; 3]) -> [f32; 3] {
    // Take off the 4 % that a dielectric's Fresnel reflection adds; less near black.
    let least = rgb[0].min(rgb[1]).min(rgb[2]);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let colour = rgb.map(|v| v - offset);
    let peak = colour[0].max(colour[1]).max(colour[2]);
    if peak < START {
        return colour;
    }
    let d = 1.0 - START;
    let compressed = 1.0 - d * d / (peak + d - START);
    let mix = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    colour.map(|v| v * (compressed / peak) * (1.0 - mix) + compressed * mix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_colours_stay_and_highlights_bleach() {
        // Base colour plus the 4 % reflection comes out as the base colour.
        let out = neutral([0.54, 0.24, 0.14]);
        assert!(out.iter().zip([0.5, 0.2, 0.1]).all(|(a, b)| (a - b).abs() < 1e-6), "{out:?}");
        let bright = neutral([1000.0, 0.0, 0.0]);
        assert!(bright[0] < 1.0 && bright[1] > 0.9, "{bright:?}");
    }

    #[test]
    fn compression_is_continuous() {
        let (below, above) = (neutral([START + 0.04 - 1e-5; 3])[0], neutral([START + 0.04 + 1e-5; 3])[0]);
        assert!((below - above).abs() < 1e-4);
    }
}

//! Plain sRGB, and curves with a shoulder that are a formula or two.

use super::{Curve, Parameter, luminance};
use crate::encoding::srgb_encode;

/// Identity, for data and tests: no curve at all.
pub(super) const NONE: Curve = Curve {
    name: "none",
    doc: "sRGB encoding, cut at 1",
    encoding: "sRGB",
    parameters: &[],
    map: |rgb, _| rgb.map(|v| srgb_encode(v.min(1.0))),
};

/// E. Reinhard et al., "Photographic Tone Reproduction for Digital Images" (2002), eq. 4, on luminance; the key is the
/// exposure.
pub(super) const REINHARD: Curve = Curve {
    name: "reinhard",
    doc: "luminance L(1 + L/white²)/(1 + L) (Reinhard et al. 2002, eq. 4)",
    encoding: "sRGB",
    parameters: &[Parameter {
        name: "white",
        doc: "smallest luminance that becomes 1, above 0; 1e9 for the curve without white point (eq. 3)",
        default: 4.0,
        range: [1e-3, 1e9],
    }],
    map: |rgb, settings| {
        let l = luminance(rgb);
        let white = settings.values[0];
        let scale = (1.0 + l / (white * white)) / (1.0 + l);
        rgb.map(|v| srgb_encode((v * scale).min(1.0)))
    },
};

/// K. Narkowicz, "ACES Filmic Tone Mapping Curve" (2016): a rational fit of the ACES RRT and sRGB ODT for greys, used
/// per channel.
pub(super) const ACES_FIT: Curve = Curve {
    name: "aces-fit",
    doc: "rational fit of the ACES film curve (Narkowicz 2016), per channel; exposure −0.74 EV gives ACES' own brightness",
    encoding: "sRGB",
    parameters: &[],
    map: |rgb, _| {
        rgb.map(|x| {
            // Above 1e4 the fraction is constant to seven digits, and its squares stay small.
            let x = x.min(1e4);
            srgb_encode(((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0))
        })
    },
};

/// J. Hable, "Filmic Tonemapping Operators" (2010), the curve of Uncharted 2, with its exposure bias of 2.
pub(super) const HABLE: Curve = Curve {
    name: "hable",
    doc: "the film curve of Uncharted 2 (Hable 2010), per channel",
    encoding: "sRGB",
    parameters: &[Parameter {
        name: "white",
        doc: "curve input that becomes 1 (radiance is doubled before), above 0",
        default: 11.2,
        range: [0.1, 1e4],
    }],
    map: |rgb, settings| {
        let curve = |x: f32| {
            let (a, b, c, d, e, f) = (0.15, 0.50, 0.10, 0.20, 0.02, 0.30);
            (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f
        };
        let scale = 1.0 / curve(settings.values[0]);
        rgb.map(|v| srgb_encode((curve((2.0 * v).min(1e6)) * scale).clamp(0.0, 1.0)))
    },
};

#[cfg(test)]
mod tests {
    use crate::encoding::srgb_decode;
    use crate::tone::Tone;

    fn linear(text: &str, rgb: [f32; 3]) -> [f32; 3] {
        Tone::parse(text).unwrap().mapper(1.0)(rgb).map(srgb_decode)
    }

    #[test]
    fn values_from_the_formulae() {
        let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a} {b}");
        close(linear("none", [0.18; 3])[0], 0.18);
        close(linear("reinhard:white=1e9", [1.0; 3])[0], 0.5);
        close(linear("reinhard", [4.0; 3])[0], 1.0);
        close(linear("aces-fit", [1.0; 3])[0], 2.54 / 3.16);
        close(linear("hable", [5.6; 3])[0], 1.0);
    }

    #[test]
    fn reinhard_keeps_ratios_of_components() {
        let [r, g, b] = linear("reinhard:white=100", [0.8, 0.4, 0.2]);
        assert!((r / g - 2.0).abs() < 1e-4 && (g / b - 2.0).abs() < 1e-4);
    }
}

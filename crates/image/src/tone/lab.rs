//! The curves of the path tracing lab: clamping, equalisation (division by the picture's maximum) and a pure power law.

use super::{Curve, Parameter, Settings};

const GAMMA_PARAMETER: Parameter =
    Parameter { name: "gamma", doc: "exponent γ of the display, 0.1 to 10", default: 2.2, range: [0.1, 10.0] };

/// Values up to 1 as they are.
pub(super) const CLAMP: Curve = Curve {
    name: "clamp",
    doc: "v / max, cut at 1; the lab's clamping, not encoded",
    encoding: "none: values are proportional to radiance",
    parameters: &[Parameter { name: "max", doc: "radiance that becomes 1, above 0", default: 1.0, range: [1e-9, 1e9] }],
    map: |rgb, settings| rgb.map(|v| (v / settings.values[0]).min(1.0)),
};

/// The largest value of the picture becomes 1.
pub(super) const EQUALIZE: Curve = Curve {
    name: "equalize",
    doc: "v / the picture's maximum; the lab's equalisation, not encoded",
    encoding: "none: values are proportional to radiance",
    parameters: &[],
    map: |rgb, settings| rgb.map(|v| v / settings.maximum),
};

/// Clamp at 1, then the power law.
pub(super) const GAMMA: Curve = Curve {
    name: "gamma",
    doc: "v^(1/γ), cut at 1",
    encoding: "power law with γ",
    parameters: &[GAMMA_PARAMETER],
    map: |rgb, settings| rgb.map(|v| v.min(1.0).powf(1.0 / settings.values[0])),
};

/// Clamp at a chosen value, then the power law.
pub(super) const CLAMP_GAMMA: Curve = Curve {
    name: "clamp-gamma",
    doc: "(v / max)^(1/γ), cut at 1",
    encoding: "power law with γ",
    parameters: &[
        GAMMA_PARAMETER,
        Parameter { name: "max", doc: "radiance that becomes 1, above 0", default: 1.0, range: [1e-9, 1e9] },
    ],
    map: |rgb, settings: &Settings| rgb.map(|v| (v / settings.values[1]).min(1.0).powf(1.0 / settings.values[0])),
};

/// Equalisation, then the power law.
pub(super) const EQUALIZE_GAMMA: Curve = Curve {
    name: "equalize-gamma",
    doc: "(v / the picture's maximum)^(1/γ)",
    encoding: "power law with γ",
    parameters: &[GAMMA_PARAMETER],
    map: |rgb, settings| rgb.map(|v| (v / settings.maximum).min(1.0).powf(1.0 / settings.values[0])),
};

#[cfg(test)]
mod tests {
    use crate::tone::Tone;

    #[test]
    fn the_labs_results() {
        let apply = |text: &str, v: f32| Tone::parse(text).unwrap().mapper(8.0)([v; 3])[0];
        assert_eq!(apply("clamp", 2.0), 1.0);
        assert_eq!(apply("clamp:max=4", 2.0), 0.5);
        assert_eq!(apply("equalize", 2.0), 0.25);
        assert!((apply("gamma", 0.5) - 0.5f32.powf(1.0 / 2.2)).abs() < 1e-6);
        assert!((apply("clamp-gamma:max=4", 1.0) - 0.25f32.powf(1.0 / 2.2)).abs() < 1e-6);
        assert!((apply("equalize-gamma:gamma=2", 2.0) - 0.5).abs() < 1e-6);
    }
}

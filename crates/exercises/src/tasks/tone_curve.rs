//! From radiance to the display: luminance, a tone curve, sRGB.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::grid,
};
use steradian_image::{encoding, tone::Tone};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "tone-curve",
    chapter: 5,
    title: "From radiance to the display: luminance, Reinhard's curve, sRGB's transfer curve",
    functions: &[
        Function {
            name: "luminance",
            inputs: &["rgb[3]"],
            outputs: &["Y"],
            reference: Some(|p| weighed(p, [0.2126, 0.7152, 0.0722])),
            points: || grid(&[&[1.0, 0.2, 0.0], &[0.5, 0.0, 2.0], &[0.1, 1.0, 0.0]]),
        },
        Function {
            name: "reinhard",
            inputs: &["luminance", "white"],
            outputs: &["L"],
            reference: Some(reinhard),
            points: || grid(&[&[1.0, 0.5, 0.18, 2.0, 0.0, 1.5], &[4.0, 2.0, 8.0]]),
        },
        Function {
            name: "encode",
            inputs: &["linear"],
            outputs: &["encoded"],
            reference: Some(|p| vec![encoding::srgb_encode(p[0] as f32).into()]),
            points: || {
                grid(&[&[
                    0.5, 0.18, 0.0, 1.0, 0.001, 0.002, 0.003, 0.0035, 0.005, 0.008, 0.01, 0.02, 0.03, 0.05, 0.1, 0.8,
                ]])
            },
        },
        Function {
            name: "decode",
            inputs: &["encoded"],
            outputs: &["linear"],
            reference: Some(|p| vec![encoding::srgb_decode(p[0] as f32).into()]),
            points: || grid(&[&[0.5, 0.7, 0.0, 1.0, 0.005, 0.01, 0.02, 0.03, 0.039, 0.05, 0.1, 0.2, 0.3, 0.9]]),
        },
    ],
    tolerance: Tolerance::SINGLE,
    mistakes: &[
        Mistake::values(
            "luminance",
            "luma",
            "0.299, 0.587 and 0.114 are for encoded values of old television; of \
        linear sRGB luminance has others.",
            |p| weighed(p, [0.299, 0.587, 0.114]),
        ),
        Mistake::values(
            "luminance",
            "mean",
            "The eye does not see the three primaries equally \
        bright.",
            |p| weighed(p, [1.0 / 3.0; 3]),
        ),
        Mistake::values(
            "luminance",
            "bgr",
            "It looks as if red and blue were \
        exchanged.",
            |p| weighed(p, [0.0722, 0.7152, 0.2126]),
        ),
        Mistake::values(
            "reinhard",
            "no-white",
            "This is the curve without a white point, L/(1 + L): it never \
        reaches 1.",
            |p| vec![p[0] / (1.0 + p[0])],
        ),
        Mistake::values("reinhard", "white-once", "The white point stands squared: L = white must give 1.", |p| {
            vec![p[0] * (1.0 + p[0] / p[1]) / (1.0 + p[0])]
        }),
        Mistake::values(
            "encode",
            "gamma",
            "This is a plain power, 1/2.2; sRGB has a line near black and a power \
        1/2.4 with an offset.",
            |p| vec![p[0].powf(1.0 / 2.2)],
        ),
        Mistake::values(
            "encode",
            "no-line",
            "Right for bright values. Near black the curve is a line, or its slope \
        would be infinite.",
            |p| vec![1.055 * p[0].powf(1.0 / 2.4) - 0.055],
        ),
        Mistake::values(
            "encode",
            "threshold",
            "The border of the line is 0.0031308 for linear values; 0.04045 is \
        the same point among encoded ones.",
            |p| vec![if p[0] <= 0.04045 { 12.92 * p[0] } else { 1.055 * p[0].powf(1.0 / 2.4) - 0.055 }],
        ),
        Mistake::values(
            "encode",
            "no-offset",
            "The power is scaled by 1.055 and 0.055 is taken away; otherwise \
        line and power do not meet.",
            |p| vec![if p[0] <= 0.0031308 { 12.92 * p[0] } else { p[0].powf(1.0 / 2.4) }],
        ),
        Mistake::values(
            "encode",
            "decodes",
            "This is the inverse: it makes values darker, and encoding makes them \
        brighter.",
            |p| vec![encoding::srgb_decode(p[0] as f32).into()],
        ),
        Mistake::values(
            "decode",
            "decode-gamma",
            "This is a plain power, 2.2; sRGB has a line near black and a \
        power 2.4 with an offset.",
            |p| vec![p[0].powf(2.2)],
        ),
        Mistake::values(
            "decode",
            "decode-no-line",
            "Right for bright values. Near black the curve is a \
        line.",
            |p| vec![((p[0] + 0.055) / 1.055).powf(2.4)],
        ),
        Mistake::values(
            "decode",
            "decode-threshold",
            "The border of the line is 0.04045 for encoded values; \
        0.0031308 is the same point among linear ones.",
            |p| vec![if p[0] <= 0.0031308 { p[0] / 12.92 } else { ((p[0] + 0.055) / 1.055).powf(2.4) }],
        ),
        Mistake::values(
            "decode",
            "encodes",
            "This is the inverse: it makes values brighter, and decoding makes \
        them darker.",
            |p| vec![encoding::srgb_encode(p[0] as f32).into()],
        ),
    ],
    laws: &[],
    texts: texts!("tone-curve"),
};

fn weighed(p: &[f64], weights: [f64; 3]) -> Vec<f64> {
    vec![p.iter().zip(weights).map(|(c, w)| c * w).sum()]
}

/// The project's curve, without its encoding.
fn reinhard(p: &[f64]) -> Vec<f64> {
    let tone = Tone::parse(&format!("reinhard:white={}", p[1]));
    vec![tone.map_or(f64::NAN, |tone| encoding::srgb_decode(tone.mapper(1.0)([p[0] as f32; 3])[0]).into())]
}

//! Shadow maps: bias, comparison, percentage-closer filtering, penumbra.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::{Random, grid},
};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "shadow-bias",
    chapter: 12,
    title: "Shadow maps: a bias by the slope, a filtered comparison, the width of a penumbra",
    functions: &[
        Function {
            name: "bias",
            inputs: &["texel", "cosine", "most"],
            outputs: &["bias"],
            reference: Some(|p| vec![0.5 * p[0] * (sine(p[1]) / p[1]).min(p[2])]),
            points: || grid(&[&[0.1, 0.02, 1.0], &[0.6, 0.8, 1.0, 0.3, 0.1, 0.02], &[10.0, 3.0]]),
        },
        Function {
            name: "lit",
            inputs: &["depth", "bias", "map[9]"],
            outputs: &["part"],
            reference: Some(|p| share(p, |depth, bias, map| depth - bias <= map)),
            points: || {
                let mut random = Random::new(131);
                let alike = [2.0, 0.5, 1.5, 1.5, 1.0, 1.5, 2.0, 1.5, 1.25, 1.5, 1.75];
                // Depths that are equal are exact.
                let equal = (0..8).map(|i| alike.map(|x| x * f64::from(i + 1)).to_vec());
                let random = (0..50).map(|_| {
                    let map = [0; 9].map(|_| random.between(1.0, 3.0));
                    [&[random.between(1.5, 2.5), random.between(0.2, 0.5)][..], &map].concat()
                });
                equal.chain(random).collect()
            },
        },
        Function {
            name: "penumbra",
            inputs: &["lamp", "blocker", "receiver"],
            outputs: &["width"],
            reference: Some(|p| vec![p[0] * (p[2] - p[1]) / p[1]]),
            points: || grid(&[&[0.5, 1.0, 0.2], &[1.0, 2.0, 2.5], &[4.0, 3.0, 10.0]]),
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "bias",
            "tangent-of-cosine",
            "The tangent is taken of the cosine, which is no angle; θ is the angle of which it is the cosine.",
            |p| vec![0.5 * p[0] * p[1].tan().min(p[2])],
        ),
        Mistake::values(
            "bias",
            "sine",
            "Depth changes by the tangent of the angle along the map, not by the \
        sine.",
            |p| vec![0.5 * p[0] * sine(p[1]).min(p[2])],
        ),
        Mistake::values(
            "bias",
            "cotangent",
            "The tangent is sin/cos: this is the cotangent, greatest where none is \
        needed.",
            |p| vec![0.5 * p[0] * if p[1] < 1.0 { (p[1] / sine(p[1])).min(p[2]) } else { p[2] }],
        ),
        Mistake::values(
            "bias",
            "whole-texel",
            "A point is half a texel away from the texel's middle at \
        most.",
            |p| vec![p[0] * (sine(p[1]) / p[1]).min(p[2])],
        ),
        Mistake::values(
            "bias",
            "unlimited",
            "Towards grazing light the tangent grows without limit, and shadows \
        detach: it is at most `most`.",
            |p| vec![0.5 * p[0] * sine(p[1]) / p[1]],
        ),
        Mistake::values(
            "lit",
            "wrong-side",
            "The bias moves the receiver towards the light: it is subtracted from \
        its depth.",
            |p| share(p, |depth, bias, map| depth + bias <= map),
        ),
        Mistake::values(
            "lit",
            "strictly-nearer",
            "A point at the very depth of the map is lit: at most, not less than.",
            |p| share(p, |depth, bias, map| depth - bias < map),
        ),
        Mistake::values(
            "lit",
            "no-bias",
            "The bias is not used: surfaces shadow \
        themselves.",
            |p| share(p, |depth, _, map| depth <= map),
        ),
        Mistake::values(
            "lit",
            "shadowed-part",
            "This is the part in shadow; the lit part is asked \
        for.",
            |p| share(p, |depth, bias, map| depth - bias > map),
        ),
        Mistake::values(
            "lit",
            "mean-depth",
            "Each depth is compared, and the answers are averaged. A mean of \
        depths is the depth of nothing.",
            |p| {
                let mean = p[2..].iter().sum::<f64>() / 9.0;
                vec![f64::from(u8::from(p[0] - p[1] <= mean))]
            },
        ),
        Mistake::values(
            "lit",
            "middle-only",
            "Only the texel in the middle is compared; the part of all nine is \
        asked for.",
            |p| vec![f64::from(u8::from(p[0] - p[1] <= p[6]))],
        ),
        Mistake::values(
            "penumbra",
            "over-receiver",
            "Similar triangles have their tip at the blocker: the distance \
        from the lamp to the blocker stands below.",
            |p| vec![p[0] * (p[2] - p[1]) / p[2]],
        ),
        Mistake::values(
            "penumbra",
            "no-difference",
            "At the blocker itself the penumbra has no width: only what \
        lies behind it counts.",
            |p| vec![p[0] * p[2] / p[1]],
        ),
        Mistake::values(
            "penumbra",
            "turned",
            "The ratio is upside down: the nearer the blocker is to the lamp, the \
        wider is the penumbra.",
            |p| vec![p[0] * p[1] / (p[2] - p[1])],
        ),
    ],
    laws: &[],
    texts: texts!("shadow-bias"),
};

fn sine(cosine: f64) -> f64 {
    (1.0 - cosine * cosine).sqrt()
}

/// The part of nine texels for which a comparison holds.
fn share(p: &[f64], is_lit: fn(f64, f64, f64) -> bool) -> Vec<f64> {
    vec![p[2..].iter().filter(|map| is_lit(p[0], p[1], **map)).count() as f64 / 9.0]
}

//! Levels of a mip-map.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::{Random, grid},
};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "mip-level",
    chapter: 11,
    title: "The level of a mip-map for a pixel's footprint, and a value between two levels",
    functions: &[
        Function {
            name: "level",
            inputs: &["dx[2]", "dy[2]", "width", "height", "count"],
            outputs: &["level"],
            reference: Some(|p| clamped(p, lengths(p).iter().copied().fold(0.0, f64::max).log2())),
            points: || {
                let mut random = Random::new(121);
                let simple = vec![4.0 / 256.0, 0.0, 0.0, 1.0 / 64.0, 256.0, 128.0, 9.0];
                let mut one = |i: usize| {
                    let scale = [0.02, 0.05, 0.001, 0.6][i % 4];
                    let d: Vec<f64> = (0..4).map(|_| random.between(-scale, scale)).collect();
                    let (w, h) = ([256.0, 1024.0, 64.0][i % 3], [128.0, 1024.0, 256.0][i % 3]);
                    [&d[..], &[w, h, [9.0, 11.0, 5.0][i % 3]]].concat()
                };
                std::iter::once(simple).chain((0..60).map(&mut one)).collect()
            },
        },
        Function {
            name: "blend",
            inputs: &["level", "values[4]"],
            outputs: &["value"],
            reference: Some(|p| between(p, |t| t)),
            points: || {
                let levels = [0.25, 1.5, 2.75, 0.0, 1.0, 2.9, 3.0, 0.6];
                grid(&[&levels, &[0.2, 1.0], &[0.5], &[0.9, 0.1], &[0.3]])
            },
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "level",
            "shorter",
            "The longer of both steps decides, or far textures flicker; this is the \
        shorter one.",
            |p| clamped(p, lengths(p).iter().copied().fold(f64::INFINITY, f64::min).log2()),
        ),
        Mistake::values(
            "level",
            "no-texels",
            "Lengths must be counted in texels: u in widths, v in heights of the \
        picture.",
            |p| {
                let longest = f64::max(p[0].hypot(p[1]), p[2].hypot(p[3]));
                clamped(p, longest.log2())
            },
        ),
        Mistake::values("level", "width-only", "v is counted in heights of the picture, not in widths.", |p| {
            let longest = f64::max(p[0].hypot(p[1]), p[2].hypot(p[3]));
            clamped(p, (p[4] * longest).log2())
        }),
        Mistake::values("level", "natural", "A level halves the size, so the logarithm is to the base 2.", |p| {
            clamped(p, lengths(p).iter().copied().fold(0.0, f64::max).ln())
        }),
        Mistake::values(
            "level",
            "one-direction",
            "Only the step to the right is looked at; the one downwards may \
        be longer.",
            |p| clamped(p, lengths(p)[0].log2()),
        ),
        Mistake::values(
            "level",
            "area",
            "This is by the footprint's area, and blurs too little what is seen at a \
        slant: the longer step is asked for.",
            |p| {
                let area = (p[4] * p[5] * (p[0] * p[3] - p[1] * p[2])).abs();
                clamped(p, 0.5 * area.log2())
            },
        ),
        Mistake::values(
            "level",
            "unclamped",
            "There is no level below 0 and none from `count` on: the result is \
        clamped.",
            |p| vec![lengths(p).iter().copied().fold(0.0, f64::max).log2()],
        ),
        Mistake::values(
            "level",
            "rounded",
            "A level with its fraction is asked for; both neighbours are blended by \
        it.",
            |p| {
                let level = lengths(p).iter().copied().fold(0.0, f64::max).log2();
                clamped(p, level.floor())
            },
        ),
        Mistake::values("blend", "finer", "This is the finer of the two levels alone.", |p| between(p, |_| 0.0)),
        Mistake::values(
            "blend",
            "nearest",
            "This is the nearest level; the two neighbours are to be \
        blended.",
            |p| between(p, f64::round),
        ),
        Mistake::values(
            "blend",
            "turned-weights",
            "The fraction is the weight of the coarser level; it looks as if \
        the weights were exchanged.",
            |p| between(p, |t| if t > 0.0 { 1.0 - t } else { 0.0 }),
        ),
        Mistake::values(
            "blend",
            "coarser",
            "This is the coarser of the two levels \
        alone.",
            |p| between(p, f64::ceil),
        ),
    ],
    laws: &[],
    texts: texts!("mip-level"),
};

/// Lengths of both steps in texels.
fn lengths(p: &[f64]) -> [f64; 2] {
    [0, 2].map(|i| (p[i] * p[4]).hypot(p[i + 1] * p[5]))
}

fn clamped(p: &[f64], level: f64) -> Vec<f64> {
    vec![level.clamp(0.0, p[6] - 1.0)]
}

/// The value between two levels, by a function of the fraction.
fn between(p: &[f64], weight: fn(f64) -> f64) -> Vec<f64> {
    let first = p[0].floor();
    let value = |i: f64| p[1 + (i.min(3.0)) as usize];
    let t = weight(p[0] - first);
    vec![(1.0 - t) * value(first) + t * value(first + 1.0)]
}

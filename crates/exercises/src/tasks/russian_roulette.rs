//! Russian roulette: ends paths, keeps means.

use crate::{
    exercise::{Exercise, Function, Law, Mistake, Tolerance, texts},
    laws::{SAMPLES, mean},
    points::{Random, grid},
};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "russian-roulette",
    chapter: 2,
    title: "Russian roulette: paths end by chance, and nothing is missing in the mean",
    functions: &[
        Function {
            name: "survive",
            inputs: &["beta", "u"],
            outputs: &["beta"],
            reference: Some(survive),
            points: || grid(&[&[0.5, 0.2, 0.8, 0.95, 0.05, 1.0, 1.5, 3.0], &[0.1, 0.3, 0.7, 0.9, 0.0, 0.5, 0.99]]),
        },
        Function {
            name: "radiance",
            inputs: &["emission", "albedo", "u[20]"],
            outputs: &["L"],
            reference: Some(radiance),
            points: || {
                let mut random = Random::new(41);
                (0..60).map(|i| walk(1.0 + (i % 3) as f64, [0.5, 0.8, 0.3][i % 3], &mut random)).collect()
            },
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "survive",
            "no-division",
            "What survives must count for more, by 1 over the probability of survival, or light is lost.",
            |p| vec![if p[1] < chance(p[0]) { p[0] } else { 0.0 }],
        ),
        Mistake::values(
            "survive",
            "other-way",
            "A path survives with probability s, that is, if u < s; here it is the other way round.",
            |p| vec![if p[1] >= chance(p[0]) { p[0] / chance(p[0]) } else { 0.0 }],
        ),
        Mistake::values(
            "survive",
            "divided-by-death",
            "What survives is divided by the probability of that, s, not by 1 − s.",
            |p| {
                let s = chance(p[0]);
                vec![if p[1] >= s {
                    0.0
                } else if s == 1.0 {
                    p[0]
                } else {
                    p[0] / (1.0 - s)
                }]
            },
        ),
        Mistake::values(
            "survive",
            "no-death",
            "Every path goes on: with probability 1 − s it must end, with β = 0.",
            |p| vec![p[0] / chance(p[0])],
        ),
        Mistake::values(
            "survive",
            "beyond-one",
            "Right where β is below 1. A probability is at most 1: s = min(1, β), and β above 1 stays as it is.",
            |p| vec![if p[1] < p[0] { 1.0 } else { 0.0 }],
        ),
        Mistake::values("survive", "half", "It looks as if s were ½ for all β; s = min(1, β) is asked for.", |p| {
            vec![if p[1] < 0.5 { 2.0 * p[0] } else { 0.0 }]
        }),
        Mistake::values(
            "radiance",
            "beta-falls",
            "β is multiplied by the albedo and divided by s = albedo, so it stays 1; here it falls from bounce to \
            bounce.",
            |p| {
                let falling = (0..alive(p)).map(|k| p[1].powi(k as i32));
                vec![p[0] * falling.sum::<f64>()]
            },
        ),
        Mistake::values(
            "radiance",
            "without-first",
            "The wall that the ray meets first shines, too: its emission counts before the first roulette.",
            |p| vec![p[0] * (alive(p) - 1) as f64],
        ),
        Mistake::values(
            "radiance",
            "last-only",
            "Each wall on the way adds its emission; here it seems to be that of the last one alone, or of the \
            first.",
            |p| vec![p[0]],
        ),
        Mistake::values(
            "radiance",
            "other-chance",
            "A path goes on if u < albedo, and it looks as if it went on otherwise.",
            |p| {
                let mirrored: Vec<f64> = p.iter().enumerate().map(|(i, u)| if i < 2 { *u } else { -u }).collect();
                let ends = mirrored[2..].iter().position(|u| -u < p[1]).unwrap_or(20);
                vec![p[0] * (ends + 1) as f64]
            },
        ),
    ],
    laws: &[
        Law {
            name: "mean of β",
            functions: &["survive"],
            questions: || {
                let mut random = Random::new(42);
                (0..SAMPLES).map(|_| ("survive", vec![0.3, random.unit()])).collect()
            },
            judge: |exercise, answers| mean(exercise, "survive", 0.3, answers),
        },
        Law {
            name: "mean radiance E/(1 − albedo)",
            functions: &["radiance"],
            questions: || {
                let mut random = Random::new(43);
                (0..SAMPLES).map(|_| ("radiance", walk(1.0, 0.5, &mut random))).collect()
            },
            // A walk longer than 20 has the probability 10⁻⁶.
            judge: |exercise, answers| mean(exercise, "radiance", 2.0, answers),
        },
    ],
    texts: texts!("russian-roulette"),
};

fn chance(beta: f64) -> f64 {
    beta.min(1.0)
}

fn survive(p: &[f64]) -> Vec<f64> {
    vec![if p[1] < chance(p[0]) { p[0] / chance(p[0]) } else { 0.0 }]
}

fn walk(emission: f64, albedo: f64, random: &mut Random) -> Vec<f64> {
    let u = [0; 20].map(|_| random.unit());
    [&[emission, albedo][..], &u].concat()
}

/// Walls that a path meets.
fn alive(p: &[f64]) -> usize {
    1 + p[2..].iter().position(|u| *u >= p[1]).unwrap_or(20)
}

fn radiance(p: &[f64]) -> Vec<f64> {
    vec![p[0] * alive(p) as f64]
}

//! Multiple importance sampling of two strategies.

use crate::{
    exercise::{Exercise, Finding, Function, Law, Mistake, Tolerance, texts},
    laws::{SAMPLES, mean},
    points::{Random, grid},
};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "mis",
    chapter: 2,
    title: "Multiple importance sampling: the power heuristic, and an estimate by two strategies",
    functions: &[
        Function {
            name: "weight",
            inputs: &["p", "other"],
            outputs: &["w"],
            reference: Some(|p| vec![weight(p[0], p[1])]),
            points: || grid(&[&[3.0, 1.0, 0.5, 10.0, 0.2, 0.0], &[1.0, 0.5, 2.0, 0.0, 30.0, 0.1]]),
        },
        Function {
            name: "estimate",
            inputs: &["fa", "pa_a", "pb_a", "fb", "pa_b", "pb_b"],
            outputs: &["I"],
            reference: Some(|p| by(p, weight)),
            points: || {
                let mut random = Random::new(61);
                let simple = vec![1.0, 2.0, 1.0, 1.0, 0.5, 4.0];
                std::iter::once(simple)
                    .chain((0..50).map(|i| {
                        let mut p: Vec<f64> = (0..6).map(|_| random.between(0.1, 4.0)).collect();
                        if i % 8 == 7 {
                            p[2] = 0.0;
                        }
                        p
                    }))
                    .collect()
            },
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "weight",
            "balance",
            "This is the balance heuristic, without squares; the power heuristic is asked for.",
            |p| vec![ratio(p[0], p[0] + p[1])],
        ),
        Mistake::values(
            "weight",
            "swapped",
            "The weight is the other strategy's: that of the strategy that drew the point stands above the line.",
            |p| vec![if p[0] == 0.0 && p[1] == 0.0 { 0.0 } else { weight(p[1], p[0]) }],
        ),
        Mistake::values("weight", "half", "Both strategies count the same here; their densities must decide.", |p| {
            vec![if p[0] + p[1] > 0.0 { 0.5 } else { 0.0 }]
        }),
        Mistake::values(
            "weight",
            "square-of-sum",
            "Below the line stands the sum of the squares, not the square of the sum: weights must add up to 1.",
            |p| vec![ratio(p[0] * p[0], (p[0] + p[1]).powi(2))],
        ),
        Mistake::values(
            "estimate",
            "no-weights",
            "Both estimates are added without weights: each is right by itself, and together they count twice.",
            |p| by(p, |_, _| 1.0),
        ),
        Mistake::values(
            "estimate",
            "mean",
            "This is the mean of both estimates. It is right in the mean, and as noisy as the worse; weights are \
            asked for.",
            |p| by(p, |_, _| 0.5),
        ),
        Mistake::values(
            "estimate",
            "balance-weights",
            "The weights are those of the balance heuristic; the power heuristic is asked for.",
            |p| by(p, |a, b| ratio(a, a + b)),
        ),
        Mistake::values("estimate", "swapped-weights", "Each estimate has the other one's weight.", |p| {
            by(p, |a, b| weight(b, a))
        }),
        Mistake::values(
            "estimate",
            "b-as-a",
            "The second point is weighted as if a had drawn it: b did, and its density comes first there.",
            |p| vec![weight(p[1], p[2]) * ratio(p[0], p[1]) + weight(p[4], p[5]) * ratio(p[3], p[5])],
        ),
        Mistake::values(
            "estimate",
            "wrong-density",
            "A value is divided by the density of the strategy that drew it, not by the other one.",
            |p| vec![weight(p[1], p[2]) * ratio(p[0], p[2]) + weight(p[5], p[4]) * ratio(p[3], p[4])],
        ),
        Mistake::values(
            "estimate",
            "no-division",
            "The values are weighted, and not divided by their densities.",
            |p| vec![weight(p[1], p[2]) * p[0] + weight(p[5], p[4]) * p[3]],
        ),
    ],
    laws: &[
        Law {
            name: "weights add up to 1",
            functions: &["weight"],
            questions: || {
                let mut random = Random::new(62);
                let both = (0..50).map(move |_| [random.between(0.0, 5.0), random.between(0.1, 5.0)]);
                both.flat_map(|[a, b]| [vec![a, b], vec![b, a]]).map(|p| ("weight", p)).collect()
            },
            judge: |_, answers| {
                let sums = answers.chunks(2).map(|pair| pair.iter().flatten().sum::<f64>());
                let off = sums.map(|s| (s - 1.0).abs()).fold(0.0, f64::max);
                Finding {
                    holds: off < 1e-6,
                    text: format!("sums of both weights differ from 1 by {off:.1e} at most"),
                    mistake: None,
                }
            },
        },
        Law {
            name: "mean of estimates of ∫ x² dx over [0, 1]",
            functions: &["estimate"],
            questions: || {
                let mut random = Random::new(63);
                // Strategies 1 and 2x.
                (0..SAMPLES)
                    .map(|_| {
                        let (a, b) = (random.unit(), (1.0 - random.unit()).sqrt());
                        ("estimate", vec![a * a, 1.0, 2.0 * a, b * b, 1.0, 2.0 * b])
                    })
                    .collect()
            },
            judge: |exercise, answers| mean(exercise, "estimate", 1.0 / 3.0, answers),
        },
    ],
    texts: texts!("mis"),
};

fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

fn weight(p: f64, other: f64) -> f64 {
    ratio(p * p, p * p + other * other)
}

/// The estimate of two samples by a heuristic.
fn by(p: &[f64], weight: fn(f64, f64) -> f64) -> Vec<f64> {
    vec![weight(p[1], p[2]) * ratio(p[0], p[1]) + weight(p[5], p[4]) * ratio(p[3], p[5])]
}

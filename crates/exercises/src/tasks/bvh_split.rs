//! The surface area heuristic.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::{Random, vector},
};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "bvh-split",
    chapter: 13,
    title: "The surface area heuristic: cost of a split, and the best one",
    functions: &[
        Function {
            name: "area",
            inputs: &["lo[3]", "hi[3]"],
            outputs: &["A"],
            reference: Some(|p| vec![2.0 * half_area(p)]),
            points: || {
                let mut random = Random::new(151);
                let simple = vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0];
                std::iter::once(simple)
                    .chain((0..20).map(|_| {
                        let lo = [0; 3].map(|_| random.between(-2.0, 2.0));
                        [lo, lo.map(|x| x + random.between(0.0, 3.0))].concat()
                    }))
                    .collect()
            },
        },
        Function {
            name: "cost",
            inputs: &["area", "left_area", "left_count", "right_area", "right_count", "step", "test"],
            outputs: &["C"],
            reference: Some(|p| vec![p[5] + p[6] * (p[1] * p[2] + p[3] * p[4]) / p[0]]),
            points: || {
                let mut random = Random::new(152);
                let mut count = |n: f64| random.between(1.0, n).floor();
                let counts: Vec<[f64; 2]> = (0..31).map(|_| [count(20.0), count(30.0)]).collect();
                let of = |c: [f64; 2]| {
                    let area = random.between(5.0, 20.0);
                    let (l, r) = (area * random.between(0.2, 0.9), area * random.between(0.2, 0.9));
                    vec![area, l, c[0], r, c[1], random.between(0.5, 2.0), random.between(0.5, 3.0)]
                };
                std::iter::once(vec![10.0, 6.0, 3.0, 5.0, 8.0, 1.0, 2.0]).chain(counts.into_iter().map(of)).collect()
            },
        },
        Function {
            name: "best",
            inputs: &["left_areas[5]", "right_areas[5]"],
            outputs: &["k"],
            reference: Some(|p| least(p, |l, k, r| l * k + r * (6.0 - k))),
            points: || {
                let mut random = Random::new(153);
                (0..60)
                    .map(|_| {
                        // Boxes grow with what they hold.
                        let mut grown = || {
                            let mut area = random.between(1.0, 4.0);
                            [0; 5].map(|_| {
                                area += random.between(0.0, 3.0) * random.unit();
                                area
                            })
                        };
                        let (left, mut right) = (grown(), grown());
                        right.reverse();
                        [left, right].concat()
                    })
                    .collect()
            },
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "area",
            "three-faces",
            "A box has six faces, in pairs; these are \
        three.",
            |p| vec![half_area(p)],
        ),
        Mistake::values(
            "area",
            "volume",
            "This is the volume. The chance of a ray to meet a convex body goes with \
        its surface.",
            |p| {
                let d = size(p);
                vec![d[0] * d[1] * d[2]]
            },
        ),
        Mistake::values(
            "area",
            "edges",
            "This is the sum of the edges; faces are products of two of \
        them.",
            |p| vec![2.0 * size(p).iter().sum::<f64>()],
        ),
        Mistake::values(
            "cost",
            "no-division",
            "A child is met with the probability of its area over the parent's: \
        the division is missing.",
            |p| vec![p[5] + p[6] * (p[1] * p[2] + p[3] * p[4])],
        ),
        Mistake::values(
            "cost",
            "no-step",
            "The step down into the node costs, \
        too.",
            |p| vec![p[6] * (p[1] * p[2] + p[3] * p[4]) / p[0]],
        ),
        Mistake::values(
            "cost",
            "counts-swapped",
            "Each child's count belongs to its own \
        area.",
            |p| vec![p[5] + p[6] * (p[1] * p[4] + p[3] * p[2]) / p[0]],
        ),
        Mistake::values(
            "cost",
            "no-areas",
            "This is the cost without areas, as if every ray met both \
        children.",
            |p| vec![p[5] + p[6] * (p[2] + p[4])],
        ),
        Mistake::values(
            "cost",
            "step-times",
            "The step and the tests have costs of their own; here both are \
        multiplied by one.",
            |p| vec![p[5] * (p[1] * p[2] + p[3] * p[4]) / p[0] + p[6]],
        ),
        Mistake::values(
            "best",
            "from-zero",
            "k is the number of primitives on the left, 1 to 5; it looks like an \
        index from 0.",
            |p| vec![least(p, |l, k, r| l * k + r * (6.0 - k))[0] - 1.0],
        ),
        Mistake::values("best", "middle", "This is the middle always; the least cost is asked for.", |_| vec![3.0]),
        Mistake::values(
            "best",
            "areas-alone",
            "Areas alone are compared; each counts as often as its box has \
        primitives.",
            |p| least(p, |l, _, r| l + r),
        ),
        Mistake::values(
            "best",
            "most",
            "This is the split of the greatest \
        cost.",
            |p| least(p, |l, k, r| -(l * k + r * (6.0 - k))),
        ),
        Mistake::values(
            "best",
            "best-swapped",
            "The left box has k primitives and the right one 6 − k; here it is \
        the other way round.",
            |p| least(p, |l, k, r| l * (6.0 - k) + r * k),
        ),
    ],
    laws: &[],
    texts: texts!("bvh-split"),
};

fn size(p: &[f64]) -> [f64; 3] {
    let (lo, hi) = (vector(p, 0), vector(p, 3));
    [0, 1, 2].map(|k| hi[k] - lo[k])
}

fn half_area(p: &[f64]) -> f64 {
    let [x, y, z] = size(p);
    x * y + y * z + z * x
}

/// The number of primitives on the left for which a cost is least.
fn least(p: &[f64], cost: fn(f64, f64, f64) -> f64) -> Vec<f64> {
    let of = |k: usize| cost(p[k - 1], k as f64, p[k + 4]);
    let best = (2..6).fold(1, |best, k| if of(k) < of(best) { k } else { best });
    vec![best as f64]
}

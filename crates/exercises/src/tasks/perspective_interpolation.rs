//! Interpolation in perspective.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::{Random, grid, vector},
};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "perspective-interpolation",
    chapter: 10,
    title: "Interpolation and depth in perspective",
    functions: &[
        Function {
            name: "interpolate",
            inputs: &["b[3]", "a[3]", "w[3]"],
            outputs: &["a"],
            reference: Some(|p| by(p, |w| 1.0 / w)),
            points: || {
                let mut random = Random::new(111);
                let mut one = |_| {
                    let (u, v) = (random.unit(), random.unit());
                    let b = [1.0 - u, u * (1.0 - v), u * v];
                    let a = [0; 3].map(|_| random.between(-2.0, 3.0));
                    let w = [0; 3].map(|_| random.between(0.5, 6.0));
                    [b, a, w].concat()
                };
                let wall = vec![0.5, 0.5, 0.0, 0.0, 1.0, 0.0, 1.0, 3.0, 1.0];
                std::iter::once(wall).chain((0..40).map(&mut one)).collect()
            },
        },
        Function {
            name: "depth",
            inputs: &["distance", "near", "far"],
            outputs: &["d"],
            reference: Some(|p| vec![p[2] * (p[0] - p[1]) / (p[0] * (p[2] - p[1]))]),
            points: || grid(&[&[2.0, 1.0, 5.0, 10.0, 3.0], &[1.0, 0.1, 0.5], &[10.0, 100.0, 1000.0]]),
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "interpolate",
            "linear",
            "Weights on the screen are not those on the surface: near corners \
        must count more, by 1/w.",
            |p| by(p, |_| 1.0),
        ),
        Mistake::values("interpolate", "not-divided", "The sum of b a/w must be divided by the sum of b/w.", |p| {
            let (b, a, w) = (vector(p, 0), vector(p, 3), vector(p, 6));
            vec![(0..3).map(|i| b[i] * a[i] / w[i]).sum()]
        }),
        Mistake::values(
            "interpolate",
            "times-w",
            "Corners are weighted by w; far ones count less, not \
        more.",
            |p| by(p, |w| w),
        ),
        Mistake::values(
            "interpolate",
            "times-mean-w",
            "The sum of b a/w is multiplied by the mean of w; it must be \
        divided by the sum of b/w.",
            |p| {
                let (b, a, w) = (vector(p, 0), vector(p, 3), vector(p, 6));
                let mean: f64 = (0..3).map(|i| b[i] * w[i]).sum();
                vec![(0..3).map(|i| b[i] * a[i] / w[i]).sum::<f64>() * mean]
            },
        ),
        Mistake::values(
            "interpolate",
            "squared",
            "Corners are weighted by 1/w², and 1/w is \
        right.",
            |p| by(p, |w| 1.0 / (w * w)),
        ),
        Mistake::values(
            "depth",
            "depth-linear",
            "This is linear in the distance. Depth after the division is \
        linear in 1/Z, which is what the screen interpolates.",
            |p| vec![(p[0] - p[1]) / (p[2] - p[1])],
        ),
        Mistake::values(
            "depth",
            "depth-opengl",
            "This is OpenGL's depth from −1 to 1; from 0 to 1 is asked \
        for.",
            |p| vec![(p[2] + p[1]) / (p[2] - p[1]) - 2.0 * p[2] * p[1] / (p[0] * (p[2] - p[1]))],
        ),
        Mistake::values("depth", "depth-reversed", "This is reversed depth, 1 at the near plane.", |p| {
            vec![p[1] * (p[2] - p[0]) / (p[0] * (p[2] - p[1]))]
        }),
        Mistake::values(
            "depth",
            "depth-no-far",
            "The factor far is missing: at the far plane depth is \
        1.",
            |p| vec![(p[0] - p[1]) / (p[0] * (p[2] - p[1]))],
        ),
    ],
    laws: &[],
    texts: texts!("perspective-interpolation"),
};

/// The mean of attributes by weights of corners.
fn by(p: &[f64], weight: fn(f64) -> f64) -> Vec<f64> {
    let (b, a, w) = (vector(p, 0), vector(p, 3), vector(p, 6));
    let sum: f64 = (0..3).map(|i| b[i] * weight(w[i])).sum();
    vec![(0..3).map(|i| b[i] * a[i] * weight(w[i])).sum::<f64>() / sum]
}

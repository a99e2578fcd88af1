//! Form factors and a step of radiosity.

use crate::{
    exercise::{Exercise, Function, Law, Mistake, Tolerance, texts},
    laws::{SAMPLES, mean},
    points::{Random, dot, grid, vector},
};
use std::f64::consts::PI;

pub(super) static EXERCISE: Exercise = Exercise {
    name: "form-factor",
    chapter: 8,
    title: "Form factors: the kernel, reciprocity, a step of Jacobi's iteration",
    functions: &[
        Function {
            name: "kernel",
            inputs: &["x[3]", "nx[3]", "y[3]", "ny[3]"],
            outputs: &["K"],
            reference: Some(|p| with(p, |x, y, r| x.max(0.0) * y.max(0.0) / (PI * r * r))),
            points: || {
                let mut random = Random::new(81);
                let simple = vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, -1.0];
                let mut one = |i: usize| {
                    let (x, y) = (random.around(), random.around().map(|c| 2.0 * c));
                    let (mut nx, mut ny) = (random.around(), random.around());
                    let d = [0, 1, 2].map(|k| y[k] - x[k]);
                    // Half of the pairs see each other.
                    if i % 4 < 2 && dot(nx, d) < 0.0 {
                        nx = nx.map(|c| -c);
                    }
                    if i % 4 < 2 && dot(ny, d) > 0.0 {
                        ny = ny.map(|c| -c);
                    }
                    [x, nx, y, ny].concat()
                };
                std::iter::once(simple).chain((0..80).map(&mut one)).collect()
            },
        },
        Function {
            name: "reverse",
            inputs: &["f_ij", "area_i", "area_j"],
            outputs: &["f_ji"],
            reference: Some(|p| vec![p[0] * p[1] / p[2]]),
            points: || grid(&[&[0.2, 0.5, 0.01], &[1.0, 2.0, 0.1], &[4.0, 0.5, 10.0]]),
        },
        Function {
            name: "step",
            inputs: &["emission", "albedo", "f[4]", "b[4]"],
            outputs: &["b"],
            reference: Some(|p| vec![p[0] + p[1] * gathered(p)]),
            points: || {
                let mut random = Random::new(82);
                let mut one = |_| {
                    let f = [0; 4].map(|_| random.between(0.0, 0.25));
                    let b = [0; 4].map(|_| random.between(0.5, 4.0));
                    [&[random.between(0.2, 1.0), random.between(0.2, 0.9)][..], &f, &b].concat()
                };
                let simple = vec![1.0, 0.5, 0.2, 0.2, 0.2, 0.2, 1.0, 2.0, 3.0, 4.0];
                std::iter::once(simple).chain((0..30).map(&mut one)).collect()
            },
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "kernel",
            "no-pi",
            "With π below the line rows of form factors add up to 1; without it to \
        π.",
            |p| with(p, |x, y, r| x.max(0.0) * y.max(0.0) / (r * r)),
        ),
        Mistake::values(
            "kernel",
            "unclamped",
            "Two negative cosines make a positive product: both must be clamped \
        at 0.",
            |p| with(p, |x, y, r| x * y / (PI * r * r)),
        ),
        Mistake::values(
            "kernel",
            "absolute",
            "Patches behind each other's backs exchange nothing: cosines are \
        clamped, not made positive.",
            |p| with(p, |x, y, r| (x * y).abs() / (PI * r * r)),
        ),
        Mistake::values("kernel", "distance-once", "The kernel falls with the square of the distance.", |p| {
            with(p, |x, y, r| x.max(0.0) * y.max(0.0) / (PI * r))
        }),
        Mistake::values(
            "kernel",
            "distance-fourth",
            "The direction is not of unit length: products with y − x have \
        the distance in them twice.",
            |p| with(p, |x, y, _| x.max(0.0) * y.max(0.0) / PI),
        ),
        Mistake::values("kernel", "one-cosine", "There are two cosines, one at each end.", |p| {
            with(p, |x, y, r| if y > 0.0 { x.max(0.0) / (PI * r * r) } else { 0.0 })
        }),
        Mistake::values("reverse", "symmetric", "F itself is not symmetric: A_i F_ij = A_j F_ji.", |p| vec![p[0]]),
        Mistake::values(
            "reverse",
            "areas-swapped",
            "The small patch sends much of its light to the large one, and \
        gets little: are the areas exchanged?",
            |p| vec![p[0] * p[2] / p[1]],
        ),
        Mistake::values(
            "step",
            "no-emission",
            "What leaves a patch is what it emits, \
        too.",
            |p| vec![p[1] * gathered(p)],
        ),
        Mistake::values(
            "step",
            "over-pi",
            "F has its π already, and the albedo stands without \
        one.",
            |p| vec![p[0] + p[1] / PI * gathered(p)],
        ),
        Mistake::values(
            "step",
            "no-albedo",
            "Of what arrives the part `albedo` is \
        reflected.",
            |p| vec![p[0] + gathered(p)],
        ),
        Mistake::values(
            "step",
            "emission-reflected",
            "The albedo belongs to what arrives, not to the \
        emission.",
            |p| vec![p[1] * (p[0] + gathered(p))],
        ),
    ],
    laws: &[Law {
        name: "mean of the kernel: the form factor of two unit squares at distance 1",
        functions: &["kernel"],
        questions: || {
            let mut random = Random::new(83);
            let mut square = |z: f64| [random.unit(), random.unit(), z];
            (0..SAMPLES)
                .map(|_| ("kernel", [square(0.0), [0.0, 0.0, 1.0], square(1.0), [0.0, 0.0, -1.0]].concat()))
                .collect()
        },
        // Howell, Catalog of Radiation Heat Transfer Configuration Factors, C-11.
        judge: |exercise, answers| mean(exercise, "kernel", 0.199_824_896, answers),
    }],
    texts: texts!("form-factor"),
};

/// A function of both cosines and the distance.
fn with(p: &[f64], kernel: fn(f64, f64, f64) -> f64) -> Vec<f64> {
    let (x, y) = (vector(p, 0), vector(p, 6));
    let d = [0, 1, 2].map(|k| y[k] - x[k]);
    let r = dot(d, d).sqrt();
    vec![kernel(dot(vector(p, 3), d) / r, -dot(vector(p, 9), d) / r, r)]
}

fn gathered(p: &[f64]) -> f64 {
    (2..6).map(|i| p[i] * p[i + 4]).sum()
}

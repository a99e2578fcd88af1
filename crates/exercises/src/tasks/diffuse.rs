//! A matt surface: value, sampling, density.

use crate::{
    exercise::{Exercise, Function, Law, Mistake, Tolerance, texts},
    laws::{cosine, density, energy, even, follows, over_hemisphere, reciprocity, samples},
    points::{Random, direction, pairs},
};
use std::f64::consts::{PI, TAU};
use steradian_math::warp::cosine_hemisphere_pdf;

pub(super) static EXERCISE: Exercise = Exercise {
    name: "diffuse",
    chapter: 7,
    title: "A matt surface: value, sampling by the cosine, density",
    functions: &[
        Function {
            name: "eval",
            inputs: &["albedo", "wo[3]", "wi[3]"],
            outputs: &["f"],
            reference: Some(eval),
            points: || pairs(1, 40).iter().enumerate().map(|(i, p)| with(ALBEDOS[i % 4], *p)).collect(),
        },
        Function {
            name: "sample",
            inputs: &["u1", "u2"],
            outputs: &["x", "y", "z"],
            reference: None,
            points: || {
                let mut random = Random::new(3);
                let edges = [[0.0, 0.0], [0.0, 0.5], [0.5, 0.0], [0.5, 0.5]].map(Vec::from);
                edges.into_iter().chain((0..20).map(|_| vec![random.unit(), random.unit()])).collect()
            },
        },
        Function {
            name: "pdf",
            inputs: &["wi[3]"],
            outputs: &["pdf"],
            reference: Some(|p| vec![cosine_hemisphere_pdf(p[2].max(0.0) as f32).into()]),
            points: || {
                let mut random = Random::new(2);
                let chosen = [60.0, 0.0, 45.0, 80.0, 120.0, 170.0].map(|angle| direction(angle, 30.0).to_vec());
                chosen.into_iter().chain((0..30).map(|_| random.around().to_vec())).collect()
            },
        },
    ],
    tolerance: Tolerance::SINGLE,
    mistakes: &[
        Mistake::values(
            "eval",
            "no-pi",
            "The albedo is the integral of f cosθ over the hemisphere, and ∫ cosθ dω is not 1.",
            |p| scaled(p, PI),
        ),
        Mistake::values("eval", "half", "The projected solid angle of the hemisphere is π, not 2π.", |p| {
            scaled(p, 0.5)
        }),
        Mistake::values(
            "eval",
            "with-cosine",
            "f does not depend on the directions; the cosine belongs to the equation around it.",
            |p| scaled(p, p[6]),
        ),
        Mistake::values(
            "eval",
            "below",
            "It is right above the surface. What does a matt surface reflect if a direction is below?",
            |p| vec![p[0] / PI],
        ),
        Mistake::density(
            "sample",
            "even-directions",
            "The directions are even over the hemisphere, with density 1/2π; those near the normal must be more.",
            even,
        ),
        Mistake::density(
            "sample",
            "even-angles",
            "θ is drawn evenly, which crowds directions at the normal: the density is 1/(π² sin θ).",
            |w| {
                let sine = (1.0 - w[2] * w[2]).max(1e-12).sqrt();
                if w[2] > 0.0 { 1.0 / (PI * PI * sine) } else { 0.0 }
            },
        ),
        Mistake::density(
            "sample",
            "whole-sphere",
            "The directions fill the whole sphere; light is reflected only above the surface, z ≥ 0.",
            |_| 0.5 / TAU,
        ),
        Mistake::density(
            "sample",
            "squared-cosine",
            "The density is 3 cos²θ/2π: is a root taken once too rarely or too often?",
            |w| 1.5 * w[2].max(0.0).powi(2) / PI,
        ),
        Mistake::values(
            "pdf",
            "pdf-even",
            "This is the density of even directions, 1/2π; the samples follow the cosine.",
            |p| vec![even([p[0], p[1], p[2]])],
        ),
        Mistake::values(
            "pdf",
            "pdf-no-pi",
            "The integral of a density over all directions is 1, and that of cosθ is not.",
            |p| vec![p[2].max(0.0)],
        ),
        Mistake::values(
            "pdf",
            "pdf-below",
            "Right above the surface; no samples lie below it, so the density there is not negative or positive but \
            …",
            |p| vec![p[2] / PI],
        ),
        Mistake::values("pdf", "pdf-absolute", "Right above the surface. How many samples lie below it?", |p| {
            vec![p[2].abs() / PI]
        }),
    ],
    laws: &[
        Law {
            name: "reciprocity",
            functions: &["eval"],
            questions: || {
                let both = pairs(4, 20).into_iter().flat_map(|[a, b]| [[a, b], [b, a]]);
                both.map(|p| ("eval", with(0.5, p))).collect()
            },
            judge: |_, answers| reciprocity(answers),
        },
        Law {
            name: "energy",
            functions: &["eval"],
            questions: || over_hemisphere("eval", |w| with(0.9, [direction(40.0, 10.0), w])),
            judge: |_, answers| energy(answers),
        },
        Law {
            name: "density",
            functions: &["pdf"],
            questions: || over_hemisphere("pdf", |w| w.to_vec()),
            judge: |_, answers| density(answers),
        },
        Law {
            name: "samples",
            functions: &["sample"],
            questions: || samples("sample", &[]),
            judge: |exercise, answers| follows(exercise, "sample", cosine, answers),
        },
    ],
    texts: texts!("diffuse"),
};

const ALBEDOS: [f64; 4] = [0.5, 0.8, 1.0, 0.1];

fn with(albedo: f64, [wo, wi]: [[f64; 3]; 2]) -> Vec<f64> {
    [&[albedo][..], &wo, &wi].concat()
}

fn eval(p: &[f64]) -> Vec<f64> {
    vec![if p[3] > 0.0 && p[6] > 0.0 { p[0] / PI } else { 0.0 }]
}

fn scaled(p: &[f64], factor: f64) -> Vec<f64> {
    vec![factor * eval(p)[0]]
}

//! Reflectance of glass.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::grid,
};
use steradian_bsdf::fresnel;

/// The only function.
const F: &str = "reflectance";

pub(super) static EXERCISE: Exercise = Exercise {
    name: "fresnel",
    chapter: 3,
    title: "Reflectance of glass, with total internal reflection",
    functions: &[Function {
        name: "reflectance",
        inputs: &["cos_i", "eta"],
        outputs: &["F"],
        reference: Some(reference),
        points: || {
            grid(&[&[0.5, 1.0, 0.8, 0.3, 0.1, 0.02, 0.6, 0.7, 0.9, 0.97], &[1.5, 1.33, 2.4, 1.1, 0.66, 0.75, 0.4]])
        },
    }],
    tolerance: Tolerance::SINGLE,
    mistakes: &[
        Mistake::values(
            F,
            "perpendicular-only",
            "These are the values of r_s² alone. Unpolarised light has two parts.",
            |p| of(p, |s, _| s * s),
        ),
        Mistake::values(
            F,
            "parallel-only",
            "These are the values of r_p² alone. Unpolarised light has two parts.",
            |p| of(p, |_, q| q * q),
        ),
        Mistake::values(F, "not-squared", "r_s and r_p are ratios of amplitudes. What is the ratio of powers?", |p| {
            of(p, |s, q| 0.5 * (s.abs() + q.abs()))
        }),
        Mistake::values(F, "sum", "Each of the two polarisations has half of the light: is the mean taken?", |p| {
            of(p, |s, q| s * s + q * q)
        }),
        Mistake::values(
            F,
            "inverted-index",
            "Snell's law is used with the inverse index: η is n_t/n_i, and sin θ_t = sin θ_i/η.",
            |p| vec![fresnel::dielectric(p[0] as f32, 1.0 / p[1] as f32).into()],
        ),
        Mistake::values(
            F,
            "no-total-reflection",
            "Beyond the critical angle nothing is refracted. What is reflected then?",
            |p| {
                let f = reference(p)[0];
                vec![if f == 1.0 { 0.0 } else { f }]
            },
        ),
        Mistake::values(F, "schlick", "This is Schlick's approximation; the exact equations are asked for.", |p| {
            let f0 = ((p[1] - 1.0) / (p[1] + 1.0)).powi(2);
            vec![f0 + (1.0 - f0) * (1.0 - p[0]).powi(5)]
        }),
        Mistake::values(
            F,
            "cosine-for-sine",
            "Snell's law is about sines: it looks as if cos θ_t were cos θ_i/η.",
            |p| {
                let (c, eta) = (p[0], p[1]);
                let t = c / eta;
                let (s, q) = ((c - eta * t) / (c + eta * t), (eta * c - t) / (eta * c + t));
                vec![0.5 * (s * s + q * q)]
            },
        ),
    ],
    laws: &[],
    texts: texts!("fresnel"),
};

fn reference(p: &[f64]) -> Vec<f64> {
    vec![fresnel::dielectric(p[0] as f32, p[1] as f32).into()]
}

/// A function of both amplitudes; 1 under total reflection.
fn of(p: &[f64], f: fn(f64, f64) -> f64) -> Vec<f64> {
    let amplitudes = fresnel::dielectric_amplitudes(p[0] as f32, p[1] as f32);
    vec![amplitudes.map_or(1.0, |a| f(a.s.into(), a.p.into()))]
}

//! Phong's lobe: mirror direction, value, sampling, density.

use crate::{
    exercise::{Exercise, Function, Law, Mistake, Tolerance, texts},
    laws::{density, energy, follows, lobe, over_hemisphere, reciprocity, samples},
    points::{Random, direction, dot, pairs, vector},
};
use std::f64::consts::TAU;
use steradian_bsdf::{Bsdf, Phong, TransportMode};
use steradian_math::{Spectrum, Vec3};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "phong",
    chapter: 7,
    title: "Phong's lobe as a BRDF: mirror direction, value, sampling, density",
    functions: &[
        Function {
            name: "mirror",
            inputs: &["w[3]"],
            outputs: &["x", "y", "z"],
            reference: Some(|p| mirror(vector(p, 0)).to_vec()),
            points: || pairs(5, 10).iter().map(|p| p[1].to_vec()).collect(),
        },
        Function {
            name: "eval",
            inputs: &["ks", "n", "wo[3]", "wi[3]"],
            outputs: &["f"],
            reference: Some(eval),
            points: || {
                let wide = [(70.0, 0.0, 70.0, 0.0), (80.0, 10.0, 60.0, 0.0), (75.0, 90.0, 80.0, 80.0)];
                let wide = wide.map(|(a, b, c, d)| [direction(a, b), direction(c, d)]);
                let all = pairs(6, 40).into_iter().chain(wide.into_iter().cycle().take(12));
                all.enumerate()
                    .map(|(i, p)| with([0.5, 1.0, 0.3][i % 3], [2.0, 20.0, 3.0, 6.0, 80.0][i % 5], p))
                    .collect()
            },
        },
        Function {
            name: "sample",
            inputs: &["n", "wo[3]", "u1", "u2"],
            outputs: &["x", "y", "z"],
            reference: None,
            points: || {
                let mut random = Random::new(7);
                let wo = |i: usize| {
                    if i.is_multiple_of(4) { [0.0, 0.0, 1.0] } else { direction(20.0 * (i % 5) as f64, 77.0) }
                };
                (0..24).map(|i| [&[20.0][..], &wo(i), &[random.unit(), random.unit()]].concat()).collect()
            },
        },
        Function {
            name: "pdf",
            inputs: &["n", "wo[3]", "wi[3]"],
            outputs: &["pdf"],
            reference: Some(pdf),
            points: || {
                let exponent = |i: usize| [4.0, 20.0, 2.0, 7.0][i % 4];
                pairs(8, 20).into_iter().enumerate().map(|(i, [a, b])| [&[exponent(i)][..], &a, &b].concat()).collect()
            },
        },
    ],
    tolerance: Tolerance::SINGLE,
    mistakes: &[
        Mistake::values(
            "mirror",
            "mirror-sign",
            "The direction points into the surface: this form is for rays that travel towards it. Here w points \
            away.",
            |p| mirror(vector(p, 0)).map(|x| -x).to_vec(),
        ),
        Mistake::values(
            "mirror",
            "no-two",
            "(n·w) n − w lies in the plane of the surface; the projection is needed twice.",
            |p| vec![-p[0], -p[1], 0.0],
        ),
        Mistake::values(
            "eval",
            "no-norm",
            "The lobe must be normalised: without (n + 2)/2π a narrow one reflects hardly anything.",
            |p| vec![eval(p)[0] * TAU / (p[1] + 2.0)],
        ),
        Mistake::values(
            "eval",
            "plus-one",
            "(n + 1)/2π normalises a density; the BRDF is multiplied with another cosine.",
            |p| vec![eval(p)[0] * (p[1] + 1.0) / (p[1] + 2.0)],
        ),
        Mistake::values(
            "eval",
            "unclamped",
            "A negative cosine of the lobe must count as 0 before the power, or there is a second highlight \
            opposite.",
            |p| {
                let c = dot(mirror(vector(p, 5)), vector(p, 2)).powi(p[1] as i32);
                vec![if is_above(p) { p[0] * (p[1] + 2.0) / TAU * c } else { 0.0 }]
            },
        ),
        Mistake::values(
            "eval",
            "over-cosine",
            "Phong of 1975 divided by cosθ_i is neither reciprocal nor bounded; f has no division.",
            |p| vec![if is_above(p) { eval(p)[0] / p[7] } else { 0.0 }],
        ),
        Mistake::values(
            "eval",
            "with-cosine",
            "f without the cosine is asked for: that one belongs to the equation around it.",
            |p| vec![eval(p)[0] * p[7]],
        ),
        Mistake::values(
            "eval",
            "half-vector",
            "This is Blinn's cosine n·h; Phong's lobe is around the mirror direction.",
            |p| {
                let (o, i) = (vector(p, 2), vector(p, 5));
                let h = [0, 1, 2].map(|k| o[k] + i[k]);
                let c = h[2] / dot(h, h).sqrt();
                vec![if is_above(p) { p[0] * (p[1] + 2.0) / TAU * c.powf(p[1]) } else { 0.0 }]
            },
        ),
        Mistake::values(
            "eval",
            "below",
            "Right above the surface. Below it nothing is reflected, whatever the lobe says.",
            |p| {
                let c = dot(mirror(vector(p, 5)), vector(p, 2)).max(0.0);
                vec![p[0] * (p[1] + 2.0) / TAU * c.powf(p[1])]
            },
        ),
        Mistake::density(
            "sample",
            "one-power",
            "The power of u is 1/(n + 1), not 1/n: the density n/2π cosⁿ⁻¹α is that of the exponent below.",
            |w| lobe(AXIS, EXPONENT - 1.0, w),
        ),
        Mistake::density(
            "sample",
            "around-normal",
            "The lobe is around the normal; it belongs around the mirror direction of wo.",
            |w| lobe([0.0, 0.0, 1.0], EXPONENT, w),
        ),
        Mistake::density(
            "sample",
            "around-wo",
            "The lobe is around wo itself; it belongs around its mirror direction.",
            |w| lobe([-AXIS[0], -AXIS[1], AXIS[2]], EXPONENT, w),
        ),
        Mistake::values(
            "pdf",
            "pdf-plus-two",
            "(n + 2)/2π is the factor of the BRDF; the integral of a density is 1.",
            |p| vec![pdf(p)[0] * (p[0] + 2.0) / (p[0] + 1.0)],
        ),
        Mistake::values(
            "pdf",
            "pdf-normal",
            "The density falls with the angle to the mirror direction of wo, not to the normal.",
            |p| vec![lobe([0.0, 0.0, 1.0], p[0], vector(p, 4))],
        ),
        Mistake::values(
            "pdf",
            "pdf-above",
            "Samples may lie below the surface, where f is 0; the density there is not.",
            |p| vec![if p[6] > 0.0 { pdf(p)[0] } else { 0.0 }],
        ),
    ],
    laws: &[
        Law {
            name: "reciprocity",
            functions: &["eval"],
            questions: || {
                let both = pairs(9, 20).into_iter().flat_map(|[a, b]| [[a, b], [b, a]]);
                both.map(|p| ("eval", with(0.5, 12.0, p))).collect()
            },
            judge: |_, answers| reciprocity(answers),
        },
        Law {
            name: "energy",
            functions: &["eval"],
            questions: || over_hemisphere("eval", |w| with(1.0, 10.0, [direction(30.0, 10.0), w])),
            judge: |_, answers| energy(answers),
        },
        Law {
            name: "density",
            functions: &["pdf"],
            questions: || over_hemisphere("pdf", |w| [&[10.0, 0.0, 0.0, 1.0][..], &w].concat()),
            judge: |_, answers| density(answers),
        },
        Law {
            name: "samples",
            functions: &["sample"],
            questions: || samples("sample", &[EXPONENT, -AXIS[0], -AXIS[1], AXIS[2]]),
            judge: |exercise, answers| follows(exercise, "sample", |w| lobe(AXIS, EXPONENT, w), answers),
        },
    ],
    texts: texts!("phong"),
};

/// Exponent and axis of the lobe that is sampled.
const EXPONENT: f64 = 4.0;
const AXIS: [f64; 3] = [0.48, -0.36, 0.8];

fn mirror(w: [f64; 3]) -> [f64; 3] {
    [-w[0], -w[1], w[2]]
}

fn with(ks: f64, exponent: f64, [wo, wi]: [[f64; 3]; 2]) -> Vec<f64> {
    [&[ks, exponent][..], &wo, &wi].concat()
}

fn is_above(p: &[f64]) -> bool {
    p[4] > 0.0 && p[7] > 0.0
}

fn eval(p: &[f64]) -> Vec<f64> {
    let bsdf = Bsdf::Phong(Phong::modified(Spectrum::ZERO, Spectrum::splat(p[0] as f32), p[1] as f32));
    let [wo, wi] = [2, 5].map(|first| Vec3::from_array(vector(p, first).map(|x| x as f32)));
    let value = f64::from(bsdf.eval(wo, wi, TransportMode::Radiance).value.to_array()[0]);
    vec![if value > 0.0 { value / p[7] } else { 0.0 }]
}

fn pdf(p: &[f64]) -> Vec<f64> {
    vec![lobe(mirror(vector(p, 1)), p[0], vector(p, 4))]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form of chapter 7 is the project's model.
    #[test]
    fn the_reference_is_the_formula() {
        for p in (EXERCISE.functions[1].points)() {
            let c = dot(mirror(vector(&p, 5)), vector(&p, 2)).max(0.0);
            let f = if is_above(&p) { p[0] * (p[1] + 2.0) / TAU * c.powf(p[1]) } else { 0.0 };
            assert!(EXERCISE.tolerance.holds(eval(&p)[0], f), "{p:?}");
        }
    }
}

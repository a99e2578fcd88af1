//! A rough mirror of facets: GGX.

use crate::{
    exercise::{Exercise, Function, Law, Mistake, Tolerance, texts},
    laws::{energy, over_hemisphere, reciprocity},
    points::{direction, dot, grid, pairs, vector},
};
use std::f64::consts::PI;
use steradian_bsdf::{Microfacet, fresnel};
use steradian_math::{Spectrum, Vec3};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "microfacet",
    chapter: 3,
    title: "A rough mirror: GGX's distribution of normals, shadowing, value",
    functions: &[
        Function {
            name: "distribution",
            inputs: &["alpha", "cos_m"],
            outputs: &["D"],
            reference: Some(|p| vec![facets(p[0]).d(at(p[1])).into()]),
            points: || grid(&[&[0.5, 0.2, 0.8], &[1.0, 0.9, 0.98, 0.8, 0.6, 0.3, 0.1]]),
        },
        Function {
            name: "shadowing",
            inputs: &["alpha", "cos_o", "cos_i"],
            outputs: &["G"],
            reference: Some(|p| vec![facets(p[0]).g2(at(p[1]), at(p[2]), Vec3::Z).into()]),
            points: || grid(&[&[0.5, 0.2, 0.8], &[0.5, 0.8, 1.0, 0.2, 0.05], &[0.3, 1.0, 0.6, 0.1]]),
        },
        Function {
            name: "eval",
            inputs: &["f0", "alpha", "wo[3]", "wi[3]"],
            outputs: &["f"],
            reference: Some(|p| eval(p, &Form::RIGHT)),
            points: || {
                pairs(11, 40)
                    .into_iter()
                    .enumerate()
                    .map(|(i, p)| with([0.04, 0.5, 0.9][i % 3], [0.5, 0.3, 0.8, 0.2][i % 4], p))
                    .collect()
            },
        },
    ],
    tolerance: Tolerance::SINGLE,
    mistakes: &[
        Mistake::values(
            "distribution",
            "no-pi",
            "The integral of D cosθ over the hemisphere must be 1: a factor of π is missing below the line.",
            |p| vec![PI * d(p[0], p[1])],
        ),
        Mistake::values(
            "distribution",
            "alpha-once",
            "α is squared in both places; here it looks as if it were taken as it is.",
            |p| vec![d(p[0].sqrt(), p[1])],
        ),
        Mistake::values(
            "distribution",
            "alpha-fourth",
            "α is the roughness of the formula already; some programs square an artist's roughness first, and it \
            looks as if you did, too.",
            |p| vec![d(p[0] * p[0], p[1])],
        ),
        Mistake::values(
            "distribution",
            "not-squared",
            "The bracket below the line is squared: (cos²θ (α² − 1) + 1)².",
            |p| {
                let bracket = p[1] * p[1] * (p[0] * p[0] - 1.0) + 1.0;
                vec![d(p[0], p[1]) * bracket]
            },
        ),
        Mistake::values(
            "distribution",
            "beckmann",
            "This is Beckmann's distribution, a Gaussian of the slopes; GGX has longer tails.",
            |p| {
                let (a2, c2) = (p[0] * p[0], p[1] * p[1]);
                vec![((c2 - 1.0) / (c2 * a2)).exp() / (PI * a2 * c2 * c2)]
            },
        ),
        Mistake::values(
            "shadowing",
            "separable",
            "This is the product G₁(o) G₁(i), which counts facets as hidden twice: the sum 1 + Λ(o) + Λ(i) is asked \
            for.",
            |p| vec![1.0 / ((1.0 + lambda(p[0], p[1])) * (1.0 + lambda(p[0], p[2])))],
        ),
        Mistake::values(
            "shadowing",
            "one-direction",
            "This is G₁ of wo alone; light can be shadowed as well as the view masked.",
            |p| vec![1.0 / (1.0 + lambda(p[0], p[1]))],
        ),
        Mistake::values(
            "shadowing",
            "no-minus-one",
            "Λ is (−1 + √(1 + α² tan²θ))/2, which is 0 along the normal; the −1 is missing.",
            |p| vec![1.0 / (2.0 + lambda(p[0], p[1]) + lambda(p[0], p[2]))],
        ),
        Mistake::values("eval", "no-four", "The 4 of the change from half vectors to directions is missing.", |p| {
            eval(p, &Form { factor: 4.0, ..Form::RIGHT })
        }),
        Mistake::values("eval", "pi-for-four", "Below the line stands 4, not π: D has its π already.", |p| {
            eval(p, &Form { factor: 4.0 / PI, ..Form::RIGHT })
        }),
        Mistake::values("eval", "no-cosines", "The cosines of both directions below the line are missing.", |p| {
            let cosines = p[4] * p[7];
            eval(p, &Form { factor: cosines, ..Form::RIGHT })
        }),
        Mistake::values(
            "eval",
            "fresnel-at-normal",
            "Fresnel's term belongs to the facet: its cosine is that between wo and the half vector, not wo and the \
            surface's normal.",
            |p| eval(p, &Form { fresnel: |wo, _| wo[2], ..Form::RIGHT }),
        ),
        Mistake::values(
            "eval",
            "fresnel-at-half",
            "Schlick's term takes the cosine between wo and the half vector; this looks like the half vector's own \
            cosine to the normal.",
            |p| eval(p, &Form { fresnel: |_, m| m[2], ..Form::RIGHT }),
        ),
        Mistake::values(
            "eval",
            "with-cosine",
            "f without the cosine is asked for: cosθ_i belongs to the equation around it.",
            |p| {
                let cosine = p[7];
                eval(p, &Form { factor: cosine, ..Form::RIGHT })
            },
        ),
    ],
    laws: &[
        Law {
            name: "reciprocity",
            functions: &["eval"],
            questions: || {
                let both = pairs(12, 20).into_iter().flat_map(|[a, b]| [[a, b], [b, a]]);
                both.map(|p| ("eval", with(0.5, 0.4, p))).collect()
            },
            judge: |_, answers| reciprocity(answers),
        },
        Law {
            name: "energy",
            functions: &["eval"],
            questions: || over_hemisphere("eval", |w| with(1.0, 0.5, [direction(40.0, 10.0), w])),
            judge: |_, answers| energy(answers),
        },
    ],
    texts: texts!("microfacet"),
};

/// A variant of the value.
struct Form {
    factor: f64,
    /// Cosine of Fresnel's term, by wo and the half vector.
    fresnel: fn([f64; 3], [f64; 3]) -> f64,
}

impl Form {
    const RIGHT: Self = Self { factor: 1.0, fresnel: dot };
}

fn facets(alpha: f64) -> Microfacet {
    Microfacet::ggx(alpha as f32, alpha as f32)
}

/// A direction with this cosine.
fn at(cos: f64) -> Vec3 {
    Vec3::new((1.0 - cos * cos).sqrt() as f32, 0.0, cos as f32)
}

fn d(alpha: f64, cos: f64) -> f64 {
    facets(alpha).d(at(cos)).into()
}

fn lambda(alpha: f64, cos: f64) -> f64 {
    facets(alpha).lambda(at(cos)).into()
}

fn with(f0: f64, alpha: f64, [wo, wi]: [[f64; 3]; 2]) -> Vec<f64> {
    [&[f0, alpha][..], &wo, &wi].concat()
}

fn eval(p: &[f64], form: &Form) -> Vec<f64> {
    let (wo, wi) = (vector(p, 2), vector(p, 5));
    if wo[2] <= 0.0 || wi[2] <= 0.0 {
        return vec![0.0];
    }
    let h = [0, 1, 2].map(|i| wo[i] + wi[i]);
    let length = dot(h, h).sqrt();
    let m = h.map(|x| x / length);
    let facets = facets(p[1]);
    let [o, i, n] = [wo, wi, m].map(|w| Vec3::from_array(w.map(|x| x as f32)));
    let f = fresnel::schlick((form.fresnel)(wo, m) as f32, Spectrum::splat(p[0] as f32)).to_array()[0];
    let value = f64::from(f) * f64::from(facets.d(n)) * f64::from(facets.g2(o, i, n));
    vec![form.factor * value / (4.0 * wo[2] * wi[2])]
}

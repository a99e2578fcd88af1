//! A path tracer in a sphere that glows: hit, directions, radiance.

use crate::{
    exercise::{Exercise, Finding, Function, Law, Mistake, Tolerance, texts},
    laws::{cosine, even, follows, mean},
    points::{Random, dot, vector},
};
use std::f64::consts::PI;
use steradian_math::{Ray, Vec3, intersect};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "path-tracer",
    chapter: 2,
    title: "A path tracer in a closed sphere that glows",
    functions: &[
        Function {
            name: "hit",
            inputs: &["o[3]", "d[3]"],
            outputs: &["t"],
            reference: Some(|p| vec![roots(p)[1]]),
            points: || {
                let mut random = Random::new(31);
                let simple = [[0.5, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -0.5, 0.0, 0.6, 0.8]].map(Vec::from);
                let mut inside = || [&random.around().map(|x| 0.9 * x)[..], &random.around()].concat();
                simple.into_iter().chain((0..30).map(|_| inside())).collect()
            },
        },
        Function {
            name: "direction",
            inputs: &["n[3]", "u1", "u2"],
            outputs: &["x", "y", "z"],
            reference: None,
            points: || {
                let mut random = Random::new(32);
                let mut normals = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
                normals.extend((0..20).map(|_| random.around()));
                normals.iter().map(|n| [&n[..], &[random.unit(), random.unit()]].concat()).collect()
            },
        },
        Function {
            name: "radiance",
            inputs: &["albedo", "o[3]", "d[3]", "u[8]"],
            outputs: &["L"],
            reference: None,
            points: || (0..20).map(|i| path(0.5, &mut Random::new(50 + i))).collect(),
        },
    ],
    tolerance: Tolerance::SINGLE,
    mistakes: &[
        Mistake::values(
            "hit",
            "near-root",
            "The ray starts inside, so one root is behind it: the greater one is wanted.",
            |p| vec![roots(p)[0]],
        ),
        Mistake::values("hit", "sign", "Is −b there, with its sign? It looks as if +b stood in the solution.", |p| {
            vec![-roots(p)[0]]
        }),
        Mistake::values(
            "hit",
            "twice",
            "With d of unit length the solution of t² + 2bt + c = 0 is −b ± √(b² − c); this is twice as much.",
            |p| vec![2.0 * roots(p)[1]],
        ),
        Mistake::values(
            "hit",
            "from-origin",
            "It looks as if the ray started in the middle of the sphere: the origin counts.",
            |_| vec![1.0],
        ),
        Mistake::density("direction", "around-z", "The directions are around z; they belong around n.", cosine),
        Mistake::density(
            "direction",
            "even",
            "The directions are even over the hemisphere; they must follow the cosine.",
            |w| even([0.0, 0.0, dot(NORMAL, w)]),
        ),
        Mistake::density("direction", "other-side", "The directions are on the other side, around −n.", |w| {
            cosine([0.0, 0.0, -dot(NORMAL, w)])
        }),
        Mistake::density(
            "direction",
            "whole-sphere",
            "The directions fill the whole sphere; only those on the side of n are wanted.",
            |_| 0.25 / PI,
        ),
        Mistake::mean(
            "radiance",
            "no-throughput",
            "Each bounce leaves only the albedo of the light: β is multiplied by it at every vertex.",
            series(1.0),
        ),
        Mistake::mean(
            "radiance",
            "first-only",
            "Only the emission at the first hit is counted; each further vertex shines, too.",
            FIRST,
        ),
        Mistake::mean(
            "radiance",
            "without-first",
            "The emission at the first hit is missing: that vertex shines, too, with β = 1.",
            series(ALBEDO) - FIRST,
        ),
        Mistake::mean(
            "radiance",
            "over-pi",
            "The BRDF is albedo/π and the density cosθ/π: in β their π cancel, and one is left over here.",
            series(ALBEDO / PI),
        ),
        Mistake::mean(
            "radiance",
            "times-pi",
            "The BRDF is albedo/π and the density cosθ/π: in β their π cancel, and here it is a factor.",
            series(ALBEDO * PI),
        ),
        Mistake::mean(
            "radiance",
            "one-short",
            "The last vertex is missing: four bounces lead to five vertices.",
            bounced(ALBEDO, BOUNCES - 1),
        ),
        Mistake::mean(
            "radiance",
            "albedo-first",
            "β starts as 1: the light of the first hit comes straight to the eye, without a bounce.",
            ALBEDO * series(ALBEDO),
        ),
    ],
    laws: &[
        Law {
            name: "directions",
            functions: &["direction"],
            questions: || crate::laws::samples("direction", &NORMAL),
            judge: |e, answers| follows(e, "direction", |w| cosine([0.0, 0.0, dot(NORMAL, w)]), answers),
        },
        Law {
            name: "radiance of black walls",
            functions: &["hit", "radiance"],
            questions: || (0..20).map(|i| ("radiance", path(0.0, &mut Random::new(70 + i)))).collect(),
            judge: |_, answers| {
                let off = answers.iter().zip(0..).find_map(|(given, i)| {
                    let p = path(0.0, &mut Random::new(70 + i));
                    let right = 1.0 + p[3] + roots(&p[1..])[1] * p[6];
                    let given = given.first().copied().unwrap_or(f64::NAN);
                    (!EXERCISE.tolerance.holds(given, right)).then(|| {
                        let at = crate::numbers::point(&EXERCISE.functions[2], &p);
                        format!(
                            "With albedo 0 only the first hit shines, with 1 + z. At {at} you gave {given}, \
                        right is {right}."
                        )
                    })
                });
                Finding {
                    holds: off.is_none(),
                    text: off.unwrap_or_else(|| "the first hit shines with 1 + z".into()),
                    mistake: None,
                }
            },
        },
        Law {
            name: "mean radiance",
            functions: &["hit", "direction", "radiance"],
            questions: || {
                let mut random = Random::new(33);
                (0..3_000).map(|_| ("radiance", fixed(ALBEDO, [0.0, 0.0, 0.3], [0.0, 0.6, 0.8], &mut random))).collect()
            },
            judge: |e, answers| mean(e, "radiance", series(ALBEDO), answers),
        },
    ],
    texts: texts!("path-tracer"),
};

/// The normal about which directions are drawn.
const NORMAL: [f64; 3] = [0.6, 0.0, -0.8];
const ALBEDO: f64 = 0.6;
const BOUNCES: i32 = 4;
/// Emission at the first hit of the ray from (0, 0, 0.3) along (0, 0.6, 0.8):
/// `t = −0.24 + √(0.24² + 0.91)`, `z = 0.3 + 0.8 t`.
const FIRST: f64 = 1.0 + 0.3 + 0.8 * 0.743_666_61;

/// Mean radiance after so many bounces: light that has left a wall reaches all of a sphere evenly, and the
/// mean emission is 1.
const fn bounced(albedo: f64, bounces: i32) -> f64 {
    let (mut sum, mut power, mut k) = (FIRST, 1.0, 0);
    while k < bounces {
        power *= albedo;
        sum += power;
        k += 1;
    }
    sum
}

/// Mean radiance after all bounces, if β is multiplied by this at each.
const fn series(factor: f64) -> f64 {
    bounced(factor, BOUNCES)
}

fn fixed(albedo: f64, o: [f64; 3], d: [f64; 3], random: &mut Random) -> Vec<f64> {
    let u = [0; 8].map(|_| random.unit());
    [&[albedo][..], &o, &d, &u].concat()
}

fn path(albedo: f64, random: &mut Random) -> Vec<f64> {
    let (o, d) = (random.around().map(|x| 0.8 * x), random.around());
    fixed(albedo, o, d, random)
}

/// Distances to the unit sphere, forwards and backwards.
fn roots(p: &[f64]) -> [f64; 2] {
    let [o, d] = [0, 3].map(|first| Vec3::from_array(vector(p, first).map(|x| x as f32)));
    intersect::sphere(Vec3::ZERO, 1.0, &Ray::new(o, d)).map_or([0.0; 2], |t| t.map(f64::from))
}

//! A closest-hit shader: attributes, instances, normals.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::{Random, vector},
};
use steradian_math::{DMat3, DVec3};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "closest-hit",
    chapter: 14,
    title: "A closest-hit shader: attributes at a hit, a ray in an instance, its normal",
    functions: &[
        Function {
            name: "attribute",
            inputs: &["beta", "gamma", "a[3]"],
            outputs: &["value"],
            reference: Some(|p| vec![(1.0 - p[0] - p[1]) * p[2] + p[0] * p[3] + p[1] * p[4]]),
            points: || {
                let mut random = Random::new(161);
                let simple = [vec![0.25, 0.5, 1.0, 2.0, 4.0], vec![0.0, 0.0, 5.0, 1.0, 2.0]];
                let mut one = |_| {
                    let u = random.unit();
                    let head = [u, (1.0 - u) * random.unit()];
                    [&head[..], &[0; 3].map(|_| random.between(-2.0, 3.0))].concat()
                };
                simple.into_iter().chain((0..20).map(&mut one)).collect()
            },
        },
        Function {
            name: "to_object",
            inputs: &["m[9]", "b[3]", "o[3]", "d[3]"],
            outputs: &["ox", "oy", "oz", "dx", "dy", "dz"],
            reference: Some(|p| ray(p, matrix(p).inverse(), DVec3::ZERO)),
            points: || {
                let mut random = Random::new(162);
                let simple =
                    [1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 3.0, 3.0, 0.0, 0.0, 1.0, 0.0].to_vec();
                std::iter::once(simple)
                    .chain((0..30).map(|_| {
                        let tail: Vec<f64> = (0..6).map(|_| random.between(-2.0, 2.0)).collect();
                        [&affine(&mut random)[..], &tail, &random.around()].concat()
                    }))
                    .collect()
            },
        },
        Function {
            name: "normal",
            inputs: &["m[9]", "n[3]"],
            outputs: &["x", "y", "z"],
            reference: Some(|p| turned(p, |m| m.inverse().transpose()).normalize().to_array().to_vec()),
            points: || {
                let mut random = Random::new(163);
                let simple = vec![1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.6, 0.8, 0.0];
                let of = |_| [&affine(&mut random)[..], &random.around()].concat();
                std::iter::once(simple).chain((0..30).map(of)).collect()
            },
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "attribute",
            "first-two",
            "β and γ belong to the second and the third corner; the first has \
        what is left.",
            |p| vec![p[0] * p[2] + p[1] * p[3] + (1.0 - p[0] - p[1]) * p[4]],
        ),
        Mistake::values(
            "attribute",
            "exchanged",
            "β is the weight of the second corner and γ that of the third; \
        they are exchanged.",
            |p| vec![(1.0 - p[0] - p[1]) * p[2] + p[1] * p[3] + p[0] * p[4]],
        ),
        Mistake::values(
            "attribute",
            "first-whole",
            "The first corner's weight is 1 − β − γ; here it seems to be \
        1.",
            |p| vec![p[2] + p[0] * p[3] + p[1] * p[4]],
        ),
        Mistake::values(
            "to_object",
            "direction-moved",
            "A direction has no place: the translation b belongs to the \
        origin only.",
            |p| {
                let m = matrix(p).inverse();
                let (o, d) = (m * (at(p, 12) - at(p, 9)), m * (at(p, 15) - at(p, 9)));
                [o.to_array(), d.to_array()].concat()
            },
        ),
        Mistake::values(
            "to_object",
            "direction-normalised",
            "The direction must not be normalised: t would no \
        longer be the same in both spaces.",
            |p| {
                let right = ray(p, matrix(p).inverse(), DVec3::ZERO);
                [&right[..3], &at(&right, 3).normalize().to_array()].concat()
            },
        ),
        Mistake::values(
            "to_object",
            "no-translation",
            "The instance stands at b: it is subtracted from the origin \
        first.",
            |p| ray(p, matrix(p).inverse(), at(p, 9)),
        ),
        Mistake::values(
            "to_object",
            "not-inverted",
            "The map leads from the object to the world, and the ray goes \
        the other way: the inverse is needed.",
            |p| ray(p, matrix(p), DVec3::ZERO),
        ),
        Mistake::values(
            "to_object",
            "transposed",
            "The transpose is the inverse for rotations \
        alone.",
            |p| ray(p, matrix(p).transpose(), DVec3::ZERO),
        ),
        Mistake::values(
            "normal",
            "as-direction",
            "A normal is not a direction: scaled along one axis it must turn \
        the other way. The inverse transpose is needed.",
            |p| turned(p, |m| m).normalize().to_array().to_vec(),
        ),
        Mistake::values(
            "normal",
            "inverse-alone",
            "The inverse must be transposed, \
        too.",
            |p| turned(p, |m| m.inverse()).normalize().to_array().to_vec(),
        ),
        Mistake::values(
            "normal",
            "transpose-alone",
            "The transpose must be inverted, \
        too.",
            |p| turned(p, |m| m.transpose()).normalize().to_array().to_vec(),
        ),
        Mistake::values(
            "normal",
            "not-normalised",
            "The result has the right direction; it must be made of unit \
        length.",
            |p| turned(p, |m| m.inverse().transpose()).to_array().to_vec(),
        ),
    ],
    laws: &[],
    texts: texts!("closest-hit"),
};

fn at(p: &[f64], first: usize) -> DVec3 {
    DVec3::from_array(vector(p, first))
}

/// The matrix whose rows are the first nine numbers.
fn matrix(p: &[f64]) -> DMat3 {
    DMat3::from_cols(at(p, 0), at(p, 3), at(p, 6)).transpose()
}

/// Origin and direction of a ray by a matrix; `kept` undoes the translation.
fn ray(p: &[f64], m: DMat3, kept: DVec3) -> Vec<f64> {
    let o = m * (at(p, 12) - at(p, 9) + kept);
    [o.to_array(), (m * at(p, 15)).to_array()].concat()
}

fn turned(p: &[f64], by: fn(DMat3) -> DMat3) -> DVec3 {
    by(matrix(p)) * at(p, 9)
}

/// A matrix that can be inverted well: one of a positive diagonal and smaller numbers around it.
fn affine(random: &mut Random) -> Vec<f64> {
    (0..9).map(|i| if i % 4 == 0 { random.between(0.6, 3.0) } else { random.between(-0.25, 0.25) }).collect()
}

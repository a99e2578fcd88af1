//! The slab test: a ray and a box.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::{Random, vector},
};
use steradian_math::{Bounds3, Vec3};

/// The only function.
const F: &str = "slab";

pub(super) static EXERCISE: Exercise = Exercise {
    name: "slab-test",
    chapter: 13,
    title: "The slab test: where a ray is inside a box",
    functions: &[Function {
        name: F,
        inputs: &["lo[3]", "hi[3]", "o[3]", "d[3]", "t_max"],
        outputs: &["hit", "near", "far"],
        reference: Some(reference),
        points,
    }],
    tolerance: Tolerance::SINGLE,
    mistakes: &[
        Mistake::values(
            F,
            "no-swap",
            "For a negative component of d the far plane of a slab is met first: near and \
        far must be exchanged.",
            |p| with(p, &Form { sorted: false, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "union",
            "The ray is in the box where it is in all slabs: the greatest near and the \
        smallest far distance count.",
            |p| with(p, &Form { union: true, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "behind",
            "The interval starts at 0: what lies behind the origin is no hit, and from \
        inside near is 0.",
            |p| with(p, &Form { first: f64::NEG_INFINITY, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "beyond",
            "The ray ends at t_max: boxes beyond are not hit, and far is t_max at \
        most.",
            |p| with(p, &Form { last: false, ..Form::RIGHT }),
        ),
        Mistake::values(
            F,
            "two-axes",
            "Only x and y are looked at; the third slab is \
        missing.",
            |p| with(p, &Form { axes: 2, ..Form::RIGHT }),
        ),
        Mistake::values(F, "always-hit", "A ray misses if near is greater than far.", |p| {
            let t = interval(p, &Form::RIGHT);
            vec![1.0, t[0], t[1]]
        }),
    ],
    laws: &[],
    texts: texts!("slab-test"),
};

fn reference(p: &[f64]) -> Vec<f64> {
    let [lo, hi, o, d] = [0, 3, 6, 9].map(|first| Vec3::from_array(vector(p, first).map(|x| x as f32)));
    let found = Bounds3::new(lo, hi).intersect(o, 1.0 / d, p[12] as f32);
    found.map_or(vec![0.0; 3], |(near, far)| vec![1.0, near.into(), far.into()])
}

/// A variant of the test.
struct Form {
    sorted: bool,
    union: bool,
    first: f64,
    last: bool,
    axes: usize,
}

impl Form {
    const RIGHT: Self = Self { sorted: true, union: false, first: 0.0, last: true, axes: 3 };
}

fn interval(p: &[f64], form: &Form) -> [f64; 2] {
    let (lo, hi, o, d) = (vector(p, 0), vector(p, 3), vector(p, 6), vector(p, 9));
    let (mut near, mut far) = (form.first, if form.last { p[12] } else { f64::INFINITY });
    if form.union {
        (near, far) = (f64::INFINITY, f64::NEG_INFINITY);
    }
    for k in 0..form.axes {
        let (mut t0, mut t1) = ((lo[k] - o[k]) / d[k], (hi[k] - o[k]) / d[k]);
        if form.sorted && t0 > t1 {
            (t0, t1) = (t1, t0);
        }
        (near, far) = if form.union { (near.min(t0), far.max(t1)) } else { (near.max(t0), far.min(t1)) };
    }
    if form.union { [near.max(0.0), far.min(p[12])] } else { [near, far] }
}

fn with(p: &[f64], form: &Form) -> Vec<f64> {
    let [near, far] = interval(p, form);
    if near <= far { vec![1.0, near, far] } else { vec![0.0; 3] }
}

/// Rays at boxes, from outside and inside, towards and away, some parallel to axes, some that end early.
fn points() -> Vec<Vec<f64>> {
    let mut random = Random::new(141);
    let cube = [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0];
    let rays = [
        [-3.0, 0.0, 0.0, 1.0, 0.0, 0.0, 10.0],
        [0.5, 0.5, 0.5, 0.0, 0.0, -2.0, 10.0],
        [0.0, 2.0, 0.0, 1.0, 0.0, 0.0, 10.0],
        [3.0, 0.5, 0.0, 1.0, 0.0, 0.0, 10.0],
        [-3.0, 0.5, 0.25, 1.0, 0.0, 0.0, 3.0],
        [-3.0, 0.5, 0.25, 1.0, 0.0, 0.0, 1.0],
        [3.0, 3.0, 3.0, -1.0, -1.0, -1.0, 100.0],
    ];
    let chosen = rays.iter().map(|ray| [&cube[..], ray].concat());
    let random = (0..80).map(|i| {
        let lo = [0; 3].map(|_| random.between(-1.5, 0.0));
        let hi = lo.map(|x| x + random.between(0.5, 2.0));
        let target = [0, 1, 2].map(|k| lo[k] + (hi[k] - lo[k]) * random.between(-0.2, 1.2));
        let o = if i % 4 == 0 { target.map(|x| x * 0.9) } else { random.around().map(|x| 4.0 * x) };
        let d = if i % 4 == 0 { random.around() } else { [0, 1, 2].map(|k| target[k] - o[k]) };
        let d = if i % 5 == 0 { d.map(|x| -x) } else { d };
        [&lo[..], &hi, &o, &d, &[if i % 3 == 0 { 1.0 } else { 100.0 }]].concat()
    });
    chosen.chain(random).collect()
}

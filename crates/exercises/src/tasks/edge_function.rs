//! Edge functions of a rasteriser.

use crate::{
    exercise::{Exercise, Function, Mistake, Tolerance, texts},
    points::Random,
};

pub(super) static EXERCISE: Exercise = Exercise {
    name: "edge-function",
    chapter: 10,
    title: "Edge functions: which pixels a triangle covers, and the weights of its corners",
    functions: &[
        Function {
            name: "edge",
            inputs: &["a[2]", "b[2]", "p[2]"],
            outputs: &["E"],
            reference: Some(|p| vec![edge(p, 0, 2, 4)]),
            points: || {
                let mut random = Random::new(101);
                let simple = [vec![1.0, 0.0, 3.0, 1.0, 2.0, 4.0], vec![0.0, 0.0, 2.0, 2.0, 1.0, 1.0]];
                simple.into_iter().chain((0..30).map(|_| (0..6).map(|_| random.between(-4.0, 4.0)).collect())).collect()
            },
        },
        Function {
            name: "weights",
            inputs: &["a[2]", "b[2]", "c[2]", "p[2]"],
            outputs: &["of_a", "of_b", "of_c"],
            reference: Some(|p| weights(p).to_vec()),
            points: triangles,
        },
        Function {
            name: "covers",
            inputs: &["a[2]", "b[2]", "c[2]", "p[2]"],
            outputs: &["inside"],
            reference: Some(|p| inside(p, |e| all(e, |x| x >= 0.0) || all(e, |x| x <= 0.0))),
            points: triangles,
        },
    ],
    tolerance: Tolerance::DOUBLE,
    mistakes: &[
        Mistake::values(
            "edge",
            "sign",
            "The sign is the other one: E is positive if p lies to the left of the way \
        from a to b (x to the right, y up).",
            |p| vec![-edge(p, 0, 2, 4)],
        ),
        Mistake::values(
            "edge",
            "half",
            "E is twice the area of the triangle a, b, p; this is the area \
        itself.",
            |p| vec![0.5 * edge(p, 0, 2, 4)],
        ),
        Mistake::values(
            "edge",
            "dot",
            "This is the dot product of both differences; the cross product is asked \
        for.",
            |p| vec![(p[2] - p[0]) * (p[4] - p[0]) + (p[3] - p[1]) * (p[5] - p[1])],
        ),
        Mistake::values(
            "edge",
            "from-origin",
            "b and p are taken from a: a must be subtracted from \
        both.",
            |p| vec![p[2] * p[5] - p[3] * p[4]],
        ),
        Mistake::values("edge", "plus", "The second product is subtracted, not added.", |p| {
            vec![(p[2] - p[0]) * (p[5] - p[1]) + (p[3] - p[1]) * (p[4] - p[0])]
        }),
        Mistake::values(
            "weights",
            "not-divided",
            "These are the edge functions; divided by their sum they add up \
        to 1.",
            |p| edges(p).to_vec(),
        ),
        Mistake::values(
            "weights",
            "turned",
            "The weight of a corner belongs to the edge opposite to it: that of a \
        to the edge from b to c.",
            |p| {
                let [a, b, c] = weights(p);
                vec![c, a, b]
            },
        ),
        Mistake::values(
            "weights",
            "turned-back",
            "The weight of a corner belongs to the edge opposite to it: that \
        of a to b c, of b to c a, of c to a b.",
            |p| {
                let [a, b, c] = weights(p);
                vec![b, c, a]
            },
        ),
        Mistake::values(
            "covers",
            "one-winding",
            "Right for triangles whose corners turn left. Those that turn \
        right have three negative edge functions inside.",
            |p| inside(p, |e| all(e, |x| x >= 0.0)),
        ),
        Mistake::values(
            "covers",
            "other-winding",
            "Right for triangles whose corners turn right; those that turn \
        left have three positive edge functions inside.",
            |p| inside(p, |e| all(e, |x| x <= 0.0)),
        ),
        Mistake::values(
            "covers",
            "strict",
            "Points on an edge or corner count as inside here: 0 has both \
        signs.",
            |p| inside(p, |e| all(e, |x| x > 0.0) || all(e, |x| x < 0.0)),
        ),
        Mistake::values("covers", "box", "This is the box around the triangle.", |p| {
            let within = |i: usize| {
                let c = [p[i], p[i + 2], p[i + 4]];
                (c.iter().any(|x| *x <= p[i + 6])) && c.iter().any(|x| *x >= p[i + 6])
            };
            vec![f64::from(u8::from(within(0) && within(1)))]
        }),
    ],
    laws: &[],
    texts: texts!("edge-function"),
};

fn edge(p: &[f64], a: usize, b: usize, at: usize) -> f64 {
    (p[b] - p[a]) * (p[at + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[at] - p[a])
}

/// Edge functions of the edges opposite to a, b and c.
fn edges(p: &[f64]) -> [f64; 3] {
    [edge(p, 2, 4, 6), edge(p, 4, 0, 6), edge(p, 0, 2, 6)]
}

fn weights(p: &[f64]) -> [f64; 3] {
    let e = edges(p);
    let sum: f64 = e.iter().sum();
    e.map(|x| x / sum)
}

fn all(e: [f64; 3], is: fn(f64) -> bool) -> bool {
    e.into_iter().all(is)
}

fn inside(p: &[f64], test: fn([f64; 3]) -> bool) -> Vec<f64> {
    vec![f64::from(u8::from(test(edges(p))))]
}

/// Triangles of both windings, with points inside, outside, on edges and at corners, in whole numbers and halves.
fn triangles() -> Vec<Vec<f64>> {
    let mut random = Random::new(102);
    let left = [[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]];
    let right = [[0.0, 0.0], [2.0, 8.0], [8.0, 2.0]];
    let at = [
        [2.0, 2.0],
        [6.0, 6.0],
        [4.0, 0.0],
        [0.0, 0.0],
        [4.0, 4.0],
        [-1.0, 3.0],
        [2.5, 3.5],
        [5.0, 5.0],
        [1.0, 4.0],
        [3.0, 3.0],
    ];
    let mut points = Vec::new();
    for t in [left, right] {
        points.extend(at.iter().map(|p| [&t.concat()[..], p].concat()));
    }
    points.extend((0..60).map(|_| {
        let t: Vec<f64> = (0..6).map(|_| random.between(0.0, 8.0)).collect();
        let w = [random.between(-0.1, 1.0), random.between(-0.1, 1.0)];
        let of = |i: usize| t[i] + w[0] * (t[i + 2] - t[i]) + w[1] * (1.0 - w[0]) * (t[i + 4] - t[i]);
        [&t[..], &[of(0), of(1)]].concat()
    }));
    points
}

//! Edge functions; the task is in README.md.
#![allow(unused_variables)]

/// Twice the signed area of the triangle a, b, p.
pub fn edge(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    // gap
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    // end
}

/// The barycentric weights of the corners at p.
pub fn weights(a: [f64; 2], b: [f64; 2], c: [f64; 2], p: [f64; 2]) -> [f64; 3] {
    // gap
    let e = [edge(b, c, p), edge(c, a, p), edge(a, b, p)];
    let sum: f64 = e.iter().sum();
    e.map(|x| x / sum)
    // end
}

/// 1 if the triangle covers p, otherwise 0.
pub fn covers(a: [f64; 2], b: [f64; 2], c: [f64; 2], p: [f64; 2]) -> f64 {
    // gap
    let e = [edge(b, c, p), edge(c, a, p), edge(a, b, p)];
    let (left, right) = (e.iter().all(|x| *x >= 0.0), e.iter().all(|x| *x <= 0.0));
    if left || right { 1.0 } else { 0.0 }
    // end
}

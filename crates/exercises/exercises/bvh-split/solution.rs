//! The surface area heuristic; the task is in README.md.
#![allow(unused_variables)]

/// The surface area of a box.
pub fn area(lo: [f64; 3], hi: [f64; 3]) -> f64 {
    // gap
    let [x, y, z] = [0, 1, 2].map(|k| hi[k] - lo[k]);
    2.0 * (x * y + y * z + z * x)
    // end
}

/// The expected cost of a ray that meets the node.
pub fn cost(
    area: f64,
    left_area: f64,
    left_count: f64,
    right_area: f64,
    right_count: f64,
    step: f64,
    test: f64,
) -> f64 {
    // gap
    step + test * (left_area * left_count + right_area * right_count) / area
    // end
}

/// The number of primitives on the left in the cheapest split of six.
pub fn best(left_areas: [f64; 5], right_areas: [f64; 5]) -> f64 {
    // gap
    let cost = |k: usize| left_areas[k - 1] * k as f64 + right_areas[k - 1] * (6 - k) as f64;
    let mut best = 1;
    for k in 2..6 {
        if cost(k) < cost(best) {
            best = k;
        }
    }
    best as f64
    // end
}

//! Levels of a mip-map; the task is in README.md.
#![allow(unused_variables)]

/// The level for a footprint, with its fraction.
pub fn level(dx: [f64; 2], dy: [f64; 2], width: f64, height: f64, count: f64) -> f64 {
    // gap
    let length = |d: [f64; 2]| (d[0] * width).hypot(d[1] * height);
    let longest = length(dx).max(length(dy));
    longest.log2().clamp(0.0, count - 1.0)
    // end
}

/// The value between the two levels around a level.
pub fn blend(level: f64, values: [f64; 4]) -> f64 {
    // gap
    let first = level as usize;
    let t = level - first as f64;
    (1.0 - t) * values[first] + t * values[(first + 1).min(3)]
    // end
}

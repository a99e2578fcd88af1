//! The slab test; the task is in README.md.
#![allow(unused_variables)]

/// Hit (1 or 0), and the first and last distance inside the box.
pub fn slab(lo: [f64; 3], hi: [f64; 3], o: [f64; 3], d: [f64; 3], t_max: f64) -> [f64; 3] {
    // gap
    let (mut near, mut far) = (0.0f64, t_max);
    for k in 0..3 {
        // Infinite for parallel rays, with the signs that are needed.
        let (t0, t1) = ((lo[k] - o[k]) / d[k], (hi[k] - o[k]) / d[k]);
        near = near.max(t0.min(t1));
        far = far.min(t0.max(t1));
    }
    if near <= far { [1.0, near, far] } else { [0.0; 3] }
    // end
}

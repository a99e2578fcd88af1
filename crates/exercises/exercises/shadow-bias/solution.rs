//! Shadow maps; the task is in README.md.
#![allow(unused_variables)]

/// The depth that a surface may change over half a texel.
pub fn bias(texel: f64, cosine: f64, most: f64) -> f64 {
    // gap
    let tangent = (1.0 - cosine * cosine).sqrt() / cosine;
    texel / 2.0 * tangent.min(most)
    // end
}

/// The part of nine texels for which the point is lit.
pub fn lit(depth: f64, bias: f64, map: [f64; 9]) -> f64 {
    // gap
    map.iter().filter(|kept| depth - bias <= **kept).count() as f64 / 9.0
    // end
}

/// The width of the half-shadow.
pub fn penumbra(lamp: f64, blocker: f64, receiver: f64) -> f64 {
    // gap
    lamp * (receiver - blocker) / blocker
    // end
}

//! Shadow maps whose depths are filtered before they are compared, by moments of their distribution.

use rayon::prelude::*;
use steradian_math::Vec3;

use super::map::{InMap, Map};
use crate::projection::Projected;

/// The means of z, z², z³ and z⁴ around each texel, z from 0 at the start of the view to 1 at its end.
#[derive(Debug)]
pub struct Moments {
    /// Shadow map of the moments, without its distances.
    map: Map,
    moments: Vec<[f32; 4]>,
    by_variance: bool,
}

/// Weight of the moments of the uniform distribution mixed in, so that rounding does not make them impossible (Peters,
/// Klein 2015, §3.3).
const MIXED: f64 = 3e-5;

impl Moments {
    /// Filters a map over so many texels along each axis. `by_variance`: two moments count, not four.
    pub fn new(map: &Map, width: u32, by_variance: bool) -> Self {
        let size = map.size as usize;
        // Raw moments E(z^k) are linear, so that they can be filtered as colours are.
        let powers = |d: &f32| {
            let z = map.view.share_of(*d);
            [z, z * z, z * z * z, z * z * z * z]
        };
        let plain: Vec<[f32; 4]> = map.distances.iter().map(powers).collect();
        let (before, count) = ((width as usize - 1) / 2, width as usize);
        // A box filter along one axis; two of them in turn are the square.
        let blurred = |texels: &[[f32; 4]], stride: usize, across: usize| -> Vec<[f32; 4]> {
            let mean = |i: usize| {
                let (line, at) = ((i / across) % size, i);
                let first = line.saturating_sub(before);
                let last = (line + count - before).min(size);
                let mut sum = [0f64; 4];
                for j in first..last {
                    let texel = texels[at + j * stride - line * stride];
                    (0..4).for_each(|k| sum[k] += f64::from(texel[k]));
                }
                sum.map(|s| (s / (last - first) as f64) as f32)
            };
            (0..texels.len()).into_par_iter().map(mean).collect()
        };
        let moments = blurred(&blurred(&plain, 1, 1), size, size);
        let map = Map { view: map.view, distances: Vec::new(), size: map.size };
        Self { map, moments, by_variance }
    }

    /// Visibility of the light from a point.
    pub fn lit(&self, p: Vec3, n: Vec3) -> f32 {
        let Some(found) = self.map.locate(p, n) else { return 1.0 };
        let view: &Projected = &self.map.view;
        let InMap { local, at, texel, slope } = found;
        let size = self.map.size as f32;
        // Between the centres of four texels.
        let place = |x: f32| ((x * 0.5 + 0.5) * size - 0.5).clamp(0.0, size - 1.0);
        let (x, y) = (place(at.x), place(-at.y));
        let (x0, y0) = (x.floor(), y.floor());
        // Moments are linear in the distribution of depths, so that they may be interpolated.
        let mut b = [0f64; 4];
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (column, row) = ((x0 + dx).min(size - 1.0), (y0 + dy).min(size - 1.0));
            let weight = (1.0 - (x - column).abs()).max(0.0) * (1.0 - (y - row).abs()).max(0.0);
            let texel = self.moments[row as usize * self.map.size as usize + column as usize];
            (0..4).for_each(|k| b[k] += f64::from(weight * texel[k]));
        }
        let z = f64::from(view.share_of(local.z - 0.1 * texel));
        // The spread of the surface's own depths within a texel.
        let own = f64::from(view.share_of(local.z) - view.share_of(local.z - 0.5 * slope * texel));
        if self.by_variance { by_variance(b, z, own) } else { by_four(b, z - own) }.clamp(0.0, 1.0) as f32
    }
}

/// Chebyshev's one-sided bound on the share of depths ≥ z (Donnelly, Lauritzen 2006, eq. 5). `own` is the least
/// deviation.
fn by_variance(b: [f64; 4], z: f64, own: f64) -> f64 {
    // Before the mean depth the bound says nothing: lit.
    if z <= b[0] {
        return 1.0;
    }
    // σ² = E(z²) − E(z)², held above the spread of a tilted surface within a texel, which would shadow itself.
    let variance = (b[1] - b[0] * b[0]).max(own * own).max(1e-12);
    variance / (variance + (z - b[0]) * (z - b[0]))
}

/// The least share of depths < z that four moments allow, from 1 (Peters, Klein 2015, algorithm 3).
fn by_four(b: [f64; 4], z: f64) -> f64 {
    let [b1, b2, b3, b4] = b.map(|b| b + MIXED * (0.5 - b));
    // Cholesky's factors of the Hankel matrix [1 b1 b2; b1 b2 b3; b2 b3 b4] = L D Lᵀ, with those that rounding could
    // make negative held.
    let d22 = (b2 - b1 * b1).max(1e-18);
    let l32 = (b3 - b1 * b2) / d22;
    let d33 = (b4 - b2 * b2 - l32 * l32 * d22).max(1e-18);
    // Forward substitution of L D Lᵀ c = (1, z, z²)ᵀ, then division by D, then back substitution.
    let (c1, c2) = (1.0, z - b1);
    let c3 = z * z - b2 - l32 * c2;
    let (c2, c3) = (c2 / d22, c3 / d33);
    let c2 = c2 - l32 * c3;
    let c1 = c1 - b1 * c2 - b2 * c3;
    // The other two places of the mass: roots of c1 + c2 x + c3 x².
    let (p, q) = (c2 / c3, c1 / c3);
    let root = (p * p / 4.0 - q).max(0.0).sqrt();
    let (z2, z3) = (-p / 2.0 - root, -p / 2.0 + root);
    // The extremal distribution has its mass at z, z2 and z3; its share before z is the bound.
    let dark = if !(z2.is_finite() && z3.is_finite()) || z <= z2 {
        0.0
    } else if z <= z3 {
        (z * z3 - b1 * (z + z3) + b2) / ((z3 - z2) * (z - z2))
    } else {
        1.0 - (z2 * z3 - b1 * (z2 + z3) + b2) / ((z - z2) * (z - z3))
    };
    1.0 - dark
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With two depths of which a share is nearer, Chebyshev's bound is exact behind both (Donnelly, Lauritzen 2006,
    /// §3), and so are four moments.
    #[test]
    fn two_depths_are_told_exactly() {
        for (near, far, share) in [(0.2f64, 0.6f64, 0.25), (0.1, 0.9, 0.5), (0.45, 0.5, 0.8)] {
            let b = [1, 2, 3, 4].map(|k| share * near.powi(k) + (1.0 - share) * far.powi(k));
            assert!((by_variance(b, far, 0.0) - (1.0 - share)).abs() < 1e-9);
            let lit = by_four(b, far);
            assert!((lit - (1.0 - share)).abs() < 0.06, "{near} {far} {share}: {lit}");
            assert!(by_four(b, near - 0.05) > 0.99 && by_variance(b, near - 0.05, 0.0) == 1.0);
        }
        // Three depths: four moments know that nothing is lit behind all of them, two do not.
        let b = [1, 2, 3, 4].map(|k| (0.1f64.powi(k) + 0.4f64.powi(k)) / 2.0);
        assert!(by_four(b, 0.8) < 0.05 && by_variance(b, 0.8, 0.0) > 0.05);
    }
}

//! Cellular noise (Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996): distances to random points, one in each
//! cell of the lattice, and the cells of their Voronoi diagram.

use super::lattice::hash;
use steradian_math::{
    Vec3,
    hash::{mix32, unit_f32},
};

/// Distance metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// √(x² + y² + z²).
    Euclidean,
    /// |x| + |y| + |z|.
    Manhattan,
    /// max(|x|, |y|, |z|).
    Chebyshev,
}

impl Metric {
    fn length(self, d: Vec3) -> f32 {
        match self {
            Self::Euclidean => d.length(),
            Self::Manhattan => d.abs().element_sum(),
            Self::Chebyshev => d.abs().max_element(),
        }
    }
}

/// The random points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cellular {
    /// Distance metric.
    pub metric: Metric,
    /// Jitter of points from the middle of their cell: 0 a regular grid, 1 anywhere in it.
    pub jitter: f32,
    /// Which points.
    pub seed: u32,
    /// Points in the plane z = 0 alone, for textures over a surface.
    pub flat: bool,
}

/// The points nearest to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance to the nearest point.
    pub f1: f32,
    /// Distance to the second nearest.
    pub f2: f32,
    /// A random number in [0, 1) that belongs to the nearest point.
    pub cell: f32,
}

impl Cellular {
    fn point(&self, c: [i32; 3]) -> (Vec3, u32) {
        let h = hash(mix32(self.seed ^ 0x27d4_eb2f), c);
        let u = |salt: u32| unit_f32(mix32(h ^ salt)) - 0.5;
        let stray = Vec3::new(u(0x1b87_3593), u(0x85eb_ca6b), if self.flat { 0.0 } else { u(0xc2b2_ae35) });
        let middle = Vec3::new(0.5, 0.5, if self.flat { 0.0 } else { 0.5 });
        (middle + stray * self.jitter, h)
    }

    /// The nearest points. The cells around are visited ring by ring until none can hold a nearer second point.
    pub fn nearest(&self, p: Vec3) -> Nearest {
        let p = if p.is_finite() { p.to_array().map(|v| v % 1_073_741_824.0) } else { [0.0; 3] };
        let p = if self.flat { [p[0], p[1], 0.0] } else { p };
        let base = p.map(|v| v.floor() as i32);
        let d = Vec3::new(p[0] - base[0] as f32, p[1] - base[1] as f32, p[2] - base[2] as f32);
        let (mut f1, mut f2, mut owner) = (f32::INFINITY, f32::INFINITY, 0);
        let depth = |r: i32| if self.flat { 0..=0 } else { -r..=r };
        for ring in 0..=4_i32 {
            // Points of this ring are at least this far away, in any of the metrics.
            let inner = d.truncate().min_element().min(1.0 - d.truncate().max_element());
            let inner = if self.flat { inner } else { inner.min(d.z).min(1.0 - d.z) };
            if ring > 0 && f2 <= (ring - 1) as f32 + inner {
                break;
            }
            for k in depth(ring) {
                for j in -ring..=ring {
                    for i in -ring..=ring {
                        if i.abs().max(j.abs()).max(k.abs()) != ring {
                            continue;
                        }
                        let c = [base[0].wrapping_add(i), base[1].wrapping_add(j), base[2].wrapping_add(k)];
                        let (q, h) = self.point(c);
                        let distance = self.metric.length(q + Vec3::new(i as f32, j as f32, k as f32) - d);
                        if distance < f1 {
                            f2 = f1;
                            f1 = distance;
                            owner = h;
                        } else if distance < f2 {
                            f2 = distance;
                        }
                    }
                }
            }
        }
        Nearest { f1, f2, cell: unit_f32(mix32(owner ^ 0x165e_67b1)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    #[test]
    fn the_nearest_are_those_of_a_search_over_all_cells_around() {
        let mut rng = HashRng::new(3);
        for metric in [Metric::Euclidean, Metric::Manhattan, Metric::Chebyshev] {
            for flat in [false, true] {
                let c = Cellular { metric, jitter: 1.0, seed: 8, flat };
                for _ in 0..300 {
                    let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 20.0 - 10.0;
                    let p = if flat { Vec3::new(p.x, p.y, 0.0) } else { p };
                    let base = p.floor();
                    let mut all = Vec::new();
                    for k in if flat { 0..=0 } else { -4..=4 } {
                        for j in -4..=4 {
                            for i in -4..=4 {
                                let o = base + Vec3::new(i as f32, j as f32, k as f32);
                                let (q, h) = c.point(o.to_array().map(|v| v as i32));
                                all.push((metric.length(o + q - p), unit_f32(mix32(h ^ 0x165e_67b1))));
                            }
                        }
                    }
                    all.sort_by(|a, b| a.0.total_cmp(&b.0));
                    let n = c.nearest(p);
                    assert!((n.f1 - all[0].0).abs() < 1e-5 && (n.f2 - all[1].0).abs() < 1e-5, "{n:?} {:?}", &all[..2]);
                    assert!(n.cell == all[0].1 || all[1].0 - all[0].0 < 1e-5);
                }
            }
        }
    }

    #[test]
    fn without_jitter_it_is_a_grid() {
        let c = Cellular { metric: Metric::Euclidean, jitter: 0.0, seed: 1, flat: false };
        let n = c.nearest(Vec3::new(0.5, 0.5, 0.25));
        assert_eq!((n.f1, n.f2), (0.25, 0.75));
        assert!(c.nearest(Vec3::splat(f32::NAN)).f1.is_finite() && c.nearest(Vec3::splat(-3e38)).f2.is_finite());
    }
}

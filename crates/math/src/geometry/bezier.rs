//! Bicubic Bézier patches and their triangles (Farin, Curves and surfaces for CAGD, 5th ed. 2002, chapters 5 and 14).

use super::{Point3, surface::SurfaceMesh};
use glam::{DVec2, DVec3};

/// Default distance of triangles from the patches, as a part of the diagonal of the box around all control points.
const CLOSE: f64 = 1e-3;
/// Most segments along a side of a patch.
pub const MOST_SEGMENTS: u32 = 256;
/// Most segments of a side where the curvature decides.
const MOST_CHOSEN: f64 = 64.0;
/// Most cells of all patches.
const MOST_CELLS: usize = 1 << 23;
/// Derivatives that are smaller, of the patch's size, are none.
const NONE: f64 = 1e-9;

/// A patch `Σᵢⱼ Bᵢ(v) Bⱼ(u) p₄ᵢ₊ⱼ` over `[0, 1]²`.
#[derive(Clone, Copy, Debug)]
pub struct BezierPatch {
    /// Control points, four rows of four.
    pub points: [DVec3; 16],
}

/// Bernstein's polynomials and their first derivatives; of `1 − u` they are the same, backwards.
fn basis(u: f64) -> [[f64; 4]; 2] {
    let w = 1.0 - u;
    let (uu, ww) = (u * u, w * w);
    [
        [w * ww, 3.0 * (u * ww), 3.0 * (w * uu), u * uu],
        [-3.0 * ww, 3.0 * ww - 6.0 * (u * w), 6.0 * (u * w) - 3.0 * uu, 3.0 * uu],
    ]
}

impl BezierPatch {
    fn sum(&self, rows: [f64; 4], columns: [f64; 4]) -> DVec3 {
        let p = &self.points;
        // Pairs from both ends, so that an edge is the same from either.
        let four = |k: [f64; 4], p: [DVec3; 4]| (p[0] * k[0] + p[3] * k[3]) + (p[1] * k[1] + p[2] * k[2]);
        four(rows, [0, 4, 8, 12].map(|i| four(columns, [p[i], p[i + 1], p[i + 2], p[i + 3]])))
    }

    /// The point of the parameters.
    pub fn point(&self, u: f64, v: f64) -> DVec3 {
        self.sum(basis(v)[0], basis(u)[0])
    }

    /// `∂p/∂u`, `∂p/∂v` and `∂²p/∂u∂v`.
    pub fn partials(&self, u: f64, v: f64) -> [DVec3; 3] {
        let ([b, db], [c, dc]) = (basis(u), basis(v));
        [self.sum(c, db), self.sum(dc, b), self.sum(dc, db)]
    }

    /// The unit normal `∂u × ∂v`. Where an edge is a point, the derivative along it is that of the curves beside it, as
    /// far as they grow; where that does not help either, that of a place further inside counts.
    pub fn normal(&self, u: f64, v: f64) -> DVec3 {
        let size = self.points.iter().fold(0.0, |m: f64, p| m.max((*p - self.points[0]).length()));
        let at = |u: f64, v: f64| {
            let [mut du, mut dv, twist] = self.partials(u, v);
            let inside = |s: f64| if s < 0.5 { 1.0 } else { -1.0 };
            if du.length() <= NONE * size {
                du = twist * inside(v);
            }
            if dv.length() <= NONE * size {
                dv = twist * inside(u);
            }
            let n = du.cross(dv);
            if n.length() > NONE * du.length() * dv.length() { n.try_normalize() } else { None }
        };
        let further = |step: f64| at(u + (0.5 - u) * step, v + (0.5 - v) * step);
        at(u, v).or_else(|| further(1e-4)).or_else(|| further(1e-2)).unwrap_or(DVec3::Z)
    }

    /// The largest second difference of control points along rows or columns: second derivatives are within six times
    /// that.
    fn bend(&self) -> f64 {
        let p = &self.points;
        let bend = |i: usize, step: usize| (p[i] - p[i + step] * 2.0 + p[i + 2 * step]).length();
        let places = (0..16).filter(|i| i % 4 < 2).map(|i| bend(i, 1)).chain((0..8).map(|i| bend(i, 4)));
        places.fold(0.0, f64::max)
    }
}

/// Number of segments along each side that keeps triangles within a thousandth of the size of all patches: a chord of a
/// curve with second derivatives up to `M` is within `M / (8 n²)`, and there are two directions.
pub fn segments(patches: &[BezierPatch]) -> u32 {
    let points = || patches.iter().flat_map(|p| p.points);
    let (low, high) = points().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let bend = patches.iter().map(BezierPatch::bend).fold(0.0, f64::max);
    let n = (2.0 * 6.0 * bend / (8.0 * CLOSE * (high - low).length())).sqrt().ceil();
    // Points alone have no size, and nothing to divide by it.
    if n > 1.0 { n.min(MOST_CHOSEN) as u32 } else { 1 }
}

/// The patches as triangles, with `n` segments along each side of each; cells that shrink to a triangle get one.
/// Patches that share the control points of an edge have the same points on it. `None` for none, and for too many.
pub fn tessellate(patches: &[BezierPatch], n: u32) -> Option<SurfaceMesh> {
    let cells = patches.len().checked_mul((n as usize).pow(2))?;
    if n == 0 || n > MOST_SEGMENTS || cells > MOST_CELLS {
        return None;
    }
    // So that 1 − u is exact.
    let part = |k: u32| (f64::from(k) / f64::from(n) * 2.0_f64.powi(40)).round() * 2.0_f64.powi(-40);
    let mut mesh = SurfaceMesh::default();
    for patch in patches {
        let first = mesh.positions.len() as u32;
        for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
            let (u, v) = (part(i), part(j));
            mesh.positions.push(Point3::from_vector(patch.point(u, v)));
            mesh.normals.push(patch.normal(u, v));
            mesh.parameters.push(DVec2::new(u, v));
        }
        let index = |i: u32, j: u32| first + j * (n + 1) + i;
        for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
            let corners = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            for t in [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| corners[k])) {
                let [a, b, c] = t.map(|k| mesh.positions[k as usize]);
                if a != b && b != c && c != a {
                    mesh.triangles.push(t);
                }
            }
        }
    }
    Some(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ray, hash::HashRng, intersect::triangle};

    fn bumpy(seed: u64) -> BezierPatch {
        let mut rng = HashRng::new(seed);
        let mut n = || f64::from(rng.next_f32() - 0.5);
        BezierPatch {
            points: std::array::from_fn(|k| {
                DVec3::new((k % 4) as f64 / 3.0 + 0.2 * n(), (k / 4) as f64 / 3.0 + 0.2 * n(), 0.8 * n())
            }),
        }
    }

    /// An eighth of a sphere, with the four points of one row at its pole; near enough to a sphere of radius 1.
    fn octant() -> BezierPatch {
        let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
        let arc = [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]];
        let row = |[r, z]: [f64; 2]| arc.map(|[x, y]| DVec3::new(r * x, r * y, z));
        let rows = [row(arc[0]), row(arc[1]), row(arc[2]), row(arc[3])];
        BezierPatch { points: std::array::from_fn(|i| rows[i / 4][i % 4]) }
    }

    /// By repeated interpolation.
    fn de_casteljau(p: &BezierPatch, u: f64, v: f64) -> DVec3 {
        let curve = |mut q: [DVec3; 4], s: f64| {
            for last in (1..4).rev() {
                (0..last).for_each(|k| q[k] = q[k].lerp(q[k + 1], s));
            }
            q[0]
        };
        curve(std::array::from_fn(|i| curve(std::array::from_fn(|j| p.points[4 * i + j]), u)), v)
    }

    #[test]
    fn points_are_de_casteljaus_and_derivatives_their_differences() {
        let mut rng = HashRng::new(1);
        for seed in 0..20 {
            let p = bumpy(seed);
            for _ in 0..50 {
                let (u, v) = (f64::from(rng.next_f32()), f64::from(rng.next_f32()));
                assert!((p.point(u, v) - de_casteljau(&p, u, v)).length() < 1e-14);
                let h = 1e-4;
                let f = |a: f64, b: f64| de_casteljau(&p, u + a * h, v + b * h);
                let [du, dv, twist] = p.partials(u, v);
                assert!(((f(1.0, 0.0) - f(-1.0, 0.0)) / (2.0 * h) - du).length() < 1e-6);
                assert!(((f(0.0, 1.0) - f(0.0, -1.0)) / (2.0 * h) - dv).length() < 1e-6);
                let mixed = (f(1.0, 1.0) - f(1.0, -1.0) - f(-1.0, 1.0) + f(-1.0, -1.0)) / (4.0 * h * h);
                assert!((mixed - twist).length() < 1e-5);
            }
        }
    }

    #[test]
    fn normals_at_a_pole_are_its() {
        let p = octant();
        for k in 0..=8 {
            let u = f64::from(k) / 8.0;
            assert!((p.normal(u, 1.0) - DVec3::Z).length() < 1e-12, "{u}");
            for v in [0.0, 0.3, 0.9, 0.999] {
                let sphere = de_casteljau(&p, u, v).normalize();
                assert!((p.normal(u, v) - sphere).length() < 5e-3, "{u} {v}");
            }
        }
        let mesh = tessellate(&[p], 8).unwrap();
        assert_eq!(mesh.triangles.len(), 2 * 64 - 8);
        let point = BezierPatch { points: [DVec3::ONE; 16] };
        assert_eq!((point.normal(0.3, 0.3), tessellate(&[point], 4).unwrap().triangles.len()), (DVec3::Z, 0));
    }

    /// M62: rays meet the patch, by Newton's method, where they meet its triangles.
    #[test]
    fn rays_meet_the_patch_near_its_triangles() {
        let mut rng = HashRng::new(2);
        let (mut hits, mut worst) = (0, 0.0_f64);
        for seed in 30..36 {
            let patch = bumpy(seed);
            let n = segments(&[patch]);
            assert!((8..=40).contains(&n), "{n}");
            let mesh = tessellate(&[patch], n).unwrap();
            for _ in 0..60 {
                let mut c = || rng.next_f32();
                let (from, to) = (crate::Vec3::new(c(), c(), 3.0), crate::Vec3::new(c(), c(), -0.5));
                let ray = Ray::new(from, to - from);
                let (o, d) = (from.as_dvec3(), (to - from).as_dvec3());
                let met = mesh.triangles.iter().filter_map(|t| {
                    let corners = t.map(|k| mesh.positions[k as usize].to_vector().as_vec3());
                    triangle(corners, &ray).map(|h| (h, *t))
                });
                let Some((h, t)) = met.min_by(|a, b| a.0.t.total_cmp(&b.0.t)) else { continue };
                let weights = [1.0 - h.u - h.v, h.u, h.v].map(f64::from);
                let mix = |f: &dyn Fn(usize) -> DVec3| (0..3).map(|k| f(t[k] as usize) * weights[k]).sum::<DVec3>();
                let uv = mix(&|k| mesh.parameters[k].extend(0.0));
                let n = mix(&|k| mesh.normals[k]).normalize();
                let mut x = DVec3::new(uv.x, uv.y, f64::from(h.t));
                for _ in 0..20 {
                    let miss = patch.point(x.x, x.y) - (o + d * x.z);
                    let [du, dv, _] = patch.partials(x.x, x.y);
                    x -= glam::DMat3::from_cols(du, dv, -d).inverse() * miss;
                }
                let exact = patch.normal(x.x, x.y);
                let slant = exact.dot(d.normalize()).abs();
                if slant < 0.3 || x.min_element() < 0.0 || x.truncate().max_element() > 1.0 {
                    continue;
                }
                let off = (patch.point(x.x, x.y) - (o + d * f64::from(h.t))).length() * slant;
                worst = worst.max(off);
                assert!((n - exact).length() < 0.02 && (x - uv).truncate().length() < 0.02, "{n} {exact}");
                hits += 1;
            }
        }
        // A thousandth of the diagonal, which is about 1.7.
        assert!(hits > 150 && worst < 1.7e-3, "{hits} {worst}");
    }

    /// Two patches with an edge in common, which one has backwards and the other along the other parameter.
    #[test]
    fn shared_edges_are_the_same_points() {
        let a = bumpy(50);
        let mut b = bumpy(51);
        (0..4).for_each(|k| b.points[4 * k] = a.points[3 - k]);
        for n in [1, 3, 7, 10, 33] {
            let mesh = tessellate(&[a, b], n).unwrap();
            let half = mesh.positions.len() / 2;
            for k in 0..=n as usize {
                let (p, q) = (mesh.positions[n as usize - k], mesh.positions[half + k * (n as usize + 1)]);
                assert_eq!(p, q, "{n} {k}");
            }
        }
        assert!(tessellate(&[a], 0).is_none() && tessellate(&[a], MOST_SEGMENTS + 1).is_none());
        assert!(tessellate(&vec![a; 200], MOST_SEGMENTS).is_none());
    }
}

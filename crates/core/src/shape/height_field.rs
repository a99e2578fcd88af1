//! Height fields: heights over the unit square, bilinear between the samples, that are traced without triangles.
//!
//! Blocks of 8 × 8 cells are primitives of the hierarchy, so that rays skip what lies far above or below. Within a
//! block, a ray goes from cell to cell (Amanatides, Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing"), and
//! meets the surface of each at the roots of a quadratic. Only the heights are kept, a twentieth of what a mesh takes.

use super::{SurfacePoint, patch::quadratic_roots};
use crate::relief::HeightField;
use glam::{DVec2, DVec3};
use steradian_accel::UserHit;
use steradian_math::{Bounds3, Ray, Vec2, Vec3, ray::gamma, transform::Affine};
use steradian_scene::Mesh;

/// Cells along a side of a block.
const BLOCK: usize = 8;

/// Tolerance of hits outside a cell, in cells: it covers the rounding of `f64`, so that rays do not slip between cells.
const EDGE: f64 = 1e-9;

/// A height field, placed in the space it is traced in. Parameters are the places in the unit square.
#[derive(Clone, Debug)]
pub struct Field {
    /// The heights.
    pub relief: HeightField,
    /// From the space of the unit square, with heights along z.
    pub place: Affine,
    /// True if normals point down.
    pub flip: bool,
    /// Enables shading normals that are smooth over the borders of cells.
    pub smooth: bool,
}

impl Field {
    /// Number of blocks along u and v.
    fn blocks(&self) -> (usize, usize) {
        let (w, h) = self.relief.cells();
        (w.div_ceil(BLOCK), h.div_ceil(BLOCK))
    }

    /// Number of blocks.
    pub fn count(&self) -> u32 {
        let (w, h) = self.blocks();
        (w * h) as u32
    }

    /// The cells of a block: first and past the last along u, the same along v.
    fn cells(&self, block: u32) -> [usize; 4] {
        let (w, h) = self.relief.cells();
        let across = self.blocks().0;
        let (i, j) = (block as usize % across * BLOCK, block as usize / across * BLOCK);
        [i, (i + BLOCK).min(w), j, (j + BLOCK).min(h)]
    }

    /// The box around a block.
    pub fn bounds(&self, block: u32) -> Bounds3 {
        let [i0, i1, j0, j1] = self.cells(block);
        let (w, h) = self.relief.cells();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for z in (j0..=j1).flat_map(|j| (i0..=i1).map(move |i| (i, j))).map(|(i, j)| self.relief.sample(i, j)) {
            (low, high) = (low.min(z), high.max(z));
        }
        let at = |i: usize, j: usize, z: f32| Vec3::new(i as f32 / w as f32, j as f32 / h as f32, z);
        let local = Bounds3 { min: at(i0, j0, low), max: at(i1, j1, high) };
        let placed = self.place.bounds(&local);
        let error = self.place.point_error(local.min.abs().max(local.max.abs()), Vec3::ZERO);
        Bounds3 { min: placed.min - error, max: placed.max + error }
    }

    /// The nearest hit with a block in `(0, t_max)` that counts, from above or below.
    pub fn intersect(&self, block: u32, ray: &Ray, counts: impl Fn(&UserHit) -> bool) -> Option<UserHit> {
        let local = self.place.inverse().ray(ray);
        let (w, h) = self.relief.cells();
        // In cells along x and y.
        let size = DVec3::new(w as f64, h as f64, 1.0);
        let (o, d) = (local.origin.as_dvec3() * size, local.direction.as_dvec3() * size);
        let [i0, i1, j0, j1] = self.cells(block);
        let (mut near, mut far) = (0.0_f64, f64::from(ray.t_max));
        for (o, d, low, high) in [(o.x, d.x, i0, i1), (o.y, d.y, j0, j1)] {
            let (low, high) = (low as f64, high as f64);
            if d == 0.0 {
                if o < low - EDGE || o > high + EDGE {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - o) / d, (high - o) / d);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        if near > far {
            return None;
        }
        let start = o + d * near;
        let first = |x: f64, low: usize, high: usize| (x.floor().max(low as f64) as usize).min(high - 1);
        let (mut i, mut j) = (first(start.x, i0, i1), first(start.y, j0, j1));
        // Where the ray leaves the cell along an axis, and the next cell there; none where it leaves the block.
        let exit = |o: f64, d: f64, i: usize| {
            if d == 0.0 { f64::INFINITY } else { ((i + usize::from(d > 0.0)) as f64 - o) / d }
        };
        let next = |d: f64, i: usize, low: usize, high: usize| {
            if d > 0.0 { Some(i + 1).filter(|&i| i < high) } else { i.checked_sub(1).filter(|&i| i >= low) }
        };
        loop {
            let mut hits = self.cell_hits(i, j, start, d, near).into_iter().flatten();
            if let Some(hit) = hits.find(|h| h.t > 0.0 && h.t < ray.t_max && counts(h)) {
                return Some(hit);
            }
            let (x, y) = (exit(o.x, d.x, i), exit(o.y, d.y, j));
            if x.min(y) >= far {
                return None;
            }
            if x < y {
                i = next(d.x, i, i0, i1)?;
            } else {
                j = next(d.y, j, j0, j1)?;
            }
        }
    }

    /// The hits with a cell, nearest first. The ray is at `start` at the parameter `near`, from which roots are
    /// counted, since differences are small there.
    #[inline]
    fn cell_hits(&self, i: usize, j: usize, start: DVec3, d: DVec3, near: f64) -> [Option<UserHit>; 2] {
        let [a, b, c, e] = self.relief.corners(i, j).map(f64::from);
        // Height a + (b − a)s + (c − a)q + twist·sq.
        let (along, up, twist) = (b - a, c - a, a - b - c + e);
        let (s, q) = (start.x - i as f64, start.y - j as f64);
        let [r0, r1] = quadratic_roots(
            twist * d.x * d.y,
            along * d.x + up * d.y + twist * (s * d.y + q * d.x) - d.z,
            a + along * s + up * q + twist * s * q - start.z,
        );
        let inside = |x: f64| (-EDGE..=1.0 + EDGE).contains(&x);
        let hit = |r: f64| {
            let (s, q) = (s + d.x * r, q + d.y * r);
            (inside(s) && inside(q)).then(|| {
                let (w, h) = self.relief.cells();
                let uv =
                    DVec2::new((i as f64 + s) / w as f64, (j as f64 + q) / h as f64).clamp(DVec2::ZERO, DVec2::ONE);
                UserHit { t: (near + r) as f32, u: uv.x as f32, v: uv.y as f32 }
            })
        };
        if r0 <= r1 { [hit(r0), hit(r1)] } else { [hit(r1), hit(r0)] }
    }

    /// The surface at a place.
    pub fn surface(&self, u: f32, v: f32) -> SurfacePoint {
        let uv = Vec2::new(u, v);
        let slope = self.relief.slope(uv);
        let p = uv.extend(self.relief.at(uv));
        let corners: f32 = self.relief.corners_at(uv).into_iter().map(f32::abs).sum();
        let error = Vec3::Z * (corners * gamma(6) + (slope.x.abs() + slope.y.abs()) * gamma(3));
        let sign = if self.flip { -1.0 } else { 1.0 };
        let normal = |slope: Vec2| self.place.normal((-slope).extend(1.0)).normalize_or_zero() * sign;
        let n = normal(slope);
        // As of a mesh: unit normals of the samples, bilinear between them.
        let smooth = || {
            let (i, j) = self.relief.cell(uv);
            let (w, h) = self.relief.cells();
            let (s, q) = (u * w as f32 - i as f32, v * h as f32 - j as f32);
            let row =
                |j: usize| normal(self.relief.vertex_slope(i, j)).lerp(normal(self.relief.vertex_slope(i + 1, j)), s);
            row(j).lerp(row(j + 1), q).normalize_or(n)
        };
        SurfacePoint {
            p: self.place.point(p),
            error: self.place.point_error(p, error),
            n,
            ns: if self.smooth { smooth() } else { n },
            dpdu: self.place.vector(Vec3::new(1.0, 0.0, slope.x)),
            uv,
        }
    }

    /// ∂p/∂v at a place.
    pub fn dpdv(&self, u: f32, v: f32) -> Vec3 {
        self.place.vector(Vec3::new(0.0, 1.0, self.relief.slope(Vec2::new(u, v)).y))
    }

    /// Mesh of the surface's bilinear patches, not yet placed.
    pub fn mesh(&self) -> Mesh {
        let (w, h) = self.relief.cells();
        let at = |i: usize, j: usize| Vec2::new(i as f32 / w as f32, j as f32 / h as f32);
        let vertices = || (0..=h).flat_map(move |j| (0..=w).map(move |i| (i, j)));
        let row = w as u32 + 1;
        let corner = |i: usize, j: usize| j as u32 * row + i as u32;
        let normal = |(i, j)| (-self.relief.vertex_slope(i, j)).extend(1.0).normalize_or(Vec3::Z).to_array();
        Mesh {
            positions: vertices().map(|(i, j)| at(i, j).extend(self.relief.sample(i, j)).to_array()).collect(),
            normals: if self.smooth { vertices().map(normal).collect() } else { Vec::new() },
            uvs: vertices().map(|(i, j)| at(i, j).to_array()).collect(),
            patches: (0..h)
                .flat_map(|j| (0..w).map(move |i| corner(i, j)))
                .map(|a| [a, a + 1, a + row, a + row + 1])
                .collect(),
            ..Mesh::default()
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let (w, h) = self.relief.cells();
        (w + 1) * (h + 1) * size_of::<f32>() + size_of::<Self>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::PatchMesh;
    use steradian_math::{DVec3, Transform, hash::HashRng, warp};

    fn field(w: usize, h: usize, place: &Transform, smooth: bool) -> Field {
        let mut rng = HashRng::new(7);
        let rough: Vec<f32> = (0..w * h).map(|_| 0.01 * rng.next_f32()).collect();
        let wave = HeightField::sampled(w, h, |p| 0.15 * (9.0 * p.x).sin() * (7.0 * p.y).cos()).unwrap();
        let data = (0..w * h).map(|k| rough[k] + wave.sample(k % w, k / w)).collect();
        let relief = HeightField::new(w, h, data);
        Field {
            relief: relief.unwrap(),
            place: place.affine().unwrap(),
            flip: place.swaps_handedness() && !smooth,
            smooth,
        }
    }

    fn nearest(count: u32, mut hit: impl FnMut(u32) -> Option<UserHit>) -> Option<(u32, UserHit)> {
        (0..count).filter_map(|k| Some((k, hit(k)?))).min_by(|a, b| a.1.t.total_cmp(&b.1.t))
    }

    /// Heights are the same surface as the mesh of bilinear patches between them: from all sides, placed, and mirrored.
    #[test]
    fn hits_are_those_of_the_mesh() {
        let places = [
            Transform::IDENTITY,
            Transform::translate(DVec3::new(3.0, -20.0, 5.0))
                * Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 1.0)
                * Transform::scale(DVec3::new(2.0, -0.7, 1.5)),
        ];
        for (place, (w, h), smooth) in
            [(places[0], (21, 34), false), (places[1], (9, 50), true), (places[0], (2, 2), true)]
        {
            let field = field(w, h, &place, smooth);
            let mesh = field.mesh();
            assert!(mesh.validate().is_ok());
            let patches = PatchMesh::new(&mesh, &place.affine().unwrap(), place.swaps_handedness(), false, !smooth);
            let mut rng = HashRng::new(1);
            let (mut hits, mut differ) = (0, 0);
            const RAYS: usize = 1500;
            for k in 0..RAYS {
                let mut u = || rng.next_f32();
                let (target, from) = (Vec3::new(u(), u(), 0.3 * u() - 0.15), Vec2::new(u(), u()));
                // From above and below, and at times straight down.
                let mut origin = target + warp::uniform_sphere(from) * 2.0;
                if k % 10 == 0 {
                    origin = target + Vec3::Z * 2.0;
                }
                let (a, b) = (field.place.point(origin), field.place.point(target));
                let ray = Ray::new(a, (b - a).normalize());
                let found = nearest(field.count(), |b| field.intersect(b, &ray, |_| true));
                let meshed = nearest(patches.patches.len() as u32, |p| patches.intersect(p, &ray));
                match (found, meshed) {
                    (Some((block, f)), Some((patch, m))) if (f.t - m.t).abs() < 1e-4 * m.t => {
                        let (s, p) = (field.surface(f.u, f.v), patches.surface(patch, m.u, m.v));
                        // Rays straight along an edge may be given to either patch.
                        let same = s.n.dot(p.n) > 0.999;
                        assert!((s.p - p.p).length() < 1e-4 && (s.uv - p.uv).length() < 1e-4, "{k}");
                        assert!(!same || s.ns.dot(p.ns) > 0.999, "{k}: {} {}", s.ns, p.ns);
                        assert!((ray.at(f.t) - s.p).length() < 1e-4, "{k}");
                        let bounds = field.bounds(block);
                        assert!(s.p.cmpge(bounds.min - s.error).all() && s.p.cmple(bounds.max + s.error).all());
                        (hits, differ) = (hits + 1, differ + usize::from(!same));
                    }
                    (None, None) => {}
                    _ => differ += 1,
                }
            }
            assert!(hits > RAYS / 3, "{hits}");
            assert!(differ * 300 <= RAYS, "{differ} of {hits}, {w} × {h}");
        }
    }

    /// Rays at the borders of cells and of blocks do not slip through.
    #[test]
    fn borders_are_closed() {
        let field = field(33, 33, &Transform::IDENTITY, false);
        let mut rng = HashRng::new(2);
        for k in 0..20_000 {
            let (i, j) = ((rng.next_u64() % 31 + 1) as u32, (rng.next_u64() % 31 + 1) as u32);
            let on = |i: u32| i as f32 / 32.0;
            let x = if k % 2 == 0 { on(i) } else { 0.1 + 0.8 * rng.next_f32() };
            let target = Vec3::new(x, on(j), field.relief.at(Vec2::new(x, on(j))));
            let origin = target + Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, 3.0) * 0.5;
            let origin = if k % 3 == 0 { Vec3::new(target.x, origin.y, origin.z) } else { origin };
            let ray = Ray::new(origin, target - origin);
            let hit = nearest(field.count(), |b| field.intersect(b, &ray, |_| true));
            assert!(hit.is_some_and(|(_, h)| h.t < 1.001), "{k}: {ray:?}");
        }
    }

    /// Derivatives are differences, and smooth normals meet at the borders of cells.
    #[test]
    fn derivatives_and_smooth_normals() {
        let place = Transform::scale(DVec3::new(2.0, 1.0, 3.0));
        let field = field(17, 13, &place, true);
        let h = 1e-3;
        for uv in [Vec2::new(0.53, 0.3), Vec2::new(0.21, 0.79)] {
            let at = |d: Vec2| field.surface(uv.x + d.x, uv.y + d.y).p;
            let (du, dv) =
                ((at(Vec2::X * h) - at(-Vec2::X * h)) / (2.0 * h), (at(Vec2::Y * h) - at(-Vec2::Y * h)) / (2.0 * h));
            let s = field.surface(uv.x, uv.y);
            assert!((du - s.dpdu).length() < 1e-2 && (dv - field.dpdv(uv.x, uv.y)).length() < 1e-2, "{du} {dv}");
            assert!(s.n.dot(s.dpdu).abs() < 1e-4 && s.n.z > 0.0);
        }
        let across = |u: f32| field.surface(u, 0.4).ns;
        assert!(across(0.25 - 1e-5).dot(across(0.25 + 1e-5)) > 0.999_99);
        let relief = HeightField::sampled(4, 5, |p| 0.5 * p.x - 0.25 * p.y).unwrap();
        let plane = Field { relief, place: Affine::IDENTITY, flip: false, smooth: true };
        assert!((plane.surface(0.01, 0.97).ns - Vec3::new(-0.5, 0.25, 1.0).normalize()).length() < 1e-5);
    }

    #[test]
    fn hostile_rays_are_harmless() {
        let field = field(12, 12, &Transform::IDENTITY, false);
        for (o, d) in [
            (Vec3::NAN, Vec3::X),
            (Vec3::ZERO, Vec3::NAN),
            (Vec3::splat(0.5), Vec3::ZERO),
            (Vec3::splat(f32::MAX), -Vec3::ONE),
            (Vec3::splat(0.5), Vec3::splat(f32::INFINITY)),
            (Vec3::new(0.5, 0.5, 1.0), Vec3::splat(1e-38)),
        ] {
            for block in 0..field.count() {
                if let Some(hit) = field.intersect(block, &Ray::new(o, d), |_| true) {
                    assert!(hit.t > 0.0 && (0.0..=1.0).contains(&hit.u) && (0.0..=1.0).contains(&hit.v));
                }
            }
        }
    }
}

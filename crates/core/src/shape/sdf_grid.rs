//! The zero set of a signed distance function that is given on a grid over the unit cube and trilinear between its
//! samples (Hansson-Söderlund, Evans, Akenine-Möller, "Ray tracing of signed distance function grids", JCGT 11(3),
//! 2022).
//!
//! Cells that the surface passes are primitives of the hierarchy. Along a ray the function is a cubic in each (their
//! eq. 4), of which all roots are found between its extrema. The normal points to where the function grows; across
//! cells it jumps, unless the normals of the eight cells around a point are interpolated (their section 5).

use super::{SurfacePoint, patch::quadratic_roots};
use glam::DVec3;
use std::sync::Arc;
use steradian_accel::UserHit;
use steradian_image::VoxelGrid;
use steradian_math::{Bounds3, Ray, Vec2, Vec3, ray::gamma, transform::Affine};

/// Tolerance of hits outside a cell, as a part of the ray's length in it: it covers the rounding of `f64`, so that rays
/// do not slip between cells.
const EDGE: f64 = 1e-9;

/// Most cells that the surface may pass.
pub const MOST: usize = 1 << 25;

/// A surface on a grid, placed in the space it is traced in.
#[derive(Clone, Debug)]
pub struct SdfGrid {
    grid: Arc<VoxelGrid>,
    place: Affine,
    flip: bool,
    smooth: bool,
    /// The cells that the surface passes, by number: x innermost.
    cells: Vec<u32>,
}

/// A polynomial `Σ kᵢ` over {1, x, y, z, xy, yz, zx, xyz} in a cell.
struct Trilinear([f64; 8]);

impl Trilinear {
    /// By the values at the corners, x innermost.
    fn new(f: [f64; 8]) -> Self {
        let [a, x, y, xy, z, xz, yz, xyz] = f;
        Self([
            a,
            x - a,
            y - a,
            z - a,
            xy - x - y + a,
            yz - y - z + a,
            xz - x - z + a,
            xyz - xy - yz - xz + x + y + z - a,
        ])
    }

    fn value(&self, p: DVec3) -> f64 {
        let k = &self.0;
        k[0] + k[1] * p.x
            + k[2] * p.y
            + k[3] * p.z
            + k[4] * p.x * p.y
            + k[5] * p.y * p.z
            + k[6] * p.z * p.x
            + k[7] * p.x * p.y * p.z
    }

    fn gradient(&self, p: DVec3) -> DVec3 {
        let k = &self.0;
        DVec3::new(
            k[1] + k[4] * p.y + k[6] * p.z + k[7] * p.y * p.z,
            k[2] + k[4] * p.x + k[5] * p.z + k[7] * p.z * p.x,
            k[3] + k[5] * p.y + k[6] * p.x + k[7] * p.x * p.y,
        )
    }

    /// The coefficients of its values along `p + u d`, constant first.
    fn along(&self, p: DVec3, d: DVec3) -> [f64; 4] {
        let k = &self.0;
        let square = k[4] * d.x * d.y
            + k[5] * d.y * d.z
            + k[6] * d.z * d.x
            + k[7] * (p.x * d.y * d.z + p.y * d.z * d.x + p.z * d.x * d.y);
        [self.value(p), self.gradient(p).dot(d), square, k[7] * d.x * d.y * d.z]
    }
}

/// The roots of a cubic between two places, in order.
fn roots([c0, c1, c2, c3]: [f64; 4], low: f64, high: f64) -> impl Iterator<Item = f64> {
    let f = move |u: f64| ((c3 * u + c2) * u + c1) * u + c0;
    let slope = move |u: f64| (3.0 * c3 * u + 2.0 * c2) * u + c1;
    let [a, b] = quadratic_roots(3.0 * c3, 2.0 * c2, c1);
    let inside = |u: f64| if u > low && u < high { u } else { high };
    let (a, b) = (inside(a), inside(b));
    // Between these it is monotone.
    let ends = [low, a.min(b), a.max(b), high];
    (0..3).filter_map(move |k| {
        let (mut low, mut high) = (ends[k], ends[k + 1]);
        let (first, last) = (f(low), f(high));
        // A root at a border counts once, in the interval that ends there; one at the very start counts too.
        let crosses = if first == 0.0 { k == 0 && last != 0.0 } else { last == 0.0 || (first < 0.0) != (last < 0.0) };
        if low >= high || !crosses {
            return None;
        }
        if first == 0.0 || last == 0.0 {
            return Some(if first == 0.0 { low } else { high });
        }
        // Newton's steps where they stay between what is known, else halves.
        let mut u = 0.5 * (low + high);
        for _ in 0..80 {
            let value = f(u);
            if (value < 0.0) == (first < 0.0) && value != 0.0 {
                low = u
            } else {
                high = u
            }
            let next = u - value / slope(u);
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - u).abs() <= 1e-15 {
                return Some(next);
            }
            u = next;
        }
        Some(u)
    })
}

impl SdfGrid {
    /// The surface on a grid of finite numbers of one channel, at least two along each axis; `None` where that is not
    /// so, or the surface passes too many cells. `flip` turns the normals to where the function falls; `smooth`
    /// interpolates shading normals.
    pub fn new(grid: Arc<VoxelGrid>, place: Affine, flip: bool, smooth: bool) -> Option<Self> {
        let count = grid.size.iter().try_fold(1_usize, |n, s| n.checked_mul(*s))?;
        let is_sound = grid.channels == 1 && grid.size.iter().all(|s| *s >= 2) && grid.data.len() == count;
        if !is_sound || u32::try_from(count).is_err() || !grid.data.iter().all(|v| v.is_finite()) {
            return None;
        }
        let mut surface = Self { grid, place, flip, smooth, cells: Vec::new() };
        let [w, h, d] = surface.size();
        for cell in 0..(w * h * d) as u32 {
            let f = surface.corners(surface.cell(cell));
            if !(f.iter().all(|v| *v > 0.0) || f.iter().all(|v| *v < 0.0)) {
                if surface.cells.len() == MOST {
                    return None;
                }
                surface.cells.push(cell);
            }
        }
        Some(surface)
    }

    /// Cells along x, y, z.
    fn size(&self) -> [usize; 3] {
        self.grid.size.map(|n| n - 1)
    }

    /// The place of a cell.
    fn cell(&self, number: u32) -> [usize; 3] {
        let [w, h, _] = self.size();
        let number = number as usize;
        [number % w, number / w % h, number / (w * h)]
    }

    fn sample(&self, x: usize, y: usize, z: usize) -> f64 {
        let [w, h, _] = self.grid.size;
        f64::from(self.grid.data[(z * h + y) * w + x])
    }

    /// The values at the corners of a cell, x innermost.
    fn corners(&self, [x, y, z]: [usize; 3]) -> [f64; 8] {
        std::array::from_fn(|i| self.sample(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2)))
    }

    /// Number of primitives.
    pub fn count(&self) -> u32 {
        self.cells.len() as u32
    }

    /// The box around a primitive.
    pub fn bounds(&self, prim: u32) -> Bounds3 {
        let cell = self.cell(self.cells[prim as usize]);
        let size = self.size();
        let corner = |k: usize| Vec3::from_array(std::array::from_fn(|a| (cell[a] + k) as f32 / size[a] as f32));
        let local = Bounds3 { min: corner(0), max: corner(1) };
        let placed = self.place.bounds(&local);
        let error = self.place.point_error(local.max, local.max * gamma(1));
        Bounds3 { min: placed.min - error, max: placed.max + error }
    }

    /// The nearest hit with a primitive in `(0, t_max)` that counts, from either side.
    pub fn intersect(&self, prim: u32, ray: &Ray, counts: impl Fn(&UserHit) -> bool) -> Option<UserHit> {
        let local = self.place.inverse().ray(ray);
        let cell = self.cell(self.cells[prim as usize]);
        let scale = DVec3::from_array(self.size().map(|n| n as f64));
        let corner = DVec3::from_array(cell.map(|n| n as f64));
        let (o, d) = (local.origin.as_dvec3() * scale - corner, local.direction.as_dvec3() * scale);
        let (mut near, mut far) = (0.0_f64, f64::from(ray.t_max));
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if !(-EDGE..=1.0 + EDGE).contains(&o[axis]) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-o[axis] / d[axis], (1.0 - o[axis]) / d[axis]);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        // Rays may pass through an edge exactly.
        let slack = EDGE * (1.0 + near.abs());
        if near > far + slack {
            return None;
        }
        let way = (far - near).max(slack);
        let cubic = Trilinear::new(self.corners(cell)).along(o + d * near, d * way);
        roots(cubic, -EDGE, 1.0 + EDGE).find_map(|u| {
            let hit = UserHit { t: (near + u * way) as f32, u: 0.0, v: 0.0 };
            (hit.t > 0.0 && hit.t < ray.t_max && counts(&hit)).then_some(hit)
        })
    }

    /// The surface where a ray meets a primitive at `t`.
    pub fn surface(&self, prim: u32, ray: &Ray, t: f32) -> SurfacePoint {
        let local = self.place.inverse().ray(ray);
        let cell = self.cell(self.cells[prim as usize]);
        let scale = DVec3::from_array(self.size().map(|n| n as f64));
        let corner = DVec3::from_array(cell.map(|n| n as f64));
        let f = Trilinear::new(self.corners(cell));
        let mut p = (local.origin.as_dvec3() + local.direction.as_dvec3() * f64::from(t)) * scale - corner;
        p = p.clamp(DVec3::ZERO, DVec3::ONE);
        // The hit is rounded: back onto the surface.
        for _ in 0..2 {
            let g = f.gradient(p);
            let step = g * (f.value(p) / g.length_squared());
            if step.length_squared() < 1e-4 {
                p -= step;
            }
        }
        let sign = if self.flip { -1.0 } else { 1.0 };
        let world = |n: DVec3| self.place.normal(n.as_vec3()).normalize_or_zero() * sign;
        let n = world((f.gradient(p) * scale).normalize_or_zero());
        let at = ((p + corner) / scale).as_vec3();
        let smooth = if self.smooth { world(self.smooth_normal(p + corner)) } else { n };
        SurfacePoint {
            ns: if smooth.dot(n) > 0.0 { smooth } else { n },
            uv: Vec2::ZERO,
            ..SurfacePoint::bare(self.place.point(at), self.place.point_error(at, at.abs() * gamma(2)), n)
        }
    }

    /// The value at a place in cells, held within the grid.
    fn value(&self, p: DVec3) -> f64 {
        let size = self.size();
        let held = std::array::from_fn::<f64, 3, _>(|a| p[a].clamp(0.0, size[a] as f64));
        let cell: [usize; 3] = std::array::from_fn(|a| (held[a] as usize).min(size[a] - 1));
        let within = std::array::from_fn::<f64, 3, _>(|a| held[a] - cell[a] as f64);
        Trilinear::new(self.corners(cell)).value(within.into())
    }

    /// The unit normals of the eight cells around the nearest corner, as they are at `p` (in cells), interpolated
    /// between the middles of cells. Cells outside the grid do not count (in Mitsuba those past its end do, with no
    /// slope across it).
    fn smooth_normal(&self, p: DVec3) -> DVec3 {
        let scale = DVec3::from_array(self.size().map(|n| n as f64));
        let first = p.round() - 1.0;
        let weight = p - first - 0.5;
        let mut sum = DVec3::ZERO;
        for i in 0..8 {
            let offset = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
            let cell = first + offset;
            if cell.min_element() < 0.0 || cell.cmpge(scale).any() {
                continue;
            }
            let slope = |axis: usize| {
                let at = |k: f64| {
                    let mut q = p;
                    q[axis] = cell[axis] + k;
                    self.value(q)
                };
                (at(1.0) - at(0.0)) * scale[axis]
            };
            let normal = DVec3::new(slope(0), slope(1), slope(2)).normalize_or_zero();
            let is_alone = |axis: usize| first[axis] < 0.0 || first[axis] + 1.0 >= scale[axis];
            let share = |axis: usize| match (is_alone(axis), offset[axis] > 0.0) {
                (true, _) => 1.0,
                (false, true) => weight[axis],
                (false, false) => 1.0 - weight[axis],
            };
            sum += normal * (share(0) * share(1) * share(2));
        }
        sum.normalize_or_zero()
    }

    /// Bytes held beside the grid.
    pub fn bytes(&self) -> usize {
        self.cells.len() * size_of::<u32>() + self.grid.data.len() * size_of::<f32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{DVec3 as D, Transform, hash::HashRng, ray::offset_ray_origin, warp};

    fn grid(size: [usize; 3], f: impl Fn(DVec3) -> f64) -> Arc<VoxelGrid> {
        let at = |k: usize, n: usize| k as f64 / (n - 1) as f64;
        let [w, h, d] = size;
        let places = (0..w * h * d).map(|i| DVec3::new(at(i % w, w), at(i / w % h, h), at(i / (w * h), d)));
        let data = places.map(|p| f(p) as f32).collect();
        Arc::new(VoxelGrid { size, channels: 1, bounds: [[0.0; 3], [1.0; 3]], data })
    }

    fn surface(size: [usize; 3], place: &Transform, smooth: bool, f: impl Fn(DVec3) -> f64) -> SdfGrid {
        SdfGrid::new(grid(size, f), place.affine().unwrap(), false, smooth).unwrap()
    }

    fn nearest(s: &SdfGrid, ray: &Ray) -> Option<(u32, f32)> {
        let hits = (0..s.count()).filter_map(|k| Some((k, s.intersect(k, ray, |_| true)?.t)));
        hits.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn places() -> [Transform; 2] {
        let turned = Transform::translate(D::new(3.0, -20.0, 5.0))
            * Transform::rotate(D::new(1.0, 2.0, 0.5), 1.0)
            * Transform::scale(D::new(2.0, -0.7, 1.5));
        [Transform::IDENTITY, turned]
    }

    /// Rays through the cube, in the space it is placed in.
    fn rays(s: &SdfGrid, count: usize) -> Vec<Ray> {
        let mut rng = HashRng::new(3);
        let mut u = || rng.next_f32();
        (0..count)
            .map(|k| {
                let target = Vec3::new(u(), u(), u());
                let mut from = Vec3::splat(0.5) + warp::uniform_sphere(Vec2::new(u(), u())) * 2.0;
                if k % 5 == 0 {
                    // Along an axis.
                    from = target;
                    from[k / 5 % 3] = -1.0;
                }
                let (a, b) = (s.place.point(from), s.place.point(target));
                Ray::new(a, (b - a).normalize())
            })
            .collect()
    }

    /// A linear function is exact: hits lie in the plane, and both kinds of normals are its own.
    #[test]
    fn planes_are_exact() {
        let n = DVec3::new(0.6, -0.48, 0.64);
        for place in places() {
            for smooth in [false, true] {
                let s = surface([5, 3, 7], &place, smooth, |p| (p - 0.45).dot(n));
                let covector = s.place.normal(n.as_vec3()).normalize();
                let through = s.place.point(Vec3::splat(0.45));
                let mut hits = 0;
                for ray in rays(&s, 600) {
                    // Where the ray meets the plane, if that is in the cube.
                    let t = covector.dot(through - ray.origin) / covector.dot(ray.direction);
                    let local = s.place.inverse().point(ray.at(t));
                    let edge = local.min_element().min(1.0 - local.max_element());
                    match nearest(&s, &ray) {
                        Some((prim, found)) => {
                            assert!(edge > -1e-4 && (found - t).abs() < 1e-4 * (1.0 + t), "{found} {t}");
                            let point = s.surface(prim, &ray, found);
                            let off = (point.p - through).dot(covector).abs();
                            assert!(off <= 2.0 * point.error.dot(covector.abs()) + 1e-6, "{off} {}", point.error);
                            assert!((point.n - covector).length() < 1e-5 && (point.ns - covector).length() < 1e-5);
                            hits += 1;
                        }
                        None => assert!(!t.is_finite() || t < 0.0 || edge < 1e-4, "lost at {t}, {local}"),
                    }
                }
                assert!(hits > 100, "{hits}");
            }
        }
    }

    /// Between samples of a sphere's distance, errors of place fall with the square of the spacing h: the linear
    /// interpolant of |p| errs by at most 3h²/(8r). Normals err by h/r. Smooth normals have no jumps, and nothing that
    /// leaves outwards comes back.
    #[test]
    fn spheres_are_near() {
        let r = 0.37;
        for n in [16, 48] {
            for smooth in [false, true] {
                let s = surface([n; 3], &Transform::IDENTITY, smooth, |p| (p - 0.5).length() - r);
                let h = 1.0 / (n - 1) as f64;
                let mut hits = 0;
                for ray in rays(&s, 400) {
                    let (o, d) = (ray.origin.as_dvec3() - 0.5, ray.direction.as_dvec3());
                    let distance = (o - d * o.dot(d)).length();
                    let Some((prim, t)) = nearest(&s, &ray) else {
                        assert!(distance > r - 2.0 * h * h / r, "lost at {distance}");
                        continue;
                    };
                    hits += 1;
                    let point = s.surface(prim, &ray, t);
                    let p = point.p.as_dvec3() - 0.5;
                    assert!((p.length() - r).abs() < 0.5 * h * h / r, "{} at {n}", p.length() - r);
                    let radial = p.normalize();
                    assert!((point.n.as_dvec3() - radial).length() < 1.2 * h / r);
                    if smooth {
                        assert!(
                            (point.ns.as_dvec3() - radial).length() < 0.35 * h / r,
                            "{}",
                            (point.ns.as_dvec3() - radial).length() * r / h
                        );
                    }
                    let origin = offset_ray_origin(point.p, point.error, point.n, point.n);
                    assert!(nearest(&s, &Ray::new(origin, point.n)).is_none(), "a ray straight out");
                }
                assert!(hits > 100, "{hits}");
            }
        }
    }

    /// Any function: hits are the first change of sign of the trilinear interpolant, found by small steps.
    #[test]
    fn rough_functions_are_met_where_they_change_sign() {
        let mut rng = HashRng::new(11);
        let noise: Vec<f64> = (0..6 * 5 * 4).map(|_| f64::from(rng.next_f32()) - 0.4).collect();
        for place in places() {
            let s = surface([6, 5, 4], &place, true, |p| {
                let [x, y, z] = [p.x * 5.0, p.y * 4.0, p.z * 3.0].map(|v| v.round() as usize);
                noise[(z * 5 + y) * 6 + x]
            });
            let size = DVec3::new(5.0, 4.0, 3.0);
            for ray in rays(&s, 150) {
                let local = s.place.inverse().ray(&ray);
                let (o, d) = (local.origin.as_dvec3(), local.direction.as_dvec3());
                let inside = |p: DVec3| p.min_element() >= 0.0 && p.max_element() <= 1.0;
                let steps = 30_000;
                let far = 60.0 / local.direction.length() as f64 * 0.05;
                let start = (DVec3::splat(0.5) - o).dot(d) / d.length_squared();
                let (mut last, mut first) = (None::<f64>, None);
                for k in 0..steps {
                    let t = start + far * (2.0 * k as f64 / steps as f64 - 1.0);
                    let p = o + d * t;
                    let value = inside(p).then(|| s.value(p * size));
                    if let (Some(a), Some(b)) = (last, value)
                        && (a < 0.0) != (b < 0.0)
                    {
                        first = Some(t);
                        break;
                    }
                    last = value;
                }
                match (nearest(&s, &ray), first) {
                    (Some((_, t)), Some(expected)) => {
                        let step = 2.0 * far / steps as f64;
                        // Roots that lie closer than the steps are passed over by these.
                        assert!(f64::from(t) < expected + step + 1e-5, "{t} {expected}");
                    }
                    (None, Some(expected)) => panic!("lost at {expected}"),
                    _ => {}
                }
                if let Some((prim, t)) = nearest(&s, &ray) {
                    let point = s.surface(prim, &ray, t);
                    let p = s.place.inverse().point(point.p).as_dvec3();
                    assert!(s.value(p * size).abs() < 1e-4, "{}", s.value(p * size));
                }
            }
        }
    }

    #[test]
    fn cubics_have_their_roots_in_order() {
        // (u − ¼)(u − ½)(u − ¾), a double root at ½, one at the start, and none.
        let all = |c: [f64; 4]| roots(c, 0.0, 1.0).collect::<Vec<_>>();
        let near = |found: Vec<f64>, expected: &[f64]| {
            assert!(
                found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12),
                "{found:?} {expected:?}"
            );
        };
        near(all([-0.09375, 0.6875, -1.5, 1.0]), &[0.25, 0.5, 0.75]);
        near(all([0.25, -1.0, 1.0, 0.0]), &[0.5]);
        near(all([0.0, 1.0, 0.0, 0.0]), &[0.0]);
        near(all([-1.0, 1.0, 0.0, 0.0]), &[1.0]);
        near(all([1.0, 0.0, 1.0, 1.0]), &[]);
        near(all([0.0; 4]), &[]);
    }

    #[test]
    fn what_is_no_grid_of_distances_is_refused() {
        let place = Affine::default();
        let sound = |size, channels, data: Vec<f32>| {
            let grid = VoxelGrid { size, channels, bounds: [[0.0; 3], [1.0; 3]], data };
            SdfGrid::new(Arc::new(grid), place, false, true).map(|s| s.count())
        };
        assert_eq!(sound([2, 2, 2], 1, vec![1.0; 8]), Some(0));
        assert_eq!(sound([2, 2, 2], 1, vec![1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]), Some(1));
        assert_eq!(sound([2, 2, 2], 2, vec![1.0; 16]), None);
        assert_eq!(sound([1, 2, 4], 1, vec![1.0; 8]), None);
        assert_eq!(sound([2, 2, 2], 1, vec![f32::NAN; 8]), None);
    }
}

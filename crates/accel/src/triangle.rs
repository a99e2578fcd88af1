//! The watertight ray-triangle test of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013,
//! on eight triangles at once.
//!
//! Vertices are moved to the ray's origin and sheared so that the ray becomes the z axis. The signs of the three edge
//! functions then decide; two triangles compute the same numbers for a shared edge, so a ray cannot slip between them.
//! Where an edge function is zero it is computed again in `f64`, where its sign is exact.
//!
//! Where rounding may have brought a hit before the origin or behind it, which happens on triangles that are much
//! larger than the distance, it is computed again in `f64`.
//!
//! No hit is before the box of its triangle, where rounding may put those on triangles that are hardly any: it is moved
//! there, to the greatest of the least distances of the vertices along each axis. The boxes of nodes, which are widened
//! by more than that rounds, never begin later. So no box that is left out because it begins behind a hit has a nearer
//! one, and hits do not depend on the order in which boxes are visited.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::layout::Block;
use crate::ray_constants::{RayConstants, at};
use crate::simd::{LANES, Lanes, Simd, WIDE, Wide};
use steradian_math::{Ray, Vec3, ray::gamma};

/// Ray constants of the triangle test.
#[derive(Clone, Copy)]
pub(crate) struct Shear<S: Simd> {
    /// Axes in the order x, y, z of the sheared space; z is where the direction is greatest.
    axes: [usize; 3],
    /// The origin by these axes.
    origin: [S::F; 3],
    /// Shear of x and y, and scale of z.
    shear: [S::F; 3],
    /// Reciprocals of the direction along x and y.
    inverse: [S::F; 2],
}

/// Candidate hits on the triangles of a block.
pub(crate) struct Candidates {
    /// Bit `i`: triangle `i` is hit within the interval.
    pub lanes: u32,
    /// Distances.
    pub t: [f32; LANES],
    /// Barycentric coordinates of the second vertex,
    pub u: [f32; LANES],
    /// and of the third.
    pub v: [f32; LANES],
}

impl<S: Simd> Shear<S> {
    /// For a valid ray.
    #[inline(always)]
    pub fn new(s: S, ray: &Ray, constants: &RayConstants) -> Self {
        let [x, y, z] = constants.axes;
        // What is chosen by an index goes to memory: these three numbers, not all of `constants`.
        let inverse = constants.inverse;
        Self {
            axes: constants.axes,
            origin: [s.splat(at(&ray.origin, x)), s.splat(at(&ray.origin, y)), s.splat(at(&ray.origin, z))],
            shear: [s.splat(constants.shear[0]), s.splat(constants.shear[1]), s.splat(constants.shear[2])],
            inverse: [s.splat(at(&inverse, x)), s.splat(at(&inverse, y))],
        }
    }

    /// A vertex of every triangle relative to the origin.
    #[inline(always)]
    fn vertex(&self, s: S, block: &Block, vertex: usize) -> [S::F; 3] {
        let x = self.coordinate(s, block, 3 * vertex, 0);
        let y = self.coordinate(s, block, 3 * vertex, 1);
        let z = self.coordinate(s, block, 3 * vertex, 2);
        [x, y, z]
    }

    /// A relative vertex, sheared along the ray's direction.
    #[inline(always)]
    fn sheared(&self, s: S, [x, y, z]: [S::F; 3]) -> [S::F; 3] {
        [s.sub(x, s.mul(self.shear[0], z)), s.sub(y, s.mul(self.shear[1], z)), z]
    }

    /// A coordinate relative to the origin; `first_row` is that of the vertex.
    #[inline(always)]
    fn coordinate(&self, s: S, block: &Block, first_row: usize, axis: usize) -> S::F {
        s.sub(self.absolute(s, block, first_row, axis), self.origin[axis])
    }

    /// A coordinate.
    #[inline(always)]
    fn absolute(&self, s: S, block: &Block, first_row: usize, axis: usize) -> S::F {
        // SAFETY: the first row of a vertex is at most six, and an axis is less than three.
        s.load(unsafe { block.rows.get_unchecked(first_row + self.axes[axis]) })
    }

    /// Tests a block: hits that are farther than rounding can tell from the origin, with `0 < t <= t_max`; those that
    /// are before the boxes of their triangles are moved there, perhaps behind `t_max`, unless that is of no
    /// consequence.
    #[inline(always)]
    pub fn test(&self, s: S, block: &Block, t_max: S::F, in_boxes: bool) -> Option<Candidates> {
        // Translate the vertices to the origin and shear them so that the ray becomes the z axis.
        let [a, b, c] = [self.vertex(s, block, 0), self.vertex(s, block, 1), self.vertex(s, block, 2)];
        let sheared = [self.sheared(s, a), self.sheared(s, b), self.sheared(s, c)];
        let corners = Sheared { shear: self, block, sheared };
        let Crossing { lanes, mut t, v, w, sum, depth } = cross(s, &corners, &self.shear, t_max)?;
        // Distance at which the ray enters the triangle's box, by the nearest vertex on each axis: no hit may be
        // nearer.
        if in_boxes {
            let [x, y] = self.inverse;
            let along_x = s.min(s.min(s.mul(a[0], x), s.mul(b[0], x)), s.mul(c[0], x));
            let along_y = s.min(s.min(s.mul(a[1], y), s.mul(b[1], y)), s.mul(c[1], y));
            t = s.max(s.max(along_x, s.max(along_y, depth)), t);
        }
        Some(Candidates { lanes, t: s.store(t), u: s.store(s.div(v, sum)), v: s.store(s.div(w, sum)) })
    }
}

/// Intersections of rays and triangles, in lanes of either.
pub(crate) struct Crossing<L: Lanes> {
    /// Lanes that are hit within the interval; the others have no meaning.
    pub lanes: u32,
    /// Distances.
    pub t: L::F,
    /// Edge functions that belong to the second vertex,
    pub v: L::F,
    /// to the third vertex,
    pub w: L::F,
    /// and the sum of all three.
    pub sum: L::F,
    /// Distances at which the rays have come as far along the greatest axis as the nearest of the vertices.
    pub depth: L::F,
}

/// The vertices of triangles relative to the origins of rays, sheared.
pub(crate) trait Corners<L: Lanes> {
    /// Their coordinates across the rays.
    fn across(&self, l: L) -> [[L::F; 2]; 3];
    /// Their coordinates along the axis where the directions are greatest.
    fn along(&self, l: L) -> [L::F; 3];
    /// The vertices and the origins of the rays as they are, by the axes of the sheared space.
    fn absolute(&self, l: L) -> [[L::F; 3]; 4];
}

/// The triangles of a block, computed before.
struct Sheared<'a, S: Simd> {
    shear: &'a Shear<S>,
    block: &'a Block,
    sheared: [[S::F; 3]; 3],
}

impl<S: Simd> Corners<S> for Sheared<'_, S> {
    #[inline(always)]
    fn across(&self, _: S) -> [[S::F; 2]; 3] {
        let [[ax, ay, _], [bx, by, _], [cx, cy, _]] = self.sheared;
        [[ax, ay], [bx, by], [cx, cy]]
    }

    #[inline(always)]
    fn along(&self, _: S) -> [S::F; 3] {
        [self.sheared[0][2], self.sheared[1][2], self.sheared[2][2]]
    }

    #[inline(always)]
    fn absolute(&self, s: S) -> [[S::F; 3]; 4] {
        let row = |vertex: usize, axis: usize| self.shear.absolute(s, self.block, 3 * vertex, axis);
        let vertex = |vertex: usize| [row(vertex, 0), row(vertex, 1), row(vertex, 2)];
        [vertex(0), vertex(1), vertex(2), self.shear.origin]
    }
}

/// Edge functions: twice the signed areas opposite to the vertices.
#[inline(always)]
pub(crate) fn edges<L: Lanes>(s: L, [[ax, ay], [bx, by], [cx, cy]]: [[L::F; 2]; 3]) -> [L::F; 3] {
    [s.sub(s.mul(cx, by), s.mul(cy, bx)), s.sub(s.mul(ax, cy), s.mul(ay, cx)), s.sub(s.mul(bx, ay), s.mul(by, ax))]
}

/// The test: hits with `0 < t <= t_max` that are farther than rounding can tell from the origin. The last of the shears
/// is the reciprocal of the greatest coordinate of the direction.
#[inline(always)]
pub(crate) fn cross<L: Lanes>(s: L, corners: &impl Corners<L>, shear: &[L::F; 3], t_max: L::F) -> Option<Crossing<L>> {
    // Edge functions U, V, W of the projected vertices.
    let edges = edges(s, corners.across(s));
    // All of one sign, with zero on either side. The signs are right, but for zeros.
    if s.bits(of_one_sign(s, edges)) == 0 {
        return None;
    }
    cross_at(s, corners, edges, shear, t_max)
}

/// Intersection of triangles whose edge functions U, V, W are known.
#[inline(always)]
pub(crate) fn cross_at<L: Lanes>(
    s: L,
    corners: &impl Corners<L>,
    [mut u, mut v, mut w]: [L::F; 3],
    shear: &[L::F; 3],
    t_max: L::F,
) -> Option<Crossing<L>> {
    let scale = shear[2];
    let zero = s.splat(0.0);
    // Inside where all have one sign.
    let mut is_inside = of_one_sign(s, [u, v, w]);
    let on_edge = s.or(s.or(s.eq(u, zero), s.eq(v, zero)), s.eq(w, zero));
    let on_edge = s.bits(s.and(is_inside, on_edge));
    if on_edge != 0 {
        // Recompute in double precision where an edge function is exactly zero (Woop et al. 2013).
        let mut edges = [Wide::splat(0.0); 3];
        let mut across = [[Wide::splat(0.0); 2]; 3];
        s.write(u, &mut edges[0]);
        s.write(v, &mut edges[1]);
        s.write(w, &mut edges[2]);
        for (wide, corner) in across.iter_mut().zip(corners.across(s)) {
            s.write(corner[0], &mut wide[0]);
            s.write(corner[1], &mut wide[1]);
        }
        edges_in_f64(&across, on_edge, &mut edges);
        [u, v, w] = [s.read(&edges[0]), s.read(&edges[1]), s.read(&edges[2])];
        is_inside = of_one_sign(s, [u, v, w]);
    }

    let [az, bz, cz] = corners.along(s);
    // det = U + V + W, T = U·z_a + V·z_b + W·z_c, t = T·S_z / det.
    let sum = s.add(s.add(u, v), w);
    let depth = s.add(s.add(s.mul(u, az), s.mul(v, bz)), s.mul(w, cz));
    let mut t = s.div(s.mul(depth, scale), sum);
    let beyond = s.bits(s.and(is_inside, s.lt(zero, t)));
    if beyond == 0 {
        return None;
    }

    // A triangle that is in front of the origin as a whole is hit in front of it. Else rounding may have brought the
    // hit there.
    let nearest = s.min(s.min(s.mul(az, scale), s.mul(bz, scale)), s.mul(cz, scale));
    let in_front = s.bits(s.lt(zero, nearest));
    let mut lanes = beyond & s.bits(s.le(t, t_max));
    // Whether it is asked must not depend on what was hit before, which `t_max` tells.
    if beyond & !in_front != 0 {
        let [[ax, ay], [bx, by], [cx, cy]] = corners.across(s);
        // Compare T with its error bound; what is below is decided in double precision.
        let error = depth_error(s, [ax, bx, cx], [ay, by, cy], [az, bz, cz], [u, v, w]);
        let told = in_front | s.bits(s.lt(error, abs(s, depth)));
        let doubtful = beyond & !told;
        lanes &= told;
        if doubtful != 0 {
            let mut exact = Exact::default();
            for (wides, vectors) in exact.points.iter_mut().zip(corners.absolute(s)) {
                wides.iter_mut().zip(vectors).for_each(|(wide, vector)| s.write(vector, wide));
            }
            exact.shear.iter_mut().zip(shear).for_each(|(wide, vector)| s.write(*vector, wide));
            s.write(t, &mut exact.t);
            let found = exact.distances(doubtful);
            t = s.read(&exact.t);
            lanes |= found & s.bits(s.le(t, t_max));
        }
    }
    (lanes != 0).then_some(Crossing { lanes, t, v, w, sum, depth: nearest })
}

/// Lanes in which three numbers have one sign, with zero on either side.
#[inline(always)]
pub(crate) fn of_one_sign<L: Lanes>(s: L, [u, v, w]: [L::F; 3]) -> L::M {
    let zero = s.splat(0.0);
    // All three are not negative, or all three are not positive.
    let (least, greatest) = (s.min(s.min(u, v), w), s.max(s.max(u, v), w));
    s.or(s.le(zero, least), s.le(greatest, zero))
}

/// A bound on the rounding error of the sum of the edge functions times the depths of their vertices. A hit whose sum
/// is not greater may lie behind the origin: a ray that leaves a large triangle would meet it again (Pharr, Jakob,
/// Humphreys, PBR 4th ed., 6.8.7). Depths are not scaled here, so that the length of the direction does not matter.
#[inline(always)]
fn depth_error<L: Lanes>(s: L, x: [L::F; 3], y: [L::F; 3], z: [L::F; 3], edges: [L::F; 3]) -> L::F {
    let (x, y, z, e) = (greatest(s, x), greatest(s, y), greatest(s, z), greatest(s, edges));
    // Bounds γ_n = nε/(1 − nε) on the sheared coordinates, then on the edge functions, then on their weighted sum.
    let (g2, g3, g5) = (s.splat(gamma(2)), s.splat(gamma(3)), s.splat(gamma(5)));
    let (dx, dy, dz) = (s.mul(g5, s.add(x, z)), s.mul(g5, s.add(y, z)), s.mul(g3, z));
    let de = s.add(s.mul(g2, s.mul(x, y)), s.add(s.mul(dy, x), s.mul(dx, y)));
    let de = s.add(de, de);
    let sum = s.add(s.add(s.mul(g3, s.mul(e, z)), s.mul(de, z)), s.mul(dz, e));
    s.mul(s.splat(3.0), sum)
}

/// Inputs and distances that are computed again in `f64`, lane by lane.
struct Exact {
    /// Vertices and origins, by the axes of the sheared space.
    points: [[Wide; 3]; 4],
    shear: [Wide; 3],
    t: Wide,
}

impl Default for Exact {
    fn default() -> Self {
        let wide = Wide::splat(0.0);
        Self { points: [[wide; 3]; 4], shear: [wide; 3], t: wide }
    }
}

impl Exact {
    /// The lanes in which the hit is beyond the origin, with its distances.
    #[cold]
    #[inline(never)]
    fn distances(&mut self, lanes: u32) -> u32 {
        let mut beyond = 0;
        for lane in (0..WIDE).filter(|lane| lanes >> lane & 1 == 1) {
            let points = self.points.map(|p| p.map(|wide| wide.0[lane]));
            if let Some(t) = exact_distance(points, self.shear.map(|wide| wide.0[lane])) {
                self.t.0[lane] = t;
                beyond |= 1 << lane;
            }
        }
        beyond
    }
}

/// Ray distance of a triangle's plane, if it is beyond the origin for certain. Vertices and origin are by the axes of
/// the sheared space.
#[cold]
pub(crate) fn exact_distance(points: [[f32; 3]; 4], [x, y, scale]: [f32; 3]) -> Option<f32> {
    let [a, b, c, origin] = points.map(|p| p.map(f64::from));
    let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let (e, f, r) = (minus(b, a), minus(c, a), minus(a, origin));
    let (mut height, mut size, mut slope) = (0.0, 0.0, 0.0);
    for (i, d) in [f64::from(x), f64::from(y), 1.0].into_iter().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        // Cross product of two sides: t = n·(a − o)/(n·d), with magnitudes summed alongside for the error bound.
        let (p, q) = (e[j] * f[k], e[k] * f[j]);
        height += (p - q) * r[i];
        size += (p.abs() + q.abs()) * r[i].abs();
        slope += (p - q) * d;
    }
    // Each number was rounded a few times.
    if height.abs() <= 16.0 * f64::EPSILON * size {
        return None;
    }
    let t = (height / slope * f64::from(scale)) as f32;
    (t > 0.0 && t < f32::INFINITY).then_some(t)
}

/// The absolute value.
#[inline(always)]
pub(crate) fn abs<L: Lanes>(s: L, x: L::F) -> L::F {
    s.max(x, s.sub(s.splat(0.0), x))
}

/// The greatest absolute value of three numbers.
#[inline(always)]
fn greatest<L: Lanes>(s: L, [a, b, c]: [L::F; 3]) -> L::F {
    s.max(s.max(abs(s, a), abs(s, b)), abs(s, c))
}

/// Edge functions of the lanes in `lanes` again, with an exact sign.
#[cold]
#[inline(never)]
fn edges_in_f64(corners: &[[Wide; 2]; 3], lanes: u32, edges: &mut [Wide; 3]) {
    for lane in (0..WIDE).filter(|lane| lanes >> lane & 1 == 1) {
        let [[ax, ay], [bx, by], [cx, cy]] = corners.map(|corner| corner.map(|wide| f64::from(wide.0[lane])));
        edges[0].0[lane] = (cx * by - cy * bx) as f32;
        edges[1].0[lane] = (ax * cy - ay * cx) as f32;
        edges[2].0[lane] = (bx * ay - by * ax) as f32;
    }
}

/// True if a ray can hit the triangle at all: finite, and no two vertices equal.
pub(crate) fn is_hittable([a, b, c]: [Vec3; 3]) -> bool {
    a.is_finite() && b.is_finite() && c.is_finite() && a != b && b != c && c != a
}

#[cfg(test)]
mod tests {
    use crate::{Bvh, Geometry};
    use steradian_math::{Ray, Vec3, hash::HashRng};

    #[test]
    fn signs_that_single_precision_cannot_tell_are_right() {
        // The ray passes the shared edge of two triangles so closely that the edge function is zero in `f32`: the
        // products (1 + e)² and 1 + 2e round to the same number. Exactly one of the triangles is hit.
        let e = f32::EPSILON;
        let positions = [
            Vec3::new(-1.0, -(1.0 + e), 1.0),
            Vec3::new(1.0 + e, 1.0 + 2.0 * e, 1.0),
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, 1.0),
        ];
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let is_hit = |third: u32| {
            let bvh = Bvh::build(&[Geometry::triangles(&positions, &[[third, 0, 1]])]);
            bvh.is_ok_and(|bvh| bvh.occluded(&ray, &()))
        };
        assert_eq!([is_hit(2), is_hit(3)], [false, true]);
    }

    /// A quad from (−`half`, 0, −`half`) to (`half`, 0, `half`).
    fn ground(half: f32) -> Bvh {
        let p = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| Vec3::new(x, 0.0, z) * half);
        Bvh::build(&[Geometry::triangles(&p, &[[0, 1, 2], [0, 2, 3]])]).expect("a quad")
    }

    #[test]
    fn rays_meet_large_triangles_that_are_near() {
        let mut rng = HashRng::new(3);
        for (half, height) in [(1e3, 1e-3), (1e3, 0.1), (1e4, 1e-2), (1e5, 1.0)] {
            let bvh = ground(half);
            let (mut rays, mut expected) = (Vec::new(), Vec::new());
            while rays.len() < 4000 {
                let d = Vec3::new(rng.next_f32() - 0.5, -0.4 * rng.next_f32(), rng.next_f32() - 0.5).normalize();
                let o = Vec3::new(rng.next_f32() - 0.5, height, rng.next_f32() - 0.5);
                let t = height / -d.y;
                if t < 0.2 * half {
                    rays.push(Ray::new(o, d));
                    expected.push(t);
                }
            }
            let mut hits = vec![None; rays.len()];
            bvh.intersect_batch(&rays, &(), &mut hits);
            for ((ray, t), hit) in rays.iter().zip(expected).zip(hits) {
                let found = hit.unwrap_or_else(|| panic!("{half} {height}: no hit on {ray:?} at {t}"));
                assert!((found.t - t).abs() < 0.05 * t, "{half} {height}: {} for {t}", found.t);
                assert_eq!(bvh.intersect(ray, &()), hit);
            }
        }
    }

    #[test]
    fn rays_that_leave_large_triangles_do_not_meet_them() {
        let mut rng = HashRng::new(8);
        for half in [1.0, 1e3, 1e5] {
            // As it is, and upright and aslant.
            let turns = [
                [Vec3::X, Vec3::Y, Vec3::Z],
                [Vec3::Y, Vec3::Z, Vec3::X],
                [Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.64, 0.6, 0.48), Vec3::new(0.48, -0.8, 0.36)],
            ];
            for [x, y, z] in turns {
                let corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]].map(|[a, b]| (x * a + z * b) * half);
                let bvh = Bvh::build(&[Geometry::triangles(&corners, &[[0, 1, 2]])]).expect("a triangle");
                for _ in 0..4000 {
                    let (u, v) = (rng.next_f32() * 0.5, rng.next_f32() * 0.5);
                    let p = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    // As far off as points on it are rounded.
                    let n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
                    let side = if rng.next_f32() < 0.5 { 1.0 } else { -1.0 };
                    let o = p + n * (side * 1e-6 * half);
                    let w = x * (rng.next_f32() - 0.5) + z * (rng.next_f32() - 0.5) + n * (side * rng.next_f32());
                    assert_eq!(bvh.intersect(&Ray::new(o, w.normalize()), &()), None, "{half} {y}: {o} {w}");
                }
            }
        }
    }
}

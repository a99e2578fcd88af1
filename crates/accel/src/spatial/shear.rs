//! The watertight test of [`crate::triangle`] on one triangle: the same operations in the same order, so that every bit
//! of a hit is the one that the hierarchy finds.

use crate::{UserHit, triangle::exact_distance};
use steradian_math::{Ray, Vec3, ray::gamma};

/// Ray constants of the triangle test.
#[derive(Clone, Copy)]
pub(super) struct Shear {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 3],
    inverse: [f32; 3],
}

impl Shear {
    /// For a valid ray.
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        // Dominant axis of the direction.
        let a = d.abs();
        let z = if a.x >= a.y && a.x >= a.z {
            0
        } else if a.y >= a.z {
            1
        } else {
            2
        };
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z];
        let [x, y, z] = axes;
        let inverse = d.recip().clamp(Vec3::splat(-f32::MAX), Vec3::splat(f32::MAX));
        Self {
            axes,
            origin: [ray.origin[x], ray.origin[y], ray.origin[z]],
            shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
            inverse: [inverse[x], inverse[y], inverse[z]],
        }
    }

    /// A vertex relative to the origin, by the axes of the sheared space.
    #[inline]
    fn relative(&self, p: Vec3) -> [f32; 3] {
        [0, 1, 2].map(|axis| p[self.axes[axis]] - self.origin[axis])
    }

    /// A vertex relative to the origin, sheared.
    #[inline]
    fn vertex(&self, p: Vec3) -> [f32; 3] {
        let [x, y, z] = self.relative(p);
        [x - self.shear[0] * z, y - self.shear[1] * z, z]
    }

    /// The hit on a triangle with `0 < t <= t_max`, farther than rounding can tell from the origin.
    #[inline]
    pub fn hit(&self, corners: &[Vec3; 3], t_max: f32) -> Option<UserHit> {
        // Translate and shear the vertices so that the ray becomes the positive z axis.
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners.map(|p| self.vertex(p));
        // Edge functions U, V, W: scaled barycentric coordinates.
        let mut u = cx * by - cy * bx;
        let mut v = ax * cy - ay * cx;
        let mut w = bx * ay - by * ax;
        // A zero may have the wrong sign: recompute in double precision.
        if u == 0.0 || v == 0.0 || w == 0.0 {
            [u, v, w] = edges_in_f64([ax, ay, bx, by, cx, cy]);
        }
        // Inside where all have one sign; zero counts for both, so that shared edges have no gaps.
        let positive = u >= 0.0 && v >= 0.0 && w >= 0.0;
        let negative = u <= 0.0 && v <= 0.0 && w <= 0.0;
        if !(positive || negative) {
            return None;
        }
        let sum = (u + v) + w;
        // T = U·z_a + V·z_b + W·z_c and t = T·S_z / (U + V + W).
        let depth = (u * az + v * bz) + w * cz;
        let scale = self.shear[2];
        let mut t = depth * scale / sum;
        // NaN is neither.
        let is_beyond = t > 0.0;
        if !is_beyond {
            return None;
        }
        // A triangle that reaches behind the origin may be hit in front of it by rounding alone: compare with the error
        // bound.
        let nearest = min(min(az * scale, bz * scale), cz * scale);
        let in_front = nearest > 0.0;
        if !in_front {
            let error = depth_error([ax, bx, cx], [ay, by, cy], [az, bz, cz], [u, v, w]);
            // NaN is not certain.
            let is_certain = error < abs(depth);
            if !is_certain {
                let [a, b, c] = corners.map(|p| [0, 1, 2].map(|axis| p[self.axes[axis]]));
                t = exact_distance([a, b, c, self.origin], self.shear)?;
            }
        }
        if t > t_max {
            return None;
        }
        // Move the hit behind the entry of its box, as the hierarchy does.
        let [a, b, c] = corners.map(|p| self.relative(p));
        let mut begin = 0.0;
        for (axis, inverse) in self.inverse.into_iter().enumerate() {
            // Nearest of the three vertices along the axis.
            let [a, b, c] = [a, b, c].map(|p| p[axis] * inverse);
            begin = max(min(min(a, b), c), begin);
        }
        let t = max(begin, t);
        (t <= t_max).then(|| UserHit { t, u: v / sum, v: w / sum })
    }
}

/// The edge functions with exact signs.
#[cold]
fn edges_in_f64(corners: [f32; 6]) -> [f32; 3] {
    let [ax, ay, bx, by, cx, cy] = corners.map(f64::from);
    [(cx * by - cy * bx) as f32, (ax * cy - ay * cx) as f32, (bx * ay - by * ax) as f32]
}

/// The bound of [`crate::triangle`] on the rounding error of the depth.
fn depth_error(x: [f32; 3], y: [f32; 3], z: [f32; 3], edges: [f32; 3]) -> f32 {
    let (x, y, z, e) = (greatest(x), greatest(y), greatest(z), greatest(edges));
    // Errors of the sheared coordinates, of the edge functions, and of their weighted sum.
    let (dx, dy, dz) = (gamma(5) * (x + z), gamma(5) * (y + z), gamma(3) * z);
    let de = gamma(2) * (x * y) + (dy * x + dx * y);
    let de = de + de;
    3.0 * ((gamma(3) * (e * z) + de * z) + dz * e)
}

/// `if a < b { a } else { b }`, as in vectors.
#[inline]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `if a > b { a } else { b }`, as in vectors.
#[inline]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline]
fn abs(x: f32) -> f32 {
    max(x, 0.0 - x)
}

#[inline]
fn greatest([a, b, c]: [f32; 3]) -> f32 {
    max(max(abs(a), abs(b)), abs(c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bvh, Geometry};
    use steradian_math::hash::HashRng;

    /// A number among few, so that edges, vertices and planes are met exactly, or any number.
    fn number(rng: &mut HashRng, coarse: bool) -> f32 {
        let x = rng.next_f32() * 2.0 - 1.0;
        if coarse { (x * 2.0).round() } else { x }
    }

    #[test]
    fn every_bit_is_that_of_the_hierarchy() {
        let mut rng = HashRng::new(71);
        let (mut hits, mut misses) = (0, 0);
        for i in 0..60_000 {
            let coarse = i % 3 == 0;
            let scale = [1.0, 1e-3, 1e5, 1e20][i % 4];
            let mut point = |by: f32| Vec3::from_array([0; 3].map(|_| number(&mut rng, coarse))) * by;
            let corners = [0; 3].map(|_| point(scale));
            let ray = Ray { t_max: [f32::INFINITY, scale][i % 2], ..Ray::new(point(scale), point(1.0)) };
            if !ray.is_valid() || !crate::triangle::is_hittable(corners) {
                continue;
            }
            let bvh = Bvh::build(&[Geometry::triangles(&corners, &[[0, 1, 2]])]).expect("one triangle");
            let expected = bvh.intersect(&ray, &()).map(|h| [h.t, h.u, h.v].map(f32::to_bits));
            let hit = Shear::new(&ray).hit(&corners, ray.t_max).filter(|h| h.t < ray.t_max);
            let hit = hit.map(|h| [h.t, h.u, h.v].map(f32::to_bits));
            assert_eq!(hit, expected, "{corners:?} {ray:?}");
            *if hit.is_some() { &mut hits } else { &mut misses } += 1;
        }
        assert!(hits > 1500 && misses > 3000, "{hits} {misses}");
    }
}

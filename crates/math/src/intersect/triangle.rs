//! Ray and triangle (Möller and Trumbore 1997).

use super::within;
use crate::{Ray, Vec3};

/// A hit of a triangle, `(1 − u − v)·v0 + u·v1 + v·v2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Distance along the ray, in units of its direction.
    pub t: f32,
    /// Barycentric coordinate of the second vertex.
    pub u: f32,
    /// Barycentric coordinate of the third vertex.
    pub v: f32,
}

/// The hit of a triangle from either side, its edges included; a ray within the plane misses.
///
/// The signs of the three barycentric numerators decide, not rounded quotients, so that rays do not slip between
/// triangles that share an edge.
#[inline]
pub fn triangle(vertices: [Vec3; 3], ray: &Ray) -> Option<TriangleHit> {
    let [v0, v1, v2] = vertices.map(|v| v.as_dvec3());
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e1, e2) = (v1 - v0, v2 - v0);
    // Cramer's rule for o − v0 = u·e1 + v·e2 − t·d.
    let p = d.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = o - v0;
    let u = s.dot(p) * det.signum();
    if u < 0.0 {
        return None;
    }
    let q = s.cross(e1);
    let v = d.dot(q) * det.signum();
    let size = det.abs();
    // Also false for NaN.
    if !(v >= 0.0 && u + v <= size) {
        return None;
    }
    let t = within(e2.dot(q) / det, ray)?;
    Some(TriangleHit { t, u: (u / size) as f32, v: (v / size) as f32 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;

    fn random_point(rng: &mut HashRng) -> Vec3 {
        Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5) * 2.0
    }

    #[test]
    fn agrees_with_plane_and_areas_in_double_precision() {
        let mut rng = HashRng::new(4);
        let mut hits = 0;
        for _ in 0..50_000 {
            let v = [0; 3].map(|_| random_point(&mut rng));
            let origin = random_point(&mut rng) * 2.0;
            let ray = Ray::new(origin, random_point(&mut rng) * 0.5 + v[0].lerp(v[1], 0.5) - origin);
            let [a, b, c] = v.map(|x| x.as_dvec3());
            let n = (b - a).cross(c - a);
            let t = n.dot(a - ray.origin.as_dvec3()) / n.dot(ray.direction.as_dvec3());
            let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t;
            let n2 = n.length_squared();
            let u = (a - c).cross(p - c).dot(n) / n2;
            let w = (b - a).cross(p - a).dot(n) / n2;
            let margin = u.min(w).min(1.0 - u - w);
            match triangle(v, &ray) {
                Some(hit) => {
                    assert!(margin > -1e-9 && t > 0.0);
                    assert!((f64::from(hit.t) - t).abs() < 1e-6 * t.max(1.0));
                    assert!((f64::from(hit.u) - u).abs() < 1e-6 && (f64::from(hit.v) - w).abs() < 1e-6);
                    hits += 1;
                }
                None => assert!(margin < 1e-9 || t < 1e-9),
            }
        }
        assert!(hits > 1000);
    }

    #[test]
    fn no_ray_slips_between_neighbours() {
        // Fans of triangles around a vertex: every ray to a point on an inner edge, or to the vertex, must hit one.
        let mut rng = HashRng::new(5);
        for _ in 0..20_000 {
            let offset = random_point(&mut rng) * 100.0;
            let center = random_point(&mut rng) * 0.1 + offset;
            let rim: [Vec3; 5] = std::array::from_fn(|i| {
                let angle = (i as f32 + 0.8 * rng.next_f32()) * std::f32::consts::TAU / 5.0;
                Vec3::new(angle.cos(), angle.sin(), 0.3 * rng.next_f32()) + offset
            });
            let target = center.lerp(rim[(rng.next_u64() % 5) as usize], rng.next_f32() * 0.9);
            let origin = offset + Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, 4.0);
            let ray = Ray::new(origin, target - origin);
            assert!((0..5).any(|i| triangle([center, rim[i], rim[(i + 1) % 5]], &ray).is_some()), "{ray:?}");
        }
        // Exactly on an edge and on a vertex of a grid.
        let (a, b, c, d) = (Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0));
        for x in [Vec3::new(0.5, 0.5, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.25, 0.75, 1.0)] {
            let ray = Ray::new(x, -Vec3::Z);
            assert!(triangle([a, b, c], &ray).is_some() && triangle([b, d, c], &ray).is_some());
        }
    }

    #[test]
    fn degenerate_input_misses() {
        let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
        let v = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(triangle(v, &ray), Some(TriangleHit { t: 1.0, u: 0.2, v: 0.2 }));
        assert!(triangle([v[0], v[2], v[1]], &ray).is_some(), "from behind");
        assert_eq!(triangle([v[0], v[1], v[1] * 2.0], &ray), None);
        assert_eq!(triangle([v[0], v[1], v[2] * f32::NAN], &ray), None);
        assert_eq!(triangle(v, &Ray::new(Vec3::new(-1.0, 0.2, 0.0), Vec3::X)), None);
        assert_eq!(triangle(v, &Ray { t_max: 0.5, ..ray }), None);
    }
}

//! Ray and plane, for the three ways to give a plane.

use super::within;
use crate::{Ray, Vec3};

/// A hit given in the coordinates of a parametric plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParametricHit {
    /// Distance along the ray, in units of its direction.
    pub t: f32,
    /// Coordinate along the first spanning vector.
    pub u: f32,
    /// Coordinate along the second spanning vector.
    pub v: f32,
}

/// The plane `⟨n, x⟩ + d = 0`: `t = −(⟨n, o⟩ + d)/⟨n, v⟩`. A parallel ray misses, also within the plane.
#[inline]
pub fn plane(n: Vec3, d: f32, ray: &Ray) -> Option<f32> {
    let n = n.as_dvec3();
    // Division by zero gives an infinity or NaN, which no interval holds.
    within(-(n.dot(ray.origin.as_dvec3()) + f64::from(d)) / n.dot(ray.direction.as_dvec3()), ray)
}

/// The plane through `p` with normal `n` of any length but zero: `t = ⟨p − o, n⟩/⟨v, n⟩`.
#[inline]
pub fn plane_point_normal(p: Vec3, n: Vec3, ray: &Ray) -> Option<f32> {
    let n = n.as_dvec3();
    within(n.dot(p.as_dvec3() - ray.origin.as_dvec3()) / n.dot(ray.direction.as_dvec3()), ray)
}

/// The plane `p + s·u + t·v`: the linear system `o + t·d = p + s·u + t·v` by Cramer's rule, which also gives the
/// coordinates of the hit.
#[inline]
pub fn plane_parametric(p: Vec3, u: Vec3, v: Vec3, ray: &Ray) -> Option<ParametricHit> {
    let (u, v, d) = (u.as_dvec3(), v.as_dvec3(), ray.direction.as_dvec3());
    let e = ray.origin.as_dvec3() - p.as_dvec3();
    let det = d.cross(v).dot(u);
    if det == 0.0 {
        return None;
    }
    let t = within(e.cross(u).dot(v) / det, ray)?;
    Some(ParametricHit { t, u: (d.cross(v).dot(e) / det) as f32, v: (e.cross(u).dot(d) / det) as f32 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;

    #[test]
    fn the_three_forms_agree() {
        let mut rng = HashRng::new(2);
        let mut hits = 0;
        for _ in 0..20_000 {
            let mut v = || Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5) * 4.0;
            let (p, u, w) = (v(), v(), v());
            let n = u.as_dvec3().cross(w.as_dvec3()).normalize();
            let ray = Ray::new(v(), v());
            let cos = n.dot(ray.direction.as_dvec3().normalize()).abs();
            if cos < 0.01 || u.cross(w).length() < 0.1 {
                continue;
            }
            let a = plane(n.as_vec3(), -n.dot(p.as_dvec3()) as f32, &ray);
            let b = plane_point_normal(p, n.as_vec3(), &ray);
            let c = plane_parametric(p, u, w, &ray);
            match (a, b, c) {
                (Some(a), Some(b), Some(c)) => {
                    let scale = 1e-5 * (1.0 + b) / cos as f32;
                    assert!((a - b).abs() < scale && (b - c.t).abs() < scale, "{a} {b} {c:?}");
                    let on_plane = p + u * c.u + w * c.v;
                    assert!((on_plane - ray.at(c.t)).length() < 1e-4 * (1.0 + on_plane.length()));
                    hits += 1;
                }
                (None, None, None) => {}
                // A plane through the origin of the ray may fall on either side of it.
                _ => assert!(n.dot((ray.origin - p).as_dvec3()).abs() < 1e-5),
            }
        }
        assert!(hits > 5000);
    }

    #[test]
    fn parallel_and_excluded_rays_miss() {
        let up = Ray::new(Vec3::new(0.0, 0.0, -2.0), Vec3::Z);
        let along = Ray::new(Vec3::new(0.0, 0.0, 1.0), Vec3::X);
        let within = Ray::new(Vec3::ZERO, Vec3::X);
        for r in [along, within] {
            assert_eq!(plane(Vec3::Z, 0.0, &r), None);
            assert_eq!(plane_point_normal(Vec3::ZERO, Vec3::Z, &r), None);
            assert_eq!(plane_parametric(Vec3::ZERO, Vec3::X, Vec3::Y, &r), None);
        }
        assert_eq!(plane(Vec3::Z, 0.0, &up), Some(2.0));
        assert_eq!(plane(Vec3::Z, 3.0, &up), None);
        assert_eq!(plane(Vec3::Z, 0.0, &Ray { t_max: 2.0, ..up }), None);
        assert_eq!(plane_parametric(Vec3::ZERO, Vec3::X, Vec3::X, &up), None);
    }
}

//! Ray and sphere.

use super::roots_with_discriminant;
use crate::{Ray, Vec3};

/// The roots `t0 ≤ t1` at which the line of the ray meets the sphere; from inside, `t0 < 0 < t1`. `None` where it
/// passes by.
///
/// The discriminant is taken from the distance between the centre and the line, not as a difference of the squares of
/// long distances (Haines et al., *Ray Tracing Gems*, ch. 7), so small spheres a million units away are round.
#[inline]
pub fn sphere(center: Vec3, radius: f32, ray: &Ray) -> Option<[f32; 2]> {
    let (o, d, r) = (ray.origin.as_dvec3() - center.as_dvec3(), ray.direction.as_dvec3(), f64::from(radius));
    let (a, h) = (d.length_squared(), o.dot(d));
    let to_line = o - d * (h / a);
    let distance = o.length();
    let c = (distance - r) * (distance + r);
    let [t0, t1] = roots_with_discriminant(a, h, c, a * (r * r - to_line.length_squared()))?;
    Some([t0 as f32, t1 as f32])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;
    use crate::intersect::nearest;

    #[test]
    fn hits_lie_on_the_sphere() {
        let mut rng = HashRng::new(3);
        let mut hits = 0;
        for _ in 0..20_000 {
            let mut v = || Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5);
            let (center, radius) = (v() * 10.0, 0.5 + v().x.abs());
            let ray = Ray::new(v() * 10.0, v() * 3.0);
            let line_distance = (center - ray.origin).cross(ray.direction).length() / ray.direction.length();
            match sphere(center, radius, &ray) {
                Some([t0, t1]) => {
                    assert!(t0 <= t1);
                    for t in [t0, t1] {
                        let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
                        let tolerance = 1e-6 * (1.0 + f64::from(t.abs() * ray.direction.length()));
                        assert!(((p - center.as_dvec3()).length() - f64::from(radius)).abs() < tolerance);
                    }
                    hits += 1;
                }
                None => assert!(line_distance > radius * (1.0 - 1e-5)),
            }
        }
        assert!(hits > 300);
    }

    #[test]
    fn inside_behind_and_tangent() {
        let r = |o: [f32; 3], d: [f32; 3]| Ray::new(Vec3::from(o), Vec3::from(d));
        let at = |ray: Ray| sphere(Vec3::ZERO, 1.0, &ray).and_then(|s| nearest(s, ray.t_max));
        assert_eq!(at(r([0.0, 0.0, -3.0], [0.0, 0.0, 1.0])), Some(2.0));
        assert_eq!(at(r([0.0, 0.0, -3.0], [0.0, 0.0, 2.0])), Some(1.0));
        assert_eq!(at(r([0.0, 0.0, 0.5], [0.0, 0.0, 1.0])), Some(0.5));
        assert_eq!(at(r([0.0, 0.0, 3.0], [0.0, 0.0, 1.0])), None);
        assert_eq!(at(r([0.0, 1.0, -3.0], [0.0, 0.0, 1.0])), Some(3.0));
        assert_eq!(at(r([0.0, 1.0_f32.next_up(), -3.0], [0.0, 0.0, 1.0])), None);
        // On the surface: the root at the start is exactly zero, so it is not hit again.
        assert_eq!(sphere(Vec3::ZERO, 1.0, &r([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0])), Some([0.0, 2.0]));
        for bad in [r([0.0; 3], [0.0; 3]), r([f32::NAN; 3], [1.0, 0.0, 0.0])] {
            assert_eq!(sphere(Vec3::ZERO, 1.0, &bad), None);
        }
    }

    #[test]
    fn a_small_sphere_a_million_units_away_is_round() {
        // Rays parallel to x at height y over a unit sphere at distance 2²⁰: t = 2²⁰ − √(1 − y²), to the rounding of t
        // (1/16).
        let far = 1_048_576.0_f32;
        for i in 0..=1000 {
            let y = i as f32 / 1000.0;
            let exact = f64::from(far) - (1.0 - f64::from(y) * f64::from(y)).sqrt();
            let ray = Ray::new(Vec3::new(-far, y, 0.0), Vec3::X);
            let [t0, t1] = sphere(Vec3::ZERO, 1.0, &ray).expect("a hit");
            assert!((f64::from(t0) - exact).abs() <= 0.0625 && t1 >= t0, "y = {y}: {t0}, {exact}");
        }
        assert!(sphere(Vec3::ZERO, 1.0, &Ray::new(Vec3::new(-far, 1.0001, 0.0), Vec3::X)).is_none());
        // A direction of length 10⁶ finds the sphere at t ≈ 1 with all digits.
        let ray = Ray::new(Vec3::new(-1e6, 0.0, 0.0), Vec3::new(1e6, 0.0, 0.0));
        assert_eq!(sphere(Vec3::ZERO, 1.0, &ray).map(|t| t[0]), Some(1.0 - 1e-6));
    }
}

//! Uniform sampling of the solid angle of a triangle (Arvo 1995), in a form without cancellation.
//!
//! With the sub-triangle `a b c'` of area `A' = u.x·A` cut off at vertex `a` (angle `α`, side `c = ∠ab`), the side
//! `b' = ∠ac'` obeys
//!
//! ```text
//! tan(b'/2) · tan(c/2) = sin(A'/2) / sin(α − A'/2)
//! ```
//!
//! This is the same function as Arvo's quotient of differences of cosines, but a product of small numbers stays
//! precise. The area is that of van Oosterom and Strackee (1983), with the triple product taken of edge vectors.

use crate::{Vec2, Vec3};

/// Below this solid angle (sr) the rounding of the unit directions shows; area sampling is as good there.
const MIN_SOLID_ANGLE: f32 = 3e-5;

/// Above this solid angle (sr; a hemisphere has 6.283) the point nearly lies in the triangle.
const MAX_SOLID_ANGLE: f32 = 6.22;

/// Triple product `a·(b×c)` of unit vectors by their differences, and the denominator of van Oosterom and Strackee.
#[inline]
fn area_terms(a: Vec3, b: Vec3, c: Vec3) -> (f32, f32) {
    (a.dot((b - a).cross(c - a)).abs(), 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// Solid angle in sr of the spherical triangle with the three unit vectors as corners, in `[0, 2π]`.
#[inline]
pub fn spherical_triangle_area(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    let (n, d) = area_terms(a, b, c);
    2.0 * n.atan2(d)
}

/// The unit directions from `p` to the vertices, their distances and the solid angle; `None` where sampling is refused.
#[inline]
fn project(v: [Vec3; 3], p: Vec3) -> Option<([Vec3; 3], Vec3, f32)> {
    let e = v.map(|x| x - p);
    let distance = Vec3::new(e[0].length(), e[1].length(), e[2].length());
    let d = [e[0] / distance.x, e[1] / distance.y, e[2] / distance.z];
    let area = spherical_triangle_area(d[0], d[1], d[2]);
    // Written so that NaN (a vertex at p, an infinite one) is refused too.
    (area > MIN_SOLID_ANGLE && area < MAX_SOLID_ANGLE).then_some((d, distance, area))
}

/// Density per solid angle of [`spherical_triangle`]: `Some` exactly where that samples.
#[inline]
pub fn spherical_triangle_pdf(v: [Vec3; 3], p: Vec3) -> Option<f32> {
    project(v, p).map(|(_, _, area)| 1.0 / area)
}

/// A point of the triangle `v`, uniform in the solid angle seen from `p`: its barycentric coordinates and density per
/// solid angle.
///
/// `None` where the triangle is degenerate or looks too small or too large from `p`; the caller samples its area
/// instead. [`spherical_triangle_pdf`] takes the same decision.
#[inline]
pub fn spherical_triangle(v: [Vec3; 3], p: Vec3, u: Vec2) -> Option<([f32; 3], f32)> {
    let ([a, b, c], distance, area) = project(v, p)?;
    // One minus the cosines of the sides at a, and the tangents at a towards b and c.
    let (ab, ac) = (b - a, c - a);
    let (m_c, m_b) = (0.5 * ab.length_squared(), 0.5 * ac.length_squared());
    let alpha = a.dot(ab.cross(ac)).abs().atan2(ab.dot(ac) - m_c * m_b);

    // Cut off u.x of the area: the side b' by the half-angle identity, x = tan(b'/2), tan²(c/2) = m/(2 − m).
    let half = 0.5 * u.x * area;
    let x = half.sin() / (alpha - half).sin().max(f32::MIN_POSITIVE) * ((2.0 - m_c) / m_c).sqrt();
    let (cos_b1, sin_b1) = if x < 1e6 {
        let q = 1.0 / (1.0 + x * x);
        ((1.0 - x * x) * q, 2.0 * x * q)
    } else {
        (-1.0, 0.0)
    };
    // c' lies on the arc from a to c: its coefficients of a and c.
    let side_b = (m_b * (2.0 - m_b)).sqrt();
    let k_c = (sin_b1 / side_b).max(0.0);
    let k_a = (cos_b1 - k_c * (1.0 - m_b)).max(0.0);
    let c1 = a * k_a + c * k_c;

    // u.y goes along the arc from b to c': uniform in the cosine of the distance from b.
    let m = (0.5 * (c1 - b).length_squared()).min(2.0);
    let y = u.y * m;
    let k_c1 = ((y * (2.0 - y)) / (m * (2.0 - m))).sqrt();
    let k_b = (1.0 - y - k_c1 * (1.0 - m)).max(0.0);

    // The direction is k·(a, b, c); the vertices are farther away by their distances.
    let k = Vec3::new(k_a * k_c1, k_b, k_c * k_c1) / distance;
    let sum = k.x + k.y + k.z;
    (sum > 0.0 && sum.is_finite()).then(|| ((k / sum).to_array(), 1.0 / area))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::test_rectangle;
    use crate::hash::{HashRng, ONE_MINUS_EPSILON};
    use glam::DVec3;

    /// Triangles seen from the origin: an octant, an ordinary one, a grazing sliver, a near one, a small one.
    fn triangles() -> [[Vec3; 3]; 5] {
        let v = |a: [f32; 9]| [Vec3::new(a[0], a[1], a[2]), Vec3::new(a[3], a[4], a[5]), Vec3::new(a[6], a[7], a[8])];
        [
            v([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]),
            v([-0.5, 0.2, 2.0, 1.5, -0.4, 2.5, 0.3, 1.8, 1.7]),
            v([-2.0, 0.05, 1.0, 3.0, 0.08, 1.0, 1.0, 0.05, 4.0]),
            v([-2.0, -2.0, 0.2, 2.0, -2.0, 0.2, 0.0, 3.0, 0.2]),
            v([0.0, 0.0, 9.0, 0.2, 0.0, 9.1, 0.05, 0.25, 9.2]),
        ]
    }

    #[test]
    fn points_are_uniform_in_solid_angle() {
        for (i, v) in triangles().into_iter().enumerate() {
            let area = spherical_triangle_area(v[0].normalize(), v[1].normalize(), v[2].normalize());
            let d = v.map(|x| x.as_dvec3());
            let normal = (d[1] - d[0]).cross(d[2] - d[0]);
            // In s = (1 − b0)², t = b2/(1 − b0) the density per area is constant: dω/(ds dt) = |n·x|/(2|x|³).
            test_rectangle(
                &format!("triangle {i}"),
                (1.0, 1.0),
                (16, 16),
                200_000,
                |u| {
                    let (b, pdf) = spherical_triangle(v, Vec3::ZERO, u).expect("a triangle that can be sampled");
                    assert!((pdf * area - 1.0).abs() < 1e-4);
                    assert!((b.iter().sum::<f32>() - 1.0).abs() < 1e-5 && b.iter().all(|&x| x >= 0.0));
                    let rest = f64::from(b[1]) + f64::from(b[2]);
                    ((rest * rest).min(1.0), if rest > 0.0 { (f64::from(b[2]) / rest).min(1.0) } else { 0.0 })
                },
                |s, t| {
                    let rest = s.sqrt();
                    let x: DVec3 = d[0] * (1.0 - rest) + d[1] * (rest * (1.0 - t)) + d[2] * (rest * t);
                    0.5 * normal.dot(x).abs() / x.length().powi(3) / f64::from(area)
                },
            );
        }
    }

    #[test]
    fn known_areas() {
        use std::f32::consts::{FRAC_PI_2, TAU};
        assert!((spherical_triangle_area(Vec3::X, Vec3::Y, Vec3::Z) - FRAC_PI_2).abs() < 1e-6);
        let third = |k: f32| Vec3::new((k * TAU / 3.0).cos(), (k * TAU / 3.0).sin(), 0.0);
        assert!((spherical_triangle_area(third(0.0), third(1.0), third(2.0)) - TAU).abs() < 1e-5);
        assert_eq!(spherical_triangle_area(Vec3::X, Vec3::X, Vec3::Z), 0.0);
    }

    #[test]
    fn the_ends_of_the_unit_interval_stay_in_the_triangle() {
        for v in triangles() {
            for x in [0.0, 1e-7, 0.5, ONE_MINUS_EPSILON] {
                for y in [0.0, 1e-7, 0.5, ONE_MINUS_EPSILON] {
                    let (b, _) = spherical_triangle(v, Vec3::ZERO, Vec2::new(x, y)).expect("sampled");
                    assert!(b.iter().all(|b| (0.0..=1.0).contains(b)), "{b:?}");
                }
            }
        }
    }

    #[test]
    fn refuses_exactly_where_the_density_does() {
        let mut rng = HashRng::new(8);
        let mut refused = 0;
        for _ in 0..20_000 {
            let mut point = |s: f32| Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5) * s;
            let (v, p) = ([point(1.0), point(1.0), point(1.0)], point(30.0));
            let sampled = spherical_triangle(v, p, Vec2::new(0.3, 0.6));
            assert_eq!(sampled.map(|s| s.1), spherical_triangle_pdf(v, p));
            refused += usize::from(sampled.is_none());
        }
        assert!(refused > 100 && refused < 19_000, "{refused}");
        let [a, b, c] = triangles()[0];
        assert!(spherical_triangle([a, b, a], Vec3::ZERO, Vec2::ZERO).is_none());
        assert!(spherical_triangle([a, b, c], a, Vec2::ZERO).is_none());
        assert!(spherical_triangle([a, b, c * f32::NAN], Vec3::ZERO, Vec2::ZERO).is_none());
        assert!(spherical_triangle([a, b, c], (a + b + c) / 3.0, Vec2::ZERO).is_none());
    }
}

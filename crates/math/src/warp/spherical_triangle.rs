//! Uniform sampling of the solid angle of a triangle (Arvo 1995), in a form without cancellation.
//!
//! With the sub-triangle `a b c'` of area `A' = u.x·A` cut off at vertex `a` (angle `α`, side `c = ∠ab`), the side `b' = ∠ac'` obeys
//!
//! ```text
//! tan(b'/2) · tan(c/2) = sin(A'/2) / sin(α − A'/2)
//! ```
//!
//! This is the same function as Arvo's quotient of differences of cosines, but a product of small numbers stays precise. The area
//! is that of van Oosterom and Strackee (1983), with the triple product taken of edge vectors.

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

/// A point of the triangle `v`, uniform in the solid angle seen from `p`: its barycentric coordinates and density per solid angle.
///
/// `None` where the triangle is degenerate or looks too small or too large from `p`; the caller samples its area instead.
/// [`spherical_triangle_pdf`] takes the same decision.
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

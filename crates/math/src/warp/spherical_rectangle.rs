//! Uniform sampling of the solid angle of a rectangle (Ureña, Fajardo and King 2013, "An area-preserving
//! parametrization for spherical rectangles").

use crate::{
    Vec2, Vec3,
    elementary::{angle_f64, sin_cos_f64},
};
use std::f64::consts::TAU;

/// A planar rectangle as seen from a point, ready to be sampled uniformly in solid angle. The angles are kept in `f64`:
/// the solid angle is a sum of four angles less `2π`, of which a small rectangle leaves little.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    /// Solid angle in sr; 0 where the rectangle is degenerate or seen edge-on, and then it cannot be sampled.
    pub solid_angle: f32,
    corner: Vec3,
    ex: Vec3,
    ey: Vec3,
    /// Rectangle in the local frame at the point: `[x0, x1] × [y0, y1]` at distance `z0 < 0`.
    x0: f64,
    x1: f64,
    y0: f64,
    y1: f64,
    z0: f64,
    /// z of the unit normals of the planes through the bottom and the top edge.
    b0: f64,
    b1: f64,
    /// `2π` less the two inner angles at the right.
    k: f64,
    area: f64,
}

impl SphericalRectangle {
    /// The rectangle `corner + s·ex + t·ey`, `s, t ∈ [0,1]`, `ex ⊥ ey`, seen from `p`.
    #[inline(always)]
    pub fn new(corner: Vec3, ex: Vec3, ey: Vec3, p: Vec3) -> Self {
        let (lx, ly) = (ex.as_dvec3().length(), ey.as_dvec3().length());
        let (x, y) = (ex.as_dvec3() * (1.0 / lx), ey.as_dvec3() * (1.0 / ly));
        let d = corner.as_dvec3() - p.as_dvec3();
        let (x0, y0, z0) = (d.dot(x), d.dot(y), -d.dot(x.cross(y)).abs());
        let (x1, y1) = (x0 + lx, y0 + ly);

        // The angle between two side planes, times whose lengths the cosine of the normals' angle is −ab for signed
        // distances a, b of the sides, and the sine |z| times the distance of the corner; so nothing cancels. Angles
        // are added up as products of complex numbers.
        let corner_at = |a: f64, b: f64| (a * a + b * b + z0 * z0).sqrt() * -z0;
        let both = |(c0, s0): (f64, f64), (c1, s1): (f64, f64)| {
            let (c, s) = (c0 * c1 - s0 * s1, s0 * c1 + c0 * s1);
            let angle = angle_f64(s.abs(), c);
            if s < 0.0 { TAU - angle } else { angle }
        };
        let first = both((y0 * x1, corner_at(y0, x1)), (-x1 * y1, corner_at(x1, y1)));
        let last = both((y1 * x0, corner_at(y1, x0)), (-x0 * y0, corner_at(x0, y0)));
        let area = first + last - TAU;
        let side = |s: f64| s / (s * s + z0 * z0).sqrt();
        // Also false for NaN, which zero edges and a point in the plane's edges give.
        let usable = area > 0.0 && z0 < 0.0 && area.is_finite();
        let area = if usable { area } else { 0.0 };
        Self {
            solid_angle: area as f32,
            corner,
            ex,
            ey,
            x0,
            x1,
            y0,
            y1,
            z0,
            b0: -side(y0),
            b1: side(y1),
            k: TAU - last,
            area,
        }
    }

    /// A point of the rectangle, uniform in solid angle with density `1/solid_angle`.
    #[inline(always)]
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let (s, t) = self.sample_coordinates(u);
        self.corner + self.ex * s + self.ey * t
    }

    /// Like [`SphericalRectangle::sample`], as the coordinates `(s, t) ∈ [0,1]²` of the point.
    #[inline(always)]
    pub fn sample_coordinates(&self, u: Vec2) -> (f32, f32) {
        if self.area <= 0.0 {
            return (u.x, u.y);
        }
        // x: the vertical line that cuts off u.x of the solid angle.
        let (sin, cos) = sin_cos_f64(f64::from(u.x) * self.area + self.k);
        let f = (cos * self.b0 - self.b1) / sin;
        let c = (1.0_f64.copysign(f) / (f * f + self.b0 * self.b0).sqrt()).clamp(-1.0, 1.0);
        let x = (-(c * self.z0) / (1.0 - c * c).max(f64::MIN_POSITIVE).sqrt()).max(self.x0).min(self.x1);
        // y: uniform in the sine of the elevation along that line.
        let d2 = x * x + self.z0 * self.z0;
        let (h0, h1) = (self.y0 / (d2 + self.y0 * self.y0).sqrt(), self.y1 / (d2 + self.y1 * self.y1).sqrt());
        let h = h0 + f64::from(u.y) * (h1 - h0);
        let y = (h * (d2 / (1.0 - h * h).max(f64::MIN_POSITIVE)).sqrt()).max(self.y0).min(self.y1);
        (((x - self.x0) / (self.x1 - self.x0)) as f32, ((y - self.y0) / (self.y1 - self.y0)) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::test_rectangle;
    use crate::hash::ONE_MINUS_EPSILON;

    fn rectangles() -> [(Vec3, Vec3, Vec3, Vec3); 5] {
        let x = Vec3::new(1.0, 2.0, -0.5).normalize();
        let y = x.any_orthonormal_vector();
        let z = x.cross(y);
        [
            (Vec3::new(-1.0, -1.0, 1.0), Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::ZERO),
            (x + 2.0 * z, x * 1.5, y * 0.7, Vec3::new(0.1, 0.2, -0.1)),
            // From behind, at a grazing angle, near, and far away.
            (-0.5 * x - z, x, y, 3.0 * x),
            (-x - y, 3.0 * x, 2.0 * y, -0.05 * z),
            (100.0 * z, x, y, Vec3::ZERO),
        ]
    }

    #[test]
    fn points_are_uniform_in_solid_angle() {
        for (i, (corner, ex, ey, p)) in rectangles().into_iter().enumerate() {
            let r = SphericalRectangle::new(corner, ex, ey, p);
            let (c, dx, dy) = ((corner - p).as_dvec3(), ex.as_dvec3(), ey.as_dvec3());
            let normal = dx.cross(dy);
            // The density also proves the solid angle: it integrates to one.
            test_rectangle(
                &format!("rectangle {i}"),
                (1.0, 1.0),
                (24, 24),
                200_000,
                |u| {
                    let (s, t) = r.sample_coordinates(u);
                    assert!((r.sample(u) - (corner + ex * s + ey * t)).length() < 1e-5);
                    (f64::from(s), f64::from(t))
                },
                |s, t| {
                    let q = c + dx * s + dy * t;
                    normal.dot(q).abs() / q.length().powi(3) / f64::from(r.solid_angle)
                },
            );
        }
    }

    #[test]
    fn degenerate_rectangles_have_no_solid_angle() {
        let whole = SphericalRectangle::new(Vec3::new(-1.0, -1.0, 1.0), Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::ZERO);
        assert!((whole.solid_angle - 2.0 * std::f32::consts::PI / 3.0).abs() < 1e-6, "one face of a cube");
        for (ex, ey, p) in [
            (Vec3::ZERO, Vec3::Y, Vec3::Z),
            (Vec3::X, Vec3::Y, Vec3::new(5.0, 5.0, 0.0)),
            (Vec3::X, Vec3::Y, Vec3::ZERO),
            (Vec3::X, Vec3::NAN, Vec3::Z),
        ] {
            let r = SphericalRectangle::new(Vec3::ZERO, ex, ey, p);
            assert!(r.solid_angle >= 0.0 && r.solid_angle < 1e-6, "{ex} {ey} {p}: {}", r.solid_angle);
        }
        for (corner, ex, ey, p) in rectangles() {
            let r = SphericalRectangle::new(corner, ex, ey, p);
            for u in [Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON), Vec2::new(0.0, ONE_MINUS_EPSILON)] {
                let (s, t) = r.sample_coordinates(u);
                assert!((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t));
            }
        }
    }
}

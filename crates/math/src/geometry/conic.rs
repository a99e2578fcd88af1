//! Plane curves of second order, each implicit, explicit where it can be, and parametric.
//!
//! The implicit functions are negative inside, zero on the curve.

use glam::{DMat3, DVec2};
use std::f64::consts::TAU;

/// The parabola `(x − c.x)² = 4 p (y − c.y)`: apex `c`, focus `p` above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parabola {
    /// Apex.
    pub apex: DVec2,
    /// Distance from the apex to the focus, not zero; negative for a parabola that opens downwards.
    pub focal_length: f64,
}

impl Parabola {
    /// `None` for a focal length of zero.
    pub fn new(apex: DVec2, focal_length: f64) -> Option<Self> {
        (focal_length != 0.0 && focal_length.is_finite() && apex.is_finite()).then_some(Self { apex, focal_length })
    }

    /// `y(x)`.
    pub fn explicit(&self, x: f64) -> f64 {
        self.apex.y + (x - self.apex.x).powi(2) / (4.0 * self.focal_length)
    }

    /// `(x − c.x)²/(4p) − (y − c.y)`.
    pub fn implicit(&self, p: DVec2) -> f64 {
        self.explicit(p.x) - p.y
    }

    /// `[t, t²/4p] + c`.
    pub fn at(&self, t: f64) -> DVec2 {
        DVec2::new(t, t * t / (4.0 * self.focal_length)) + self.apex
    }

    /// The focus.
    pub fn focus(&self) -> DVec2 {
        self.apex + DVec2::Y * self.focal_length
    }
}

/// An ellipse with perpendicular axes of any direction; a circle where they are equally long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// Centre.
    pub center: DVec2,
    /// Unit direction of the first semi-axis; the second one is a quarter turn on.
    pub axis: DVec2,
    /// Lengths of the two semi-axes, positive.
    pub radii: DVec2,
}

impl Ellipse {
    /// From the centre, the direction of the first semi-axis (of any length but zero) and the lengths of both; `None`
    /// where they are not positive.
    pub fn new(center: DVec2, axis: DVec2, radii: DVec2) -> Option<Self> {
        let axis = axis.try_normalize()?;
        (radii.min_element() > 0.0 && radii.is_finite() && center.is_finite()).then_some(Self { center, axis, radii })
    }

    /// The circle; `None` for a radius that is not positive.
    pub fn circle(center: DVec2, radius: f64) -> Option<Self> {
        Self::new(center, DVec2::X, DVec2::splat(radius))
    }

    /// The point in coordinates in which the ellipse is the unit circle.
    fn to_unit(self, p: DVec2) -> DVec2 {
        let d = p - self.center;
        DVec2::new(d.dot(self.axis), d.dot(self.axis.perp())) / self.radii
    }

    /// `(x'/a)² + (y'/b)² − 1` in the coordinates of its axes.
    pub fn implicit(&self, p: DVec2) -> f64 {
        self.to_unit(p).length_squared() - 1.0
    }

    /// The symmetric matrix of the implicit form, `⟨(x,1), Q (x,1)⟩`: the change of basis worked into the equation.
    pub fn matrix(&self) -> DMat3 {
        let (k, l) = (self.axis / self.radii.x, self.axis.perp() / self.radii.y);
        let to_unit = DMat3::from_cols(k.extend(-k.dot(self.center)), l.extend(-l.dot(self.center)), glam::DVec3::Z);
        to_unit * DMat3::from_diagonal(glam::DVec3::new(1.0, 1.0, -1.0)) * to_unit.transpose()
    }

    /// `a cos t k + b sin t l + c`, `t ∈ [0, 2π)`, counter-clockwise.
    pub fn at(&self, t: f64) -> DVec2 {
        let (sin, cos) = t.sin_cos();
        self.center + self.axis * (self.radii.x * cos) + self.axis.perp() * (self.radii.y * sin)
    }

    /// The parameter in `[0, 2π)` of the point of the curve in the direction of `p` from the centre, in its own
    /// coordinates.
    pub fn parameter(&self, p: DVec2) -> f64 {
        let u = self.to_unit(p);
        super::coordinates::Polar::from_cartesian(u).phi
    }

    /// The lower and the upper `y` at `x`: no single function, as the curve folds back; `None` beside it.
    pub fn explicit(&self, x: f64) -> Option<[f64; 2]> {
        let q = self.matrix();
        // Q as a quadratic in y.
        let (a, h, c) =
            (q.y_axis.y, q.x_axis.y * x + q.y_axis.z, q.x_axis.x * x * x + 2.0 * q.x_axis.z * x + q.z_axis.z);
        crate::intersect::roots(a, h, c)
    }

    /// Area, `π a b`.
    pub fn area(&self) -> f64 {
        0.5 * TAU * self.radii.x * self.radii.y
    }
}

/// The segment between two points of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The point at `t = 0`.
    pub a: DVec2,
    /// The point at `t = 1`.
    pub b: DVec2,
}

impl Segment {
    /// `(1 − t) a + t b`, on the segment for `t ∈ [0, 1]`.
    pub fn at(&self, t: f64) -> DVec2 {
        self.a.lerp(self.b, t)
    }

    /// Distance from a point.
    pub fn distance(&self, p: DVec2) -> f64 {
        let d = self.b - self.a;
        let l2 = d.length_squared();
        let t = if l2 > 0.0 { ((p - self.a).dot(d) / l2).clamp(0.0, 1.0) } else { 0.0 };
        p.distance(self.at(t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;
    use crate::quadrature::integrate;

    #[test]
    fn parabolas() {
        let mut r = Random::new(15);
        for _ in 0..500 {
            let parabola = Parabola::new(r.vector2(), r.number() * 0.9 + 1.0).expect("a parabola");
            let t = r.number() * 3.0;
            let p = parabola.at(t);
            assert!(parabola.implicit(p).abs() < 1e-13 && (parabola.explicit(p.x) - p.y).abs() < 1e-13);
            // Every point is as far from the focus as from the directrix.
            let directrix = parabola.apex.y - parabola.focal_length;
            assert!((p.distance(parabola.focus()) - (p.y - directrix).abs()).abs() < 1e-12);
            assert!(parabola.implicit(parabola.focus()) < 0.0);
        }
        assert_eq!(Parabola::new(DVec2::ZERO, 0.0), None);
    }

    #[test]
    fn circles_and_ellipses_with_any_axes() {
        let mut r = Random::new(16);
        for i in 0..500 {
            let radii = if i % 4 == 0 { DVec2::splat(0.7) } else { r.vector2().abs() + 0.2 };
            let e = Ellipse::new(r.vector2(), r.vector2() + DVec2::X * 1.1, radii).expect("an ellipse");
            let t = (r.number() + 1.0) * 0.5 * TAU;
            let p = e.at(t);
            assert!(e.implicit(p).abs() < 1e-12);
            assert!(p.extend(1.0).dot(e.matrix() * p.extend(1.0)).abs() < 1e-12);
            let x = r.vector2() * 2.0;
            assert!((x.extend(1.0).dot(e.matrix() * x.extend(1.0)) - e.implicit(x)).abs() < 1e-11);
            let difference = (e.parameter(p) - t).abs();
            assert!(difference < 1e-9 || (difference - TAU).abs() < 1e-9);
            let [low, high] = e.explicit(p.x).expect("beside it");
            assert!((low - p.y).abs().min((high - p.y).abs()) < 1e-6 && low <= high);
            assert!(e.implicit(e.center) < 0.0 && e.explicit(e.center.x + 9.0).is_none());
            // The sum of the distances from the two foci is twice the longer semi-axis.
            let (major, minor) = (radii.max_element(), radii.min_element());
            let along = if radii.x >= radii.y { e.axis } else { e.axis.perp() };
            let f = along * (major * major - minor * minor).sqrt();
            assert!((p.distance(e.center + f) + p.distance(e.center - f) - 2.0 * major).abs() < 1e-9);
        }
        let e = Ellipse::new(DVec2::ONE, DVec2::new(3.0, 4.0), DVec2::new(2.0, 0.5)).expect("an ellipse");
        let area =
            integrate(|t| 0.5 * (e.at(t) - e.center).perp_dot(e.at(t + 1e-6) - e.at(t - 1e-6)) / 2e-6, 0.0, TAU, 40);
        assert!((area - e.area()).abs() < 1e-8);
        assert_eq!(Ellipse::circle(DVec2::ZERO, 0.0), None);
        assert_eq!(Ellipse::new(DVec2::ZERO, DVec2::ZERO, DVec2::ONE), None);
    }

    #[test]
    fn segments() {
        let s = Segment { a: DVec2::new(1.0, 1.0), b: DVec2::new(3.0, 1.0) };
        assert_eq!(s.at(0.25), DVec2::new(1.5, 1.0));
        assert_eq!(s.distance(DVec2::new(2.0, 4.0)), 3.0);
        assert_eq!(s.distance(DVec2::new(0.0, 1.0)), 1.0);
        assert_eq!(Segment { a: s.a, b: s.a }.distance(DVec2::new(1.0, 3.0)), 2.0);
    }
}

//! Lines of the plane in all their forms, and segments and lines of space.
//!
//! The form that is kept is the line coordinates `[a, b, c]`, `a x + b y + c = 0`: it has no exceptions (the ideal line
//! is `[0, 0, 1]`), and joining points and meeting lines are both a cross product.

use super::Point3;
use glam::{DVec2, DVec3};

/// A line of the projective plane by its line coordinates; all multiples but zero are the same line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line2 {
    /// `[a, b, c]` of `a x + b y + c = 0`; `(a, b)` is a normal.
    pub coordinates: DVec3,
}

impl Line2 {
    /// The line at infinity, on which all ideal points lie.
    pub const IDEAL: Self = Self { coordinates: DVec3::Z };

    /// From line coordinates; three zeros name no line.
    pub fn new(coordinates: DVec3) -> Option<Self> {
        (coordinates.is_finite() && coordinates != DVec3::ZERO).then_some(Self { coordinates })
    }

    /// `⟨x − p, n⟩ = 0`; `None` for a zero normal.
    pub fn from_point_normal(p: DVec2, n: DVec2) -> Option<Self> {
        (n != DVec2::ZERO).then(|| Self::new(n.extend(-n.dot(p)))).flatten()
    }

    /// `p + t v`; `None` for a zero direction. The normal lies to the left of the direction.
    pub fn from_point_direction(p: DVec2, v: DVec2) -> Option<Self> {
        Self::from_point_normal(p, v.perp())
    }

    /// The line through two distinct points: the cofactors of the determinant `|x y 1; p 1; q 1|`.
    pub fn through(p: DVec2, q: DVec2) -> Option<Self> {
        if p == q { None } else { Self::join(p.extend(1.0), q.extend(1.0)) }
    }

    /// The explicit line `y = m x + b`.
    pub fn from_slope(m: f64, b: f64) -> Option<Self> {
        Self::new(DVec3::new(m, -1.0, b))
    }

    /// The line through two homogeneous points; `None` where they are the same.
    pub fn join(p: DVec3, q: DVec3) -> Option<Self> {
        Self::new(p.cross(q))
    }

    /// The homogeneous point that lies on both lines (ideal for parallel ones); `None` where they are the same.
    pub fn meet(&self, other: &Self) -> Option<DVec3> {
        let x = self.coordinates.cross(other.coordinates);
        (x.is_finite() && x != DVec3::ZERO).then_some(x)
    }

    /// The Hesse normal form: the same line with a unit normal, so that [`Line2::value`] is the signed distance. `None`
    /// for the ideal line.
    pub fn hesse(&self) -> Option<Self> {
        let l = self.coordinates.truncate().length();
        (l > 0.0).then_some(())?;
        Self::new(self.coordinates / l)
    }

    /// `a x + b y + c`: positive on the side of the normal.
    pub fn value(&self, p: DVec2) -> f64 {
        self.coordinates.dot(p.extend(1.0))
    }

    /// Slope and intercept of `y = m x + b`; `None` for vertical lines.
    pub fn slope_intercept(&self) -> Option<(f64, f64)> {
        let DVec3 { x: a, y: b, z: c } = self.coordinates;
        let (m, k) = (-a / b, -c / b);
        (m.is_finite() && k.is_finite()).then_some((m, k))
    }

    /// The parametric form: the foot of the perpendicular from the origin, and a unit direction. `None` for the ideal
    /// line.
    pub fn parametric(&self) -> Option<(DVec2, DVec2)> {
        let h = self.hesse()?.coordinates;
        let n = h.truncate();
        Some((-h.z * n, -n.perp()))
    }
}

/// Twice the signed area of the triangle `x p q`: zero exactly on the line through `p` and `q`.
pub fn collinearity(x: DVec2, p: DVec2, q: DVec2) -> f64 {
    glam::DMat3::from_cols(x.extend(1.0), p.extend(1.0), q.extend(1.0)).determinant()
}

/// A line of space, `p + t v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line3 {
    /// A point of it.
    pub point: Point3,
    /// Its direction, not zero.
    pub direction: DVec3,
}

impl Line3 {
    /// From a point and a direction; `None` for a zero direction.
    pub fn new(point: Point3, direction: DVec3) -> Option<Self> {
        (direction.is_finite() && direction != DVec3::ZERO).then_some(Self { point, direction })
    }

    /// The line through two distinct points, at `t = 0` and `t = 1`: `(1 − t) p + t q`.
    pub fn through(p: Point3, q: Point3) -> Option<Self> {
        Self::new(p, q - p)
    }

    /// The point at `t`. Between 0 and 1 it runs over the segment that [`Line3::through`] was made of.
    pub fn at(&self, t: f64) -> Point3 {
        self.point + self.direction * t
    }

    /// The parameter of the point of the line nearest to `p`.
    pub fn nearest(&self, p: Point3) -> f64 {
        (p - self.point).dot(self.direction) / self.direction.length_squared()
    }

    /// Distance of a point from the line.
    pub fn distance(&self, p: Point3) -> f64 {
        (p - self.point).cross(self.direction).length() / self.direction.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    #[test]
    fn all_forms_describe_the_same_line() {
        let mut r = Random::new(10);
        for _ in 0..1000 {
            let (p, q) = (r.vector2(), r.vector2());
            if p.distance(q) < 0.1 || (q.x - p.x).abs() < 0.01 {
                continue;
            }
            let through = Line2::through(p, q).expect("two points");
            let (m, b) = through.slope_intercept().expect("not vertical");
            let forms = [
                through,
                Line2::from_point_direction(p, q - p).expect("a direction"),
                Line2::from_point_normal(q, (q - p).perp() * 3.0).expect("a normal"),
                Line2::from_slope(m, b).expect("finite"),
                Line2::join(q.extend(1.0) * -2.0, (q - p).extend(0.0)).expect("a point and an ideal point"),
            ];
            let x = r.vector2();
            let distance = forms[0].hesse().expect("ordinary").value(x);
            // The determinant is twice an area: the distance times the base.
            assert!((collinearity(x, p, q).abs() - distance.abs() * p.distance(q)).abs() < 1e-13);
            for line in forms {
                let h = line.hesse().expect("ordinary");
                assert!((h.value(x).abs() - distance.abs()).abs() < 1e-11, "{line:?}");
                assert!(h.value(p).abs() < 1e-12 && h.value(q).abs() < 1e-12);
                let (foot, v) = line.parametric().expect("ordinary");
                assert!(foot.dot(v).abs() < 1e-12 && (v.length() - 1.0).abs() < 1e-14);
                let on_line = foot + v * r.number() * 10.0;
                assert!(collinearity(on_line, p, q).abs() < 1e-11);
                assert!((on_line.y - (m * on_line.x + b)).abs() < 1e-8 * (1.0 + m.abs()));
            }
            assert!(through.value(p + (q - p).perp()) * forms[1].value(p + (q - p).perp()) > 0.0);
        }
    }

    #[test]
    fn join_and_meet_are_dual() {
        let mut r = Random::new(11);
        for _ in 0..1000 {
            let (a, b, c) = (r.vector2(), r.vector2(), r.vector2());
            if collinearity(a, b, c).abs() < 0.05 {
                continue;
            }
            let (l, m) = (Line2::through(a, b).expect("two points"), Line2::through(a, c).expect("two points"));
            let x = l.meet(&m).expect("two lines");
            assert!((x.truncate() / x.z - a).length() < 1e-12);
        }
        // Parallels meet at the ideal point of their direction, every line meets the ideal line there.
        let l = Line2::from_slope(2.0, 0.0).expect("a line");
        let m = Line2::from_slope(2.0, 5.0).expect("a line");
        let x = l.meet(&m).expect("two lines");
        assert!(x.z == 0.0 && (x.y / x.x - 2.0).abs() < 1e-15);
        assert_eq!(l.meet(&Line2::IDEAL).map(|i| i.cross(x).length()), Some(0.0));
        assert_eq!(l.meet(&l), None);
        assert_eq!(Line2::IDEAL.hesse(), None);
        assert_eq!(Line2::IDEAL.parametric(), None);
        assert_eq!(Line2::through(DVec2::ONE, DVec2::ONE), None);
        assert_eq!(Line2::from_point_normal(DVec2::ONE, DVec2::ZERO), None);
        assert_eq!(Line2::new(DVec3::ZERO), None);
        assert_eq!(Line2::new(DVec3::X).and_then(|l| l.slope_intercept()), None, "vertical");
    }

    #[test]
    fn lines_and_segments_of_space() {
        let mut r = Random::new(12);
        for _ in 0..200 {
            let (p, q, x) = (r.point(), r.point(), r.point());
            let line = Line3::through(p, q).expect("two points");
            assert!(line.at(0.0) == p && line.at(1.0).distance(q) < 1e-15);
            let t = r.number();
            assert!(line.at(t).distance(p.lerp(q, t)) < 1e-15);
            let foot = line.at(line.nearest(x));
            assert!((x - foot).dot(line.direction).abs() < 1e-13);
            assert!((x.distance(foot) - line.distance(x)).abs() < 1e-13);
        }
        assert_eq!(Line3::through(Point3::ORIGIN, Point3::ORIGIN), None);
    }
}

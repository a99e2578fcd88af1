//! The torus around the z axis.

use super::{Implicit, Parametric};
use crate::geometry::Point3;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The torus `(√(x² + y²) − R)² + z² = r²` around the origin, `0 < r < R`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    radius: f64,
    tube: f64,
}

impl Torus {
    /// From the radius of the circle and that of the tube; `None` but for `0 < tube < radius`.
    pub fn new(radius: f64, tube: f64) -> Option<Self> {
        (0.0 < tube && tube < radius && radius.is_finite()).then_some(Self { radius, tube })
    }

    /// Volume, `2π² R r²` (Pappus).
    pub fn volume(&self) -> f64 {
        2.0 * PI * PI * self.radius * self.tube * self.tube
    }
}

impl Implicit for Torus {
    fn value(&self, p: Point3) -> f64 {
        (p.x.hypot(p.y) - self.radius).powi(2) + p.z * p.z - self.tube * self.tube
    }

    fn gradient(&self, p: Point3) -> DVec3 {
        let from_axis = p.x.hypot(p.y);
        let radial = if from_axis > 0.0 { 1.0 - self.radius / from_axis } else { 0.0 };
        2.0 * DVec3::new(radial * p.x, radial * p.y, p.z)
    }
}

/// `u` is the azimuth, `v` the angle around the tube from its outer side upwards.
impl Parametric for Torus {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[0.0, TAU], [0.0, TAU]]
    }

    fn is_closed_in_u(&self) -> bool {
        true
    }

    fn point(&self, u: f64, v: f64) -> Point3 {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        let from_axis = self.radius + self.tube * cv;
        Point3::new(from_axis * cu, from_axis * su, self.tube * sv)
    }

    fn partials(&self, u: f64, v: f64) -> [DVec3; 2] {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        [(self.radius + self.tube * cv) * DVec3::new(-su, cu, 0.0), self.tube * DVec3::new(-sv * cu, -sv * su, cv)]
    }

    fn second_partials(&self, u: f64, v: f64) -> [DVec3; 3] {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        [
            (self.radius + self.tube * cv) * DVec3::new(-cu, -su, 0.0),
            self.tube * sv * DVec3::new(su, -cu, 0.0),
            -self.tube * DVec3::new(cv * cu, cv * su, sv),
        ]
    }

    fn normal_at(&self, u: f64, v: f64) -> DVec3 {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        DVec3::new(cv * cu, cv * su, sv)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::tessellate;

    /// Pappus: the area is 4π² R r, the volume 2π² R r²; a mesh comes near both from below.
    #[test]
    fn area_and_volume_are_those_of_pappus() {
        let t = Torus::new(3.0, 1.0).expect("a torus");
        assert!((t.area(24) / (12.0 * PI * PI) - 1.0).abs() < 1e-10);
        let mesh = tessellate(&t, 240, 240).expect("a mesh");
        assert!((mesh.volume() / t.volume() - 1.0).abs() < 5e-4 && mesh.volume() < t.volume());
        assert!((mesh.area() / (12.0 * PI * PI) - 1.0).abs() < 5e-4);
        assert!(Torus::new(1.0, 1.0).is_none() && Torus::new(1.0, 0.0).is_none());
    }

    /// The three representations agree: points lie on f = 0, the gradient has the direction of the normal and of ∂u ×
    /// ∂v.
    #[test]
    fn representations_agree() {
        let t = Torus::new(2.0, 0.5).expect("a torus");
        for k in 0..40 {
            let (u, v) = (0.157 * f64::from(k), 0.971 * f64::from(k));
            let p = t.point(u, v);
            assert!(t.value(p).abs() < 1e-12);
            let n = t.normal(p).expect("a normal");
            let [du, dv] = t.partials(u, v);
            assert!(n.distance(t.normal_at(u, v)) < 1e-12 && n.distance(du.cross(dv).normalize()) < 1e-12);
        }
        assert!(t.value(Point3::new(2.0, 0.0, 0.0)) < 0.0 && t.normal(Point3::ORIGIN).is_none());
    }
}

//! The ellipsoid, and the sphere as the one with equal radii.

use super::{Implicit, Parametric};
use crate::geometry::Point3;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The ellipsoid `(x/a)² + (y/b)² + (z/c)² = 1` around a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    center: Point3,
    radii: DVec3,
}

impl Ellipsoid {
    /// From the centre and the semi-axes along x, y, z; `None` where they are not positive and finite.
    pub fn new(center: Point3, radii: DVec3) -> Option<Self> {
        (radii.min_element() > 0.0 && radii.is_finite() && center.to_vector().is_finite())
            .then_some(Self { center, radii })
    }

    /// The sphere; `None` for a radius that is not positive.
    pub fn sphere(center: Point3, radius: f64) -> Option<Self> {
        Self::new(center, DVec3::splat(radius))
    }

    /// Centre.
    pub fn center(&self) -> Point3 {
        self.center
    }

    /// Semi-axes.
    pub fn radii(&self) -> DVec3 {
        self.radii
    }

    /// Volume, `4π/3 · a b c`.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * PI * self.radii.element_product()
    }

    /// Parameters `(u, v)` of the point of the surface in the direction of `p` in the coordinates in which it is a unit
    /// sphere.
    pub fn parameters(&self, p: Point3) -> (f64, f64) {
        let s = crate::geometry::coordinates::Spherical::from_cartesian((p - self.center) / self.radii);
        (s.phi, s.theta)
    }
}

impl Implicit for Ellipsoid {
    fn value(&self, p: Point3) -> f64 {
        ((p - self.center) / self.radii).length_squared() - 1.0
    }

    fn gradient(&self, p: Point3) -> DVec3 {
        2.0 * (p - self.center) / (self.radii * self.radii)
    }
}

/// `u` is the azimuth, `v` the angle from `+z`.
impl Parametric for Ellipsoid {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[0.0, TAU], [0.0, PI]]
    }

    fn is_closed_in_u(&self) -> bool {
        true
    }

    fn point(&self, u: f64, v: f64) -> Point3 {
        self.center + self.radii * unit(u, v)
    }

    fn partials(&self, u: f64, v: f64) -> [DVec3; 2] {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        [self.radii * DVec3::new(-su * sv, cu * sv, 0.0), self.radii * DVec3::new(cu * cv, su * cv, -sv)]
    }

    fn second_partials(&self, u: f64, v: f64) -> [DVec3; 3] {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        [
            self.radii * DVec3::new(-cu * sv, -su * sv, 0.0),
            self.radii * DVec3::new(-su * cv, cu * cv, 0.0),
            -self.radii * unit(u, v),
        ]
    }

    fn normal_at(&self, u: f64, v: f64) -> DVec3 {
        // ∂u × ∂v is −sin v times this, so inwards, and zero at the poles.
        (unit(u, v) / self.radii).normalize()
    }
}

/// The point of the unit sphere.
fn unit(u: f64, v: f64) -> DVec3 {
    let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
    DVec3::new(cu * sv, su * sv, cv)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::{laws, tessellate};

    #[test]
    fn spheres_and_ellipsoids_obey_the_laws() {
        laws::check(&Ellipsoid::sphere(Point3::new(1.0, -2.0, 0.5), 1.5).expect("a sphere"));
        laws::check(&Ellipsoid::new(Point3::new(0.0, 1.0, 2.0), DVec3::new(0.5, 2.0, 1.0)).expect("an ellipsoid"));
        assert_eq!(Ellipsoid::sphere(Point3::ORIGIN, -1.0), None);
        assert_eq!(Ellipsoid::new(Point3::ORIGIN, DVec3::new(1.0, 0.0, 1.0)), None);
    }

    #[test]
    fn poles_have_normals() {
        let e = Ellipsoid::new(Point3::ORIGIN, DVec3::new(0.5, 2.0, 1.0)).expect("an ellipsoid");
        assert!((e.normal_at(0.3, 0.0) - DVec3::Z).length() < 1e-15);
        assert!((e.normal_at(0.3, PI) + DVec3::Z).length() < 1e-15);
        let [du, dv] = e.partials(0.3, 1.0);
        assert!(du.cross(dv).dot(e.normal_at(0.3, 1.0)) < 0.0, "the cross product points inwards");
    }

    #[test]
    fn areas_and_volumes() {
        let r = 1.7;
        let s = Ellipsoid::sphere(Point3::new(5.0, 0.0, 0.0), r).expect("a sphere");
        assert!((s.area(24) - 4.0 * PI * r * r).abs() < 1e-9);
        assert!((s.volume() - 4.0 / 3.0 * PI * r.powi(3)).abs() < 1e-12);
        // Spheroids have closed forms: oblate 2πa²(1 + (1 − e²)/e·artanh e), prolate 2πa²(1 + c/(a e)·arcsin e).
        let (a, c) = (2.0_f64, 1.0_f64);
        let e = (1.0 - c * c / (a * a)).sqrt();
        let oblate = TAU * a * a * (1.0 + (1.0 - e * e) / e * e.atanh());
        let by_quadrature = Ellipsoid::new(Point3::ORIGIN, DVec3::new(a, a, c)).expect("an ellipsoid").area(40);
        assert!((by_quadrature / oblate - 1.0).abs() < 1e-9);
        let prolate = TAU * c * c * (1.0 + a / (c * e) * e.asin());
        let by_quadrature = Ellipsoid::new(Point3::ORIGIN, DVec3::new(c, c, a)).expect("an ellipsoid").area(40);
        assert!((by_quadrature / prolate - 1.0).abs() < 1e-9);
    }

    #[test]
    fn parameters_come_back() {
        let e = Ellipsoid::new(Point3::new(1.0, 2.0, 3.0), DVec3::new(0.5, 2.0, 1.0)).expect("an ellipsoid");
        for (u, v) in [(0.1, 0.2), (3.0, 1.5), (6.2, 3.0)] {
            let (a, b) = e.parameters(e.point(u, v));
            assert!((a - u).abs() < 1e-12 && (b - v).abs() < 1e-12);
        }
    }

    #[test]
    fn meshes_converge_with_the_square_of_the_step() {
        let e = Ellipsoid::new(Point3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 1.5)).expect("an ellipsoid");
        let exact = [e.area(64), e.volume()];
        let errors = [16, 32, 64].map(|n| {
            let mesh = tessellate(&e, 2 * n, n).expect("a mesh");
            [exact[0] - mesh.area(), exact[1] - mesh.volume()]
        });
        for k in 0..2 {
            for pair in errors.windows(2) {
                let order = (pair[0][k] / pair[1][k]).log2();
                assert!((1.9..2.1).contains(&order), "order {order}");
            }
        }
        // The volume is positive: the triangles turn outwards.
        assert!(errors[2][1] > 0.0 && errors[2][1] < 0.01 * exact[1]);
    }
}

//! The paraboloid over a rectangle.

use super::{Explicit, Implicit, Parametric};
use crate::geometry::Point3;
use glam::DVec3;

/// The paraboloid `z − c.z = a (x − c.x)² + b (y − c.y)²` around its apex `c`, with parameters in `[−extent, extent]²`.
/// Its inside is above, its outward normals point down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paraboloid {
    apex: Point3,
    a: f64,
    b: f64,
    extent: f64,
}

impl Paraboloid {
    /// `None` where a number is not finite or the extent not positive.
    pub fn new(apex: Point3, a: f64, b: f64, extent: f64) -> Option<Self> {
        let finite = apex.to_vector().is_finite() && a.is_finite() && b.is_finite() && extent.is_finite();
        (finite && extent > 0.0).then_some(Self { apex, a, b, extent })
    }
}

impl Explicit for Paraboloid {
    fn height(&self, x: f64, y: f64) -> f64 {
        let (x, y) = (x - self.apex.x, y - self.apex.y);
        self.apex.z + self.a * x * x + self.b * y * y
    }
}

impl Implicit for Paraboloid {
    fn value(&self, p: Point3) -> f64 {
        self.height(p.x, p.y) - p.z
    }

    fn gradient(&self, p: Point3) -> DVec3 {
        let d = p - self.apex;
        DVec3::new(2.0 * self.a * d.x, 2.0 * self.b * d.y, -1.0)
    }
}

/// `u` and `v` are `x` and `y` from the apex.
impl Parametric for Paraboloid {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[-self.extent, self.extent]; 2]
    }

    fn is_closed_in_u(&self) -> bool {
        false
    }

    fn point(&self, u: f64, v: f64) -> Point3 {
        self.apex + DVec3::new(u, v, self.a * u * u + self.b * v * v)
    }

    fn partials(&self, u: f64, v: f64) -> [DVec3; 2] {
        [DVec3::new(1.0, 0.0, 2.0 * self.a * u), DVec3::new(0.0, 1.0, 2.0 * self.b * v)]
    }

    fn second_partials(&self, _: f64, _: f64) -> [DVec3; 3] {
        [DVec3::Z * 2.0 * self.a, DVec3::ZERO, DVec3::Z * 2.0 * self.b]
    }

    fn normal_at(&self, u: f64, v: f64) -> DVec3 {
        DVec3::new(2.0 * self.a * u, 2.0 * self.b * v, -1.0).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::{laws, tessellate};
    use std::f64::consts::PI;

    #[test]
    fn paraboloids_obey_the_laws() {
        let p = Paraboloid::new(Point3::new(1.0, 2.0, -1.0), 0.5, 1.5, 2.0).expect("a paraboloid");
        laws::check(&p);
        laws::check(&Paraboloid::new(Point3::ORIGIN, 1.0, -0.7, 1.0).expect("a saddle"));
        for (u, v) in [(0.3, -1.2), (2.0, 0.0)] {
            let q = p.point(u, v);
            assert!((p.height(q.x, q.y) - q.z).abs() < 1e-14);
        }
        assert_eq!(Paraboloid::new(Point3::ORIGIN, f64::NAN, 1.0, 1.0), None);
    }

    #[test]
    fn the_area_of_a_bowl_is_the_known_one() {
        // Over the disk of radius R, z = a r² has the area π/(6a²)·((1 + 4a²R²)^{3/2} − 1); ring by ring, from the
        // partials.
        let (a, radius) = (0.8, 1.3);
        let bowl = Paraboloid::new(Point3::ORIGIN, a, a, radius).expect("a bowl");
        let area = crate::quadrature::integrate(
            |r| {
                let [du, dv] = bowl.partials(r, 0.0);
                2.0 * PI * r * du.cross(dv).length()
            },
            0.0,
            radius,
            32,
        );
        let exact = PI / (6.0 * a * a) * ((1.0 + 4.0 * a * a * radius * radius).powf(1.5) - 1.0);
        assert!((area - exact).abs() < 1e-10);
    }

    #[test]
    fn meshes_converge_and_turn_outwards() {
        let p = Paraboloid::new(Point3::ORIGIN, 0.5, 1.5, 1.0).expect("a paraboloid");
        let exact = p.area(32);
        let errors = [8, 16, 32].map(|n| exact - tessellate(&p, n, n).expect("a mesh").area());
        assert!(
            (1.9..2.1).contains(&(errors[0] / errors[1]).log2())
                && (1.9..2.1).contains(&(errors[1] / errors[2]).log2())
        );
        let mesh = tessellate(&p, 8, 8).expect("a mesh");
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).z < 0.0);
        }
    }
}

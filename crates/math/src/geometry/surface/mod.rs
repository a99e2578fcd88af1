//! Surfaces of space in their three representations, their normals and the classical objects.
//!
//! Implicit functions are negative inside, so gradients point outwards, and parametric normals are turned to agree with
//! them. Textbooks differ here: `∂u × ∂v` of the usual parameters of an ellipsoid points inwards, and vanishes at its
//! poles.

mod ellipsoid;
mod paraboloid;
mod tessellation;
mod torus;

pub use ellipsoid::Ellipsoid;
pub use paraboloid::Paraboloid;
pub use tessellation::{SurfaceMesh, tessellate};
pub use torus::Torus;

use super::Point3;
use crate::quadrature::gauss_legendre;
use glam::DVec3;

/// A surface `f(p) = 0`, with `f < 0` inside.
pub trait Implicit {
    /// `f(p)`.
    fn value(&self, p: Point3) -> f64;

    /// `∇f(p)`; points outwards on the surface.
    fn gradient(&self, p: Point3) -> DVec3;

    /// Unit outward normal at a point of the surface; `None` where the gradient vanishes.
    fn normal(&self, p: Point3) -> Option<DVec3> {
        self.gradient(p).try_normalize()
    }
}

/// A surface `p(u, v)` over a rectangle of parameters.
pub trait Parametric {
    /// Ranges of `u` and of `v`.
    fn domain(&self) -> [[f64; 2]; 2];

    /// True if `u` closes upon itself: its two ends are the same curve.
    fn is_closed_in_u(&self) -> bool;

    /// The point of the parameters.
    fn point(&self, u: f64, v: f64) -> Point3;

    /// `∂p/∂u` and `∂p/∂v`.
    fn partials(&self, u: f64, v: f64) -> [DVec3; 2];

    /// `∂²p/∂u²`, `∂²p/∂u∂v` and `∂²p/∂v²`.
    fn second_partials(&self, u: f64, v: f64) -> [DVec3; 3];

    /// Unit outward normal, also where the partials are dependent.
    fn normal_at(&self, u: f64, v: f64) -> DVec3;

    /// Area of the part over the whole domain, by Gauss–Legendre quadrature of `|∂u × ∂v|` with `n²` points.
    fn area(&self, n: usize) -> f64 {
        let [[u0, u1], [v0, v1]] = self.domain();
        let rule = gauss_legendre(n);
        let scale = 0.25 * (u1 - u0) * (v1 - v0);
        let map = |a: f64, b: f64, x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x;
        rule.iter()
            .flat_map(|&(x, wx)| rule.iter().map(move |&(y, wy)| (x, y, wx * wy)))
            .map(|(x, y, w)| {
                let [du, dv] = self.partials(map(u0, u1, x), map(v0, v1, y));
                w * du.cross(dv).length()
            })
            .sum::<f64>()
            * scale
    }
}

/// A surface `z = f(x, y)`.
pub trait Explicit {
    /// The height over `(x, y)`.
    fn height(&self, x: f64, y: f64) -> f64;
}

#[cfg(test)]
pub(crate) mod laws {
    //! Laws that every surface must obey.

    use super::*;
    use crate::geometry::random::Random;

    /// The representations agree, the derivatives are those of the functions, and normals are unit vectors that point
    /// outwards.
    pub fn check(surface: &(impl Implicit + Parametric)) {
        let mut r = Random::new(17);
        let [[u0, u1], [v0, v1]] = surface.domain();
        for _ in 0..1000 {
            let (u, v) = (u0 + (u1 - u0) * 0.5 * (r.number() + 1.0), v0 + (v1 - v0) * 0.5 * (r.number() + 1.0));
            let p = surface.point(u, v);
            let gradient = surface.gradient(p);
            assert!(surface.value(p).abs() < 1e-12 * (1.0 + gradient.length()));

            let h = 1e-6;
            let [du, dv] = surface.partials(u, v);
            assert!(((surface.point(u + h, v) - surface.point(u - h, v)) / (2.0 * h) - du).length() < 1e-7);
            assert!(((surface.point(u, v + h) - surface.point(u, v - h)) / (2.0 * h) - dv).length() < 1e-7);
            let numeric = [DVec3::X, DVec3::Y, DVec3::Z]
                .map(|e| (surface.value(p + e * h) - surface.value(p - e * h)) / (2.0 * h));
            assert!((DVec3::from(numeric) - gradient).length() < 1e-6 * (1.0 + gradient.length()));

            let n = surface.normal_at(u, v);
            assert!((n.length() - 1.0).abs() < 1e-13);
            assert!((n - surface.normal(p).expect("regular")).length() < 1e-9);
            assert!(n.dot(du).abs() < 1e-9 * (1.0 + du.length()) && n.dot(dv).abs() < 1e-9 * (1.0 + dv.length()));
            assert!(surface.value(p + n * 1e-4) > 0.0 && surface.value(p - n * 1e-4) < 0.0, "outwards at ({u}, {v})");
        }
    }
}

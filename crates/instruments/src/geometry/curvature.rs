//! The two fundamental forms of a surface, and its curvatures.
//!
//! `I = E du² + 2F du dv + G dv²` with `E = ⟨p_u, p_u⟩`, …, `II = L du² + 2M du dv + N dv²` with `L = ⟨p_uu, n⟩`, …;
//! `K = (LN − M²)/(EG − F²)`, `H = (EN − 2FM + GL)/(2(EG − F²))` (do Carmo, *Differential Geometry of Curves and
//! Surfaces*, §3.3, equations 4 and 5). Curvatures are positive where the surface bends towards its normal, so negative
//! on the outside of a sphere.

use steradian_math::{geometry::surface::Parametric, quadrature::gauss_legendre};

/// Fundamental forms of a surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Forms {
    /// `E`, `F`, `G`.
    pub first: [f64; 3],
    /// `L`, `M`, `N`.
    pub second: [f64; 3],
}

impl Forms {
    /// Fundamental forms of a surface at its parameters, for the outward normal.
    pub fn at(surface: &impl Parametric, u: f64, v: f64) -> Self {
        let ([pu, pv], n) = (surface.partials(u, v), surface.normal_at(u, v));
        Self { first: [pu.dot(pu), pu.dot(pv), pv.dot(pv)], second: surface.second_partials(u, v).map(|p| p.dot(n)) }
    }

    /// `EG − F²`, the square of the area per `du dv`.
    fn determinant(&self) -> f64 {
        let [e, f, g] = self.first;
        e * g - f * f
    }

    /// Gaussian and mean curvature; `None` where the parameters have no two directions.
    pub fn curvatures(&self) -> Option<(f64, f64)> {
        let ([e, f, g], [l, m, n], d) = (self.first, self.second, self.determinant());
        let k = ((l * n - m * m) / d, 0.5 * (e * n - 2.0 * f * m + g * l) / d);
        (d > 1e-20 * e * g && k.0.is_finite() && k.1.is_finite()).then_some(k)
    }
}

/// `∫ K dA` over the whole surface by Gauss and Legendre's rule with `n²` points: 2π times the Euler characteristic of
/// a closed one (Gauss and Bonnet).
pub fn total(surface: &impl Parametric, n: usize) -> f64 {
    let rule = gauss_legendre(n);
    let [[u0, u1], [v0, v1]] = surface.domain();
    let map = |a: f64, b: f64, x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x;
    let mut sum = 0.0;
    for &(x, wx) in &rule {
        for &(y, wy) in &rule {
            let forms = Forms::at(surface, map(u0, u1, x), map(v0, v1, y));
            let k = forms.curvatures().map_or(0.0, |k| k.0);
            sum += wx * wy * k * forms.determinant().max(0.0).sqrt();
        }
    }
    0.25 * (u1 - u0) * (v1 - v0) * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::geometry::{
        Point3,
        surface::{Ellipsoid, Paraboloid, Torus},
    };

    fn curvatures(surface: &impl Parametric, u: f64, v: f64) -> (f64, f64) {
        Forms::at(surface, u, v).curvatures().expect("regular")
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-10 * (1.0 + b.abs())
    }

    /// M13: closed forms of Gaussian and mean curvature: sphere, ellipsoid (K = 1/(abc Σ x²/a⁴)²), torus (do Carmo,
    /// §3.3, example 5), paraboloid and saddle (the graph's Hessian).
    #[test]
    fn curvatures_have_their_closed_forms() {
        let sphere = Ellipsoid::sphere(Point3::ORIGIN, 2.0).expect("a sphere");
        let ellipsoid = Ellipsoid::new(Point3::ORIGIN, glam::DVec3::new(1.0, 2.0, 3.0)).expect("an ellipsoid");
        let (radius, tube) = (3.0, 1.2);
        let torus = Torus::new(radius, tube).expect("a torus");
        for j in 1..12 {
            for i in 0..12 {
                let (u, v) = (0.5 * f64::from(i), 0.25 * f64::from(j));
                let (k, h) = curvatures(&sphere, u, v);
                assert!(close(k, 0.25) && close(h, -0.5));
                let p = ellipsoid.point(u, v).to_vector();
                let sum = p.x * p.x + p.y * p.y / 16.0 + p.z * p.z / 81.0;
                assert!(close(curvatures(&ellipsoid, u, v).0, (6.0 * sum).powi(-2)));
                let (k, h) = curvatures(&torus, u, v);
                let from_axis = radius + tube * v.cos();
                assert!(close(k, v.cos() / (tube * from_axis)));
                assert!(close(h, -(radius + 2.0 * tube * v.cos()) / (2.0 * tube * from_axis)));
            }
        }
        for (a, b) in [(0.5, 0.3), (0.5, -0.3), (1.0, 0.0)] {
            let surface = Paraboloid::new(Point3::ORIGIN, a, b, 2.0).expect("a paraboloid");
            for (x, y) in [(0.0, 0.0), (0.7, -1.1), (-2.0, 2.0)] {
                let (p, q) = (2.0 * a * x, 2.0 * b * y);
                let w = 1.0 + p * p + q * q;
                let (k, h) = curvatures(&surface, x, y);
                assert!(close(k, 4.0 * a * b / (w * w)));
                // The normal points down: the sign of the mean curvature is turned.
                assert!(close(h, -((1.0 + q * q) * a + (1.0 + p * p) * b) / w.powf(1.5)));
            }
        }
        assert!(Forms::at(&sphere, 0.0, 0.0).curvatures().is_none());
    }

    /// Gauss and Bonnet: 4π for what is like a sphere, 0 for a torus.
    #[test]
    fn the_total_curvature_counts_handles() {
        let ellipsoid = Ellipsoid::new(Point3::ORIGIN, glam::DVec3::new(1.0, 1.5, 2.0)).expect("an ellipsoid");
        assert!((total(&ellipsoid, 48) - 4.0 * std::f64::consts::PI).abs() < 1e-5);
        let torus = Torus::new(2.0, 0.8).expect("a torus");
        assert!(total(&torus, 48).abs() < 1e-9);
    }
}

//! Tests of the grid of directions, which need the statistics beside them.

pub use steradian_math::sphere_grid::{SphereGrid, integrate_sphere};

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use steradian_math::Vec3;

    fn direction(z: f64, phi: f64) -> Vec3 {
        let r = (1.0 - z * z).sqrt();
        Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32)
    }

    #[test]
    fn known_integrals() {
        assert!((integrate_sphere(|_| 1.0, 1e-6) - 4.0 * PI).abs() < 1e-6);
        assert!((integrate_sphere(|w| f64::from(w.z.max(0.0)), 1e-6) - PI).abs() < 1e-5);
        // A narrow lobe: (n + 1)/(2π) cosⁿ.
        let lobe = |w: Vec3| f64::from(w.dot(Vec3::new(0.6, 0.48, 0.64)).max(0.0)).powi(2000) * 2001.0 / (2.0 * PI);
        assert!((integrate_sphere(lobe, 1e-5) - 1.0).abs() < 1e-4);
    }

    /// Caps, whose edges cut small corners off cells.
    #[test]
    fn hard_edges_are_where_samples_find_them() {
        let grid = SphereGrid { bands: 20, sectors: 40 };
        let (samples, cos) = (100_000, 0.9);
        let mut rng = steradian_math::hash::HashRng::new(5);
        for k in 0..3 {
            let axis = direction(0.5 + 0.08 * f64::from(k), 0.3);
            let density = |w: Vec3| if f64::from(w.dot(axis)) > cos { 0.5 / PI / (1.0 - cos) } else { 0.0 };
            let (s, t) = axis.any_orthonormal_pair();
            let mut histogram = vec![0; grid.cells()];
            for _ in 0..samples {
                let w = direction(1.0 - (1.0 - cos) * f64::from(rng.next_f32()), 2.0 * PI * f64::from(rng.next_f32()));
                histogram[grid.cell(s * w.x + t * w.y + axis * w.z)] += 1;
            }
            let overlooks = |expected: &[f64]| histogram.iter().zip(expected).any(|(&seen, &e)| seen > 1 && e < 1e-6);
            let expected = grid.expected_counts(density, &histogram, samples);
            assert!(!overlooks(&expected));
            let chi2 = crate::chi2_test(&histogram, &expected, samples);
            assert!(chi2.p_value > crate::sidak(0.01, 3), "{chi2:?}");
        }
    }

    #[test]
    fn cells_have_equal_measure_and_hold_their_directions() {
        let grid = SphereGrid { bands: 6, sectors: 10 };
        let areas = grid.integrate(|_| 1.0, 1e-6);
        assert!(areas.iter().all(|a| (a - 4.0 * PI / 60.0).abs() < 1e-9));
        for i in 0..grid.cells() {
            let (z, phi) = (((i / 10) as f64 + 0.5) / 3.0 - 1.0, ((i % 10) as f64 + 0.5) * PI / 5.0);
            assert_eq!(grid.cell(direction(z, phi)), i);
        }
        assert!(grid.cell(Vec3::Z) < grid.cells() && grid.cell(-Vec3::Z) < grid.cells());
    }
}

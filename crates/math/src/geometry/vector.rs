//! Angles, determinants and projections of vectors.

use glam::DVec3;

/// Angle between two vectors in `[0, π]`, precise for nearly parallel ones (Kahan); 0 where one is zero.
pub fn angle_between(a: DVec3, b: DVec3) -> f64 {
    let (p, q) = (a * b.length(), b * a.length());
    2.0 * (p - q).length().atan2((p + q).length())
}

/// Signed length of the projection of `a` on the direction of `onto`: `|a| cos α`. `None` where `onto` is zero.
pub fn signed_projection(a: DVec3, onto: DVec3) -> Option<f64> {
    onto.try_normalize().map(|n| a.dot(n))
}

/// `a` as the sum of a part along `onto` and a part orthogonal to it. `None` where `onto` is zero.
pub fn decompose(a: DVec3, onto: DVec3) -> Option<(DVec3, DVec3)> {
    let n = onto.try_normalize()?;
    let along = n * a.dot(n);
    Some((along, a - along))
}

/// Signed volume `⟨a × b, c⟩` of the parallelepiped: positive for a right-handed triple.
pub fn determinant(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    a.cross(b).dot(c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    #[test]
    fn products_obey_their_identities() {
        let mut r = Random::new(3);
        for _ in 0..1000 {
            let (a, b, c) = (r.vector(), r.vector(), r.vector());
            let angle = angle_between(a, b);
            assert!((a.dot(b) - a.length() * b.length() * angle.cos()).abs() < 1e-14);
            assert!((a.cross(b).length() - a.length() * b.length() * angle.sin()).abs() < 1e-14);
            assert!(a.cross(b).dot(a).abs() < 1e-15 && (a.cross(b) + b.cross(a)).length() == 0.0);
            // Lagrange: |a×b|² + ⟨a,b⟩² = |a|²|b|².
            let lagrange = a.cross(b).length_squared() + a.dot(b).powi(2) - a.length_squared() * b.length_squared();
            assert!(lagrange.abs() < 1e-14);
            // The cross product by its determinant against the unit vectors.
            for e in [DVec3::X, DVec3::Y, DVec3::Z] {
                assert!((a.cross(b).dot(e) - determinant(a, b, e)).abs() < 1e-15);
            }
            assert!((determinant(a, b, c) - glam::DMat3::from_cols(a, b, c).determinant()).abs() < 1e-14);
            let (along, across) = decompose(a, b).expect("a direction");
            assert!((along + across - a).length() < 1e-15 && across.dot(b).abs() < 1e-15);
            let signed = signed_projection(a, b).expect("a direction");
            assert!((signed.abs() - along.length()).abs() < 1e-15 && (signed > 0.0) == (a.dot(b) > 0.0));
        }
    }

    #[test]
    fn small_angles_and_zero_vectors() {
        let tilted = DVec3::new(1.0, 1e-12, 0.0);
        assert!((angle_between(DVec3::X, tilted) / 1e-12 - 1.0).abs() < 1e-6);
        assert!((angle_between(DVec3::X, -DVec3::X * 9.0) - std::f64::consts::PI).abs() < 1e-15);
        assert_eq!(angle_between(DVec3::ZERO, DVec3::X), 0.0);
        assert_eq!(signed_projection(DVec3::X, DVec3::ZERO), None);
        assert_eq!(decompose(DVec3::X, DVec3::ZERO), None);
    }
}

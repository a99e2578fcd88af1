//! Handedness and up-axis conversions.
//!
//! Swapping two coordinates turns a right-handed system into a left-handed one. The up-axis maps here are rotations,
//! which keep the handedness, and the change of handedness is a separate, explicit mirror.

use glam::{DMat3, DVec3};

/// Which way a coordinate system turns from its first axis over the second to the third.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handedness {
    /// `x × y = z`.
    Right,
    /// `x × y = −z`.
    Left,
}

/// The handedness of a basis; `None` where the vectors do not span space.
pub fn handedness(x: DVec3, y: DVec3, z: DVec3) -> Option<Handedness> {
    let det = super::vector::determinant(x, y, z);
    if det > 0.0 {
        Some(Handedness::Right)
    } else if det < 0.0 {
        Some(Handedness::Left)
    } else {
        None
    }
}

/// Coordinates in a y-up system of what has coordinates in a z-up one: the quarter turn about x,
/// `(x, y, z) → (x, z, −y)`.
pub const Y_UP_FROM_Z_UP: DMat3 = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0]);

/// The inverse of [`Y_UP_FROM_Z_UP`]: `(x, y, z) → (x, −z, y)`.
pub const Z_UP_FROM_Y_UP: DMat3 = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0]);

/// The other proper conversion from z-up to y-up: the axes in turn, `(x, y, z) → (y, z, x)`.
pub const CYCLE: DMat3 = DMat3::from_cols_array(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);

/// Between right-handed and left-handed coordinates with the same x and y: `z → −z`. Its own inverse; it also turns
/// round the winding of every triangle.
pub const MIRROR_Z: DMat3 = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0]);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    #[test]
    fn conversions_are_proper_and_come_back() {
        assert_eq!(Y_UP_FROM_Z_UP * DVec3::Z, DVec3::Y);
        assert_eq!(Z_UP_FROM_Y_UP * DVec3::Y, DVec3::Z);
        assert_eq!(CYCLE * DVec3::Z, DVec3::Y);
        assert_eq!(CYCLE * DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 3.0, 1.0));
        for m in [Y_UP_FROM_Z_UP, Z_UP_FROM_Y_UP, CYCLE] {
            assert_eq!(m.determinant(), 1.0);
        }
        assert_eq!(MIRROR_Z.determinant(), -1.0);
        let mut r = Random::new(4);
        for _ in 0..100 {
            let (a, b, c) = (r.vector(), r.vector(), r.vector());
            assert_eq!(Z_UP_FROM_Y_UP * (Y_UP_FROM_Z_UP * a), a);
            assert_eq!(CYCLE * (CYCLE * (CYCLE * a)), a);
            assert_eq!(MIRROR_Z * (MIRROR_Z * a), a);
            let h = handedness(a, b, c);
            assert_eq!(handedness(CYCLE * a, CYCLE * b, CYCLE * c), h);
            assert_eq!(handedness(Y_UP_FROM_Z_UP * a, Y_UP_FROM_Z_UP * b, Y_UP_FROM_Z_UP * c), h);
            assert_ne!(handedness(MIRROR_Z * a, MIRROR_Z * b, MIRROR_Z * c), h);
        }
        assert_eq!(handedness(DVec3::X, DVec3::Y, DVec3::Z), Some(Handedness::Right));
        assert_eq!(handedness(DVec3::X, DVec3::Y, DVec3::X), None);
    }
}

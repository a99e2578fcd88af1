//! Orthonormal frames; `z` is the normal of shading frames.

use crate::Vec3;

/// A right-handed orthonormal basis.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// First tangent.
    pub x: Vec3,
    /// Second tangent.
    pub y: Vec3,
    /// Normal.
    pub z: Vec3,
}

impl Frame {
    /// The axes.
    pub const IDENTITY: Self = Self { x: Vec3::X, y: Vec3::Y, z: Vec3::Z };

    /// A frame around a unit vector, without branches on its direction (Duff et al. 2017).
    #[inline(always)]
    pub fn from_z(z: Vec3) -> Self {
        // Not by the sign bit: frames of 0 and −0 are one.
        let sign = if z.z < 0.0 { -1.0_f32 } else { 1.0 };
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: Vec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// A frame whose `z` is the unit vector `z` and whose `x` is the part of `x` orthogonal to it; any frame around `z`
    /// where there is none.
    pub fn from_zx(z: Vec3, x: Vec3) -> Self {
        let t = x - z * z.dot(x);
        let len2 = t.length_squared();
        if len2 > 1e-12 * x.length_squared() && len2.is_finite() && len2 > 0.0 {
            let x = t / len2.sqrt();
            Self { x, y: z.cross(x), z }
        } else {
            Self::from_z(z)
        }
    }

    /// Coordinates of `v` in this frame.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// The vector with local coordinates `v`.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_do_not_depend_on_signs_of_zero() {
        for z in [Vec3::X, Vec3::Y, Vec3::new(0.6, 0.8, 0.0)] {
            let [a, b] = [0.0, -0.0].map(|zero| Frame::from_z(Vec3::new(z.x, z.y, zero)));
            assert_eq!((a.x, a.y), (b.x, b.y));
        }
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for z in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, -0.8), Vec3::new(1.0, -2.0, 0.5).normalize()] {
            for f in [Frame::from_z(z), Frame::from_zx(z, Vec3::new(0.3, 0.9, -0.2)), Frame::from_zx(z, z)] {
                assert!((f.x.cross(f.y) - f.z).length() < 1e-6);
                assert!(f.x.dot(f.y).abs() < 1e-6 && (f.x.length() - 1.0).abs() < 1e-6);
                let v = Vec3::new(0.1, 2.0, -3.0);
                assert!((f.to_world(f.to_local(v)) - v).length() < 1e-5);
            }
        }
    }
}

//! Rotations by angles.
//!
//! **Yaw, pitch, roll.** The world is y-up: yaw turns about y, pitch about x, roll about z, each right-handed, and the
//! roll is applied first: `R = R_Y(yaw) · R_X(pitch) · R_Z(roll)`. (The lectures name these axes but print the product
//! `R_Z · R_Y · R_X`, with the sign of the middle angle reversed, E23; that product is [`Transform::rotate_zyx`], with
//! every factor right-handed.)

use super::Transform;
use glam::{DMat3, DQuat, DVec3};

impl Transform {
    /// Rotation about x by an angle in radians: y goes to z.
    pub fn rotate_x(angle: f64) -> Self {
        Self::rotate(DVec3::X, angle)
    }

    /// Rotation about y by an angle in radians: z goes to x.
    pub fn rotate_y(angle: f64) -> Self {
        Self::rotate(DVec3::Y, angle)
    }

    /// Rotation about z by an angle in radians: x goes to y.
    pub fn rotate_z(angle: f64) -> Self {
        Self::rotate(DVec3::Z, angle)
    }

    /// `R_Y(yaw) · R_X(pitch) · R_Z(roll)`, angles in radians.
    pub fn yaw_pitch_roll(yaw: f64, pitch: f64, roll: f64) -> Self {
        Self::rotate_y(yaw) * Self::rotate_x(pitch) * Self::rotate_z(roll)
    }

    /// The angles of [`Transform::yaw_pitch_roll`] in radians: yaw and roll in `(−π, π]`, pitch in `[−π/2, π/2]`. In
    /// gimbal lock (pitch ±π/2), where only the sum or the difference of the two others is determined, the roll is 0.
    /// `None` where the linear part is not a rotation.
    pub fn to_yaw_pitch_roll(&self) -> Option<[f64; 3]> {
        let r = self.rotation_part()?;
        let (sin_roll, cos_roll) = (r.x_axis.y, r.y_axis.y);
        let cos_pitch = sin_roll.hypot(cos_roll);
        let pitch = (-r.z_axis.y).atan2(cos_pitch);
        Some(if cos_pitch > 1e-9 {
            [r.z_axis.x.atan2(r.z_axis.z), pitch, sin_roll.atan2(cos_roll)]
        } else {
            [(-r.x_axis.z).atan2(r.x_axis.x), pitch, 0.0]
        })
    }

    /// `R_Z(alpha) · R_Y(beta) · R_X(gamma)`, angles in radians.
    pub fn rotate_zyx(alpha: f64, beta: f64, gamma: f64) -> Self {
        Self::rotate_z(alpha) * Self::rotate_y(beta) * Self::rotate_x(gamma)
    }

    /// The unit axis and the angle in `[0, π]` of [`Transform::rotate`]; the x axis and 0 for the identity. `None`
    /// where the linear part is not a rotation.
    pub fn to_axis_angle(&self) -> Option<(DVec3, f64)> {
        let q = DQuat::from_mat3(&self.rotation_part()?);
        let q = if q.w < 0.0 { -q } else { q };
        let (axis, w) = (q.xyz(), q.w);
        let angle = 2.0 * axis.length().atan2(w);
        Some(axis.try_normalize().map_or((DVec3::X, 0.0), |a| (a, angle)))
    }

    /// The linear part where its columns are orthonormal and right-handed, to 1e-9.
    fn rotation_part(&self) -> Option<DMat3> {
        let r = DMat3::from_mat4(self.matrix);
        let is_rotation = (r.transpose() * r).abs_diff_eq(DMat3::IDENTITY, 1e-9) && r.determinant() > 0.0;
        is_rotation.then_some(r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn same(a: Transform, b: Transform, tolerance: f64) -> bool {
        a.matrix.abs_diff_eq(b.matrix, tolerance)
    }

    #[test]
    fn axis_rotations_are_right_handed_and_add_up() {
        type Rotation = fn(f64) -> Transform;
        let rotations: [(Rotation, DVec3, DVec3); 3] = [
            (Transform::rotate_x, DVec3::Y, DVec3::Z),
            (Transform::rotate_y, DVec3::Z, DVec3::X),
            (Transform::rotate_z, DVec3::X, DVec3::Y),
        ];
        let mut r = Random::new(20);
        for (rotation, from, to) in rotations {
            assert!((rotation(FRAC_PI_2).vector(from) - to).length() < 1e-15);
            for _ in 0..50 {
                let (a, b) = (r.number() * 9.0, r.number() * 9.0);
                assert!(same(rotation(a) * rotation(b), rotation(a + b), 1e-14));
                assert!((rotation(a).matrix.determinant() - 1.0).abs() < 1e-14);
                assert!(same(rotation(a).inverse().expect("regular"), rotation(-a), 1e-14));
            }
        }
    }

    #[test]
    fn yaw_pitch_roll_round_trips() {
        let mut r = Random::new(21);
        for _ in 0..1000 {
            let angles = [r.number() * PI, r.number() * 1.57, r.number() * PI];
            let m = Transform::yaw_pitch_roll(angles[0], angles[1], angles[2]);
            let back = m.to_yaw_pitch_roll().expect("a rotation");
            assert!((0..3).all(|i| (back[i] - angles[i]).abs() < 1e-9), "{angles:?} {back:?}");
        }
        // The convention: yaw turns the view −z to −x; pitch lifts it to +y; roll leaves it.
        let view = -DVec3::Z;
        assert!((Transform::yaw_pitch_roll(FRAC_PI_2, 0.0, 0.0).vector(view) + DVec3::X).length() < 1e-15);
        assert!((Transform::yaw_pitch_roll(0.0, FRAC_PI_2, 0.0).vector(view) - DVec3::Y).length() < 1e-15);
        assert!((Transform::yaw_pitch_roll(0.0, 0.0, 1.0).vector(view) - view).length() < 1e-15);
    }

    #[test]
    fn gimbal_lock_keeps_the_rotation() {
        for pitch in [FRAC_PI_2, -FRAC_PI_2] {
            for (yaw, roll) in [(0.4, 0.0), (1.0, 2.0), (-3.0, 0.7)] {
                let m = Transform::yaw_pitch_roll(yaw, pitch, roll);
                let [y, p, r] = m.to_yaw_pitch_roll().expect("a rotation");
                assert_eq!(r, 0.0);
                assert!((p - pitch).abs() < 1e-7);
                assert!(same(Transform::yaw_pitch_roll(y, p, r), m, 1e-9));
            }
        }
    }

    #[test]
    fn the_printed_matrix_has_its_middle_angle_reversed() {
        // The product Z·Y·X with right-handed factors, against entries worked out by hand: −sin β is in the last row.
        let (a, b, c) = (0.3, 0.5, 0.7);
        let m = Transform::rotate_zyx(a, b, c).matrix;
        assert!((m.x_axis.z + b.sin()).abs() < 1e-15 && (m.x_axis.x - a.cos() * b.cos()).abs() < 1e-15);
        assert!((m.y_axis.z - b.cos() * c.sin()).abs() < 1e-15);
    }

    #[test]
    fn axis_and_angle_both_ways() {
        let mut r = Random::new(22);
        for i in 0..1000 {
            let axis = r.direction();
            let angle = match i % 10 {
                0 => 1e-7,
                1 => PI - 1e-7,
                _ => (r.number() + 1.0) * 0.5 * PI,
            };
            let m = Transform::rotate(axis * 3.0, angle);
            // Rodrigues' formula.
            let v = r.vector();
            let (sin, cos) = angle.sin_cos();
            let rodrigues = v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
            assert!((m.vector(v) - rodrigues).length() < 1e-14);
            let (a, t) = m.to_axis_angle().expect("a rotation");
            assert!((t - angle).abs() < 1e-8 && same(Transform::rotate(a, t), m, 1e-9));
            assert!(angle < 1e-6 || (a - axis).length() < 1e-6);
        }
        assert_eq!(Transform::IDENTITY.to_axis_angle(), Some((DVec3::X, 0.0)));
        let (a, t) = Transform::rotate_y(PI).to_axis_angle().expect("a rotation");
        assert!((a.abs() - DVec3::Y).length() < 1e-12 && (t - PI).abs() < 1e-12);
        for m in [Transform::scale(DVec3::splat(2.0)), Transform::scale(DVec3::new(1.0, 1.0, -1.0))] {
            assert_eq!(m.to_axis_angle(), None);
            assert_eq!(m.to_yaw_pitch_roll(), None);
        }
    }
}

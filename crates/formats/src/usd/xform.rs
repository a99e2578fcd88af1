//! Transforms of prims: UsdGeomXformable.

use super::{Reader, stage::Prim};
use glam::DQuat;
use steradian_math::{DMat4, DVec3};

impl Reader<'_> {
    /// The local transform of a prim, and whether that of its parents does not count.
    pub(super) fn local(&mut self, prim: &Prim) -> (DMat4, bool) {
        let order = self.stage.value(prim, "xformOpOrder");
        let order = order.as_ref().map(|v| v.texts().to_vec()).unwrap_or_default();
        let (mut matrix, mut resets) = (DMat4::IDENTITY, false);
        for name in order {
            if name == "!resetXformStack!" {
                (matrix, resets) = (DMat4::IDENTITY, true);
                continue;
            }
            let (name, inverts) = match name.strip_prefix("!invert!") {
                Some(name) => (name.to_owned(), true),
                None => (name, false),
            };
            let operation = self.operation(prim, &name);
            match inverts {
                false => matrix *= operation,
                true if operation.determinant().abs() > 1e-300 => matrix *= operation.inverse(),
                true => self.fault(prim, &name, "this transform has no inverse".into()),
            }
        }
        (matrix, resets)
    }

    fn operation(&mut self, prim: &Prim, name: &str) -> DMat4 {
        let kind = name.strip_prefix("xformOp:").unwrap_or_default().split(':').next().unwrap_or_default();
        let vector = |reader: &mut Self, default: f64| DVec3::from(reader.tuple(prim, name, [default; 3]));
        let axis = |letter: char| match letter {
            'X' => DVec3::X,
            'Y' => DVec3::Y,
            _ => DVec3::Z,
        };
        let letter = kind.chars().last().unwrap_or('X');
        match kind {
            "translate" => DMat4::from_translation(vector(self, 0.0)),
            "scale" => DMat4::from_scale(vector(self, 1.0)),
            "translateX" | "translateY" | "translateZ" => {
                DMat4::from_translation(axis(letter) * self.number(prim, name, 0.0, (f64::MIN, f64::MAX)))
            }
            "scaleX" | "scaleY" | "scaleZ" => {
                let factor = self.number(prim, name, 1.0, (f64::MIN, f64::MAX));
                DMat4::from_scale(DVec3::ONE + axis(letter) * (factor - 1.0))
            }
            "rotateX" | "rotateY" | "rotateZ" => {
                let angle = self.number(prim, name, 0.0, (f64::MIN, f64::MAX));
                DMat4::from_axis_angle(axis(letter), angle.to_radians())
            }
            "rotateXYZ" | "rotateXZY" | "rotateYXZ" | "rotateYZX" | "rotateZXY" | "rotateZYX" => {
                let angles = vector(self, 0.0);
                // The first letter's rotation is done first.
                kind.chars().skip("rotate".len()).fold(DMat4::IDENTITY, |matrix, letter| {
                    DMat4::from_axis_angle(axis(letter), angles.dot(axis(letter)).to_radians()) * matrix
                })
            }
            "orient" => {
                let [w, x, y, z] = self.tuple(prim, name, [1.0, 0.0, 0.0, 0.0]);
                DMat4::from_quat(unit(DQuat::from_xyzw(x, y, z, w)))
            }
            "transform" => DMat4::from_cols_array(&self.tuple(prim, name, DMat4::IDENTITY.to_cols_array())),
            _ => {
                self.fault(prim, "xformOpOrder", format!("'{name}' is not a known operation"));
                DMat4::IDENTITY
            }
        }
    }
}

/// A rotation of any quaternion but zero.
pub(super) fn unit(q: DQuat) -> DQuat {
    if q.length_squared() > 1e-24 && q.is_finite() { q.normalize() } else { DQuat::IDENTITY }
}

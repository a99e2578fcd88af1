//! Bounds of an object, and of its placed instances.

use crate::Instance;
use glam::Vec3A;
use steradian_math::{Bounds3, Motion, Vec3, transform::Affine};

/// Boxes that contain an object.
pub(crate) struct Outline {
    /// Their centres and half their lengths.
    boxes: Vec<[Vec3A; 2]>,
    /// The greatest coordinates of their corners, without signs.
    reach: Vec3,
}

impl Outline {
    /// The outline of an object in some boxes, none of which is empty.
    pub fn new(boxes: &[Bounds3]) -> Self {
        let halves = |b: &Bounds3| [b.center().into(), (b.max * 0.5 - b.min * 0.5).into()];
        Self {
            boxes: boxes.iter().map(halves).collect(),
            reach: boxes.iter().fold(Vec3::ZERO, |reach, b| reach.max(greatest(b))),
        }
    }

    /// A box in world space that contains the object where it is placed, and every point where a ray that was
    /// transformed to its space may hit it.
    pub fn placed(&self, world_from_object: &Affine) -> Bounds3 {
        let Affine { m, inv } = world_from_object;
        if !m.is_finite() || !inv.is_finite() {
            return Bounds3::EMPTY;
        }
        let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|axis| Vec3A::from_vec4(axis).abs());
        let (mut min, mut max) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for &[center, half] in &self.boxes {
            let center = m.transform_point3a(center);
            let reach = x * half.x + y * half.y + z * half.z;
            // In this order what is not a number, where all is too large, changes nothing.
            (min, max) = ((center - reach).min(min), (center + reach).max(max));
        }
        let bounds = Bounds3 { min: min.into(), max: max.into() };
        // Rounding: of the numbers above, and of the ray on its way to object space, seen from the world.
        let error = world_from_object.inverse().point_error(greatest(&bounds), Vec3::ZERO);
        let error = world_from_object.point_error(self.reach, error) * 2.0;
        Bounds3 { min: bounds.min - error, max: bounds.max + error }
    }

    /// [`Self::placed`] where an instance is, at all moments from zero to one.
    pub fn of(&self, instance: &Instance) -> Bounds3 {
        instance.motion.as_ref().map_or_else(|| self.placed(&instance.world_from_object), |motion| self.moved(motion))
    }

    fn moved(&self, motion: &Motion) -> Bounds3 {
        let (times, beyond) = motion.steps(self.reach.length());
        let places = times.iter().filter_map(|time| motion.at(*time));
        let bounds = places.fold(Bounds3::EMPTY, |bounds, place| bounds.union(self.placed(&place)));
        // Also of the numbers that this one is made of.
        let beyond = Vec3::splat(beyond * 1.001);
        Bounds3 { min: bounds.min - beyond, max: bounds.max + beyond }
    }
}

/// The greatest coordinates of the corners of a box, without signs.
fn greatest(b: &Bounds3) -> Vec3 {
    b.min.abs().max(b.max.abs())
}

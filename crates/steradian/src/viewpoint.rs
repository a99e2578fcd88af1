//! Viewpoints of cameras, and placing cameras there.

use steradian_math::{DVec3, Transform};
use steradian_scene::{NodeId, SceneDesc, Value};

/// Viewpoint of a camera: its position, its target, and the direction that is up, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// The eye.
    pub eye: DVec3,
    /// A point in the middle of the picture.
    pub target: DVec3,
    /// A direction that the picture shows upwards; of any length, not along the view.
    pub up: DVec3,
}

impl Viewpoint {
    /// Viewpoint of a camera in the place `world_from_camera`, with the target at a distance; `None` where the place is
    /// singular.
    pub fn of(world_from_camera: &Transform, distance: f64) -> Option<Self> {
        let column = |axis: DVec3| world_from_camera.vector(axis);
        let eye = world_from_camera.point(DVec3::ZERO);
        let (forward, up) = (column(DVec3::Z).try_normalize()?, column(DVec3::Y).try_normalize()?);
        let view = Self { eye, target: eye + forward * distance, up };
        view.transform().map(|_| view)
    }

    /// True if the eye is apart from the target, and `up` not along the view, as numbers allow.
    pub fn is_sound(&self) -> bool {
        self.transform().is_some_and(|t| t.is_finite())
    }

    /// Camera-to-world of a camera without scale or mirroring.
    fn transform(&self) -> Option<Transform> {
        Transform::look_at(self.eye, self.target, self.up)
    }

    /// A camera of the place `from`, moved here: it keeps its scale, and mirrors as before. `None` where either place
    /// is singular.
    pub fn moved(&self, from: &Transform) -> Option<Transform> {
        let own = Self::of(from, 1.0)?.transform()?.inverse()? * *from;
        Some(self.transform()? * own)
    }

    /// Moves a camera of a description here, where it then stands still. `false`, and nothing is changed, where a place
    /// is singular.
    pub fn place(&self, desc: &mut SceneDesc, camera: NodeId) -> bool {
        let from = match desc.node(camera).get("to_world") {
            Some(Value::Transform(place)) => *place,
            _ => Transform::IDENTITY,
        };
        let Some(place) = self.moved(&from) else { return false };
        let node = desc.node_mut(camera);
        node.params.retain(|p| !matches!(p.name.as_str(), "to_world_end" | "motion_times"));
        node.set("to_world", Value::Transform(place), None);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera that mirrors, as pbrt's converters write them, mirrors still.
    #[test]
    fn moved_cameras_keep_their_handedness_and_scale() {
        let mirror = Transform::scale(DVec3::new(-2.0, 2.0, 2.0));
        let look = Transform::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, DVec3::Y).unwrap();
        let from = look * mirror;
        let own = Viewpoint::of(&from, 1.0).unwrap();
        let same = own.moved(&from).unwrap();
        for (axis, apart) in [(DVec3::X, 1e-12), (DVec3::Y, 1e-12), (DVec3::Z, 1e-12)] {
            assert!((same.vector(axis) - from.vector(axis)).length() < apart);
        }
        let there = Viewpoint { eye: DVec3::new(0.0, 0.0, 5.0), target: DVec3::ZERO, up: DVec3::Y };
        let moved = there.moved(&from).unwrap();
        assert!(moved.swaps_handedness() == from.swaps_handedness());
        // Looking along -z with y up, what is at the right of an unmirrored camera is -x: up × forward.
        assert!((moved.vector(DVec3::X) - DVec3::new(2.0, 0.0, 0.0)).length() < 1e-12);
        assert!((moved.vector(DVec3::Z) - DVec3::new(0.0, 0.0, -2.0)).length() < 1e-12);
        assert!((moved.point(DVec3::ZERO) - there.eye).length() < 1e-12);
    }

    #[test]
    fn places_from_which_nothing_is_seen_are_refused() {
        let along = Viewpoint { eye: DVec3::ZERO, target: DVec3::Z, up: DVec3::Z };
        let nowhere = Viewpoint { target: DVec3::ZERO, ..along };
        let endless = Viewpoint { eye: DVec3::splat(f64::INFINITY), ..along };
        for view in [along, nowhere, endless] {
            assert!(!view.is_sound(), "{view:?}");
            assert!(view.moved(&Transform::IDENTITY).is_none(), "{view:?}");
        }
        assert!(Viewpoint::of(&Transform::scale(DVec3::new(1.0, 0.0, 1.0)), 1.0).is_none());
    }
}

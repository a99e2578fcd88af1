//! Cameras.

use super::node::Draft;
use crate::{Family, Transform, node::Value};
use steradian_math::DVec3;

/// A camera.
#[derive(Clone, Debug)]
pub struct Camera {
    pub(super) draft: Draft,
    eye: [f64; 3],
    target: [f64; 3],
}

impl Camera {
    /// A pinhole camera at a point that looks at another, with +y up and 45° across the shorter side of the picture.
    pub fn look_at(eye: [f64; 3], target: [f64; 3]) -> Self {
        let draft = Draft::new(Family::Camera, "perspective").with("fov", 45.0);
        Self { draft: draft.with("to_world", frame(eye, target, [0.0, 1.0, 0.0])), eye, target }
    }

    /// The direction that is up in the picture. One along the view is replaced by another axis.
    #[must_use]
    pub fn up(mut self, up: [f64; 3]) -> Self {
        self.draft.set("to_world", frame(self.eye, self.target, up));
        self
    }

    /// The angle of view across the shorter side of the picture, in degrees between 0 and 180.
    #[must_use]
    pub fn fov(mut self, degrees: f64) -> Self {
        self.draft.set("fov", degrees);
        self
    }

    /// A lens of that radius, sharp at that distance.
    #[must_use]
    pub fn lens(mut self, radius: f64, focal_distance: f64) -> Self {
        self.draft.set("lens_radius", radius);
        self.draft.set("focal_distance", focal_distance);
        self
    }

    /// Parallel rays; the shorter side of the picture spans that much of the scene.
    #[must_use]
    pub fn orthographic(mut self, extent: f64) -> Self {
        self.draft.kind = "orthographic";
        self.draft.parts.retain(|p| p.0 != "fov");
        let size = Transform::scale(DVec3::new(0.5 * extent, 0.5 * extent, 1.0));
        let place = match self.draft.parts.iter().find(|p| p.0 == "to_world") {
            Some((_, super::node::Part::Value(Value::Transform(t)))) => *t,
            _ => Transform::IDENTITY,
        };
        self.draft.set("to_world", place * size);
        self
    }

    /// The name by which it is chosen.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.draft.name = Some(name.into());
        self
    }
}

/// A frame at `from` whose z leads to `to`; where `up` is along it, another axis is up, and where both points are one,
/// it leads along +z.
pub(super) fn frame(from: [f64; 3], to: [f64; 3], up: [f64; 3]) -> Transform {
    let (from, to) = (DVec3::from(from), DVec3::from(to));
    let to = if (to - from).try_normalize().is_some() { to } else { from + DVec3::Z };
    [DVec3::from(up), DVec3::Y, DVec3::Z, DVec3::X]
        .into_iter()
        .find_map(|up| Transform::look_at(from, to, up))
        .unwrap_or(Transform::translate(from))
}

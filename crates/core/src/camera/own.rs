//! Projections of a program's own.

use super::Camera;
use std::fmt::Debug;
use steradian_math::{Ray, Vec2, Vec3};

/// A projection of a program's own: from a place on the film to a ray in camera space, x to the right, y up, z forward.
/// Which place sees a point is not known of it: textures are taken at points, methods that connect light to the camera
/// leave it out.
pub trait OwnCamera: Debug + Send + Sync {
    /// Origin and direction, of any length, of the ray through a place of the frame in the unit square (x to the right,
    /// y down) and a point of the lens, in the unit square, too. Where the direction is zero or not finite, light comes
    /// along the axis.
    fn ray(&self, film: Vec2, lens: Vec2) -> (Vec3, Vec3);
}

impl Camera {
    /// The ray of a projection of a program's own, in the world, between near and far plane.
    pub(super) fn own_ray(&self, own: &dyn OwnCamera, film: Vec2, lens: Vec2) -> Ray {
        let (origin, direction) = sound(own.ray(film, lens));
        let ahead = if self.near > 0.0 && direction.z > 0.0 { self.near / direction.z } else { 0.0 };
        let d = self.world_from_camera.vector(direction).normalize();
        Ray { t_max: self.view().end(d), ..Ray::new(self.world_from_camera.point(origin + direction * ahead), d) }
    }
}

/// A ray that is none is one along the axis.
fn sound((origin, direction): (Vec3, Vec3)) -> (Vec3, Vec3) {
    let origin = if origin.is_finite() { origin } else { Vec3::ZERO };
    (origin, direction.try_normalize().unwrap_or(Vec3::Z))
}

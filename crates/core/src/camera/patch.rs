//! Surfaces that receive light: cameras whose picture is the irradiance over a patch.

use super::Camera;
use std::f32::consts::TAU;
use steradian_math::{Frame, Ray, Vec2, Vec3, warp};

/// A surface in camera space, over whose area the film is spread evenly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patch {
    /// The square from −1 to 1 along x and y, facing +z.
    Square,
    /// The disc of radius 1 about the origin, facing +z.
    Disk,
    /// The sphere of radius 1 about the origin, facing outwards.
    Sphere,
    /// The cylinder of radius 1 about the z axis from 0 to 1, without its ends, facing outwards.
    Cylinder,
}

impl Patch {
    /// By name.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "square" => Self::Square,
            "disk" => Self::Disk,
            "sphere" => Self::Sphere,
            "cylinder" => Self::Cylinder,
            _ => return None,
        })
    }

    /// The point of a place in the unit square, and its normal.
    fn at(self, s: Vec2) -> (Vec3, Vec3) {
        match self {
            Self::Square => ((s * 2.0 - 1.0).extend(0.0), Vec3::Z),
            // Area-preserving maps from the square to each surface.
            Self::Disk => (warp::concentric_disk(s).extend(0.0), Vec3::Z),
            Self::Sphere => {
                let p = warp::uniform_sphere(s);
                (p, p)
            }
            Self::Cylinder => {
                let (sin, cos) = (TAU * s.x).sin_cos();
                (Vec3::new(cos, sin, s.y), Vec3::new(cos, sin, 0.0))
            }
        }
    }
}

impl Camera {
    /// The ray that leaves a patch at a place of the frame (in the unit square), in proportion to the cosine with the
    /// normal.
    pub(super) fn ray_of_patch(&self, patch: Patch, is_inward: bool, s: Vec2, u: Vec2) -> Ray {
        let (p, n) = patch.at(s);
        let place = &self.world_from_camera;
        // Normals transform by the inverse transpose.
        let normal = place.inv.transpose().transform_vector3(if is_inward { -n } else { n }).normalize();
        let p = place.point(p);
        // Off the surface, which may be part of the scene.
        let step = 1e-5 * place.vector(Vec3::X).length() + 1e-6 * p.abs().max_element();
        Ray::new(p + normal * step, Frame::from_z(normal).to_world(warp::cosine_hemisphere(u)))
    }
}

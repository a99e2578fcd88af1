//! From a surface point to texture coordinates.

use super::TextureContext;
use steradian_math::{Vec2, Vec3, transform::Affine};

/// A texture mapping.
#[derive(Clone, Debug)]
pub struct Mapping {
    /// What is mapped.
    pub projector: Projector,
    /// Factor on (u, v).
    pub scale: Vec2,
    /// Added to (u, v).
    pub delta: Vec2,
    /// A further affine map of (u, v): columns a, b and offset.
    pub matrix: [Vec2; 3],
}

/// How a point becomes a pair of coordinates.
#[derive(Clone, Copy, Debug)]
pub enum Projector {
    /// The surface's own parameters.
    Uv,
    /// Polar angle over π and azimuth over 2π around the texture's z axis (pbrt's spherical mapping).
    Spherical(Affine),
    /// Azimuth over 2π and height along z.
    Cylindrical(Affine),
    /// Distances along two axes.
    Planar(Affine, Vec3, Vec3),
}

impl Default for Mapping {
    fn default() -> Self {
        Self { projector: Projector::Uv, scale: Vec2::ONE, delta: Vec2::ZERO, matrix: [Vec2::X, Vec2::Y, Vec2::ZERO] }
    }
}

impl Mapping {
    /// Texture coordinates of a surface point.
    #[inline]
    pub fn uv(&self, at: &TextureContext) -> Vec2 {
        use std::f32::consts::{PI, TAU};
        // The lectures' azimuth lies in [0, 2π); atan2 gives (−π, π].
        let azimuth = |v: Vec3| {
            let phi = v.y.atan2(v.x);
            if phi < 0.0 { phi + TAU } else { phi }
        };
        let uv = match &self.projector {
            Projector::Uv => at.uv,
            Projector::Spherical(local) => {
                let v = local.point(at.p).normalize_or(Vec3::Z);
                Vec2::new(v.z.clamp(-1.0, 1.0).acos() / PI, azimuth(v) / TAU)
            }
            Projector::Cylindrical(local) => {
                let v = local.point(at.p);
                Vec2::new(azimuth(v) / TAU, v.z)
            }
            Projector::Planar(local, v1, v2) => {
                let v = local.point(at.p);
                Vec2::new(v.dot(*v1), v.dot(*v2))
            }
        };
        let uv = uv * self.scale + self.delta;
        self.matrix[0] * uv.x + self.matrix[1] * uv.y + self.matrix[2]
    }

    /// Solid texture coordinates of a world point.
    pub fn solid(&self, p: Vec3) -> Vec3 {
        match &self.projector {
            Projector::Uv => p,
            Projector::Spherical(local) | Projector::Cylindrical(local) | Projector::Planar(local, ..) => {
                local.point(p)
            }
        }
    }
}

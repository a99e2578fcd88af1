//! From a surface point to texture coordinates: a projector, then an affine corresponder (M205 to M207). Derivatives go
//! along, so that filters know what a pixel covers; where a projector has a seam they are taken on one side of it.

pub mod projector;
pub mod two_part;

use super::TextureContext;
pub use projector::Projector;
use steradian_math::{Vec2, Vec3, transform::Affine};
pub use two_part::{Intermediary, ObjectMap};

/// A texture mapping.
#[derive(Clone, Debug)]
pub struct Mapping {
    /// Projector from points to coordinates.
    pub projector: Projector,
    /// From the world to the space of projectors and solid textures.
    pub local: Affine,
    /// Factor on (u, v).
    pub scale: Vec2,
    /// Added to (u, v).
    pub delta: Vec2,
    /// A further affine map of (u, v): columns a, b and offset.
    pub matrix: [Vec2; 3],
}

/// A pair of texture coordinates with its derivatives by the pixel's x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coordinates2 {
    /// The coordinates.
    pub uv: Vec2,
    /// By x.
    pub dx: Vec2,
    /// By y.
    pub dy: Vec2,
}

impl Coordinates2 {
    /// The larger of the two derivatives of each coordinate, in magnitude.
    pub fn width(&self) -> Vec2 {
        self.dx.abs().max(self.dy.abs())
    }
}

/// A point of texture space with its derivatives by the pixel's x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coordinates3 {
    /// The point.
    pub p: Vec3,
    /// By x.
    pub dx: Vec3,
    /// By y.
    pub dy: Vec3,
}

impl Coordinates3 {
    /// The larger of the two derivatives of each coordinate, in magnitude.
    pub fn width(&self) -> Vec3 {
        self.dx.abs().max(self.dy.abs())
    }

    /// Both with the unit of length divided by `k`.
    #[must_use]
    pub fn scaled(&self, k: f32) -> Self {
        Self { p: self.p * k, dx: self.dx * k, dy: self.dy * k }
    }
}

impl Default for Mapping {
    fn default() -> Self {
        Self {
            projector: Projector::Uv,
            local: Affine::IDENTITY,
            scale: Vec2::ONE,
            delta: Vec2::ZERO,
            matrix: [Vec2::X, Vec2::Y, Vec2::ZERO],
        }
    }
}

impl Mapping {
    /// The matrix of glTF's `KHR_texture_transform`: scale, then rotation, then offset. Angles turn from +u to −v,
    /// which is counter-clockwise where v points down, as the reference viewer has it.
    pub fn khr_texture_transform(offset: Vec2, rotation: f32, scale: Vec2) -> [Vec2; 3] {
        let (s, c) = (super::exact::sin(rotation.into()) as f32, super::exact::cos(rotation.into()) as f32);
        [Vec2::new(c, -s) * scale.x, Vec2::new(s, c) * scale.y, offset]
    }

    fn correspond(&self, uv: Vec2) -> Vec2 {
        let uv = uv * self.scale + self.delta;
        self.matrix[0] * uv.x + self.matrix[1] * uv.y + self.matrix[2]
    }

    fn correspond_vector(&self, d: Vec2) -> Vec2 {
        let d = d * self.scale;
        self.matrix[0] * d.x + self.matrix[1] * d.y
    }

    /// Texture coordinates of a surface point.
    #[inline]
    pub fn uv(&self, at: &TextureContext) -> Vec2 {
        match &self.projector {
            Projector::Uv => self.correspond(at.uv),
            projector => self.correspond(projector.project(&self.local, at, Vec3::ZERO, None).uv),
        }
    }

    /// Texture coordinates with what the footprint makes of them.
    pub fn coordinates(&self, at: &TextureContext) -> Coordinates2 {
        let f = &at.footprint;
        if let Projector::Uv = self.projector {
            return Coordinates2 {
                uv: self.correspond(at.uv),
                dx: self.correspond_vector(f.duvdx),
                dy: self.correspond_vector(f.duvdy),
            };
        }
        if let Projector::Attribute(name) = &self.projector
            && let Some(uv) = projector::attribute(name, at, Vec2::ZERO)
        {
            let by = |duv| self.correspond_vector(projector::attribute(name, at, duv).map_or(Vec2::ZERO, |to| to - uv));
            return Coordinates2 { uv: self.correspond(uv), dx: by(f.duvdx), dy: by(f.duvdy) };
        }
        let here = self.projector.project(&self.local, at, Vec3::ZERO, None);
        let by = |dp: Vec3| {
            if dp == Vec3::ZERO {
                return Vec2::ZERO;
            }
            // On the same side of the seams: the same face, and the shorter way around.
            let there = self.projector.project(&self.local, at, dp, Some(here.face));
            let d = there.uv - here.uv;
            let d = Vec2::new(if here.wraps { d.x - d.x.round() } else { d.x }, d.y);
            if d.is_finite() { self.correspond_vector(d) } else { Vec2::ZERO }
        };
        Coordinates2 { uv: self.correspond(here.uv), dx: by(f.dpdx), dy: by(f.dpdy) }
    }

    /// Solid texture coordinates of a world point.
    pub fn solid(&self, p: Vec3) -> Vec3 {
        self.local.point(p)
    }

    /// Solid texture coordinates with what the footprint makes of them.
    pub fn solid_coordinates(&self, at: &TextureContext) -> Coordinates3 {
        let f = &at.footprint;
        let vector = |v: Vec3| if v == Vec3::ZERO { v } else { self.local.vector(v) };
        Coordinates3 { p: self.local.point(at.p), dx: vector(f.dpdx), dy: vector(f.dpdy) }
    }
}

#[cfg(test)]
mod tests;

//! Shading models of triangles: the points at which light is computed, and the normals there.
//!
//! Flat and Gouraud shading compute light once for each triangle or corner that the picture sees, before its pixels;
//! these interpolate it by the barycentric coordinates of what they see. Shapes without corners are shaded pixel by
//! pixel with every model.

use steradian_core::{material::Scattering, scene::Interaction};
use steradian_math::{Frame, Vec3};

/// Shading model of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadingModel {
    /// Light of the first corner (the provoking vertex) over the whole triangle.
    Flat,
    /// Light of the middle with the normal of the face, over the whole triangle.
    FlatCentre,
    /// Light of the corners, interpolated (Gouraud 1971).
    Gouraud,
    /// Light of each pixel with the interpolated normal of the corners, without maps of normals (Phong 1975).
    Phong,
    /// Light of each pixel with the normal of the surface and its maps.
    Pixel,
}

/// The models by name.
pub(crate) const MODELS: [(&str, ShadingModel); 5] = [
    ("flat", ShadingModel::Flat),
    ("flat-centre", ShadingModel::FlatCentre),
    ("gouraud", ShadingModel::Gouraud),
    ("phong", ShadingModel::Phong),
    ("pixel", ShadingModel::Pixel),
];

/// Normals with which light is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normals {
    /// Shading normals of the surface with its maps.
    Mapped,
    /// Interpolated normals of the corners.
    Interpolated,
    /// Normal of the face.
    Face,
}

impl Normals {
    /// Sets the shading normal of a surface point before it scatters.
    pub fn set(self, i: &mut Interaction) {
        if self == Self::Face {
            i.surface.ns = i.surface.n;
        }
    }

    /// Scattering without the perturbation of the normal, for models that have none.
    pub fn unmapped<'a>(self, i: &Interaction, (s, frame): (Scattering<'a>, Frame)) -> (Scattering<'a>, Frame) {
        if self == Self::Mapped || s.detail.is_none() {
            return (s, frame);
        }
        let z = if s.flipped { -i.surface.ns } else { i.surface.ns };
        let mut unmapped = Scattering { detail: None, ground: None, ..s };
        unmapped.bsdf.set_coat_normal(Vec3::Z);
        (unmapped, Frame::from_zx(z, frame.x))
    }
}

impl ShadingModel {
    /// Barycentric coordinates (u, v) of the points of a triangle that light is computed at: one, three, or none for
    /// models of pixels.
    pub fn points(self) -> &'static [[f32; 2]] {
        match self {
            Self::Flat => &[[0.0, 0.0]],
            Self::FlatCentre => &[[1.0 / 3.0, 1.0 / 3.0]],
            Self::Gouraud => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            Self::Phong | Self::Pixel => &[],
        }
    }

    /// Normals with which the model computes light.
    pub fn normals(self) -> Normals {
        match self {
            Self::Flat | Self::Gouraud | Self::Phong => Normals::Interpolated,
            Self::FlatCentre => Normals::Face,
            Self::Pixel => Normals::Mapped,
        }
    }
}

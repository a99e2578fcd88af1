//! Shading models of triangles: the points at which light is computed, and the normals there.
//!
//! Flat and Gouraud shading compute light once for each triangle or corner that the picture sees, before its pixels;
//! these interpolate it by the barycentric coordinates of what they see. Shapes without corners are shaded pixel by
//! pixel with every model.

use crate::{projection::Projected, visibility::Seen};
use steradian_core::{
    Scene,
    material::Scattering,
    scene::{Hit, Interaction},
};
use steradian_math::{Frame, Ray, Vec2, Vec3};

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
        (Scattering { detail: None, ground: None, ..s }, Frame::from_zx(z, frame.x))
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

/// A sample of a pixel, or the light of a point of a triangle.
#[derive(Clone, Debug)]
pub struct Found {
    /// Colour of all light.
    pub value: Vec3,
    /// Colours of the light of each group of lights; empty where these are not asked for.
    pub lights: Vec<Vec3>,
}

impl Found {
    /// A colour without groups of lights.
    pub fn of(value: Vec3) -> Self {
        Self { value, lights: Vec::new() }
    }

    /// Interpolates the light of the points of a triangle at barycentric coordinates (u, v): L = Σ λᵢ Lᵢ.
    pub fn between(points: &[Self], [u, v]: [f32; 2]) -> Self {
        let [a, b, c] = points else { return points.first().cloned().unwrap_or_else(|| Self::of(Vec3::ZERO)) };
        let mix = |a: Vec3, b: Vec3, c: Vec3| a * (1.0 - u - v) + b * u + c * v;
        let lights = a.lights.iter().zip(&b.lights).zip(&c.lights).map(|((a, b), c)| mix(*a, *b, *c)).collect();
        Self { value: mix(a.value, b.value, c.value), lights }
    }
}

/// A point of a triangle that is seen, and the ray towards it with its hit there.
///
/// Corners of triangles that face the eye may have normals that turn away from it. As the fixed-function pipeline
/// lights the front of a triangle whatever the direction of the eye, the view of such a corner is bent until it grazes
/// the surface.
pub fn view_of(scene: &Scene, projected: &Projected, seen: Seen, [u, v]: [f32; 2]) -> (Vec3, Ray, Seen) {
    // Barycentric coordinates give the point, whichever ray asks.
    let hit = Hit { u, v, ..seen.hit };
    let s = scene.interaction(&Ray::new(Vec3::ZERO, Vec3::Z), &hit).surface;
    let (mut ray, t) = projected.ray_to(s.p);
    // The shading normal on the side of the face that the eye is on.
    let wo = -ray.direction;
    let side = if s.n.dot(wo) < 0.0 { -s.ns } else { s.ns };
    let above = side.dot(wo);
    if above <= GRAZING {
        let bent = (wo + side * (GRAZING - above)).normalize_or_zero();
        ray = Ray::new(s.p + bent * t, -bent);
    }
    (s.p, ray, Seen { hit: Hit { t, ..hit }, ..seen })
}

/// Least cosine between the normal of a corner and its view.
const GRAZING: f32 = 1e-3;

/// Two words from the place of a point, so that corners at one place take the same random numbers.
pub fn key(p: Vec3) -> [u32; 2] {
    let [x, y, z] = p.to_array().map(|v| (v + 0.0).to_bits());
    [x ^ z.rotate_left(11), y ^ z.rotate_left(23)]
}

/// Light of the triangles that a picture sees, at the points of the shading model.
#[derive(Debug, Default)]
pub struct TriangleLight {
    /// Numbers of the triangles, increasing, with the light at the points of each.
    pub triangles: Vec<(u32, Vec<Found>)>,
}

impl TriangleLight {
    /// Light of what a pixel sees; `None` where that has no corners.
    pub fn at(&self, seen: &Seen) -> Option<Found> {
        let place = self.triangles.binary_search_by_key(&seen.number, |t| t.0).ok()?;
        let uv = Vec2::new(seen.hit.u, seen.hit.v);
        Some(Found::between(&self.triangles[place].1, uv.to_array()))
    }
}

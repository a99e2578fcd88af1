//! Light of triangles at the points of a shading model: computed once for each triangle that the picture sees, and
//! interpolated by its pixels.

use crate::{projection::Projected, visibility::Seen};
use steradian_core::{Scene, scene::Hit};
use steradian_math::{Ray, Vec2, Vec3};

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

    /// Multiplies all light by a share.
    pub fn scale(&mut self, share: f32) {
        self.value *= share;
        self.lights.iter_mut().for_each(|light| *light *= share);
    }

    /// Adds a share of other light.
    pub fn add(&mut self, other: &Self, share: f32) {
        self.value += other.value * share;
        self.lights.iter_mut().zip(&other.lights).for_each(|(light, other)| *light += *other * share);
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

//! Gather radius of photons.

use super::vertex::{Place, Vertex};
use std::f32::consts::PI;
use steradian_core::Scene;
use steradian_math::Vec2;
use steradian_request::MethodRequest;

/// The radius of the first pass.
#[derive(Clone, Copy, Debug)]
pub enum Radius {
    /// A length in scene units.
    Fixed(f32),
    /// A number of pixels, where the camera sees surfaces at their median distance.
    Pixels(f32),
}

impl Radius {
    /// Radius by the options `radius` or `pixels`, whichever is set last.
    pub(super) fn of(options: &MethodRequest) -> Self {
        match options.last_of(&["radius", "pixels"]).and_then(|(name, value)| Some((name, value.number()?))) {
            Some(("radius", length)) => Self::Fixed(length as f32),
            _ => Self::Pixels(options.number("pixels").unwrap_or(1.0) as f32),
        }
    }

    /// Radius times a factor.
    pub(super) fn times(self, factor: f32) -> Self {
        match self {
            Self::Fixed(r) => Self::Fixed(factor * r),
            Self::Pixels(r) => Self::Pixels(factor * r),
        }
    }

    /// Radius in a scene, in scene units.
    pub(super) fn of_scene(self, scene: &Scene) -> f32 {
        match self {
            Self::Fixed(r) => r,
            Self::Pixels(pixels) => pixels * pixel_size(scene),
        }
    }
}

/// Exponent α of the shrinking radius: squared radii of passes are `r² (n + 1)^(α − 1)`, so that bias and variance both
/// vanish (Knaus, Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach").
const ALPHA: f32 = 2.0 / 3.0;

/// The radius of a pass, counted from zero.
pub(super) fn of_pass(first: f32, number: u32) -> f32 {
    // r_n = r_1 (n + 1)^((α − 1)/2).
    first * (number as f32 + 1.0).powf((ALPHA - 1.0) / 2.0)
}

/// The kernel of a density estimate at a vertex within a radius: one over the area of its disc, or in media over the
/// volume of its ball.
pub(super) fn kernel(v: &Vertex<'_>, square: f32) -> f32 {
    let square = square.max(f32::MIN_POSITIVE);
    match &v.place {
        Place::Surface(_) => 1.0 / (PI * square),
        Place::Medium(_) => 0.75 / (PI * square * square.sqrt()),
    }
}

/// The radii within which photons are gathered.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Radii {
    surfaces: f32,
    media: f32,
}

/// Radius in media relative to that on surfaces, where this is a number of pixels: few photons lie in a ball of that
/// size.
const IN_MEDIA: f32 = 4.0;

/// Such radii in media are at most this part of the scene's diagonal, since light is missing from balls that reach out
/// of their medium.
const WIDEST: f32 = 0.02;

impl Radii {
    /// Radii of the first pass.
    pub fn of_scene(radius: Radius, scene: &Scene) -> Self {
        let surfaces = radius.of_scene(scene);
        let media = match radius {
            Radius::Fixed(r) => r,
            Radius::Pixels(_) => {
                let diagonal = (scene.bounds().max - scene.bounds().min).length();
                // Of scenes without bounds there is no part.
                if diagonal.is_finite() { (IN_MEDIA * surfaces).min(WIDEST * diagonal) } else { surfaces }
            }
        };
        Self { surfaces, media }
    }

    /// Radii of a pass, counted from zero.
    pub fn of_pass(self, number: u32) -> Self {
        Self { surfaces: of_pass(self.surfaces, number), media: of_pass(self.media, number) }
    }

    /// The one at a vertex.
    pub fn at(self, v: &Vertex<'_>) -> f32 {
        match &v.place {
            Place::Surface(_) => self.surfaces,
            Place::Medium(_) => self.media,
        }
    }

    /// The larger one of a scene.
    pub fn largest(self, scene: &Scene) -> f32 {
        if scene.has_media() { self.surfaces.max(self.media) } else { self.surfaces }
    }
}

/// The median edge of a pixel on what the camera sees.
fn pixel_size(scene: &Scene) -> f32 {
    const EDGE: u32 = 16;
    let size = Vec2::new(scene.film().width as f32, scene.film().height as f32);
    let mut edges = Vec::new();
    // A coarse grid of camera rays: distance over the root of the density on the film is the edge of a pixel there.
    for k in 0..EDGE * EDGE {
        let place = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
        let ray = scene.camera().ray(scene.film(), place * size, Vec2::splat(0.5));
        let Some(hit) = scene.intersect(&ray) else { continue };
        let d = scene.camera().ray_density(scene.film(), &ray);
        let distance = if d.is_parallel { 1.0 } else { hit.t + d.start };
        edges.push(distance / d.density.sqrt());
    }
    edges.sort_by(f32::total_cmp);
    edges.get(edges.len() / 2).copied().unwrap_or(1e-3)
}

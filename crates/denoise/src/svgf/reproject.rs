//! Where a pixel was in the frame before.

use steradian_math::{Vec2, Vec3};

use super::{accumulate::Accumulated, surface::Surface};
use crate::{gbuffer::GBuffer, image::Image};

/// The least cosine of the angle between the normals of a point now and before.
const NORMALS: f32 = 0.9;
/// How much depths may differ from what is expected beyond a pixel's gradient, relative to them.
const DEPTHS: f32 = 0.02;
/// Less weight of the bilinear filter than this is no history.
const LEAST_WEIGHT: f32 = 0.01;

/// What was accumulated in the frame before, and which surfaces it showed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Before<'a> {
    pub accumulated: &'a Image<Accumulated>,
    pub surfaces: &'a Image<Surface>,
}

impl Before<'_> {
    /// The history of a pixel: bilinear, of those of the four pixels about its former place that showed the same
    /// surface. None where there is none.
    pub fn history(&self, gbuffer: &GBuffer, surface: &Surface, x: u32, y: u32) -> Option<Accumulated> {
        let place = Vec2::new(x as f32, y as f32) + gbuffer.motion.at(x, y);
        let [width, height] = self.surfaces.size();
        // Not so for NaN either.
        if !(place.x > -1.0 && place.y > -1.0 && place.x < width as f32 && place.y < height as f32) {
            return None;
        }
        let depth = gbuffer.previous_depth.at(x, y);
        let (corner, part) = (place.floor(), place - place.floor());
        let (mut weights, mut length, mut color, mut moments) = (0.0, 0.0, Vec3::ZERO, Vec2::ZERO);
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let weight = [1.0 - part.x, part.x][i] * [1.0 - part.y, part.y][j];
            let tap = corner + Vec2::new(i as f32, j as f32);
            let is_inside = tap.x >= 0.0 && tap.y >= 0.0 && tap.x < width as f32 && tap.y < height as f32;
            if weight <= 0.0 || !is_inside {
                continue;
            }
            let was = self.accumulated.at(tap.x as u32, tap.y as u32);
            let shown = self.surfaces.at(tap.x as u32, tap.y as u32);
            if was.length > 0 && is_same(surface, depth, &shown, tap - place) {
                weights += weight;
                color += weight * was.color;
                moments += weight * was.moments;
                length += weight * was.length as f32;
            }
        }
        let scale = 1.0 / weights;
        let length = (length * scale).round().max(1.0) as u32;
        (weights >= LEAST_WEIGHT).then(|| Accumulated { color: color * scale, moments: moments * scale, length })
    }
}

/// Whether a tap of the frame before shows the surface, which was at `depth` there, `offset` pixels from it.
fn is_same(surface: &Surface, depth: f32, tap: &Surface, offset: Vec2) -> bool {
    let expected = depth + surface.gradient.dot(offset);
    let tolerance = surface.gradient.abs().element_sum() + DEPTHS * depth.abs();
    surface.id == tap.id
        && is_same_direction(surface.normal, tap.normal)
        && (tap.depth == expected || (tap.depth - expected).abs() <= tolerance)
}

/// Whether normals are near each other. Pixels without a surface have zero.
fn is_same_direction(a: Vec3, b: Vec3) -> bool {
    a.dot(b) >= NORMALS || (a == Vec3::ZERO && b == Vec3::ZERO)
}

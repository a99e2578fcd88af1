//! Reprojection of a pixel to the frame before.

use steradian_math::{Vec2, Vec3};

use super::{accumulate::Accumulated, surface::Surface};
use crate::{gbuffer::GBuffer, image::Image, rows::Rows};

/// The least cosine of the angle between the normals of a point now and before.
const NORMALS: f32 = 0.9;
/// Relative tolerance of depths around the expected one, beyond a pixel's gradient.
const DEPTHS: f32 = 0.02;
/// Less weight of the bilinear filter than this is no history.
const LEAST_WEIGHT: f32 = 0.01;

/// The pixels of the frame before that a pixel's history is taken from, with their weights: 0 where they showed another
/// surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Former {
    pixels: [[u32; 2]; 4],
    weights: [f32; 4],
}

impl Former {
    /// The four pixels about the former place of a pixel, of which `surfaces` are what the frame before showed.
    pub fn of(surfaces: &Image<Surface>, gbuffer: &GBuffer, surface: &Surface, x: u32, y: u32) -> Self {
        // Follow the motion vector back to the former place.
        let place = Vec2::new(x as f32, y as f32) + gbuffer.motion.at(x, y);
        let [width, height] = surfaces.size();
        let mut former = Self::default();
        // Not so for NaN either.
        if !(place.x > -1.0 && place.y > -1.0 && place.x < width as f32 && place.y < height as f32) {
            return former;
        }
        let depth = gbuffer.previous_depth.at(x, y);
        let (corner, part) = (place.floor(), place - place.floor());
        // Bilinear taps: each counts only if it showed the same surface.
        for (k, (i, j)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let weight = [1.0 - part.x, part.x][i] * [1.0 - part.y, part.y][j];
            let tap = corner + Vec2::new(i as f32, j as f32);
            // Taps outside the picture have no history.
            let is_inside = tap.x >= 0.0 && tap.y >= 0.0 && tap.x < width as f32 && tap.y < height as f32;
            if weight <= 0.0 || !is_inside {
                continue;
            }
            let pixel = [tap.x as u32, tap.y as u32];
            if is_same(surface, depth, &surfaces.at(pixel[0], pixel[1]), tap - place) {
                (former.pixels[k], former.weights[k]) = (pixel, weight);
            }
        }
        former
    }

    /// The history of a term there: bilinear, of the pixels that have one. None where there is none.
    pub fn history(&self, accumulated: &Rows<Accumulated>, term: usize) -> Option<Accumulated> {
        let (mut weights, mut length, mut color, mut moments) = (0.0, 0.0, Vec3::ZERO, Vec2::ZERO);
        for ([x, y], &weight) in self.pixels.iter().zip(&self.weights) {
            if weight <= 0.0 {
                continue;
            }
            let was = accumulated.at(term, *x as usize, *y as usize);
            if was.length > 0 {
                weights += weight;
                color += weight * was.color;
                moments += weight * was.moments;
                length += weight * was.length as f32;
            }
        }
        // Renormalise over the taps that have a history.
        let scale = 1.0 / weights;
        let length = (length * scale).round().max(1.0) as u32;
        (weights >= LEAST_WEIGHT).then(|| Accumulated { color: color * scale, moments: moments * scale, length })
    }
}

/// True if a tap of the frame before shows the surface, which was at `depth` there, `offset` pixels from it.
fn is_same(surface: &Surface, depth: f32, tap: &Surface, offset: Vec2) -> bool {
    // Expected depth at the tap by the gradient; the tolerance is a pixel's gradient and a part of the depth.
    let expected = depth + surface.gradient.dot(offset);
    let tolerance = surface.gradient.abs().element_sum() + DEPTHS * depth.abs();
    surface.id == tap.id
        && is_same_direction(surface.normal, tap.normal)
        && (tap.depth == expected || (tap.depth - expected).abs() <= tolerance)
}

/// True if normals are near each other. Pixels without a surface have zero.
fn is_same_direction(a: Vec3, b: Vec3) -> bool {
    a.dot(b) >= NORMALS || (a == Vec3::ZERO && b == Vec3::ZERO)
}

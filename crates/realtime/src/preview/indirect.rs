//! Light that arrives after bounces, by few paths: from one point in each block of pixels, smoothed over surfaces.
//! Irradiance changes slowly over them (Ward, Rubinstein, Clear 1988), so few points tell it for all.

use super::Surface;
use rayon::prelude::*;
use steradian_math::Vec3;

/// Side of the blocks of pixels that have a point each.
pub const BLOCK: u32 = 8;
/// Light of a block is held below so many times the mean of the picture.
const MOST: f32 = 16.0;
/// The power of the cosine of the angle between normals by which points count for each other.
const NORMAL_POWER: i32 = 8;

/// Light over albedo in blocks of pixels.
pub struct Blocks<'a> {
    columns: u32,
    rows: u32,
    /// A point in each block and the light there, where it has a surface.
    points: Vec<Option<(&'a Surface, Vec3)>>,
    mean: Vec3,
    /// The angle that a block covers.
    angle: f32,
}

/// Number of blocks of a picture along each axis.
pub fn blocks([width, height]: [u32; 2]) -> [u32; 2] {
    [width.div_ceil(BLOCK), height.div_ceil(BLOCK)]
}

/// The pixels of a block, from its middle on.
pub fn pixels([column, row]: [u32; 2], [width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..BLOCK * BLOCK).filter_map(move |k| {
        let k = (k + BLOCK * BLOCK / 2 + BLOCK / 2) % (BLOCK * BLOCK);
        let at = [column * BLOCK + k % BLOCK, row * BLOCK + k / BLOCK];
        (at[0] < width && at[1] < height).then_some(at)
    })
}

impl<'a> Blocks<'a> {
    /// From points by rows, with the light over albedo that they receive. `pixel_angle`: between the rays of pixels.
    pub fn new(size: [u32; 2], mut points: Vec<Option<(&'a Surface, Vec3)>>, pixel_angle: f32) -> Self {
        let [columns, rows] = blocks(size);
        let (sum, count) =
            points.iter().flatten().fold((Vec3::ZERO, 0_u32), |(sum, n), (_, light)| (sum + *light, n + 1));
        let mean = sum / count.max(1) as f32;
        // Fireflies of few paths would spread over many pixels: the largest values are held, at the cost of some
        // energy.
        let most = MOST * mean.max_element();
        for (_, light) in points.iter_mut().flatten() {
            let largest = light.max_element();
            if largest > most {
                *light *= most / largest;
            }
        }
        Self { columns, rows, points, mean, angle: pixel_angle * BLOCK as f32 }
    }

    /// Each point's light becomes the mean of those around it that lie on its surface, with gaps of `step` blocks.
    pub fn smooth(self, step: i32) -> Self {
        // Edge-aware smoothing over neighbouring points, as one pass of an à-trous filter with this step.
        let at = |k: usize| [k as u32 % self.columns, k as u32 / self.columns].map(|x| x as f32);
        let smoothed = (0..self.points.len()).into_par_iter().map(|k| {
            let (surface, light) = self.points[k]?;
            Some((surface, self.around(surface, at(k), step, 2).unwrap_or(light)))
        });
        let points = smoothed.collect();
        Self { points, ..self }
    }

    /// The light over albedo at a surface that a pixel shows.
    pub fn light(&self, surface: &Surface, pixel: [u32; 2]) -> Vec3 {
        let at = pixel.map(|x| (x as f32 + 0.5) / BLOCK as f32 - 0.5);
        // Near blocks first, then farther ones, then the mean of the picture.
        self.around(surface, at, 1, 1).or_else(|| self.around(surface, at, 2, 3)).unwrap_or(self.mean)
    }

    /// The mean of points around a place, as they lie on a surface; `None` where none does.
    fn around(&self, surface: &Surface, [x, y]: [f32; 2], step: i32, reach: i32) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        let (column, row) = (x.round() as i32, y.round() as i32);
        let wide = ((reach + 1) * step) as f32;
        // Weighted mean: a tent in the picture times the likeness of the surfaces.
        for (dy, dx) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dy * step, dx * step))) {
            let (i, j) = (column + dx, row + dy);
            if !(0..self.columns as i32).contains(&i) || !(0..self.rows as i32).contains(&j) {
                continue;
            }
            let Some((other, light)) = &self.points[(j as u32 * self.columns + i as u32) as usize] else { continue };
            // A cross-bilateral weight: a tent over the distance in the picture, times the likeness of the surfaces.
            let tent = |d: f32| (1.0 - d.abs() / wide).max(0.0);
            let weight = tent(i as f32 - x) * tent(j as f32 - y) * self.likeness(surface, other);
            sum += *light * weight;
            weights += weight;
        }
        (weights > 1e-4).then(|| sum / weights)
    }

    /// Weight of the light at another surface for this one: max(n·n′, 0)⁸ · exp(−d²), with the distance d of the other
    /// point from the plane of this one in blocks.
    fn likeness(&self, surface: &Surface, other: &Surface) -> f32 {
        // Geometric weight: similar normals, and a small distance from the tangent plane relative to the block's width.
        let facing = surface.normal.dot(other.normal).max(0.0).powi(NORMAL_POWER);
        let off = surface.normal.dot(other.p - surface.p) / (self.angle * surface.distance);
        facing * (-off * off).exp()
    }
}

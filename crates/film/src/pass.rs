//! The film of one pass: samples of pixels, and splats, which arrive anywhere.

use crate::{Crop, FilmSpec};
use steradian_math::{Vec2, Vec3};

/// A contribution to a place of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Place on the full frame, pixels (origin at the top left, y down).
    pub at: Vec2,
    /// Linear Rec.709 radiance times pixels.
    pub rgb: Vec3,
}

/// Sums of a pass. Contributions are added in an order that does not depend on threads: the caller adds what chunks of
/// work found, chunk by chunk.
#[derive(Debug)]
pub struct PassFilm<'s> {
    spec: &'s FilmSpec,
    /// Sums in the order of the rows of the crop.
    sums: Vec<[f64; 3]>,
    /// Sums of each group of lights, pixel by pixel.
    by_light: Vec<[f64; 3]>,
    groups: usize,
    /// Contributions that were not finite, which count as black.
    nonfinite: u64,
}

impl<'s> PassFilm<'s> {
    /// A black film that keeps the light of so many groups of lights apart.
    pub fn new(spec: &'s FilmSpec, groups: usize) -> Self {
        let n = spec.crop.width() as usize * spec.crop.height() as usize;
        Self { spec, sums: vec![[0.0; 3]; n], by_light: vec![[0.0; 3]; n * groups], groups, nonfinite: 0 }
    }

    /// Sum of each pixel's contributions, by rows of the crop.
    pub fn sums(&self) -> &[[f64; 3]] {
        &self.sums
    }

    /// The light of each group of lights, pixel by pixel.
    pub fn by_light(&self) -> &[[f64; 3]] {
        &self.by_light
    }

    /// Contributions that were not finite.
    pub fn nonfinite(&self) -> u64 {
        self.nonfinite
    }

    /// Part of the frame that is kept.
    pub fn crop(&self) -> Crop {
        self.spec.crop
    }

    /// Adds to a pixel of the frame; nothing where it is outside of the crop.
    pub fn add(&mut self, x: u32, y: u32, rgb: Vec3) {
        let crop = self.spec.crop;
        if !(crop.x0..crop.x1).contains(&x) || !(crop.y0..crop.y1).contains(&y) {
            return;
        }
        if !rgb.is_finite() {
            self.nonfinite += 1;
            return;
        }
        let sum = &mut self.sums[(y - crop.y0) as usize * crop.width() as usize + (x - crop.x0) as usize];
        for c in 0..3 {
            sum[c] += f64::from(rgb[c]);
        }
    }

    /// Adds the light of each group of lights to a pixel of the crop, by its index; what is not finite counts as black.
    pub fn add_lights(&mut self, at: usize, lights: &[Vec3]) {
        let sums = &mut self.by_light[at * self.groups..(at + 1) * self.groups];
        for (sum, light) in sums.iter_mut().zip(lights).filter(|(_, l)| l.is_finite()) {
            *sum = std::array::from_fn(|c| sum[c] + f64::from(light[c]));
        }
    }

    /// Adds values of all pixels of the crop, by rows.
    pub fn add_rows(&mut self, rows: &[Vec<Vec3>]) {
        let crop = self.spec.crop;
        for (y, row) in (crop.y0..).zip(rows) {
            for (x, rgb) in (crop.x0..).zip(row) {
                self.add(x, y, *rgb);
            }
        }
    }

    /// Adds to all pixels whose filter covers a place.
    pub fn splat(&mut self, splat: &Splat) {
        if !splat.rgb.is_finite() || !splat.at.is_finite() {
            self.nonfinite += 1;
            return;
        }
        let (crop, filter) = (self.spec.crop, &self.spec.filter);
        let radius = filter.radius();
        let range = |p: f32, r: f32, from: u32, to: u32| {
            let first = (p - 0.5 - r).ceil().max(from as f32) as u32;
            let end = ((p - 0.5 + r).floor() + 1.0).clamp(0.0, to as f32) as u32;
            first..end
        };
        for y in range(splat.at.y, radius.y, crop.y0, crop.y1) {
            for x in range(splat.at.x, radius.x, crop.x0, crop.x1) {
                let offset = splat.at - Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                self.add(x, y, splat.rgb * filter.density(offset));
            }
        }
    }
}

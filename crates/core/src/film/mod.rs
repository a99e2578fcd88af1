//! The film: per-pixel sums of samples, and the pixel filter.

pub mod filter;
pub mod matte;

pub use filter::{Filter, FilterKind};
pub use matte::{Hits, MatteSums};

use steradian_math::Vec3;

/// What is seen first by a camera ray: the auxiliary layers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FirstHit {
    /// Reflectance estimate, linear Rec.709.
    pub albedo: [f32; 3],
    /// Shading normal, world space; zero where nothing is hit.
    pub normal: [f32; 3],
    /// Geometric normal, world space, on the side of the camera; zero where nothing is hit.
    pub geometric_normal: [f32; 3],
    /// World-space position.
    pub position: [f32; 3],
    /// Distance along the camera's axis.
    pub depth: f32,
    /// Distance along the ray.
    pub distance: f32,
    /// Surface parameters.
    pub uv: [f32; 2],
    /// Index of the shape, counted from one; 0 for nothing.
    pub shape: u32,
    /// Index of the material, counted from one; 0 for nothing.
    pub material: u32,
    /// 1 where a surface is hit; in the mean the part of the pixel that surfaces cover.
    pub coverage: f32,
}

/// The sums of one pixel. Samples are added in the order of their index, whatever the thread, so the sums have the same
/// bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pixel {
    /// Sum of linear Rec.709 radiance.
    pub sum: [f64; 3],
    /// Sum of its squares.
    pub sum_squares: [f64; 3],
    /// Samples added, those with a non-finite value among them (they add zero).
    pub samples: u32,
}

impl Pixel {
    /// The pixel whose mean has a value and an estimated variance, from a number of samples: the inverse of
    /// [`Self::mean`] and [`Self::variance_of_mean`].
    pub fn of(mean: [f64; 3], variance_of_mean: [f64; 3], samples: u32) -> Self {
        let n = f64::from(samples);
        Self {
            sum: mean.map(|m| m * n),
            sum_squares: std::array::from_fn(|c| n * (variance_of_mean[c] * (n - 1.0) + mean[c] * mean[c])),
            samples,
        }
    }

    /// Adds a sample; returns `false`, and adds zero radiance, if it is not finite. This is the one gate for NaN and
    /// infinity.
    #[inline]
    pub fn add(&mut self, rgb: Vec3) -> bool {
        self.samples += 1;
        if !rgb.is_finite() {
            return false;
        }
        for c in 0..3 {
            let v = f64::from(rgb[c]);
            self.sum[c] += v;
            self.sum_squares[c] += v * v;
        }
        true
    }

    /// Adds a finite sample that is a sum of many contributions.
    #[inline]
    pub fn add_value(&mut self, rgb: [f64; 3]) {
        self.samples += 1;
        for (c, v) in rgb.into_iter().enumerate() {
            self.sum[c] += v;
            self.sum_squares[c] += v * v;
        }
    }

    /// The mean: the pixel's linear Rec.709 radiance.
    pub fn mean(&self) -> [f64; 3] {
        let n = f64::from(self.samples.max(1));
        self.sum.map(|s| s / n)
    }

    /// The unbiased estimate of the variance of the mean; zero with fewer than two samples.
    pub fn variance_of_mean(&self) -> [f64; 3] {
        if self.samples < 2 {
            return [0.0; 3];
        }
        let n = f64::from(self.samples);
        std::array::from_fn(|c| {
            let mean = self.sum[c] / n;
            ((self.sum_squares[c] / n - mean * mean).max(0.0)) / (n - 1.0)
        })
    }
}

/// Sums of first hits over the samples of a pixel; ids are those of the first surface that a sample hits.
#[derive(Clone, Copy, Debug, Default)]
pub struct FirstHitSums {
    /// Sum of the averaged quantities.
    pub sum: FirstHit,
    /// Samples added.
    pub samples: u32,
}

impl FirstHitSums {
    /// Adds the first hit of a sample.
    pub fn add(&mut self, hit: &FirstHit) {
        let add = |a: &mut [f32], b: &[f32]| {
            let finite = |(a, b): (&mut f32, &f32)| {
                if b.is_finite() {
                    *a = (*a + b).clamp(f32::MIN, f32::MAX);
                }
            };
            a.iter_mut().zip(b).for_each(finite);
        };
        let s = &mut self.sum;
        add(&mut s.albedo, &hit.albedo);
        add(&mut s.normal, &hit.normal);
        add(&mut s.geometric_normal, &hit.geometric_normal);
        add(&mut s.position, &hit.position);
        add(&mut s.uv, &hit.uv);
        add(std::slice::from_mut(&mut s.depth), &[hit.depth]);
        add(std::slice::from_mut(&mut s.distance), &[hit.distance]);
        add(std::slice::from_mut(&mut s.coverage), &[hit.coverage]);
        if s.shape == 0 {
            (s.shape, s.material) = (hit.shape, hit.material);
        }
        self.samples += 1;
    }

    /// The averages: of albedo (held in [0, 1]), normals and coverage over all samples; of position, parameters and
    /// distances over those that hit a surface. Distances are infinite where none does.
    pub fn mean(&self) -> FirstHit {
        let s = &self.sum;
        let over_all = 1.0 / self.samples.max(1) as f32;
        let over_hits = if s.coverage > 0.0 { 1.0 / s.coverage } else { 0.0 };
        let distance = |sum: f32| if s.coverage > 0.0 { sum * over_hits } else { f32::INFINITY };
        FirstHit {
            albedo: s.albedo.map(|v| (v * over_all).clamp(0.0, 1.0)),
            normal: s.normal.map(|v| v * over_all),
            geometric_normal: s.geometric_normal.map(|v| v * over_all),
            position: s.position.map(|v| v * over_hits),
            uv: s.uv.map(|v| v * over_hits),
            depth: distance(s.depth),
            distance: distance(s.distance),
            coverage: s.coverage * over_all,
            ..*s
        }
    }
}

/// The rectangle of pixels that is rendered, within the full frame. Half open: `x0 ≤ x < x1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl Crop {
    /// Columns.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }
}

/// What the film is like.
#[derive(Clone, Debug)]
pub struct FilmSpec {
    /// Columns of the full frame.
    pub width: u32,
    /// Rows of the full frame.
    pub height: u32,
    /// What of it is rendered.
    pub crop: Crop,
    /// How samples spread around pixel centres.
    pub filter: Filter,
    /// Factor from radiance to film value (pbrt's exposure time × ISO / 100).
    pub imaging_ratio: f32,
    /// Samples with a larger component are scaled down to it; infinite where nothing is clamped.
    pub max_component: f32,
}

impl FilmSpec {
    /// Most pixels that are rendered: of the crop.
    pub const MAX_PIXELS: u64 = 1 << 28;
    /// Most pixels of a side of the frame.
    pub const MAX_SIDE: i64 = 1 << 20;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn non_finite_samples_are_counted_as_black() {
        let mut p = Pixel::default();
        assert!(p.add(Vec3::ONE));
        assert!(!p.add(Vec3::new(1.0, f32::NAN, 0.0)));
        assert!(!p.add(Vec3::splat(f32::INFINITY)));
        assert!(p.add(Vec3::splat(3.0)));
        assert_eq!((p.samples, p.mean()), (4, [1.0; 3]));
    }

    #[test]
    fn variance_of_mean_is_that_of_statistics() {
        let mut p = Pixel::default();
        for v in [1.0, 2.0, 3.0, 4.0_f32] {
            p.add(Vec3::splat(v));
        }
        // Sample variance 5/3, over four samples.
        assert!((p.variance_of_mean()[0] - 5.0 / 12.0).abs() < 1e-12);
        let q = Pixel::of(p.mean(), p.variance_of_mean(), p.samples);
        assert!((q.mean()[0] - 2.5).abs() < 1e-12 && (q.variance_of_mean()[0] - 5.0 / 12.0).abs() < 1e-12);
    }
}

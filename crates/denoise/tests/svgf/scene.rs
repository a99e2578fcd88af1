//! G-buffers and random numbers for the tests.

use steradian_denoise::{
    GBuffer, Image,
    svgf::{Denoiser, Filtered, Settings, Term},
};
use steradian_math::{Vec2, Vec3};

/// A generator of numbers that are the same each time (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn below(&mut self, n: u32) -> u32 {
        (self.bits() % u64::from(n)) as u32
    }

    pub fn color(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Colours of a generator.
pub fn noise(width: u32, height: u32, seed: u64) -> Image<Vec3> {
    let mut random = Random(seed);
    Image::from_fn(width, height, |_, _| random.color())
}

/// A wall that faces the camera; nothing moves.
pub fn wall(width: u32, height: u32) -> GBuffer {
    GBuffer {
        depth: Image::filled(width, height, 2.0),
        depth_gradient: Image::filled(width, height, Vec2::ZERO),
        previous_depth: Image::filled(width, height, 2.0),
        normal: Image::filled(width, height, Vec3::Z),
        albedo: Image::filled(width, height, Vec3::ONE),
        id: Image::filled(width, height, 1),
        motion: Image::filled(width, height, Vec2::ZERO),
    }
}

/// Filters a frame of one term without albedo.
pub fn frame(denoiser: &mut Denoiser, radiance: &Image<Vec3>, gbuffer: &GBuffer) -> Filtered {
    denoiser.frame(&[Term { radiance, has_albedo: false }], gbuffer).unwrap().remove(0)
}

/// A denoiser whose filter does not look at luminance.
pub fn blind(iterations: u32) -> Denoiser {
    Denoiser::new(Settings { iterations, sigma_luminance: f32::INFINITY, ..Settings::default() }).unwrap()
}

pub fn largest(values: impl IntoIterator<Item = f32>) -> f32 {
    values.into_iter().fold(0.0, f32::max)
}

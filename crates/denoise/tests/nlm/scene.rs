//! Walls, and noise of a known variance.

use steradian_denoise::{Image, nlm::Picture};
use steradian_math::Vec3;

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly from 0 to 1.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Mean 0, variance 1: a sum of twelve.
    pub fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.unit()).sum::<f32>() - 6.0
    }
}

/// A picture that is known, with noise of a standard deviation, grey and for all pixels the same.
pub fn noisy(truth: &Image<Vec3>, sigma: f32, seed: u64) -> Image<Vec3> {
    let mut random = Random(seed);
    Image::from_fn(truth.width(), truth.height(), |x, y| {
        let value = truth.get(x, y).copied().unwrap_or_default();
        value + Vec3::from_array([(); 3].map(|()| sigma * random.normal()))
    })
}

/// Colour alone.
pub fn bare<'a>(radiance: &'a Image<Vec3>, variance: &'a Image<Vec3>) -> Picture<'a> {
    Picture { radiance, variance: Some(variance), albedo: None, normal: None, depth: None }
}

/// Mean square of the differences of pixels at least `margin` from the edge.
pub fn square_error(a: &Image<Vec3>, b: &Image<Vec3>, margin: u32) -> f32 {
    let (mut sum, mut count) = (0.0, 0.0);
    for y in margin..a.height() - margin {
        for x in margin..a.width() - margin {
            sum += (*a.get(x, y).unwrap() - *b.get(x, y).unwrap()).length_squared() / 3.0;
            count += 1.0;
        }
    }
    sum / count
}

/// Any number: now and then one that no picture should hold.
pub fn any_number(random: &mut Random) -> f32 {
    match random.bits() % 12 {
        0 => f32::from_bits(random.bits() as u32),
        1 => [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, f32::MIN, 1e-42, -0.0][(random.bits() % 7) as usize],
        2 => random.unit() * 1e5 - 5e4,
        _ => random.unit() * 3.0 - 1.0,
    }
}

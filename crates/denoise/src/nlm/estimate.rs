//! Values of pixels with their variances.

use steradian_accel::Lanes;
use steradian_math::Vec3;

use super::{features::Features, plane::Plane};

/// Three channels with their variances, and whether pixels count for others.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    value: [Plane; 3],
    variance: [Plane; 3],
    weight: Plane,
    size: [usize; 2],
}

impl Estimate {
    /// Estimate with these values, variances and weights.
    pub fn new(size: [usize; 2], channels: [(Vec<f32>, Vec<f32>); 3], weights: Vec<f32>) -> Self {
        let plane = |values: &Vec<f32>| Plane::new(size, |place| values[place]);
        Self {
            value: channels.each_ref().map(|c| plane(&c.0)),
            variance: channels.each_ref().map(|c| plane(&c.1)),
            weight: plane(&weights).with_edge(0.0),
            size,
        }
    }

    /// Other values and variances of the same pixels.
    pub fn with(&self, value: [Plane; 3], variance: [Plane; 3]) -> Self {
        Self { value, variance, weight: self.weight.clone(), ..*self }
    }

    /// Values and variances of a channel of pixels that follow one another.
    #[inline(always)]
    pub fn rows<const N: usize>(&self, channel: usize, at: [i64; 2]) -> [&[f32; N]; 2] {
        [self.value[channel].row(at), self.variance[channel].row(at)]
    }

    /// Weights for others of pixels that follow one another.
    #[inline(always)]
    pub fn counts<const N: usize>(&self, at: [i64; 2]) -> &[f32; N] {
        self.weight.row(at)
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The value of a pixel's channel, and its variance.
    pub fn channel(&self, channel: usize, place: usize) -> (f32, f32) {
        (self.value[channel].at(place), self.variance[channel].at(place))
    }

    /// Weight of a pixel for others.
    pub fn count(&self, place: usize) -> f32 {
        self.weight.at(place)
    }

    /// The value of a pixel.
    pub fn at(&self, place: usize) -> Vec3 {
        Vec3::from_array(self.value.each_ref().map(|plane| plane.at(place)))
    }

    /// Means over the 3×3 pixels around that count and show the same surface, with their variances: a guide that is
    /// less noisy, and hardly less sharp.
    pub fn blurred(&self, features: &Features, lanes: Lanes) -> Self {
        let of = |value: &(dyn Fn(usize) -> f32 + Sync)| Plane::new(self.size, value).with_edge(0.0);
        let counted = self.value.each_ref().map(|plane| of(&|place| plane.at(place) * self.count(place)));
        let noise = self.variance.each_ref().map(|plane| of(&|place| plane.at(place) * self.count(place).powi(2)));
        let [r, g, b] = &counted;
        let sums = features.sums((1, 1.0), ([r, g, b, &self.weight], noise.each_ref()), lanes);
        let over = |place: usize| 1.0 / sums[place].values[3];
        let plane = |value: &(dyn Fn(usize) -> f32 + Sync), other: &Plane| {
            Plane::new(self.size, |place| if over(place).is_finite() { value(place) } else { other.at(place) })
        };
        let value = std::array::from_fn(|c| plane(&|p| sums[p].values[c] * over(p), &self.value[c]));
        let variance = std::array::from_fn(|c| plane(&|p| sums[p].squared[c] * over(p) * over(p), &self.variance[c]));
        self.with(value, variance)
    }

    /// With at least a part of the variance of another.
    pub fn with_noise_of(self, noisy: &Self, part: f32) -> Self {
        // The second pass trusts the first not wholly: a part of the noise is taken to be left.
        let more = |mine: &Plane, other: &Plane| Plane::new(self.size, |place| mine.at(place) + part * other.at(place));
        let variance = std::array::from_fn(|c| more(&self.variance[c], &noisy.variance[c]));
        Self { variance, ..self }
    }
}

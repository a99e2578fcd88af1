//! The two halves of a pixel's samples, which err independently of each other.

use crate::Pixel;

/// Part of a pixel's mean that one half of its samples, those of even number, makes; the rest is the other half's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Half {
    /// Its part of the mean: linear Rec.709 radiance times the weight.
    pub part: [f64; 3],
    /// The weight of its samples in the mean, in [0, 1].
    pub weight: f64,
}

impl Half {
    /// Half of so many of a pixel's samples with this sum.
    pub fn of(sum: [f64; 3], samples: u32, pixel: &Pixel) -> Self {
        let n = f64::from(pixel.samples.max(1));
        Self { part: sum.map(|s| s / n), weight: f64::from(samples) / n }
    }

    /// The half of two estimates of a pixel as one, the second with weight `a`.
    #[must_use]
    pub fn joined(&self, now: &Self, a: f64) -> Self {
        let b = 1.0 - a;
        Self {
            part: std::array::from_fn(|c| b * self.part[c] + a * now.part[c]),
            weight: b * self.weight + a * now.weight,
        }
    }

    /// The means of both halves of a pixel: linear Rec.709 radiance. `None` where one has no samples.
    pub fn means(&self, pixel: &Pixel) -> Option<[[f64; 3]; 2]> {
        let rest = 1.0 - self.weight;
        let all = pixel.mean();
        let others = std::array::from_fn(|c| (all[c] - self.part[c]) / rest);
        (self.weight > 0.0 && rest > 0.0).then(|| [self.part.map(|p| p / self.weight), others])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::Vec3;

    /// Three samples of which the first and the third are even, then two, joined with a weight.
    #[test]
    fn halves_are_means_and_make_up_the_picture() {
        let pixel = |values: &[f32]| {
            let mut pixel = Pixel::default();
            values.iter().for_each(|v| assert!(pixel.add(Vec3::splat(*v))));
            pixel
        };
        let (first, second) = (pixel(&[1.0, 2.0, 6.0]), pixel(&[4.0, 8.0]));
        let [a, b] = [Half::of([7.0; 3], 2, &first), Half::of([4.0; 3], 1, &second)];
        let [even, odd] = a.means(&first).unwrap();
        assert!((even[0] - 3.5).abs() < 1e-12 && (odd[2] - 2.0).abs() < 1e-12, "{even:?} {odd:?}");
        let whole = Pixel::of([0.25 * 3.0 + 0.75 * 6.0; 3], [0.0; 3], 5);
        let half = a.joined(&b, 0.75);
        let [even, odd] = half.means(&whole).unwrap();
        // 2/3 of a quarter and half of three quarters.
        let weight = 1.0 / 6.0 + 0.375;
        assert!((half.weight - weight).abs() < 1e-12);
        assert!((even[0] * weight - (3.5 / 6.0 + 4.0 * 0.375)).abs() < 1e-12);
        assert!((even[0] * weight + odd[0] * (1.0 - weight) - 5.25).abs() < 1e-12);
        assert_eq!(Half::of([1.0; 3], 1, &pixel(&[1.0])).means(&pixel(&[1.0])), None);
        assert_eq!(Half::default().means(&Pixel::default()), None);
    }
}

//! Input of the filter: a picture with its variance and the features of its surfaces.

use steradian_accel::Lanes;
use steradian_math::Vec3;

use super::{
    Denoised,
    estimate::Estimate,
    features::Features,
    fireflies::hold,
    local::{calm_variance, map},
    plane::Plane,
};
use crate::{
    balance::{Amount, give_back},
    error::{Error, Result},
    gbuffer::check_size,
    image::Image,
};

/// The largest number that is calculated with: squares of differences stay finite.
const MOST: f32 = 1e15;
/// Numbers nearer to 0 are taken as 0: products with them would be too small for the processor's fast path.
const LEAST: f32 = 1e-15;
/// The least albedo that colours are divided by: what a surface mirrors does not follow its albedo.
const LEAST_ALBEDO: f32 = 0.05;
/// The variance of pixels of which nothing is known.
const UNKNOWN: f32 = 1e30;
/// The mean variance over the mean of the least of nine windows that overlap, for normal noise.
const CALMEST: f32 = 2.0;
/// Distance up to which variances are averaged.
const SMOOTHED: i64 = 2;
/// Light of paths too rare for the pixels around to take makes all that is there a little brighter: it would else stay
/// as points.
const GIVEN_BACK: Amount =
    Amount { noises: [3.0, 5.0], noises_around: [4.0, 6.0], most_gain: 0.1, most_wide_gain: 1.0, keeps_points: false };

/// A picture with what is known of it. All images have one size. Values that are not finite are taken as not known.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Radiance.
    pub radiance: &'a Image<Vec3>,
    /// The variance of a pixel's radiance: that of the mean of its samples. Without it, the neighbourhood tells.
    pub variance: Option<&'a Image<Vec3>>,
    /// Albedo of the first surface, from 0 to 1.
    pub albedo: Option<&'a Image<Vec3>>,
    /// Unit normal of the first surface, averaged over the pixel; zero where there is none.
    pub normal: Option<&'a Image<Vec3>>,
    /// Depth of the first surface; infinite where there is none.
    pub depth: Option<&'a Image<f32>>,
}

impl Picture<'_> {
    /// Checks that images have one size, with a pixel at least.
    pub(crate) fn check(&self) -> Result<()> {
        let size = self.radiance.size();
        if size.contains(&0) {
            return Err(Error::Empty);
        }
        let images = [("variance", self.variance), ("albedo", self.albedo), ("normal", self.normal)];
        let known = images.into_iter().filter_map(|(what, image)| Some((what, image?.size())));
        known.chain(self.depth.map(|i| ("depth", i.size()))).try_for_each(|(what, found)| check_size(what, found, size))
    }

    /// Width and height in pixels.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.radiance.size().map(|n| n as usize)
    }

    /// True if a pixel shows a surface, or if that is not known.
    pub(crate) fn has_surface(&self, place: usize) -> bool {
        // A surface has a normal that is not zero and a finite depth, as far as either is known.
        let by_normal = self.normal.is_none_or(|i| i.values()[place] != Vec3::ZERO);
        by_normal && self.depth.is_none_or(|i| i.values()[place] < f32::INFINITY)
    }

    /// Divisor of a pixel's radiance: its albedo, at most 1 and not too small to divide by.
    pub(crate) fn factor(&self, place: usize) -> Vec3 {
        let held = |a: f32| if a > LEAST_ALBEDO { a.min(1.0) } else { LEAST_ALBEDO };
        self.albedo.map_or(Vec3::ONE, |i| Vec3::from_array(i.values()[place].to_array().map(held)))
    }

    /// Radiance over albedo, and its variance.
    pub(super) fn noisy(&self, features: &Features, lanes: Lanes) -> Estimate {
        let size = self.size();
        let place = |x: usize, y: usize| y * size[0] + x;
        let is_known = |place: usize| self.radiance.values()[place].is_finite();
        let hold_value = |v: f32| if v.is_finite() && v.abs() > LEAST { v.clamp(-MOST, MOST) } else { 0.0 };
        let mut channels = [0, 1, 2].map(|c| {
            // Demodulate by the albedo; the variance goes with its square.
            let over_albedo = |place: usize| hold_value(self.radiance.values()[place][c] / self.factor(place)[c]);
            let value = map(size, |x, y| if is_known(place(x, y)) { over_albedo(place(x, y)) } else { 0.0 });
            let variance = match self.variance {
                Some(image) => map(size, |x, y| {
                    let factor = self.factor(place(x, y))[c];
                    hold_value(image.values()[place(x, y)][c] / (factor * factor)).max(0.0)
                }),
                None => calm_variance(size, &value).into_iter().map(|v| CALMEST * v).collect(),
            };
            (value, variance)
        });
        hold(&mut channels, size, features, is_known, lanes);
        // Few samples tell variance poorly, and none where they all found the same; a pixel that a rare path hit keeps
        // its own. The mean of standard deviations is robust against single bright pixels, and the mean of variances at
        // the foot of a highlight would be that of its top.
        let roots = channels.each_ref().map(|(_, variance)| Plane::new(size, |place| variance[place].sqrt()));
        let sums = features.sums((SMOOTHED, 1.0), (roots.each_ref(), []), lanes);
        let channels = std::array::from_fn(|c| {
            let (value, variance) = &channels[c];
            let smoothed = |place: usize| {
                let root = sums[place].values[c] / sums[place].weight;
                if is_known(place) { variance[place].max(root * root) } else { UNKNOWN }
            };
            (value.clone(), map(size, |x, y| smoothed(place(x, y))))
        });
        // Pixels without a surface or a value count for no other.
        let counts = |place: usize| is_known(place) && self.has_surface(place);
        Estimate::new(size, channels, map(size, |x, y| f32::from(counts(place(x, y)))))
    }

    /// Radiance that is calculated with: held to the largest numbers, 0 where it is not finite.
    pub(crate) fn radiance_held(&self) -> Image<Vec3> {
        let [width, height] = self.radiance.size();
        Image::by_rows(width, height, |x, y| {
            let radiance = self.radiance.at(x, y);
            let held = radiance.clamp(Vec3::splat(-MOST), Vec3::splat(MOST));
            if radiance.is_finite() { held } else { Vec3::ZERO }
        })
    }

    /// Radiance again, of pixels with a surface, as much as there was where the mean is kept.
    pub(super) fn finish(&self, filtered: &Estimate, keeps_mean: bool) -> Denoised {
        let [width, height] = self.radiance.size();
        let is_bad = |place: usize| !self.radiance.values()[place].is_finite();
        // Multiply the albedo back; the background stays as it was.
        let mut radiance = Image::by_rows(width, height, |x, y| {
            let place = y as usize * width as usize + x as usize;
            if self.has_surface(place) || is_bad(place) {
                filtered.at(place) * self.factor(place)
            } else {
                self.radiance.values()[place]
            }
        });
        if keeps_mean {
            let counts = |place: usize| self.has_surface(place) && !is_bad(place);
            give_back(&mut radiance, &self.radiance_held(), self.variance, counts, GIVEN_BACK);
        }
        Denoised { radiance, not_finite: (0..width as usize * height as usize).filter(|p| is_bad(*p)).count() }
    }
}

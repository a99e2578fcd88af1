//! Sums of layers while samples are taken.

use crate::{BandSample, Bands, FirstHit, FirstHitSums, LayerInputs, MatteSums};
use std::ops::Range;
use steradian_math::Vec3;

/// Sums of layers over pixels, by rows. Each is empty where the layers that are asked for do not need it.
#[derive(Clone, Debug, Default)]
pub struct LayerSums {
    /// First hits ([`LayerInputs::FIRST_HITS`]).
    pub features: Vec<FirstHitSums>,
    /// Objects and materials that cover pixels ([`LayerInputs::MATTES`]).
    pub mattes: Vec<MatteSums>,
    /// Linear Rec.709 radiance of each part of the light, pixel by pixel: of groups of lights
    /// ([`LayerInputs::LIGHT_GROUPS`]), of numbers of scattering events ([`LayerInputs::BOUNCES`]), or of time bins.
    pub by_light: Vec<[f64; 3]>,
    /// Spectral radiance of each band of wavelengths, pixel by pixel ([`LayerInputs::BANDS`]).
    pub by_band: Vec<f64>,
}

impl LayerSums {
    /// Empty sums of so many pixels, parts of the light, and bands of wavelengths.
    pub fn new(inputs: LayerInputs, pixels: usize, parts: usize, bands: usize) -> Self {
        let of = |input| if inputs.has(input) { pixels } else { 0 };
        Self {
            features: vec![FirstHitSums::default(); of(LayerInputs::FIRST_HITS)],
            mattes: vec![MatteSums::default(); of(LayerInputs::MATTES)],
            by_light: vec![[0.0; 3]; pixels * parts],
            by_band: vec![0.0; pixels * bands],
        }
    }

    /// True if no layer depends on first hits.
    pub fn ignore_hits(&self) -> bool {
        self.features.is_empty() && self.mattes.is_empty()
    }

    /// Adds the first hit of a sample of a pixel.
    pub fn add_hit(&mut self, at: usize, hit: &FirstHit) {
        if let Some(features) = self.features.get_mut(at) {
            features.add(hit);
        }
        if let Some(mattes) = self.mattes.get_mut(at) {
            mattes.add(hit);
        }
    }

    /// Adds each part of the light of a sample of a pixel; values that are not finite count as black.
    pub fn add_lights(&mut self, at: usize, lights: &[Vec3]) {
        for (sum, light) in self.by_light[at * lights.len()..].iter_mut().zip(lights).filter(|(_, l)| l.is_finite()) {
            *sum = std::array::from_fn(|c| sum[c] + f64::from(light[c]));
        }
    }

    /// Adds the sums of further samples of all pixels.
    pub fn add_sums(&mut self, of: &Self) {
        self.features.iter_mut().zip(&of.features).for_each(|(sums, of)| sums.add_sums(of));
        self.mattes.iter_mut().zip(&of.mattes).for_each(|(sums, of)| sums.add_sums(of));
        for (sum, light) in self.by_light.iter_mut().zip(&of.by_light) {
            *sum = std::array::from_fn(|c| sum[c] + light[c]);
        }
        self.by_band.iter_mut().zip(&of.by_band).for_each(|(sum, of)| *sum += of);
    }

    /// Adds the light of a sample of a pixel to its bands.
    pub fn add_bands(&mut self, at: usize, bands: &Bands, sample: &BandSample) {
        let count = bands.count();
        if let Some(sums) = self.by_band.get_mut(at * count..(at + 1) * count) {
            bands.add(sample, sums);
        }
    }

    /// Copies a range of the pixels of other sums to the pixels from `to` on, of light in so many parts and bands.
    pub fn copy(&mut self, to: usize, from: &Self, range: Range<usize>, [parts, bands]: [usize; 2]) {
        fn part<T: Copy>(to: &mut [T], at: usize, from: &[T], range: Range<usize>) {
            if !from.is_empty() {
                to[at..at + range.len()].copy_from_slice(&from[range]);
            }
        }
        part(&mut self.features, to, &from.features, range.clone());
        part(&mut self.mattes, to, &from.mattes, range.clone());
        part(&mut self.by_light, to * parts, &from.by_light, range.start * parts..range.end * parts);
        part(&mut self.by_band, to * bands, &from.by_band, range.start * bands..range.end * bands);
    }

    /// First hits and mattes of a pixel alone.
    #[must_use]
    pub fn pixel(&self, at: usize) -> Self {
        Self {
            features: self.features.get(at).copied().into_iter().collect(),
            mattes: self.mattes.get(at).copied().into_iter().collect(),
            ..Self::default()
        }
    }
}

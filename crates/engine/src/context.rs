//! Context of a path.

use crate::Counters;
use steradian_core::{Scene, sampler::PixelSampler};
use steradian_math::spectra::Wavelengths;

/// The scene that a path is followed in, its random numbers and wavelengths, and what is counted.
#[derive(Debug)]
pub struct PathContext<'s, 'a> {
    /// The scene.
    pub scene: &'s Scene,
    /// The path's random numbers.
    pub sampler: &'a PixelSampler,
    /// The wavelengths that it carries; they lose the secondary ones where it disperses.
    pub lambda: &'a mut Wavelengths,
    /// Counters of the work.
    pub counters: &'a mut Counters,
}

impl<'s> PathContext<'s, '_> {
    /// The context of a branch, with random numbers of its own.
    #[inline]
    pub fn branch<'b>(&'b mut self, sampler: &'b PixelSampler) -> PathContext<'s, 'b> {
        PathContext { scene: self.scene, sampler, lambda: self.lambda, counters: self.counters }
    }
}

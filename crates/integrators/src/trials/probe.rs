//! Samples of a group of pixels for trials, by their luminance and cost.

use crate::{
    Counters,
    partition::{MAX_GROUP, Partition, Place, Window},
    path::PathTracer,
    precomputed::Precomputed,
    sharing::{self, GroupBuffer},
};
use steradian_core::{
    Scene,
    sampler::{Sampler, SamplerKind},
};
use steradian_engine::PixelSample;

/// A group of pixels that is tried.
pub(crate) struct Probe<'a, 's> {
    /// Its pixels on the film.
    pub places: Vec<Place>,
    partition: &'a Partition,
    pixel_samples: Vec<PixelSample>,
    buffer: GroupBuffer<'s>,
}

impl<'a, 's> Probe<'a, 's> {
    /// A group of a partition.
    pub fn new(scene: &Scene, partition: &'a Partition, window: Window) -> Self {
        let is_on_film = |p: &Place| p.x < scene.film().width && p.y < scene.film().height;
        let places = partition.places(window).filter(is_on_film).collect();
        Self { places, partition, pixel_samples: Vec::new(), buffer: GroupBuffer::default() }
    }

    /// One of the `of` samples of each pixel, spread over each other as those of a picture are: its luminance, zero
    /// where it is not finite, and the rays of all, to which the start of a path adds one.
    pub fn sample<const MEDIA: bool>(
        &mut self,
        path: &PathTracer<MEDIA>,
        scene: &'s Scene,
        precomputed: &Precomputed,
        seed: u64,
        (index, of): (u32, u32),
    ) -> ([f64; MAX_GROUP], f64) {
        if precomputed.stop.is_asked() {
            return ([0.0; MAX_GROUP], 0.0);
        }
        let sampler = Sampler { kind: SamplerKind::Sobol, spp: of, seed };
        self.pixel_samples.clear();
        self.pixel_samples
            .extend(self.places.iter().map(|p| PixelSample::at(scene, &sampler, self.partition, index, p).0));
        // The group as a render would take it; cost is the rays, and one for the start of each path.
        let mut counters = Counters::until(&precomputed.stop);
        sharing::group(path, scene, precomputed, &mut self.pixel_samples, &mut self.buffer, &mut counters);
        let mut light = [0.0; MAX_GROUP];
        for (light, pixel_sample) in light.iter_mut().zip(&self.pixel_samples) {
            let l = f64::from(
                scene.mode().luminance(pixel_sample.radiance, &pixel_sample.lambda) * scene.film().imaging_ratio,
            );
            *light = if l.is_finite() { l } else { 0.0 };
        }
        (light, (self.pixel_samples.len() as u64 + counters.rays) as f64)
    }
}

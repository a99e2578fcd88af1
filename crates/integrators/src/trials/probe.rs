//! Samples for trials, of groups of pixels or of pixels that share nothing, by their luminance and cost.

use crate::{
    Counters,
    partition::{MAX_GROUP, Partition, Place, Window},
    path::PathTracer,
    precomputed::Precomputed,
    sharing::{self, GroupBuffer},
    wave::{WaveBuffer, wave},
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
        Self {
            places: on_film(scene, partition, window).collect(),
            partition,
            pixel_samples: Vec::new(),
            buffer: GroupBuffer::default(),
        }
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
        light.iter_mut().zip(&self.pixel_samples).for_each(|(light, s)| *light = luminance(scene, s));
        (light, (self.pixel_samples.len() as u64 + counters.rays) as f64)
    }
}

/// The pixels of a window that are on the film.
pub(crate) fn on_film<'a>(
    scene: &Scene,
    partition: &'a Partition,
    window: Window,
) -> impl Iterator<Item = Place> + use<'a> {
    let (width, height) = (scene.film().width, scene.film().height);
    partition.places(window).filter(move |p| p.x < width && p.y < height)
}

/// Two independent samples of each of some pixels, which share nothing: the luminances of the first ones, then those of
/// the second ones, zero where not finite; and the rays of all, to which the start of a path adds one.
pub(crate) fn alone<'s, const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &Precomputed,
    (partition, places): (&Partition, &[Place]),
    buffer: &mut WaveBuffer<'s>,
) -> (Vec<f64>, f64) {
    let samplers = [0, 1].map(|seed| Sampler { kind: SamplerKind::Sobol, spp: 1, seed });
    let all = samplers.iter().flat_map(|sampler| places.iter().map(move |place| (sampler, place)));
    let mut samples: Vec<_> =
        all.map(|(sampler, place)| PixelSample::at(scene, sampler, partition, 0, place).0).collect();
    let mut counters = Counters::until(&precomputed.stop);
    if !precomputed.stop.is_asked() {
        wave(path, scene, precomputed, &mut samples, buffer, &mut counters);
    }
    (samples.iter().map(|s| luminance(scene, s)).collect(), (samples.len() as u64 + counters.rays) as f64)
}

/// Luminance of a sample, zero where it is not finite.
fn luminance(scene: &Scene, s: &PixelSample) -> f64 {
    let l = f64::from(scene.mode().luminance(s.radiance, &s.lambda) * scene.film().imaging_ratio);
    if l.is_finite() { l } else { 0.0 }
}

//! What trials take of a picture: samples of a group of pixels, by their luminance and cost.

use crate::{
    Counters,
    partition::{Partition, Place, Window},
    reuse::{MAX_GROUP, Room, Seat, Suffix},
    survey::Survey,
};
use steradian_core::{
    Scene,
    sampler::{Sampler, SamplerKind},
};

/// A group of pixels that is tried.
pub(crate) struct Probe<'a, 's> {
    /// Its pixels on the film.
    pub places: Vec<Place>,
    partition: &'a Partition,
    seats: Vec<Seat>,
    room: Room<'s>,
}

impl<'a, 's> Probe<'a, 's> {
    /// A group of a partition.
    pub fn new(scene: &Scene, partition: &'a Partition, window: Window) -> Self {
        let is_on_film = |p: &Place| p.x < scene.film.width && p.y < scene.film.height;
        let places = partition.places(window).filter(is_on_film).collect();
        Self { places, partition, seats: Vec::new(), room: Room::default() }
    }

    /// One of the `of` samples of each pixel, spread over each other as those of a picture are: its luminance, zero where it is not finite, and
    /// the rays of all, to which the start of a path adds one.
    pub fn sample<const MEDIA: bool, S: Suffix<MEDIA>>(
        &mut self,
        suffix: &S,
        scene: &'s Scene,
        survey: &Survey,
        seed: u64,
        (index, of): (u32, u32),
    ) -> ([f64; MAX_GROUP], f64) {
        if survey.stop.is_asked() {
            return ([0.0; MAX_GROUP], 0.0);
        }
        let sampler = Sampler { kind: SamplerKind::Sobol, spp: of, seed };
        self.seats.clear();
        self.seats.extend(self.places.iter().map(|p| Seat::at(scene, &sampler, self.partition, index, p).0));
        let mut counters = Counters::until(&survey.stop);
        suffix.group(scene, survey, &mut self.seats, &mut self.room, &mut counters);
        let mut light = [0.0; MAX_GROUP];
        for (light, seat) in light.iter_mut().zip(&self.seats) {
            let l = f64::from(scene.mode.luminance(seat.radiance, &seat.lambda) * scene.film.imaging_ratio);
            *light = if l.is_finite() { l } else { 0.0 };
        }
        (light, (self.seats.len() as u64 + counters.rays) as f64)
    }
}

//! Media that are the same everywhere, wholly in columns: flights to the next event, and scattering there.

use super::{
    Walk, Walker, WaveBuffer,
    block::{self, Block, attenuated, depart_from, is_black},
    lights::illuminate,
};
use crate::Counters;
use steradian_accel::{
    columns::{WIDTH, get3, get4, set3, set4},
    kernel,
};
use steradian_core::{Scene, medium::Medium, sampler::sobol_scramble, scene::Hit};
use steradian_engine::{PixelSample, dimension};
use steradian_math::{Spectrum, Vec2, Vec3, spectra::Wavelengths, warp};
use steradian_transport::{
    Depth,
    flight::{by_lane, homogeneous_flight, lanes},
    power_heuristic,
};

/// Outcome of a flight.
pub const PASSES: u32 = 0;
pub const SCATTERS: u32 = 1;
/// Nothing is carried on.
pub const IS_BLACK: u32 = 2;

impl<'s, const MEDIA: bool> Walk<'_, 's, MEDIA> {
    /// The medium of a path, if it is the same everywhere and scatters by one lobe of Henyey and Greenstein.
    #[inline]
    pub fn plain_medium(&self, walker: &Walker) -> Option<&'s Medium> {
        let medium = &self.scene.media()[walker.state.medium.filter(|_| MEDIA)? as usize];
        medium.plain_asymmetry().map(|_| medium)
    }

    /// Samples free flights of paths, up to a block of them, through such media: to scatter there, or to their hits.
    pub fn free_flights(
        &self,
        in_media: &[(u32, Option<Hit>)],
        buffer: &mut WaveBuffer<'s>,
        pixel_samples: &mut [PixelSample],
        counters: &mut Counters,
    ) {
        let WaveBuffer { block: b, walkers, shadows, .. } = &mut *buffer;
        // Coefficients, ray and length of each segment to the columns.
        for (k, (number, hit)) in in_media.iter().enumerate() {
            let (walker, sample) = (&walkers[*number as usize], &pixel_samples[*number as usize]);
            let Some(medium) = self.plain_medium(walker) else { continue };
            gather_medium(b, k, medium, (self.scene, &sample.lambda));
            b.gather_path(k, walker, self.scene, sample);
            b.is_in_medium[k] = 1;
            set3(&mut b.from, k, walker.state.ray.origin);
            b.end[k] = hit.as_ref().map_or(f32::INFINITY, |h| h.t);
        }
        flights(self.lanes, b);
        let mut any_scatters = false;
        for (k, (number, _)) in in_media.iter().enumerate() {
            // The flight's factor on the throughput, and its outcome.
            let Walker { state, goes_on, .. } = &mut walkers[*number as usize];
            state.beta = Spectrum::new(get4(&b.beta, k));
            *goes_on = b.flight[k] == PASSES;
            let scatters = b.flight[k] == SCATTERS && state.events < self.path.depth.max;
            b.takes_light[k] = scatters.into();
            any_scatters |= scatters;
        }
        let flight = b.flight;
        // Scattering in the medium: light sample, phase function and roulette, for the whole block.
        if any_scatters {
            block::numbers(self.lanes, b);
            let numbers = in_media.iter().map(|(number, _)| *number);
            illuminate(self.lanes, b, numbers.clone(), self.scene, pixel_samples);
            phases(self.lanes, b, self.path.depth);
            let scattered = numbers.enumerate().filter(|(k, _)| flight[*k] == SCATTERS);
            self.depart(b, scattered, walkers, pixel_samples, shadows);
        }
        // Flights that passed end at their surfaces.
        for ((number, hit), _) in in_media.iter().zip(flight).filter(|(_, flight)| *flight == PASSES) {
            self.meet_surface(*number, (*hit, true), buffer, pixel_samples, counters);
        }
    }
}

/// Fills the columns of a medium.
#[inline]
pub fn gather_medium(b: &mut Block, k: usize, medium: &Medium, (scene, lambda): (&Scene, &Wavelengths)) {
    let (sigma_a, sigma_s) = medium.coefficients(lambda);
    set4(&mut b.sigma_a, k, sigma_a.to_array());
    set4(&mut b.sigma_s, k, sigma_s.to_array());
    (b.asymmetry[k], b.lanes[k]) = (medium.plain_asymmetry().unwrap_or(0.0), lanes(scene, lambda) as u32);
}

kernel! {
    /// Flights to the hits: where they scatter, and what paths carry then.
    pub fn flights(b: &'a mut Block) {
        for k in 0..WIDTH {
            let (seed, reversed, event, passes) = (b.sampler[0][k], b.sampler[1][k], b.events[k], b.passes[k]);
            // The two numbers of a single path's flight, for lane and distance.
            let number = |decision: u32| {
                sobol_scramble(seed, dimension::at(event, decision) ^ (passes << 16)).point_1d(reversed)
            };
            let numbers = (number(dimension::LANE), number(dimension::FLIGHT));
            let coefficients = (get4(&b.sigma_a, k), get4(&b.sigma_s, k));
            let (t, factor) = homogeneous_flight(coefficients, b.lanes[k], b.end[k], numbers);
            let beta = get4(&b.beta, k);
            let beta = by_lane(|c| beta[c] * factor[c]);
            set4(&mut b.beta, k, beta);
            let most = beta[0].max(beta[1]).max(beta[2].max(beta[3]));
            let is_lost = if b.is_single[k] != 0 { beta[0] <= 0.0 } else { most <= 0.0 };
            b.flight[k] = if is_lost { IS_BLACK } else { u32::from(t.is_some()) };
            // The scattering point; it has no normal and no error bounds, and light from all sides.
            let t = t.unwrap_or(0.0);
            set3(&mut b.p, k, get3(&b.from, k) + get3(&b.direction, k) * t);
            set3(&mut b.error, k, Vec3::ZERO);
            set3(&mut b.n, k, Vec3::ZERO);
            set3(&mut b.light_n, k, Vec3::ZERO);
        }
    }
}

kernel! {
    /// Light and the sampled direction where media scatter.
    pub fn phases(b: &'a mut Block, depth: Depth) {
        for k in 0..WIDTH {
            let (wo, wi) = (-get3(&b.direction, k), get3(&b.light_wi, k));
            let (g, pdf, radiance) = (b.asymmetry[k], b.light_pdf[k], get4(&b.light_radiance, k));
            // Light sample: phase · L w / p, attenuated by the medium on the way.
            let phase = warp::hg_phase(wo.dot(wi), g);
            let weight = if b.light_is_delta[k] != 0 { 1.0 } else { power_heuristic(pdf, phase) };
            let factor = phase * weight / pdf;
            let light = attenuated(b, k, by_lane(|c| radiance[c] * factor));
            let beta = get4(&b.beta, k);
            set4(&mut b.light, k, by_lane(|c| beta[c] * light[c]));
            b.is_lit[k] = u32::from((pdf > 0.0) & !is_black(light));

            // Direction by Henyey and Greenstein's phase function, whose density is its value: the throughput stays.
            let (wi, pdf) = warp::sample_hg(wo, g, Vec2::new(b.bsdf_u[0][k], b.bsdf_u[1][k]));
            (b.is_drawn[k], b.pdf[k]) = (1, pdf);
            set3(&mut b.wi, k, wi);
            depart_from(b, k, &depth);
        }
    }
}

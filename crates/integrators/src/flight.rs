//! Flights through participating media: distances are drawn from the transmittance of one lane chosen at random and
//! weighted by the mean density over lanes; shadow rays are attenuated by Beer–Lambert through every interface and thin
//! pane on their way.

use crate::{Counters, MAX_PASSES, Stop, tracking};
use steradian_core::{
    ColorMode, Scene,
    medium::{Medium, transmittance},
};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths, warp};

/// What became of a flight through a medium.
pub(crate) enum Flight {
    /// Scattered at a distance; factor on the throughput.
    Scattered(f32, Spectrum),
    /// Reached the surface; factor on the throughput.
    Passed(Spectrum),
}

/// Lanes that carry something.
pub(crate) fn lanes(scene: &Scene, lambda: &Wavelengths) -> usize {
    match scene.mode {
        ColorMode::Rgb => 3,
        ColorMode::Spectral if lambda.is_secondary_terminated() => 1,
        ColorMode::Spectral => 4,
    }
}

/// Draws a free flight over at most `distance`.
pub(crate) fn sample_flight(
    scene: &Scene,
    medium: &Medium,
    distance: f32,
    lane: f32,
    u: f32,
    lambda: &Wavelengths,
) -> Flight {
    let lanes = lanes(scene, lambda);
    let (sigma_a, sigma_s) = medium.coefficients(lambda);
    let sigma_t = sigma_a + sigma_s;
    // Where nothing scatters the flight passes for sure.
    if (0..lanes).all(|l| sigma_s[l] == 0.0) {
        return Flight::Passed(transmittance(sigma_t, distance));
    }
    let chosen = sigma_t[((lane * lanes as f32) as usize).min(lanes - 1)];
    let t = if chosen > 0.0 { warp::exponential(u, chosen) } else { f32::INFINITY };
    let scatters = t < distance;
    let (value, pdf) = member_density(scene, medium, if scatters { t } else { distance }, scatters, lambda);
    let factor = if pdf > 0.0 { value / pdf } else { Spectrum::ZERO };
    if scatters { Flight::Scattered(t, factor) } else { Flight::Passed(factor) }
}

/// What passes a distance, to scatter at its end or not, and the density (per length where it scatters) with which
/// [`sample_flight`] finds it.
pub(crate) fn member_density(
    scene: &Scene,
    medium: &Medium,
    distance: f32,
    scatters: bool,
    lambda: &Wavelengths,
) -> (Spectrum, f32) {
    let lanes = lanes(scene, lambda);
    let mean = |s: Spectrum| (0..lanes).map(|l| s[l]).sum::<f32>() / lanes as f32;
    let (sigma_a, sigma_s) = medium.coefficients(lambda);
    let sigma_t = sigma_a + sigma_s;
    let tr = transmittance(sigma_t, distance);
    match scatters {
        true => (tr * sigma_s, mean(tr * sigma_t)),
        false if (0..lanes).all(|l| sigma_s[l] == 0.0) => (tr, 1.0),
        false => (tr, mean(tr)),
    }
}

/// Transmittance towards a light at a distance, before which `ray` ends: zero behind anything that scatters.
pub(crate) fn towards(
    scene: &Scene,
    ray: Ray,
    distance: f32,
    (medium, number): (Option<u32>, f32),
    lambda: &Wavelengths,
    counters: &mut Counters,
) -> Spectrum {
    if scene.is_see_through {
        return visibility(scene, ray, (medium, number), lambda, counters);
    }
    counters.rays += 1;
    if scene.occluded(&ray) {
        return Spectrum::ZERO;
    }
    medium.map_or(Spectrum::ONE, |m| passed(scene, m, (&ray, distance), number, lambda, &counters.stop))
}

/// What passes a distance through a medium: the transmittance, or where the medium varies an estimate of it that is a
/// function of the ray and of a random number.
pub(crate) fn passed(
    scene: &Scene,
    medium: u32,
    (ray, distance): (&Ray, f32),
    number: f32,
    lambda: &Wavelengths,
    stop: &Stop,
) -> Spectrum {
    let medium = &scene.media[medium as usize];
    match &medium.field {
        None => medium.transmittance(distance, lambda),
        Some(field) => tracking::estimate_transmittance(scene, (medium, field), ray, distance, number, lambda, stop),
    }
}

/// Transmittance through whatever light passes straight.
fn visibility(
    scene: &Scene,
    mut ray: Ray,
    (mut medium, number): (Option<u32>, f32),
    lambda: &Wavelengths,
    counters: &mut Counters,
) -> Spectrum {
    let mut t = Spectrum::ONE;
    for _ in 0..MAX_PASSES {
        if counters.stop.is_asked() {
            break;
        }
        counters.rays += 1;
        let hit = scene.intersect(&ray);
        if let Some(m) = medium {
            let distance = hit.as_ref().map_or(ray.t_max, |h| h.t);
            t *= passed(scene, m, (&ray, distance), number, lambda, &counters.stop);
            if t.is_black() {
                return t;
            }
        }
        let Some(hit) = hit else { return t };
        let i = scene.interaction_of_light(&ray, &hit);
        // Interfaces pass everything, thin panes a part; what bends or stops light blocks the way.
        if let Some((s, frame)) = scene.scattering(&i, 0.5, &mut lambda.clone()) {
            match s.bsdf.straight_transmission(frame.to_local(i.wo)) {
                Some(part) => t *= part,
                None => return Spectrum::ZERO,
            }
        }
        medium = scene.medium_towards(&i, ray.direction, medium);
        let next = i.spawn(ray.direction);
        // What is left of the way.
        let left = ray.t_max - (next.origin - ray.origin).length();
        if left <= 0.0 {
            return t;
        }
        ray = Ray { t_max: left, ..next };
    }
    Spectrum::ZERO
}

//! Flights through participating media: distances are drawn from the transmittance of one lane chosen at random and
//! weighted by the mean density over lanes.

use steradian_core::{
    ColorMode, Scene,
    medium::{Medium, transmittance},
};
use steradian_math::{Spectrum, spectra::Wavelengths, warp};

/// What became of a flight through a medium.
pub enum Flight {
    /// Scattered at a distance; factor on the throughput.
    Scattered(f32, Spectrum),
    /// Reached the surface; factor on the throughput.
    Passed(Spectrum),
}

/// Lanes that carry something.
pub fn lanes(scene: &Scene, lambda: &Wavelengths) -> usize {
    match scene.mode() {
        ColorMode::Rgb => 3,
        ColorMode::Spectral if lambda.is_secondary_terminated() => 1,
        ColorMode::Spectral => 4,
    }
}

/// Draws a free flight over at most `distance`.
pub fn sample_flight(scene: &Scene, medium: &Medium, distance: f32, lane: f32, u: f32, lambda: &Wavelengths) -> Flight {
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
    let (value, pdf) = flight_density(scene, medium, if scatters { t } else { distance }, scatters, lambda);
    let factor = if pdf > 0.0 { value / pdf } else { Spectrum::ZERO };
    if scatters { Flight::Scattered(t, factor) } else { Flight::Passed(factor) }
}

/// What passes a distance, to scatter at its end or not, and the density (per length where it scatters) with which
/// [`sample_flight`] finds it.
pub fn flight_density(
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

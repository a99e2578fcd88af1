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

/// The mean over so many lanes.
#[inline]
fn mean(s: Spectrum, lanes: usize) -> f32 {
    match lanes {
        1 => s[0],
        3 => (s[0] + s[1] + s[2]) / 3.0,
        _ => (s[0] + s[1] + s[2] + s[3]) / 4.0,
    }
}

/// Whether so many lanes are zero.
#[inline]
fn is_zero(s: Spectrum, lanes: usize) -> bool {
    s[0] == 0.0 && (lanes == 1 || s[1] == 0.0 && s[2] == 0.0 && (lanes == 3 || s[3] == 0.0))
}

/// Draws a free flight over at most `distance`.
#[inline]
pub fn sample_flight(scene: &Scene, medium: &Medium, distance: f32, lane: f32, u: f32, lambda: &Wavelengths) -> Flight {
    let lanes = lanes(scene, lambda);
    let coefficients = medium.coefficients(lambda);
    let sigma_t = coefficients.0 + coefficients.1;
    // Where nothing scatters the flight passes for sure.
    if is_zero(coefficients.1, lanes) {
        return Flight::Passed(transmittance(sigma_t, distance));
    }
    let chosen = match ((lane * lanes as f32) as usize).min(lanes - 1) {
        0 => sigma_t[0],
        1 => sigma_t[1],
        2 => sigma_t[2],
        _ => sigma_t[3],
    };
    let t = if chosen > 0.0 { warp::exponential(u, chosen) } else { f32::INFINITY };
    let scatters = t < distance;
    let (value, pdf) = density(coefficients, if scatters { t } else { distance }, scatters, lanes);
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
    density(medium.coefficients(lambda), distance, scatters, lanes(scene, lambda))
}

/// [`flight_density`] of coefficients of absorption and scattering.
#[inline]
fn density((sigma_a, sigma_s): (Spectrum, Spectrum), distance: f32, scatters: bool, lanes: usize) -> (Spectrum, f32) {
    let sigma_t = sigma_a + sigma_s;
    let tr = transmittance(sigma_t, distance);
    match scatters {
        true => (tr * sigma_s, mean(tr * sigma_t, lanes)),
        false if is_zero(sigma_s, lanes) => (tr, 1.0),
        false => (tr, mean(tr, lanes)),
    }
}

//! Flights through participating media. In homogeneous ones distances are drawn from the transmittance of one lane chosen at random and
//! weighted by the mean density over lanes.

use steradian_core::{
    ColorMode, Scene,
    medium::{Medium, beer_lambert, transmittance},
};
use steradian_math::{Spectrum, spectra::Wavelengths, warp};

/// Outcome of a flight through a medium.
pub enum Flight {
    /// Scattered at a distance; factor on the throughput.
    Scattered(f32, Spectrum),
    /// Reached the surface; factor on the throughput.
    Passed(Spectrum),
}

/// Lanes that carry something.
#[inline]
pub fn lanes(scene: &Scene, lambda: &Wavelengths) -> usize {
    match scene.mode() {
        ColorMode::Rgb => 3,
        ColorMode::Spectral if lambda.is_secondary_terminated() => 1,
        ColorMode::Spectral => 4,
    }
}

/// Numbers by lane.
type ByLane = [f32; 4];

/// A number for each lane.
#[inline(always)]
pub fn by_lane(f: impl Fn(usize) -> f32) -> ByLane {
    [f(0), f(1), f(2), f(3)]
}

/// The mean over so many lanes.
#[inline(always)]
fn mean(s: ByLane, lanes: u32) -> f32 {
    let three = s[0] + s[1] + s[2];
    let several = if lanes == 3 { three / 3.0 } else { (three + s[3]) / 4.0 };
    if lanes == 1 { s[0] } else { several }
}

/// True if so many lanes are zero.
#[inline(always)]
fn is_zero(s: ByLane, lanes: u32) -> bool {
    (s[0] == 0.0) & ((lanes == 1) | ((s[1] == 0.0) & (s[2] == 0.0) & ((lanes == 3) | (s[3] == 0.0))))
}

/// The one of so many lanes that a number chooses.
#[inline(always)]
fn chosen(s: ByLane, lane: f32, lanes: u32) -> f32 {
    // Selections instead of an index, so that the columns of a block need no table.
    let at = lane * lanes as i32 as f32;
    let low = if (lanes == 1) | (at < 1.0) { s[0] } else { s[1] };
    let high = if (lanes == 3) | (at < 3.0) { s[2] } else { s[3] };
    if (lanes == 1) | (at < 2.0) { low } else { high }
}

/// Free flight over at most a distance, where the coefficients of absorption and scattering are the same everywhere:
/// the distance at which it scatters, if it does, and the factor on the throughput.
#[inline(always)]
pub fn homogeneous_flight(
    (sigma_a, sigma_s): (ByLane, ByLane),
    lanes: u32,
    distance: f32,
    (lane, u): (f32, f32),
) -> (Option<f32>, ByLane) {
    let sigma_t = by_lane(|c| sigma_a[c] + sigma_s[c]);
    // Where nothing scatters the flight passes for sure.
    let only_absorbs = is_zero(sigma_s, lanes);
    // t = −ln(1 − u)/σt by the extinction of the lane that the random number chooses; infinite where that lane passes
    // all.
    let rate = chosen(sigma_t, lane, lanes);
    let t = if rate > 0.0 { warp::exponential(u, rate) } else { f32::INFINITY };
    // The flight scatters if it ends before the surface.
    let scatters = !only_absorbs & (t < distance);
    let end = if scatters { t } else { distance };
    // Tr = exp(−σt d) of every lane to the end of the flight.
    let tr = by_lane(|c| beer_lambert(sigma_t[c], end));
    // Density: σt Tr to scatter there, Tr to pass; value: σs Tr and Tr.
    let density = by_lane(|c| if scatters { tr[c] * sigma_t[c] } else { tr[c] });
    let value = by_lane(|c| if scatters { tr[c] * sigma_s[c] } else { tr[c] });
    // Single-sample MIS over lanes (balance heuristic): the density is the mean over all lanes that might have been
    // chosen.
    let pdf = if only_absorbs { 1.0 } else { mean(density, lanes) };
    let factor = by_lane(|c| if pdf > 0.0 { value[c] / pdf } else { 0.0 });
    (if scatters { Some(t) } else { None }, factor)
}

/// Draws a free flight over at most `distance`.
#[inline]
pub fn sample_flight(scene: &Scene, medium: &Medium, distance: f32, lane: f32, u: f32, lambda: &Wavelengths) -> Flight {
    let (a, s) = medium.coefficients(lambda);
    let lanes = lanes(scene, lambda) as u32;
    let (t, factor) = homogeneous_flight((a.to_array(), s.to_array()), lanes, distance, (lane, u));
    let factor = Spectrum::new(factor);
    t.map_or(Flight::Passed(factor), |t| Flight::Scattered(t, factor))
}

/// Transmittance of a distance, times σs if the flight scatters at its end, and the density (per length where it
/// scatters) with which [`sample_flight`] finds it.
#[inline]
pub fn flight_density(
    scene: &Scene,
    medium: &Medium,
    distance: f32,
    scatters: bool,
    lambda: &Wavelengths,
) -> (Spectrum, f32) {
    let (sigma_a, sigma_s) = medium.coefficients(lambda);
    let (sigma_t, lanes) = (sigma_a + sigma_s, lanes(scene, lambda) as u32);
    let tr = transmittance(sigma_t, distance);
    match scatters {
        true => (tr * sigma_s, mean((tr * sigma_t).to_array(), lanes)),
        false if is_zero(sigma_s.to_array(), lanes) => (tr, 1.0),
        false => (tr, mean(tr.to_array(), lanes)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each lane is drawn by an equal part of the numbers, and of a medium in which one lane alone is dense a flight
    /// goes as far as that lane says.
    #[test]
    fn lanes_are_drawn_evenly() {
        let sigma = [1.0, 2.0, 3.0, 4.0];
        for lanes in [1, 3, 4] {
            for k in 0..lanes {
                let most = f32::from_bits(((k + 1) as f32 / lanes as f32).to_bits() - 1);
                for lane in [k as f32 / lanes as f32 + 1e-6, (k as f32 + 0.5) / lanes as f32, most - 1e-6] {
                    assert_eq!(chosen(sigma, lane, lanes), sigma[k as usize], "{lane} of {lanes}");
                    let (t, _) = homogeneous_flight(([0.0; 4], sigma), lanes, f32::INFINITY, (lane, 0.5));
                    assert_eq!(t, Some(warp::exponential(0.5, sigma[k as usize])));
                }
            }
        }
    }

    /// Over all numbers a flight carries as much as it would without scattering, and scatters the rest, in each lane.
    #[test]
    fn flights_bring_what_is_there() {
        let (a, s, distance, n) = ([0.3, 0.0, 0.1, 0.0], [0.2, 0.9, 0.4, 0.0], 1.7, 300);
        for lanes in [1, 3] {
            let (mut passed_sum, mut scattered_sum) = ([0.0; 4], [0.0; 4]);
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let numbers = ((i as f32 + 0.5) / n as f32, (j as f32 + 0.5) / n as f32);
                let (t, factor) = homogeneous_flight((a, s), lanes, distance, numbers);
                let sum = if t.is_some() { &mut scattered_sum } else { &mut passed_sum };
                (0..4).for_each(|c| sum[c] += f64::from(factor[c]) / f64::from(n * n));
            }
            for c in 0..lanes as usize {
                let t = f64::from(a[c] + s[c]);
                let passes = (-t * f64::from(distance)).exp();
                assert!((passed_sum[c] - passes).abs() < 3e-3, "{} for {passes}", passed_sum[c]);
                let scatters = f64::from(s[c]) / t * (1.0 - passes);
                assert!((scattered_sum[c] - scatters).abs() < 3e-3, "{} for {scatters}", scattered_sum[c]);
            }
        }
    }
}

//! The integrating sphere: which part of the light from a direction is reflected and transmitted.

use crate::{Specimen, direction};
use rayon::prelude::*;
use serde::Serialize;
use steradian_core::bsdf::TransportMode;
use steradian_math::{Spectrum, Vec2, sobol::shuffled_scrambled_sobol_4d};

/// Directional–hemispherical reflectance and transmittance.
#[derive(Clone, Debug, Serialize)]
pub struct Albedo {
    /// Angle of the light from the normal, degrees.
    pub theta: f64,
    /// Part of the power that is reflected, lane by lane.
    pub reflectance: Vec<f32>,
    /// Part of the power that is transmitted, lane by lane.
    pub transmittance: Vec<f32>,
    /// Standard error of the sum's largest lane, as of independent samples (an upper bound in practice).
    pub error: f32,
}

/// Measures at an angle (degrees; beyond 90 from below) in the plane of the tangent, from so many samples.
pub fn albedo(specimen: &Specimen<'_>, theta: f64, samples: u32) -> Albedo {
    let wo = direction(theta, 0.0);
    let chunk = 4096;
    // Summed in order of chunks: the same number on any number of threads.
    let parts: Vec<[Spectrum; 3]> = (0..samples.div_ceil(chunk))
        .into_par_iter()
        .map(|c| {
            let mut sums = [Spectrum::ZERO; 3];
            for i in c * chunk..((c + 1) * chunk).min(samples) {
                let [choice, u, x, y] = shuffled_scrambled_sobol_4d(i, 7);
                let Some(s) = specimen.sample(wo, choice, u, Vec2::new(x, y), TransportMode::Importance) else {
                    continue;
                };
                sums[usize::from(s.lobe.is_transmission())] += s.weight;
                sums[2] += s.weight * s.weight;
            }
            sums
        })
        .collect();
    let [r, t, squares] = parts.iter().fold([Spectrum::ZERO; 3], |a, b| std::array::from_fn(|i| a[i] + b[i]));
    let n = samples as f32;
    let mean = (r + t) / n;
    let variance = (squares / n - mean * mean).max(0.0).max_element();
    Albedo {
        theta,
        reflectance: specimen.lanes(r / n),
        transmittance: specimen.lanes(t / n),
        error: (variance / n).sqrt(),
    }
}

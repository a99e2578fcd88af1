//! The integrating sphere: which part of the light from a direction is reflected and transmitted.

use crate::{Specimen, furnace::Furnace};
use rayon::prelude::*;
use serde::Serialize;
use steradian_math::Spectrum;

/// Directional–hemispherical reflectance and transmittance. Of a fibre hemispherical–directional ones, in the mean over
/// its width: the parts of even light before it and behind it that a viewer sees.
#[derive(Clone, Debug, Serialize)]
pub struct Albedo {
    /// Angle of the light from the normal, degrees; of a fibre that of the viewer from the plane across it.
    pub theta: f64,
    /// Part of the power that is reflected, lane by lane.
    pub reflectance: Vec<f32>,
    /// Part of the power that is transmitted, lane by lane.
    pub transmittance: Vec<f32>,
    /// Standard error of the sum's largest lane, as of independent samples (an upper bound in practice).
    pub error: f32,
}

/// Angles at which energy is watched, degrees from the normal: models gain it towards grazing.
pub const WATCHED: [f64; 9] = [0.0, 10.0, 20.0, 45.0, 60.0, 75.0, 80.0, 85.0, 89.0];
/// The gain that rounding may make.
const ROUNDING: f32 = 1e-4;

impl Albedo {
    /// The part that leaves on both sides, of the lane with most of it.
    pub fn total(&self) -> f32 {
        self.reflectance.iter().zip(&self.transmittance).map(|(r, t)| r + t).fold(0.0, f32::max)
    }

    /// No lane gains energy, beyond four standard errors.
    pub fn conserves_energy(&self) -> bool {
        self.total() <= 1.0 + ROUNDING + 4.0 * self.error
    }
}

/// Measures at an angle (degrees; beyond 90 from below) in the plane of the tangent, or along a fibre, from so many
/// samples.
pub fn albedo(specimen: &Specimen<'_>, theta: f64, samples: u32) -> Albedo {
    let furnace = Furnace::new(specimen);
    let chunk = 4096;
    // Summed in order of chunks: the same number on any number of threads.
    let parts: Vec<[[f64; 4]; 3]> = (0..samples.div_ceil(chunk))
        .into_par_iter()
        .map(|c| {
            let mut sums = [[0.0; 4]; 3];
            for i in c * chunk..((c + 1) * chunk).min(samples) {
                let Some(s) = furnace.sample(theta, i, 7) else { continue };
                for (lane, w) in s.weight.to_array().into_iter().map(f64::from).enumerate() {
                    sums[usize::from(s.lobe.is_transmission())][lane] += w;
                    sums[2][lane] += w * w;
                }
            }
            sums
        })
        .collect();
    let n = f64::from(samples);
    let mean = |k: usize| -> [f64; 4] { std::array::from_fn(|l| parts.iter().map(|p| p[k][l]).sum::<f64>() / n) };
    let [r, t, squares] = [0, 1, 2].map(mean);
    let variance = (0..4).map(|l| (squares[l] - (r[l] + t[l]).powi(2)).max(0.0)).fold(0.0, f64::max);
    let lanes = |v: [f64; 4]| specimen.lanes(Spectrum::new(v.map(|v| v as f32)));
    Albedo { theta, reflectance: lanes(r), transmittance: lanes(t), error: (variance / n).sqrt() as f32 }
}

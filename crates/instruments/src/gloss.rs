//! The glossmeter of ISO 2813: 20°, 60° and 85°, in gloss units.
//!
//! A source seen under 0.75° × 2.5° lights the specimen; a receptor of the standard's angular size around the mirror
//! direction collects what comes back. 100 gloss units are what polished black glass of index 1.567 sends there; the
//! index of the primary standard. Simplified: the lens system is ideal, light is unpolarised, and of its spectrum only
//! the luminance counts.

use crate::{Specimen, direction};
use rayon::prelude::*;
use serde::Serialize;
use steradian_bsdf::{TransportMode, fresnel};
use steradian_math::{
    Frame, Vec2, Vec3,
    sobol::{shuffled_scrambled_sobol_2d, shuffled_scrambled_sobol_4d},
};

/// Index of refraction of the glass that has 100 gloss units.
pub const BLACK_GLASS: f32 = 1.567;

/// A geometry of the standard: angle, and the receptor's aperture in and across the plane of incidence, degrees.
pub const GEOMETRIES: [(f64, f64, f64); 3] = [(20.0, 1.8, 3.6), (60.0, 4.4, 11.7), (85.0, 4.0, 6.0)];

/// The image of the source, in and across the plane of incidence, degrees.
const SOURCE: (f64, f64) = (0.75, 2.5);

/// A reading.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Gloss {
    /// Angle from the normal, degrees.
    pub theta: f64,
    /// Gloss units.
    pub units: f64,
    /// Standard error of them, as of independent samples.
    pub error: f64,
}

/// Reads the glossmeter at one of its geometries.
pub fn gloss(specimen: &Specimen<'_>, (theta, along, across): (f64, f64, f64), samples: u32) -> Gloss {
    let mirror = direction(theta, 180.0);
    // In the plane of incidence, and across it.
    let axes = Frame { x: Vec3::Y.cross(mirror), y: Vec3::Y, z: mirror };
    let inside = |w: Vec3| {
        let l = axes.to_local(w);
        let angle = |v: f32| f64::from(v.atan2(l.z)).to_degrees().abs();
        l.z > 0.0 && angle(l.x) <= along / 2.0 && angle(l.y) <= across / 2.0
    };
    let chunk = 4096;
    let parts: Vec<(f64, f64)> = (0..samples.div_ceil(chunk))
        .into_par_iter()
        .map(|c| {
            let mut sums = (0.0, 0.0);
            for i in c * chunk..((c + 1) * chunk).min(samples) {
                let [choice, u, x, y] = shuffled_scrambled_sobol_4d(i, 11);
                let [sx, sy] = shuffled_scrambled_sobol_2d(i, 13);
                let from = direction(theta + SOURCE.0 * (f64::from(sx) - 0.5), 0.0);
                let side = (SOURCE.1 * (f64::from(sy) - 0.5)).to_radians().tan() as f32;
                let wo = (from + Vec3::Y * side).normalize();
                let Some(s) = specimen.sample(wo, choice, u, Vec2::new(x, y), TransportMode::Importance) else {
                    continue;
                };
                if inside(s.wi) {
                    let w = f64::from(specimen.luminance(s.weight));
                    sums = (sums.0 + w, sums.1 + w * w);
                }
            }
            sums
        })
        .collect();
    let (sum, squares) = parts.iter().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    let n = f64::from(samples);
    let standard = f64::from(fresnel::dielectric(theta.to_radians().cos() as f32, BLACK_GLASS));
    let mean = sum / n;
    let error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
    Gloss { theta, units: 100.0 * mean / standard, error: 100.0 * error / standard }
}

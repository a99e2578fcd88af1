//! A material at a glance: its lobes, what it reflects and transmits of white light, whether it makes light.

use crate::{
    Specimen,
    albedo::{Albedo, WATCHED, albedo},
    furnace::Furnace,
};
use serde::Serialize;
use steradian_bsdf::Lobe;
use steradian_math::Spectrum;

/// Angles from the normal at which white light is told, degrees.
pub const ANGLES: [f64; 3] = [WATCHED[TOLD[0]], WATCHED[TOLD[1]], WATCHED[TOLD[2]]];
/// Their places among the watched angles: 0°, 45° and 80°.
const TOLD: [usize; 3] = [0, 3, 6];
/// Draws that look for lobes, at each angle.
const DRAWS: u32 = 4096;

/// A kind of scattering that was met.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Met {
    /// Such as `glossy reflection`.
    pub name: String,
    /// Its part of the light that is scattered at 45°.
    pub share: f64,
}

/// White light at an angle: the mean over lanes by their luminance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct White {
    /// Angle from the normal, degrees.
    pub theta: f64,
    /// The part that is reflected.
    pub reflectance: f32,
    /// The part that is transmitted.
    pub transmittance: f32,
}

/// Summary of a material.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Its lobes, the strongest at 45° first.
    pub lobes: Vec<Met>,
    /// White light at 0°, 45° and 80°.
    pub white: [White; 3],
    /// True if light is transmitted.
    pub is_transmitting: bool,
    /// True if no lane gains energy at any angle that was tried, beyond four standard errors.
    pub conserves_energy: bool,
    /// The largest part of a lane that is scattered, at the angle that was tried.
    pub largest_albedo: f32,
}

/// Looks at a specimen from its front with so many samples for each angle.
pub fn summary(specimen: &Specimen<'_>, samples: u32) -> Summary {
    let lobes = lobes(specimen);
    let watched = WATCHED.map(|theta| albedo(specimen, theta, samples));
    Summary {
        white: TOLD.map(|k| {
            let a = &watched[k];
            let [reflectance, transmittance] = [&a.reflectance, &a.transmittance].map(|v| specimen.luminance(value(v)));
            White { theta: a.theta, reflectance, transmittance }
        }),
        is_transmitting: watched.iter().any(|a| a.transmittance.iter().any(|t| *t > 0.0)),
        conserves_energy: watched.iter().all(Albedo::conserves_energy),
        largest_albedo: watched.iter().map(Albedo::total).fold(0.0, f32::max),
        lobes,
    }
}

/// The value of lanes.
fn value(lanes: &[f32]) -> Spectrum {
    let mut all = [0.0; 4];
    all.iter_mut().zip(lanes).for_each(|(v, lane)| *v = *lane);
    Spectrum::new(all)
}

fn lobes(specimen: &Specimen<'_>) -> Vec<Met> {
    let (mut met, furnace): (Vec<Met>, _) = (Vec::new(), Furnace::new(specimen));
    for theta in ANGLES {
        for i in 0..DRAWS {
            let Some(s) = furnace.sample(theta, i, 5) else { continue };
            let power = f64::from(specimen.luminance(s.weight));
            if power <= 0.0 {
                continue;
            }
            let share = if theta == 45.0 { power } else { 0.0 };
            let name = name(s.lobe);
            match met.iter_mut().find(|m| m.name == name) {
                Some(seen) => seen.share += share,
                None => met.push(Met { name, share }),
            }
        }
    }
    let sum: f64 = met.iter().map(|m| m.share).sum();
    met.iter_mut().for_each(|m| m.share /= sum.max(f64::MIN_POSITIVE));
    met.sort_by(|a, b| b.share.total_cmp(&a.share));
    met
}

fn name(lobe: Lobe) -> String {
    if lobe.contains(Lobe::SUBSURFACE) {
        return "subsurface scattering".into();
    }
    let how = if lobe.is_specular() {
        "specular"
    } else if lobe.is_diffuse() {
        "diffuse"
    } else {
        "glossy"
    };
    format!("{how} {}", if lobe.is_transmission() { "transmission" } else { "reflection" })
}

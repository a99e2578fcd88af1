//! The virtual gonioreflectometer: a table of a material's values, and the scattering of a piece of geometry as if it
//! were one.

use crate::{Specimen, TransportMode, direction};
use rayon::prelude::*;
use steradian_bsdf::measured::angles;
use steradian_core::Scene;
use steradian_math::{Frame, Ray, Vec2, Vec3, hash::HashRng, spectra::Wavelengths};

/// The luminance of `f` as a table of angles that the material `measured` reads: steps of the angle from the normal and
/// of the azimuth, and the incident azimuths, in degrees; one azimuth for isotropic materials.
pub fn table(specimen: &Specimen<'_>, steps: [f64; 2], azimuths: &[f64]) -> String {
    angles::write(steps, azimuths, |ti, pi, to, po| {
        // At 90° nothing arrives: the value just before stands in.
        let (wo, wi) = (direction(to.min(89.5), po), direction(ti.min(89.5), pi));
        let e = specimen.eval(wo, wi, TransportMode::Importance);
        f64::from(specimen.luminance(e.value)) / f64::from(wi.z)
    })
}

/// Bins of outgoing directions: rings of equal projected solid angle, sectors of azimuth.
#[derive(Clone, Copy, Debug)]
pub struct Bins {
    /// Rings from the normal to the horizon.
    pub rings: usize,
    /// Sectors around.
    pub sectors: usize,
}

impl Bins {
    fn of(&self, w: Vec3) -> usize {
        let ring = ((1.0 - w.z * w.z) * self.rings as f32) as usize;
        let turn = w.y.atan2(w.x) / std::f32::consts::TAU;
        let sector = ((turn - turn.floor()) * self.sectors as f32) as usize;
        ring.min(self.rings - 1) * self.sectors + sector.min(self.sectors - 1)
    }
}

/// Light from one direction reflected by a piece of geometry.
#[derive(Clone, Debug)]
pub struct Scattered {
    /// Mean `f` (sr⁻¹) in each bin, and its standard error.
    pub f: Vec<(f64, f64)>,
    /// Mean `f` (sr⁻¹) in each bin of light that met the geometry once only.
    pub single: Vec<f64>,
    /// The part of all light that is reflected.
    pub albedo: f64,
}

/// Lights the middle of a scene's geometry (up is +z) from a direction `wi` and follows the light up to so many events,
/// without the scene's lights. Rays enter over the middle half of the bounds, so that the rim is not seen; those that
/// leave through the sides without meeting anything do not count, light that leaves downwards is lost.
pub fn geometry(scene: &Scene, wi: Vec3, bins: Bins, rays: u32, max_events: u32) -> Scattered {
    let bounds = scene.bounds();
    let (centre, extent) = (0.5 * (bounds.min + bounds.max), bounds.max - bounds.min);
    let lambda = Wavelengths::at([450.0, 550.0, 600.0, 650.0]);
    let count = bins.rings * bins.sectors;
    let chunk = 1 << 13;
    let parts: Vec<(Vec<[f64; 3]>, u32)> = (0..rays.div_ceil(chunk))
        .into_par_iter()
        .map(|c| {
            let (mut sums, mut met) = (vec![[0.0; 3]; count], 0);
            let mut rng = HashRng::new(u64::from(c));
            for _ in c * chunk..((c + 1) * chunk).min(rays) {
                let spot = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, 0.0) * 0.5;
                let target = Vec3::new(centre.x, centre.y, bounds.max.z) + spot * extent;
                let ray = Ray::new(target + wi * (extent.length() + 1.0), -wi);
                let foot = target - wi * (extent.z / wi.z) - centre;
                let over_edge = foot.x.abs() > 0.5 * extent.x || foot.y.abs() > 0.5 * extent.y;
                if over_edge && scene.intersect(&ray).is_none() {
                    continue;
                }
                met += 1;
                if let Some((w, weight, events)) = follow(scene, ray, lambda, max_events, &mut rng) {
                    let bin = &mut sums[bins.of(w)];
                    bin[0] += weight;
                    bin[1] += weight * weight;
                    bin[2] += if events == 1 { weight } else { 0.0 };
                }
            }
            (sums, met)
        })
        .collect();
    // ∫cosθ dω over a bin of equal projected solid angle.
    let n = f64::from(parts.iter().map(|p| p.1).sum::<u32>().max(1));
    let area = std::f64::consts::PI / count as f64;
    let sums: Vec<[f64; 3]> =
        (0..count).map(|b| parts.iter().fold([0.0; 3], |s, p| std::array::from_fn(|i| s[i] + p.0[b][i]))).collect();
    let error = |s: &[f64; 3]| ((s[1] / n - (s[0] / n).powi(2)).max(0.0) / n).sqrt();
    Scattered {
        f: sums.iter().map(|s| (s[0] / n / area, error(s) / area)).collect(),
        single: sums.iter().map(|s| s[2] / n / area).collect(),
        albedo: sums.iter().map(|s| s[0] / n).sum(),
    }
}

/// Bins of [`geometry_table`]: about 6° where light leaves half way.
const TABLE_BINS: Bins = Bins { rings: 16, sectors: 36 };

/// Step of incident and outgoing angles of [`geometry_table`], degrees.
const TABLE_STEP: f64 = 7.5;

/// A table of angles, as [`table`], of what a scene's geometry scatters: for each incident direction so many rays,
/// counted in bins.
pub fn geometry_table(scene: &Scene, azimuths: &[f64], rays: u32, max_events: u32) -> String {
    let thetas = (90.0 / TABLE_STEP) as usize + 1;
    let seen: Vec<Scattered> = (0..thetas * azimuths.len())
        .map(|i| {
            let theta = (i / azimuths.len()) as f64 * TABLE_STEP;
            geometry(scene, direction(theta.min(89.5), azimuths[i % azimuths.len()]), TABLE_BINS, rays, max_events)
        })
        .collect();
    angles::write([TABLE_STEP, 10.0], azimuths, |ti, pi, to, po| {
        let row = (ti / TABLE_STEP).round() as usize * azimuths.len();
        let column = azimuths.iter().position(|a| *a == pi).unwrap_or(0);
        seen[row + column].f[TABLE_BINS.of(direction(to.min(89.5), po))].0
    })
}

/// The direction in which light leaves upwards, its power, and how often it was scattered.
fn follow(
    scene: &Scene,
    mut ray: Ray,
    mut lambda: Wavelengths,
    max_events: u32,
    rng: &mut HashRng,
) -> Option<(Vec3, f64, u32)> {
    let mut power = 1.0;
    for events in 0..=max_events {
        let Some(hit) = scene.intersect(&ray) else {
            return (events > 0 && ray.direction.z > 0.0).then_some((ray.direction, power, events));
        };
        if events == max_events {
            return None;
        }
        let i = scene.interaction(&ray, &hit);
        let (s, frame): (_, Frame) = scene.scattering(&i, rng.next_f32(), &mut lambda)?;
        let u2 = Vec2::new(rng.next_f32(), rng.next_f32());
        let drawn = s.bsdf.sample(frame.to_local(i.wo), rng.next_f32(), u2, TransportMode::Importance)?;
        power *= f64::from(steradian_math::color::luminance(Vec3::from(drawn.weight.to_rgb())));
        ray = i.spawn(frame.to_world(drawn.wi));
    }
    None
}

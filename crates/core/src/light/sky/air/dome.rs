//! The sky that air makes: tables by direction.

use super::{
    Air,
    data::{self, BANDS, Bands},
    medium::{Medium, aerosols},
    moments,
    orders::{FEW, Orders, SPARSE, pass, passed},
    path::{Sunward, Way, horizon},
};
use crate::light::sky::{body::CelestialBody, cells::Cells};
use rayon::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI};
use steradian_math::{
    Frame, Spectrum, Vec2, Vec3,
    color::luminance,
    spectra::{ColorMode, Wavelengths},
};

/// Directions over half a turn from the sun's azimuth, and from the horizon up to the zenith, dense near the horizon.
const COLUMNS: usize = 49;
const ROWS: usize = 64;
/// Pieces of ways on either side of the place nearest to the ground.
const PIECES: usize = 32;
/// Number of terms of the light from a direction: scattering by molecules is `a + b cos²` of the angle from the sun,
/// and `a` includes multiple scattering; aerosols have a phase function of their own.
const TERMS: usize = 3;

/// Radiance without phase functions by direction.
type Sight = [Bands; TERMS];

/// The sky without the sun.
#[derive(Clone, Debug)]
pub struct AirDome {
    /// `z` up, the sun's azimuth along `x`.
    frame: Frame,
    sun: Vec3,
    /// Dip of the horizon below the horizontal, radians.
    dip: f32,
    g: f32,
    /// `[row][column][term][band]`, where RGB has three bands.
    table: Vec<f32>,
    bands: usize,
    mode: ColorMode,
    cells: Cells,
}

/// Four directions of the table around one, with their weights.
type Corners = [(usize, f32); 4];

impl AirDome {
    /// The sky of some air.
    pub fn new(air: &Air) -> Self {
        let medium = air.medium();
        // Tabulate radiance over elevation and azimuth from the sun; phase functions are applied at lookup.
        let sights = sights(&medium, air);
        let frame = Frame::from_zx(air.up, air.sun);
        let dip = -(horizon(medium.radius, air.altitude_km()).asin() as f32);
        let rgb = data::rgb_of_bands();
        let bands = if air.mode == ColorMode::Rgb { 3 } else { BANDS };
        let table = match air.mode {
            ColorMode::Spectral => sights.iter().flatten().flatten().copied().collect(),
            // In RGB mode the integral over wavelengths is precomputed, band by band.
            ColorMode::Rgb => {
                let colour = |b: &Bands| (0..BANDS).map(|i| rgb[i] * b[i]).sum::<Vec3>().to_array();
                sights.iter().flatten().flat_map(colour).collect()
            }
        };
        let brightness = rgb.map(luminance);
        let y = |b: &Bands| b.iter().zip(&brightness).map(|(v, y)| v * y).sum::<f32>();
        let bright: Vec<f32> = sights.iter().flatten().map(y).collect();
        let g = medium.g;
        // Importance: the luminance of the finished sky by cells.
        let cells = Cells::new(frame, dip, |w| {
            let d = frame.to_local(w);
            corners(d, dip).map_or(0.0, |c| mixed(&bright, 1, &c, &weights(w.dot(air.sun), g), 0))
        });
        Self { frame, sun: air.sun, dip, g, table, bands, mode: air.mode, cells }
    }
}

impl CelestialBody for AirDome {
    fn radiance(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        let Some(corners) = corners(self.frame.to_local(w), self.dip) else { return Spectrum::ZERO };
        // Mix the terms at the direction, with the phase functions of its angle from the sun.
        let weights = weights(w.dot(self.sun), self.g);
        let value = |b: usize| mixed(&self.table, self.bands, &corners, &weights, b);
        match self.mode {
            ColorMode::Rgb => Spectrum::rgb(value(0).max(0.0), value(1).max(0.0), value(2).max(0.0)),
            ColorMode::Spectral => data::at_wavelengths(lambda, value),
        }
    }

    fn sample(&self, u: Vec2) -> (Vec3, f32) {
        self.cells.sample(u)
    }

    fn pdf(&self, w: Vec3) -> f32 {
        self.cells.pdf(w)
    }

    fn fluence(&self) -> f32 {
        self.cells.fluence()
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.table[..]) + self.cells.bytes()
    }
}

/// Factors on the terms at a cosine with the direction to the sun.
fn weights(nu: f32, g: f32) -> [f32; TERMS] {
    // Rayleigh scattering splits into 1 and cos²; aerosols have their own phase function.
    [1.0, nu * nu, aerosols(g, nu.clamp(-1.0, 1.0))]
}

/// A band at a direction between those of the table.
#[inline]
fn mixed(table: &[f32], bands: usize, corners: &Corners, weights: &[f32; TERMS], band: usize) -> f32 {
    let at = |i: usize, term: usize| table[(i * TERMS + term) * bands + band];
    corners.iter().map(|&(i, w)| w * (0..TERMS).map(|t| weights[t] * at(i, t)).sum::<f32>()).sum()
}

/// The directions of the table around a direction of the sky's frame; `None` below the horizon.
fn corners(d: Vec3, dip: f32) -> Option<Corners> {
    let above = d.z.clamp(-1.0, 1.0).asin() + dip;
    if above < 0.0 {
        return None;
    }
    // Square-root spacing towards the horizon, linear in azimuth.
    let y = (above / (FRAC_PI_2 + dip)).min(1.0).sqrt() * (ROWS - 1) as f32;
    let x = d.y.abs().atan2(d.x) / PI * (COLUMNS - 1) as f32;
    let (i, j) = ((y as usize).min(ROWS - 2), (x.max(0.0) as usize).min(COLUMNS - 2));
    let (s, t) = (y - i as f32, x - j as f32);
    let at = i * COLUMNS + j;
    Some([
        (at, (1.0 - s) * (1.0 - t)),
        (at + 1, (1.0 - s) * t),
        (at + COLUMNS, s * (1.0 - t)),
        (at + COLUMNS + 1, s * t),
    ])
}

/// The table for the sun's spectrum.
fn sights(medium: &Medium, air: &Air) -> Vec<Sight> {
    let height = air.altitude_km();
    let mu_sun = f64::from(air.sun.dot(air.up)).clamp(-1.0, 1.0);
    let sin_sun = (1.0 - mu_sun * mu_sun).sqrt();
    let dip = -horizon(medium.radius, height).asin();
    let eye = Eye::new(medium, mu_sun, air.multiple);
    (0..ROWS * COLUMNS)
        .into_par_iter()
        .map(|i| {
            let (row, column) = ((i / COLUMNS) as f64 / (ROWS - 1) as f64, (i % COLUMNS) as f64 / (COLUMNS - 1) as f64);
            // Elevation by the square of the row; cosine with the sun by the spherical law of cosines.
            let (mu, cos) = (row * row * (std::f64::consts::FRAC_PI_2 + dip) - dip).sin_cos();
            let nu = cos * (column * std::f64::consts::PI).cos() * sin_sun + mu * mu_sun;
            let mut sight = eye.sight(&Way { height, mu, mu_sun, nu, can_hit: false });
            sight.iter_mut().for_each(|bands| bands.iter_mut().zip(data::SUN).for_each(|(v, sun)| *v *= sun));
            sight
        })
        .collect()
}

/// Observer of the sky.
pub(super) struct Eye {
    medium: Medium,
    sunward: Sunward,
    orders: Option<Orders>,
    /// Scattering by aerosols, including light that goes straight on.
    scattering: Bands,
}

impl Eye {
    /// With a sun of some cosine with the vertical. With multiple scattering, light that aerosols scatter straight on
    /// counts as if it had not been scattered but for the last time (Nakajima, Tanaka, "Algorithms for radiative
    /// intensity calculations in moderately thick atmospheres using a truncation approximation", 1988).
    pub(super) fn new(medium: &Medium, mu_sun: f64, multiple: bool) -> Self {
        let sunward = Sunward::new(medium);
        let scattering = medium.optics.scattering;
        if !multiple {
            return Self { medium: medium.clone(), sunward, orders: None, scattering };
        }
        // Delta scaling: remove the forward peak of aerosols from extinction and scattering.
        let (forward, _) = moments::of_aerosols(medium.g);
        let mut medium = medium.clone();
        medium.optics = medium.optics.without_forward(forward);
        let orders = Some(Orders::new(&medium, mu_sun.acos(), &sunward));
        Self { medium, sunward, orders, scattering }
    }

    /// The light along a way, for a sun whose irradiance is one.
    pub(super) fn sight(&self, way: &Way) -> Sight {
        let optics = &self.medium.optics;
        // Cut the line of sight into pieces, dense near the lowest point.
        let (steps, _) = way.steps(&self.medium, PIECES);
        let (mut through, mut sight) = ([1.0; BANDS], [[0.0; BANDS]; TERMS]);
        for step in &steps {
            // Sunlight reaches the piece by the transmittance of the columns towards the sun.
            let sunlight = self.sunward.columns(step.height, step.mu_sun).map_or([0.0; BANDS], |c| passed(optics, &c));
            let again = self.orders.as_ref().map(|orders| orders.arriving(step, way.nu));
            let [air, dust, _] = step.amounts;
            // Source term of the piece, weighted by transmittance to the eye: single scattering, then higher orders.
            pass(optics, &step.amounts, &mut through, |b, weight| {
                let (even, square) = self.medium.molecules(b);
                let molecules = weight * air * optics.rayleigh[b];
                sight[0][b] += molecules * even * sunlight[b];
                sight[1][b] += molecules * square * sunlight[b];
                sight[2][b] += weight * dust * self.scattering[b] * sunlight[b];
                if let Some((by_molecules, by_aerosols)) = &again {
                    let aerosols = weight * dust * optics.scattering[b];
                    sight[0][b] += molecules * between(by_molecules, b) + aerosols * between(by_aerosols, b);
                }
            });
        }
        sight
    }
}

/// A band of all of what is given of some.
#[inline]
fn between(few: &[f32; FEW], band: usize) -> f32 {
    let (i, t) = (band / SPARSE, (band % SPARSE) as f32 / SPARSE as f32);
    few[i] * (1.0 - t) + few[(i + 1).min(FEW - 1)] * t
}

//! The sky without the sun (Hosek and Wilkie 2012).

use super::{
    Atmosphere,
    body::CelestialBody,
    cells::Cells,
    data::{self, SkyBand},
};
use steradian_math::{
    Frame, Spectrum, Vec2, Vec3,
    color::luminance,
    spectra::{ColorMode, Wavelengths},
};

/// The sky without the sun: its radiance is the model's in every direction, and its samples follow that in cells.
#[derive(Clone, Debug)]
pub struct SkyDome {
    up: Vec3,
    sun: Vec3,
    bands: Vec<SkyBand>,
    mode: ColorMode,
    cells: Cells,
}

/// Radiance of one band: `F(θ, γ)` times the level (eq. 8 of the paper, with the coefficients A to I in its order but
/// `H` and `I` exchanged, as the tables have them).
fn band(b: &SkyBand, cos_theta: f32, gamma: f32, cos_gamma: f32) -> f32 {
    // Gradient towards the horizon, glow around the sun, and an anisotropic Mie term.
    let near_horizon = 1.0 + b[0] * (b[1] / (cos_theta + 0.01)).exp();
    let cos2 = cos_gamma * cos_gamma;
    let base = (1.0 + b[8] * b[8] - 2.0 * b[8] * cos_gamma).max(1e-12);
    let mie = (1.0 + cos2) / (base * base.sqrt());
    let around = b[2] + b[3] * (b[4] * gamma).exp() + b[5] * cos2 + b[6] * mie + b[7] * cos_theta.sqrt();
    near_horizon * around * b[9]
}

impl SkyDome {
    /// The sky of an atmosphere; black where the sun is below the horizon.
    pub fn new(air: &Atmosphere) -> Self {
        let height = air.height();
        let bands = match air.mode {
            _ if height < 0.0 => Vec::new(),
            ColorMode::Rgb => {
                // In RGB mode the three channels take the place of bands.
                let albedo = air.albedo.eval(&Wavelengths::RGB).to_rgb();
                data::sky(air.turbidity, &albedo, height)
            }
            ColorMode::Spectral => data::sky(air.turbidity, &data::banded(|l| air.albedo.eval(l)), height),
        };
        let frame = Frame::from_zx(air.up, air.sun);
        let rgb = data::rgb_of_bands();
        // Importance: the luminance of the model in each cell.
        let cells = Cells::new(frame, 0.0, |w| {
            let radiance = |b: usize| at(&bands[b], frame.z, air.sun, w);
            match air.mode {
                _ if bands.is_empty() => 0.0,
                ColorMode::Rgb => luminance(Vec3::from_array(std::array::from_fn(radiance))),
                ColorMode::Spectral => {
                    (0..data::BANDS).map(|b| radiance(b) * luminance(Vec3::from_array(rgb[b]))).sum()
                }
            }
        });
        Self { up: frame.z, sun: air.sun, bands, mode: air.mode, cells }
    }
}

impl CelestialBody for SkyDome {
    fn radiance(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        let cos_theta = w.dot(self.up);
        // The model ends at the horizon.
        if self.bands.is_empty() || cos_theta < 0.0 {
            return Spectrum::ZERO;
        }
        let (cos_gamma, gamma) = (w.dot(self.sun).clamp(-1.0, 1.0), angle(w, self.sun));
        let value = |b: usize| band(&self.bands[b], cos_theta.min(1.0), gamma, cos_gamma);
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
        size_of_val(&self.bands[..]) + self.cells.bytes()
    }
}

/// Radiance of a band from the direction `w`, by the directions to the zenith and to the sun.
fn at(b: &SkyBand, up: Vec3, sun: Vec3, w: Vec3) -> f32 {
    band(b, w.dot(up).clamp(0.0, 1.0), angle(w, sun), w.dot(sun).clamp(-1.0, 1.0))
}

/// The angle between unit vectors, accurate for small ones.
fn angle(a: Vec3, b: Vec3) -> f32 {
    // tan(γ/2) = |a − b|/|a + b|, without the loss of digits of the arc cosine near one.
    2.0 * (a - b).length().atan2((a + b).length())
}

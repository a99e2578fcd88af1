//! The sky without the sun (Hosek and Wilkie 2012).

use super::{
    Atmosphere,
    data::{self, SkyBand},
};
use std::f32::consts::PI;
use steradian_math::{
    Frame, Spectrum, Vec2, Vec3,
    color::luminance,
    distribution::Piecewise2D,
    spectra::{ColorMode, Wavelengths},
    warp,
};

/// Cells that directions are sampled by, over the azimuth from the sun's and over the angle from the zenith.
const COLUMNS: usize = 256;
const ROWS: usize = 128;

/// The sky without the sun: its radiance is the model's in every direction, and its samples follow that in cells.
#[derive(Clone, Debug)]
pub struct SkyDome {
    /// `z` up, the sun's azimuth along `x`.
    frame: Frame,
    sun: Vec3,
    bands: Vec<SkyBand>,
    mode: ColorMode,
    distribution: Piecewise2D,
    fluence: f32,
}

/// Radiance of one band: `F(θ, γ)` times the level (eq. 8 of the paper, with the coefficients A to I in its order but
/// `H` and `I` exchanged, as the tables have them).
fn band(b: &SkyBand, cos_theta: f32, gamma: f32, cos_gamma: f32) -> f32 {
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
                let albedo = air.albedo.eval(&Wavelengths::RGB).to_rgb();
                data::sky(air.turbidity, &albedo, height)
            }
            ColorMode::Spectral => data::sky(air.turbidity, &data::banded(|l| air.albedo.eval(l)), height),
        };
        let frame = Frame::from_zx(air.up, air.sun);
        let mut dome = Self {
            frame,
            sun: air.sun,
            bands,
            mode: air.mode,
            distribution: Piecewise2D::new(&[1.0], 1, 1),
            fluence: 0.0,
        };
        dome.tabulate();
        dome
    }

    fn tabulate(&mut self) {
        let rgb = data::rgb_of_bands();
        let mut values = Vec::with_capacity(COLUMNS * ROWS);
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let uv = Vec2::new((column as f32 + 0.5) / COLUMNS as f32, (row as f32 + 0.5) / ROWS as f32);
                let (w, density) = self.direction(uv);
                let radiance = |b: usize| self.band(b, w);
                let y = match self.mode {
                    _ if self.bands.is_empty() => 0.0,
                    ColorMode::Rgb => luminance(Vec3::from_array(std::array::from_fn(radiance))),
                    ColorMode::Spectral => {
                        (0..data::BANDS).map(|b| radiance(b) * luminance(Vec3::from_array(rgb[b]))).sum()
                    }
                };
                values.push(y.max(0.0) / density);
            }
        }
        self.fluence = values.iter().sum::<f32>() / values.len() as f32;
        // Every cell can be found, black at its middle or not.
        let (mean, cells) = (self.fluence, values.iter_mut());
        cells.for_each(|v| *v = v.max(1e-3 * mean));
        self.distribution = Piecewise2D::new(&values, COLUMNS, ROWS);
    }

    /// The world direction of a place on the table, and the density of directions per unit of its area.
    fn direction(&self, uv: Vec2) -> (Vec3, f32) {
        let (d, sin) = warp::direction_from_latlong(Vec2::new(uv.x, 0.5 * uv.y));
        (self.frame.to_world(d), 1.0 / (PI * PI * sin))
    }

    fn band(&self, b: usize, w: Vec3) -> f32 {
        let cos_gamma = w.dot(self.sun).clamp(-1.0, 1.0);
        band(&self.bands[b], w.dot(self.frame.z).clamp(0.0, 1.0), angle(w, self.sun), cos_gamma)
    }

    /// Radiance from the direction `w`, W/(m² sr nm).
    pub fn radiance(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        let cos_theta = w.dot(self.frame.z);
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

    /// A direction, and its density per solid angle.
    pub fn sample(&self, u: Vec2) -> (Vec3, f32) {
        let (uv, pdf) = self.distribution.sample(u);
        let (w, density) = self.direction(uv);
        (w, pdf * density)
    }

    /// The density of [`SkyDome::sample`].
    pub fn pdf(&self, w: Vec3) -> f32 {
        let d = self.frame.to_local(w);
        let sin = d.x.hypot(d.y);
        if d.z <= 0.0 || sin <= 0.0 {
            return 0.0;
        }
        let uv = warp::latlong_from_direction(d) * Vec2::new(1.0, 2.0);
        self.distribution.pdf(uv) / (PI * PI * sin)
    }

    pub(super) fn fluence(&self) -> f32 {
        self.fluence
    }

    pub(super) fn bytes(&self) -> usize {
        let cells: usize = self.distribution.size().into_iter().product();
        size_of_val(&self.bands[..]) + cells * 3 * size_of::<f32>()
    }
}

/// The angle between unit vectors, accurate for small ones.
fn angle(a: Vec3, b: Vec3) -> f32 {
    2.0 * (a - b).length().atan2((a + b).length())
}

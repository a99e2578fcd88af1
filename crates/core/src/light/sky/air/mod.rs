//! The sky and the sun by what air scatters and absorbs: molecules, aerosols and ozone around a round, bare globe.
//!
//! Single scattering is summed along each line of sight; light that is scattered again comes from its moments, order by
//! order. Light goes straight: there is no refraction. Radiances are in W/(m² sr nm).

mod data;
mod dome;
mod medium;
mod moments;
mod orders;
mod path;
mod sun;
#[cfg(test)]
mod tests;

pub use dome::AirDome;
pub use sun::AirSun;

use medium::Medium;
use steradian_math::{
    Vec3,
    spectra::{ColorMode, Wavelengths, role::Color},
};

/// Contents of the air.
#[derive(Clone, Copy, Debug)]
pub struct Contents {
    /// Pressure at sea level, hPa.
    pub pressure: f64,
    /// Ozone, Dobson units.
    pub ozone: f64,
    /// Vertical optical depth of aerosols at 550 nm, above sea level.
    pub aerosol: f64,
    /// Ångström's exponent: their depth goes with the wavelength to minus this.
    pub angstrom: f64,
    /// The part of what they take out of light that they scatter.
    pub aerosol_albedo: f32,
    /// Height in m over which they thin by a factor of e.
    pub aerosol_height: f64,
    /// Mean cosine of the angle that they scatter by, in (−1, 1).
    pub g: f32,
}

impl Contents {
    /// Clear air at sea level, as a scene has it that says nothing else.
    pub const CLEAR: Self = Self {
        pressure: 1013.25,
        ozone: 300.0,
        aerosol: 0.1,
        angstrom: 1.3,
        aerosol_albedo: 0.95,
        aerosol_height: 1500.0,
        g: 0.7,
    };
}

/// Air, and who looks at the sun through it.
#[derive(Clone, Debug)]
pub struct Air {
    /// Contents of the air.
    pub contents: Contents,
    /// Reflectance of the ground in [0, 1], a spectrum in both modes.
    pub albedo: Color,
    /// Height of the viewer above sea level, m.
    pub altitude: f32,
    /// Enables multiple scattering.
    pub multiple: bool,
    /// Unit vector to the zenith.
    pub up: Vec3,
    /// Unit vector to the middle of the sun.
    pub sun: Vec3,
    /// The colour mode.
    pub mode: ColorMode,
}

impl Air {
    fn medium(&self) -> Medium {
        // Sample the ground's reflectance in the middle of each band.
        let reflectance = |b| self.albedo.eval(&Wavelengths::at([data::wavelength(b).min(830.0); 4])).to_array()[0];
        Medium::new(&self.contents, std::array::from_fn(|b| reflectance(b).clamp(0.0, 1.0)))
    }

    fn altitude_km(&self) -> f64 {
        f64::from(self.altitude) * 1e-3
    }
}

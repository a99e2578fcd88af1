//! Spectra: curves over the wavelength, the CIE observer, standard illuminants, measured metals and glasses, thermal
//! emission, and the sampling of wavelengths.
//!
//! Wavelengths are in nanometres. The visible range is [`LAMBDA_MIN`]..=[`LAMBDA_MAX`]; outside it the observer sees
//! nothing.

pub mod blackbody;
pub mod cie;
pub mod curve;
mod data;
pub mod daylight;
pub mod dispersion;
pub mod ior;
mod mode;
pub mod named;
pub mod parse;
pub mod photometry;
mod reradiation;
mod response;
pub mod role;
pub mod spd;
pub mod wavelengths;

pub use blackbody::Blackbody;
pub use cie::CIE_Y_INTEGRAL;
pub use curve::{Curve, Dense};
pub use dispersion::Dispersion;
pub use mode::ColorMode;
pub use named::{d65, named};
pub use parse::parse_spd;
pub use reradiation::{BispectralTable, Reradiation};
pub use response::Response;
pub use spd::Spd;
pub use wavelengths::Wavelengths;

/// Shortest visible wavelength, nm.
pub const LAMBDA_MIN: f32 = 360.0;
/// Longest visible wavelength, nm.
pub const LAMBDA_MAX: f32 = 830.0;
/// Number of whole nanometres from [`LAMBDA_MIN`] to [`LAMBDA_MAX`], both included.
pub const LAMBDA_COUNT: usize = 471;

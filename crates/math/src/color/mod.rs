//! Colour: RGB spaces and CIE XYZ, the sRGB transfer function, CIELAB, and spectra for RGB values.
//!
//! "RGB" without more words is linear Rec.709 (the primaries and white of sRGB).

pub mod difference;
pub mod lab;
pub mod models;
pub mod space;
pub mod transfer;
pub mod upsample;
pub mod xyz;

pub use space::RgbSpace;
pub use upsample::RgbSigmoid;

use crate::Vec3;

/// Luminance Y of linear Rec.709 (red, green and blue weigh 0.2126, 0.7152 and 0.0722).
#[inline]
pub fn luminance(rgb: Vec3) -> f32 {
    space::REC709.luminance_weights_f32().dot(rgb)
}

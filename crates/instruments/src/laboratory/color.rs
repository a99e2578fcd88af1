//! Colours of spectra for pictures of experiments.

use glam::DVec3;
use steradian_math::{color::space::REC709, spectra::cie};

/// Linear Rec.709 of XYZ. Colours outside the gamut are mixed with the white of the same luminance until the smallest
/// component is zero.
pub fn rgb_from_xyz_in_gamut(xyz: DVec3) -> [f32; 3] {
    let rgb = REC709.rgb_from_xyz() * xyz;
    let luminance = xyz.y.max(0.0);
    let least = rgb.min_element();
    let rgb = if least < 0.0 && luminance > least {
        DVec3::splat(luminance) + (rgb - luminance) * (luminance / (luminance - least))
    } else {
        rgb
    };
    rgb.max(DVec3::ZERO).as_vec3().to_array()
}

/// The colour of light of one wavelength (nm), with the luminance that the eye gives it relative to 555 nm.
pub fn monochromatic(lambda: f64) -> [f32; 3] {
    rgb_from_xyz_in_gamut(DVec3::from(cie::matching_linear(lambda)))
}

/// The colour of a spectrum (any unit per nm), scaled so that the constant spectrum 1 has luminance 1.
pub fn spectrum_rgb(s: impl Fn(f32) -> f32) -> [f32; 3] {
    rgb_from_xyz_in_gamut(cie::to_xyz(s))
}

//! The sky of air against walks at random, closed forms, and what is known of days and twilights.

mod flux;
mod known;
mod walks;

use super::{
    Air, Contents,
    data::BANDS,
    dome::Eye,
    medium::{Medium, aerosols},
    path::Way,
};
use steradian_math::{
    Vec3,
    spectra::{ColorMode, role::Color},
};

/// A direction by its height and its azimuth from the sun's, degrees.
pub(super) fn toward(height: f64, azimuth: f64) -> Vec3 {
    let (h, a) = (height.to_radians(), azimuth.to_radians());
    Vec3::new((h.cos() * a.cos()) as f32, (h.cos() * a.sin()) as f32, h.sin() as f32)
}

/// Some air with the sun at a height.
pub(super) fn air(contents: Contents, sun: f64) -> Air {
    let (albedo, altitude) = (Color::constant(0.3), 0.0);
    Air { contents, albedo, altitude, multiple: true, up: Vec3::Z, sun: toward(sun, 0.0), mode: ColorMode::Spectral }
}

/// A way from a height in km along a direction, by heights of the sun and of the direction and the azimuth between
/// them, in degrees.
pub(super) fn way(height: f64, sun: f64, to: f64, azimuth: f64) -> Way {
    let (sun, to) = (sun.to_radians(), to.to_radians());
    let nu = to.cos() * azimuth.to_radians().cos() * sun.cos() + to.sin() * sun.sin();
    Way { height, mu: to.sin(), mu_sun: sun.sin(), nu, can_hit: false }
}

/// The radiance along a way for a sun whose irradiance is one, by band.
pub(super) fn seen(eye: &Eye, medium: &Medium, way: &Way) -> [f32; BANDS] {
    let [even, square, dust] = eye.sight(way);
    let nu = way.nu as f32;
    let phase = aerosols(medium.g, nu);
    std::array::from_fn(|b| even[b] + nu * nu * square[b] + phase * dust[b])
}

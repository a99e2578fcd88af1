//! Instruments. First those that measure materials: what a goniophotometer, an integrating sphere and a glossmeter
//! would read off a surface of a scene.
//!
//! Every instrument looks at a [`Specimen`]: one material of a compiled scene at one point of a surface, in its shading
//! frame (`z` is the normal, `x` the tangent).
//!
//! Beside them stand experiments of [`optics`], of [`vision`], of Monte Carlo integration ([`estimate`]) and of
//! analytic [`geometry`]; see [`experiment`].

pub mod albedo;
mod chi_square;
pub mod estimate;
pub mod experiment;
pub mod fit;
mod furnace;
pub mod geometry;
pub mod gloss;
pub mod goniometer;
mod laboratory;
pub mod laws;
pub mod least_squares;
pub mod microsurface;
pub mod optics;
pub mod plot;
mod specimen;
pub mod summary;
mod svg;
pub mod vision;

pub use specimen::Specimen;
pub use steradian_bsdf::TransportMode;

use steradian_math::Vec3;

/// The unit vector at an angle from the normal and an azimuth, both in degrees.
pub fn direction(theta: f64, phi: f64) -> Vec3 {
    let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    Vec3::new((sin * x) as f32, (sin * y) as f32, cos as f32)
}

#[cfg(test)]
mod tests;

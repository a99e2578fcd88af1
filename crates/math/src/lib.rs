//! Mathematics of light transport: vectors, rays, bounds, transforms, frames, warps, distributions,
//! low-discrepancy sequences, spectra and colour.
//!
//! Everything here is a pure function of its arguments. Vectors are [`glam`] `f32` vectors; import-time transforms are
//! kept in `f64` ([`Transform`]) and rounded once.

pub mod bounds;
mod cell;
#[cfg(test)]
mod chi_square;
pub mod color;
pub mod distribution;
pub mod elementary;
pub mod error;
pub mod expression;
pub mod frame;
pub mod geometry;
pub mod golden_section;
pub mod harmonics;
pub mod hash;
pub mod intersect;
pub mod motion;
pub mod photon_noise;
pub mod polarization;
pub mod quadrature;
pub mod ray;
pub mod sobol;
pub mod spectra;
pub mod spectrum;
pub mod sphere_grid;
pub mod transform;
pub mod uniform_bits;
pub mod warp;

pub use bounds::Bounds3;
pub use cell::cell;
pub use error::Error;
pub use frame::Frame;
pub use glam::{DMat3, DMat4, DVec2, DVec3, Mat3, Mat4, Vec2, Vec3, Vec4};
pub use motion::Motion;
pub use ray::Ray;
pub use spectrum::Spectrum;
pub use transform::Transform;
pub use uniform_bits::Chance;

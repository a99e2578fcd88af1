//! Analytic geometry in double precision: points and vectors, coordinate systems, lines, planes, conics, surfaces,
//! solid angles.
//!
//! Conventions: coordinate systems are right-handed, angles are radians, `z` is up unless [`axes`] converted it.
//! Rendering in `f32` lives elsewhere ([`crate::intersect`], [`crate::transform::Affine`]); this is for building scenes
//! and for checking them.

pub mod axes;
pub mod barycentric;
pub mod bezier;
pub mod conic;
pub mod coordinates;
pub mod fill;
pub mod homogeneous;
pub mod line;
pub mod plane;
pub mod point;
pub mod projection;
#[cfg(test)]
pub(crate) mod random;
pub mod solid_angle;
pub mod surface;
pub mod vector;

pub use point::Point3;

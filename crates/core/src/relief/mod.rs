//! Relief without geometry: heights over the unit square that rays are traced against, the one-step approximations of
//! it, and how roughness takes the place of relief that is too fine to see.

pub mod field;
pub mod filtering;
pub mod parallax;
pub mod search;

pub use field::HeightField;

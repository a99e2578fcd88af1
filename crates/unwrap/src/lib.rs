//! Unwrapping: a texture atlas of a triangle mesh, in which no two triangles overlap.
//!
//! 1. Vertices at one position are one; sides that exactly two triangles share in opposite directions join them
//!    (`connect`).
//! 2. Triangles are merged into charts, pair by pair, while a chart stays a disk and its normals stay in a cone
//!    (`cluster`).
//! 3. Each chart is laid into the plane: least-squares conformal maps, else a projection; a chart for which neither is
//!    one-to-one is taken apart into the two it was merged from (`flatten`, `lscm`, `proof`).
//! 4. Charts are turned into their smallest boxes and packed below each other (`hull`, `pack`).
//! 5. Coordinates are rounded to multiples of 2⁻²³, which single precision holds exactly, and whether triangles keep
//!    their orientation and borders cross nothing is decided again, in integers (`atlas`). A chart that the rounding
//!    broke is taken apart as well.
//!
//! A triangle alone is always one-to-one, so this ends. It is the same computation, to the last bit, in every run.

mod atlas;
mod chart;
mod cluster;
mod connect;
mod flatten;
mod hull;
mod lscm;
mod measure;
mod mesh;
mod pack;
mod proof;

pub use atlas::{Atlas, NO_CHART, unwrap};
pub use measure::{Metrics, stretch};
pub use mesh::{Error, MOST_TRIANGLES, Mesh, Options};

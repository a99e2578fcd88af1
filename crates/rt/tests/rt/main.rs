//! What the crate promises, held against models that are written from the specifications.

mod facing;
mod model;
mod queries;
mod structures;
mod worlds;

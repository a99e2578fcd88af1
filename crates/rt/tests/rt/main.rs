//! Specified behaviour of the crate, held against models that are written from the specifications.

mod builds;
mod capture;
mod examples;
mod facing;
mod inspect;
mod legality;
mod limits;
mod model;
mod pipeline;
mod procedural;
mod queries;
mod random;
mod serial;
mod structures;
mod tables;
mod worlds;

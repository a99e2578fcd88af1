//! Tests of mesh shading.

mod bounds;
mod meshlets;
mod shapes;
mod statistics;

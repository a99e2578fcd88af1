//! Tests of mesh shading.

mod bounds;
mod drawing;
mod meshlets;
mod rules;
mod shapes;
mod statistics;

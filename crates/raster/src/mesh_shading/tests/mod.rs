//! Tests of mesh shading.

mod bounds;
mod culling;
mod drawing;
mod meshlets;
mod rules;
mod shapes;
mod statistics;

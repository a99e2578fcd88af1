//! Mesh shading: meshes in clusters small enough for one work group.
//!
//! [`Meshlets`] are built once from a mesh with indices; each has a [`Sphere`] and a [`NormalCone`] to be culled by. [`VertexReuse`]
//! and [`Overdraw`] measure how good an order of triangles is.

mod adjacency;
mod bounds;
mod build;
mod meshlet;
mod overdraw;
mod spatial_order;
mod statistics;

pub use bounds::{NormalCone, Sphere};
pub use meshlet::{Meshlet, MeshletLimits, Meshlets};
pub use overdraw::Overdraw;
pub use statistics::VertexReuse;

#[cfg(test)]
mod tests;

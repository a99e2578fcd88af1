//! The pipeline against values that are known by other means.

mod clipping;
mod draws;
mod examples;
mod fill;
mod fragments;
mod hostile;
mod hostile_mesh_shading;
mod lines;
mod mesh_shading;
mod ray_cast;
mod refusals;
mod samples;
mod stage;
mod tests_and_blending;
mod textures;
mod topologies;

//! Spatiotemporal variance-guided filtering against what is known of it by other means.

mod constants;
mod edges;
mod hostile;
mod kernel;
mod moving;
mod panning;
mod scene;
mod similarity;

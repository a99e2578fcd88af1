//! The scene as it is rendered: [`compile`](compile::compile) turns a description into an immutable [`Scene`].

pub mod camera;
pub mod compile;
pub mod footprint;
pub mod light;
pub mod material;
pub mod medium;
pub mod relief;
pub mod sampler;
pub mod scene;
pub mod shape;

pub use compile::{Compiled, compile};
pub use scene::Scene;
pub use steradian_film as film;
pub use steradian_math::spectra::ColorMode;

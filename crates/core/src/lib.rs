//! The scene as it is rendered: an immutable [`Scene`], and the queries on it.

pub mod camera;
pub mod footprint;
pub mod light;
pub mod material;
pub mod medium;
pub mod relief;
pub mod sampler;
pub mod scene;
pub mod shape;

pub use scene::Scene;
pub use steradian_film as film;
pub use steradian_math::spectra::ColorMode;

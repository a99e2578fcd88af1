#![doc = include_str!("../README.md")]

mod method;

pub use method::{Error, Fault, MethodRequest};

use steradian_film::Layer;
use steradian_schema::Model;

/// A render request. Fields that are `None` follow the scene.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Method with its options; `None` for the scene's own method or, where that refuses the scene, a path tracer.
    pub method: Option<MethodRequest>,
    /// Samples per pixel; their mean with `adaptive`.
    pub spp: Option<u32>,
    /// True to spend more samples on parts of the picture with larger errors.
    pub adaptive: bool,
    /// Relative error of the picture at which sampling ends.
    pub error: Option<f64>,
    /// Random seed.
    pub seed: Option<u64>,
    /// Threads; 0 for one per processor.
    pub threads: usize,
    /// Most scattering events on a path.
    pub max_depth: Option<u32>,
    /// Point set of the samples; `None` for the default of the scene's format.
    pub sampler: Option<SamplerRequest>,
    /// Auxiliary layers.
    pub layers: Vec<Layer>,
    /// True to leave the background behind all surfaces out of the picture, for [`Layer::ALPHA`].
    pub transparent: bool,
    /// True for pixels with independent errors, which denoisers need: paths share nothing unless an option says so.
    pub independent: bool,
}

/// A point set that is asked for.
#[derive(Clone, Copy, Debug)]
pub enum SamplerRequest {
    /// The sampler that the scene's file names.
    OfFile,
    /// A row of the schema's family of samplers.
    Row(&'static Model),
}

//! Plan of a render, and the state shared with whoever watches it.

use crate::Sight;
use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicBool, AtomicU64},
};
use steradian_core::{film::LayerInputs, sampler::Sampler};

/// Plan of a render, whatever the method.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The random numbers; its `spp` is the number that a full render takes.
    pub sampler: Sampler,
    /// Threads; 0 for one per processor.
    pub threads: usize,
    /// Measurements of the layers that are asked for.
    pub inputs: LayerInputs,
    /// True for pixels with independent errors: paths of several pixels share nothing unless an option says so.
    pub independent: bool,
    /// Makes samples whose camera rays meet no surface black: what lies behind everything is not in the picture.
    pub transparent: bool,
    /// Lets camera rays pass all that emits: lights are hidden from the camera, in layers as in the picture.
    pub hide_emitters: bool,
    /// Gives cells that err more further samples, where the first ones tell that it pays; `spp` is the mean then.
    pub adaptive: bool,
    /// The relative error of the picture ([`crate::Session::error`]) at which to stop, unless it is in doubt.
    pub error: Option<f64>,
}

impl Plan {
    /// Evenly spread samples on all processors, without layers or a limit on the error.
    pub fn new(sampler: Sampler) -> Self {
        Self {
            sampler,
            threads: 0,
            inputs: LayerInputs::NONE,
            independent: false,
            transparent: false,
            hide_emitters: false,
            adaptive: false,
            error: None,
        }
    }

    /// Surfaces that count as seen by camera rays.
    pub fn sight(&self) -> Sight {
        Sight { sees_through: self.has(LayerInputs::SEEN_THROUGH), hide_emitters: self.hide_emitters }
    }

    /// True if layers need these measurements.
    pub fn has(&self, inputs: LayerInputs) -> bool {
        self.inputs.has(inputs)
    }

    /// Threads that a step uses.
    pub fn threads(&self) -> usize {
        // The system looks into files to tell.
        static PROCESSORS: OnceLock<usize> = OnceLock::new();
        match self.threads {
            0 => *PROCESSORS.get_or_init(|| std::thread::available_parallelism().map_or(1, |n| n.get())),
            n => n,
        }
    }
}

/// Shared with whoever watches a step: progress, and cancellation.
#[derive(Debug, Default)]
pub struct Control {
    /// Samples (of all pixels) taken so far.
    pub samples: AtomicU64,
    /// Rays traced so far.
    pub rays: AtomicU64,
    /// True while trials of the scene are under way, before the first sample.
    pub trials: AtomicBool,
    /// Set to stop, wherever paths are.
    pub cancel: Arc<AtomicBool>,
}

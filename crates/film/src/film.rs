//! The state of a film.

use crate::{Bands, Crop, Half, LayerSums, Pixel};
use std::sync::Arc;

/// The state of a film: what a render gives to be looked at or saved.
#[derive(Clone, Debug)]
pub struct Film {
    /// Part of the full frame that it shows.
    pub crop: Crop,
    /// Pixels by rows.
    pub pixels: Vec<Pixel>,
    /// Sums of layers, by rows.
    pub layers: LayerSums,
    /// The halves of samples, by rows; empty where they were not kept.
    pub halves: Vec<Half>,
    /// Number of time bins of a transient render, which take the place of groups of lights; 0 where there are none.
    pub bins: u32,
    /// Bands of wavelengths that the layers have sums of; `None` where they were not kept.
    pub bands: Option<Arc<Bands>>,
}

//! The state of a film.

use crate::{Crop, Half, LayerSums, Pixel};

/// The state of a film: what a render gives to be looked at or saved.
#[derive(Clone, Debug)]
pub struct Film {
    /// What of the full frame it shows.
    pub crop: Crop,
    /// Pixels by rows.
    pub pixels: Vec<Pixel>,
    /// Sums of layers, by rows.
    pub layers: LayerSums,
    /// The halves of samples, by rows; empty where they were not kept.
    pub halves: Vec<Half>,
    /// How many intervals of the arrival of light these are instead; 0 where they are groups of lights.
    pub bins: u32,
}

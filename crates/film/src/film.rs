//! The state of a film.

use crate::{Crop, FirstHitSums, Half, MatteSums, Pixel};

/// The state of a film: what a render gives to be looked at or saved.
#[derive(Clone, Debug)]
pub struct Film {
    /// What of the full frame it shows.
    pub crop: Crop,
    /// Pixels by rows.
    pub pixels: Vec<Pixel>,
    /// First hits by rows; empty where they were not gathered.
    pub features: Vec<FirstHitSums>,
    /// What covers pixels, by rows; empty where it was not counted.
    pub mattes: Vec<MatteSums>,
    /// Sums of linear Rec.709 radiance of each group of lights, pixel by pixel; empty where they were not kept.
    pub by_light: Vec<[f64; 3]>,
    /// The halves of samples, by rows; empty where they were not kept.
    pub halves: Vec<Half>,
    /// How many intervals of the arrival of light these are instead; 0 where they are groups of lights.
    pub bins: u32,
}

//! What shading and shadows keep of a pixel's light.

use steradian_engine::Counters;

/// What follows the way of a pixel's light.
pub struct Trace<'a> {
    /// Counts rays, and keeps the light of each group of lights.
    pub counters: &'a mut Counters,
    /// The pixel, while what it sees itself is shaded.
    pub pixel: Option<usize>,
}

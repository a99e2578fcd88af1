//! What shading and shadows ask of rays, and what they keep of a pixel's light.

use crate::world::World;
use steradian_core::{Scene, scene::Hit};
use steradian_engine::Counters;
use steradian_math::Ray;

/// What follows the way of a pixel's light.
pub struct Trace<'a> {
    /// Counts rays, and keeps the light of each group of lights.
    pub counters: &'a mut Counters,
    /// The pixel, while what it sees itself is shaded.
    pub pixel: Option<usize>,
    /// The structures that rays go through; without, those of the scene.
    pub world: Option<&'a World>,
}

impl Trace<'_> {
    /// What a ray meets first.
    pub fn nearest(&mut self, scene: &Scene, ray: &Ray) -> Option<Hit> {
        self.counters.rays += 1;
        match self.world {
            Some(world) => world.nearest(scene, ray),
            None => scene.intersect(ray),
        }
    }

    /// Whether anything is on a ray.
    pub fn is_occluded(&mut self, scene: &Scene, ray: &Ray) -> bool {
        self.counters.rays += 1;
        match self.world {
            Some(world) => world.is_occluded(scene, ray),
            None => scene.occluded(ray),
        }
    }
}

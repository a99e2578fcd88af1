//! Ray queries of shading and shadows, and the record of a pixel's light.

use crate::world::World;
use steradian_core::{Scene, scene::Hit};
use steradian_engine::Counters;
use steradian_math::Ray;

/// Tracer of a pixel's rays and recorder of its light.
pub struct Trace<'a> {
    /// Counts rays, and keeps the light of each group of lights.
    pub counters: &'a mut Counters,
    /// The pixel, while what it sees itself is shaded.
    pub pixel: Option<usize>,
    /// The structures that rays go through; without, those of the scene.
    pub world: Option<&'a World>,
}

impl Trace<'_> {
    /// Nearest hit of a ray; `None` once a stop is asked for.
    pub fn nearest(&mut self, scene: &Scene, ray: &Ray) -> Option<Hit> {
        // A stop that was asked for ends the walk at once: no hit, or occluded.
        if self.counters.stop.is_asked() {
            return None;
        }
        self.counters.rays += 1;
        match self.world {
            Some(world) => world.nearest(scene, ray),
            None => scene.intersect(ray),
        }
    }

    /// True if a ray is occluded, or once a stop is asked for.
    pub fn is_occluded(&mut self, scene: &Scene, ray: &Ray) -> bool {
        if self.counters.stop.is_asked() {
            return true;
        }
        self.counters.rays += 1;
        match self.world {
            Some(world) => world.is_occluded(scene, ray),
            None => scene.occluded(ray),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, atomic::AtomicBool};
    use steradian_compile::{Options, compile};
    use steradian_engine::Stop;
    use steradian_math::Vec3;
    use steradian_scene::{Family, Node, SceneDesc, Shape};

    /// No ray is traced once a stop is asked for.
    #[test]
    fn a_stop_ends_all_rays() {
        let mut desc = SceneDesc::default();
        desc.film = Some(desc.add(Node::new(Family::Film, "rgb", None)));
        desc.cameras = vec![desc.add(Node::new(Family::Camera, "perspective", None))];
        let ball = desc.add(Node::new(Family::Shape, "sphere", None));
        desc.shapes.push(Shape::new(ball));
        let scene = compile(&desc, &Options::default()).scene.unwrap();
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        for is_stopped in [false, true] {
            let stop = Stop::by(&Arc::new(AtomicBool::new(is_stopped)));
            let mut counters = Counters::until(&stop);
            let mut trace = Trace { counters: &mut counters, pixel: None, world: None };
            assert_eq!(trace.nearest(&scene, &ray).is_some(), !is_stopped);
            assert!(trace.is_occluded(&scene, &ray));
            assert_eq!(counters.rays, if is_stopped { 0 } else { 2 });
        }
    }
}

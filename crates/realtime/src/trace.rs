//! Ray queries of shading and shadows, and the record of a pixel's light.

use crate::world::World;
use steradian_core::{Scene, scene::Hit};
use steradian_engine::Counters;
use steradian_math::Ray;

/// Shares of light below this are taken for none.
const LEAST_OPEN: f32 = 1e-3;

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
    /// Share of light that passes along a ray, by the opacities of what it meets; 0 once a stop is asked for.
    pub fn open(&mut self, scene: &Scene, ray: &Ray) -> f32 {
        let (mut open, mut ray) = (1.0, *ray);
        while open > LEAST_OPEN && !self.counters.stop.is_asked() {
            self.counters.rays += 1;
            let Some((hit, opacity)) = scene.intersect_layer(&ray) else { return open };
            let i = scene.interaction_of_light(&ray, &hit);
            // Interfaces between media scatter nothing, and cast no shadow.
            if !scene.geometry(hit.id).is_interface {
                open *= 1.0 - opacity;
            }
            ray = i.rest(&ray);
        }
        0.0
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

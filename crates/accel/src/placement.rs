//! Placed objects.

use glam::Mat4;
use std::sync::Arc;
use steradian_math::{Motion, Ray, transform::Affine};

/// A placement of an object. Instances whose transform is not finite are left out.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index among the objects of the structure.
    pub object: u32,
    /// Placement of the object.
    pub world_from_object: Affine,
    /// Motion of a moving instance, evaluated at the times of rays; `world_from_object` is not used then.
    pub motion: Option<Arc<Motion>>,
}

impl Instance {
    /// One that stands still.
    pub fn new(object: u32, world_from_object: Affine) -> Self {
        Self { object, world_from_object, motion: None }
    }
}

/// Traversal data of an instance.
#[derive(Clone, Debug)]
pub(crate) struct Placement {
    pub object_from_world: Mat4,
    pub object: u32,
    motion: Option<Arc<Motion>>,
}

impl Placement {
    pub fn of(instance: &Instance) -> Self {
        Self {
            object_from_world: instance.world_from_object.inv,
            object: instance.object,
            motion: instance.motion.clone(),
        }
    }

    /// A ray in the space of the object.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray) -> Ray {
        let enter = |place: &Mat4| Ray {
            origin: place.transform_point3(ray.origin),
            direction: place.transform_vector3(ray.direction),
            ..*ray
        };
        match &self.motion {
            None => enter(&self.object_from_world),
            Some(motion) => enter(&moved(motion, ray.time)),
        }
    }
}

/// The way to the space of an object that moves; where there is none, all points are one, which no ray meets.
#[cold]
#[inline(never)]
fn moved(motion: &Motion, time: f32) -> Mat4 {
    motion.at(time).map_or(Mat4::ZERO, |place| place.inv)
}

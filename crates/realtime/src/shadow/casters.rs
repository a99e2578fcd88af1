//! Triangles that cast shadows.

use steradian_accel::WORLD;
use steradian_core::{Scene, scene::Shape};
use steradian_math::Vec3;

use crate::{Error, draw_list::DrawList, options::Shadows};

/// Triangles of meshes without masks, in the world.
#[derive(Debug, Default)]
pub struct Casters {
    pub triangles: Vec<[Vec3; 3]>,
    /// Index in the draw list of each triangle's mesh.
    pub items: Vec<u32>,
    /// True if anything else casts shadows: other shapes, and meshes with masks.
    pub others: bool,
}

impl Casters {
    /// Casters of a scene, if the technique asks for them.
    ///
    /// # Errors
    /// More than 119 million triangles.
    pub fn new(scene: &Scene, list: &DrawList, kind: Shadows) -> Result<Self, Error> {
        if kind.is_of_pixels() || kind == Shadows::Cube { Self::all(scene, list) } else { Ok(Self::default()) }
    }

    /// Casters of a scene.
    ///
    /// # Errors
    /// More than 119 million triangles.
    pub fn all(scene: &Scene, list: &DrawList) -> Result<Self, Error> {
        let mut casters = Self::default();
        // Gather opaque triangles in world space; masked meshes and other shapes need rays.
        for (number, item) in list.items.iter().enumerate() {
            let geometry = list.geometry(scene, item);
            let Shape::Mesh(mesh) = &geometry.shape else {
                casters.others = true;
                continue;
            };
            if geometry.is_masked() {
                casters.others = true;
                continue;
            }
            let place = item.place(scene);
            let in_world = |p: Vec3| if item.instance == WORLD { p } else { place.point(p) };
            let count = mesh.triangles.len() as u32;
            // As many as can be drawn at once.
            if casters.triangles.len() + count as usize > (u32::MAX / 36) as usize {
                return Err(Error::Scene("raster casts shadows of up to 119 million triangles".into()));
            }
            casters.triangles.extend((0..count).map(|t| mesh.corners(t).map(in_world)));
            casters.items.extend((0..count).map(|_| number as u32));
        }
        Ok(casters)
    }
}

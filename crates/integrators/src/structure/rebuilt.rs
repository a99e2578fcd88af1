//! A scene with another acceleration structure.

use std::sync::Arc;
use steradian_accel::{Accel, Accelerator, Geometry, Instance, Object};
use steradian_core::{
    Scene,
    scene::{self, Shape},
};
use steradian_engine::Refusal;
use steradian_math::Bounds3;

/// The scene with a structure of this kind over its geometry and placed groups. The hits of rays have the same bits.
pub fn scene(scene: &Scene, accelerator: Accelerator) -> Result<Scene, Refusal> {
    let all = scene.geometries();
    let boxes: Vec<Vec<Bounds3>> = all.iter().map(|g| boxes(&g.shape)).collect();
    let geometries = |from: u32, count: u32| -> Vec<Geometry<'_>> {
        let range = from as usize..(from + count) as usize;
        all[range.clone()].iter().zip(&boxes[range]).map(|(g, boxes)| geometry(g, boxes)).collect()
    };
    let failed = |e: steradian_accel::Error| Refusal(format!("structure '{}': {e}", accelerator.about().0));
    // Groups by their first geometry; those without geometry are all the same.
    let mut groups: Vec<(u32, u32)> = scene.placements().iter().map(|place| (place.base, place.count)).collect();
    groups.sort_unstable();
    groups.dedup();
    let objects = groups.iter().map(|&(base, count)| Object::build(accelerator, &geometries(base, count)));
    let objects = objects.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    let instance = |place: &scene::Placement| Instance {
        object: groups.partition_point(|group| *group < (place.base, place.count)) as u32,
        world_from_object: place.world_from_group,
        motion: place.motion.clone(),
    };
    let instances: Vec<Instance> = scene.placements().iter().map(instance).collect();
    let world = geometries(0, scene.world_count());
    let accel = Accel::build(accelerator, &world, objects, &instances).map_err(failed)?;
    Ok(scene.clone().changed(|parts| parts.accel = Arc::new(accel)))
}

fn geometry<'g>(geometry: &'g scene::Geometry, boxes: &'g [Bounds3]) -> Geometry<'g> {
    let shape = match &geometry.shape {
        Shape::Mesh(mesh) => Geometry::triangles(&mesh.positions, &mesh.triangles),
        _ => Geometry::boxes(boxes),
    };
    shape.filtered(geometry.is_masked() || geometry.is_interface)
}

/// Boxes of the primitives of a shape that are no triangles. Infinite planes are in no structure.
fn boxes(shape: &Shape) -> Vec<Bounds3> {
    match shape {
        Shape::Mesh(_) | Shape::Plane(_) => Vec::new(),
        Shape::Patches(p) => (0..p.patches.len() as u32).map(|k| p.bounds(k)).collect(),
        Shape::Curves(c) => (0..c.count()).map(|k| c.bounds(k)).collect(),
        Shape::Field(f) => (0..f.count()).map(|k| f.bounds(k)).collect(),
        Shape::Sdf(s) => (0..s.count()).map(|k| s.bounds(k)).collect(),
        Shape::Quadric(_) | Shape::Level(_) => vec![shape.bounds()],
    }
}

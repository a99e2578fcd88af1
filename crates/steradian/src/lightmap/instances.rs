//! Scenes whose instances are shapes of their own, so that each has its own place in the atlas.

use crate::{Error, unwrap::MOST_TRIANGLES};
use steradian_scene::{SceneDesc, Shape};

/// A scene without instances: a shape in the world for each shape of each instance. They share meshes.
///
/// # Errors
/// [`Error::CannotBake`] for instances that move, whose light has no one place, and where they have more triangles than
/// [`MOST_TRIANGLES`]; it is found before any is placed.
pub(super) fn placed(desc: &SceneDesc) -> Result<SceneDesc, Error> {
    if desc.instances.iter().any(|instance| instance.movement.is_some()) {
        return Err(Error::CannotBake("instances that move cannot have a lightmap: their light changes".into()));
    }
    // What is no mesh counts as one triangle, to bound the number of shapes.
    let count = |shape: &Shape| match shape.mesh.and_then(|mesh| desc.meshes.get(mesh)) {
        Some(mesh) => (mesh.triangles.len() + 2 * mesh.patches.len()).max(1),
        None => 1,
    };
    let of_group: Vec<usize> = desc.groups.iter().map(|group| group.shapes.iter().map(count).sum()).collect();
    let of_instances = desc.instances.iter().filter_map(|instance| of_group.get(instance.group));
    let triangles = of_instances.fold(0_usize, |sum, more| sum.saturating_add(*more));
    if triangles > MOST_TRIANGLES {
        let instances = desc.instances.len();
        return Err(Error::CannotBake(format!(
            "{instances} instances have {triangles} triangles in all, more than the {MOST_TRIANGLES} of an atlas"
        )));
    }
    let mut placed = desc.clone();
    placed.instances.clear();
    placed.groups.clear();
    for instance in &desc.instances {
        let shapes = desc.groups.get(instance.group).map_or(&[][..], |group| &group.shapes);
        placed.shapes.extend(shapes.iter().map(|shape| Shape {
            world_from_object: instance.world_from_group * shape.world_from_object,
            ..shape.clone()
        }));
    }
    Ok(placed)
}

//! Models in coordinates of a country, which single precision has no room for, are moved near the origin.

use std::collections::HashMap;
use steradian_math::Transform;
use steradian_scene::SceneDesc;

/// Coordinates from here on have steps of 1/128 and more in single precision.
pub const FAR: f64 = 65_536.0;

/// Offset subtracted from all positions of a model with this first position: whole numbers, so that it can be added
/// again without an error; zero along axes that are not far.
pub(super) fn origin(first: [f64; 3]) -> [f64; 3] {
    first.map(|v| if v.abs() >= FAR && v.abs() <= f64::from(f32::MAX) { v.round() } else { 0.0 })
}

/// Places the shapes of meshes that were moved, by their index and what was taken away, where their files have them:
/// transforms have room for what positions have not.
pub(crate) fn put_back(desc: &mut SceneDesc, origins: &[(usize, [f64; 3])]) {
    let moved: HashMap<usize, Transform> = origins
        .iter()
        .filter(|(_, origin)| *origin != [0.0; 3])
        .map(|(mesh, origin)| (*mesh, Transform::translate((*origin).into())))
        .collect();
    if moved.is_empty() {
        return;
    }
    for shape in desc.shapes.iter_mut().chain(desc.groups.iter_mut().flat_map(|group| &mut group.shapes)) {
        if let Some(back) = shape.mesh.and_then(|mesh| moved.get(&mesh)) {
            shape.world_from_object = shape.world_from_object * *back;
        }
    }
}

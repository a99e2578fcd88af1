//! Scenes whose details lie so far from the origin that single precision loses them are compiled around a point near
//! these details. Places are composed in double precision before they are rounded.

use super::precision::each_placed;
use std::collections::HashSet;
use steradian_math::{DVec3, Transform};
use steradian_scene::{Family, Node, NodeId, SceneDesc, Value};

/// The point that becomes the origin, and the description around it; `None` where nothing is gained, or where
/// something depends on places that cannot be moved.
pub(super) fn recentred(desc: &SceneDesc) -> Option<(DVec3, SceneDesc)> {
    let origin = origin(desc)?;
    (!is_bound(desc)).then(|| (origin, moved(desc, origin)))
}

/// The middle of what is coarse, where fewer meshes are coarse as seen from there.
fn origin(desc: &SceneDesc) -> Option<DVec3> {
    let (mut min, mut max, mut before) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0_u64);
    each_placed(desc, |_, placed| {
        if placed.is_coarse(DVec3::ZERO) {
            (min, max, before) = (min.min(placed.min), max.max(placed.max), before + 1);
        }
    });
    if before == 0 {
        return None;
    }
    let (middle, size) = ((min + max) / 2.0, (max - min).max_element());
    // Steps of a power of two, so that places stay exact, and nothing along axes that are not far.
    let step = (size / 4.0).max(f64::MIN_POSITIVE).log2().floor().exp2();
    let rounded = (middle / step).round() * step;
    let origin = DVec3::select(middle.abs().cmpgt(DVec3::splat(size)), rounded, DVec3::ZERO);
    let mut after = 0_u64;
    each_placed(desc, |_, placed| after += u64::from(placed.is_coarse(origin)));
    (origin.is_finite() && after < before).then_some(origin)
}

/// True if textures are looked up at positions that do not move with the world: those of groups that are displaced by
/// them, or of lamps that project them.
fn is_bound(desc: &SceneDesc) -> bool {
    let is_by_texture = |node: &Node| node.get("displacement").is_some() || node.kind == "height_field";
    let is_solid = |id: NodeId| !matches!(desc.node(id).kind.as_str(), "image" | "distance_field" | "constant");
    desc.groups.iter().flat_map(|group| &group.shapes).any(|shape| is_by_texture(desc.node(shape.node)))
        || desc.lights.iter().any(|light| desc.node(*light).node("texture").is_some_and(is_solid))
}

/// A description whose origin is another point.
fn moved(desc: &SceneDesc, origin: DVec3) -> SceneDesc {
    let mut desc = desc.clone();
    let (there, back) = (Transform::translate(-origin), Transform::translate(origin));
    desc.shapes.iter_mut().for_each(|shape| shape.world_from_object = there * shape.world_from_object);
    for instance in &mut desc.instances {
        instance.world_from_group = there * instance.world_from_group;
        if let Some(movement) = &mut instance.movement {
            movement.end = there * movement.end;
        }
    }
    let lights: HashSet<NodeId> = desc.lights.iter().copied().collect();
    for (id, node) in (0..).map(NodeId).zip(&mut desc.nodes) {
        match node.family {
            Family::Camera => {
                place(node, "to_world", |t| there * t);
                if node.get("to_world_end").is_some() {
                    place(node, "to_world_end", |t| there * t);
                }
            }
            Family::Light if lights.contains(&id) => move_light(node, origin),
            Family::Medium if knows(node, "to_world") => place(node, "to_world", |t| there * t),
            Family::Texture if knows(node, "texture_from_world") => {
                place(node, "texture_from_world", |t| t * back);
            }
            _ => {}
        }
    }
    desc
}

/// True if a model has a parameter.
fn knows(node: &Node, name: &str) -> bool {
    node.family.model(&node.kind).is_some_and(|model| model.parameter(name).is_some())
}

/// Changes a transform, which is the identity where it is absent; what is none is left to be reported.
fn place(node: &mut Node, name: &str, changed: impl Fn(Transform) -> Transform) {
    let param = node.param(name).map(|p| (p.span, p.value.clone()));
    match param {
        None => _ = node.set(name, changed(Transform::IDENTITY), None),
        Some((span, Value::Transform(t))) => _ = node.set(name, changed(t), span),
        Some(_) => {}
    }
}

/// Moves a light that is no part of a shape. Those at infinity stay, but for their portals.
fn move_light(node: &mut Node, origin: DVec3) {
    if let Some(Value::Floats(corners)) = node.params.iter_mut().find(|p| p.name == "portal").map(|p| &mut p.value) {
        corners.iter_mut().zip(origin.to_array().iter().cycle()).for_each(|(c, o)| *c -= o);
    }
    if !matches!(node.kind.as_str(), "point" | "spot" | "goniometric" | "projection") {
        return;
    }
    let position = node.param("position").map(|p| p.span).zip(node.vec3("position"));
    let within = position.map_or(DVec3::ZERO, |(_, p)| p.into());
    if let Some((span, _)) = position {
        node.set("position", [0.0; 3], span);
    }
    place(node, "to_world", |t| Transform::translate(-origin) * t * Transform::translate(within));
}

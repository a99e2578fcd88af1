//! A scene of one shape, with a camera and a light: what tests of textures and their gallery look at.

use steradian_compile::{Options, compile};
use steradian_core::Scene;
use steradian_scene::{Family, Mesh, Node, NodeId, SceneDesc, Shape};

/// Adds a shape to a description, with a camera and a point light.
pub fn add(desc: &mut SceneDesc, shape: Node, mesh: Option<Mesh>, material: Option<Node>) -> NodeId {
    let material = material.map(|m| desc.add(m));
    let node = desc.add(shape);
    let mesh = mesh.map(|m| desc.add_mesh(m));
    desc.shapes.push(Shape { mesh, material, ..Shape::new(node) });
    let camera = desc.add(Node::new(Family::Camera, "perspective", None));
    desc.cameras.push(camera);
    let light = desc.add(Node::new(Family::Light, "point", None));
    desc.lights.push(light);
    node
}

/// Compiles a description that must be without a fault, or tells what was said about it.
pub fn compiled(desc: &SceneDesc) -> Result<Scene, Vec<String>> {
    let compiled = compile(desc, &Options::default());
    let said: Vec<String> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
    if said.is_empty() { compiled.scene.ok_or_else(Vec::new) } else { Err(said) }
}

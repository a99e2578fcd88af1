//! Scenes in which light is never lost, so that nothing but the integrators' own bounds ends a path: for every
//! integrator.

use crate::case::{Case, Expect::Picture};
use steradian::{
    cornell,
    scene::{Family, Format, Node, NodeId, SceneDesc, Shape},
};

/// The lab's camera and light within spheres of a material, one around the other.
fn spheres(material: Node, count: usize, step: f64) -> SceneDesc {
    let mut scene = SceneDesc { format: Format::Native, shapes: Vec::new(), ..cornell::point_light() };
    let material = scene.add(material);
    for i in 0..count {
        let sphere = scene.add(Node::new(Family::Shape, "sphere", None).with("radius", 10.0 + step * i as f64));
        scene.shapes.push(sphere_of(sphere, material));
    }
    scene
}

fn sphere_of(node: NodeId, material: NodeId) -> Shape {
    Shape { material: Some(material), ..Shape::new(node) }
}

fn material(kind: &str) -> Node {
    Node::new(Family::Material, kind, None)
}

/// Fog that absorbs nothing, in a sphere before the camera.
fn fog(sigma_s: f64) -> SceneDesc {
    let mut scene = cornell::point_light();
    let fog = scene.add(Node::new(Family::Medium, "homogeneous", None).with("sigma_s", sigma_s).with("sigma_a", 0.0));
    let interface = scene.add(material("interface"));
    let sphere = scene.add(Node::new(Family::Shape, "sphere", None).with("radius", 0.8));
    let shape = Shape { interior: Some(fog), is_medium_boundary: true, ..sphere_of(sphere, interface) };
    scene.shapes.push(shape);
    scene
}

pub fn table() -> Vec<Case> {
    let white = || material("diffuse").with("reflectance", 1.0);
    let scenes: [(&str, SceneDesc); 9] = [
        ("a white sphere", spheres(white(), 1, 0.0)),
        ("a mirror", spheres(material("conductor"), 1, 0.0)),
        ("a rough mirror", spheres(material("conductor").with("alpha_u", 1.0), 1, 0.0)),
        ("30 spheres of glass", spheres(material("dielectric"), 30, 0.1)),
        ("30 panes", spheres(material("thin_dielectric"), 30, 0.1)),
        ("100 spheres that are not seen", spheres(material("interface"), 100, 0.1)),
        ("200 spheres at one place that are not seen", spheres(material("interface"), 200, 0.0)),
        ("fog of 10⁵ per metre", fog(1e5)),
        ("fog of 10³⁰ per metre", fog(1e30)),
    ];
    let mut cases = Vec::new();
    for (name, scene) in scenes {
        // The effort of radiosity is in its patches: no path of it is long.
        for integrator in Family::Integrator.kinds().filter(|name| !["radiosity", "raster"].contains(name)) {
            // A large number is no limit either; it reaches all integrators the same way.
            let depths: &[i64] = if integrator.starts_with("path") { &[-1, 1_000_000_000] } else { &[-1] };
            for &depth in depths {
                let mut scene = scene.clone();
                let mut node = Node::new(Family::Integrator, integrator, None).with("max_depth", depth);
                // A few rays of those of a hemisphere are as long as all.
                if ["gather", "irradiance-cache"].contains(&integrator) {
                    node.set("rays", 16_i64, None).set("branches", 64_i64, None);
                }
                scene.integrator = Some(scene.add(node));
                let mut case = Case::new(format!("{name}, {integrator}, depth {depth}"), "none", "", Picture);
                (case.description, case.small) = (Some(scene), true);
                cases.push(case);
            }
        }
    }
    cases
}

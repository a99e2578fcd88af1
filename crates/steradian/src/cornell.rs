//! The built-in scenes: the Cornell box of the path-tracing lab, lit by a point, or by its ceiling.
//!
//! Planes obey `n·x + d = 0` with normals that point inwards; the camera stands at (0, 0, −3.5) before the open front
//! and looks along +z through an image plane at distance 3 that is two units wide.

use steradian_scene::{ColorSpace, Family, Format, Node, NodeId, SceneDesc, Shape, SpectrumValue, Transform, Value};

/// The built-in scenes: name, and what it shows.
pub const BUILTIN: &[(&str, &str)] = &[
    ("cornell-box", "the lab's box with a point light"),
    ("cornell-box-area", "the lab's box with a luminous ceiling"),
];

/// A built-in scene by name.
pub fn builtin(name: &str) -> Option<SceneDesc> {
    match name {
        "cornell-box" => Some(point_light()),
        "cornell-box-area" => Some(luminous_ceiling()),
        _ => None,
    }
}

fn rgb(r: f64, g: f64, b: f64) -> Value {
    Value::Spectrum(SpectrumValue::Rgb([r, g, b], ColorSpace::Srgb))
}

/// The box with the lab's point light at (0, 0.5, 0) of intensity one.
pub fn point_light() -> SceneDesc {
    let mut scene = empty_box();
    let light =
        Node::new(Family::Light, "point", None).with("position", [0.0, 0.5, 0.0]).with("intensity", rgb(1.0, 1.0, 1.0));
    let light = scene.add(light);
    scene.lights.push(light);
    scene
}

/// The box whose ceiling emits radiance one.
pub fn luminous_ceiling() -> SceneDesc {
    let mut scene = empty_box();
    let light = scene.add(Node::new(Family::Light, "area", None).with("radiance", rgb(1.0, 1.0, 1.0)));
    // The ceiling is the fourth shape.
    scene.shapes[3].emission = Some(light);
    scene
}

fn empty_box() -> SceneDesc {
    let mut scene = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let diffuse = |scene: &mut SceneDesc, name: &str, color: Value| {
        let mut node = Node::new(Family::Material, "diffuse", None).with("reflectance", color);
        node.name = Some(name.into());
        scene.add(node)
    };
    let white = diffuse(&mut scene, "white", rgb(0.75, 0.75, 0.75));
    let red = diffuse(&mut scene, "red", rgb(0.75, 0.1, 0.1));
    let green = diffuse(&mut scene, "green", rgb(0.1, 0.6, 0.1));
    let pink = diffuse(&mut scene, "pink", rgb(0.85, 0.5, 0.65));
    let blue = diffuse(&mut scene, "blue", rgb(0.45, 0.75, 0.85));
    let shape = |scene: &mut SceneDesc, node: Node, material: NodeId| {
        let node = scene.add(node);
        scene.shapes.push(Shape { material: Some(material), ..Shape::new(node) });
    };
    let plane = |n: [f64; 3]| Node::new(Family::Shape, "plane", None).with("normal", n).with("distance", 1.0);
    shape(&mut scene, plane([1.0, 0.0, 0.0]), red);
    shape(&mut scene, plane([-1.0, 0.0, 0.0]), green);
    shape(&mut scene, plane([0.0, 1.0, 0.0]), white);
    shape(&mut scene, plane([0.0, -1.0, 0.0]), white);
    shape(&mut scene, plane([0.0, 0.0, -1.0]), white);
    let sphere = |c: [f64; 3]| Node::new(Family::Shape, "sphere", None).with("center", c).with("radius", 0.3);
    shape(&mut scene, sphere([-0.5, -0.7, 0.25]), pink);
    shape(&mut scene, sphere([0.5, -0.7, -0.25]), blue);
    // Half the image plane's width over its distance is the tangent of half the angle of view.
    let fov = 2.0 * (1.0_f64 / 3.0).atan().to_degrees();
    let camera = Node::new(Family::Camera, "perspective", None)
        .with("fov", fov)
        .with("fov_axis", "x")
        .with("to_world", Transform::translate(steradian_math::DVec3::new(0.0, 0.0, -3.5)));
    let camera = scene.add(camera);
    scene.cameras.push(camera);
    let film = Node::new(Family::Film, "rgb", None).with("width", 256_i64).with("height", 256_i64);
    scene.film = Some(scene.add(film));
    let filter = Node::new(Family::Filter, "gaussian", None);
    scene.filter = Some(scene.add(filter));
    let sampler = Node::new(Family::Sampler, "zsobol", None).with("samples", 256_i64);
    scene.sampler = Some(scene.add(sampler));
    let integrator = Node::new(Family::Integrator, "path", None);
    scene.integrator = Some(scene.add(integrator));
    scene
}

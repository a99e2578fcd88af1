//! A scene made in code: two spheres on a floor under a sky and a lamp, rendered and saved.
//!
//!     cargo run --release -p steradian --example two_spheres -- two-spheres.png

use steradian::{
    CompileOptions, Quality, compile, image, render,
    scene::{ColorSpace, Family, Node, NodeId, SceneDesc, Shape, SpectrumValue, Transform, Value},
};

fn rgb(r: f64, g: f64, b: f64) -> Value {
    Value::Spectrum(SpectrumValue::Rgb([r, g, b], ColorSpace::Srgb))
}

fn place(scene: &mut SceneDesc, shape: Node, material: NodeId) {
    let node = scene.add(shape);
    scene.shapes.push(Shape { material: Some(material), ..Shape::new(node) });
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let output = std::env::args().nth(1).unwrap_or_else(|| "two-spheres.png".into());
    let mut scene = SceneDesc::default();

    let clay = scene.add(Node::new(Family::Material, "diffuse", None).with("reflectance", rgb(0.7, 0.35, 0.25)));
    let floor = scene.add(Node::new(Family::Material, "diffuse", None).with("reflectance", rgb(0.5, 0.5, 0.5)));
    let gold = scene.add(
        Node::new(Family::Material, "conductor", None)
            .with("eta", SpectrumValue::Named("metal-Au-eta".into()))
            .with("k", SpectrumValue::Named("metal-Au-k".into()))
            .with("alpha_u", 0.15),
    );
    let sphere = |x: f64| Node::new(Family::Shape, "sphere", None).with("center", [x, 1.0, 0.0]).with("radius", 1.0);
    place(&mut scene, sphere(-1.1), clay);
    place(&mut scene, sphere(1.1), gold);
    place(&mut scene, Node::new(Family::Shape, "plane", None).with("normal", [0.0, 1.0, 0.0]), floor);

    let sky = scene.add(Node::new(Family::Light, "environment", None).with("radiance", rgb(0.4, 0.5, 0.7)));
    let lamp = scene.add(
        Node::new(Family::Light, "point", None)
            .with("position", [3.0, 5.0, -4.0])
            .with("intensity", rgb(60.0, 55.0, 45.0)),
    );
    scene.lights.extend([sky, lamp]);

    let eye = Transform::look_at([0.0, 2.5, -8.0].into(), [0.0, 0.8, 0.0].into(), [0.0, 1.0, 0.0].into())
        .ok_or("the camera looks along its up vector")?;
    let camera = scene.add(Node::new(Family::Camera, "perspective", None).with("fov", 32.0).with("to_world", eye));
    scene.cameras.push(camera);

    let compiled = compile(&scene, &CompileOptions { size: Some((320, 180)), ..CompileOptions::default() });
    let compiled_scene = compiled.scene.ok_or_else(|| format!("{:?}", compiled.diagnostics))?;
    let picture = render(&std::sync::Arc::new(compiled_scene), &Quality { spp: Some(32), ..Quality::default() })?;
    image::write(std::path::Path::new(&output), &picture, &image::WriteOptions::default())?;
    Ok(())
}

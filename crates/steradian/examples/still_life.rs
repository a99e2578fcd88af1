//! A scene by typed builders: a golden ball, a glass ball and a lacquered one on a checkerboard, under a lamp and a sky.
//!
//!     cargo run --release -p steradian --example still_life -- still-life.png

use steradian::{
    CompileOptions, Quality, Scene, compile, image, render,
    scene::build::{AreaLight, Camera, Checkerboard, DistantLight, Material, Sky, Sphere, TriangleMesh, glass, metal},
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let output = std::env::args().nth(1).unwrap_or_else(|| "still-life.png".into());
    let board = Checkerboard::new([0.7, 0.7, 0.65], [0.15, 0.17, 0.2]).repeat(10.0, 10.0);
    let desc = Scene::builder()
        .camera(Camera::look_at([0.0, 2.5, -7.0], [0.0, 0.7, 0.0]).fov(30.0).lens(0.03, 7.2))
        .size(240, 135)
        .add(
            TriangleMesh::parallelogram([-5.0, 0.0, 5.0], [10.0, 0.0, 0.0], [0.0, 0.0, -10.0]),
            Material::diffuse(board),
        )
        .add(Sphere::new([-2.1, 0.9, 0.3], 0.9), Material::conductor(metal::GOLD).roughness(0.15))
        .add(Sphere::new([0.0, 0.8, -0.6], 0.8), Material::dielectric(glass::BK7))
        .add(Sphere::new([2.0, 0.9, 0.4], 0.9), Material::coated([0.5, 0.06, 0.05]).roughness(0.05).named("lacquer"))
        .lamp(
            TriangleMesh::parallelogram([-1.0, 4.5, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]),
            AreaLight::new([8.0, 7.5, 6.5]).named("lamp"),
        )
        .light(DistantLight::new([0.4, -1.0, 0.6], [0.8, 0.75, 0.6]).named("sun"))
        .light(Sky::new([0.25, 0.35, 0.5]))
        .build();
    let compiled = compile(&desc, &CompileOptions::default());
    let scene = compiled.scene.ok_or_else(|| format!("{:?}", compiled.diagnostics))?;
    let picture = render(&std::sync::Arc::new(scene), &Quality { spp: Some(16), ..Quality::default() })?;
    image::write(std::path::Path::new(&output), &picture, &image::WriteOptions::default())?;
    Ok(())
}

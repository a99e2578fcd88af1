//! Models and a method of one's own in one scene, that of `scene.steradian` beside this file:
//! `cargo run --release -p steradian --example own_models -- SCENE own.png`
#![expect(clippy::print_stderr, reason = "output of the program")]

mod camera;
mod light;
mod material;
mod medium;
mod method;
mod shape;
mod texture;

use std::{error::Error, path::Path};
use steradian::{Quality, Registry, RegistryError, image};

/// All that is of one's own.
fn registry() -> Result<Registry, RegistryError> {
    Registry::new()
        .material(&material::MODEL, material::Glossy)?
        .texture(&texture::MODEL, texture::Rings::new)?
        .shape(&shape::MODEL, shape::Torus::new)?
        .light(&light::MODEL, light::Beam::new)?
        .medium(&medium::MODEL, medium::Fog::new)?
        .camera(&camera::MODEL, camera::Fisheye::new)?
        .method(&method::MODEL, method::KIND)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (scene, output, integrator) = match &arguments[..] {
        [scene, output] => (scene, output, None),
        [scene, output, integrator] => (scene, output, Some(integrator.clone())),
        _ => return Err("usage: own_models SCENE OUTPUT [INTEGRATOR]".into()),
    };
    let registry = registry()?;
    let (scene, messages) = registry.open(scene)?;
    messages.iter().for_each(|message| eprintln!("{message}"));
    let picture = registry.render(&scene, &Quality { integrator, ..Quality::default() })?;
    Ok(image::write(Path::new(output), &picture, &Default::default())?)
}

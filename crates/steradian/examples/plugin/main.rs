//! Renders scenes with the models of this package: `cargo run --release -- scene.steradian picture.png`.

mod velvet;

use std::{error::Error, io::Write, path::Path};
use steradian::{Quality, Registry, RegistryError, image};

/// The models of this package. Each has a row here, and scenes name it by its kind.
fn registry() -> Result<Registry, RegistryError> {
    Registry::new().material(&velvet::MODEL, velvet::Velvet)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, picture] = &arguments[..] else { return Err("usage: SCENE PICTURE".into()) };
    let registry = registry()?;
    let (scene, messages) = registry.open(scene)?;
    messages.iter().try_for_each(|message| writeln!(std::io::stderr(), "{message}"))?;
    let rendered = registry.render(&scene, &Quality::default())?;
    Ok(image::write(Path::new(picture), &rendered, &Default::default())?)
}

#[cfg(test)]
mod tests {
    use super::registry;
    use steradian::{
        instruments::{Specimen, laws::laws},
        load_bytes,
    };

    /// Values are not negative, the same with the directions exchanged, no more light leaves than arrives, and
    /// directions are drawn by the density that is told for them.
    #[test]
    fn the_material_keeps_the_laws() {
        let registry = registry().expect("models that go together");
        let scene = "steradian: 1, camera: {camera: perspective}, lights: [{light: environment}],
            shapes: [{shape: sphere, material: {material: velvet, rim: 0.8}}]";
        let loaded = load_bytes("scene", scene.into(), Some("steradian"), &registry.reading());
        let loaded = loaded.compile(&registry.compiling());
        let scene = loaded.scene.unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
        // The first material is that of shapes without one.
        let found = laws(&Specimen::new(&scene, 1), 20_000);
        assert!(found.hold, "{:#?}", found.laws.iter().filter(|law| !law.holds).collect::<Vec<_>>());
    }
}

//! The scenes under `shared/assets/pbrt`.

use super::*;

pub const SCENES: [&str; 6] = ["coffee", "cornell-box", "hair-curl", "staircase2", "veach-mis", "volumetric-caustic"];

/// The file of a published scene, or `None` with a word about it.
pub fn path(name: &str) -> Option<std::path::PathBuf> {
    steradian_testkit::asset(&format!("pbrt/{name}/scene-v4.pbrt"))
}

fn scene(name: &str) -> Option<SceneDesc> {
    let Import { desc, diagnostics } = import(&path(name)?, &Options::default());
    let messages: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{name}: {}", messages.join("\n"));
    assert_eq!((desc.format, desc.cameras.len()), (Format::Pbrt, 1));
    Some(desc)
}

#[test]
fn all_import_without_a_word() {
    let counts: Vec<_> = SCENES
        .iter()
        .filter_map(|name| scene(name).map(|d| (*name, d.shapes.len(), d.face_count(), d.lights.len())))
        .collect();
    for (name, shapes, faces, lights) in counts {
        let expected = match name {
            "coffee" => (23, 235_271, 0),
            "cornell-box" => (8, 36, 0),
            "hair-curl" => (1, 0, 2),
            "staircase2" => (32, 30_927, 0),
            "veach-mis" => (9, 52, 0),
            _ => (8, 14, 0),
        };
        assert_eq!((shapes, faces, lights), expected, "{name}");
    }
}

#[test]
fn coffee_has_its_camera_and_materials() {
    let Some(d) = scene("coffee") else { return };
    let to_world = camera(&d).transform("to_world").unwrap();
    // The camera stands at the image of its origin, in front of the machine.
    let eye = image_of(to_world, [0.0; 3]);
    assert_near(eye.map(|v| (v * 1e3).round() / 1e3), [-0.003, 0.198, 0.828]);
    assert_eq!(camera(&d).float("fov"), Some(25.0));
    let film = d.node(d.film.unwrap());
    assert_eq!((film.int("width"), film.int("height")), (Some(800), Some(1000)));
    let filter = d.node(d.filter.unwrap());
    assert_eq!((filter.kind.as_str(), filter.float("radius_x")), ("tent", Some(1.0)));
    assert_eq!(d.node(d.integrator.unwrap()).int("max_depth"), Some(17));
    let metal = d.nodes.iter().find(|n| n.name.as_deref() == Some("Metal")).unwrap();
    assert_eq!(metal.kind, "conductor");
    assert_eq!(metal.get("eta"), Some(&steradian_scene::SpectrumValue::Named("metal-Ag-eta".into()).into()));
    // Three panels emit.
    assert_eq!(d.shapes.iter().filter(|s| s.emission.is_some()).count(), 3);
    assert!(d.shapes.iter().all(|s| s.material.is_some()));
}

#[test]
fn volumetric_caustic_has_its_gas_between_boundaries() {
    let Some(d) = scene("volumetric-caustic") else { return };
    let boundaries: Vec<_> = d.shapes.iter().filter(|s| s.is_medium_boundary).collect();
    assert_eq!(boundaries.len(), 3);
    let gas = d.nodes.iter().position(|n| n.name.as_deref() == Some("gas")).unwrap() as u32;
    assert_eq!(boundaries[0].interior.map(|m| m.0), Some(gas));
    assert_eq!((boundaries[1].interior, boundaries[1].exterior.map(|m| m.0)), (None, Some(gas)));
    assert_eq!(d.node(boundaries[0].material.unwrap()).kind, "interface");
    assert_eq!(d.node(d.integrator.unwrap()).kind, "volpath");
}

#[test]
fn hair_curl_imports_its_curve_and_lights() {
    let Some(d) = scene("hair-curl") else { return };
    let curve = shape(&d);
    assert_eq!(
        (curve.kind.as_str(), curve.string("basis"), curve.string("type")),
        ("curve", Some("bspline"), Some("cylinder"))
    );
    assert!(curve.floats("points").unwrap().len() > 30);
    assert_eq!(material(&d).kind, "hair");
    let [distant, sky] = [0, 1].map(|i| d.node(d.lights[i]));
    assert_eq!(distant.kind, "distant");
    let direction = DVec3::from(distant.vec3("direction").unwrap());
    assert!((direction - DVec3::new(0.376_047, -0.758_426, -0.532_333).normalize()).length() < 1e-6);
    assert_eq!(sky.kind, "environment");
    assert!(sky.path("file").unwrap().is_file());
}

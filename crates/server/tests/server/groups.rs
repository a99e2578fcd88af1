//! The light of groups of lights, to be mixed by pages.

use crate::client::{Server, camera};
use serde_json::json;
use std::{fmt::Write, fs};
use steradian::{CompileOptions, Layer, Quality};

/// A floor under lamps of these names, each of a colour of its own.
fn floor(lamps: &[String]) -> String {
    let mut lights = String::new();
    for (k, name) in lamps.iter().enumerate() {
        let color = [[4, 1, 1], [1, 3, 1], [1, 2, 5]][k % 3];
        let x = k as f64 / 2.0 - 0.5;
        writeln!(lights, "    {name}: {{light: point, intensity: {{rgb: {color:?}}}, position: [{x}, 0.5, 1.5]}}")
            .unwrap();
    }
    format!(
        "steradian: 1\nmaterials: {{grey: {{material: diffuse, reflectance: 0.5}}}}\n\
         camera: {{camera: perspective, fov: 40, to_world: {{look_at: [0, 0, 0], from: [0, 0, 6], up: [0, 1, 0]}}}}\n\
         film: {{film: rgb, width: 24, height: 16}}\nintegrator: {{integrator: path, max_depth: 3}}\n\
         lights: {{\n{lights}}}\nshapes: [{{shape: plane, normal: [0, 0, 1], material: grey}}\n\
         {{shape: sphere, center: [0, 0, 0.5], radius: 0.5, material: grey}}]\n"
    )
}

fn halves(tile: &[u8]) -> Vec<f32> {
    tile[24..].chunks(2).map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32()).collect()
}

/// One plane for each group, in order, as the library makes them; their sum is the picture, to the rounding of halves.
/// Coarse previews have none, and neither has anything once it is switched off.
#[test]
fn groups_come_beside_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.steradian");
    let names = ["key", "fill", "rim"].map(String::from);
    fs::write(&file, floor(&names)).unwrap();
    let server = Server::of(&file);
    let mut page = server.page();
    page.until("the state", |v| v["type"] == "state");
    assert_eq!(page.state["settings"]["lightGroups"], false);
    let (end, tiles) = page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
    assert_eq!((&end["lightGroups"], tiles.len()), (&json!([]), 1));

    page.send(json!({"type": "settings", "lightGroups": true}));
    let (end, tiles) = page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
    assert_eq!(page.state["settings"]["lightGroups"], true);
    let mut order: Vec<&str> = end["lightGroups"].as_array().unwrap().iter().map(|v| v.as_str().unwrap()).collect();
    let numbers: Vec<u16> = tiles.iter().map(|t| u16::from_le_bytes([t[8], t[9]])).collect();
    assert_eq!(numbers, [0, 256, 257, 258]);
    let command = page.state["command"].as_str().unwrap();
    assert!(command.ends_with(" --aov light_groups"), "{command}");

    let desc = steradian::load(&file, &Default::default()).desc;
    let options = CompileOptions { spp: Some(4), ..CompileOptions::default() };
    let scene = std::sync::Arc::new(steradian::compile(&desc, &options).scene.unwrap());
    let quality = Quality { layers: vec![Layer::LIGHT_GROUPS], ..Quality::of("path").spp(4) };
    let picture = steradian::render(&scene, &quality).unwrap();
    let mut sum = vec![0.0; 3 * 24 * 16];
    for (name, tile) in order.iter().zip(&tiles[1..]) {
        let wanted = picture.layer_rgb(&format!("RGBA_{name}")).unwrap();
        for (k, got) in halves(tile).into_iter().enumerate() {
            let want = wanted.at(k / 3)[k % 3];
            assert!((got - want).abs() <= want.abs() / 2048.0 + 1e-7, "{name} {k}: {got} {want}");
            sum[k] += got;
        }
        assert!(halves(tile).iter().any(|v| *v > 0.01), "{name} is dark");
    }
    for ((got, want), k) in sum.iter().zip(halves(&tiles[0])).zip(0..) {
        assert!((got - want).abs() <= want.abs() / 1024.0 + 1e-7, "{k}: {got} {want}");
    }
    order.sort_unstable();
    assert_eq!(order, ["fill", "key", "rim"]);

    // A file of the picture has them, too.
    let saved = folder.path().join("a.exr");
    fs::write(&saved, server.get("api/picture.exr?layers=light_groups").body).unwrap();
    let saved = steradian::image::read(&saved, &Default::default()).unwrap();
    assert_eq!(saved.layer_rgb("RGBA_rim").unwrap().at(7), picture.layer_rgb("RGBA_rim").unwrap().at(7));

    // Nothing comes after it that a page may see instead.
    let mut moving = camera(0.25);
    moving["moving"] = json!(true);
    page.send(moving);
    let (preview, tiles) = page.until("a preview", |v| v["type"] == "frame" && v["kind"] == "preview");
    assert_eq!((&preview["lightGroups"], tiles.len()), (&json!([]), 1));

    assert_eq!(page.finished(json!({"type": "settings", "lightGroups": false}))["lightGroups"], json!([]));
    assert!(!page.state["command"].as_str().unwrap().contains("aov"));
}

/// Methods without them, denoised pictures and too many groups are refused, each with its reason.
#[test]
fn groups_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.steradian");
    let names: Vec<String> = (0..33).map(|k| format!("lamp{k}")).collect();
    fs::write(&file, floor(&names)).unwrap();
    let on = json!({"type": "settings", "lightGroups": true});
    let server = Server::of(&file);
    let mut page = server.page();
    page.until("a picture", |v| v["type"] == "frame");
    let said = page.refusal(on.clone());
    assert!(said.contains("33 groups of lights") && said.contains("at most 32"), "{said}");

    fs::write(&file, floor(&names[..32])).unwrap();
    let server = Server::of(&file);
    let mut page = server.page();
    assert_eq!(page.finished(on.clone())["lightGroups"].as_array().map(Vec::len), Some(32));
    let said = page.refusal(json!({"type": "settings", "integrator": "bdpt"}));
    assert!(said.contains("layers of groups of lights") && said.contains("'path', 'volpath' and 'raster'"), "{said}");
    let said = page.refusal(json!({"type": "settings", "denoise": "atrous"}));
    assert!(said.contains("no light groups"), "{said}");
    // 32 planes of a picture of a million pixels are the most.
    let said = page.refusal(json!({"type": "settings", "width": 1025, "height": 1024}));
    assert!(said.contains("32 groups of lights of 1025 x 1024 pixels"), "{said}");
    assert_eq!(
        (&page.state["settings"]["denoise"], &page.state["settings"]["integrator"]),
        (&json!(null), &json!("path"))
    );
}

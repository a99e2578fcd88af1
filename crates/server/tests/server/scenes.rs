//! Scenes that are dropped onto the page.

use crate::client::{Server, served};
use serde_json::json;

const QUAD: &[u8] = b"v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";

/// A model that is dropped is shown; one that is broken is told, and the scene before stays.
#[test]
fn models_are_dropped() {
    let server = Server::of("builtin:cornell-box");
    let mut page = server.page();
    page.until("a picture", |v| v["type"] == "frame");
    let broken = server.upload(&[("a.pbrt", b"WorldBegin\nShape \"spher\n")]);
    assert_eq!(broken.status, 422);
    assert!(broken.json()["error"].as_str().unwrap().contains("a.pbrt:2"), "{}", broken.text());
    assert_eq!(server.upload(&[("a.txt", b"hello")]).status, 422);
    assert_eq!(server.upload(&[]).status, 422);
    assert!(server.get("api/state").json()["scene"]["name"].as_str().unwrap().contains("cornell"));
    assert_eq!(server.upload(&[("quad.obj", QUAD)]).json()["opened"], "quad.obj");
    let state = page.until("the model", |v| v["scene"]["name"] == "quad.obj").0;
    assert_eq!(state["tone"], "pbr-neutral");
    page.until("its picture", |v| v["type"] == "frame" && v["kind"] == "render");
    // With files beside it.
    let scene = b"Camera \"perspective\" LookAt 0 0 3 0 0 0 0 1 0 WorldBegin Include \"parts/a.pbrt\"";
    let part = b"LightSource \"infinite\" Shape \"sphere\"";
    let answer = server.upload(&[("s/parts/a.pbrt", part), ("s/scene.pbrt", scene)]);
    assert_eq!(answer.status, 200, "{}", answer.text());
}

/// An archive is unpacked, and its scene shown; one that is none is told, and one that leads elsewhere.
#[test]
fn archives_are_dropped() {
    let server = Server::of("builtin:cornell-box");
    let mut page = server.page();
    page.until("a picture", |v| v["type"] == "frame");
    let folder = tempfile::tempdir().unwrap();
    let (scene, part) = (folder.path().join("scene.pbrt"), folder.path().join("part.pbrt"));
    std::fs::write(&scene, "Camera \"perspective\" LookAt 0 0 3 0 0 0 0 1 0 WorldBegin Include \"part.pbrt\"").unwrap();
    std::fs::write(&part, "LightSource \"infinite\" Shape \"sphere\"").unwrap();
    let archive = folder.path().join("ball.zip");
    steradian::archive::pack(&scene, [&*part], &archive).unwrap();
    let bytes = std::fs::read(&archive).unwrap();
    let answer = server.upload(&[("ball.zip", &bytes)]);
    assert_eq!((answer.status, answer.json()["opened"].as_str()), (200, Some("scene.pbrt")), "{}", answer.text());
    page.until("the scene", |v| v["scene"]["name"] == "scene.pbrt");
    for (name, bytes, about) in [("a.zip", &bytes[..40], "zip"), ("b.zip", b"hello", "zip")] {
        let answer = server.upload(&[(name, bytes)]);
        assert_eq!(answer.status, 422);
        assert!(answer.json()["error"].as_str().unwrap().contains(about), "{}", answer.text());
    }
    // Files of the archive are there as long as its scene is shown, and nothing outside is read.
    let lost = folder.path().join("lost.pbrt");
    std::fs::write(&lost, format!("WorldBegin Include \"{}\"", part.display())).unwrap();
    steradian::archive::pack(&lost, [], &archive).unwrap();
    let answer = server.upload(&[("c.zip", &std::fs::read(&archive).unwrap())]);
    assert_eq!(answer.status, 422, "{}", answer.text());
    assert_eq!(server.get("api/state").json()["scene"]["name"], "scene.pbrt");
    assert_eq!(server.upload(&[("quad.obj", QUAD)]).status, 200);
}

/// Pages are told what the integrator that a file names leaves out of its scene.
#[test]
fn limits_of_integrators_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fog.xml");
    let fog = "<shape type='cube'><bsdf type='null'/><medium name='interior' type='homogeneous'/></shape>";
    let text = |integrator: &str| {
        format!(
            "<scene version='3.0.0'>{integrator}<sensor type='perspective'/><emitter type='constant'/>{fog}</scene>"
        )
    };
    let said = |integrator: &str| {
        std::fs::write(&path, text(integrator)).unwrap();
        Server::of(&path).get("api/state").json()["scene"]["messages"].to_string()
    };
    let what = "integrator 'path' leaves out participating media; 'volpath' renders it";
    assert!(said("<integrator type='path'/>").contains(what), "{}", said("<integrator type='path'/>"));
    assert!(!said("").contains("leaves out"), "{}", said(""));
}

/// Scenes that are dropped read nothing outside what came with them: by no format, path or link of theirs.
#[test]
fn dropped_scenes_read_nothing_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let secret = folder.path().join("secret.ply");
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::fs::write(&secret, ply).unwrap();
    let absolute = secret.display().to_string();
    let up = format!("../{}/secret.ply", folder.path().file_name().unwrap().to_string_lossy());
    let server = Server::of("builtin:cornell-box");
    for path in [absolute.as_str(), up.as_str()] {
        let pbrt = format!("Camera \"perspective\" WorldBegin Shape \"plymesh\" \"string filename\" \"{path}\"");
        let include = format!("Camera \"perspective\" WorldBegin Include \"{path}\"");
        let xml = format!(
            "<scene version='3.0.0'><sensor type='perspective'/><shape type='ply'>\
             <string name='filename' value='{path}'/></shape></scene>"
        );
        let xml_include = format!("<scene version='3.0.0'><include filename='{path}'/></scene>");
        let gltf = serde_json::json!({
            "asset": {"version": "2.0"},
            "buffers": [{"uri": path, "byteLength": 3}],
            "bufferViews": [{"buffer": 0, "byteLength": 3}],
            "accessors": [{"bufferView": 0, "componentType": 5121, "count": 3, "type": "SCALAR"}],
            "images": [{"uri": path}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}],
        })
        .to_string();
        let own = format!(
            "steradian: 1\ncameras: [{{camera: perspective}}]\nshapes: [{{shape: mesh, mesh: {{file: \"{path}\"}}}}]\n"
        );
        let files = [
            ("a.pbrt", pbrt),
            ("b.pbrt", include),
            ("c.xml", xml),
            ("d.xml", xml_include),
            ("e.gltf", gltf),
            ("f.steradian", own),
        ];
        for (name, text) in files {
            let answer = server.upload(&[(name, text.as_bytes())]);
            let state = server.get("api/state").text();
            let said = answer.text() + &state;
            let refusals = ["is outside the scene's folder", "leads out of the folder"];
            assert!(refusals.iter().any(|why| said.contains(why)), "{name} {path}: {said}");
            assert!(answer.status == 422 || !state.contains("\"faces\":1,"), "{name} {path}: {said}");
        }
    }
    let long = format!("{}.obj", "x".repeat(300));
    for name in ["../x.obj", "/tmp/x.obj", "a/../../x.obj", "a\\..\\x.obj", "a\u{202e}.obj", &long] {
        assert_eq!(server.upload(&[(name, QUAD)]).status, 400, "{name}");
    }
    // A file is no folder.
    assert_eq!(server.upload(&[("a", QUAD), ("a/x.obj", QUAD)]).status, 400);
    assert_eq!(server.upload(&[("a/x.obj", QUAD), ("a", QUAD)]).status, 400);
}

/// A picture that is dropped by itself becomes the environment map, upright and not mirrored for its camera; it is
/// taken back as other edits are, and saved with the scene.
#[test]
fn environment_maps_are_dropped() {
    let folder = tempfile::tempdir().unwrap();
    // Red and green tell the angle around it from left to right, blue what is above.
    let mut picture = b"PF\n32 4\n-1.0\n".to_vec();
    // Rows from the lowest.
    for blue in [1.0_f32, 1.0, 2.0, 2.0] {
        for column in 0..32 {
            let (sine, cosine) = ((column as f32 + 0.5) / 32.0 * std::f32::consts::TAU).sin_cos();
            [1.5 + cosine, 1.5 + sine, blue].iter().for_each(|v| picture.extend(v.to_le_bytes()));
        }
    }
    let angle = |column: usize, image: &[[f32; 3]]| {
        let mean = |c: usize| (0..16).map(|row| image[24 * row + column][c]).sum::<f32>() / 16.0;
        (mean(1) - 1.5).atan2(mean(0) - 1.5)
    };
    // By how much it turns from the left of a picture to the right, 90 degrees apart but for a pixel, and what is
    // above.
    let seen = |image: &[[f32; 3]]| {
        let [left, right] = [0, 23].map(|column| angle(column, image));
        ((right - left).rem_euclid(std::f32::consts::TAU), image[24 + 12][2] / image[14 * 24 + 12][2])
    };
    let check = |name: &str, image: &[[f32; 3]]| {
        let (turn, above) = seen(image);
        assert!((turn - 1.6).abs() < 0.35, "{name}: {turn}");
        assert!(above > 1.5, "{name}: {above}");
    };
    let mirrored = "Scale -1 1 1 LookAt 0 0 0  1 0 0  0 0 1";
    let pbrt =
        |view: &str| format!("{view} Camera \"perspective\" \"float fov\" 90 WorldBegin LightSource \"infinite\"");
    let xml = |axes: &str| {
        format!(
            "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='90'/><transform \
             name='to_world'><lookat origin='0,0,0' {axes}/></transform></sensor><emitter type='constant'/></scene>"
        )
    };
    let scenes = [
        ("z.pbrt", pbrt("LookAt 0 0 0  1 0 0  0 0 1")),
        ("mirrored.pbrt", pbrt(mirrored)),
        ("y.pbrt", pbrt("LookAt 0 0 0  0 0 1  0 1 0")),
        ("y.xml", xml("target='0,0,-1' up='0,1,0'")),
        ("z.xml", xml("target='0,-1,0' up='0,0,1'")),
    ];
    for (name, text) in scenes {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let server = Server::of(&path);
        let mut page = server.page();
        page.until("the picture", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
        let answer = server.upload(&[("studio.pfm", &picture)]);
        assert_eq!(answer.json()["environment"], "studio.pfm", "{}", answer.text());
        page.until("it", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
        let image = served(&server).to_rgb().unwrap();
        check(name, &image);
        page.finished(json!({"type": "undo"}));
        let plain = served(&server).to_rgb().unwrap();
        let blue = |row: usize| plain[24 * row..24 * (row + 1)].iter().map(|p| p[2]).sum::<f32>();
        assert!((blue(1) / blue(14) - 1.0).abs() < 0.2, "{name}: {} {}", blue(1), blue(14));
        page.finished(json!({"type": "redo"}));
        assert_eq!(served(&server).to_rgb().unwrap(), image);
        let file = format!("{name}.steradian");
        assert_eq!(server.post("api/save", &json!({"name": file})).status, 200);
        let saved = steradian::load(folder.path().join(file), &Default::default());
        let options = steradian::CompileOptions { size: Some((24, 16)), ..Default::default() };
        let scene = std::sync::Arc::new(steradian::compile(&saved.desc, &options).scene.unwrap());
        let image = steradian::render(&scene, &steradian::Quality::of("path").spp(4)).unwrap();
        check("saved", &image.to_rgb().unwrap());
    }
    let server = Server::of("builtin:cornell-box");
    assert_eq!(server.upload(&[("studio.pfm", b"PF\n1 1\n")]).status, 422);
}

/// A scene that needs more memory than there is is refused, be it dropped or the first.
#[test]
fn scenes_that_do_not_fit_are_refused() {
    let memory = |there_is: fn() -> Option<u64>| {
        let mut options = steradian_server::Options::of(std::path::Path::new("builtin:cornell-box"));
        options.source.memory = Some(there_is);
        options.settings.width = Some(640);
        options.settings.height = Some(480);
        steradian_server::View::start(&options)
    };
    let why = memory(|| Some(1 << 20)).err().expect("a refusal").to_string();
    assert!(why.contains("memory"), "{why}");
    assert!(memory(|| None).is_ok());
    assert!(memory(|| Some(1 << 30)).is_ok());
}

/// A second compilation needs no memory for pictures that are read already.
#[test]
fn what_is_in_memory_needs_none() {
    let folder = tempfile::tempdir().unwrap();
    // A picture of 3 MiB, of which 4 with all its sizes.
    let mut picture = b"PF\n512 512\n-1.0\n".to_vec();
    picture.resize(picture.len() + 512 * 512 * 12, 0);
    std::fs::write(folder.path().join("p.pfm"), picture).unwrap();
    let path = folder.path().join("a.pbrt");
    let text = "Camera \"perspective\" WorldBegin LightSource \"infinite\" Texture \"t\" \"spectrum\" \"imagemap\" \
                \"string filename\" \"p.pfm\" Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"";
    std::fs::write(&path, text).unwrap();
    // What there is before the picture is read, and after.
    static LEFT: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(5 << 20);
    let left = || Some(LEFT.swap(1 << 20, std::sync::atomic::Ordering::SeqCst));
    let settings = steradian_server::SettingsChange { width: Some(24), height: Some(16), ..Default::default() };
    let mut options = steradian_server::Options { settings, ..steradian_server::Options::of(&path) };
    options.source.memory = Some(left);
    let server = Server { view: steradian_server::View::start(&options).unwrap(), log: Default::default() };
    let mut page = server.page();
    page.finished(json!({"type": "settings", "color": "rgb"}));
    let nodes = server.get("api/nodes").json();
    let sphere = nodes.as_array().unwrap().iter().find(|n| n["kind"] == "sphere").unwrap();
    page.finished(json!({"type": "edit", "node": sphere["id"], "parameter": "radius", "value": "0.5"}));
}

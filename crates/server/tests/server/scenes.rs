//! Scenes that are dropped onto the page.

use crate::client::Server;

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
    for name in ["../x.obj", "/tmp/x.obj", "a/../../x.obj", "a\\..\\x.obj"] {
        assert_eq!(server.upload(&[(name, QUAD)]).status, 400, "{name}");
    }
}

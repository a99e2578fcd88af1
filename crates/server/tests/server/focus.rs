//! Cameras that are focused from the page.

use crate::client::Server;
use serde_json::json;

/// Pages know what focusing a lens takes: what edits call the camera, its scale in the world, and its lens.
#[test]
fn lenses_are_focused() {
    let server = Server::of("builtin:cornell-box");
    let mut page = server.page();
    page.until("the state", |v| v["type"] == "state");
    let camera = page.state["camera"].clone();
    assert_eq!((&camera["unit"], &camera["lens"]), (&json!(1.0), &json!(0.0)));
    let edit = json!({"type": "edit", "node": camera["id"], "parameter": "focal_distance", "value": "2.5"});
    page.finished(edit);
    assert!(server.get("api/scene.steradian").text().contains("focal_distance: 2.5"));
    page.finished(json!({"type": "undo"}));
    assert!(!server.get("api/scene.steradian").text().contains("focal_distance: 2.5"));

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.steradian");
    let seen = |camera: &str| {
        let text = format!("steradian: 1\ncamera: {{camera: {camera}}}\nshapes: [{{shape: sphere}}]\n");
        std::fs::write(&file, text).unwrap();
        let server = Server::of(&file);
        let mut page = server.page();
        page.until("the state", |v| v["type"] == "state");
        let camera = &page.state["camera"];
        (camera["unit"].clone(), camera["lens"].clone())
    };
    let scaled = seen("perspective, lens_radius: 0.25, to_world: [{scale: [2, 2, 2]}, {translate: [0, 0, -9]}]");
    assert_eq!(scaled, (json!(2.0), json!(0.25)));
    assert_eq!(seen("spherical"), (json!(1.0), json!(null)));
}

//! Sessions of a page: pictures as the library makes them, cameras, settings, edits, files.

use crate::client::{self, Server, camera, served};
use serde_json::json;
use steradian::{
    CompileOptions, Quality, Viewpoint,
    image::Image,
    math::{DVec3, Transform},
};

const BOX: &str = "builtin:cornell-box";

/// The picture that the library makes of the Cornell box.
fn rendered(quality: &Quality, view: Option<Viewpoint>, edit: impl FnOnce(&mut steradian::scene::SceneDesc)) -> Image {
    let mut desc = steradian::load(BOX, &Default::default()).desc;
    edit(&mut desc);
    let camera = desc.camera(None).unwrap();
    assert!(view.is_none_or(|view| view.place(&mut desc, camera)));
    let options = CompileOptions { size: Some((24, 16)), spp: quality.spp, ..CompileOptions::default() };
    let scene = std::sync::Arc::new(steradian::compile(&desc, &options).scene.unwrap());
    steradian::render(&scene, quality).unwrap()
}

/// A page is told the state first, then a picture at once, and in the end the one that the library makes, bit for bit;
/// tiles have its values as halves.
#[test]
fn pictures_come_at_once_and_end_as_the_library_makes_them() {
    let server = Server::of(BOX);
    let mut page = server.page();
    assert_eq!(page.next()["type"], "state");
    assert_eq!(page.state["film"], json!({"width": 24, "height": 16}));
    assert_eq!(page.state["command"], "steradian render builtin:cornell-box --integrator path --spp 4 --size 24x16");
    let (end, tiles) = page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
    assert_eq!((&end["samples"], &end["target"]), (&json!(4.0), &json!(4)));
    let quality = Quality::of("path").spp(4);
    let expected = rendered(&quality, None, |_| {}).to_rgb().unwrap();
    assert_eq!(served(&server).to_rgb().unwrap(), expected);
    let [tile] = &tiles[..] else { panic!("{} tiles", tiles.len()) };
    let halves: Vec<f32> = tile[24..].chunks(2).map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32()).collect();
    assert_eq!(halves.len(), 3 * 24 * 16);
    for (got, want) in halves.iter().zip(expected.as_flattened()) {
        assert!((got - want).abs() <= want.abs() / 2048.0, "{got} {want}");
    }
    // The inspector has them as they are.
    let pixel = server.get("api/pixel?x=7&y=11").json();
    let at = expected[11 * 24 + 7];
    for (name, value) in ["R", "G", "B"].into_iter().zip(at) {
        assert_eq!(pixel["channels"][name].as_f64().map(|v| v as f32), Some(value));
    }
    assert_eq!(pixel["samples"], 4);
    assert!(pixel["material"].is_string() && pixel["object"].is_string(), "{pixel}");
    assert_eq!(server.get("api/pixel?x=24&y=0").status, 404);
    assert_eq!(server.get("api/pixel?x=-1&y=0").status, 400);
}

/// A camera that was moved shows what `--look-at` shows; coarse pictures come while a hand is on it, and it goes back.
#[test]
fn cameras_move_and_go_back() {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("a picture", |v| v["type"] == "frame");
    let home = page.state["camera"].clone();
    assert_eq!((&home["movable"], &home["moved"], &home["kind"]), (&json!(true), &json!(false), &json!("perspective")));
    let mut moving = camera(0.25);
    moving["moving"] = json!(true);
    page.send(moving);
    page.until("a preview", |v| v["type"] == "frame" && v["kind"] == "preview");
    page.finished(camera(0.5));
    let view = Viewpoint { eye: DVec3::new(0.5, 0.0, -3.0), target: DVec3::ZERO, up: DVec3::Y };
    let quality = Quality::of("path").spp(4);
    assert_eq!(served(&server).to_rgb().unwrap(), rendered(&quality, Some(view), |_| {}).to_rgb().unwrap());
    let command = page.state["command"].as_str().unwrap();
    assert!(command.ends_with("--look-at 0.5,0,-3,0,0,0,0,1,0"), "{command}");
    for bad in [
        json!({"type": "camera", "eye": [0, 0, 0], "target": [0, 0, 0], "up": [0, 1, 0]}),
        json!({"type": "camera", "eye": [0, 0, 0], "target": [0, 1, 0], "up": [0, 1, 0]}),
        json!({"type": "camera", "eye": [0, 0, 1], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 180}),
        json!({"type": "camera-name", "name": "nobody's"}),
    ] {
        page.refusal(bad);
    }
    page.finished(json!({"type": "camera-reset"}));
    assert_eq!(page.state["camera"], home);
}

/// Settings, edits, undo and redo each end in the picture that the library makes with them; what is wrong is told, and
/// changes nothing.
#[test]
fn settings_and_edits_show() {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
    let before = served(&server).to_rgb().unwrap();
    page.finished(json!({"type": "settings", "integrator": "direct", "seed": 7, "spp": 2}));
    let quality = Quality { seed: Some(7), ..Quality::of("direct").spp(2) };
    assert_eq!(served(&server).to_rgb().unwrap(), rendered(&quality, None, |_| {}).to_rgb().unwrap());
    for bad in [
        json!({"type": "settings", "integrator": "pth"}),
        json!({"type": "settings", "integrator": "path:reuse=3"}),
        json!({"type": "settings", "sampler": "sobl"}),
        json!({"type": "settings", "color": "cmyk"}),
        json!({"type": "settings", "spp": 0}),
        json!({"type": "settings", "width": 0, "height": 5}),
        json!({"type": "settings", "width": 70000, "height": 70000}),
        json!({"type": "settings", "width": 5}),
        json!({"type": "region", "pixels": [5, 5, 5, 9]}),
        json!({"type": "layers", "names": ["albdo"]}),
        json!({"type": "edit", "node": "whit", "parameter": "reflectance", "value": "1"}),
        json!({"type": "edit", "node": "white", "parameter": "reflectnce", "value": "1"}),
        json!({"type": "edit", "node": "white", "parameter": "reflectance", "value": "[1, 2"}),
        json!({"type": "undo"}),
        json!({"type": "redo"}),
    ] {
        let said = page.refusal(bad.clone());
        assert!(!said.is_empty(), "{bad}");
    }
    assert_eq!(page.state["settings"]["integrator"], "direct");
    page.finished(json!({"type": "settings", "integrator": "path", "seed": null, "spp": 4}));
    assert_eq!(served(&server).to_rgb().unwrap(), before);
    page.finished(json!({"type": "edit", "node": "white", "parameter": "reflectance", "value": "0.25"}));
    let dark = |desc: &mut steradian::scene::SceneDesc| {
        let node = desc.nodes.iter_mut().find(|n| n.name.as_deref() == Some("white")).unwrap();
        node.set("reflectance", 0.25, None);
    };
    let edited = served(&server).to_rgb().unwrap();
    assert_eq!(edited, rendered(&Quality::of("path").spp(4), None, dark).to_rgb().unwrap());
    assert_eq!((&page.state["undo"], &page.state["redo"]), (&json!(1), &json!(0)));
    assert!(server.get("api/scene.steradian").text().contains("0.25"));
    page.finished(json!({"type": "undo"}));
    assert_eq!(served(&server).to_rgb().unwrap(), before);
    page.finished(json!({"type": "redo"}));
    assert_eq!(served(&server).to_rgb().unwrap(), edited);
}

/// Regions and layers come as asked.
#[test]
fn regions_and_layers_come_as_asked() {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
    let whole = served(&server).to_rgb().unwrap();
    let end = page.finished(json!({"type": "region", "pixels": [4, 3, 9, 13]}));
    assert_eq!((&end["width"], &end["height"], &end["origin"]), (&json!(5), &json!(10), &json!([4, 3])));
    let part = served(&server).to_rgb().unwrap();
    for (k, value) in part.iter().enumerate() {
        assert_eq!(*value, whole[(3 + k / 5) * 24 + 4 + k % 5]);
    }
    page.finished(json!({"type": "region", "pixels": null}));
    page.send(json!({"type": "layers", "names": ["normal", "depth"]}));
    let (_, tiles) = page.until("layers", |v| v["type"] == "frame");
    let head = |tile: &Vec<u8>| [tile[8], tile[10]];
    assert_eq!(tiles.iter().map(head).collect::<Vec<_>>(), [[0, 3], [1, 3], [2, 1]]);
}

/// A pause holds everything still, and what was changed meanwhile is rendered after it.
#[test]
fn pauses_hold_still() {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("a picture", |v| v["type"] == "frame");
    page.send(json!({"type": "pause", "on": true}));
    page.until("the pause", |v| v["paused"] == true);
    page.send(camera(0.1));
    page.until("a preview", |v| v["type"] == "frame" && v["kind"] == "preview");
    page.send(json!({"type": "pause", "on": false}));
    page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
}

/// While a hand is on a slider its edits are one, which is taken back at once.
#[test]
fn edits_of_a_slider_are_one() {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("the state", |v| v["type"] == "state");
    let edit = |value: f64, moving: bool| {
        let value = value.to_string();
        json!({"type": "edit", "node": "white", "parameter": "reflectance", "value": value, "moving": moving})
    };
    for value in [0.1, 0.2, 0.3] {
        page.send(edit(value, true));
        page.until("a preview", |v| v["type"] == "frame" && v["kind"] == "preview");
    }
    let mut wrong = edit(0.0, true);
    wrong["value"] = json!("[1,");
    page.refusal(wrong);
    page.finished(edit(0.4375, false));
    assert_eq!((&page.state["undo"], &page.state["redo"]), (&json!(1), &json!(0)));
    page.finished(edit(0.5, false));
    assert_eq!(page.state["undo"], 2);
    page.finished(json!({"type": "undo"}));
    assert!(server.get("api/scene.steradian").text().contains("0.4375"));
    page.finished(json!({"type": "undo"}));
    assert!(!server.get("api/scene.steradian").text().contains("0.4375"));
}

/// A scene whose file changes is shown as it is now, with the camera where it was and the edits that were made; one
/// that cannot be read is told, and the picture stays.
#[test]
fn changed_files_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.steradian");
    let text = steradian::formats::native::write(&steradian::load(BOX, &Default::default()).desc, &file).unwrap().text;
    std::fs::write(&file, &text).unwrap();
    let server = Server::of(&file);
    let mut page = server.page();
    page.finished(camera(0.5));
    page.finished(json!({"type": "edit", "node": "white", "parameter": "reflectance", "value": "0.25"}));
    let before = served(&server).to_rgb().unwrap();
    let view = page.state["camera"]["eye"].clone();
    // At once, since a machine that is busy may take any time between opening a file and writing it.
    let write = |text: &str| {
        let beside = folder.path().join("b");
        std::fs::write(&beside, text).unwrap();
        std::fs::rename(beside, &file).unwrap();
    };
    write("steradian: 1\nshapes: [{shape: shpere}]");
    let (said, _) = page.until("what is wrong", |v| v["type"] == "message");
    assert!(said["text"].as_str().unwrap().contains("shpere"), "{said}");
    assert_eq!(served(&server).to_rgb().unwrap(), before);
    assert!(text.contains("radius: 0.3"), "{text}");
    write(&text.replace("radius: 0.3", "radius: 0.25"));
    page.until("the news", |v| v["type"] == "message" && v["severity"] == "note");
    page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
    assert_eq!((&page.state["camera"]["eye"], &page.state["undo"]), (&view, &json!(1)));
    let after = served(&server).to_rgb().unwrap();
    assert_ne!(after, before);
    let point = Viewpoint { eye: DVec3::new(0.5, 0.0, -3.0), target: DVec3::ZERO, up: DVec3::Y };
    let expected = rendered(&Quality::of("path").spp(4), Some(point), |desc| {
        for node in &mut desc.nodes {
            match (node.name.as_deref(), node.kind.as_str()) {
                (Some("white"), _) => node.set("reflectance", 0.25, None),
                (_, "sphere") => node.set("radius", 0.25, None),
                _ => node,
            };
        }
    });
    assert_eq!(after, expected.to_rgb().unwrap());
}

/// An edit that cannot be rendered as it is asked for leaves the scene as it was, and so does taking one back.
#[test]
fn edits_that_cannot_be_rendered_leave_the_scene() {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("the state", |v| v["type"] == "state");
    let nodes = || server.get("api/nodes").json();
    let film = nodes().as_array().unwrap().iter().find(|n| n["family"] == "film").unwrap()["id"].clone();
    let noisy = json!({"type": "edit", "node": film, "parameter": "full_well", "value": "1000"});
    page.finished(json!({"type": "settings", "denoise": "atrous"}));
    let before = nodes();
    let said = page.refusal(noisy.clone());
    assert!(said.contains("noise cannot be removed here"), "{said}");
    assert_eq!(nodes(), before);
    assert!(page.refusal(json!({"type": "undo"})).contains("nothing to undo"));
    assert!(page.refusal(json!({"type": "redo"})).contains("nothing to redo"));

    page.finished(json!({"type": "settings", "denoise": null}));
    page.finished(noisy);
    page.finished(json!({"type": "undo"}));
    page.finished(json!({"type": "settings", "denoise": "atrous"}));
    assert!(page.refusal(json!({"type": "redo"})).contains("noise cannot be removed here"));
    assert_eq!(nodes(), before);
    page.finished(json!({"type": "settings", "denoise": null}));
    page.finished(json!({"type": "redo"}));
    assert_eq!((&page.state["undo"], &page.state["redo"]), (&json!(1), &json!(0)));
}

/// Nodes without names go by the same ones in the list, in values, in edits and of pixels; outlines are by them, too.
#[test]
fn nameless_nodes_have_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.steradian");
    let text = "steradian: 1\ncameras: [{camera: perspective, to_world: {translate: [0, 0, -4]}},\n\
                {camera: perspective, to_world: {translate: [0, 0, -9]}}]\n\
                lights: [{light: environment}]\nfilm: {film: rgb, width: 24, height: 16}\n\
                shapes: [{shape: sphere, material: {material: diffuse, reflectance: {texture: checkerboard}}}]\n";
    std::fs::write(&path, text).unwrap();
    let server = Server::of(&path);
    let mut page = server.page();
    let value = |server: &Server| {
        let nodes = server.get("api/nodes").json();
        let node = nodes.as_array().unwrap().iter().find(|n| n["id"] == "diffuse 1").unwrap().clone();
        node["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "reflectance").unwrap()["value"].clone()
    };
    let before = value(&server);
    assert!(before.as_str().unwrap().contains("checkerboard 1"), "{before}");
    let edit = |value: &serde_json::Value| json!({"type": "edit", "node": "diffuse 1", "parameter": "reflectance", "value": value, "moving": false});
    page.finished(edit(&json!("0.25")));
    assert_eq!(value(&server), "0.25");
    page.finished(edit(&before));
    assert_eq!(value(&server), before);
    let pixel = server.get("api/pixel?x=12&y=8").json();
    assert_eq!((&pixel["object"], &pixel["material"]), (&json!("sphere 1"), &json!("diffuse 1")));
    let outline = server.get("api/outline?shape=sphere%201").json();
    assert!(!outline["runs"].as_array().unwrap().is_empty() && outline["handle"].is_object(), "{outline}");
    assert_eq!(server.get("api/outline?shape=cube%201").status, 404);
    // A camera without a name is chosen by its label.
    page.finished(json!({"type": "camera-name", "name": "perspective 2"}));
    assert_eq!(page.state["camera"]["name"], "perspective 2");
    assert_eq!(page.state["camera"]["eye"], json!([0.0, 0.0, -9.0]));
}

/// The edit that places something.
fn placing(node: &serde_json::Value, value: &str, moving: bool) -> serde_json::Value {
    let parameter = "to_world";
    json!({"type": "edit", "node": node, "parameter": parameter, "value": value, "moving": moving})
}

/// Placements of shapes and groups are edited as all else is: the picture is the library's, slider edits are one, and
/// it is taken back. A shape that is placed several times has a name for each place, as instances have.
#[test]
fn places_of_shapes_are_edited() {
    let server = Server::of(BOX);
    let mut page = server.page();
    let nodes = server.get("api/nodes").json();
    let block = nodes.as_array().unwrap().iter().rfind(|n| n["family"] == "shape").unwrap().clone();
    let place = block["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "to_world").unwrap().clone();
    assert_eq!(place["type"], "transform");
    let node = &block["id"];
    let edit = |value: &str, moving: bool| placing(node, value, moving);
    let up = format!("[{}, {{translate: [0, 0.25, 0]}}]", place["value"].as_str().unwrap());
    let moved = |desc: &mut steradian::scene::SceneDesc| {
        let shape = desc.shapes.last_mut().unwrap();
        shape.world_from_object = Transform::translate(DVec3::Y * 0.25) * shape.world_from_object;
    };
    page.finished(edit(&up, false));
    let quality = Quality::of("path").spp(4);
    let image = served(&server).to_rgb().unwrap();
    assert_eq!(image, rendered(&quality, None, moved).to_rgb().unwrap());
    page.finished(json!({"type": "undo"}));
    assert_eq!(served(&server).to_rgb().unwrap(), rendered(&quality, None, |_| {}).to_rgb().unwrap());
    for value in ["{translate: [0, 0.125, 0]}", "{translate: [0, 0.75, 0]}"] {
        page.send(edit(value, true));
        page.until("a preview", |v| v["type"] == "frame" && v["kind"] == "preview");
    }
    page.finished(edit(&up, false));
    assert_eq!(served(&server).to_rgb().unwrap(), image);
    assert_eq!(page.state["undo"], 1);
    for (wrong, why) in
        [("{scale: 0}", "singular"), ("{scale: [1, 2]}", "to_world:1:"), ("7", "a transform is expected")]
    {
        let said = page.refusal(edit(wrong, false));
        assert!(said.contains(why), "{wrong}: {said}");
    }
    assert_eq!(served(&server).to_rgb().unwrap(), image);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.steradian");
    let text = "steradian: 1\ncameras: [{camera: perspective, to_world: {translate: [0, 0, -4]}}]\n\
                lights: [{light: environment}]\n\
                nodes: {ball: {shape: sphere, radius: 0.5}}\n\
                shapes: [{node: ball, to_world: {translate: [-1, 0, 0]}},\n\
                {node: ball, to_world: {translate: [1, 0, 0]}}]\n\
                groups: {pair: [{shape: disk}]}\n\
                instances: [{group: pair}]\n";
    std::fs::write(&path, text).unwrap();
    let server = Server::of(&path);
    let mut page = server.page();
    let nodes = server.get("api/nodes").json();
    let nodes = nodes.as_array().unwrap();
    let places: Vec<_> = nodes.iter().filter(|n| n["family"] == "placement").collect();
    assert_eq!(places.iter().map(|n| n["kind"].as_str().unwrap()).collect::<Vec<_>>(), ["ball", "ball", "pair"]);
    let edit = |node: &serde_json::Value| placing(node, "{translate: [0, 1, 0]}", false);
    let said = page.refusal(edit(&json!("ball")));
    assert!(said.contains("placed several times, as placement 1, placement 2"), "{said}");
    let said = page.refusal(edit(&json!("placement 10")));
    assert!(said.contains("there is no node"), "{said}");
    for (k, place) in places.iter().enumerate() {
        page.finished(edit(&place["id"]));
        assert_eq!(page.state["undo"], 1 + k);
    }
    assert_eq!(server.post("api/save", &json!({"name": "b.steradian"})).status, 200);
    let saved = steradian::load(folder.path().join("b.steradian"), &Default::default()).desc;
    let up = Transform::translate(DVec3::Y);
    assert!(saved.shapes.iter().all(|s| s.world_from_object == up) && saved.instances[0].world_from_group == up);
}

/// Each request is answered once, after the state that knows of it; what is refused, too.
#[test]
fn answers_come_after_the_state_that_knows_of_them() {
    let server = Server::of(BOX);
    let mut page = server.page();
    let answered = |page: &mut client::Page| page.until("an answer", |v| v["type"] == "answered");
    for spp in 5..15 {
        page.send(json!({"type": "settings", "spp": spp}));
    }
    for spp in 5..15 {
        answered(&mut page);
        assert!(page.state["settings"]["spp"].as_u64() >= Some(spp), "{spp}: {}", page.state["settings"]);
    }
    for on in [true, false] {
        page.send(json!({"type": "pause", "on": on}));
        answered(&mut page);
        assert_eq!(page.state["paused"], on);
    }
    page.send(json!({"type": "layers", "names": ["albedo"]}));
    answered(&mut page);
    assert_eq!(page.state["layers"], json!(["albedo"]));
    for refused in [json!({"type": "undo"}), json!({"type": "quit"})] {
        page.refusal(refused);
        answered(&mut page);
        assert_eq!(page.state["settings"]["spp"], 14);
    }
}

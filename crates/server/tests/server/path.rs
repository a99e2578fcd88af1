//! Paths of single samples: where they lie in the picture, and what is refused.

use crate::client::{Server, camera};
use serde_json::{Value, json};

const PLAIN: &str = "path:reuse=1,effort=even,caustics=false";

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn path(server: &Server, x: u32, y: u32, sample: u32) -> Value {
    let answer = server.get(&format!("api/path?x={x}&y={y}&sample={sample}"));
    assert_eq!(answer.status, 200, "{}", answer.text());
    answer.json()
}

/// The first vertices of a pixel's samples have the mean that its layer of positions has, and its values the mean that
/// the picture has.
#[test]
fn paths_begin_where_the_layers_say() {
    let server = Server::of("builtin:cornell-box");
    let mut page = server.page();
    page.finished(json!({"type": "settings", "integrator": PLAIN}));
    for (x, y) in [(0, 0), (7, 11), (12, 8), (23, 15)] {
        let pixel = server.get(&format!("api/pixel?x={x}&y={y}")).json();
        let (mut place, mut value) = ([0.0; 3], [0.0; 3]);
        for sample in 0..4 {
            let path = path(&server, x, y, sample);
            assert_eq!((&path["tracer"], &path["of_picture"]), (&json!("path"), &json!(true)));
            assert_eq!(path["generation"], pixel["generation"]);
            let [camera, first] = [&path["vertices"][0], &path["vertices"][1]];
            assert_eq!((&camera["kind"], &camera["place"]), (&json!("camera"), &Value::Null));
            assert_eq!((&first["kind"], &first["weight"]), (&json!("surface"), &json!([1.0, 1.0, 1.0])));
            let (position, added) = (numbers(&first["position"]), numbers(&path["value"]));
            place = std::array::from_fn(|c| place[c] + position[c] / 4.0);
            value = std::array::from_fn(|c| value[c] + added[c] / 4.0);
        }
        for (c, (axis, color)) in ["P.X", "P.Y", "P.Z"].into_iter().zip(["R", "G", "B"]).enumerate() {
            let [layer, picture] = [axis, color].map(|name| pixel["channels"][name].as_f64().unwrap());
            assert!((place[c] - layer).abs() < 1e-6, "{x} {y} {axis}: {} {layer}", place[c]);
            assert!((value[c] - picture).abs() <= 1e-6 * picture.abs(), "{x} {y} {color}: {} {picture}", value[c]);
        }
        let object = path(&server, x, y, 0)["vertices"][1]["object"].clone();
        assert!(object.is_string(), "{object}");
    }
    // Where the camera stands now.
    page.finished(camera(0.5));
    let moved = path(&server, 12, 8, 0);
    let eye = numbers(&moved["vertices"][0]["position"]);
    assert!(eye.iter().zip([0.5, 0.0, -3.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{eye:?}");
    assert_eq!(moved["generation"], page.state["generation"]);
}

/// First vertices lie within their pixels if the filter is a box.
#[test]
fn paths_begin_within_their_pixels() {
    let server = Server::of(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/verify/glass.pbrt"));
    for (x, y, sample) in [(12, 8, 0), (9, 3, 1), (13, 12, 2), (10, 10, 70_000)] {
        let first = &path(&server, x, y, sample)["vertices"][1];
        for (at, pixel) in numbers(&first["place"]).iter().zip([x, y]) {
            let from = f64::from(pixel);
            assert!((from - 1e-4..=from + 1.0 + 1e-4).contains(at), "{x} {y}: {first}");
        }
    }
}

/// Light samples end at the lamp, which is a point: in the scene, and at one place of the picture.
#[test]
fn light_samples_lead_to_the_lamp() {
    let server = Server::of("builtin:cornell-box");
    let (mut sampled, mut lit) = (0, 0);
    for sample in 0..20 {
        for vertex in path(&server, 12, 12, sample)["vertices"].as_array().unwrap() {
            let direct = &vertex["direct"];
            if direct.is_null() {
                continue;
            }
            sampled += 1;
            lit += u32::from(numbers(&direct["light"]).iter().any(|v| *v > 0.0));
            let off = numbers(&direct["position"]).iter().zip([0.0, 0.5, 0.0]).map(|(a, b)| (a - b).abs()).sum::<f64>();
            let place = numbers(&direct["place"]);
            // The camera looks along z at its height: the lamp is in the middle column, above the middle.
            assert!(off < 1e-6 && (place[0] - 12.0).abs() < 1e-4 && (0.0..8.0).contains(&place[1]), "{direct}");
        }
    }
    assert!(sampled > 20 && lit > 10, "{sampled} {lit}");
}

/// Methods that follow no such paths show those of the path tracer, and what is not there is told.
#[test]
fn other_methods_and_errors_are_told() {
    let server = Server::of("builtin:cornell-box");
    let mut page = server.page();
    page.finished(json!({"type": "settings", "integrator": "bdpt"}));
    let path = path(&server, 3, 4, 5);
    assert_eq!((&path["tracer"], &path["of_picture"]), (&json!("path"), &json!(false)));
    for (query, status, said) in [
        ("x=24&y=0", 404, "there is no pixel 24, 0"),
        ("x=0&y=16&sample=1", 404, "there is no pixel 0, 16"),
        ("x=0&y=0&sample=16777216", 400, "from 0 to 16777215, not 16777216"),
        ("x=-1&y=0", 400, "x"),
        ("y=0", 400, "x"),
        ("x=0&y=0&sample=many", 400, "sample"),
    ] {
        let answer = server.get(&format!("api/path?{query}"));
        assert_eq!(answer.status, status, "{query}");
        assert!(answer.text().contains(said), "{query}: {}", answer.text());
    }
    assert_eq!(server.get("api/path?x=23&y=15&sample=16777215").status, 200);
}

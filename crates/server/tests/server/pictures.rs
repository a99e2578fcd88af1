//! Finished pictures: the list, layers, pixels, differences, and files that are no pictures.

use crate::client::{Answer, Server, taken};
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
};
use steradian::image::{Image, WriteOptions, encode, metrics, read_bytes, write};
use steradian_server::{Error, Pictures, View};

fn options(files: Vec<PathBuf>) -> Pictures {
    Pictures {
        files,
        tone: Some("reinhard:white=4".into()),
        exposure: None,
        bind: "127.0.0.1".into(),
        port: 0,
        log: std::sync::Arc::new(|_| {}),
    }
}

fn server(files: Vec<PathBuf>) -> Server {
    Server { view: View::pictures(&options(files)).unwrap(), log: Default::default() }
}

/// A picture of 3 × 2 pixels with a normal, a depth and a layer of five channels.
fn layered() -> Image {
    let pixels: Vec<[f32; 3]> = (0..6).map(|k| [k as f32, 0.5, 0.25]).collect();
    let mut image = Image::from_rgb(3, 2, &pixels).unwrap();
    let normals: Vec<[f32; 3]> = (0..6).map(|k| [0.0, 1.0, -(k as f32)]).collect();
    image.push_layer("N", ["X", "Y", "Z"], &normals).unwrap();
    image.push("Z", vec![1e6, 2.0, 3.0, f32::INFINITY, 5.0, 6.0]).unwrap();
    for name in ["a", "b", "c", "d", "e"] {
        image.push(format!("five.{name}"), vec![1.0; 6]).unwrap();
    }
    image
}

fn save(folder: &Path, name: &str, image: &Image) -> PathBuf {
    let path = folder.join(name);
    write(&path, image, &WriteOptions::default()).unwrap();
    path
}

fn list(server: &Server) -> Vec<Value> {
    server.get("api/pictures").json().as_array().unwrap().clone()
}

fn names(list: &[Value]) -> Vec<String> {
    let name = |v: &Value| Path::new(v["name"].as_str().unwrap()).file_name().unwrap().to_string_lossy().into_owned();
    list.iter().map(name).collect()
}

fn error(answer: &Answer) -> String {
    answer.json()["error"].as_str().unwrap().to_owned()
}

#[test]
fn files_and_those_of_folders_are_listed() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("folder");
    fs::create_dir(&folder).unwrap();
    let single = save(place.path(), "z.exr", &layered());
    save(&folder, "b.pfm", &Image::from_rgb(1, 1, &[[1.0; 3]]).unwrap());
    save(&folder, "a.hdr", &Image::from_rgb(1, 1, &[[1.0; 3]]).unwrap());
    fs::write(folder.join("notes.txt"), "no picture").unwrap();
    let server = server(vec![single.clone(), folder.clone(), place.path().join("missing.png"), single]);
    let told = list(&server);
    assert_eq!(names(&told), ["z.exr", "missing.png", "a.hdr", "b.pfm"]);
    let faults: Vec<_> = told.iter().map(|v| v["fault"].as_str()).collect();
    assert_eq!(faults, [None, Some("there is no such file"), None, None]);
    // One that comes to the folder comes to the list, and the others keep their numbers.
    save(&folder, "a.exr", &layered());
    let told = list(&server);
    assert_eq!(names(&told), ["z.exr", "missing.png", "a.hdr", "b.pfm", "a.exr"]);
    assert_eq!(told[4]["id"], 4);
    let look = server.get("api/look").json();
    assert_eq!((look["tone"].as_str(), look["exposure"].as_str()), (Some("reinhard:white=4"), Some("given")));
    assert!(look["tones"].as_array().unwrap().len() > 5);
    let page = server.get("");
    assert_eq!(page.status, 200);
    assert!(page.text().contains("pictures.js"));
    // Nothing without the token.
    assert_eq!(server.ask("GET", "/api/pictures", &format!("Host: {}\r\n", server.host()), b"").status, 403);
}

#[test]
fn layers_and_channels_are_shown() {
    let place = tempfile::tempdir().unwrap();
    let server = server(vec![save(place.path(), "a.exr", &layered())]);
    let (head, values) = taken(&server.get("api/picture?id=0"));
    assert_eq!((&head["width"], &head["height"], &head["layer"]), (&3.into(), &2.into(), &"picture".into()));
    let offered: Vec<&str> = head["layers"].as_array().unwrap().iter().map(|l| l["name"].as_str().unwrap()).collect();
    assert_eq!(offered[0], "N");
    assert!(!offered.contains(&"five") && offered.contains(&"five.e") && offered.contains(&"Z"), "{offered:?}");
    assert_eq!(values[..6], [0.0, 0.5, 0.25, 1.0, 0.5, 0.25]);
    // As `convert --layer` names it, and as the file does.
    for name in ["N", "normal"] {
        let (_, values) = taken(&server.get(&format!("api/picture?id=0&layer={name}")));
        assert_eq!(values[3..6], [0.0, 1.0, -1.0], "{name}");
    }
    let (_, depth) = taken(&server.get("api/picture?id=0&layer=Z"));
    assert_eq!(depth, [65504.0, 2.0, 3.0, 65504.0, 5.0, 6.0]);
    for (query, why) in [
        ("id=0&layer=albedo", "has no layer 'albedo'"),
        ("id=0&layer=five", "at most four channels"),
        ("id=9", "there is no picture 9"),
    ] {
        let answer = server.get(&format!("api/picture?{query}"));
        assert_eq!(answer.status, 404, "{query}");
        assert!(error(&answer).contains(why), "{}", error(&answer));
    }
    assert_eq!(server.get("api/picture?id=-1").status, 400);
}

#[test]
fn pixels_are_as_exact_as_the_file() {
    let place = tempfile::tempdir().unwrap();
    let server = server(vec![save(place.path(), "a.exr", &layered())]);
    let told = server.get("api/pixel?id=0&x=0&y=1").json();
    let channels = &told["channels"];
    assert_eq!((channels["R"].as_f64(), channels["N.Z"].as_f64()), (Some(3.0), Some(-3.0)));
    assert_eq!(channels["Z"], "inf");
    assert_eq!(server.get("api/pixel?id=0&x=0&y=0").json()["channels"]["Z"].as_f64(), Some(1e6));
    // Red before blue.
    let text = server.get("api/pixel?id=0&x=0&y=0").text();
    let at = |name: &str| text.find(name).unwrap();
    assert!(at("\"R\"") < at("\"G\"") && at("\"G\"") < at("\"B\"") && at("N.X") < at("N.Y"), "{text}");
    let outside = server.get("api/pixel?id=0&x=3&y=0");
    assert_eq!(outside.status, 404);
    assert!(error(&outside).contains("no pixel 3, 0"));
}

#[test]
fn differences_are_those_of_the_library() {
    let place = tempfile::tempdir().unwrap();
    let mut other = layered();
    other.channel_mut("G").unwrap()[2] = 0.75;
    let small = Image::from_rgb(1, 1, &[[1.0; 3]]).unwrap();
    let files = [("a.exr", &layered()), ("b.exr", &other), ("small.pfm", &small)];
    let server = server(files.map(|(name, image)| save(place.path(), name, image)).into());
    let (head, map) = taken(&server.get("api/difference?a=0&b=1&metric=absolute"));
    let changed: Vec<usize> = (0..map.len()).filter(|k| map[*k] != 0.0).collect();
    assert_eq!((changed, map[7]), (vec![7], 0.25));
    let want = metrics::compare(&layered(), &other).unwrap().rel_mse;
    assert!((head["relmse"].as_f64().unwrap() - want).abs() <= 1e-9 * want);
    let (head, _) = taken(&server.get("api/difference?a=0&b=1&metric=flip&tone=none&exposure=1&layer=N"));
    assert_eq!(head["mean"].as_f64(), Some(0.0));
    let apart = server.get("api/difference?a=0&b=2&metric=flip");
    assert_eq!(apart.status, 409);
    let why = error(&apart);
    assert!(why.contains("a.exr' has 3 x 2 pixels") && why.contains("small.pfm' has 1 x 1 pixels"), "{why}");
    let bad = server.get("api/difference?a=0&b=1&metric=flip&tone=nothing");
    assert_eq!(bad.status, 400);
}

#[test]
fn broken_files_are_told_and_changed_ones_read_anew() {
    let place = tempfile::tempdir().unwrap();
    let good = save(place.path(), "good.exr", &layered());
    let broken = place.path().join("broken.exr");
    fs::write(&broken, "no picture").unwrap();
    let server = server(vec![broken.clone(), good]);
    assert_eq!(list(&server)[0]["fault"], Value::Null);
    let refused = server.get("api/picture?id=0");
    assert_eq!(refused.status, 422);
    let told = list(&server);
    assert_eq!(told[0]["fault"].as_str().unwrap(), error(&refused));
    assert_eq!(told[1]["fault"], Value::Null);
    taken(&server.get("api/picture?id=1"));
    // It has another length, so the time of the change does not matter.
    save(place.path(), "broken.exr", &Image::from_rgb(1, 1, &[[2.0; 3]]).unwrap());
    let now = list(&server);
    assert_eq!(now[0]["fault"], Value::Null);
    assert!(now[0]["version"].as_u64() > told[0]["version"].as_u64());
    assert_eq!(taken(&server.get("api/picture?id=0")).1, [2.0; 3]);
    fs::remove_file(&broken).unwrap();
    assert_eq!(list(&server)[0]["fault"], "there is no such file");
    // More pixels than are shown, which the header alone declares.
    fs::write(&broken, "PF\n100000 100000\n-1.0\n").unwrap();
    list(&server);
    let refused = server.get("api/picture?id=0");
    assert_eq!(refused.status, 422);
    assert!(error(&refused).contains("the number of pixels"), "{}", error(&refused));
}

#[test]
fn dropped_pictures_come_to_the_list() {
    let place = tempfile::tempdir().unwrap();
    let server = server(vec![save(place.path(), "a.exr", &layered())]);
    let bytes = encode(steradian::image::FileKind::Exr, &layered(), &WriteOptions::default()).unwrap();
    assert!(read_bytes(&bytes, None, &Default::default()).is_ok());
    let answer = server.upload(&[("folder/dropped.exr", &bytes), ("folder/notes.txt", b"no picture")]);
    assert_eq!(answer.status, 200, "{}", answer.text());
    assert_eq!(answer.json()["added"], serde_json::json!([1]));
    assert_eq!(names(&list(&server)), ["a.exr", "dropped.exr"]);
    assert_eq!(taken(&server.get("api/picture?id=1")).0["width"], 3);
    let refused = server.upload(&[("notes.txt", b"no picture")]);
    assert_eq!(refused.status, 422);
    assert!(error(&refused).contains("no picture among the files"));
    assert_eq!(server.upload(&[("../a.exr", &bytes)]).status, 400);
    assert_eq!(list(&server).len(), 2);
}

#[test]
fn without_pictures_there_is_no_view() {
    let place = tempfile::tempdir().unwrap();
    let why = View::pictures(&options(vec![place.path().join("missing.exr")])).err();
    assert!(matches!(&why, Some(Error::Pictures(why)) if why.contains("missing.exr")), "{why:?}");
}

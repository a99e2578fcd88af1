//! References of the picture.

use crate::client::{Page, Server, taken};
use serde_json::{Value, json};
use steradian::image::{
    FileKind, Image, WriteOptions, encode,
    metrics::{self, DEFAULT_PIXELS_PER_DEGREE},
    read_bytes,
    tone::Tone,
};

const BOX: &str = "builtin:cornell-box";

/// A view whose picture is done.
fn done() -> (Server, Page) {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("the end", |v| v["type"] == "frame" && v["done"] == true && v["kind"] == "render");
    (server, page)
}

fn picture(server: &Server) -> Image {
    read_bytes(&server.get("api/picture.exr").body, None, &Default::default()).unwrap()
}

/// Halves have 11 bits, and those near zero a step of 2⁻²⁴.
fn assert_close(got: &[f32], want: &[f32]) {
    assert_eq!(got.len(), want.len());
    for (got, want) in got.iter().zip(want) {
        assert!((got - want).abs() <= want.abs() / 2048.0 + 6e-8, "{got} {want}");
    }
}

/// Figures of an answer against those of the library.
fn assert_figures(head: &Value, a: &Image, b: &Image, map: &[f32]) {
    let all = metrics::compare(a, b).unwrap();
    let mean = map.iter().map(|v| f64::from(*v)).sum::<f64>() / map.len() as f64;
    let mut sorted = map.to_vec();
    sorted.sort_by(f32::total_cmp);
    let quantile = sorted[(0.95 * map.len() as f64).ceil() as usize - 1];
    for (name, want) in
        [("relmse", all.rel_mse), ("psnr", all.psnr), ("mean", mean), ("quantile95", f64::from(quantile))]
    {
        let got = head[name].as_f64().unwrap();
        assert!((got - want).abs() <= 1e-9 * want.abs(), "{name}: {got} {want}");
    }
}

/// A picture that is kept stays as it is while others come, and differs from itself by nothing.
#[test]
fn a_picture_is_kept() {
    let (server, mut page) = done();
    assert_eq!(server.get("api/reference").status, 204);
    assert_eq!(server.get("api/difference?metric=flip").status, 404);
    let about = server.post("api/reference?from=current", &json!(null)).json();
    assert_eq!((&about["width"], &about["height"], &about["crop"]), (&json!(24), &json!(16), &json!([0, 0, 24, 16])));
    let first = picture(&server);
    for metric in ["flip", "relative", "absolute", "flip&tone=agx&exposure=1"] {
        let (head, map) = taken(&server.get(&format!("api/difference?metric={metric}")));
        assert!(map.iter().all(|v| *v == 0.0));
        assert_eq!((&head["mean"], &head["quantile95"], &head["relmse"]), (&json!(0.0), &json!(0.0), &json!(0.0)));
        // Infinite.
        assert_eq!(head["psnr"], json!(null));
    }
    page.finished(json!({"type": "settings", "seed": 7}));
    let (head, values) = taken(&server.get("api/reference"));
    assert_eq!(head, about);
    assert_close(&values, first.to_rgb().unwrap().as_flattened());
    let second = picture(&server);
    let (head, map) = taken(&server.get("api/difference?metric=relative"));
    let all = metrics::compare(&second, &first).unwrap();
    assert!(all.rel_mse > 1e-3 && (head["relmse"].as_f64().unwrap() / all.rel_mse - 1.0).abs() < 1e-9);
    assert!((head["mean"].as_f64().unwrap() / all.rel_mse - 1.0).abs() < 1e-5);
    assert_eq!(map.len(), 24 * 16);
    let deleted =
        server.ask("DELETE", &(server.base() + "api/reference"), &format!("Host: {}\r\n", server.host()), b"");
    assert_eq!(deleted.status, 204);
    assert_eq!(server.get("api/reference").status, 204);
}

/// Against files, maps and figures are those of `steradian compare`.
#[test]
fn files_are_compared_as_the_library_compares() {
    let (server, mut page) = done();
    let exr = server.get("api/picture.exr").body;
    let png = server.get("api/picture.png").body;
    page.finished(json!({"type": "settings", "seed": 7}));
    let a = picture(&server);
    for (name, bytes) in [("b.exr", &exr), ("b.png", &png)] {
        let about = server.send_files("api/reference", &[(name, bytes)]).json();
        assert_eq!(about, json!({"name": name, "width": 24, "height": 16, "crop": null}));
        let b = read_bytes(bytes, None, &Default::default()).unwrap();
        let absolute = metrics::absolute_difference(&a, &b).unwrap().to_rgb().unwrap();
        let flip = metrics::flip_map(&a, &b, DEFAULT_PIXELS_PER_DEGREE).unwrap();
        for (metric, wanted) in [("absolute", absolute.as_flattened()), ("flip", &flip)] {
            let (head, map) = taken(&server.get(&format!("api/difference?metric={metric}")));
            assert_figures(&head, &a, &b, wanted);
            assert_close(&map, wanted);
        }
        // What is displayed is what PNG files have.
        let tone = Tone::parse("reinhard:white=2").unwrap().with_exposure(1.5).unwrap();
        let options = WriteOptions { tone, ..WriteOptions::default() };
        let seen = |image: &Image| {
            read_bytes(&encode(FileKind::Png, image, &options).unwrap(), None, &Default::default()).unwrap()
        };
        let flip = metrics::flip_map(&seen(&a), &seen(&b), DEFAULT_PIXELS_PER_DEGREE).unwrap();
        let (head, map) = taken(&server.get("api/difference?metric=flip&tone=reinhard:white=2&exposure=1.5"));
        assert_figures(&head, &a, &b, &flip);
        assert_close(&map, &flip);
    }
}

/// A file that is no picture, too large, or of another size is refused, and the reference before stays.
#[test]
fn what_does_not_fit_is_refused() {
    let (server, mut page) = done();
    let exr = server.get("api/picture.exr").body;
    let small = encode(FileKind::Pfm, &Image::from_rgb(8, 9, &[[0.5; 3]; 72]).unwrap(), &Default::default()).unwrap();
    assert_eq!(server.send_files("api/reference", &[("b.pfm", &small)]).status, 200);
    let large = [b"PF\n5000 5000\n-1.0\n".as_slice(), &[0; 64]].concat();
    let long = [b"Pf\n70000 1\n-1.0\n".as_slice(), &vec![0; 280_000]].concat();
    for (name, bytes, why) in [
        ("a.txt", b"hello".as_slice(), "a.txt: not a known image format"),
        ("a.exr", b"", "a.exr: "),
        ("a.exr", &exr[..exr.len() / 2], "a.exr: "),
        ("a.pfm", &large, "16777216"),
        ("a.pfm", &long, "70000 pixels are too many along an edge"),
    ] {
        let answer = server.send_files("api/reference", &[(name, bytes)]);
        let said = answer.json()["error"].as_str().unwrap().to_owned();
        assert_eq!(answer.status, 422, "{said}");
        assert!(said.contains(why), "{said}");
        assert!(!said.contains("/tmp"), "{said}");
    }
    assert_eq!(server.send_files("api/reference", &[]).status, 400);
    assert_eq!(server.post("api/reference", &json!({})).status, 400);
    assert_eq!(server.post("api/reference?from=elsewhere", &json!(null)).status, 400);
    for bad in ["", "?metric=psnr", "?metric=flip&tone=nix", "?metric=flip&exposure=99"] {
        assert_eq!(server.get(&format!("api/difference{bad}")).status, 400, "{bad}");
    }
    let other = server.get("api/difference?metric=flip");
    assert_eq!(other.status, 409);
    let said = other.json()["error"].as_str().unwrap().to_owned();
    assert!(said.contains("24x16") && said.contains("8x9"), "{said}");
    // Another part of the same size is another picture.
    page.finished(json!({"type": "region", "pixels": [0, 0, 8, 9]}));
    assert_eq!(server.get("api/difference?metric=flip").status, 200);
    assert_eq!(server.post("api/reference?from=current", &json!(null)).status, 200);
    page.finished(json!({"type": "region", "pixels": [8, 0, 16, 9]}));
    let said = server.get("api/difference?metric=flip").text();
    assert!(said.contains("from 8, 0") && said.contains("from 0, 0"), "{said}");
}

/// Pages learn that another one keeps a picture, and that it is forgotten.
#[test]
fn all_pages_learn_of_it() {
    let (server, _first) = done();
    let mut second = server.page();
    second.until("the picture", |v| v["type"] == "frame");
    let is_news = |v: &Value| *v == json!({"type": "reference"});
    assert_eq!(server.post("api/reference?from=current", &json!(null)).status, 200);
    second.until("that there is one", is_news);
    let headers = format!("Host: {}\r\n", server.host());
    assert_eq!(server.ask("DELETE", &(server.base() + "api/reference"), &headers, b"").status, 204);
    second.until("that there is none", is_news);
}

//! Noise is removed by the denoiser that was chosen: its last frame has the bits that the command line makes.

use crate::client::{Server, served};
use serde_json::{Value, json};
use std::{path::PathBuf, sync::Arc};
use steradian::{
    CompileOptions, Layer, Quality,
    denoise::{self, GUIDES, OIDN_GUIDES, Oidn},
    image::{Image, Value as Meta},
};

const BOX: &str = "builtin:cornell-box";

/// The Cornell box with so many samples, with noise, as `render --denoise` renders it.
fn noisy(spp: u32, guides: &[Layer]) -> Image {
    let desc = steradian::load(BOX, &Default::default()).desc;
    let options = CompileOptions { size: Some((24, 16)), spp: Some(spp), ..CompileOptions::default() };
    let scene = Arc::new(steradian::compile(&desc, &options).scene.unwrap());
    let quality = Quality { independent: true, layers: guides.to_vec(), ..Quality::of("path").spp(spp) };
    let mut picture = steradian::render(&scene, &quality).unwrap();
    // As the program labels its files.
    picture.metadata.set("samplesPerPixel", Meta::Int(spp as i32));
    picture
}

fn settings(denoise: &str, spp: u32) -> Value {
    json!({"type": "settings", "denoise": denoise, "spp": spp})
}

#[test]
fn the_last_frame_is_that_of_the_chosen_denoiser() {
    let server = Server::of(BOX);
    let mut page = server.page();
    for spp in [1, 4] {
        let noisy = noisy(spp, &GUIDES);
        let nlm = denoise::picture(&noisy, None, 1.0).unwrap().picture;
        let atrous = denoise::quick(&noisy).unwrap().picture;
        assert_ne!(nlm.to_rgb().unwrap(), atrous.to_rgb().unwrap());
        for (name, clean) in [("nlm", nlm), ("atrous", atrous)] {
            let end = page.finished(settings(name, spp));
            assert_eq!((&end["denoised"], &page.state["settings"]["denoise"]), (&json!(true), &json!(name)));
            let command = page.state["command"].as_str().unwrap();
            assert!(command.ends_with(&format!(" --denoise={name}")), "{command}");
            let got = served(&server);
            assert_eq!(got.to_rgb().unwrap(), clean.to_rgb().unwrap(), "{name}, {spp}");
            assert_eq!(got.layer_rgb("raw").unwrap().at(5), noisy.rgb().unwrap().at(5));
        }
    }
    let said = page.refusal(json!({"type": "settings", "integrator": "sppm"}));
    assert!(said.contains("noise cannot be removed"), "{said}");
    let end = page.finished(json!({"type": "settings", "denoise": null}));
    assert_eq!((&end["denoised"], &page.state["settings"]["denoise"]), (&json!(false), &json!(null)));
    let names: Vec<&str> = page.state["choices"]["denoisers"]
        .as_array()
        .unwrap()
        .iter()
        .map(|choice| choice["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["nlm", "atrous", "oidn"]);
}

/// While a render goes on it is the quick filter whose pictures are shown, and the layers asked for are those beneath.
#[test]
fn the_quick_filter_is_shown_on_the_way() {
    let server = Server::of(BOX);
    let mut page = server.page();
    page.until("the state", |v| v["type"] == "state");
    page.send(settings("nlm", 1 << 20));
    let samples = |v: &Value| v["samples"].as_f64().unwrap_or(0.0);
    let on_the_way = |v: &Value| v["type"] == "frame" && v["target"] == 1 << 20 && v["kind"] == "render";
    let (frame, _) = page.until("a picture on the way", |v| on_the_way(v) && samples(v) >= 16.0 && v["done"] == false);
    assert_eq!(frame["denoised"], true);
    page.send(json!({"type": "pause", "on": true}));
    page.until("a pause", |v| v["type"] == "state" && v["paused"] == true);
    // A frame follows only where more samples were taken since the last one.
    let got = served(&server);
    let again = denoise::quick(&got).unwrap();
    assert_eq!(again.missing, []);
    assert_eq!(got.to_rgb().unwrap(), again.picture.to_rgb().unwrap());
}

/// Without its library Open Image Denoise is refused with what brings it; the setting stays as it was.
#[test]
fn a_library_that_is_not_there_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("libOpenImageDenoise.so.2");
    std::fs::write(&text, "no library").unwrap();
    for (library, about) in [(Err("`pip install` brings it".to_owned()), "pip install"), (Ok(text), "no library that")]
    {
        let server = Server::with(BOX, library);
        let mut page = server.page();
        page.finished(settings("atrous", 2));
        let said = page.refusal(settings("oidn", 2));
        assert!(said.contains(about), "{said}");
        assert_eq!(page.state["settings"]["denoise"], "atrous");
        assert_eq!(page.finished(json!({"type": "settings", "spp": 1}))["denoised"], true);
    }
    let server = Server::of(BOX);
    let mut page = server.page();
    let said = page.refusal(json!({"type": "settings", "denoise": "oidn"}));
    assert!(said.contains("steradian view --oidn PATH"), "{said}");
    let said = page.refusal(json!({"type": "settings", "denoise": true}));
    assert!(said.contains("denoise") || said.contains("invalid type"), "{said}");
}

/// Open Image Denoise, where `STERADIAN_OIDN` names its library.
#[expect(clippy::print_stdout, reason = "a skipped test says so")]
#[test]
fn open_image_denoise_has_the_last_word() {
    let Some(library) = std::env::var_os("STERADIAN_OIDN").map(PathBuf::from).filter(|path| path.is_file()) else {
        println!("SKIPPED: STERADIAN_OIDN does not name the library of Open Image Denoise");
        return;
    };
    let clean = denoise::by_oidn(&noisy(4, &OIDN_GUIDES), &Oidn::load(&library, 1).unwrap()).unwrap();
    assert_eq!(clean.missing, []);
    let server = Server::with(BOX, Ok(library.clone()));
    let mut page = server.page();
    for _ in 0..2 {
        assert_eq!(page.finished(settings("oidn", 4))["denoised"], true);
        assert_eq!(served(&server).to_rgb().unwrap(), clean.picture.to_rgb().unwrap());
    }
    let command = page.state["command"].as_str().unwrap();
    assert!(command.ends_with(&format!(" --denoise=oidn --oidn {}", library.display())), "{command}");
}

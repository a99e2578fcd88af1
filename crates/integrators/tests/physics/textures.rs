//! Texture filters, judged by pictures.

use crate::{
    shot::Shot,
    stage::{Stage, diffuse, material, plane, shape},
};
use steradian_core::{
    ColorMode, Scene,
    compile::{Options, compile},
};
use steradian_image::{Image, WriteOptions, metrics};
use steradian_scene::{Family, Node, Value};

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;

/// Two cells of the checkerboard, 32 texels each way per cell.
fn checks(folder: &std::path::Path) -> std::path::PathBuf {
    let cell = |i: usize| if (i % 64 / 32 + i / 64 / 32).is_multiple_of(2) { [0.8; 3] } else { [0.2; 3] };
    let image = Image::from_rgb(64, 64, &(0..64 * 64).map(cell).collect::<Vec<_>>()).unwrap();
    let path = folder.join("checks.exr");
    steradian_image::write(&path, &image, &WriteOptions::default()).unwrap();
    path
}

/// A plane of checks to the horizon under a grey sky, seen by samples with a Gaussian around each pixel, or at its centre.
fn horizon(texture: Node, at_centre: bool) -> Scene {
    let mut stage = Stage::new();
    stage.film(WIDTH.into(), HEIGHT.into()).look([0.0, 1.0, 0.0], [0.3, 0.75, 1.0], 70.0);
    let filter = if at_centre {
        Node::new(Family::Filter, "box", None).with("radius_x", 1e-4).with("radius_y", 1e-4)
    } else {
        Node::new(Family::Filter, "gaussian", None).with("radius_x", 1.5).with("radius_y", 1.5).with("sigma", 0.5)
    };
    stage.desc.filter = Some(stage.desc.add(filter));
    let texture = stage.add(texture);
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), material("diffuse").with("reflectance", Value::Node(texture)));
    // A wall behind the horizon, far away, so that no pixel is black.
    stage.solid(shape("sphere").with("radius", 1e5), diffuse(0.5));
    let compiled = compile(&stage.desc, &Options { mode: Some(ColorMode::Rgb), spp: Some(1), ..Options::default() });
    let said: Vec<String> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
    assert!(!compiled.diagnostics.is_lossy() && !compiled.diagnostics.has_errors(), "{said:?}");
    compiled.scene.expect("a scene without errors")
}

fn picture(scene: &Scene, spp: u32) -> Image {
    let film = Shot::of("raycast", spp).take(scene);
    let pixels: Vec<[f32; 3]> = film.pixels.iter().map(|p| p.mean().map(|v| v as f32)).collect();
    Image::from_rgb(WIDTH as usize, HEIGHT as usize, &pixels).unwrap()
}

/// The classic check: one sample with an elliptical filter against very many points, and against one point.
#[test]
#[allow(clippy::print_stdout, reason = "figures of the other filters, for who asks with --nocapture")]
fn a_checkerboard_to_the_horizon() {
    let folder = tempfile::tempdir().unwrap();
    let file = checks(folder.path());
    let image = |filter: &str| {
        Node::new(Family::Texture, "image", None)
            .with("file", Value::Path(file.clone()))
            .with("filter", filter)
            .with("max_anisotropy", 64.0)
    };
    let reference = picture(&horizon(image("bilinear"), false), 1024);
    let error = |filter: &str| {
        let seen = picture(&horizon(image(filter), true), 1);
        metrics::compare(&seen, &reference).unwrap().rel_mse
    };
    let (ewa, bilinear) = (error("ewa"), error("bilinear"));
    println!(
        "relMSE: ewa {ewa:.5}, bilinear {bilinear:.5}, trilinear {:.5}, ripmap {:.5}, box {:.5}",
        error("trilinear"),
        error("ripmap"),
        error("box")
    );
    assert!(ewa <= 0.01, "{ewa}");
    assert!(bilinear >= 10.0 * ewa, "{bilinear} {ewa}");
}

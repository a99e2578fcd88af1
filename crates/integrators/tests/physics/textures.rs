//! Texture filters, judged by pictures.

use crate::{
    shot::Shot,
    stage::{Stage, diffuse, light, material, plane, shape, white},
};
use steradian_compile::{Options, compile};
use steradian_core::{ColorMode, Scene};
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

/// A plane of checks, seen by samples with a Gaussian around each pixel, or at its centre, and what else there is.
fn checkered(texture: Node, at_centre: bool, furnish: impl Fn(&mut Stage)) -> Scene {
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
    furnish(&mut stage);
    let compiled = compile(&stage.desc, &Options { mode: Some(ColorMode::Rgb), spp: Some(1), ..Options::default() });
    let said: Vec<String> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
    assert!(!compiled.diagnostics.is_lossy() && !compiled.diagnostics.has_errors(), "{said:?}");
    compiled.scene.expect("a scene without errors")
}

/// The plane to the horizon under a grey sky.
fn horizon(texture: Node, at_centre: bool) -> Scene {
    checkered(texture, at_centre, |stage| {
        // A wall behind the horizon, far away, so that no pixel is black.
        stage.solid(shape("sphere").with("radius", 1e5), diffuse(0.5));
    })
}

fn picture(scene: &Scene, integrator: &'static str, spp: u32) -> Image {
    rows(scene, integrator, spp, 0..HEIGHT)
}

/// Some rows of a picture.
fn rows(scene: &Scene, integrator: &'static str, spp: u32, rows: std::ops::Range<u32>) -> Image {
    let film = Shot::of(integrator, spp).depth(2).take(scene);
    let seen = &film.pixels[(rows.start * WIDTH) as usize..(rows.end * WIDTH) as usize];
    let pixels: Vec<[f32; 3]> = seen.iter().map(|p| p.mean().map(|v| v as f32)).collect();
    Image::from_rgb(WIDTH as usize, rows.len(), &pixels).unwrap()
}

/// The classic check: one sample with an elliptical filter against very many points, and against one point.
#[test]
#[expect(clippy::print_stdout, reason = "figures of the other filters, for who asks with --nocapture")]
fn a_checkerboard_to_the_horizon() {
    let folder = tempfile::tempdir().unwrap();
    let file = checks(folder.path());
    let image = |filter: &str| {
        Node::new(Family::Texture, "image", None)
            .with("file", Value::Path(file.clone()))
            .with("filter", filter)
            .with("max_anisotropy", 64.0)
    };
    let reference = picture(&horizon(image("bilinear"), false), "raycast", 1024);
    let error = |filter: &str| {
        let seen = picture(&horizon(image(filter), true), "raycast", 1);
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

/// The checkerboard in a mirror that stands across the plane, where path tracers carry differentials: the light's way
/// is longer than the camera is far, and the plane is seen at another angle.
#[test]
#[expect(clippy::print_stdout, reason = "figures, for who asks with --nocapture")]
fn a_checkerboard_in_a_mirror() {
    let folder = tempfile::tempdir().unwrap();
    let file = checks(folder.path());
    let scene = |filter: &str, at_centre: bool| {
        let image = Node::new(Family::Texture, "image", None)
            .with("file", Value::Path(file.clone()))
            .with("filter", filter)
            .with("max_anisotropy", 64.0);
        checkered(image, at_centre, |stage| {
            stage.solid(plane([0.0, 0.0, -1.0], -4.0), material("conductor"));
            stage.light(light("distant").with("direction", [0.0, -1.0, 0.1]).with("radiance", white(3.0)));
        })
    };
    // The rows of the mirror between the horizon and its foot, where there are no edges but those of the checks.
    let mirror = 20..32;
    let reference = rows(&scene("bilinear", false), "path", 256, mirror.clone());
    let of = |filter: &str, integrator: &'static str| rows(&scene(filter, true), integrator, 1, mirror.clone());
    let error = |image: &Image| metrics::compare(image, &reference).unwrap().rel_mse;
    let (seen, points) = (of("ewa", "path"), of("bilinear", "path"));
    let (ewa, bilinear) = (error(&seen), error(&points));
    println!("relMSE in the mirror: ewa {ewa:.5}, bilinear {bilinear:.5}");
    assert!(ewa <= 0.005, "{ewa}");
    assert!(bilinear >= 30.0 * ewa, "{bilinear} {ewa}");
}

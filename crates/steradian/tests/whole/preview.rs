//! First pictures: `raster` without options and samples.

use std::sync::Arc;
use steradian::{CompileOptions, Control, Film, Quality, Scene, compile, load};

fn scene_at(path: &str, [width, height]: [u32; 2]) -> Scene {
    let loaded = load(path, &Default::default());
    assert!(!loaded.diagnostics.has_errors(), "{path}");
    let options = CompileOptions { mode: Some(steradian::ColorMode::Rgb), ..CompileOptions::default() };
    let scene = compile(&loaded.desc, &options).scene.unwrap();
    scene.changed(|parts| {
        parts.film.width = width;
        parts.film.height = height;
        parts.film.crop = steradian_core::film::Crop { x0: 0, y0: 0, x1: width, y1: height };
    })
}

fn verify_scene(name: &str) -> Scene {
    scene_at(&format!("{}/../../scenes/verify/{name}.pbrt", env!("CARGO_MANIFEST_DIR")), [64, 64])
}

fn scene_of(text: &str, size: [u32; 2]) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.pbrt");
    std::fs::write(&path, text).unwrap();
    scene_at(path.to_str().unwrap(), size)
}

fn film(scene: &Scene, quality: &Quality) -> Result<Film, steradian::Error> {
    let scene = Arc::new(scene.clone());
    let mut session = quality.render(&scene)?.session(&scene)?;
    session.step(u32::MAX, &Control::default());
    match session.failure() {
        Some(why) => panic!("{why}"),
        None => Ok(session.film()),
    }
}

fn picture(scene: &Scene, quality: &Quality) -> Vec<[f64; 3]> {
    film(scene, quality).unwrap().pixels.iter().map(|p| p.mean()).collect()
}

fn preview(scene: &Scene) -> Vec<[f64; 3]> {
    picture(scene, &Quality::of("raster"))
}

fn mean(pixels: &[[f64; 3]]) -> f64 {
    pixels.iter().flatten().sum::<f64>() / (3 * pixels.len()) as f64
}

/// The median of relative errors over pixels: of what is between edges.
fn error(picture: &[[f64; 3]], reference: &[[f64; 3]]) -> f64 {
    let mut errors: Vec<f64> =
        picture.iter().zip(reference).map(|(a, b)| (a[1] - b[1]).abs() / (b[1] + 0.01)).collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

/// Previews of rooms show all their light, with glass and mirrors, and err less than four samples of path tracing do.
#[test]
fn previews_show_the_light_of_paths() {
    for (name, bias) in [
        ("diffuse", 0.05),
        ("glass", 0.05),
        ("rough-glass", 0.05),
        ("point", 0.05),
        ("many-lights", 0.05),
        // Most of its mean is a small bright spot, of which blocks of pixels know little.
        ("hidden-lamp", 0.6),
    ] {
        let scene = verify_scene(name);
        let reference = picture(&scene, &Quality::of("bdpt").spp(64));
        let few = picture(&scene, &Quality { seed: Some(7), ..Quality::of("path").spp(4) });
        let preview = preview(&scene);
        let ratio = mean(&preview) / mean(&reference);
        assert!((ratio - 1.0).abs() < bias, "{name}: {ratio}");
        let (error, of_few) = (error(&preview, &reference), error(&few, &reference));
        assert!(error < of_few, "{name}: {error} {of_few}");
    }
}

/// A scene of many more triangles than the picture has pixels is seen by rays, and shows the same.
#[test]
fn rays_find_what_many_triangles_show() {
    let side = 40;
    let points: Vec<String> =
        (0..side * side).map(|k| format!("{} {} 3", k % side - side / 2, k / side - side / 2)).collect();
    let cell = |x, y| {
        let k: i32 = y * side + x;
        format!("{} {} {} {} {} {}", k, k + 1, k + side, k + 1, k + side + 1, k + side)
    };
    let cells: Vec<String> = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| cell(x, y))).collect();
    let scene = |size| {
        scene_of(
            &format!(
                "Camera \"perspective\"\nWorldBegin\nLightSource \"distant\" \"rgb L\" [1 1 1]\n\
                 Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\n\
                 Shape \"trianglemesh\" \"point3 P\" [{}] \"integer indices\" [{}]",
                points.join(" "),
                cells.join(" ")
            ),
            size,
        )
    };
    // 3042 triangles.
    let (few, many) = (preview(&scene([16, 16])), preview(&scene([64, 64])));
    // Light falls straight on the mesh: radiance 0.5/π.
    for (pixels, side) in [(few, 16), (many, 64)] {
        let middle = pixels[side / 2 * side + side / 2][1];
        assert!((middle * std::f64::consts::PI / 0.5 - 1.0).abs() < 0.02, "{side}: {middle}");
    }
}

/// A scene without light is shown by one at the camera.
#[test]
fn a_light_at_the_camera_shows_what_has_none() {
    let scene = scene_of(
        "Camera \"perspective\" \"float fov\" 5 WorldBegin Material \"diffuse\" \"rgb reflectance\" [0.6 0.3 0.1] \
         Translate 0 0 10 Shape \"disk\"",
        [33, 33],
    );
    let found = preview(&scene)[16 * 33 + 16];
    for (value, albedo) in found.iter().zip([0.6, 0.3, 0.1]) {
        assert!((value / albedo - 1.0).abs() < 0.01, "{found:?}");
    }
}

/// Cameras of all directions see by rays.
#[test]
fn cameras_of_all_directions_are_shown() {
    let scene = scene_of(
        "Camera \"spherical\" \"string mapping\" \"equirectangular\" WorldBegin \
         LightSource \"infinite\" \"rgb L\" [0.7 0.7 0.7] Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5] \
         Translate 0 0 4 Shape \"sphere\"",
        [64, 32],
    );
    let found = preview(&scene);
    let of = |x: usize, y: usize| found[y * 64 + x][1];
    // The sky, and the sphere around +z, which sends half of it on.
    assert!((of(0, 3) - 0.7).abs() < 1e-5 && found.iter().any(|p| (p[1] - 0.35).abs() < 0.01), "{}", of(0, 3));
}

/// Samples and options ask for pictures of their own; what previews do not have is refused by name.
#[test]
fn only_what_asks_for_nothing_is_a_preview() {
    let scene = verify_scene("diffuse");
    let forward = picture(&scene, &Quality::of("raster:frame=forward"));
    assert_eq!(forward, picture(&scene, &Quality::of("raster:points=4")));
    assert_eq!(forward, picture(&scene, &Quality::of("raster").spp(1)));
    assert_ne!(forward, preview(&scene));
    assert_eq!(preview(&scene), picture(&scene, &Quality { threads: 1, ..Quality::of("raster:frame=preview") }));
    let groups = Quality { layers: vec![steradian::Layer::LIGHT_GROUPS], ..Quality::of("raster:frame=preview") };
    let transparent = Quality { transparent: true, ..Quality::of("raster:frame=preview") };
    for (quality, part) in [(groups, "groups of lights"), (transparent, "transparent")] {
        let refused = film(&scene, &quality).unwrap_err().to_string();
        assert!(refused.contains(part), "{refused}");
    }
    assert!(film(&scene, &Quality { transparent: true, ..Quality::of("raster") }).is_ok());
}

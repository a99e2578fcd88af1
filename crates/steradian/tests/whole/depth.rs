//! The layer of depth counts from the eye, wherever the near plane is.

use steradian::{CompileOptions, Quality, compile, formats::Options, load, math::spectra::ColorMode, render};

/// `Z` and `depth.Z` of the middle of a picture of a large ball whose nearest point is 4 away.
fn depths(camera: &str) -> [f64; 2] {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.steradian");
    let text = format!(
        "steradian: 1
         film: {{film: rgb, width: 1, height: 1}}
         camera: {{{camera}}}
         shapes: [{{shape: sphere, radius: 1000, center: [0 0 -1000]}}]
         lights: [{{light: environment}}]"
    );
    std::fs::write(&path, text).expect("written");
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let compiled = compile(&load(&path, &Options::default()).desc, &options);
    let scene = std::sync::Arc::new(compiled.scene.unwrap_or_else(|| panic!("{:?}", compiled.diagnostics)));
    let quality = Quality { spp: Some(16), layers: vec![steradian::Layer::DEPTH], ..Quality::default() };
    let picture = render(&scene, &quality).expect("a picture");
    ["Z", "depth.Z"].map(|name| f64::from(picture.channel(name).expect("a plane")[0]))
}

#[test]
fn depth_counts_from_the_eye() {
    let place = "to_world: {look_at: [0 0 0], from: [0 0 4]}";
    for camera in [
        format!("camera: perspective, fov: 0.1, {place}"),
        format!("camera: perspective, fov: 0.1, lens_radius: 0.001, focal_distance: 4, {place}"),
        format!("camera: orthographic, screen_window: [-0.001, 0.001, -0.001, 0.001], {place}"),
        "camera: perspective, fov: 0.1, to_world: [{scale: 0.5}, {look_at: [0 0 0], from: [0 0 4]}]".to_owned(),
    ] {
        for near in [0.0, 0.5, 3.0] {
            let [z, along] = depths(&format!("{camera}, near: {near}"));
            assert!((z - 4.0).abs() < 2e-3 && (along - 4.0).abs() < 2e-3, "{camera}, near {near}: {z} {along}");
        }
    }
}

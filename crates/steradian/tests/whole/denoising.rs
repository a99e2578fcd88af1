//! Real scenes with few samples before and after denoising, against references of many.

use std::{path::PathBuf, sync::Arc};
use steradian::{
    CompileOptions, Quality, compile,
    denoise::{self, GUIDES},
    image::{Image, metrics},
    load, render,
};

fn repository(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "../..", name].iter().collect()
}

/// relMSE before and after, of a render with so many samples.
fn errors(scene: PathBuf, size: (u32, u32), spp: u32) -> [f64; 2] {
    let loaded = load(&scene, &Default::default());
    let compiling = CompileOptions { size: Some(size), ..CompileOptions::default() };
    let scene = Arc::new(compile(&loaded.desc, &compiling).scene.unwrap_or_else(|| panic!("{}", scene.display())));
    let quality = Quality { independent: true, layers: GUIDES.to_vec(), seed: Some(1), ..Quality::of("path") }.spp(spp);
    let noisy = render(&scene, &quality).unwrap();
    let reference = render(&scene, &Quality { seed: Some(2), ..Quality::of("path") }.spp(256)).unwrap();
    let after = denoise::picture(&noisy, None, 1.0).unwrap();
    assert_eq!((&after.used[..], &after.missing[..], after.not_finite), (&GUIDES[..], &[][..], 0));
    let error = |picture: &Image| metrics::compare(picture, &reference).unwrap().rel_mse;
    [error(&noisy), error(&after.picture)]
}

/// By which factor the error falls at least. The smaller the picture, the less is there to average: larger ones are in
/// docs/denoising.md.
#[test]
fn errors_fall() {
    let own = |name: &str| Some(repository(name));
    let scenes = [
        (Some("builtin:cornell-box".into()), (64, 64), 5.0),
        (own("scenes/showcase.pbrt"), (96, 54), 4.5),
        (steradian_testkit::asset("pbrt/coffee/scene-v4.pbrt"), (50, 70), 2.8),
        (steradian_testkit::asset("pbrt/staircase2/scene-v4.pbrt"), (45, 80), 6.0),
        (steradian_testkit::asset("pbrt/veach-mis/scene-v4.pbrt"), (80, 45), 2.2),
        (steradian_testkit::asset("gltf/FlightHelmet/FlightHelmet.gltf"), (64, 64), 1.4),
    ];
    for (scene, size, factor) in scenes {
        let Some(scene) = scene else { continue };
        let name = scene.display().to_string();
        let [before, after] = errors(scene, size, 4);
        assert!(after * factor < before, "{name}: {before} to {after}, a factor of {}", before / after);
    }
}

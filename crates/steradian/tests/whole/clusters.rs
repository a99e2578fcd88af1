//! `raster:lights=`: all lights of a scene with a thousand lamps, and those that matter in the cells of the view.

use std::fmt::Write as _;
use std::sync::Arc;
use steradian::{ColorMode, CompileOptions, Control, Quality, Scene, compile, load};

/// A floor and rows of posts under lamps of many colours, with a dim sky.
fn lamps(count: u32) -> Arc<Scene> {
    let mut text = String::from(
        "LookAt 0 -14 5  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 50\n\
         Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 48\nWorldBegin\n\
         LightSource \"distant\" \"rgb L\" [0.02 0.02 0.03] \"point3 from\" [1 -2 4] \"point3 to\" [0 0 0]\n",
    );
    let side = f64::from(count).sqrt().ceil() as u32;
    for k in 0..count {
        let at = |v: u32| (f64::from(v) + 0.5) / f64::from(side) * 40.0 - 20.0;
        let (x, y, z) = (at(k % side), at(k / side), 0.3 + 0.4 * (f64::from(k) * 0.618).fract());
        let [r, g, b] = [0.37, 0.71, 0.13].map(|step| 0.02 + 0.06 * (f64::from(k) * step).fract());
        writeln!(text, "LightSource \"point\" \"rgb I\" [{r} {g} {b}] \"point3 from\" [{x} {y} {z}]").unwrap();
    }
    text.push_str(
        "Material \"diffuse\" \"rgb reflectance\" [0.6 0.6 0.6]\nShape \"trianglemesh\" \"point3 P\" \
         [-30 -30 0 30 -30 0 30 30 0 -30 30 0] \"integer indices\" [0 1 2 0 2 3]\n\
         AttributeBegin\nTranslate -3 -6 1\nShape \"sphere\" \"float radius\" 1\nAttributeEnd\n\
         AttributeBegin\nTranslate 4 0 1\nShape \"cylinder\" \"float radius\" 0.5 \"float zmin\" -1\nAttributeEnd\n",
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lamps.pbrt");
    std::fs::write(&path, text).unwrap();
    let loaded = load(path.to_str().unwrap(), &Default::default());
    assert!(!loaded.diagnostics.has_errors(), "{:?}", loaded.diagnostics);
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    Arc::new(compile(&loaded.desc, &options).scene.unwrap())
}

/// Green of the pixels, and the number of rays.
fn pixels(scene: &Arc<Scene>, integrator: &str, spp: u32, threads: usize) -> (Vec<f64>, u64) {
    let quality = Quality { integrator: Some(integrator.into()), spp: Some(spp), threads, ..Quality::default() };
    let mut session = quality.render(scene).unwrap().session(scene).unwrap();
    session.step(u32::MAX, &Control::default());
    assert_eq!(session.failure(), None);
    (session.film().pixels.iter().map(|p| p.mean()[1]).collect(), session.counters().rays)
}

/// Lights of cells and a few others by chance are all lights in the mean, with less noise than by chance alone and far
/// fewer rays than all together. Bits do not depend on threads.
#[test]
fn cells_keep_the_lights_that_matter() {
    let scene = lamps(1000);
    let (all, all_rays) = pixels(&scene, "raster:frame=forward,lights=all", 1, 2);
    let (clustered, rays) = pixels(&scene, "raster:frame=forward,lights=clustered", 1, 1);
    assert_eq!(pixels(&scene, "raster:frame=forward,lights=clustered", 1, 3).0, clustered);
    assert!(rays * 10 < all_rays, "{rays} of {all_rays} rays");
    let mean = |pixels: &[f64]| pixels.iter().sum::<f64>() / pixels.len() as f64;
    let error = |pixels: &[f64]| pixels.iter().zip(&all).map(|(found, right)| (found - right).abs()).sum::<f64>();
    let (chosen, _) = pixels(&scene, "raster:frame=forward,points=40", 1, 2);
    let [mean_all, mean_clustered, mean_chosen] = [&all, &clustered, &chosen].map(|pixels| mean(pixels));
    assert!((mean_clustered / mean_all - 1.0).abs() < 0.01, "{mean_clustered} for {mean_all}");
    assert!((mean_chosen / mean_all - 1.0).abs() < 0.02, "{mean_chosen} for {mean_all}");
    assert!(error(&clustered) < 0.5 * error(&chosen), "{} and {} by chance", error(&clustered), error(&chosen));
}

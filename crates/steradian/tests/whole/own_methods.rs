//! Methods of a user's own, as the examples have them: they run in the engine's sessions, and their pictures are right.

#[path = "../../examples/own_integrator.rs"]
#[allow(dead_code, reason = "tests include this file")]
mod own_integrator;
#[path = "../../examples/own_pass.rs"]
#[allow(dead_code, reason = "tests include this file")]
mod own_pass;
#[path = "../../examples/path_recursive.rs"]
#[allow(dead_code, reason = "tests include this file")]
mod path_recursive;

use own_integrator::ByChance;
use own_pass::Sprinkled;
use path_recursive::Recursive;
use std::sync::Arc;
use steradian::{
    ColorMode, CompileOptions, Control, Film, Layer, Plan, Quality, Scene, Session, compile, cornell,
    engine::{Passes, PerPixel},
    transport::Depth,
};

fn room() -> Arc<Scene> {
    let options = CompileOptions { size: Some((24, 24)), ..CompileOptions::default() };
    Arc::new(compile(&cornell::luminous_ceiling(), &options).scene.expect("a sound scene"))
}

fn plan(scene: &Scene, spp: u32) -> Plan {
    let layers = vec![Layer::ALBEDO];
    Quality { spp: Some(spp), seed: Some(2), layers, ..Quality::default() }.render(scene).expect("a plan").plan
}

fn taken(session: &mut dyn Session) -> Film {
    session.step(u32::MAX, &Control::default());
    assert!(session.is_done());
    session.film()
}

/// The mean of green, and its standard error.
fn mean(film: &Film) -> (f64, f64) {
    let n = film.pixels.len() as f64;
    let sum = |f: &dyn Fn(&steradian::Pixel) -> f64| film.pixels.iter().map(f).sum::<f64>();
    (sum(&|p| p.mean()[1]) / n, sum(&|p| p.variance_of_mean()[1]).sqrt() / n)
}

/// Paths that find light by chance have the mean of the path tracer's; stopped and gone on with, the same bits.
#[test]
fn an_integrator_of_ones_own() {
    let scene = room();
    let own = || PerPixel::per_pixel(Arc::clone(&scene), ByChance, plan(&scene, 256));
    let film = taken(&mut own());
    let quality = Quality { integrator: Some("path:reuse=1".into()), spp: Some(256), ..Quality::default() };
    let reference = taken(&mut *quality.render(&scene).expect("a plan").session(&scene).expect("a session"));
    let ((a, s), (b, t)) = (mean(&film), mean(&reference));
    assert!((a - b).abs() < 4.0 * s.hypot(t) && s < 0.02 * a, "{a} ± {s}, not {b} ± {t}");
    assert!(film.layers.features.iter().any(|f| f.mean().albedo[0] > 0.3), "layers come with the session");
    let (mut first, mut state) = (own(), Vec::new());
    first.step(10, &Control::default());
    first.save(&mut state).expect("written");
    let mut second = own();
    second.restore(&mut &state[..]).expect("its own state");
    let bits = |film: &Film| film.pixels.iter().map(|p| p.sum.map(f64::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&taken(&mut second)), bits(&film));
}

/// M160, M161: the recursive path tracer has the bits of `path`: with masks, mixtures, textures, glass that disperses
/// and motion, in RGB and spectral mode, with Russian roulette from the first event on and without, hidden lights, and
/// a path that ends soon.
#[test]
fn the_recursive_path_tracer_has_the_bits_of_path() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/verify");
    for name in ["diffuse", "dispersive", "masked", "moving", "sky-and-lamp", "textured", "instanced"] {
        let loaded = steradian::load(folder.join(name).with_extension("pbrt"), &Default::default());
        for mode in [ColorMode::Rgb, ColorMode::Spectral] {
            let options = CompileOptions { size: Some((17, 13)), mode: Some(mode), ..CompileOptions::default() };
            let scene = Arc::new(compile(&loaded.desc, &options).scene.expect("a sound scene"));
            for (max, roulette_after, hide_emitters) in [(24, 0, false), (24, 100, false), (2, 1, true)] {
                let own = Recursive(Depth { max, roulette_after, hide_emitters });
                let options = format!("max_depth={max},rr_depth={roulette_after},hide_emitters={hide_emitters}");
                let integrator = Some(format!("path:reuse=1,effort=even,caustics=false,{options}"));
                let quality = Quality { integrator, spp: Some(8), seed: Some(5), ..Quality::default() };
                let path = quality.render(&scene).expect("a plan");
                let own = taken(&mut PerPixel::per_pixel(Arc::clone(&scene), own, path.plan));
                let film = taken(&mut *path.session(&scene).expect("a session"));
                let bits = |film: &Film| film.pixels.iter().map(|p| p.sum.map(f64::to_bits)).collect::<Vec<_>>();
                assert!(film.pixels.iter().any(|p| p.sum[1] > 0.0), "{name}, {options}: a black picture");
                assert_eq!(bits(&own), bits(&film), "{name}, {mode:?}, {options}");
            }
        }
    }
}

/// Values sprinkled over the film come to the layer of albedo, and do not depend on threads.
#[test]
fn a_pass_of_ones_own() {
    let scene = room();
    let with_threads =
        |threads| taken(&mut Passes::new(Arc::clone(&scene), Sprinkled, Plan { threads, ..plan(&scene, 256) }));
    let film = with_threads(1);
    let bits = |film: &Film| film.pixels.iter().map(|p| p.sum.map(f64::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&film), bits(&with_threads(2)));
    let albedo = film.layers.features.iter().map(|f| f64::from(f.mean().albedo[1])).sum::<f64>()
        / film.layers.features.len() as f64;
    let (found, error) = mean(&film);
    // The filter carries some of it over the edges of the film.
    assert!((found / albedo - 1.0).abs() < 0.08 && error < 0.01, "{found} ± {error}, not {albedo}");
}

/// Errors have all messages, with places; what is only told comes with the scene.
#[test]
fn scenes_are_opened_with_all_that_is_said_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |text: &str| {
        let path = folder.path().join("s.pbrt");
        std::fs::write(&path, text).expect("written");
        steradian::open(path)
    };
    let wrong = "WorldBegin\nShape \"sphre\"\nMaterial \"diffuse\" \"float reflectance\" [ \"red\" ]\n";
    let said = file(wrong).expect_err("errors").to_string();
    assert!(said.contains("s.pbrt:2:7") && said.contains("'sphere'") && said.contains("s.pbrt:3:"), "{said}");
    let (scene, messages) = file("WorldBegin\nShape \"sphere\" \"float raduis\" 2\n").expect("a scene");
    assert!(scene.geometries().len() == 1 && messages.iter().any(|m| m.to_string().contains("raduis")));
}

/// A scene, a picture and a file in one expression; what is wrong comes with its place, and no file is left.
#[test]
fn a_picture_in_one_expression() {
    use steradian::prelude::*;
    let folder = tempfile::tempdir().expect("a folder");
    let (scene, file) = (folder.path().join("s.pbrt"), folder.path().join("s.exr"));
    let picture = |text: &str| -> Result<(), Error> {
        std::fs::write(&scene, text).expect("written");
        Scene::load(&scene)?.render(&Quality::of("path:max_depth=2").spp(2))?.save(&file)
    };
    let film = r#"Film "rgb" "integer xresolution" 5 "integer yresolution" 3 Camera "perspective" "#;
    let said = picture(&format!("{film} WorldBegin Shape \"sphre\"")).expect_err("an error").to_string();
    assert!(said.contains("s.pbrt:1:") && said.contains("'sphere'") && !file.exists(), "{said}");
    picture(&format!("{film} WorldBegin LightSource \"infinite\"")).expect("a picture");
    let read = steradian::image::read(&file, &Default::default()).expect("a picture");
    assert_eq!((read.width(), read.height()), (5, 3));
    assert!(read.channel("G").expect("green").iter().all(|v| *v > 0.5));
}

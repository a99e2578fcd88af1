//! Methods that a trial chooses.

use steradian::{CompileOptions, Layer, Quality, Scene, auto::AUTO, compile, load};

/// A scene of `scenes/verify`, 32 × 32 pixels.
fn verified(name: &str) -> Scene {
    let path = format!("{}/../../scenes/verify/{name}.pbrt", env!("CARGO_MANIFEST_DIR"));
    let mode = Some(steradian::ColorMode::Rgb);
    let options = CompileOptions { mode, size: Some((32, 32)), ..Default::default() };
    compile(&load(path, &Default::default()).desc, &options).scene.expect(name)
}

/// Path tracing is chosen where it finds all light easily, and another method for the caustic of a small lamp, whatever
/// the number of threads, the seed and the samples.
#[test]
fn the_choice_suits_the_scene_alone() {
    for (name, is_path) in [("diffuse", true), ("caustic", false)] {
        let scene = verified(name);
        let chosen = |threads, seed, spp| {
            let quality = Quality { threads, seed: Some(seed), ..Quality::of(AUTO).spp(spp) };
            quality.render(&scene).expect("a method")
        };
        let render = chosen(1, 0, 16);
        let choice = render.choice.clone().expect("a trial");
        assert_eq!(render.name == "path", is_path, "{name}: {choice}");
        let errors: Vec<f64> = choice.tried.iter().map(|t| t.1).collect();
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(errors.len() == 4 && errors.iter().all(|e| e.is_finite() && *e > 0.0), "{name}: {choice}");
        assert!(is_path || errors[0] > 5.0 * least, "{name}: {choice}");
        if !is_path {
            let again = chosen(3, 7, 4);
            assert_eq!((again.name, again.choice), (render.name, Some(choice)), "{name}");
        }
    }
}

/// Methods that do not do what is asked for are not tried; where one alone is left there is no trial.
#[test]
fn candidates_do_what_is_asked_for() {
    let quality = Quality { layers: vec![Layer::BOUNCES], ..Quality::of(AUTO) };
    for (scene, name) in [("caustic", "path"), ("fog", "volpath")] {
        let render = quality.render(&verified(scene)).expect("a method");
        assert_eq!((render.name, render.choice.expect("an answer").tried), (name, Vec::new()));
    }
    let unknown = Quality::of("auto:max_depth=3").render(&verified("diffuse")).unwrap_err().to_string();
    assert!(unknown.contains("auto"), "{unknown}");
}

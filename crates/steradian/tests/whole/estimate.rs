//! The estimated error against the true one, where light comes by paths that are hardly ever found.

use std::{path::PathBuf, sync::Arc};
use steradian::{CompileOptions, Control, Film, Quality, Scene, Session, compile, integrators::Doubt, load};

fn scene(name: &str) -> Arc<Scene> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/scenes/{name}.pbrt"));
    let loaded = load(&path, &Default::default());
    assert!(!loaded.diagnostics.has_errors(), "{:#?}", loaded.diagnostics);
    Arc::new(compile(&loaded.desc, &CompileOptions::default()).scene.expect("a sound scene"))
}

fn session(scene: &Arc<Scene>, integrator: &str, spp: u32, seed: u64, error: Option<f64>) -> Box<dyn Session> {
    let integrator = Some(integrator.into());
    let quality = Quality { integrator, spp: Some(spp), seed: Some(seed), error, ..Quality::default() };
    let mut session = quality.render(scene).expect("a registered integrator").session(scene).expect("a session");
    session.step(u32::MAX, &Control::default());
    session
}

/// True value of the estimate of [`Session::error`].
fn true_error(film: &Film, reference: &Film) -> f64 {
    let of = |k: usize, c: usize| {
        let (m, r) = (film.pixels[k].mean()[c], reference.pixels[k].mean()[c]);
        (m - r).powi(2) / (r * r + 0.01)
    };
    let sum: f64 = (0..film.pixels.len()).map(|k| (0..3).map(|c| of(k, c)).sum::<f64>()).sum();
    (sum / (3 * film.pixels.len()) as f64).sqrt()
}

/// A pool lit through the water by a lamp of 5 mm: paths by chance miss that light or meet it once, which their samples
/// do not tell; no error is reached then, however large. Photons are what it takes, and are taken.
#[test]
fn light_through_water_is_not_thought_to_be_found() {
    let scene = scene("water");
    for seed in 0..3 {
        for spp in [16, 64] {
            let by_chance = session(&scene, "path:reuse=1,caustics=false", spp, seed, Some(10.0));
            assert_eq!(by_chance.doubt(), Some(Doubt::HardlyFound), "seed {seed}, {spp} samples");
            assert!(!by_chance.is_good_enough() && by_chance.samples() == spp);
        }
        assert!(session(&scene, "path:reuse=1", 2, seed, None).asks_photons(), "seed {seed}");
    }
}

/// The estimate is within a factor of two of the true error, or in doubt: by chance and with photons, in both scenes.
#[test]
fn errors_are_what_is_estimated_or_in_doubt() {
    for name in ["water", "egg"] {
        let scene = scene(name);
        let reference = session(&scene, "vcm", 128, 1000, None).film();
        for integrator in ["path:reuse=1,caustics=false", "path:reuse=1", "bdpt"] {
            for seed in 0..3 {
                let session = session(&scene, integrator, 32, seed, None);
                let (told, found) = (session.error().expect("32 samples"), true_error(&session.film(), &reference));
                if session.doubt().is_none() {
                    let ratio = told / found;
                    assert!((0.5..2.0).contains(&ratio), "{name}, {integrator}, seed {seed}: {told} for {found}");
                }
            }
        }
    }
}

/// Under a spot lamp a glass egg's light rules the error, and photons are asked: a cap on what one path may bring would
/// hide it.
#[test]
fn photons_are_asked_for_an_egg_under_a_lamp() {
    let egg = scene("egg");
    for seed in 0..2 {
        assert!(session(&egg, "path:reuse=1", 2, seed, None).asks_photons());
    }
}

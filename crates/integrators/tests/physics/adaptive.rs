//! Adaptive sampling: no bias, honest variances, less noise, the same bits.

use crate::{
    shot::{SIGMAS, Shot, same_bits},
    stage::{Stage, diffuse, plane, rectangle},
};
use steradian_core::Scene;
use steradian_integrators::Control;
use steradian_testkit::Moments;

/// A lamp of radiance one seen through a sheet that lets a part of all rays pass, over the left `width` of a frame two
/// units wide; the lamp alone over the rest. So samples are one with a probability, else zero.
fn veil(passes: f64, width: f64) -> Scene {
    let mut stage = Stage::new();
    let grey = stage.add(diffuse(0.5));
    stage.place_mesh(rectangle([-1.0, -1.0, 0.0], [width, 0.0, 0.0], [0.0, 2.0, 0.0])).material = Some(grey);
    let sheet = stage.desc.shapes.last().expect("the sheet").node;
    stage.desc.node_mut(sheet).set("alpha", 1.0 - passes, None);
    stage.lamp(plane([0.0, 0.0, -1.0], -3.0), 1.0);
    let camera = steradian_scene::Node::new(steradian_scene::Family::Camera, "orthographic", None)
        .with("screen_window", vec![-1.0, 1.0, -1.0, 1.0])
        .with("to_world", crate::stage::look_at([0.0, 0.0, -4.0], [0.0; 3]));
    stage.film(32, 32).camera(camera);
    stage.scene()
}

/// Rare bright samples: cells that begin dark get fewer samples, and their dark beginning must not count for more
/// because of it. Weighting rounds by their numbers of samples fails this by five to six standard errors. 4σ over 1200
/// pictures; the evenly sampled ones are held to the same.
#[test]
fn rare_bright_samples_do_not_darken_the_picture() {
    const PASSES: f64 = 0.02;
    let whole = veil(PASSES, 0.5);
    // Pixels that are sampled evenly have the same bits without those beside them.
    let sheet = whole.clone().changed(|parts| parts.film.crop.x1 = 8);
    for (adaptive, scene, width) in [(false, sheet, 8), (true, whole, 32)] {
        let means: Moments = (0..1200)
            .map(|seed| {
                let film = Shot { adaptive, ..Shot::of("path", 16).depth(0).seed(seed) }.take(&scene);
                assert_eq!(film.pixels.iter().all(|p| p.samples == 16), !adaptive);
                film.pixels.chunks(width).flat_map(|row| &row[..8]).map(|p| p.mean()[0]).sum::<f64>() / 256.0
            })
            .collect();
        assert!(means.standard_error() < 0.004 * PASSES, "{} tells nothing", means.standard_error());
        let z = (means.mean() - PASSES) / means.standard_error();
        assert!(z.abs() < SIGMAS, "adaptive: {adaptive}: {} for {PASSES}, {z:.1} standard errors", means.mean());
    }
}

/// The variance that the film tells, from several rounds with their weights, is that of its pixels about the truth:
/// within 4 % where the standard error of that comparison is 1 %. So is the error of the whole picture.
#[test]
fn variances_of_rounds_add_up() {
    const PASSES: f64 = 0.5;
    let scene = veil(PASSES, 1.0);
    let (mut told, mut found, mut error, mut samples) = (0.0, 0.0, 0.0, 0);
    for seed in 0..12 {
        let mut session = Shot::of("path", 64).depth(0).adaptive().seed(seed).session(&scene);
        session.step(u32::MAX, &Control::default());
        error += session.error().expect("two samples each").powi(2) * (PASSES * PASSES + 0.01) * 1024.0;
        let film = session.film();
        for p in &film.pixels {
            told += p.variance_of_mean()[0];
            samples += p.samples;
        }
        let veiled = film.pixels.chunks(32).flat_map(|row| &row[..16]);
        found += veiled.map(|p| (p.mean()[0] - PASSES).powi(2)).sum::<f64>();
    }
    assert!((found / told - 1.0).abs() < 0.04, "{found} for {told}");
    // The picture takes its own pixels for the truth below the fraction, which adds a little.
    assert!((error / found - 1.0).abs() < 0.08, "{error} for {found}");
    assert!((f64::from(samples) / (12.0 * 1024.0) - 64.0).abs() < 0.5, "{samples}");
}

/// Adaptive sampling of a picture with all its noise in one quarter: the same number of samples leaves less than half
/// of it: at best 1/3.6, but for the even first round and what neighbours get.
#[test]
fn samples_go_where_the_noise_is() {
    let scene = veil(0.5, 0.5);
    let shot = Shot::of("path", 64).depth(0);
    let error = |shot: Shot| -> f64 {
        let film = shot.take(&scene);
        let truth = |at: usize| if at % 32 < 8 { 0.5 } else { 1.0 };
        film.pixels.iter().enumerate().map(|(at, p)| (p.mean()[0] - truth(at)).powi(2)).sum()
    };
    let (even, adaptive) = (error(shot), error(shot.adaptive()));
    assert!(adaptive * 2.0 < even, "{adaptive} against {even}");
    let film = shot.adaptive().take(&scene);
    assert!(film.pixels[0].samples > 3 * film.pixels[31].samples && film.pixels[31].samples >= 8);
}

/// The render ends at the error asked for, not long before or after, evenly sampled or not; and it takes the samples
/// that this error needs.
#[test]
fn the_error_asked_for_ends_the_render() {
    // Relative error of one sample: ½ over √(¼ + 0.01), of all pixels or of half of them. Half of them take almost all
    // samples.
    let single = 0.5 / 0.26_f64.sqrt();
    for (adaptive, scene, single) in [(false, veil(0.5, 2.0), single), (true, veil(0.5, 1.0), 0.5 * single)] {
        for error in [0.2, 0.05] {
            let shot = Shot { adaptive, error: Some(error), ..Shot::of("path", 1 << 20).depth(0) };
            let mut session = shot.session(&scene);
            session.step(u32::MAX, &Control::default());
            let reached = session.error().expect("two samples each");
            assert!(session.is_done() && session.is_good_enough() && reached <= error);
            let needed = (single / error).powi(2);
            let taken = f64::from(session.samples());
            assert!(taken < needed.max(16.0) * 1.5 && taken >= 0.9 * needed, "{taken} samples for {needed}");
            // Neither threads nor steps decide where it ends.
            let mut other = Shot { threads: 3, ..shot }.session(&scene);
            while !other.is_done() {
                other.step(7, &Control::default());
            }
            same_bits(&session.film(), &other.film(), &format!("adaptive: {adaptive}, error {error}"));
            session.step(5, &Control::default());
            assert_eq!(session.samples() as f64, taken, "a render that is done goes on");
        }
    }
}

/// M161: threads, steps, and steps that are cancelled change no bit, shared paths or not.
#[test]
fn no_bit_depends_on_how_the_work_is_done() {
    let scene = veil(0.5, 0.5);
    for reuse in [1, 4, 16] {
        let shot = Shot::of("path", 20).depth(8).reuse(reuse).adaptive();
        let whole = shot.take(&scene);
        assert!(whole.pixels.iter().any(|p| p.samples != 20), "all pixels have the same number of samples");
        let mut session = Shot { threads: 3, ..shot }.session(&scene);
        for n in [1, 3, 4, 2] {
            session.step(n, &Control::default());
        }
        let cancelled = Control::default();
        cancelled.cancel.store(true, std::sync::atomic::Ordering::Relaxed);
        session.step(100, &cancelled);
        assert!(!session.is_done());
        session.step(100, &Control::default());
        assert!(session.is_done());
        same_bits(&whole, &session.film(), &format!("{reuse} paths share"));
    }
}

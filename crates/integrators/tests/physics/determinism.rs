//! Determinism: equal bits, however the work is done.

use crate::{
    materials::cases,
    shot::{Shot, same_bits},
    stage::{Stage, diffuse, light, plane, rectangle, shape, sphere, white},
};
use steradian_core::{ColorMode, Scene, sampler::SAMPLERS};
use steradian_integrators::Control;
use steradian_math::{DVec3, Transform};
use steradian_scene::Family;

/// A ball of every material on a floor, lit by an area, a point and the sky; masks, mixtures and interfaces among them.
pub fn collection(mode: ColorMode) -> Scene {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.5));
    for (i, case) in cases().iter().enumerate() {
        let made_of = (case.make)(&mut stage.desc);
        let center = [(i % 6) as f64 - 2.5, 0.4, (i / 6) as f64];
        // Every third is a disk, so that both kinds of surfaces are met.
        let node = if i % 3 == 2 { shape("disk").with("radius", 0.4) } else { sphere([0.0; 3], 0.4) };
        let body = stage.place(node);
        body.material = Some(made_of);
        body.world_from_object = Transform::translate(DVec3::from_array(center)) * Transform::rotate(DVec3::X, 0.5);
    }
    stage.mesh_lamp(rectangle([-1.0, 3.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]), 3.0);
    stage.light(light("point").with("position", [2.0, 2.0, -2.0]).with("intensity", white(2.0)));
    stage.sky(0.4).film(37, 29).look([0.5, 3.5, -5.0], [0.0, 0.2, 1.5], 45.0);
    stage.scene_in(mode)
}

/// M161, M166: no number of threads changes a bit, whatever the integrator and the sampler.
#[test]
fn threads_do_not_change_a_bit() {
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        let scene = collection(mode);
        // Radiosity has a test of its own, with fewer patches.
        for integrator in Family::Integrator.kinds().filter(|name| !["radiosity", "raster"].contains(name)) {
            let shot = Shot::of(integrator, 3).depth(8).reuse(16);
            let one = shot.take(&scene);
            for threads in [2, 3, 7] {
                same_bits(&one, &Shot { threads, ..shot }.take(&scene), &format!("{integrator} on {threads} threads"));
            }
        }
    }
    let scene = collection(ColorMode::Rgb);
    for (name, sampler) in SAMPLERS {
        let shot = Shot { sampler: *sampler, ..Shot::of("path", 4).reuse(16) };
        same_bits(&shot.take(&scene), &Shot { threads: 5, ..shot }.take(&scene), name);
    }
}

/// M161: eight samples at once have the bits of one, three, and four more; so have those of a step that is cancelled
/// before it begins and taken again.
#[test]
fn steps_do_not_change_a_bit() {
    let scene = collection(ColorMode::Spectral);
    for (name, sampler) in SAMPLERS {
        let shot = Shot { sampler: *sampler, threads: 2, ..Shot::of("path", 8).reuse(4) };
        let whole = shot.take(&scene);
        let mut session = shot.session(&scene);
        for n in [1, 3] {
            session.step(n, &Control::default());
        }
        assert!(!session.is_done());
        let cancelled = Control::default();
        cancelled.cancel.store(true, std::sync::atomic::Ordering::Relaxed);
        session.step(4, &cancelled);
        assert!(session.film().pixels.iter().all(|p| p.samples == 4), "a cancelled step took samples");
        session.step(4, &Control::default());
        assert!(session.is_done());
        same_bits(&whole, &session.film(), name);
    }
}

/// A crop has the bits of the whole picture's part.
#[test]
fn crops_do_not_change_a_bit() {
    let scene = collection(ColorMode::Rgb);
    let crop = steradian_core::film::Crop { x0: 5, y0: 7, x1: 30, y1: 24 };
    let cropped = scene.clone().changed(|parts| parts.film.crop = crop);
    for reuse in [1, 4, 16] {
        let shot = Shot::of("path", 2).reuse(reuse);
        let (whole, part) = (shot.take(&scene), shot.take(&cropped));
        for y in 7..24_usize {
            for x in 5..30_usize {
                let (a, b) = (whole.pixels[y * 37 + x], part.pixels[(y - 7) * 25 + x - 5]);
                assert_eq!(a.sum.map(f64::to_bits), b.sum.map(f64::to_bits), "{reuse} paths share");
            }
        }
    }
}

//! A wish to stop is answered wherever paths are.

use crate::{
    Control, Counters, Depth, Integrator, IntegratorKind, Plan, Precomputed, Session, Stop, VarianceReduction,
    path::Path, path_recursive::PathRecursive, raycast::Raycast, stokes::Stokes, whitted::Whitted,
};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use steradian_core::{
    ColorMode, Scene,
    compile::{Options, compile},
    sampler::{Sampler, SamplerKind},
};
use steradian_math::{Transform, spectra::Wavelengths};
use steradian_scene::{ColorSpace, Family, Format, Node, SceneDesc, Shape, SpectrumValue, Value};

const FOREVER: Depth = Depth { max: u32::MAX, roulette_after: u32::MAX, hide_emitters: false };

/// A camera in a ball of which nothing leaves: of mirrors, or of white walls.
fn ball(kind: &str) -> Scene {
    let white = Value::Spectrum(SpectrumValue::Rgb([1.0; 3], ColorSpace::Srgb));
    let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let film = Node::new(Family::Film, "rgb", None).with("width", 64i64).with("height", 64i64);
    desc.film = Some(desc.add(film));
    let camera = Node::new(Family::Camera, "perspective", None).with("to_world", Transform::IDENTITY);
    desc.cameras = vec![desc.add(camera)];
    let made_of = desc.add(Node::new(Family::Material, kind, None).with("reflectance", white));
    let node = desc.add(Node::new(Family::Shape, "sphere", None));
    desc.shapes.push(Shape { material: Some(made_of), ..Shape::new(node) });
    compile(&desc, &Options { mode: Some(ColorMode::Rgb), spp: Some(1), ..Options::default() }).scene.unwrap()
}

/// Where a stop is asked for before a path begins, at most one ray of it is followed; without, a path in such a ball
/// has hundreds, before roulette ends it.
#[test]
fn paths_end_where_they_are() {
    let (variance_reduction, depth) = (VarianceReduction::default(), Depth { roulette_after: 0, ..FOREVER });
    let rays = |integrator: &dyn Integrator, scene: &Scene, stop: &Stop| {
        let sampler = Sampler { kind: SamplerKind::Independent, spp: 1, seed: 0 }.pixel(3, 5, 0);
        let ray = scene.camera.ray(&scene.film, steradian_math::Vec2::new(3.5, 5.5), steradian_math::Vec2::splat(0.5));
        let (mut counters, mut lambda) = (Counters::until(stop), Wavelengths::RGB);
        integrator.radiance(scene, &Precomputed::default(), ray, &sampler, &mut lambda, &mut counters);
        counters.rays
    };
    for kind in ["conductor", "diffuse"] {
        let scene = ball(kind);
        let long: [&dyn Integrator; 3] = [
            &Path { depth, variance_reduction },
            &PathRecursive { depth, variance_reduction },
            &Stokes { depth, component: 0 },
        ];
        let short: [&dyn Integrator; 2] = [&Whitted { depth }, &Raycast];
        let stop = Stop::by(&Arc::new(AtomicBool::new(true)));
        for integrator in long {
            let endless = rays(integrator, &scene, &Stop::default());
            assert!(endless >= 100 && rays(integrator, &scene, &stop) <= 1, "{kind}: {endless} rays");
        }
        assert!(short.into_iter().all(|integrator| rays(integrator, &scene, &stop) <= 1), "{kind}");
    }
}

/// A render of such paths, and the trials before it, end when that is asked for, on one thread and on several, with
/// shared paths and without; what is there are whole samples, and it goes on from them to the same bits.
#[test]
fn renders_end_where_they_are() {
    let scene = ball("diffuse");
    for (reuse, threads) in [(Some(1), 1), (Some(16), 1), (Some(16), 3), (None, 2)] {
        let variance_reduction = VarianceReduction { reuse, ..VarianceReduction::default() };
        let integrator = IntegratorKind::named("path", FOREVER, variance_reduction).unwrap();
        let plan = |spp| Plan {
            integrator,
            sampler: Sampler { kind: SamplerKind::ZSobol, spp, seed: 0 },
            threads,
            features: false,
            transparent: false,
            mattes: false,
            by_light: false,
            adaptive: false,
            error: None,
        };
        // So many samples that it would take days.
        let control = Control::default();
        let cancel = Arc::clone(&control.cancel);
        let mut session = Session::new(&scene, plan(1 << 24));
        std::thread::scope(|scope| {
            scope.spawn(move || {
                std::thread::sleep(std::time::Duration::from_millis(30));
                cancel.store(true, Ordering::Relaxed);
            });
            session.step(u32::MAX, &control);
        });
        assert!(!session.is_done());
        let film = session.film();
        let most = film.pixels.iter().map(|p| p.samples).max().unwrap_or(0);
        assert_eq!(session.counters().samples, film.pixels.iter().map(|p| u64::from(p.samples)).sum::<u64>());
        if reuse == Some(1) {
            assert!(most < 1 << 24);
        } else {
            assert!(film.pixels.iter().all(|p| p.samples + 3 >= most), "{reuse:?}, {threads} threads");
        }
    }
}

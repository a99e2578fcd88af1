//! Cancellation is polled along each path.

use crate::{
    Control, Counters, Depth, Integrator, Method as _, Plan, SharedPath, Stop, VarianceReduction, path::PathTracer,
    raycast::Raycast, stokes::Stokes, whitted::Whitted,
};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use steradian_compile::{Options, compile};
use steradian_core::{
    ColorMode, Scene,
    sampler::{Sampler, SamplerKind},
};
use steradian_engine::PathContext;
use steradian_math::{Transform, spectra::Wavelengths};
use steradian_scene::{ColorSpace, Family, Format, Node, SceneDesc, Shape, SpectrumValue, Value};

const FOREVER: Depth = Depth { max: u32::MAX, roulette_after: u32::MAX, hide_emitters: false };

/// A camera in a ball of which nothing leaves: of mirrors, or of white walls.
pub(crate) fn ball(kind: &str) -> Scene {
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

/// A path with a stop asked for before it begins follows one ray at most; without, a path in such a ball has hundreds,
/// before roulette ends it.
#[test]
fn paths_end_where_they_are() {
    let depth = Depth { roulette_after: 0, ..FOREVER };
    for kind in ["conductor", "diffuse"] {
        let scene = ball(kind);
        let stop = Stop::by(&Arc::new(AtomicBool::new(true)));
        let both = |rays: &dyn Fn(&Stop) -> u64| [rays(&Stop::default()), rays(&stop)];
        let long = [
            both(&|stop| rays(&PathTracer::<false> { depth }, &scene, stop)),
            both(&|stop| rays(&Stokes { depth, component: 0 }, &scene, stop)),
        ];
        for [endless, stopped] in long {
            assert!(endless >= 100 && stopped <= 1, "{kind}: {endless} rays");
        }
        assert!(
            rays(&Whitted { depth }, &scene, &stop) <= 1 && rays(&Raycast { hide_emitters: false }, &scene, &stop) <= 1,
            "{kind}"
        );
    }
}

/// Between mirrors that absorb nothing a path ends all the same, however late roulette is to begin.
#[test]
fn no_path_is_endless() {
    let scene = ball("conductor");
    let rays = rays(&PathTracer::<false> { depth: FOREVER }, &scene, &Stop::default());
    assert!((1000..20_000).contains(&rays), "{rays}");
    // The path of a sample, with all its vertices.
    let sampler = Sampler { kind: SamplerKind::Independent, spp: 1, seed: 0 };
    let path = crate::traced::trace(&scene, &sampler, (false, FOREVER), [3, 5], 0);
    assert_eq!(path.end, crate::traced::End::Roulette);
}

/// Rays of one path.
fn rays<I: Integrator>(integrator: &I, scene: &Scene, stop: &Stop) -> u64 {
    let sampler = Sampler { kind: SamplerKind::Independent, spp: 1, seed: 0 }.pixel(3, 5, 0);
    let ray = scene.camera().ray(scene.film(), steradian_math::Vec2::new(3.5, 5.5), steradian_math::Vec2::splat(0.5));
    let (mut counters, mut lambda) = (Counters::until(stop), Wavelengths::RGB);
    let context = &mut PathContext { scene, sampler: &sampler, lambda: &mut lambda, counters: &mut counters };
    integrator.radiance(&I::Prepared::default(), ray, context);
    counters.rays
}

/// A render of such paths, and the trials before it, end when that is asked for, on one thread and on several, with
/// shared paths and without; what is there are whole samples, and it goes on from them to the same bits.
#[test]
fn renders_end_where_they_are() {
    let scene = Arc::new(ball("diffuse"));
    for (reuse, threads) in [(Some(1), 1), (Some(16), 1), (Some(16), 3), (None, 2)] {
        let variance_reduction = VarianceReduction { reuse, ..VarianceReduction::default() };
        let integrator = SharedPath { path: PathTracer::<false> { depth: FOREVER }, variance_reduction };
        let plan = |spp| Plan { threads, ..Plan::new(Sampler { kind: SamplerKind::ZSobol, spp, seed: 0 }) };
        // So many samples that it would take days.
        let control = Control::default();
        let cancel = Arc::clone(&control.cancel);
        let mut session = integrator.session(Arc::clone(&scene), plan(1 << 24)).unwrap();
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

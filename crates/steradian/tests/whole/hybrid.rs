//! Hybrid frames of `raster` against the scene's own rays and against paths.

use std::{path::PathBuf, sync::Arc};
use steradian::{
    ColorMode, CompileOptions, Control, Film, History, Quality, Scene, compile, load,
    math::{Ray, Vec3, hash::HashRng},
};
use steradian_realtime::{World, draw_list::DrawList};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn scene(path: &PathBuf, size: (u32, u32)) -> Arc<Scene> {
    let options = CompileOptions { size: Some(size), mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let scene = compile(&load(path, &Default::default()).desc, &options).scene;
    Arc::new(scene.unwrap_or_else(|| panic!("{}: no scene", path.display())))
}

fn film(scene: &Arc<Scene>, integrator: &str, spp: u32, threads: usize) -> Film {
    let quality = Quality { integrator: Some(integrator.into()), spp: Some(spp), threads, ..Quality::default() };
    let mut session = quality.render(scene).expect("a method").session(scene).expect("a session");
    session.step(u32::MAX, &Control::default());
    assert_eq!(session.failure(), None);
    session.film()
}

fn means(film: &Film) -> Vec<[f64; 3]> {
    film.pixels.iter().map(|p| p.mean()).collect()
}

/// Rays through the structures of the ray-tracing pipeline meet what they meet through those of the scene: meshes,
/// spheres and other shapes, placed groups, masks.
#[test]
fn rays_meet_what_the_scene_has() {
    let folder = folder().join("verify");
    let (mut count, mut hits, mut odd) = (0, 0, 0);
    for path in std::fs::read_dir(folder).expect("the folder").map(|e| e.expect("an entry").path()) {
        let scene = scene(&path, (16, 16));
        let world = World::new(&scene, &DrawList::new(&scene)).expect("structures");
        let (center, radius) = scene.bounds().bounding_sphere();
        let mut rng = HashRng::new(5);
        let mut unit = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - Vec3::ONE;
        for _ in 0..5000 {
            let ray = Ray::new(center + unit() * radius, unit().normalize());
            let (found, expected) = (world.nearest(&scene, &ray), scene.intersect(&ray));
            // Surfaces that only separate media are not drawn.
            if expected.is_some_and(|hit| scene.geometry(hit.id).is_interface) {
                continue;
            }
            count += 1;
            hits += u32::from(expected.is_some());
            let is_same = match (found, expected) {
                (Some(a), Some(b)) => a.id == b.id && (a.t - b.t).abs() <= 1e-4 * b.t.max(radius),
                (a, b) => a.is_none() && b.is_none(),
            };
            assert_eq!(world.is_occluded(&scene, &ray), found.is_some(), "{}: {ray:?}", path.display());
            odd += u32::from(!is_same);
        }
    }
    // Rays that graze an edge.
    assert!(count > 80_000 && hits > 30_000 && odd < count / 5000, "{count} {hits} {odd}");
}

/// Without mirrors the terms add up to the light of paths with two scattering events.
#[test]
fn terms_are_the_light_of_two_events() {
    let scene = scene(&folder().join("verify/diffuse.pbrt"), (32, 32));
    let (found, expected) =
        (film(&scene, "raster:frame=hybrid,filter=false", 400, 2), film(&scene, "path:max_depth=2", 1600, 2));
    let (a, b) = (means(&found), means(&expected));
    let (mut squares, mut count) = (0.0, 0.0);
    for (at, (p, q)) in found.pixels.iter().zip(&expected.pixels).enumerate() {
        let (v, w) = (p.variance_of_mean(), q.variance_of_mean());
        for c in 0..3 {
            let variance = v[c] + w[c];
            if variance > 0.0 {
                squares += (a[at][c] - b[at][c]).powi(2) / variance;
                count += 1.0;
            }
        }
    }
    let mean = |values: &[[f64; 3]]| values.iter().flatten().sum::<f64>() / values.len() as f64;
    assert!((mean(&a) / mean(&b) - 1.0).abs() < 3e-3, "{} for {}", mean(&a), mean(&b));
    // Samples that are spread well differ by less than their variance says.
    assert!(count > 2900.0 && squares / count < 1.3, "{squares} over {count}");
}

/// Each term is a view, and the picture is their sum; the bits do not depend on the number of threads.
#[test]
fn the_picture_is_the_sum_of_its_terms() {
    let scene = scene(&folder().join("showcase.pbrt"), (48, 32));
    let view = |name: &str, threads| means(&film(&scene, &format!("raster:frame=hybrid,show={name}"), 1, threads));
    let (picture, emission) = (view("picture", 2), view("emission", 2));
    let [direct, indirect] = ["direct", "indirect"].map(|name| view(name, 2));
    let [reflections, transparency] = ["reflections", "transparency"].map(|name| view(name, 2));
    let (mut lit, mut reflected) = (0, 0);
    for k in 0..picture.len() {
        for c in 0..3 {
            let rest = picture[k][c] - emission[k][c] - reflections[k][c] - transparency[k][c];
            let diffuse = direct[k][c] + indirect[k][c];
            // What is left is light over albedo times an albedo, which the view does not have.
            assert!(rest >= -1e-5 && rest <= diffuse * 1.0001 + 1e-5, "{k}: {rest} of {diffuse}");
            lit += u32::from(direct[k][c] > 0.0);
            reflected += u32::from(reflections[k][c] > 0.0);
        }
    }
    assert!(lit > 500 && reflected > 50, "{lit} {reflected}");
    assert_eq!(picture, view("picture", 1));
    assert!(view("occlusion", 1).iter().flatten().all(|v| (0.0..=1.0).contains(v)));
    let graph = view("graph", 1);
    assert!(graph.iter().any(|v| *v != graph[0]));
}

/// The box of `scenes/verify/diffuse.pbrt` with another camera, and its ball beside where it was.
fn moved(step: f32, ball_moves: bool) -> Arc<Scene> {
    let text = std::fs::read_to_string(folder().join("verify/diffuse.pbrt")).expect("a scene");
    let (eye, ball) = (0.04 * step, if ball_moves { 0.1 + 0.03 * step } else { 0.1 });
    let text = text.replace("LookAt 0 0 -3.2", &format!("LookAt {eye} 0 -3.2"));
    let text = text.replace("Translate 0.1 -0.5 0.1", &format!("Translate {ball} -0.5 0.1"));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("moved.pbrt");
    std::fs::write(&path, text).expect("a file");
    scene(&path, (96, 96))
}

/// The filter keeps the light of each term: in a frame alone to rounding, and over frames that follow each other within
/// noise.
#[test]
fn filtered_terms_have_the_light_of_the_noisy_ones() {
    let light = |picture: &[[f64; 3]]| picture.iter().flatten().sum::<f64>();
    let showcase = scene(&folder().join("showcase.pbrt"), (80, 50));
    for term in ["direct", "indirect", "reflections", "transparency"] {
        let of = |filter: bool| light(&frame(&showcase, &format!("show={term},filter={filter}"), 3, &mut None));
        let (filtered, noisy) = (of(true), of(false));
        assert!((filtered / noisy - 1.0).abs() < 1e-4, "{term}: {filtered} of {noisy}");
    }
    let (mut history, mut filtered, mut noisy) = (None, 0.0, 0.0);
    for number in 0..12 {
        let scene = moved(number as f32, false);
        filtered += light(&frame(&scene, "points=1,show=indirect", number, &mut history));
        noisy += light(&frame(&scene, "points=1,show=indirect,filter=false", number, &mut None));
    }
    assert!((filtered / noisy - 1.0).abs() < 0.02, "{filtered} of {noisy}");
}

/// The squared error of pictures relative to others.
fn error(found: &[[f64; 3]], expected: &[[f64; 3]]) -> f64 {
    let of = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|c| (a[c] - b[c]).powi(2) / (b[c] * b[c] + 0.01)).sum::<f64>();
    found.iter().zip(expected).map(of).sum::<f64>() / found.len() as f64
}

/// The picture of a frame of one sample, after another one.
fn frame(scene: &Arc<Scene>, options: &str, seed: u64, history: &mut Option<History>) -> Vec<[f64; 3]> {
    let integrator = Some(format!("raster:frame=hybrid,{options}"));
    let quality = Quality { integrator, spp: Some(1), threads: 2, seed: Some(seed), ..Quality::default() };
    let mut session = quality.render(scene).expect("a method").session(scene).expect("a session");
    history.iter().for_each(|history| session.follow(history));
    session.step(u32::MAX, &Control::default());
    *history = session.take_history();
    means(&session.film())
}

/// While the camera moves, or a ball too, each frame goes on from the one before: its error falls below a third of what
/// a frame has without filter, and where lights and shadows stay well below that of a filtered frame alone.
#[test]
fn sequences_have_less_noise_than_frames() {
    const COUNT: u64 = 12;
    let mut history = None;
    for ball_moves in [true, false] {
        history = None;
        let mut last = Vec::new();
        for number in 0..COUNT {
            last = frame(&moved(number as f32, ball_moves), "points=1", number, &mut history);
        }
        let scene = moved((COUNT - 1) as f32, ball_moves);
        // Through the middles of pixels, as those are.
        let mut expected = vec![[0.0; 3]; last.len()];
        for seed in 1000..1100 {
            for (sum, value) in expected.iter_mut().zip(frame(&scene, "points=8,filter=false", seed, &mut None)) {
                *sum = std::array::from_fn(|c| sum[c] + value[c] / 100.0);
            }
        }
        let noisy = error(&frame(&scene, "points=1,filter=false", COUNT, &mut None), &expected);
        let alone = error(&frame(&scene, "points=1", COUNT, &mut None), &expected);
        let together = error(&last, &expected);
        assert!(together < noisy / 3.0, "{together} of {noisy}");
        assert!(ball_moves || together < 0.7 * alone, "{together} of {alone}");
    }
    // Nothing of a sequence is left where a frame of another size follows.
    let other = scene_of_another_size();
    let alone = frame(&other, "points=1", 1, &mut None);
    assert_eq!(frame(&other, "points=1", 1, &mut history), alone);
}

fn scene_of_another_size() -> Arc<Scene> {
    scene(&folder().join("verify/diffuse.pbrt"), (40, 30))
}

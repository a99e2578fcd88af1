//! Hybrid frames of `raster` against the scene's own rays and against paths.

use std::{path::PathBuf, sync::Arc};
use steradian::{
    ColorMode, CompileOptions, Control, Film, History, Quality, Scene, compile, load,
    math::{Ray, Vec2, Vec3, hash::HashRng},
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

/// A room with a ball of a material: walls of albedo ½ under a lamp, or black walls that shine.
fn room(walls_shine: bool, material: &str) -> Arc<Scene> {
    let quad = |p: &str| format!("Shape \"trianglemesh\" \"point3 P\" [ {p} ] \"integer indices\" [ 0 1 2  0 2 3 ]\n");
    let walls = [
        "-1 -1 -1  -1 -1 1  1 -1 1  1 -1 -1",
        "-1 1 -1  1 1 -1  1 1 1  -1 1 1",
        "-1 -1 1  -1 1 1  1 1 1  1 -1 1",
        "-1 -1 -1  -1 1 -1  -1 1 1  -1 -1 1",
        "1 -1 -1  1 -1 1  1 1 1  1 1 -1",
    ];
    let light = |l: f64, p: &str| {
        format!(
            "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [{l} {l} {l}] \"bool twosided\" true {} AttributeEnd\n",
            quad(p)
        )
    };
    let black = "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n".to_owned();
    let stage: String = if walls_shine {
        black + &(1..).zip(walls).map(|(k, wall)| light(0.3 * f64::from(k), wall)).collect::<String>()
    } else {
        let lamp = light(4.0, "-0.4 0.98 -0.4  0.4 0.98 -0.4  0.4 0.98 0.4  -0.4 0.98 0.4");
        let grey = "Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\n";
        black + &lamp + grey + &walls.map(quad).concat()
    };
    let text = format!(
        r#"LookAt 0 0 -3.2  0 0 0  0 1 0 Camera "perspective" "float fov" 40
        Film "rgb" "integer xresolution" 24 "integer yresolution" 24 PixelFilter "box" WorldBegin {stage}
        Material {material} Translate 0.1 -0.2 0.1 Shape "sphere" "float radius" 0.6"#
    );
    let loaded = steradian::load_bytes("room.pbrt", text.into_bytes(), Some("pbrt"), &Default::default());
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    Arc::new(compile(&loaded.desc, &options).scene.expect("a sound scene"))
}

/// True for pixels that the ball of a room covers, by rays through nine places of each.
fn of_ball(scene: &Scene, pixel: usize) -> bool {
    (0..9).all(|k| {
        let at = Vec2::new((pixel % 24) as f32 + 0.5 * (k % 3) as f32, (pixel / 24) as f32 + 0.5 * (k / 3) as f32);
        let ray = scene.camera().ray(scene.film(), at, Vec2::splat(0.5));
        let hit = scene.intersect(&ray);
        hit.is_some_and(|hit| !matches!(scene.geometry(hit.id).shape, steradian_core::scene::Shape::Mesh(_)))
    })
}

/// A mean over pixels with its variance.
#[derive(Clone, Copy)]
struct Mean(f64, f64);

impl Mean {
    fn of(scene: &Arc<Scene>, integrator: &str, spp: u32, is_counted: impl Fn(usize) -> bool) -> Self {
        let film = film(scene, integrator, spp, 2);
        let pixels: Vec<_> = film.pixels.iter().enumerate().filter(|(k, _)| is_counted(*k)).map(|(_, p)| p).collect();
        let count = pixels.len() as f64;
        let variance: f64 = pixels.iter().map(|p| p.variance_of_mean()[1]).sum();
        Self(pixels.iter().map(|p| p.mean()[1]).sum::<f64>() / count, variance / (count * count))
    }

    fn scaled(self, k: f64) -> Self {
        Self(self.0 * k, self.1 * k * k)
    }

    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }

    fn less(self, other: Self) -> Self {
        Self(self.0 - other.0, self.1 + other.1)
    }

    fn is_near(self, other: Self, what: &str) {
        let sigma = (self.1 + other.1).sqrt();
        assert!(other.0 > 5e-3, "{what}: {}", other.0);
        assert!(
            (self.0 - other.0).abs() < 4.0 * sigma + 1e-4 * other.0,
            "{what}: {} for {} ± {sigma}",
            self.0,
            other.0
        );
        assert!(sigma < 0.03 * other.0, "{what}: ± {sigma} says nothing");
    }
}

/// M256: each term of hybrid frames is the path tracer's: emission, direct light, light after one bounce, occlusion,
/// what a mirror shows, what glass reflects and lets through, and frosted glass as a whole, of forward frames, too.
#[test]
fn each_term_is_that_of_paths() {
    let diffuse = room(false, r#""diffuse" "rgb reflectance" [0.5 0.5 0.5]"#);
    // The lamp would hide what differs: pixels that see none of it count.
    let lamp = means(&film(&diffuse, "path:max_depth=0,reuse=1", 256, 2));
    let dark = |pixel: usize| lamp[pixel][1] == 0.0;
    let frame = |show: &str, is_counted: &dyn Fn(usize) -> bool| {
        Mean::of(&diffuse, &format!("raster:frame=hybrid,filter=false,show={show}"), 600, is_counted)
    };
    let paths = |depth: u32, is_counted: &dyn Fn(usize) -> bool| {
        Mean::of(&diffuse, &format!("path:max_depth={depth},reuse=1"), 3000, is_counted)
    };
    frame("emission", &|_| true).is_near(paths(0, &|_| true), "emission");
    let (one, two) = (paths(1, &dark), paths(2, &dark));
    frame("direct", &dark).scaled(0.5).is_near(one, "direct");
    frame("indirect", &dark).scaled(0.5).is_near(two.less(one), "indirect");
    let reach = 0.1 * diffuse.bounds().bounding_sphere().1;
    let open = Mean::of(&diffuse, &format!("ao:distance={reach}"), 1600, |_| true);
    frame("occlusion", &|_| true).is_near(open, "occlusion");
    for (what, material, terms) in [
        ("mirror", r#""conductor" "rgb reflectance" [1 1 1] "float roughness" 0"#, &["reflections"][..]),
        ("glass", r#""dielectric""#, &["reflections", "transparency"]),
        ("frosted glass", r#""dielectric" "float roughness" 0.3"#, &["picture"]),
    ] {
        let scene = room(true, material);
        let of = |integrator: &str, spp| Mean::of(&scene, integrator, spp, |pixel| of_ball(&scene, pixel));
        let right = of("path:max_depth=9,reuse=1", 1600);
        let term = |show: &&str| of(&format!("raster:frame=hybrid,filter=false,show={show}"), 400);
        let found = terms.iter().map(term).reduce(Mean::plus).expect("a term");
        found.is_near(right, what);
        of("raster:frame=forward", 400).is_near(right, &format!("{what}, forward"));
    }
}

/// Each term is a view. What the picture has beyond emission, mirrors and glass lies between nothing and the diffuse
/// terms, which are light over albedo; [`each_term_is_that_of_paths`] holds each of them. The bits do not depend on the
/// number of threads.
#[test]
fn the_picture_lies_between_its_terms() {
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

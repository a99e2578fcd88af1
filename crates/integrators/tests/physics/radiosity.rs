//! Radiosity against closed forms and against path tracing.

use crate::{
    shot::{Shot, mean},
    stage::{Stage, cuboid, diffuse, light, material, plane, rectangle, rgb, sphere, white},
};
use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};
use steradian_core::{
    Scene,
    sampler::{Sampler, SamplerKind},
};
use steradian_integrators::{
    Counters, Depth, Integrator, PathContext,
    radiosity::{FormFactors, METHODS, Method, Refusal, Settings, Solution, View, Watcher, solve},
};
use steradian_math::{Ray, Vec2};
use steradian_scene::Mesh;

/// Everything by a fixed number of patches.
fn settings(method: Method, patches: usize) -> Settings {
    Settings { method, patches, adaptive: 0, tolerance: 1e-6, ..Settings::default() }
}

fn solved(scene: &Scene, settings: &Settings) -> Solution {
    solve(scene, settings, &()).expect("a scene for radiosity").expect("nobody said stop")
}

/// The mean of the picture (first three lanes) by so many samples per pixel.
fn picture(scene: &Scene, solution: Solution, gather: u32, spp: u32) -> [f64; 3] {
    picture_to(u32::MAX, scene, solution, gather, spp)
}

/// The mean of the picture of paths with at most `max` scattering events.
fn picture_to(max: u32, scene: &Scene, solution: Solution, gather: u32, spp: u32) -> [f64; 3] {
    let depth = Depth { max, roulette_after: 8, hide_emitters: false };
    let view = View { settings: Settings::default(), depth, gather, smooth: true };
    let solution = Some(Arc::new(solution));
    let sampler = Sampler { kind: SamplerKind::ZSobol, spp, seed: 1 };
    let (w, h) = (scene.film().width, scene.film().height);
    let mut sum = [0.0; 3];
    for k in 0..w * h * spp {
        let (x, y, index) = (k / spp % w, k / spp / w, k % spp);
        let s = sampler.pixel(x, y, index);
        let at = Vec2::new(x as f32, y as f32) + s.get_2d(0);
        let ray: Ray = scene.camera().ray(scene.film(), at, Vec2::splat(0.5));
        let mut lambda = scene.mode().wavelengths(|| s.get_1d(2));
        let counters = &mut Counters::default();
        let l = view.radiance(&solution, ray, &mut PathContext { scene, sampler: &s, lambda: &mut lambda, counters });
        let c = scene.mode().to_rgb(l, &lambda);
        sum.iter_mut().zip(c.to_array()).for_each(|(s, c)| *s += f64::from(c) / f64::from(w * h * spp));
    }
    sum
}

/// The lab's box of half width one with its two spheres, open in front, lit by its ceiling or by a point.
fn lab_box(ceiling: bool) -> Stage {
    let mut stage = Stage::new();
    let walls = [
        ([1.0, 0.0, 0.0], [0.75, 0.1, 0.1]),
        ([-1.0, 0.0, 0.0], [0.1, 0.6, 0.1]),
        ([0.0, 1.0, 0.0], [0.75; 3]),
        ([0.0, 0.0, -1.0], [0.75; 3]),
        ([0.0, -1.0, 0.0], [0.75; 3]),
    ];
    for (n, c) in walls {
        stage.solid(plane(n, -1.0), diffuse(0.0).with("reflectance", rgb(c)));
    }
    stage.solid(sphere([-0.5, -0.7, 0.25], 0.3), diffuse(0.0).with("reflectance", rgb([0.85, 0.5, 0.65])));
    stage.solid(sphere([0.5, -0.7, -0.25], 0.3), diffuse(0.0).with("reflectance", rgb([0.45, 0.75, 0.85])));
    if ceiling {
        let lamp = stage.add(light("area").with("radiance", white(1.0)));
        stage.desc.shapes[4].emission = Some(lamp);
    } else {
        stage.light(light("point").with("position", [0.0, 0.5, 0.0]).with("intensity", white(1.0)));
    }
    stage.film(16, 16);
    stage.look([0.0, 0.0, -3.5], [0.0, 0.0, 0.0], 2.0 * (1.0_f64 / 3.0).atan().to_degrees());
    stage
}

fn relative(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max)
}

/// M180, M182: the mean of the lab's box is path tracing's within 1 %, and nearer with more patches; with a final
/// gather too.
#[test]
fn the_lab_box_is_as_bright_as_by_path_tracing() {
    for ceiling in [true, false] {
        let scene = lab_box(ceiling).scene();
        let truth = mean(&Shot { threads: 0, ..Shot::of("path", 4096) }.take(&scene));
        let error =
            |solution: &Solution, gather: u32| relative(picture(&scene, solution.clone(), gather, 32), truth.mean);
        let of = |patches: usize| solved(&scene, &settings(Method::GaussSeidel, patches));
        let fine = of(2000);
        let (coarse, fine, gathered) = (error(&of(250), 0), error(&fine, 0), error(&fine, 1));
        let noise = (0..3).map(|c| truth.sigma[c] / truth.mean[c]).fold(0.0, f64::max);
        assert!(noise < 2e-3);
        assert!(fine < 0.01 && fine < coarse, "{coarse} {fine}");
        assert!(gathered < 0.01, "{gathered}");
    }
}

/// A closed room of a lamp, walls of many colours and a box in its middle.
fn room() -> Stage {
    let mut stage = Stage::new();
    let mut wall = |corner: [f64; 3], x: [f64; 3], y: [f64; 3], c: [f64; 3]| {
        let made_of = stage.add(diffuse(0.0).with("reflectance", rgb(c)));
        stage.place_mesh(rectangle(corner, x, y)).material = Some(made_of);
    };
    wall([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.7; 3]);
    wall([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.7; 3]);
    wall([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.8, 0.2, 0.2]);
    wall([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.2, 0.8, 0.2]);
    wall([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.5; 3]);
    wall([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.5; 3]);
    let white_box = stage.add(diffuse(0.6));
    stage.place_mesh(cuboid([0.3, 0.3, 0.0], [0.7, 0.6, 0.4])).material = Some(white_box);
    stage.mesh_lamp(rectangle([0.35, 0.35, 0.99], [0.0, 0.3, 0.0], [0.3, 0.0, 0.0]), 5.0);
    stage.film(8, 8);
    stage.look([0.5, 0.02, 0.5], [0.5, 1.0, 0.4], 80.0);
    stage
}

/// The light that patches reflect, by channel; W.
fn reflected(solution: &Solution) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (area, _, reflected) in solution.patches() {
        (0..3).for_each(|c| sum[c] += area * f64::from(reflected[0][c]));
    }
    sum
}

/// A room without anything in it: every patch sees every other one, so that analytic form factors are exact.
fn empty_room() -> Stage {
    let mut stage = Stage::new();
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let walls = [([0.0; 3], x, y, 0.5), ([0.0; 3], y, z, 0.7), (x, z, y, 0.2), ([0.0; 3], z, x, 0.6), (y, x, z, 0.4)];
    for (corner, ex, ey, reflectance) in walls {
        let made_of = stage.add(diffuse(reflectance));
        stage.place_mesh(rectangle(corner, ex, ey)).material = Some(made_of);
    }
    stage.mesh_lamp(rectangle(z, y, x), 1.0);
    stage.film(8, 8);
    stage.look([0.5, 0.02, 0.5], [0.5, 1.0, 0.4], 80.0);
    stage
}

/// M176: form factors by rays err by no more than their noise (4σ of 8 seeds). Those of hemicubes, which stand on one
/// point of a patch, err by less with finer pixels, and then by less with smaller patches.
#[test]
fn form_factors_err_by_their_own_error() {
    let scene = empty_room().scene();
    let of = |factors, seed, patches| {
        reflected(&solved(&scene, &Settings { factors, seed, ..settings(Method::Jacobi, patches) }))
    };
    let exact = of(FormFactors::Analytic, 0, 150);
    let seeds: Vec<[f64; 3]> = (1..=8).map(|seed| of(FormFactors::MonteCarlo(300), seed, 150)).collect();
    let mean = seeds.iter().map(|s| s[0]).sum::<f64>() / 8.0;
    let variance = seeds.iter().map(|s| (s[0] - mean).powi(2)).sum::<f64>() / 7.0 / 8.0;
    assert!((mean - exact[0]).abs() < 4.0 * variance.sqrt(), "{mean} ± {} {}", variance.sqrt(), exact[0]);
    assert!(variance.sqrt() < 2e-3 * exact[0], "{} {}", variance.sqrt(), exact[0]);
    let error = |pixels, patches| {
        let exact = of(FormFactors::Analytic, 0, patches);
        relative(of(FormFactors::Hemicube(pixels), 0, patches), exact)
    };
    let errors = [error(16, 150), error(64, 150), error(64, 500)];
    assert!(errors[1] < 0.5 * errors[0] && errors[2] < 0.7 * errors[1], "{errors:?}");
}

/// M176 to M179: all methods come to the same light, as far as patches and rays allow.
#[test]
fn all_methods_agree() {
    let scene = room().scene();
    let of = |s: Settings| reflected(&solved(&scene, &s));
    let matrix = of(settings(Method::GaussSeidel, 400));
    for (name, method) in METHODS {
        let exact = settings(*method, 400);
        // The hierarchy looks at links of all sizes, rays have noise; the others solve one equation.
        let (s, tolerance) = match method {
            Method::Hierarchical => (Settings { tolerance: 1e-3, patches: 1500, ..exact }, 0.02),
            Method::Stochastic => (exact, 0.02),
            // It holds rows to a sum of one where it shoots, the others where they gather.
            Method::Shooting => (Settings { tolerance: 1e-4, ..exact }, 6e-3),
            _ => (exact, 1e-3),
        };
        let other = of(s);
        assert!(relative(other, matrix) < tolerance, "{name}: {other:?} {matrix:?}");
    }
}

/// M179: the hierarchy comes to the matrix of many patches as its tolerance falls.
#[test]
fn the_hierarchy_converges() {
    let scene = room().scene();
    let truth = reflected(&solved(&scene, &settings(Method::GaussSeidel, 2000)));
    let error = |tolerance: f64| {
        let s = Settings { tolerance, ..settings(Method::Hierarchical, 4000) };
        relative(reflected(&solved(&scene, &s)), truth)
    };
    let errors = [error(1e-3), error(3e-5)];
    assert!(errors[1] < 0.5 * errors[0] && errors[1] < 0.006, "{errors:?}");
}

/// M178: a closed sphere of albedo 0.9 that emits 1/π is everywhere of radiosity 10, whatever the method.
#[test]
fn a_closed_sphere_of_a_scene_is_ten() {
    let mut stage = Stage::new();
    let lamp = stage.add(light("area").with("radiance", white(1.0 / std::f64::consts::PI)).with("two_sided", true));
    stage.solid(sphere([0.0; 3], 2.0), diffuse(0.9)).emission = Some(lamp);
    stage.probe([0.0; 3], [0.0, 0.0, 1.0]);
    let scene = stage.scene().changed(|parts| parts.materials.iter_mut().for_each(|m| m.two_sided = true));
    for (method, factors) in [
        (Method::Direct, FormFactors::MonteCarlo(256)),
        (Method::GaussSeidel, FormFactors::Hemicube(32)),
        (Method::Stochastic, FormFactors::Analytic),
    ] {
        let solution = solved(&scene, &Settings { factors, tolerance: 1e-9, rays: 100, ..settings(method, 300) });
        let (mut sum, mut area) = (0.0, 0.0);
        // Nine of the ten are reflected inside; outside there is nothing to reflect.
        for (a, _, reflected) in solution.patches().filter(|p| p.2[0][0] > 1.0) {
            sum += a * f64::from(reflected[0][0]);
            area += a;
        }
        // Every ray from the inside meets the inside; the stochastic method ends with a millionth of the light.
        let exact = if method == Method::Stochastic { 0.02 } else { 1e-3 };
        assert!((sum / area - 9.0).abs() < exact, "{method:?} {factors:?}: {}", sum / area);
    }
}

/// M181: in spectral mode radiosity is solved for each wavelength, with path tracing's mean; twice the light is twice
/// the radiosity.
#[test]
fn radiosity_is_spectral_and_linear() {
    let stage = room();
    let scene = stage.scene_in(steradian_core::ColorMode::Spectral);
    let truth = mean(&Shot { threads: 0, ..Shot::of("path", 2048) }.take(&scene));
    let solution = solved(&scene, &settings(Method::GaussSeidel, 1500));
    let ours = picture(&scene, solution, 1, 256);
    assert!(relative(ours, truth.mean) < 0.015, "{ours:?} {truth:?}");
    let dim = reflected(&solved(&stage.scene(), &settings(Method::GaussSeidel, 300)));
    let bright = stage.scene().changed(|parts| parts.lights.emitters.iter_mut().for_each(|e| e.scale *= 2.0));
    let bright = reflected(&solved(&bright, &settings(Method::GaussSeidel, 300)));
    assert!(relative(bright, dim.map(|v| 2.0 * v)) < 1e-5);
}

/// Solutions have equal bits for any number of threads, and after saving and loading.
#[test]
fn solutions_are_kept_bit_by_bit() {
    let scene = room().scene();
    for method in [Method::GaussSeidel, Method::Hierarchical, Method::Stochastic, Method::Shooting] {
        let s = Settings { adaptive: 1, tolerance: 1e-2, rays: 100, ..settings(method, 300) };
        let bits = |s: &Solution| -> Vec<[u32; 4]> {
            s.patches().flat_map(|p| [p.1[0], p.2[0]]).map(|v| v.to_array().map(f32::to_bits)).collect()
        };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| solved(&scene, &s))
        };
        let (one, three) = (on(1), on(3));
        assert_eq!(bits(&one), bits(&three), "{method:?}");
        let mut file = Vec::new();
        one.save(&mut file).expect("memory takes everything");
        let back = Solution::load(&scene, &mut &file[..], file.len() as u64).expect("what was saved");
        assert_eq!(bits(&one), bits(&back));
        for cut in (0..file.len()).step_by(file.len() / 40 + 1) {
            assert!(Solution::load(&scene, &mut &file[..cut], cut as u64).is_err(), "cut at {cut}");
        }
        let other = lab_box(true).scene();
        assert!(Solution::load(&other, &mut &file[..], file.len() as u64).is_err());
    }
}

/// Unsupported features are refused by name, those that take part in part are told.
#[test]
fn limits_are_named() {
    let mut stage = room();
    stage.solid(sphere([0.8, 0.8, 0.2], 0.1), material("plastic"));
    let scene = stage.scene();
    assert_eq!(solved(&scene, &settings(Method::GaussSeidel, 200)).report.impure.len(), 1);
    let refused = solve(&scene, &settings(Method::Direct, 1 << 20), &()).expect_err("too many");
    assert!(matches!(refused, Refusal::TooManyPatches { .. }));
    assert!(refused.to_string().contains("stochastic"), "{refused}");
}

/// A rectangle of `n`² rectangles.
fn tessellated(corner: [f64; 3], ex: [f64; 3], ey: [f64; 3], n: u32) -> Mesh {
    let point = |k: u32| {
        let (s, t) = (f64::from(k % (n + 1)) / f64::from(n), f64::from(k / (n + 1)) / f64::from(n));
        std::array::from_fn(|i| (corner[i] + ex[i] * s + ey[i] * t) as f32)
    };
    let first = (0..n * n).map(|k| k / n * (n + 1) + k % n);
    let triangles: Vec<[u32; 3]> = first.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]).collect();
    Mesh { positions: (0..(n + 1) * (n + 1)).map(point).collect(), triangles: triangles.into(), ..Mesh::default() }
}

/// A closed box of walls of `n`² rectangles each under a lamp, with a pane that transmits light.
fn fine_box(n: u32) -> Scene {
    let mut stage = Stage::new();
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let walls = [
        ([0.0; 3], z, x, 0.7),
        (y, x, z, 0.5),
        ([0.0; 3], y, z, 0.3),
        (x, z, y, 0.6),
        ([0.0; 3], x, y, 0.8),
        (z, y, x, 0.4),
    ];
    for (corner, ex, ey, grey) in walls {
        let made_of = stage.add(diffuse(grey));
        stage.place_mesh(tessellated(corner, ex, ey, n)).material = Some(made_of);
    }
    let pane =
        stage.add(material("diffuse_transmission").with("reflectance", white(0.3)).with("transmittance", white(0.4)));
    stage.place_mesh(tessellated([0.2, 0.5, 0.2], [0.6, 0.0, 0.0], [0.0, 0.0, 0.6], n)).material = Some(pane);
    stage.mesh_lamp(rectangle([0.3, 0.99, 0.3], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4]), 1.0);
    stage.film(8, 8).look([0.5, 0.6, 0.02], [0.5, 0.4, 1.0], 80.0);
    stage.scene()
}

/// With more triangles than patches asked for, patches share the light of so many clusters: the work does not grow with
/// the triangles, and the picture is that of few triangles.
#[test]
fn patches_bound_the_work_on_fine_meshes() {
    let (coarse, fine) = (fine_box(1), fine_box(12));
    let expected = picture(&coarse, solved(&coarse, &settings(Method::GaussSeidel, 600)), 0, 16);
    let methods = [Method::GaussSeidel, Method::Jacobi, Method::Direct, Method::Shooting, Method::Stochastic];
    for method in methods {
        let tolerance = if method == Method::Shooting { 0.01 } else { 1e-4 };
        let solution = solved(&fine, &Settings { rays: 2000, tolerance, ..settings(method, 200) });
        let report = &solution.report;
        assert!(report.patches > 2000 && report.clusters.is_some_and(|c| c <= 200), "{method:?}: {report:?}");
        if method != Method::Shooting {
            assert!(report.rays < 1_500_000, "{method:?}: {report:?}");
        }
        let seen = picture(&fine, solution, 0, 16);
        assert!(relative(seen, expected) < 0.04, "{method:?}: {seen:?} {expected:?}");
    }
}

/// Counts how often it is asked whether to go on, and says no from one of these times on.
struct Asked {
    times: AtomicU64,
    until: u64,
    /// Number of questions before the last exchange of light began.
    before: AtomicU64,
}

impl Asked {
    fn until(until: u64) -> Self {
        Self { times: AtomicU64::new(0), until, before: AtomicU64::new(0) }
    }

    fn times(&self) -> u64 {
        self.times.load(Ordering::Relaxed)
    }
}

impl Watcher for Asked {
    fn begins(&self, phase: &'static str, _: u64) {
        if phase != "patches" {
            self.before.store(self.times(), Ordering::Relaxed);
        }
    }

    fn advances(&self, _: u64) -> bool {
        self.times.fetch_add(1, Ordering::Relaxed) < self.until
    }
}

/// All methods ask again and again whether to go on, at least once for every 2¹⁴ rays, and end without a solution when
/// they are told to stop, at whatever time.
#[test]
fn solving_ends_when_it_is_told_to() {
    let mut stage = Stage::new();
    let grey = stage.add(diffuse(0.5));
    stage.place_mesh(rectangle([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0])).material = Some(grey);
    stage.place_mesh(rectangle([-1.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0])).material = Some(grey);
    stage.mesh_lamp(rectangle([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 1.0);
    stage.film(8, 8).look([0.0, 0.5, -3.0], [0.0, 0.5, 0.0], 40.0);
    let scene = stage.scene();
    let fine = [FormFactors::Analytic, FormFactors::MonteCarlo(4096), FormFactors::Hemicube(256)];
    for (name, method) in METHODS {
        for factors in fine.into_iter().take(if *method == Method::GaussSeidel { 3 } else { 1 }) {
            let settings = Settings { factors, rays: 20_000, adaptive: 1, tolerance: 1e-3, ..settings(*method, 24) };
            let whole = Asked::until(u64::MAX);
            let solution = solve(&scene, &settings, &whole).unwrap().unwrap();
            let all = whole.times();
            let (rays, patches) = (solution.report.rays, solution.report.patches as u64);
            let meanwhile = all - whole.before.load(Ordering::Relaxed);
            assert!(rays / meanwhile <= 1 << 14, "{name} {factors:?}: {rays} rays, asked {meanwhile} times");
            for until in (0..5).map(|k| all * k / 5).chain([all - 1]) {
                let asked = Asked::until(until);
                let found = solve(&scene, &settings, &asked).unwrap();
                let more = asked.times() - until;
                assert!(
                    found.is_none() && more <= 4 * patches + 64,
                    "{name} {factors:?}: {until} of {all}, {more} more"
                );
            }
        }
    }
}

/// With a limit on bounces the picture is the partial sum of Neumann's series: in a closed box of albedo ½ that glows,
/// `2 − ½^d`; under a point light the same as that of paths. Elimination and shooting have no bounces, and refuse.
#[test]
fn a_limit_on_bounces_is_followed() {
    let mut glowing = Stage::new();
    let made_of = glowing.add(diffuse(0.5));
    let mut inwards = cuboid([-1.0; 3], [1.0; 3]);
    inwards.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let shape = glowing.mesh_lamp(inwards, 1.0);
    shape.material = Some(made_of);
    glowing.look([0.1, 0.2, -0.3], [0.3, 0.1, 1.0], 80.0);
    glowing.film(8, 8);
    let pointed = lab_box(false);
    for (scene, patches, precision) in [(glowing.scene(), 300, 0.01), (pointed.scene(), 600, 0.03)] {
        for depth in [0_u32, 1, 3] {
            let expected = mean(&Shot::of("path", 512).depth(depth).take(&scene)).mean;
            for gather in [0, 1] {
                let bounces = Some(depth.saturating_sub(gather));
                // The gather is the same whichever method solved.
                let methods = [Method::GaussSeidel, Method::Jacobi, Method::Stochastic];
                for method in methods.into_iter().take(if gather == 0 { 3 } else { 1 }) {
                    let solution = solved(&scene, &Settings { bounces, ..settings(method, patches) });
                    let seen = picture_to(depth, &scene, solution, gather, 16);
                    let off = seen.iter().zip(expected).all(|(a, b)| (a - b).abs() <= precision * b);
                    assert!(off, "{method:?}, {depth} bounces, {gather} rays of a gather: {seen:?}, {expected:?}");
                }
            }
        }
        let expected = mean(&Shot::of("path", 512).depth(2).take(&scene)).mean;
        let links = Settings { bounces: Some(2), tolerance: 1e-4, ..settings(Method::Hierarchical, 1500) };
        let solution = solved(&scene, &links);
        let seen = picture_to(2, &scene, solution, 0, 16);
        assert!(relative(seen, expected) < precision, "the hierarchy: {seen:?}, {expected:?}");
        for method in [Method::Direct, Method::Shooting] {
            let refused = solve(&scene, &Settings { bounces: Some(3), ..settings(method, 100) }, &());
            assert!(matches!(refused, Err(Refusal::Bounces { limit: 3, .. })), "{method:?}");
        }
    }
}

/// Surfaces that scatter nothing take no part of the limit on bounces, for the camera's rays and those of the gather.
#[test]
fn interfaces_are_no_bounces() {
    let open = room().scene();
    let mut stage = room();
    for y in [0.1, 0.15, 0.2] {
        let pane = stage.add(material("interface"));
        stage.place_mesh(rectangle([0.0, y, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])).material = Some(pane);
    }
    let paned = stage.scene();
    for (depth, gather) in [(0, 0), (1, 0), (2, 1)] {
        let seen = |scene: &Scene| {
            let bounces = Some(depth - gather);
            let solution = solved(scene, &Settings { bounces, ..settings(Method::GaussSeidel, 300) });
            picture_to(depth, scene, solution, gather, 16)
        };
        let (open, paned) = (seen(&open), seen(&paned));
        assert!(relative(paned, open) < 0.01, "{depth} bounces: {paned:?}, {open:?}");
    }
}

/// An infinite plane is lit up to the horizon, beyond the part of it that is cut into patches.
#[test]
fn planes_are_bright_up_to_the_horizon() {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.5));
    stage.solid(sphere([0.0, 1.0, 0.0], 0.5), diffuse(0.5));
    stage.sky(1.0);
    stage.film(16, 16);
    stage.look([0.0, 2.0, 6.0], [0.0, 1.5, 0.0], 40.0);
    let scene = stage.scene();
    let expected = mean(&Shot::of("path", 256).take(&scene)).mean;
    for gather in [0, 1] {
        let seen = picture(&scene, solved(&scene, &settings(Method::GaussSeidel, 600)), gather, 32);
        assert!(relative(seen, expected) < 0.01, "{gather} rays of a gather: {seen:?}, {expected:?}");
    }
}

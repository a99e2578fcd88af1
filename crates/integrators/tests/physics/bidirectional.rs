//! Methods that start at lights, held against path tracing: M163, M167, M168, M173.

use crate::{
    shot::{Shot, same_bits},
    stage::{Stage, cuboid, diffuse, light, material, rectangle, rgb, shape, sphere, white},
};
use steradian_core::{ColorMode, Scene, film::Pixel};
use steradian_integrators::{Control, Film};
use steradian_scene::{Family, Node, NodeId, Value};

/// A box of five walls, open to the camera, without light.
pub fn room(wall: f64) -> Stage {
    let mut stage = Stage::new();
    stage.film(12, 12).look([0.0, 0.0, -3.2], [0.0, 0.0, 0.0], 40.0);
    for (corner, ex, ey, made_of) in [
        ([-1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0], diffuse(wall)),
        ([-1.0, 1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], diffuse(wall)),
        ([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], diffuse(wall)),
        (
            [-1.0, -1.0, -1.0],
            [0.0, 2.0, 0.0],
            [0.0, 0.0, 2.0],
            material("diffuse").with("reflectance", rgb([0.7, 0.2, 0.1])),
        ),
        ([1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0], diffuse(wall)),
    ] {
        let made_of = stage.add(made_of);
        stage.place_mesh(rectangle(corner, ex, ey)).material = Some(made_of);
    }
    stage
}

/// A square lamp under the ceiling, shining downwards.
pub fn lamp(stage: &mut Stage, edge: f64, radiance: f64) {
    stage.mesh_lamp(rectangle([-edge / 2.0, 0.98, -edge / 2.0], [edge, 0.0, 0.0], [0.0, 0.0, edge]), radiance);
}

/// Something in the middle of the room.
pub fn furnish(stage: &mut Stage, made_of: Node) {
    stage.solid(sphere([0.1, -0.5, 0.1], 0.45), made_of);
}

/// Small scenes by name, each about one thing.
fn scenes() -> Vec<(&'static str, Scene)> {
    let rough_metal = || material("conductor").with("alpha_u", 0.4).with("alpha_v", 0.4);
    let rough_glass = || material("dielectric").with("alpha_u", 0.4).with("alpha_v", 0.4);
    let mut all = Vec::new();
    let mut add = |name, made: &dyn Fn(&mut Stage)| {
        let mut stage = room(0.6);
        made(&mut stage);
        all.push((name, stage.scene()));
    };
    add("diffuse", &|s| lamp(s, 0.6, 6.0));
    add("rough metal", &|s| {
        lamp(s, 0.8, 4.0);
        furnish(s, rough_metal());
    });
    add("rough glass", &|s| {
        lamp(s, 0.8, 4.0);
        furnish(s, rough_glass());
    });
    add("glass", &|s| {
        lamp(s, 1.2, 2.0);
        furnish(s, material("dielectric"));
    });
    add("mirror", &|s| {
        lamp(s, 1.2, 2.0);
        furnish(s, material("conductor"));
    });
    add("varnish", &|s| {
        lamp(s, 0.8, 4.0);
        furnish(s, material("coated_diffuse"));
    });
    add("lamp that is a sphere", &|s| {
        s.lamp(sphere([0.2, 0.5, 0.0], 0.2), 6.0);
    });
    add("lamp that is a disk, of two sides", &|s| {
        let emission = s.add(light("area").with("radiance", white(4.0)).with("two_sided", true));
        let disk = s.solid(shape("disk").with("radius", 0.3), diffuse(0.0));
        disk.emission = Some(emission);
    });
    add("many lamps", &|s| {
        for k in 0..9 {
            let at = |k: i32| f64::from(k) * 0.6 - 0.6;
            s.lamp(sphere([at(k % 3), 0.9, at(k / 3)], 0.05), 4.0 + f64::from(k) * 2.0);
        }
    });
    add("point", &|s| {
        s.light(light("point").with("position", [0.3, 0.4, -0.2]).with("intensity", white(0.6)));
        furnish(s, rough_metal());
    });
    add("distant", &|s| {
        s.light(light("distant").with("direction", [0.3, -0.4, 1.0]).with("radiance", white(1.5)));
        furnish(s, diffuse(0.5));
    });
    add("spot", &|s| {
        let place = crate::stage::look_at([0.5, 0.9, -0.8], [0.0, -0.6, 0.2]);
        s.light(light("spot").with("intensity", white(3.0)).with("cone_angle", 40.0).with("to_world", place));
        furnish(s, diffuse(0.5));
    });
    add("sky", &|s| {
        s.sky(0.8);
        furnish(s, rough_metal());
    });
    add("sky and lamp", &|s| {
        s.sky(0.3);
        lamp(s, 0.4, 8.0);
        s.place_mesh(cuboid([-0.6, -1.0, 0.0], [-0.2, 0.0, 0.4]));
    });
    for kind in ["flat", "cylinder", "ribbon"] {
        add(format!("curves, {kind}").leak(), &|s| {
            lamp(s, 1.2, 2.0);
            tuft(s, kind);
        });
    }
    for facing in ["bent", "turned", "as_it_is"] {
        for (surface, made_of) in
            [("diffuse", diffuse(0.6)), ("rough metal", rough_metal()), ("rough glass", rough_glass())]
        {
            add(format!("normal map on {surface}, {facing}").leak(), &|s| {
                lamp(s, 1.2, 2.0);
                let map = dented(s);
                let made_of = made_of.clone().with("normal_map", map).with("detail_facing", facing);
                furnish(s, made_of.with("detail_shadowing", facing == "turned"));
            });
        }
    }
    add("mask", &|s| {
        lamp(s, 1.2, 2.0);
        let inner = s.add(diffuse(0.8));
        furnish(s, material("mask").with("opacity", 0.3).with("material", inner));
    });
    all
}

/// Curved fibres of hair and of plaster. Rays start off curves by their width: where that counts against the distance
/// of lights, densities of light samples are not those of where rays start.
fn tuft(stage: &mut Stage, kind: &str) {
    for k in 0..24 {
        let x = f64::from(k) * 0.06 - 0.7;
        let points = [x, -1.0, 0.3, x + 0.1, -0.5, 0.1, x + 0.3, -0.2, -0.3, x + 0.2, 0.2, -0.1];
        let curve = shape("curve").with("points", Value::Floats(points.to_vec())).with("type", kind);
        let normals = Value::Floats(vec![0.0, 0.3, -1.0, 0.5, 0.3, -1.0]);
        let curve = if kind == "ribbon" { curve.with("normals", normals) } else { curve };
        let hair = material("hair").with("color", rgb([0.8, 0.6, 0.3])).with("beta_m", 0.7).with("beta_n", 0.7);
        let made_of = if k % 2 == 0 { hair } else { diffuse(0.7) };
        stage.solid(curve.with("width0", 0.03).with("width1", 0.02), made_of);
    }
}

/// A normal map of steep dents.
fn dented(stage: &mut Stage) -> NodeId {
    let texture = |kind: &str| Node::new(Family::Texture, kind, None);
    let [a, b] = [[0.95, 0.6, 0.72], [0.15, 0.25, 0.7]].map(|n| stage.add(texture("constant").with("value", rgb(n))));
    stage.add(texture("checkerboard").with("a", a).with("b", b).with("scale_u", 12.0).with("scale_v", 8.0))
}

/// Means of blocks of pixels with their variances, by channel.
fn blocks(film: &Film) -> Vec<(f64, f64)> {
    const EDGE: usize = 3;
    let width = film.crop.width() as usize;
    let mut all = Vec::new();
    for y in (0..film.crop.height() as usize).step_by(EDGE) {
        for x in (0..width).step_by(EDGE) {
            let pixel = |k: usize| &film.pixels[(y + k / EDGE) * width + x + k % EDGE];
            for c in 0..3 {
                let sum = |f: &dyn Fn(&Pixel) -> f64| (0..EDGE * EDGE).map(|k| f(pixel(k))).sum::<f64>();
                let n = (EDGE * EDGE) as f64;
                all.push((sum(&|p| p.mean()[c]) / n, sum(&|p| p.variance_of_mean()[c]) / (n * n)));
            }
        }
    }
    all
}

/// Reports a disagreement of two pictures: every block has to be within the standard errors that Šidák's correction
/// allows, and the whole has to have little noise.
pub fn disagreement(what: &str, a: &Film, b: &Film, precision: f64) -> Option<String> {
    let (a, b) = (blocks(a), blocks(b));
    let level = steradian_testkit::sidak(0.01, a.len() * 100);
    let (mut difference, mut total, mut variance, mut wrong) = (0.0, 0.0, 0.0, None);
    for (k, ((m, v), (n, w))) in a.iter().zip(&b).enumerate() {
        let sigma = (v + w).sqrt();
        let p = steradian_testkit::normal_two_sided_p((m - n) / sigma.max(1e-9));
        if p <= level && (m - n).abs() > 1e-5 {
            wrong = Some(format!("{what}, block {k}: {m:.5} against {n:.5} ± {sigma:.5}"));
        }
        // Errors of channels are not independent of each other: green alone tells the total.
        if k % 3 == 1 {
            difference += m - n;
            total += n;
            variance += v + w;
        }
    }
    let sigma = variance.sqrt();
    if difference.abs() > 4.0 * sigma || sigma > precision * total {
        wrong = Some(format!("{what}: a difference of {difference:.4} from {total:.4} ± {sigma:.4}"));
    }
    wrong
}

#[track_caller]
fn agree(what: &str, a: &Film, b: &Film, precision: f64) {
    assert_eq!(disagreement(what, a, b, precision), None);
}

/// M173: all connections with exact weights have the mean of path tracing, in every scene; so do shared paths, light
/// tracing (M167) where no smooth surface is seen, and Metropolis.
#[test]
fn unbiased_methods_agree_with_path_tracing() {
    let mut wrong = Vec::new();
    for (name, scene) in scenes() {
        // Small lamps, seen from the camera, make most of the noise: elsewhere fewer samples tell as much.
        let fewer = if ["diffuse", "many lamps", "sky and lamp"].contains(&name) { 1 } else { 3 };
        let paths = Shot::of("path", 450 / fewer).depth(6).seed(7).take(&scene);
        let shared = Shot::of("path", 204 / fewer).depth(6).reuse(4).take(&scene);
        wrong.extend(disagreement(&format!("shared paths, {name}"), &shared, &paths, 0.05));
        let bdpt = Shot::of("bdpt", 120 / fewer).depth(6).take(&scene);
        wrong.extend(disagreement(&format!("bdpt, {name}"), &bdpt, &paths, 0.05));
        // The directions that bent normals fold are drawn evenly by light subpaths.
        let folds = name == "normal map on rough glass, bent";
        let light = Shot::of("light", if folds { 3000 } else { 402 / fewer }).depth(6);
        match light.limit(&scene) {
            None => wrong.extend(disagreement(&format!("light, {name}"), &light.take(&scene), &paths, 0.05)),
            Some(what) => assert!(
                ["glass", "mirror", "varnish", "curves, flat", "curves, cylinder", "curves, ribbon"].contains(&name),
                "{name}: {what}"
            ),
        }
        let metropolis = Shot::of("pssmlt", 160).depth(6).take(&scene);
        wrong.extend(disagreement(&format!("pssmlt, {name}"), &metropolis, &paths, 0.08));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Difference between two pictures without their noise, as part of the mean.
fn bias(film: &Film, reference: &Film) -> f64 {
    let (a, b) = (blocks(film), blocks(reference));
    let squares: f64 = a.iter().zip(&b).map(|((m, v), (n, w))| (m - n).powi(2) - v - w).sum();
    (squares.max(0.0) / a.len() as f64).sqrt() / (b.iter().map(|b| b.0).sum::<f64>() / b.len() as f64)
}

/// M168: photon mapping has the mean of path tracing as its radius shrinks, with a final gather and without; within a
/// wide radius the nearest photons alone are less biased than all.
#[test]
fn photons_agree_with_path_tracing_as_radii_shrink() {
    let mut wrong = Vec::new();
    for (name, scene) in scenes() {
        const HELD: [&str; 6] = ["diffuse", "glass", "point", "sky and lamp", "curves, ribbon", "mask"];
        if !HELD.contains(&name) {
            continue;
        }
        let paths = Shot::of("path", 1500).depth(6).seed(7).take(&scene);
        let at = |method, spp, options: &[(&str, &str)]| {
            let shot = Shot { threads: 2, ..Shot::of(method, spp).depth(6) };
            let options: String = options.iter().map(|(key, value)| format!("{key}={value},")).collect();
            let mut session = shot.session_of(&scene, &*shot.method(&scene, &options));
            session.step(u32::MAX, &Control::default());
            bias(&session.film(), &paths)
        };
        let photons = |options: &[(&'static str, &'static str)]| {
            at("photon", 24, &[&[("photons", "5000")][..], options].concat())
        };
        let wide_photons = photons(&[("radius", "0.6")]);
        let pairs = [
            ("vcm", at("vcm", 60, &[("radius", "0.6")]), at("vcm", 60, &[("radius", "0.1")])),
            ("sppm", at("sppm", 150, &[("radius", "0.6")]), at("sppm", 150, &[("radius", "0.1")])),
            ("photon", wide_photons, photons(&[("radius", "0.1")])),
            (
                "photon without gather",
                photons(&[("radius", "0.6"), ("gather", "false")]),
                photons(&[("radius", "0.1"), ("gather", "false")]),
            ),
            ("photon, the nearest", wide_photons, photons(&[("radius", "0.6"), ("nearest", "15")])),
        ];
        for (what, wide, narrow) in pairs {
            // Light leaks out of edges and corners by a part of the radius over the distance between them.
            if !(narrow < 0.05 && (narrow < wide || wide < 0.02)) {
                wrong.push(format!("{what}, {name}: {wide} then {narrow}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A lamp of 5 mm in glass, which light samples do not reach and scattering hardly ever finds, is found by paths from
/// the lamp.
#[test]
fn a_tiny_light_in_glass_converges() {
    // A lamp of 5 mm in a glass ball of 15 cm: scattering finds it one time in ten thousand.
    let mut stage = room(0.5);
    stage.lamp(sphere([0.0, 0.0, 0.2], 0.005), 4000.0);
    stage.solid(sphere([0.0, 0.0, 0.2], 0.15), material("dielectric"));
    let scene = stage.scene();
    let error = |integrator, spp| {
        let film = Shot::of(integrator, spp).depth(8).take(&scene);
        let (v, m) = film.pixels.iter().fold((0.0, 0.0), |(v, m), p| (v + p.variance_of_mean()[1], m + p.mean()[1]));
        (v * film.pixels.len() as f64).sqrt() / m
    };
    let (paths, bdpt) = (error("path", 400), error("bdpt", 100));
    assert!(bdpt < 0.25 * paths, "relative errors of {bdpt} against {paths}");
    agree(
        "a tiny light in glass",
        &Shot::of("bdpt", 150).depth(8).take(&scene),
        &Shot::of("light", 600).depth(8).take(&scene),
        0.1,
    );
}

/// No number of threads changes a bit, nor being cancelled, nor spectral mode.
#[test]
fn threads_and_steps_do_not_change_a_bit() {
    let mut stage = room(0.6);
    lamp(&mut stage, 0.6, 6.0);
    furnish(&mut stage, material("dielectric"));
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        let scene = stage.scene_in(mode);
        for method in ["light", "bdpt", "vcm", "sppm", "photon", "pssmlt", "mmlt"] {
            // A pass of Metropolis has 16 samples; one of photon mapping sends many photons.
            let spp = if method == "photon" { 2 } else { 32 };
            let shot = Shot::of(method, spp).depth(5);
            let one = shot.take(&scene);
            let many = Shot { threads: 4, ..shot };
            same_bits(&one, &many.take(&scene), method);
            let mut session = many.session(&scene);
            let cancelled = Control::default();
            cancelled.cancel.store(true, std::sync::atomic::Ordering::Relaxed);
            session.step(spp / 2, &Control::default());
            session.step(spp, &cancelled);
            while !session.is_done() {
                session.step(3, &Control::default());
            }
            same_bits(&one, &session.film(), method);
        }
    }
}

/// Spectral pictures agree too, dispersion among them: wavelengths are lost along either subpath.
#[test]
fn spectral_pictures_agree() {
    let mut stage = room(0.6);
    lamp(&mut stage, 1.0, 3.0);
    let curve = steradian_scene::SpectrumValue::Named("glass-SF11".into());
    furnish(&mut stage, material("dielectric").with("eta", Value::Spectrum(curve)));
    let scene = stage.scene_in(ColorMode::Spectral);
    let paths = Shot::of("path", 1000).depth(6).seed(3).take(&scene);
    agree("bdpt", &Shot::of("bdpt", 200).depth(6).take(&scene), &paths, 0.03);
    agree("pssmlt", &Shot::of("pssmlt", 320).depth(6).take(&scene), &paths, 0.05);
}

/// The parts of a crop have the bits of the whole.
#[test]
fn crops_are_parts_of_the_whole() {
    let mut stage = room(0.6);
    lamp(&mut stage, 0.6, 6.0);
    let whole = stage.scene();
    let crop = steradian_core::film::Crop { x0: 3, y0: 5, x1: 9, y1: 11 };
    let part = whole.clone().changed(|parts| parts.film.crop = crop);
    for method in ["light", "bdpt", "vcm", "sppm", "pssmlt", "mmlt"] {
        let (a, b) = (Shot::of(method, 16).depth(4).take(&whole), Shot::of(method, 16).depth(4).take(&part));
        for (k, p) in b.pixels.iter().enumerate() {
            assert_eq!(p.sum, a.pixels[(5 + k / 6) * 12 + 3 + k % 6].sum, "{method}, pixel {k}");
        }
    }
}

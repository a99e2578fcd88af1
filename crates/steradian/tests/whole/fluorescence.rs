//! Light that leaves at other wavelengths than it comes with.

use std::{path::Path, sync::Arc};
use steradian::{
    CompileOptions, Quality, Scene, compile,
    formats::Options,
    load,
    math::{color::space::REC709, spectra::cie},
    render,
};

/// A ball that fills the picture, of a material, under an even sky whose radiance is a table over the wavelength.
fn scene(folder: &Path, material: &str, sky: &str) -> Result<Arc<Scene>, String> {
    let text = format!(
        "steradian: 1
         film: {{film: rgb, width: 8, height: 8}}
         filter: {{filter: box}}
         integrator: {{integrator: path, max_depth: 20}}
         cameras: [{{camera: orthographic, screen_window: [-0.1, 0.1, -0.1, 0.1],
                    to_world: {{matrix: [-1, 0, 0, 0,  0, 1, 0, 0,  0, 0, -1, 5,  0, 0, 0, 1]}}}}]
         lights: [{{light: environment, radiance: {sky}, normalize: false}}]
         shapes: [{{shape: sphere, radius: 1, material: {{material: fluorescent, {material}}}}}]"
    );
    let path = folder.join("scene.steradian");
    std::fs::write(&path, text).expect("written");
    let loaded = load(&path, &Options::default());
    let mode = Some(steradian::math::spectra::ColorMode::Spectral);
    let compiled = compile(&loaded.desc, &CompileOptions { mode, ..CompileOptions::default() });
    let said: Vec<String> =
        loaded.diagnostics.iter().chain(compiled.diagnostics.iter()).map(|d| d.message.clone()).collect();
    if said.is_empty() { Ok(Arc::new(compiled.scene.expect("a scene"))) } else { Err(said.join("; ")) }
}

/// The mean colour of a picture.
fn seen(scene: &Arc<Scene>, quality: Quality) -> [f64; 3] {
    let picture = render(scene, &quality).expect("a picture");
    ["R", "G", "B"].map(|name| {
        let plane = picture.channel(name).expect("a colour");
        plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
    })
}

/// A table of a function, from 360 nm to 830 nm.
fn table(f: impl Fn(f32) -> f32) -> String {
    let pairs: (Vec<_>, Vec<_>) = (360..=830).step_by(2).map(|l| (l.to_string(), f(l as f32).to_string())).unzip();
    format!("{{wavelengths: [{}], values: [{}]}}", pairs.0.join(", "), pairs.1.join(", "))
}

fn bell(l: f32, middle: f32, width: f32) -> f32 {
    (-((l - middle) / width).powi(2)).exp()
}

/// A ball under an even sky sends back the product of the matrix and its spectrum (Donaldson 1954), beside what is
/// reflected; for a pigment and for a table of its matrix.
#[test]
fn the_matrix_times_the_illuminant_is_seen() {
    let folder = tempfile::tempdir().expect("a folder");
    let sky = |l: f32| 0.2 + bell(l, 400.0, 20.0);
    let (absorbed, emitted) = (|l: f32| 0.7 * bell(l, 410.0, 35.0), |l: f32| bell(l, 530.0, 30.0));
    let all: f64 = (360..830).map(|l| f64::from(emitted(l as f32 + 0.5))).sum();
    let expected = |l: f32| {
        let shifted: f64 = (360..830)
            .map(|from| {
                let from = from as f32 + 0.5;
                f64::from(absorbed(from) * sky(from) * emitted(l) * from / l) * 0.8 / all
            })
            .sum();
        0.25 * sky(l) + shifted as f32
    };
    let expected = REC709.rgb_from_xyz() * cie::to_xyz(expected);
    let pigment =
        format!("reflectance: 0.25, quantum_yield: 0.8, absorption: {}, emission: {}", table(absorbed), table(emitted));
    let wavelengths: Vec<f32> = (360..=830).step_by(5).map(|l| l as f32).collect();
    let mut text = wavelengths.iter().map(|l| l.to_string()).collect::<Vec<_>>().join(" ");
    for from in &wavelengths {
        text += &format!("\n{from}");
        for out in &wavelengths {
            text += &format!(" {}", f64::from(absorbed(*from) * emitted(*out) * from / out) * 0.8 / all);
        }
    }
    std::fs::write(folder.path().join("matrix.txt"), text).expect("written");
    for material in [pigment.as_str(), "reflectance: 0.25, matrix: {file: \"matrix.txt\"}"] {
        let scene = scene(folder.path(), material, &table(sky)).expect("nothing is said");
        let quality = Quality { spp: Some(4096), ..Quality::default() };
        let found = seen(&scene, quality);
        for (found, expected) in found.into_iter().zip(expected.to_array()) {
            assert!((found - expected).abs() < 0.01 * expected.abs() + 2e-3, "{found}, not {expected}: {material:.30}");
        }
    }
}

/// Sharp edges of absorption and emission keep their wavelengths: a pigment of straight lines under a sky of one, and
/// under a line between whole nanometres. The sums are integrals in steps of a hundredth of a nanometre.
#[test]
fn sharp_edges_keep_their_wavelengths() {
    let folder = tempfile::tempdir().expect("a folder");
    let material = "reflectance: 0, quantum_yield: 0.7,
        absorption: {wavelengths: [399.9, 400, 450, 450.1], values: [0, 0.8, 0.4, 0]},
        emission: {wavelengths: [510, 510.1, 512.3, 512.4], values: [0, 1, 1, 0]}";
    let absorbed = |l: f64| if (399.95..450.05).contains(&l) { 0.8 - 0.008 * (l - 400.0) } else { 0.0 };
    let step = 0.01;
    let at = |k: u32| 380.0 + (f64::from(k) + 0.5) * step;
    let photons = |sky: &dyn Fn(f64) -> f64| (0..9000).map(at).map(|l| absorbed(l) * l * sky(l) * step).sum::<f64>();
    let even = ("1", photons(&|_| 1.0));
    let line = "{wavelengths: [404.6, 404.7, 404.8], values: [0, 200, 0]}";
    for (sky, photons) in [even, (line, 20.0 * 404.7 * absorbed(404.7))] {
        // What leaves is within 510.05 and 512.35 nm.
        let energy = 0.7 * photons / 511.2;
        let found = seen(
            &scene(folder.path(), material, sky).expect("nothing is said"),
            Quality { spp: Some(16384), ..Quality::default() },
        );
        let xyz = REC709.xyz_from_rgb() * steradian::math::DVec3::from(found);
        let expected = energy * cie::matching_linear(511.2)[1] / 106.856895;
        assert!((xyz.y / expected - 1.0).abs() < 0.015, "{sky}: {}, not {expected}", xyz.y);
    }
}

/// A pigment that would give back more photons than it gets is refused, as is one of which something is missing; what
/// follows no changes of wavelength refuses by name.
#[test]
fn what_cannot_be_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let white = "1";
    let bell = table(|l| bell(l, 500.0, 40.0));
    for (material, expected) in [
        (format!("reflectance: 0.6, absorption: 0.7, emission: {bell}"), "cannot create photons"),
        ("matrix: {file: \"nowhere.txt\"}".into(), "nowhere.txt"),
        (format!("absorption: 0.5, emission: {bell}, quantum_yield: 1.5"), "quantum_yield"),
    ] {
        let said = scene(folder.path(), &material, white).expect_err("it is refused");
        assert!(said.contains(expected), "{said}");
    }
    let material = format!("reflectance: 0.2, absorption: 0.5, emission: {bell}");
    let scene = scene(folder.path(), &material, white).expect("nothing is said");
    for name in ["bdpt", "whitted", "stokes"] {
        let quality = Quality { integrator: Some(name.into()), spp: Some(1), ..Quality::default() };
        let refusal = render(&scene, &quality).expect_err("it is refused").to_string();
        assert!(refusal.contains("changes its wavelength"), "{refusal}");
    }
}

/// A lamp of a narrow spectrum is found by wavelengths that are drawn for it: a ball under an even sky of two
/// nanometres, of which by chance one in sixty wavelengths would be, has the product of matrix and spectrum, and the
/// pixels of 64 samples each spread little about it.
#[test]
fn narrow_lamps_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let sky = |l: f32| if (l - 400.0).abs() <= 1.0 { 40.0 } else { 0.0 };
    let (absorbed, emitted) = (|l: f32| 0.7 * bell(l, 410.0, 60.0), |l: f32| bell(l, 530.0, 30.0));
    let all: f64 = (360..830).map(|l| f64::from(emitted(l as f32 + 0.5))).sum();
    // The table of the sky is linear between values 2 nm apart: a triangle of 2 nm.
    let expected = |l: f32| {
        let shifted = f64::from(absorbed(400.0) * emitted(l) * 400.0 / l) * 0.8 / all * 40.0 * 2.0;
        shifted as f32
    };
    let expected = REC709.rgb_from_xyz() * cie::to_xyz(expected);
    let pigment =
        format!("reflectance: 0, quantum_yield: 0.8, absorption: {}, emission: {}", table(absorbed), table(emitted));
    let scene = scene(folder.path(), &pigment, &table(sky)).expect("a scene");
    let picture = render(&scene, &Quality { spp: Some(64), ..Quality::default() }).expect("a picture");
    let green = picture.channel("G").expect("green");
    let mean = green.iter().map(|v| f64::from(*v)).sum::<f64>() / green.len() as f64;
    let spread = (green.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / green.len() as f64).sqrt();
    assert!((mean / expected.y - 1.0).abs() < 0.05, "{mean}, not {}", expected.y);
    assert!(spread < 0.2 * mean, "{spread} of {mean}");
}

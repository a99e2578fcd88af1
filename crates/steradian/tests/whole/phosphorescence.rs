//! Light that matter holds back, and lights that go on and off.

use std::{path::Path, sync::Arc};
use steradian::{CompileOptions, Quality, Scene, compile, formats::Options, load, math::spectra::ColorMode, render};

/// Seconds for which the phosphor of these scenes holds light back.
const LIFETIME: f64 = 0.5;

/// A ball that fills the picture, of a material, under an even sky of a schedule, in an exposure.
fn scene(folder: &Path, material: &str, schedule: &str, [open, close]: [f64; 2]) -> Result<Arc<Scene>, String> {
    let text = format!(
        "steradian: 1
         film: {{film: rgb, width: 8, height: 8}}
         filter: {{filter: box}}
         integrator: {{integrator: path, max_depth: 20}}
         cameras: [{{camera: orthographic, screen_window: [-0.1, 0.1, -0.1, 0.1],
                    shutter_open: {open}, shutter_close: {close},
                    to_world: {{matrix: [-1, 0, 0, 0,  0, 1, 0, 0,  0, 0, -1, 5,  0, 0, 0, 1]}}}}]
         lights: [{{light: environment{schedule},
                    radiance: {{wavelengths: [360, 400, 420, 830], values: [1, 1, 0, 0]}}}}]
         shapes: [{{shape: sphere, radius: 1, material: {material}}}]"
    );
    compiled(folder, &text)
}

fn compiled(folder: &Path, text: &str) -> Result<Arc<Scene>, String> {
    let path = folder.join("scene.steradian");
    std::fs::write(&path, text).expect("written");
    let loaded = load(&path, &Options::default());
    let compiled =
        compile(&loaded.desc, &CompileOptions { mode: Some(ColorMode::Spectral), ..CompileOptions::default() });
    let said: Vec<String> =
        loaded.diagnostics.iter().chain(compiled.diagnostics.iter()).map(|d| d.message.clone()).collect();
    if said.is_empty() { Ok(Arc::new(compiled.scene.expect("a scene"))) } else { Err(said.join("; ")) }
}

/// A phosphor that takes up violet light and gives it back as green.
fn phosphor(lifetime: f64) -> String {
    format!(
        "{{material: fluorescent, reflectance: 0, lifetime: {lifetime}, quantum_yield: 0.9,
           absorption: {{wavelengths: [360, 420, 440], values: [0.8, 0.8, 0]}},
           emission: {{wavelengths: [500, 520, 540], values: [0, 1, 0]}}}}"
    )
}

/// The mean of green, with its standard error over the pixels.
fn green(scene: &Arc<Scene>, spp: u32) -> (f64, f64) {
    let picture = render(scene, &Quality { spp: Some(spp), ..Quality::default() }).expect("a picture");
    let plane = picture.channel("G").expect("a colour");
    let n = plane.len() as f64;
    let mean = plane.iter().map(|v| f64::from(*v)).sum::<f64>() / n;
    let variance = plane.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// A lamp that was on from `on` to `off` left a phosphor glowing as `e^((off − t)/τ) − e^((on − t)/τ)` of the steady
/// glow at a later moment t, which is 1 − e^((on − t)/τ) before it goes off; an exposure has the mean of that.
#[test]
fn a_phosphor_fades_and_rises_by_its_lifetime() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |schedule: &str, exposure| {
        green(&scene(folder.path(), &phosphor(LIFETIME), schedule, exposure).expect("nothing is said"), 1024)
    };
    let (steady, error) = of("", [0.0, 0.0]);
    assert!(steady > 0.01 && error < 0.01 * steady, "{steady} ± {error}");
    let fast = green(&scene(folder.path(), &phosphor(0.0), "", [0.0, 0.0]).expect("nothing is said"), 2048).0;
    assert!((steady - fast).abs() < 0.02 * steady, "steady light hides the lifetime: {steady}, {fast}");
    let decay = |t: f64| (-t / LIFETIME).exp();
    // The mean of a decay that begins at 0, from one moment to another.
    let mean = |a: f64, b: f64| LIFETIME * (decay(a) - decay(b)) / (b - a);
    for (schedule, exposure, expected) in [
        (", off: 2", [2.0, 2.0], 1.0),
        (", off: 2", [2.25, 2.25], decay(0.25)),
        (", off: 2", [2.5, 2.5], decay(0.5)),
        (", off: 2", [3.0, 3.0], decay(1.0)),
        (", on: 1", [0.9, 0.9], 0.0),
        (", on: 1", [1.25, 1.25], 1.0 - decay(0.25)),
        (", on: 1", [2.0, 2.0], 1.0 - decay(1.0)),
        (", on: 1, off: 1.5", [1.75, 1.75], decay(0.25) - decay(0.75)),
        (", off: 2", [2.0, 2.5], mean(0.0, 0.5)),
        (", off: 2", [1.5, 2.5], 0.5 + 0.5 * mean(0.0, 0.5)),
        (", on: 1", [1.0, 2.0], 1.0 - mean(0.0, 1.0)),
        // All that was stored: the steady glow for a lifetime.
        (", off: 2", [2.0, 12.0], LIFETIME / 10.0),
        // A strobe: the geometric series of its flashes before.
        (", on: 0, off: 0.1, period: 0.5", [100.1, 100.1], (1.0 - decay(0.1)) / (1.0 - decay(0.5))),
    ] {
        let (found, error) = of(schedule, exposure);
        let tolerance = 4.0 * error + 0.01 * steady * expected;
        assert!(
            (found - steady * expected).abs() <= tolerance,
            "{schedule} from {exposure:?}: {}, not {expected}, ± {}",
            found / steady,
            tolerance / steady
        );
    }
}

/// Light that matter gives back at once, and lights themselves, are seen only while they shine.
#[test]
fn a_light_is_seen_while_it_shines() {
    let folder = tempfile::tempdir().expect("a folder");
    let white = "{material: diffuse, reflectance: 0.5}";
    let all = |light: &str, exposure: [f64; 2]| {
        let [open, close] = exposure;
        let text = format!(
            "steradian: 1
             film: {{film: rgb, width: 8, height: 8}}
             integrator: {{integrator: path, max_depth: 4}}
             cameras: [{{camera: perspective, fov: 20, shutter_open: {open}, shutter_close: {close},
                        to_world: {{look_at: [0, 0, 0], from: [0, 0, 6], up: [0, 1, 0]}}}}]
             {light}"
        );
        green(&compiled(folder.path(), &text).expect("nothing is said"), 256).0
    };
    let ball = format!("shapes: [{{shape: sphere, radius: 1, material: {white}}}]");
    let schedule = "on: 1, off: 2, period: 4";
    let lights = [
        format!("lights: [{{light: point, position: [0, 0, 6], SCHEDULE}}]\n{ball}"),
        format!("lights: [{{light: spot, to_world: {{look_at: [0, 0, 0], from: [0, 0, 6]}}, SCHEDULE}}]\n{ball}"),
        format!("lights: [{{light: distant, direction: [0, 0, -1], SCHEDULE}}]\n{ball}"),
        format!("lights: [{{light: environment, SCHEDULE}}]\n{ball}"),
        format!("shapes: [{{shape: sphere, radius: 1, material: {white}, emission: {{light: area, SCHEDULE}}}}]"),
    ];
    for light in lights {
        let steady = all(&light.replace("SCHEDULE", "scale: 1"), [0.0, 0.0]);
        assert!(steady > 0.0, "{light}");
        let light = light.replace("SCHEDULE", schedule);
        for (exposure, expected) in
            [([0.5, 0.5], 0.0), ([1.5, 1.5], 1.0), ([2.5, 2.5], 0.0), ([5.0, 6.0], 1.0), ([1.5, 3.5], 0.25)]
        {
            let found = all(&light, exposure) / steady;
            assert!((found - expected).abs() < 0.02, "{found}, not {expected}, in {exposure:?}: {light}");
        }
    }
}

/// Times that are none are refused where they stand; methods that do not follow light through time refuse by name.
#[test]
fn what_cannot_be_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for (lifetime, schedule, exposure, expected) in [
        (-1.0, "", [0.0, 1.0], "parameter 'lifetime'"),
        (0.0, ", on: 2, off: 1", [0.0, 1.0], "'off' must be after 'on'"),
        (0.0, ", on: 2, off: 2", [0.0, 1.0], "'off' must be after 'on'"),
        (0.0, ", period: 1", [0.0, 1.0], "within a period"),
        (0.0, ", on: 0, off: 2, period: 1", [0.0, 1.0], "within a period"),
        (0.0, ", on: 0, off: 0.5, period: -1", [0.0, 1.0], "period above 0"),
        (0.0, ", on: now", [0.0, 1.0], "must be a number"),
        (0.0, ", on: 0", [1.0, 0.0], "exposure from 1 s to 0 s"),
    ] {
        let said = scene(folder.path(), &phosphor(lifetime), schedule, exposure).expect_err("it is refused");
        assert!(said.contains(expected), "{said}");
    }
    let scene = scene(folder.path(), "{material: diffuse}", ", on: 0", [0.0, 1.0]).expect("nothing is said");
    for name in ["bdpt", "sppm", "pssmlt", "whitted", "stokes", "radiosity"] {
        let quality = Quality { integrator: Some(name.into()), spp: Some(1), ..Quality::default() };
        let refusal = render(&scene, &quality).expect_err("it is refused").to_string();
        assert!(refusal.contains("go on and off"), "{refusal}");
    }
}

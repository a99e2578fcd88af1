//! A law of all methods: whatever light, emitting shape, material or medium a scene has, each method either agrees with
//! path tracing, or refuses it, or says what it leaves out. Nothing is lost silently.

use std::sync::Arc;
use steradian::{ColorMode, CompileOptions, Quality, Scene, compile, formats::Options, load, render, scene::Family};

/// Methods that compute other things than all light, by their definition; `direct` and `whitted` do with one bounce.
/// `pssmlt` and `mmlt` bring what `bdpt` does, with means too skewed for so few samples, and
/// `gather` what `path` does without lights asked, with more noise.
const OTHERS: &[&str] =
    &["ao", "gather", "raycast", "structure", "stokes-s1", "stokes-s2", "stokes-s3", "pssmlt", "mmlt"];
const SEEDS: u64 = 3;

/// A floor before the camera, with what is asked for; paths of so many bounces.
fn scene(bounces: u32, integrator: &str, what: &str) -> Arc<Scene> {
    scene_between("", bounces, integrator, what)
}

/// As [`scene`], with further parameters of the camera.
fn scene_between(planes: &str, bounces: u32, integrator: &str, what: &str) -> Arc<Scene> {
    let text = format!(
        "steradian: 1
camera: {{camera: perspective, fov: 30, to_world: {{look_at: [0,0,0], from: [0,-3,3], up: [0,0,1]}}{planes}}}
film: {{film: rgb, width: 8, height: 8}}
integrator: {{integrator: {integrator}, max_depth: {bounces}}}
materials: {{w: {{material: diffuse, reflectance: 0.5}}, k: {{material: diffuse, reflectance: 0}}, {what}
"
    );
    let loaded = load::load_bytes("law.steradian", text.clone().into_bytes(), Some("steradian"), &Options::default());
    let said = |d: &steradian::scene::Diagnostics| d.iter().map(|d| d.message.clone()).collect::<Vec<_>>();
    assert!(loaded.diagnostics.iter().next().is_none(), "{:?} in {text}", said(&loaded.diagnostics));
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let compiled = compile(&loaded.desc, &options);
    Arc::new(compiled.scene.unwrap_or_else(|| panic!("{:?} in {text}", said(&compiled.diagnostics))))
}

/// The mean of green over the picture, and its standard error by seeds; or why there is no picture.
fn mean(scene: &Arc<Scene>, name: &str, spp: u32) -> Result<[f64; 2], String> {
    let quality = Quality::of(name).spp(spp);
    let mut means = Vec::new();
    for seed in 1..=SEEDS {
        let picture = render(scene, &Quality { seed: Some(seed), ..quality.clone() }).map_err(|e| e.to_string())?;
        let green = picture.channel("G").expect("green");
        means.push(green.iter().map(|v| f64::from(*v)).sum::<f64>() / green.len() as f64);
    }
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let spread = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n;
    Ok([mean, spread.sqrt()])
}

/// Holds every method against a reference. Beyond four standard errors (which three seeds tell coarsely) means may
/// differ by 6 %, for radii of photons on so few pixels, and those of 600 patches by 12 %.
fn obey(what: &str, scene: &Arc<Scene>, reference: &str, leave_out: &[&str]) -> String {
    let [right, error] = mean(scene, reference, 128).expect(reference);
    assert!(right > 0.0 && error < 0.05 * right, "{what}: {reference} gives {right} ± {error}");
    let mut faults = String::new();
    for info in Family::Integrator.models().iter().filter(|i| !OTHERS.contains(&i.kind) && !leave_out.contains(&i.kind))
    {
        let (name, spp) = match info.kind {
            "light" => ("light", 256),
            "raster" => ("raster", 16),
            "radiosity" => ("radiosity:patches=600", 8),
            name => (name, 32),
        };
        let quality = Quality::of(name);
        let Ok(render) = quality.render(scene) else { continue };
        if render.left_out(scene).is_some() {
            continue;
        }
        let [found, noise] = mean(scene, name, spp).unwrap_or_else(|e| panic!("{what} by {name}: {e}"));
        let coarse = if info.kind == "radiosity" { 0.12 } else { 0.06 };
        if (found - right).abs() > 4.0 * error.hypot(noise) + coarse * right {
            faults += &format!("{what} by {name}: {found:.5} ± {noise:.5}, not {right:.5} ± {error:.5}\n");
        }
    }
    faults
}

const FLOOR: &str = "{shape: disk, radius: 4, material: w}";
const LAMP: &str = "{shape: sphere, radius: 0.4, to_world: {translate: [0.6,-0.5,2.8]}, material: k, \
    emission: {light: area, radiance: 8}}";

/// One bounce: `direct`, `whitted` and `raster` compute all of it, too.
#[test]
fn lights_are_found_or_told() {
    let lights = [
        "{light: point, position: [0.5,0,2], intensity: 3}",
        "{light: spot, to_world: {look_at: [0,0,0], from: [0.5,0,2], up: [0,1,0]}, intensity: 3, cone_angle: 50}",
        "{light: distant, direction: [0.3,0,-1], radiance: 2}",
        "{light: environment, radiance: 1}",
        "{light: sky, turbidity: 3}",
    ];
    let mut faults = String::new();
    for light in lights {
        faults += &obey(light, &scene(1, "path", &format!("}}\nlights: [{light}]\nshapes: [{FLOOR}]")), "path", &[]);
    }
    assert!(faults.is_empty(), "\n{faults}");
}

/// Surfaces before the plane `near` or beyond the plane `far` of the camera are seen by no method; a pane that only
/// separates media hides nothing, and moves no plane.
#[test]
fn planes_that_cut_the_view_are_followed() {
    let pane = "{shape: sphere, radius: 0.3, to_world: {translate: [0,-1.2,1.2]}, material: i}";
    let lamp = "i: {material: interface}}\nlights: [{light: point, position: [0.5,0,2], intensity: 3}]";
    let seen = |planes: &str| scene_between(planes, 4, "path", &format!("{lamp}\nshapes: [{FLOOR}, {pane}]"));
    let mut faults = String::new();
    let [whole, _] = mean(&seen(""), "path", 64).expect("path");
    for planes in [", near: 4", ", far: 4.4", ", near: 3.9, far: 4.5"] {
        let [part, _] = mean(&seen(planes), "path", 64).expect("path");
        assert!(part > 0.2 * whole && part < 0.8 * whole, "{planes}: {part} of {whole}");
        faults += &obey(planes, &seen(planes), "path", &[]);
    }
    assert!(faults.is_empty(), "\n{faults}");
}

/// Shapes that emit, on both sides or one, with holes, and of which no point can be drawn.
#[test]
fn emitting_shapes_are_found_or_told() {
    let shapes = [
        ("sphere, radius: 0.5", "area, radiance: 4"),
        ("sphere, radius: 0.5, alpha: 0.5", "area, radiance: 4, two_sided: true"),
        ("disk, radius: 0.5", "area, radiance: 4, two_sided: true"),
        ("cylinder, radius: 0.3", "area, radiance: 4, two_sided: true"),
        ("cone, radius: 0.5", "area, radiance: 4, two_sided: true"),
        ("paraboloid", "area, radiance: 4, two_sided: true"),
        ("plane, normal: [0,0,-1], distance: 1.5", "area, radiance: 1"),
        ("quadric, coefficients: [1,1,1,0,0,0,0,0,0,-0.3]", "area, radiance: 4"),
        ("disk, radius: 0.5, reversed: true", "directional_area, radiance: 4"),
    ];
    let lamp = |(shape, light): (&str, &str)| {
        let place = "to_world: {translate: [0.2,0,1.5]}, material: k";
        format!("{{shape: {shape}, {place}, emission: {{light: {light}}}}}")
    };
    let mut faults = String::new();
    for shape in &shapes.map(lamp) {
        faults += &obey(shape, &scene(1, "path", &format!("}}\nshapes: [{FLOOR}, {shape}]")), "path", &[]);
    }
    assert!(faults.is_empty(), "\n{faults}");
}

/// A ball of each material on the floor under a lamp, with three bounces.
#[test]
fn materials_are_followed_or_told() {
    let materials = [
        "diffuse, reflectance: 0.7",
        "conductor, reflectance: 0.8, alpha_u: 0.4",
        "dielectric, alpha_u: 0.4",
        "coated_diffuse, alpha_u: 0.3",
        "plastic",
        "diffuse_transmission",
        "oren_nayar",
        "fluorescent",
        "subsurface",
        "principled",
        "mask, opacity: 0.5, material: @w",
    ];
    let mut faults = String::new();
    for material in materials {
        let ball = "{shape: sphere, radius: 0.5, to_world: {translate: [0,0,0.6]}, material: m}";
        let what = format!("m: {{material: {material}}}}}\nshapes: [{FLOOR}, {ball}, {LAMP}]");
        faults += &obey(material, &scene(3, "path", &what), "path", &["direct", "whitted", "raster"]);
    }
    assert!(faults.is_empty(), "\n{faults}");
}

/// A ball of a medium under a lamp.
#[test]
fn media_are_followed_or_told() {
    let media = [
        "homogeneous, sigma_s: 2, sigma_a: 0.2",
        "homogeneous, sigma_a: 0.5, Le: 1",
        "homogeneous, sigma_s: 2, sigma_a: 0.2, phase: {phase: rayleigh}",
    ];
    let mut faults = String::new();
    for medium in media {
        let ball = "{shape: sphere, radius: 0.7, to_world: {translate: [0,0,0.8]}, material: i, interior: f}";
        let media = format!("i: {{material: interface}}}}\nmedia: {{f: {{medium: {medium}}}}}");
        let what = format!("{media}\nshapes: [{FLOOR}, {ball}, {LAMP}]");
        faults += &obey(medium, &scene(4, "volpath", &what), "volpath", &[]);
    }
    assert!(faults.is_empty(), "\n{faults}");
}

//! When light of a pulse arrives, against closed forms.

use std::{path::Path, sync::Arc};
use steradian::{
    CompileOptions, Quality, Scene, compile, formats::Options, image::Image, load, math::spectra::ColorMode, render,
};

fn compiled(folder: &Path, mode: ColorMode, text: &str) -> Arc<Scene> {
    let path = folder.join("scene.steradian");
    std::fs::write(
        &path,
        format!("steradian: 1\nfilm: {{film: rgb, width: 8, height: 8}}\nfilter: {{filter: box}}\n{text}"),
    )
    .expect("written");
    let loaded = load(&path, &Options::default());
    let compiled = compile(&loaded.desc, &CompileOptions { mode: Some(mode), ..CompileOptions::default() });
    let said: Vec<String> =
        loaded.diagnostics.iter().chain(compiled.diagnostics.iter()).map(|d| d.message.clone()).collect();
    assert!(said.is_empty(), "{}", said.join("; "));
    Arc::new(compiled.scene.expect("a scene"))
}

fn taken(scene: &Arc<Scene>, integrator: &str, spp: u32) -> Image {
    let quality = Quality { integrator: Some(integrator.into()), spp: Some(spp), ..Quality::default() };
    render(scene, &quality).expect("a picture")
}

/// The mean of green of a layer; of the picture where it has no name.
fn green(picture: &Image, layer: &str) -> f64 {
    let plane = picture.channel(&format!("{layer}G")).expect("a layer");
    plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
}

/// The means of all intervals.
fn bins(picture: &Image, count: usize) -> Vec<f64> {
    (0..count).map(|bin| green(picture, &format!("bin.{bin:03}."))).collect()
}

/// A camera 5 above the origin that sees a small part of the plane there.
const ABOVE: &str = "cameras: [{camera: orthographic, screen_window: [-0.01, 0.01, -0.01, 0.01],
    to_world: {matrix: [-1, 0, 0, 0,  0, 1, 0, 0,  0, 0, -1, 5,  0, 0, 0, 1]}}]";

/// All that is found is in an interval or outside of all, and the picture has the bits of `volpath` without its trials.
#[test]
fn intervals_add_up_to_the_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let text =
        "cameras: [{camera: perspective, fov: 40, to_world: {look_at: [0, 1, 0], from: [0, 1, 3.5], up: [0, 1, 0]}}]
        lights: [{light: environment, scale: 0.2}, {light: distant, direction: [0, -1, -1]}]
        shapes: [{shape: plane, normal: [0, 1, 0], material: {material: diffuse}}
                 {shape: sphere, center: [0, 1, 0], radius: 0.5, material: {material: dielectric}}
                 {shape: sphere, center: [-1.2, 1, 0], radius: 0.5, material: {material: dielectric, alpha_u: 0.3}}
                 {shape: sphere, center: [1, 2.5, 0], radius: 0.3, emission: {light: area}}]";
    let scene = compiled(folder.path(), ColorMode::Rgb, text);
    let path = taken(&scene, "volpath:max_depth=6,reuse=1,caustics=false,effort=even", 64);
    let all = taken(&scene, "transient:max_depth=6,from=-1e12,to=1e12,bins=16", 64);
    let part = taken(&scene, "transient:max_depth=6,from=2,to=6,bins=7", 64);
    for channel in ["R", "G", "B"] {
        let plane =
            |picture: &Image, name: &str| picture.channel(&format!("{name}{channel}")).expect("a plane").to_vec();
        let sums = |picture: &Image, count: usize| {
            let mut sums = vec![0.0; 64];
            for bin in 0..count {
                sums.iter_mut().zip(plane(picture, &format!("bin.{bin:03}."))).for_each(|(sum, v)| *sum += v);
            }
            sums
        };
        let (whole, inside) = (sums(&all, 16), sums(&part, 7));
        for (pixel, expected) in plane(&path, "").into_iter().enumerate() {
            let near = |v: f32| (v - expected).abs() < 1e-4 * expected.max(1.0);
            assert_eq!([plane(&all, "")[pixel], plane(&part, "")[pixel]], [expected; 2]);
            assert!(near(whole[pixel]), "{} is not {expected}", whole[pixel]);
            assert!(inside[pixel] <= expected * 1.0001, "{} of {expected}", inside[pixel]);
        }
        assert!(inside.iter().sum::<f32>() > 0.1 * whole.iter().sum::<f32>());
    }
}

/// Light of a point arrives from there by way of what it lights, parallel light from the sphere around the scene.
#[test]
fn direct_light_arrives_when_geometry_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let floor = "shapes: [{shape: disk, material: {material: diffuse, reflectance: 0.5}}]";
    for (lights, camera, unit, expected) in [
        ("{light: point, position: [3, 0, 4]}", true, 1.0, 10.0),
        ("{light: point, position: [3, 0, 4]}", false, 1.0, 5.0),
        ("{light: point, position: [3, 0, 4]}", false, 0.6, 3.0),
        ("{light: point, position: [8, 0, 6]}", false, 1.0, 10.0),
        // The sphere around the square from −1 to 1 has a radius of √2.
        ("{light: distant, direction: [0, 0, -1]}", true, 10.0, 10.0 * (5.0 + 2.0_f64.sqrt())),
    ] {
        let scene = compiled(folder.path(), ColorMode::Rgb, &format!("{ABOVE}\nlights: [{lights}]\n{floor}"));
        let (from, to) = (expected - 3.5, expected + 4.5);
        let options = format!("transient:from={from},to={to},bins=8,unit={unit},camera={camera}");
        let picture = taken(&scene, &options, 16);
        let total = green(&picture, "");
        assert!(total > 0.0);
        for (bin, found) in bins(&picture, 8).into_iter().enumerate() {
            let wanted = if bin == 3 { total } else { 0.0 };
            assert!((found - wanted).abs() < 1e-5 * total, "interval {bin} has {found} of {total}: {lights}");
        }
    }
}

/// Through a slab of glass light is later by (n − 1) d; what is reflected within goes twice more through it each time.
/// Of what meets a face `R = ((n − 1)/(n + 1))²` is reflected.
#[test]
fn glass_holds_light_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!(
        "{ABOVE}
         shapes: [{{shape: disk, radius: 20, material: {{material: diffuse, reflectance: 0}},
                    emission: {{light: area}}}}
                  {{shape: plane, normal: [0, 0, 1], distance: -3.5, material: {{material: dielectric, eta: 1.5}}}}
                  {{shape: plane, normal: [0, 0, -1], distance: 1.5, material: {{material: dielectric, eta: 1.5}}}}]"
    );
    let scene = compiled(folder.path(), ColorMode::Rgb, &text);
    let picture = taken(&scene, "transient:from=-0.5,to=19.5,bins=20,max_depth=12", 16384);
    let found = bins(&picture, 20);
    let (r, d, n) = (0.04_f64, 2.0, 1.5);
    let first = (5.0 + (n - 1.0) * d) as usize;
    for (bin, found) in found.into_iter().enumerate() {
        let expected = match bin {
            b if b == first => (1.0 - r).powi(2),
            // Reflected twice within.
            b if b == first + 6 => (1.0 - r).powi(2) * r * r,
            _ => 0.0,
        };
        // Light between the slab and what shines is reflected by nothing there: the lamp is black.
        assert!((found - expected).abs() < 0.01 * expected + 3e-4, "interval {bin}: {found}, not {expected}");
    }
}

/// In a sphere of radius R whose wall reflects ρ by Lambert's law each chord has the density l/(2R²), with the mean
/// 4R/3, whatever came before: light of a point in the middle that was scattered k times went R + (k − 1) 4R/3 in the
/// mean, and is ρᵏ of that.
#[test]
fn an_integrating_sphere_has_chords_of_four_thirds() {
    let folder = tempfile::tempdir().expect("a folder");
    let (radius, rho, count) = (1.5_f64, 0.7_f64, 100);
    let text = format!(
        "cameras: [{{camera: perspective, fov: 30, to_world: {{look_at: [1, 0, 0], from: [0, 0, 0], up: [0, 1, 0]}}}}]
         lights: [{{light: point}}]
         shapes: [{{shape: sphere, radius: {radius}, material: {{material: diffuse, reflectance: {rho}}}}}]"
    );
    let scene = compiled(folder.path(), ColorMode::Rgb, &text);
    let width = 0.1;
    let shot = |depth: u32| {
        let options = format!(
            "transient:max_depth={depth},rr_depth=50,from=0,to={},bins={count},camera=false",
            width * count as f64
        );
        bins(&taken(&scene, &options, 2048), count)
    };
    let mut before = vec![0.0; count];
    let mut first = 0.0;
    for order in 1..=4_u32 {
        let so_far = shot(order);
        let of_order: Vec<f64> = so_far.iter().zip(&before).map(|(a, b)| a - b).collect();
        let total: f64 = of_order.iter().sum();
        let mean = of_order.iter().enumerate().map(|(i, v)| v * width * (i as f64 + 0.5)).sum::<f64>() / total;
        first = if order == 1 { total } else { first };
        let expected = first * rho.powi(order as i32 - 1);
        assert!((total - expected).abs() < 0.01 * expected, "order {order}: {total}, not {expected}");
        let expected = radius + f64::from(order - 1) * 4.0 * radius / 3.0;
        // Intervals have a width, and the first order is in the middle of none.
        assert!(
            (mean - expected).abs() < 0.01 * expected + 0.5 * width * f64::from(u8::from(order == 1)),
            "order {order}: {mean}, not {expected}"
        );
        if order == 2 {
            for (i, found) in of_order.iter().enumerate() {
                let part = |l: f64| ((l - radius).clamp(0.0, 2.0 * radius) / (2.0 * radius)).powi(2);
                let expected = total * (part(width * (i as f64 + 1.0)) - part(width * i as f64));
                assert!((found - expected).abs() < 0.03 * expected + 2e-3 * total, "{i}: {found}, not {expected}");
            }
        }
        before = so_far;
    }
}

/// A phosphor spreads light of a pulse over its lifetime.
#[test]
fn a_phosphor_spreads_a_pulse() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!(
        "{ABOVE}
         lights: [{{light: point, position: [3, 0, 4], intensity: {{wavelengths: [360, 420, 421], values: [1, 1, 0]}}}}]
         shapes: [{{shape: disk, material: {{material: fluorescent, reflectance: 0, lifetime: 1e-8,
                    absorption: {{wavelengths: [360, 420, 440], values: [0.8, 0.8, 0]}},
                    emission: {{wavelengths: [500, 520, 540], values: [0, 1, 0]}}}}}}]"
    );
    let scene = compiled(folder.path(), ColorMode::Spectral, &text);
    let picture = taken(&scene, "transient:from=10,to=20,bins=5", 8192);
    let total = green(&picture, "");
    let left = |l: f64| (-l / (299_792_458.0 * 1e-8)).exp();
    for (bin, found) in bins(&picture, 5).into_iter().enumerate() {
        let l = 2.0 * bin as f64;
        let expected = total * (left(l) - left(l + 2.0));
        assert!((found - expected).abs() < 0.03 * expected + 2e-3 * total, "{bin}: {found}, not {expected}");
    }
}

/// Options that are none are refused, as are scenes in which light is not one pulse.
#[test]
fn what_cannot_be_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |light: &str, material: &str| {
        let text = format!(
            "{ABOVE}
         lights: [{{light: point, position: [0, 0, 3]{light}}}]
         shapes: [{{shape: sphere, material: {material}}}]"
        );
        compiled(folder.path(), ColorMode::Rgb, &text)
    };
    let plain = "{material: diffuse}";
    for (scene, options, expected) in [
        (of("", plain), "from=3,to=3", "'to' must be more than 'from'"),
        (of("", plain), "bins=0", "in [1, 1024]"),
        (of("", plain), "bins=1025", "in [1, 1024]"),
        (of("", plain), "unit=0", "above 0"),
        (of("", plain), "to=far", "'to'"),
        (of(", off: 1", plain), "bins=2", "go on and off"),
        (of("", "{material: subsurface}"), "bins=2", "below surfaces"),
    ] {
        let quality = Quality { integrator: Some(format!("transient:{options}")), spp: Some(1), ..Quality::default() };
        let refusal = render(&scene, &quality).expect_err("it is refused").to_string();
        assert!(refusal.contains(expected), "{refusal}");
    }
}

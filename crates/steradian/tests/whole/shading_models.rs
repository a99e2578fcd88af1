//! Shading models of `raster` (`shading=`) against their formulas on triangles under points and parallel light.

use std::{f32::consts::PI, fmt::Write};
use steradian::{
    CompileOptions, Quality, Scene, compile, load_bytes,
    math::{Vec2, Vec3},
    render,
};

fn scene(text: &str) -> Scene {
    let loaded = load_bytes("triangles.pbrt", text.as_bytes().to_vec(), Some("pbrt"), &Default::default());
    let mode = Some(steradian::ColorMode::Rgb);
    compile(&loaded.desc, &CompileOptions { mode, ..CompileOptions::default() }).scene.expect("a sound scene")
}

/// Green of every pixel, by rows.
fn green(scene: &Scene, model: &str) -> Vec<f32> {
    let picture = render(&std::sync::Arc::new(scene.clone()), &Quality::of(&format!("raster:shading={model}")));
    picture.expect(model).channel("G").expect("green").to_vec()
}

/// M48 to M50: flat shading is the light of the first corner, or of the middle with the normal of the face; Gouraud
/// shading interpolates the light of the corners; Phong shading lights each point with the interpolated unit normal.
/// ρ/π · I cos θ / d² by hand, at each pixel.
#[test]
fn models_follow_their_formulas() {
    let p = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -0.8, 0.4), Vec3::new(0.1, 1.0, -0.3)];
    let n = [Vec3::new(-0.5, -0.3, -1.0), Vec3::new(0.6, -0.2, -1.0), Vec3::new(0.0, 0.8, -1.0)].map(Vec3::normalize);
    let list = |v: [Vec3; 3]| v.map(|v| format!("{} {} {}", v.x, v.y, v.z)).join(" ");
    let scene = scene(&format!(
        r#"LookAt 0 0 -4  0 0 0  0 1 0 Camera "perspective" "float fov" 40
        Film "rgb" "integer xresolution" 48 "integer yresolution" 48 WorldBegin
        LightSource "point" "rgb I" [10 10 10] "point3 from" [0.7 1.2 -3]
        Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
        Shape "trianglemesh" "point3 P" [{}] "normal N" [{}] "integer indices" [0 1 2]"#,
        list(p),
        list(n)
    ));
    let light = |at: Vec3, normal: Vec3| {
        let to = Vec3::new(0.7, 1.2, -3.0) - at;
        0.5 / PI * 10.0 * normal.dot(to.normalize()).max(0.0) / to.length_squared()
    };
    let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
    let face = if face.z > 0.0 { -face } else { face };
    let mixed = |v: [Vec3; 3], [a, b, c]: [f32; 3]| v[0] * a + v[1] * b + v[2] * c;
    type Expected<'a> = &'a dyn Fn([f32; 3]) -> f32;
    let models: [(&str, Expected<'_>); 5] = [
        ("flat", &|_| light(p[0], n[0])),
        ("flat-centre", &|_| light(mixed(p, [1.0 / 3.0; 3]), face)),
        ("gouraud", &|[a, b, c]| a * light(p[0], n[0]) + b * light(p[1], n[1]) + c * light(p[2], n[2])),
        ("phong", &|l| light(mixed(p, l), mixed(n, l).normalize())),
        ("pixel", &|l| light(mixed(p, l), mixed(n, l).normalize())),
    ];
    for (model, expected) in models {
        let (found, mut seen) = (green(&scene, model), 0);
        for (k, found) in found.iter().enumerate() {
            let pixel = Vec2::new((k % 48) as f32 + 0.5, (k / 48) as f32 + 0.5);
            let ray = scene.camera().ray(scene.film(), pixel, Vec2::splat(0.5));
            let Some(hit) = scene.intersect(&ray) else { continue };
            let right = expected([1.0 - hit.u - hit.v, hit.u, hit.v]);
            assert!((found - right).abs() < 1e-4 * right.max(0.1), "{model} at {pixel}: {found}, not {right}");
            seen += 1;
        }
        assert!(seen > 300, "{seen} pixels see the triangle");
    }
}

/// A cylinder of flat sides with the normals of a round one, its ridges at x = sin(15° k).
fn cylinder() -> String {
    let angles: Vec<f32> = (-4..=4).map(|k| (15.0 * k as f32).to_radians()).collect();
    let (mut points, mut normals, mut indices) = (String::new(), String::new(), String::new());
    for (k, a) in angles.iter().enumerate() {
        let (x, z) = (a.sin(), -a.cos());
        let _ = write!(points, "{x} -1 {z} {x} 1 {z} ");
        let _ = write!(normals, "{x} 0 {z} {x} 0 {z} ");
        if k > 0 {
            let [a, b, c, d] = [2 * k - 2, 2 * k - 1, 2 * k, 2 * k + 1];
            let _ = write!(indices, "{a} {b} {d} {a} {d} {c} ");
        }
    }
    format!(
        r#"LookAt 0 0 -4  0 0 0  0 1 0
        Camera "orthographic" "float screenwindow" [-0.9 0.9 -0.1 0.1]
        Film "rgb" "integer xresolution" 900 "integer yresolution" 3 WorldBegin
        LightSource "distant" "rgb L" [1 1 1] "point3 from" [-0.5 0 -1] "point3 to" [0 0 0]
        Material "diffuse" "rgb reflectance" [1 1 1]
        Shape "trianglemesh" "point3 P" [{points}] "normal N" [{normals}] "integer indices" [{indices}]"#
    )
}

/// M49: at ridges the derivative of Gouraud shading jumps from the slope of one side to that of the next, which eyes
/// see as Mach bands; that of Phong shading does not.
#[test]
fn gouraud_shading_has_mach_bands() {
    let scene = scene(&cylinder());
    let to_light = Vec3::new(-0.5, 0.0, -1.0).normalize();
    let light = |k: i32| {
        let a = (15.0 * k as f32).to_radians();
        (a.sin(), Vec3::new(a.sin(), 0.0, -a.cos()).dot(to_light) / PI)
    };
    let slope = |k: i32| (light(k + 1).1 - light(k).1) / (light(k + 1).0 - light(k).0);
    let jump = |row: &[f32], k: i32| {
        // Columns are 0.002 wide; slopes over six of them on both sides of the ridge.
        let middle = ((light(k).0 + 0.9) / 0.002).round() as usize;
        let of = |from: usize, to: usize| (row[to] - row[from]) / (0.002 * (to - from) as f32);
        of(middle + 2, middle + 8) - of(middle - 8, middle - 2)
    };
    let row = |model: &str| green(&scene, model)[900..1800].to_vec();
    let (gouraud, phong) = (row("gouraud"), row("phong"));
    let (mut of_gouraud, mut of_phong) = (0.0, 0.0);
    for k in -2..=2 {
        let right = slope(k) - slope(k - 1);
        let found = jump(&gouraud, k);
        assert!((found - right).abs() < 0.02 * right.abs(), "ridge {k}: {found}, not {right}");
        of_gouraud += found.abs();
        of_phong += jump(&phong, k).abs();
    }
    // Sides of unequal width leave small jumps of the interpolated normal's rate.
    assert!(of_phong < 0.25 * of_gouraud, "{of_phong} of {of_gouraud}");
}

/// A sphere of n rings of 2n quadrilaterals, with or without the normals of the sphere.
fn sphere(n: usize) -> String {
    let (mut points, mut indices) = (String::new(), String::new());
    for i in 0..=n {
        for j in 0..=2 * n {
            let (theta, phi) = (PI * i as f32 / n as f32, PI * j as f32 / n as f32);
            let _ = write!(points, "{} {} {} ", theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            if i < n && j < 2 * n {
                let at = |i: usize, j: usize| i * (2 * n + 1) + j;
                let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
                let _ = write!(indices, "{a} {b} {d} {a} {d} {c} ");
            }
        }
    }
    format!(r#"Shape "trianglemesh" "point3 P" [{points}] "normal N" [{points}] "integer indices" [{indices}]"#)
}

/// M50: Phong and Gouraud shading of spheres of n rings converge to the sphere as n⁻², flat shading as n⁻¹.
#[test]
fn models_converge_to_the_sphere() {
    let scene = |shape: &str| {
        scene(&format!(
            r#"LookAt 0.3 0.4 -4  0 0 0  0 1 0 Camera "orthographic" "float screenwindow" [-0.6 0.6 -0.6 0.6]
            Film "rgb" "integer xresolution" 96 "integer yresolution" 96 WorldBegin
            LightSource "distant" "rgb L" [1 1 1] "point3 from" [-0.5 0.7 -2] "point3 to" [0 0 0]
            Material "diffuse" "rgb reflectance" [1 1 1] {shape}"#
        ))
    };
    let right = green(&scene(r#"Shape "sphere""#), "pixel");
    for (model, order) in [("phong", 2.0), ("gouraud", 2.0), ("flat", 1.0), ("flat-centre", 1.0)] {
        let error = |n: usize| {
            let found = green(&scene(&sphere(n)), model);
            let squares: f32 = found.iter().zip(&right).map(|(a, b)| (a - b).powi(2)).sum();
            f64::from((squares / right.len() as f32).sqrt())
        };
        // Slope of log error over log n, from 12 to 48 rings.
        let slope = (error(12) / error(48)).ln() / 4f64.ln();
        assert!((slope - order).abs() < 0.15, "{model}: n^-{slope}");
    }
}

/// Neighbours light a shared corner with the same random numbers: an area light by one point leaves no seam.
#[test]
fn shared_corners_have_one_light() {
    let text = r#"LookAt 0 0 -4  0 0 0  0 1 0 Camera "orthographic" "float screenwindow" [-0.9 0.9 -0.9 0.9]
        Film "rgb" "integer xresolution" 64 "integer yresolution" 64 WorldBegin
        AttributeBegin Translate 0.5 3 -2 AreaLightSource "diffuse" "rgb L" [4 4 4] Shape "sphere" "float radius" 0.8
        AttributeEnd
        Shape "trianglemesh" "point3 P" [-1 -1 0  1 -1 0  1 1 0  -1 1 0] "integer indices" [0 1 2]
        Shape "trianglemesh" "point3 P" [-1 -1 0  1 1 0  -1 1 0] "integer indices" [0 1 2]"#;
    let found = green(&scene(text), "gouraud,points=1");
    // Across the diagonal that both triangles share.
    let step = |k: usize| (found[k * 64 + 63 - k] - found[k * 64 + 64 - k]).abs();
    let largest = (1..64).map(step).fold(0.0, f32::max);
    let range = found.iter().fold(0.0, |a: f32, b| a.max(*b)) - found.iter().fold(f32::MAX, |a, b| a.min(*b));
    assert!(range > 0.05 && largest < 0.06 * range, "{largest} of {range}");
}

#[test]
fn models_are_of_forward_frames() {
    let scene = scene(&cylinder());
    for frame in ["hybrid", "preview"] {
        let quality = Quality::of(&format!("raster:frame={frame},shading=flat"));
        let said = quality.render(&scene).expect_err(frame).to_string();
        assert!(said.contains("shading") && said.contains("frame=forward"), "{said}");
    }
}

//! Environments as image-based light in `raster`.

use std::sync::Arc;
use steradian::{ColorMode, CompileOptions, Quality, Scene, compile, load_bytes, render};

/// A white ball under an environment, in a parallel view.
fn ball(lights: &str) -> Arc<Scene> {
    ball_of(lights, "{material: diffuse, reflectance: 1}")
}

/// A ball of a material under an environment, in a parallel view.
fn ball_of(lights: &str, material: &str) -> Arc<Scene> {
    let text = format!(
        r#"steradian: 1
        film: {{film: rgb, width: 48, height: 48}}
        camera: {{camera: orthographic, to_world: {{look_at: [0, 0, 0], from: [2, 1, 3]}}}}
        lights: [{lights}]
        shapes: [{{shape: sphere, material: {material}}}]"#
    );
    let loaded = load_bytes("ball.steradian", text.into_bytes(), None, &Default::default());
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    Arc::new(compile(&loaded.desc, &options).scene.expect("a sound scene"))
}

fn green(scene: &Arc<Scene>, integrator: &str, spp: u32) -> Vec<f32> {
    let quality = Quality::of(integrator).spp(spp);
    render(scene, &quality).expect(integrator).channel("G").expect("green").to_vec()
}

/// M109: nine coefficients light a convex body as the environment does: exactly under a constant one, to a hundredth of
/// the brightest in the mean under a sky. A sun, all of whose light comes from one direction, is the worst case: three
/// hundredths, and nine at most (Ramamoorthi and Hanrahan 2001, section 3).
#[test]
fn nine_coefficients_light_a_ball() {
    for (lights, mean, largest) in [
        ("{light: environment, radiance: 0.7}", 1e-4, 1e-3),
        ("{light: sky, sun_direction: [0.5, 0.8, 0.3], to_world: {rotate: [1, 0, 0], degrees: -90}}", 0.03, 0.09),
        (
            "{light: sky, sun_direction: [0.5, 0.8, 0.3], sun_scale: 0, to_world: {rotate: [1, 0, 0], degrees: -90}}",
            0.01,
            0.04,
        ),
    ] {
        let scene = ball(lights);
        let hide = "hide_emitters=true";
        let found = green(&scene, &format!("raster:environment=harmonics,{hide}"), 1);
        let right = green(&scene, &format!("path:max_depth=1,reuse=1,{hide}"), 512);
        // Pixels within the ball.
        let inside = |k: &usize| {
            let at = |v: usize| (v as f32 + 0.5) / 24.0 - 1.0;
            at(k % 48).hypot(at(k / 48)) < 0.85
        };
        let brightest = right.iter().fold(0.0, |a: f32, b| a.max(*b));
        let errors: Vec<f32> = (0..48 * 48).filter(inside).map(|k| (found[k] - right[k]).abs() / brightest).collect();
        let (sum, most) = errors.iter().fold((0.0, 0.0), |(sum, most): (f32, f32), e| (sum + e, most.max(*e)));
        let average = sum / errors.len() as f32;
        assert!(brightest > 0.0 && average < mean && most < largest, "{lights}: {average} {most}");
    }
}

/// Prefiltered maps and the albedo of facets light a metal and glTF's surface of each roughness nearly as the environment
/// does: a constant one but for Schlick's form of the reflectance, a sky to a few hundredths of the light in the mean.
#[test]
fn prefiltered_maps_light_balls_of_each_roughness() {
    let sky = "{light: sky, sun_direction: [0.5, 0.8, 0.3], sun_scale: 0, to_world: {rotate: [1, 0, 0], degrees: -90}}";
    let metal = |alpha: f32| format!("{{material: conductor, alpha_u: {alpha}, eta: 0.2, k: 3}}");
    let gltf = |alpha: f32| {
        let roughness = alpha.sqrt();
        format!("{{material: metallic_roughness, base_color: 0.6, metallic: 0.3, roughness: {roughness}}}")
    };
    let hide = "hide_emitters=true";
    for (lights, most) in [("{light: environment, radiance: 0.7}", 0.015), (sky, 0.06)] {
        for (name, alpha) in ["metal", "glTF"].iter().flat_map(|name| [0.05, 0.3, 1.0].map(|a| (*name, a))) {
            let scene = ball_of(lights, &if name == "metal" { metal(alpha) } else { gltf(alpha) });
            let found = green(&scene, &format!("raster:environment=prefiltered,{hide}"), 1);
            let right = green(&scene, &format!("path:max_depth=1,reuse=1,{hide}"), 64);
            let inside = |k: &usize| {
                let at = |v: usize| (v as f32 + 0.5) / 24.0 - 1.0;
                at(k % 48).hypot(at(k / 48)) < 0.85
            };
            let sum = |f: &dyn Fn(usize) -> f32| (0..48 * 48).filter(inside).map(f).sum::<f32>();
            let light = sum(&|k| right[k]);
            let (mean, error) = (sum(&|k| found[k]) / light - 1.0, sum(&|k| (found[k] - right[k]).abs()) / light);
            assert!(mean.abs() < most && error < 0.12, "{name} of α = {alpha}: {mean} in the mean, {error}, {lights}");
        }
    }
}

#[test]
fn coefficients_are_of_forward_frames_in_rgb() {
    let scene = ball("{light: environment, radiance: 1}");
    let said = Quality::of("raster:frame=hybrid,environment=harmonics").render(&scene).expect_err("hybrid").to_string();
    assert!(said.contains("frame=forward"), "{said}");
}

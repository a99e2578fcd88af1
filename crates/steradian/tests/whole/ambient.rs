//! The ambient term `k_a L_a` of `whitted` and `raster` (M73).

use std::sync::Arc;
use steradian::{ColorMode, CompileOptions, Layer, Quality, Scene, compile, load_bytes, math::Vec3, render};

/// A wall of reflectance (0.2, 0.5, 0.8) that fills the view, under two ambient lights of together (1.5, 0.75, 1).
fn scene(material: &str, lights: &str) -> Arc<Scene> {
    let text = format!(
        r#"steradian: 1
        film: {{film: rgb, width: 4, height: 4}}
        camera: {{camera: perspective, fov: 20, to_world: {{look_at: [0, 0, 0], from: [0, 0, -3]}}}}
        lights: [
            {{light: ambient, radiance: {{rgb: [0.5, 0.25, 1]}}}}
            {{light: ambient, radiance: {{rgb: [0.5, 0.25, 0]}}, scale: 2}}
            {lights}
        ]
        shapes: [{{shape: plane, normal: [0, 0, -1], material: {material}}}]"#
    );
    let loaded = load_bytes("wall.steradian", text.into_bytes(), None, &Default::default());
    assert!(!loaded.diagnostics.has_errors());
    let mode = Some(ColorMode::Rgb);
    let compiled = compile(&loaded.desc, &CompileOptions { mode, ..CompileOptions::default() });
    Arc::new(compiled.scene.expect("a sound scene"))
}

fn color(scene: &Arc<Scene>, quality: &Quality, layer: &str) -> Vec3 {
    let picture = render(scene, quality).expect("a picture");
    let channel = |c: &str| {
        let name = format!("{layer}{c}");
        picture.channel(&name).unwrap_or_else(|| panic!("no {name}")).iter().sum::<f32>() / 16.0
    };
    Vec3::new(channel("R"), channel("G"), channel("B"))
}

const WALL: &str = "{material: diffuse, reflectance: {rgb: [0.2, 0.5, 0.8]}}";

/// The term is constant: the albedo times the light, or the material's own k_a times it; textures of k_a count. A lamp
/// adds its light to it. Mirrors have none.
#[test]
fn the_term_is_a_product() {
    let light = Vec3::new(1.5, 0.75, 1.0);
    let own = "{material: diffuse, reflectance: {rgb: [0.2, 0.5, 0.8]}, ambient: {rgb: [0.1, 1, 0]}}";
    let textured = "{material: diffuse, reflectance: 0.5, ambient: {texture: constant, value: {rgb: [0.3, 0.2, 0.1]}}}";
    let mirror = "{material: conductor, reflectance: 1}";
    let lamp = "{light: point, position: [0, 0, -5], intensity: 30}";
    for name in ["whitted", "raster:frame=forward"] {
        let of = |material: &str, lights: &str| color(&scene(material, lights), &Quality::of(name), "");
        for (material, k) in [
            (WALL, Vec3::new(0.2, 0.5, 0.8)),
            (own, Vec3::new(0.1, 1.0, 0.0)),
            (textured, Vec3::new(0.3, 0.2, 0.1)),
            (mirror, Vec3::ZERO),
        ] {
            let found = of(material, "");
            assert!((found - k * light).abs().max_element() < 1e-5, "{name}, {material}: {found}");
        }
        let (both, lamp_alone) = (of(WALL, lamp), of(&WALL.replace("}}", "}, ambient: 0}"), lamp));
        let ambient = both - lamp_alone;
        assert!(lamp_alone.min_element() > 0.05, "{name}: {lamp_alone}");
        assert!((ambient - Vec3::new(0.2, 0.5, 0.8) * light).abs().max_element() < 1e-5, "{name}: {ambient}");
    }
}

/// Each ambient light has its group, and other methods say that they leave it out.
#[test]
fn ambient_lights_have_groups_and_are_told() {
    let scene = scene(WALL, "");
    let quality = Quality { layers: vec![Layer::LIGHT_GROUPS], ..Quality::of("raster:frame=forward") };
    let (a, b) = (color(&scene, &quality, "RGBA_ambient_1."), color(&scene, &quality, "RGBA_ambient_2."));
    assert!((a - Vec3::new(0.1, 0.125, 0.8)).abs().max_element() < 1e-5, "{a}");
    assert!((b - Vec3::new(0.2, 0.25, 0.0)).abs().max_element() < 1e-5, "{b}");
    for (name, is_exact) in [("whitted", true), ("raster:frame=forward", true), ("raster", false), ("path", false)] {
        let render = Quality::of(name).render(&scene).expect(name);
        let told = render.left_out(&scene).map_or(String::new(), |left_out| left_out.of(name));
        assert_eq!(told.contains("lights 'ambient'"), !is_exact, "{name}: {told}");
        assert_eq!(told.contains("'whitted' renders it"), !is_exact, "{name}: {told}");
    }
}

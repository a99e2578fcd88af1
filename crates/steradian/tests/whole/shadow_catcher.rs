//! Shadow catchers: pictures show only the shadows that they receive.

use std::sync::Arc;
use steradian::{CompileOptions, Layer, Quality, Scene, compile, load_bytes, render};

const SKY: &str = "{light: environment, radiance: 2}";
/// From +x, at 45 degrees.
const SUN: &str = "{light: distant, direction: [-1, 0, -1], radiance: 3}";
/// A wall beside the point that is seen, as good as without end, that hides all directions to +x.
const WALL: &str =
    "{shape: disk, radius: 1000, to_world: [{rotate: [0, 1, 0], degrees: 90}, {translate: [0.5, 0, 0]}]}";

/// A catcher that is seen from above at the origin, with lights and other shapes.
fn scene(lights: &str, shapes: &str) -> Arc<Scene> {
    let text = format!(
        "steradian: 1
        camera: {{camera: perspective, fov: 0.5, to_world: {{look_at: [0, 0, 0], from: [0, 0, 8], up: [0, 1, 0]}}}}
        lights: [{lights}]
        shapes: [{{shape: disk, shadow_catcher: true, radius: 10}}, {shapes}]"
    );
    let loaded = load_bytes("catcher.steradian", text.into_bytes(), None, &Default::default());
    let compiled = compile(&loaded.desc, &CompileOptions { size: Some((8, 8)), ..CompileOptions::default() });
    Arc::new(compiled.scene.unwrap_or_else(|| panic!("{:?} {:?}", loaded.diagnostics, compiled.diagnostics)))
}

/// Mean of red and of alpha.
fn means(scene: &Arc<Scene>, integrator: &str, transparent: bool) -> [f64; 2] {
    let quality = Quality { transparent, layers: vec![Layer::ALPHA], ..Quality::of(integrator).spp(64) };
    let picture = render(scene, &quality).expect(integrator);
    ["R", "A"].map(|channel| picture.channel(channel).unwrap().iter().map(|v| f64::from(*v)).sum::<f64>() / 64.0)
}

/// Alpha is the part of the light that is blocked: half of a sky beside a wall, all of a sun behind it, and by their
/// irradiances 2 π and 3/√2 of both; nothing where nothing is in the way. Without a transparent background the sky of
/// radiance 2 is seen, less that part.
#[test]
fn pictures_show_the_part_of_the_light_that_is_blocked() {
    let [sky, sun] = [2.0 * std::f64::consts::PI, 3.0 * std::f64::consts::FRAC_1_SQRT_2];
    let both = format!("{SKY}, {SUN}");
    let cases = [
        (SKY, WALL, 0.5, 2.0),
        (SUN, WALL, 1.0, 0.0),
        (&both, WALL, (0.5 * sky + sun) / (sky + sun), 2.0),
        (SKY, "", 0.0, 2.0),
        (&both, "", 0.0, 2.0),
        ("", WALL, 0.0, 0.0),
    ];
    for (lights, shapes, blocked, behind) in cases {
        let scene = scene(lights, shapes);
        for integrator in ["path", "direct", "raster"] {
            let what = format!("{integrator}: {lights} {shapes}");
            let [red, alpha] = means(&scene, integrator, true);
            assert!((alpha - blocked).abs() < 0.01, "{what}: alpha {alpha}, not {blocked}");
            assert_eq!(red, 0.0, "{what}");
            let [red, _] = means(&scene, integrator, false);
            let right = behind * (1.0 - blocked);
            assert!((red - right).abs() < 0.02, "{what}: red {red}, not {right}");
        }
    }
}

/// Other surfaces see a catcher as any surface: its light is on them, and mirrors show it.
#[test]
fn other_surfaces_see_it() {
    let under = "{shape: disk, radius: 0.5, material: {material: conductor, reflectance: 1}, \
                 to_world: [{rotate: [1, 0, 0], degrees: 180}, {translate: [0, 0, 4]}]}, \
                 {shape: disk, radius: 0.5, material: {material: diffuse, reflectance: 0.5}, \
                 to_world: [{translate: [0, 0, 2]}]}";
    let [red, alpha] = means(&scene(SKY, under), "path", false);
    assert!(alpha == 1.0 && red > 0.05, "{red} {alpha}");
}

/// Layers that add up to the light of paths have no part that a catcher shows: they are refused.
#[test]
fn layers_that_add_up_are_refused() {
    for layer in [Layer::LIGHT_GROUPS, Layer::BOUNCES] {
        let quality = Quality { layers: vec![layer], ..Quality::of("path").spp(1) };
        let error = render(&scene(SKY, WALL), &quality).unwrap_err().to_string();
        assert!(error.contains("with shadow catchers"), "{error}");
    }
}

//! Colour: RGB and spectral rendering agree where they should, and white stays white.

use crate::{
    shot::{Shot, mean},
    stage::{Stage, cuboid, diffuse, light, material, medium, plane, rectangle, rgb, sphere, white},
};
use steradian_core::ColorMode;
use steradian_math::{
    color::space::REC709,
    spectra::{Blackbody, cie},
};
use steradian_scene::{SpectrumValue, Value};

fn spectrum(v: SpectrumValue) -> Value {
    Value::Spectrum(v)
}

/// Everything grey, lit by white light of each kind: the spectral picture is the RGB picture, for every part of the
/// frame. 4σ.
#[test]
fn grey_scenes_look_the_same_in_both_modes() {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 1.0, 0.0], 0.0), diffuse(0.5));
    let block = stage.add(diffuse(0.8));
    stage.place_mesh(cuboid([-0.9, 0.0, -0.3], [-0.4, 0.8, 0.2])).material = Some(block);
    stage.solid(
        sphere([0.1, 0.4, 0.2], 0.4),
        material("plastic").with("diffuse_reflectance", white(0.4)).with("alpha_u", 0.1),
    );
    stage.solid(sphere([0.9, 0.3, 0.0], 0.3), material("dielectric").with("eta", 1.5));
    stage.mesh_lamp(rectangle([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 2.0);
    stage.light(light("point").with("position", [1.5, 1.5, 1.5]).with("intensity", white(1.0)));
    stage.light(light("distant").with("direction", [0.5, -1.0, -0.5]).with("radiance", white(0.4)));
    stage.sky(0.2).film(8, 8).look([0.2, 1.2, 4.0], [0.1, 0.4, 0.0], 35.0);
    let shot = |mode, seed| Shot::of("path", 1500).depth(6).seed(seed).take(&stage.scene_in(mode));
    let (a, b) = (shot(ColorMode::Rgb, 1), shot(ColorMode::Spectral, 2));
    for rows in 0..4 {
        let part = |f: &steradian_integrators::Film| {
            mean(&steradian_integrators::Film { pixels: f.pixels[rows * 16..(rows + 1) * 16].to_vec(), ..f.clone() })
        };
        part(&b).agrees(&format!("rows {} and {}", 2 * rows, 2 * rows + 1), part(&a), 0.03);
    }
}

/// M128: white light on a coloured surface gives the surface's colour in spectral mode too: RGB reflectances become
/// spectra that look the same under D65. 4σ and the 5·10⁻³ of the upsampling.
#[test]
fn reflectances_round_trip_under_d65() {
    for color in [[0.8, 0.8, 0.8], [0.8, 0.3, 0.1], [0.1, 0.5, 0.2], [0.1, 0.2, 0.7], [0.9, 0.8, 0.05]] {
        let mut stage = Stage::new();
        stage.solid(sphere([0.0; 3], 1.0), material("diffuse").with("reflectance", rgb(color)));
        stage.sky(1.0).probe([0.0, 0.0, -3.0], [0.0; 3]);
        let e = mean(&Shot::of("path", 100_000).take(&stage.scene_in(ColorMode::Spectral)));
        for c in 0..3 {
            assert!(e.sigma[c] < 4e-3, "too noisy: {e:?}");
            assert!((e.mean[c] - color[c]).abs() < 4.0 * e.sigma[c] + 5e-3, "{:?} for {color:?}", e.mean);
        }
    }
}

/// M135: black bodies have the chromaticity of the Planckian locus: illuminant A (2856 K) is at (0.4476, 0.4074), 6500
/// K at (0.3135, 0.3237), 10000 K at (0.2807, 0.2884) (CIE 15:2004; Wyszecki & Stiles 1982), as a light in both modes.
#[test]
fn black_bodies_have_their_color() {
    for (kelvin, [x, y]) in [(2856.0, [0.4476, 0.4074]), (6500.0, [0.3135, 0.3237]), (10_000.0, [0.2807, 0.2884])] {
        for mode in [ColorMode::Rgb, ColorMode::Spectral] {
            let mut stage = Stage::new();
            stage.light(light("environment").with("radiance", spectrum(SpectrumValue::Blackbody(kelvin))));
            stage.look([0.0; 3], [0.0, 0.0, 1.0], 40.0);
            let spp = if mode == ColorMode::Rgb { 4 } else { 200_000 };
            let e = mean(&Shot::of("path", spp).take(&stage.scene_in(mode)));
            // The radiance itself: Planck's law of maximum one.
            let xyz = cie::to_xyz(|l| Blackbody::normalized(kelvin).eval(l));
            let expected = (REC709.rgb_from_xyz() * xyz).to_array();
            e.is_near(&format!("{kelvin} K, {mode:?}"), expected, 0.02);
            let seen = REC709.xyz_from_rgb() * steradian_math::DVec3::from_array(e.mean);
            let sum = seen.x + seen.y + seen.z;
            let tolerance = if mode == ColorMode::Rgb { 1e-3 } else { 4e-3 };
            assert!(
                (seen.x / sum - x).abs() < tolerance && (seen.y / sum - y).abs() < tolerance,
                "{kelvin} K, {mode:?}: {seen}"
            );
        }
    }
}

/// M68: a narrow line at 555 nm and D65 of the same luminance look equally bright; an equal-energy light is a little
/// pink in Rec.709, by the very amount of the CIE's numbers. 4σ.
#[test]
fn light_spectra_become_their_tristimulus() {
    let line = SpectrumValue::Sampled { lambdas: vec![549.0, 550.0, 560.0, 561.0], values: vec![0.0, 1.0, 1.0, 0.0] };
    let flat = SpectrumValue::Constant(1.0);
    for (name, value, s) in [
        ("line", line, Box::new(|l: f32| (l - 549.0).min(561.0 - l).clamp(0.0, 1.0)) as Box<dyn Fn(f32) -> f32>),
        ("equal energy", flat, Box::new(|_| 1.0)),
    ] {
        let expected = (REC709.rgb_from_xyz() * cie::to_xyz(s)).to_array();
        let mut stage = Stage::new();
        stage.light(light("environment").with("radiance", spectrum(value)));
        stage.look([0.0; 3], [0.0, 0.0, 1.0], 40.0);
        let e = mean(&Shot::of("path", 400_000).take(&stage.scene_in(ColorMode::Spectral)));
        e.is_near(name, expected, 0.02);
    }
}

/// Wavelengths part at glass whose index depends on them: the furnace stays white, though each path keeps one
/// wavelength alone. 4σ.
#[test]
fn dispersion_keeps_white_white() {
    let mut stage = Stage::new();
    let glass = spectrum(SpectrumValue::Named("glass-SF11".into()));
    stage.solid(sphere([0.0; 3], 1.0), material("dielectric").with("eta", glass));
    stage.sky(1.0).probe([0.4, 0.3, -4.0], [0.4, 0.3, 0.0]);
    let e = mean(&Shot::of("path", 300_000).roulette_after(1000).take(&stage.scene_in(ColorMode::Spectral)));
    e.is_near_grey("a ball of flint glass", 1.0, 0.02);
}

/// M171: a grey medium lit by white gives the same grey in both modes. 4σ.
#[test]
fn grey_media_look_the_same_in_both_modes() {
    let mut stage = Stage::new();
    let (what, interface) = (stage.add(medium(white(0.3), white(1.2))), stage.add(material("interface")));
    let ball = stage.place(sphere([0.0; 3], 1.0));
    (ball.interior, ball.is_medium_boundary, ball.material) = (Some(what), true, Some(interface));
    stage.light(light("distant").with("direction", [1.0, -0.5, 0.5]).with("radiance", white(3.0)));
    stage.sky(0.3).probe([0.1, 0.2, -4.0], [0.1, 0.2, 0.0]);
    let shot = |mode, spp| mean(&Shot::of("volpath", spp).take(&stage.scene_in(mode)));
    shot(ColorMode::Spectral, 80_000).agrees("grey fog", shot(ColorMode::Rgb, 60_000), 0.03);
}

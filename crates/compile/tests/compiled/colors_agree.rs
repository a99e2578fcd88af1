//! Every material looks the same computed in RGB and over wavelengths, as far as three numbers can say it.

use super::prepare;
use steradian_bsdf::TransportMode::Radiance;
use steradian_compile::{Options, compile};
use steradian_core::{material::scattering, scene::Scene};
use steradian_math::{
    Vec2, Vec3,
    color::space::REC709,
    spectra::{
        ColorMode,
        role::{Color, Role},
    },
};
use steradian_scene::{Family, Node, SceneDesc, Shape};
use steradian_schema::material::MATERIALS;
use steradian_texture::TextureContext;

/// A sphere of a material with its defaults.
fn scene(kind: &str, mode: ColorMode) -> Scene {
    let mut d = SceneDesc::default();
    let camera = d.add(Node::new(Family::Camera, "perspective", None));
    d.cameras.push(camera);
    let inner = d.add(Node::new(Family::Material, "diffuse", None));
    let mut node = Node::new(Family::Material, kind, None);
    let model = Family::Material.model(kind).expect("a kind of material");
    prepare(&mut node, model, [inner; 2], None);
    // What absorbs along a way has no colour of its own: powers of three numbers are not those of the spectrum behind
    // them.
    if model.parameter("sigma_a").is_some() {
        node.set("sigma_a", 0.3, None);
    }
    let material = d.add(node);
    let sphere = d.add(Node::new(Family::Shape, "sphere", None));
    d.shapes.push(Shape { material: Some(material), ..Shape::new(sphere) });
    let compiled = compile(&d, &Options { mode: Some(mode), ..Options::default() });
    compiled.scene.unwrap_or_else(|| panic!("{kind}: {:?}", compiled.diagnostics))
}

/// The colour of white light scattered from one direction to another, or of the specular lobe; in spectral mode by
/// quadrature.
fn seen(scene: &Scene, wo: Vec3, wi: Vec3) -> Vec3 {
    let n = if scene.mode() == ColorMode::Rgb { 1 } else { 128 };
    let white = Color::rgb(Vec3::ONE, &REC709, Role::Illuminant, scene.mode());
    let at = TextureContext::new(Vec3::ZERO, Vec2::splat(0.4));
    let mut sum = Vec3::ZERO;
    for i in 0..n {
        let mut lambda = scene.mode().wavelengths(|| (i as f32 + 0.5) / n as f32);
        let material = scene.geometries()[0].material;
        let s = scattering(scene.materials(), scene.textures(), material, &at, true, 0.3, &mut lambda)
            .expect("it scatters");
        let value = if s.bsdf.is_specular() {
            s.bsdf.sample(wo, 0.01, Vec2::splat(0.3), Radiance).expect("a lobe").weight
        } else {
            s.bsdf.eval(wo, wi, Radiance).value
        };
        sum += scene.mode().to_rgb(value * white.eval(&lambda), &lambda);
    }
    sum / n as f32
}

#[test]
fn colours_are_the_same_in_rgb_and_over_wavelengths() {
    let directions = [
        (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.55, 0.1, 0.7)),
        (Vec3::new(0.3, -0.2, 0.5), Vec3::new(0.1, 0.4, 0.3)),
        (Vec3::new(-0.8, 0.1, 0.3), Vec3::new(0.0, 0.1, 1.0)),
    ];
    // The orders of a grating go by the wavelength.
    for entry in MATERIALS.iter().filter(|e| !["interface", "measured", "grating"].contains(&e.kind)) {
        let [rgb, spectral] = [ColorMode::Rgb, ColorMode::Spectral].map(|mode| scene(entry.kind, mode));
        for (wo, wi) in directions.map(|(o, i)| (o.normalize(), i.normalize())) {
            let (a, b) = (seen(&rgb, wo, wi), seen(&spectral, wo, wi));
            let allowed = 0.03 * a.max(b) + Vec3::splat(1e-3);
            assert!((a - b).abs().cmple(allowed).all(), "{}: {a} in RGB, {b} over wavelengths", entry.kind);
        }
    }
}

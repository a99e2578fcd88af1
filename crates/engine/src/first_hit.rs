//! Auxiliary layers: what a camera ray sees first.

use steradian_bsdf::Bsdf;
use steradian_core::{ColorMode, Scene, film::FirstHit, scene::Interaction};
use steradian_math::{
    Frame, Ray, Spectrum, Vec3,
    spectra::{Wavelengths, role},
};

/// Sets of four wavelengths at which the albedo of a spectral scene is evaluated. They are the same for all samples, so
/// that the layer has no noise of wavelengths.
const SETS: usize = 4;

/// The first surface that scatters, along a camera ray.
pub fn first_hit(scene: &Scene, ray: Ray, lambda: &Wavelengths) -> FirstHit {
    let forward = scene.camera().forward();
    let eye = ray.origin;
    let mut ray = ray;
    // A ray meets few interfaces before anything else; beyond that the layers stay empty.
    for _ in 0..64 {
        let Some(hit) = scene.intersect(&ray) else { return FirstHit::default() };
        let i = scene.interaction(&ray, &hit);
        let Some((albedo, frame)) = albedo(scene, &i, lambda) else {
            ray = i.spawn(ray.direction);
            continue;
        };
        let geometry = &scene.geometries()[i.geometry as usize];
        let to = i.surface.p - eye;
        let ng = i.surface.n;
        return FirstHit {
            albedo: albedo.to_array(),
            normal: frame.z.to_array(),
            geometric_normal: if ng.dot(i.wo) < 0.0 { -ng } else { ng }.to_array(),
            position: i.surface.p.to_array(),
            depth: to.dot(forward),
            distance: to.length(),
            uv: i.surface.uv.to_array(),
            shape: geometry.id,
            material: geometry.material + 1,
            coverage: 1.0,
        };
    }
    FirstHit::default()
}

/// The part of white light that a surface sends back, as RGB, and the shading frame; `None` where it scatters nothing.
pub fn albedo(scene: &Scene, i: &Interaction, lambda: &Wavelengths) -> Option<(Vec3, Frame)> {
    // Textures are evaluated at the wavelengths that are asked for.
    let at = |lambda: &Wavelengths| scene.scattering(i, 0.5, &mut { *lambda });
    let (s, frame) = at(lambda)?;
    let albedo = |bsdf: &Bsdf, lambda: &Wavelengths| albedo_of(scene, bsdf, frame.to_local(i.wo), lambda);
    let albedo = match scene.mode() {
        ColorMode::Rgb => albedo(&s.bsdf, lambda),
        ColorMode::Spectral => {
            let (mut sum, mut white) = (Vec3::ZERO, Vec3::ZERO);
            for set in 0..SETS {
                let lambda = Wavelengths::sample_visible((set as f32 + 0.5) / (4 * SETS) as f32).at_time(lambda.time);
                let one = role::under_white(Spectrum::ONE, &lambda, scene.mode());
                white += scene.mode().to_rgb(one, &lambda);
                sum += at(&lambda).map_or(Vec3::ZERO, |(s, _)| albedo(&s.bsdf, &lambda));
            }
            sum / white
        }
    };
    Some((albedo, frame))
}

/// The part of white light that a surface sends towards `wo` in its shading frame, as RGB; of a few wavelengths, in
/// spectral mode, where it has the wrong hue.
pub fn albedo_of(scene: &Scene, bsdf: &Bsdf, wo: Vec3, lambda: &Wavelengths) -> Vec3 {
    let albedo = role::under_white(bsdf.albedo_estimate(wo), lambda, scene.mode());
    scene.mode().to_rgb(albedo, lambda)
}

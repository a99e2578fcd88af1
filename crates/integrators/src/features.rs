//! Auxiliary layers: what a camera ray sees first.

use steradian_core::{Scene, color, film::FirstHit};
use steradian_math::{Ray, spectra::Wavelengths};

/// The first surface that scatters, along a camera ray.
pub fn first_hit(scene: &Scene, ray: Ray, lambda: &Wavelengths) -> FirstHit {
    let forward = scene.camera.forward();
    let eye = ray.origin;
    let mut ray = ray;
    // A ray meets few interfaces before anything else; beyond that the layers stay empty.
    for _ in 0..64 {
        let Some(hit) = scene.intersect(&ray) else { return FirstHit::default() };
        let i = scene.interaction(&ray, &hit);
        let mut w = *lambda;
        let Some((s, frame)) = scene.scattering(&i, 0.5, &mut w) else {
            ray = i.spawn(ray.direction);
            continue;
        };
        let albedo = s.bsdf.albedo_estimate(frame.to_local(i.wo));
        let geometry = &scene.geometries[i.geometry as usize];
        let to = i.surface.p - eye;
        return FirstHit {
            albedo: color::to_rgb(albedo, lambda, scene.mode).clamp(glam::Vec3::ZERO, glam::Vec3::ONE).to_array(),
            normal: frame.z.to_array(),
            position: i.surface.p.to_array(),
            depth: to.dot(forward),
            distance: to.length(),
            uv: i.surface.uv.to_array(),
            shape: geometry.id,
            material: geometry.material + 1,
        };
    }
    FirstHit::default()
}

//! Methods by passes ([`steradian_engine::Pass`]): those that start at lights, or whose paths land on other pixels than
//! their own.
//!
//! Contributions are added in the order of pieces of work (`Run::in_order`), so that splats need no atomics and bits do
//! not depend on threads. The spread between passes gives the variance of pixels.
//!
//! `subpath` traces subpaths from the camera or from lights, and `vertex` scatters at their vertices. `bidirectional`
//! connects subpaths for `light`, `bdpt` and `vcm`; `mlt` drives the same code with Markov chains; `sppm` and
//! `photon_map` gather photons. `missed` estimates the caustics that no path from the camera finds. The emission of
//! lights is in `steradian_core::light::emission`, the importance of cameras in `steradian_core::camera::importance`.

mod bidirectional;
mod missed;
mod mlt;
mod photon_map;
mod photons;
mod radius;
mod registry;
mod sppm;
mod subpath;
mod vertex;

pub use bidirectional::{Bidirectional, Strategy};
pub use missed::missed_caustics;
pub use mlt::Metropolis;
pub use photon_map::PhotonMap;
pub use radius::Radius;
pub(crate) use registry::for_paths_alone;
pub use registry::{PassKind, left_to_chance};
pub use sppm::Sppm;

use crate::Depth;
use steradian_bsdf::TransportMode;
use steradian_core::{Scene, light::Light, scene::Interaction};
use steradian_engine::Run;
use steradian_math::{Vec2, Vec3, spectra::Wavelengths};

/// The wavelengths and the moment that all paths of a pass share.
fn pass_wavelengths(run: &Run<'_>, number: u32) -> Wavelengths {
    run.wavelengths(&run.sampler.pixel(u32::MAX, u32::MAX, number))
}

/// Light that paths from lights cannot bring.
fn light_reaches_all(scene: &Scene) -> Option<String> {
    let is_infinite = |l: &Light| matches!(l, Light::Distant(..) | Light::Environment(_));
    let is_lost = !scene.planes().is_empty() && scene.lights().lights.iter().any(is_infinite);
    is_lost.then(|| "light from infinity on infinite planes".into())
}

/// Whether the camera, at a direction and a distance, does not see a point of a surface. Where lights are hidden from
/// it, it sees nothing that emits, and sees past all that does.
fn is_hidden_from_camera(scene: &Scene, depth: &Depth, i: &Interaction, (to_camera, distance): (Vec3, f32)) -> bool {
    let ray = i.spawn_towards(to_camera, distance);
    match depth.hide_emitters && !scene.settings().hidden_emitters_block {
        true => depth.hides(scene, i.geometry, 0) || scene.occluded_past_emitters(&ray),
        false => scene.occluded(&ray),
    }
}

/// The material of a surface that the camera sees and that reflects or refracts in one direction, by a grid of rays.
pub fn specular_material(scene: &Scene) -> Option<String> {
    const EDGE: u32 = 48;
    let size = Vec2::new(scene.film().width as f32, scene.film().height as f32);
    (0..EDGE * EDGE).find_map(|k| {
        let place = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
        let ray = scene.camera().ray(scene.film(), place * size, Vec2::splat(0.5));
        let i = scene.interaction(&ray, &scene.intersect(&ray)?);
        let mut lambda = scene.mode().wavelengths(|| 0.5);
        let (s, frame) = scene.scattering(&i, 0.5, &mut lambda)?;
        let wo = frame.to_local(i.wo);
        let lobe = |u| s.bsdf.sample(wo, u, Vec2::splat(0.4), TransportMode::Radiance);
        let is_specular = [0.0, 0.25, 0.5, 0.75, 0.999].into_iter().filter_map(lobe).any(|s| s.lobe.is_specular());
        let name = || scene.material_names().get(scene.geometries()[i.geometry as usize].material as usize).cloned();
        is_specular.then(|| name().unwrap_or_default())
    })
}

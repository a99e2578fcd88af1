//! Auxiliary layers: what a camera ray sees first.
//!
//! First hits are gathered beside the samples, and counted by object and material for Cryptomatte (`steradian_film`).
//! For the layer of motion, a session hands its scene on to the session of the next frame (`Session::take_history`,
//! `Session::follow`), and `steradian_core::scene` finds the position of the surface point in the earlier frame
//! (`earlier`).

use crate::shadow_catcher::{DIRECTIONS, opacity};
use steradian_bsdf::{Bsdf, TransportMode};
use steradian_core::{
    ColorMode, Scene,
    film::FirstHit,
    scene::{Interaction, Moved},
};
use steradian_math::{
    Frame, Ray, Spectrum, Vec2, Vec3,
    spectra::{Wavelengths, role},
};

/// Sets of four wavelengths at which the albedo of a spectral scene is evaluated. They are the same for all samples, so
/// that the layer has no noise of wavelengths.
const SETS: usize = 4;

/// Mirrors and panes that are seen through at most.
const MIRRORS: usize = 16;

/// Rules for the surfaces that count as seen by a camera ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sight {
    /// Gathers surfaces that mirrors and smooth glass show, too.
    pub sees_through: bool,
    /// Lets camera rays pass all that emits.
    pub hide_emitters: bool,
}

/// The first surface that scatters, along a camera ray, by what counts as seen; with its motion since the frame
/// `before`. Nothing is said to move where that is not known.
pub fn first_hit(scene: &Scene, ray: Ray, lambda: &Wavelengths, sight: Sight, before: Option<&Scene>) -> FirstHit {
    let forward = scene.camera().forward();
    let eye = ray.origin;
    // Depth counts from the eye, and rays begin at the near plane.
    let start = scene.camera().start_of(&ray);
    let before_start = if start > 0.0 { start / ray.direction.dot(forward).max(f32::MIN_POSITIVE) } else { 0.0 };
    let motion = |moved: Option<Moved>| moved.map_or([0.0; 3], |m| m.pixels.extend(m.depth).to_array());
    let Some((i, albedo, frame)) = next_hit(scene, ray, lambda, sight.hide_emitters) else {
        let moved = before.and_then(|before| scene.far_moved_since(before, &ray));
        return FirstHit { motion: motion(moved), ..FirstHit::default() };
    };
    let geometry = &scene.geometries()[i.geometry as usize];
    let to = i.surface.p - eye;
    let ng = i.surface.n;
    let mut first = FirstHit {
        albedo: albedo.to_array(),
        normal: frame.z.to_array(),
        geometric_normal: if ng.dot(i.wo) < 0.0 { -ng } else { ng }.to_array(),
        position: i.surface.p.to_array(),
        motion: motion(before.and_then(|before| scene.moved_since(before, &i))),
        depth: start + to.dot(forward),
        distance: before_start + to.length(),
        uv: i.surface.uv.to_array(),
        shape: geometry.id,
        material: geometry.material + 1,
        coverage: 1.0,
        opacity: if geometry.catches_shadows { opacity(scene, &i, frame.z, lambda, DIRECTIONS) } else { 1.0 },
        catches_shadows: geometry.catches_shadows,
        ..FirstHit::default()
    };
    if sight.sees_through {
        let [albedo, normal] = seen(scene, i, [albedo, frame.z], lambda);
        (first.seen_albedo, first.seen_normal) = (albedo.to_array(), normal.to_array());
    }
    first
}

/// The first surface along a ray that scatters, with its albedo and shading frame. Rays meet few interfaces before
/// anything else; beyond that there is none. Lights are passed where they are hidden.
fn next_hit(
    scene: &Scene,
    mut ray: Ray,
    lambda: &Wavelengths,
    hide_emitters: bool,
) -> Option<(Interaction, Vec3, Frame)> {
    for _ in 0..64 {
        let (from, hit) = match hide_emitters {
            true => scene.intersect_past_emitters(&ray)?,
            false => (ray, scene.intersect(&ray)?),
        };
        let i = scene.interaction(&from, &hit);
        match albedo(scene, &i, lambda) {
            Some((albedo, frame)) => return Some((i, albedo, frame)),
            None => ray = i.rest(&ray),
        }
    }
    None
}

/// Albedo and normal of what a surface shows if it is perfectly specular, else its own: along the lobe that sends more,
/// reflection or transmission, which has no noise. As Open Image Denoise recommends for its guides: albedos are
/// multiplied; where a mirror shows nothing, they are its own.
fn seen(scene: &Scene, mut i: Interaction, [mut albedo, mut normal]: [Vec3; 2], lambda: &Wavelengths) -> [Vec3; 2] {
    for _ in 0..MIRRORS {
        let scattering = scene.scattering(&i, 0.5, &mut { *lambda });
        let Some((s, frame)) = scattering.filter(|(s, _)| s.bsdf.is_specular()) else { break };
        let drawn = s.bsdf.sample(frame.to_local(i.wo), 0.5, Vec2::splat(0.5), TransportMode::Radiance);
        // What goes below the surface shows nothing else.
        let Some(drawn) = drawn.filter(|drawn| !drawn.lobe.is_subsurface()) else { break };
        let Some((next, more, frame)) = next_hit(scene, i.spawn(frame.to_world(drawn.wi)), lambda, false) else {
            break;
        };
        (i, albedo, normal) = (next, albedo * more, frame.z);
    }
    [albedo, normal]
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

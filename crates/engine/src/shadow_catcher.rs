//! Shadow catchers: surfaces of which a picture shows only that they are in shadow, before its background.
//!
//! The opacity of a point is the part of its direct light that is blocked, ∫ L (1 − V) cosθ dω / ∫ L cosθ dω by
//! luminance: a picture with that alpha, put over another one, darkens it as the light would. Points without direct
//! light are clear. What other surfaces send to the catcher is left out.

use steradian_core::{
    Scene,
    film::FirstHit,
    light::{Light, LightContext},
    scene::Interaction,
};
use steradian_math::{
    Frame, Ray, Spectrum, Vec2, Vec3,
    hash::HashRng,
    spectra::Wavelengths,
    warp::{cosine_hemisphere, cosine_hemisphere_pdf},
};

/// Directions by each of the two techniques for a sample of a pixel.
pub(crate) const DIRECTIONS: u32 = 4;

/// Steps of an additive recurrence of two dimensions with low discrepancy (Roberts, "The unreasonable effectiveness of
/// quasirandom sequences", 2018).
const STEPS: Vec2 = Vec2::new(0.754_877_7, 0.569_840_3);

/// Opacity of a point of a shadow catcher with the normal `n` on the side that is seen, by so many directions of each
/// of two techniques. Its random numbers are a function of the point and of where it is seen from.
pub fn opacity(scene: &Scene, i: &Interaction, n: Vec3, lambda: &Wavelengths, directions: u32) -> f32 {
    let frame = Frame::from_z(n);
    let lights = scene.lights();
    let ctx = LightContext { p: i.surface.p, n };
    let words = i.surface.p.to_array().into_iter().chain(i.wo.to_array());
    let mut rng = HashRng::new(words.fold(0, |seed, v| steradian_math::hash::combine64(seed, v.to_bits().into())));
    let [choice, light, surface] = [(); 3].map(|()| Vec2::new(rng.next_f32(), rng.next_f32()));
    let (mut all, mut blocked) = (0.0, 0.0);
    let mut add = |light: Spectrum, wi, distance| {
        let weight = scene.mode().luminance(light, lambda);
        if weight > 0.0 {
            all += weight;
            blocked += if scene.occluded(&i.spawn_towards(wi, distance)) { weight } else { 0.0 };
        }
    };
    for k in 0..directions {
        let turned = |start: Vec2| (start + STEPS * k as f32).fract();
        // A light by its importance, and a point on it: L cosθ / p, weighted against the other technique where that
        // finds the light, too.
        let u = (choice.x + k as f32 / directions as f32).fract();
        let chosen = lights.choose(&ctx, u).and_then(|(number, p)| {
            Some((number, p, lights.sample(number, &ctx, turned(light), lambda, scene.textures())?))
        });
        if let Some((number, p, s)) = chosen {
            let cosine = s.wi.dot(n).max(0.0);
            let p = p * s.pdf;
            let other = match lights.lights[number as usize] {
                Light::Environment(_) => cosine_hemisphere_pdf(cosine),
                _ => 0.0,
            };
            add(s.radiance * (cosine / (p + other)), s.wi, s.distance);
        }
        // A direction by the cosine, and the environments there, weighted by the balance heuristic.
        let local = cosine_hemisphere(turned(surface));
        let (wi, p) = (frame.to_world(local), cosine_hemisphere_pdf(local.z));
        let found = lights.environments.iter().fold(Spectrum::ZERO, |sum, &number| {
            let Light::Environment(e) = &lights.lights[number as usize] else { return sum };
            let shines = lights.shines(number, lambda);
            let other = lights.environment_pdf(number, &ctx, wi);
            if shines { sum + e.radiance(ctx.p, wi, lambda) * (local.z / (p + other)) } else { sum }
        });
        add(found, wi, f32::INFINITY);
    }
    if all > 0.0 { (blocked / all).min(1.0) } else { 0.0 }
}

/// Light of a sample in place of that of its path, by what the camera ray sees first: none where a transparent
/// background is seen; before shadow catchers the background, exposed, less their opacity; `None` elsewhere.
pub fn shown(scene: &Scene, ray: &Ray, hit: &FirstHit, is_transparent: bool, lambda: &Wavelengths) -> Option<Spectrum> {
    let is_background = hit.coverage == 0.0 || hit.catches_shadows;
    if is_transparent {
        return is_background.then_some(Spectrum::ZERO);
    }
    hit.catches_shadows.then(|| scene.film().exposed(background(scene, ray, lambda)) * (1.0 - hit.opacity))
}

/// Background of a camera ray: the backdrop, else all environments.
pub fn background(scene: &Scene, ray: &Ray, lambda: &Wavelengths) -> Spectrum {
    let lights = scene.lights();
    if let Some(backdrop) = &lights.backdrop {
        return backdrop.radiance(ray.origin, ray.direction, lambda);
    }
    lights.environments.iter().fold(Spectrum::ZERO, |sum, &number| match &lights.lights[number as usize] {
        Light::Environment(e) if lights.shines(number, lambda) => sum + e.radiance(ray.origin, ray.direction, lambda),
        _ => sum,
    })
}

//! Shadow rays through media, interfaces and thin panes: Beer–Lambert where a medium is homogeneous, else an estimate
//! by ratio tracking.

use crate::{MAX_PASSES, tracking::Stretch};
use steradian_core::Scene;
use steradian_engine::{Counters, PathContext, Stop};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// Surroundings of a shadow ray.
#[derive(Debug)]
pub struct Shadow<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The wavelengths of the light that it asks for.
    pub lambda: &'a Wavelengths,
    /// Counters of the work.
    pub counters: &'a mut Counters,
}

impl<'a> Shadow<'a> {
    /// The surroundings of a path.
    #[inline]
    pub fn of(context: &'a mut PathContext<'_, '_>) -> Self {
        Shadow { scene: context.scene, lambda: context.lambda, counters: context.counters }
    }

    fn air(&self) -> Air<'_> {
        (self.scene, self.lambda, &self.counters.stop)
    }
}

/// Surroundings within one medium.
pub type Air<'a> = (&'a Scene, &'a Wavelengths, &'a Stop);

/// Transmittance towards a light at a distance, before which `ray` ends: zero behind anything that scatters.
pub fn towards(ray: Ray, distance: f32, (medium, number): (Option<u32>, f32), shadow: &mut Shadow<'_>) -> Spectrum {
    let scene = shadow.scene;
    // Where surfaces may let light pass straight, the way is followed surface by surface.
    if scene.is_see_through() {
        return along(ray, (medium, number), None, false, shadow);
    }
    shadow.counters.rays += 1;
    // Else one visibility test, and one medium for the whole way.
    if scene.occluded(&ray) {
        return Spectrum::ZERO;
    }
    medium.map_or(Spectrum::ONE, |m| passed(m, (&ray, distance), number, shadow.air()))
}

/// Transmittance of a distance through a medium; where the medium varies an estimate of it that is a function of the
/// ray and of a random number.
pub fn passed(medium: u32, (ray, distance): (&Ray, f32), number: f32, (scene, lambda, stop): Air<'_>) -> Spectrum {
    let medium = &scene.media()[medium as usize];
    // Homogeneous: exp(−σt d). Else ratio tracking.
    let Some(field) = &medium.field else { return medium.transmittance(distance, lambda) };
    let mut glow = Spectrum::ZERO;
    Stretch { medium, field, ray, distance, lambda, stop }.estimate_transmittance(scene, number, &mut glow)
}

/// Emission of a medium over a distance, and its transmittance.
fn glowing(m: u32, (ray, distance): (&Ray, f32), number: f32, (scene, lambda, stop): Air<'_>) -> [Spectrum; 2] {
    let medium = &scene.media()[m as usize];
    match &medium.field {
        // ∫ σa Le exp(−σt t) dt in closed form, and exp(−σt d).
        None => [medium.glow_over(distance, lambda), medium.transmittance(distance, lambda)],
        Some(field) => {
            let stretch = Stretch { medium, field, ray, distance, lambda, stop };
            let mut glow = Spectrum::ZERO;
            let passed = stretch.estimate_transmittance(scene, number, &mut glow);
            [glow, passed]
        }
    }
}

/// Transmittance through whatever light passes straight, with `past_hidden` also through emitters that are hidden from
/// the camera. Adds what a medium gives off on the way, where one is given.
pub fn along(
    mut ray: Ray,
    (mut medium, number): (Option<u32>, f32),
    mut glow: Option<(u32, &mut Spectrum)>,
    past_hidden: bool,
    shadow: &mut Shadow<'_>,
) -> Spectrum {
    let (scene, mut t) = (shadow.scene, Spectrum::ONE);
    // Segment by segment: the medium's transmittance to the next surface, then that of the surface.
    for _ in 0..MAX_PASSES {
        if shadow.counters.stop.is_asked() {
            break;
        }
        shadow.counters.rays += 1;
        let hit = scene.intersect(&ray);
        // T ← T Tr of the segment; emission of the medium asked for is added with the T before it.
        if let Some(m) = medium {
            let distance = hit.as_ref().map_or(ray.t_max, |h| h.t);
            t *= match &mut glow {
                Some((of, sum)) if *of == m => {
                    let [given_off, passed] = glowing(m, (&ray, distance), number, shadow.air());
                    **sum += t * given_off;
                    passed
                }
                _ => passed(m, (&ray, distance), number, shadow.air()),
            };
            if t.is_black() {
                return t;
            }
        }
        // Nothing more in the way: the light arrives with what is left.
        let Some(hit) = hit else { return t };
        let i = scene.interaction_of_light(&ray, &hit);
        // Interfaces pass everything, thin panes a part; what bends or stops light blocks the way.
        if !(past_hidden && scene.is_passed_when_hidden(i.geometry))
            && let Some((s, frame)) = scene.scattering(&i, 0.5, &mut shadow.lambda.clone())
        {
            match s.bsdf.straight_transmission(frame.to_local(i.wo)) {
                Some(part) => t *= part,
                None => return Spectrum::ZERO,
            }
        }
        // On in the medium behind the surface, for the rest of the distance.
        medium = scene.medium_towards(&i, ray.direction, medium);
        let next = i.spawn(ray.direction);
        // What is left of the way.
        let left = ray.t_max - (next.origin - ray.origin).length();
        if left <= 0.0 {
            return t;
        }
        ray = Ray { t_max: left, ..next };
    }
    Spectrum::ZERO
}

//! Visible point of a pixel of a preview: the first surface that scatters light diffusely or glossily, and the light
//! added to its own.

use crate::{
    shading::{CameraPath, MOST_PASSED, Numbers, Point, Shader},
    trace::Trace,
};
use steradian_bsdf::{BsdfSample, TransportMode};
use steradian_core::scene::Interaction;
use steradian_math::{Spectrum, Vec2, spectra::Wavelengths};
use steradian_transport::nee;

/// Reflections that carry less than this are left out.
const LEAST_REFLECTION: f32 = 0.01;
/// The largest random number.
const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

/// The end of a pixel's ray.
pub struct Look<'a> {
    /// Light that does not come from the surface: emission, the background, reflections of glass and coats.
    pub aside: Spectrum,
    /// The surface that scatters.
    pub point: Option<Point<'a>>,
    /// Distance of the point, along the path.
    pub distance: f32,
}

/// Follows a pixel's ray past interfaces, mirrors and glass to the first surface that scatters otherwise. Where light
/// can go two ways, both are taken once, by `reflections`, and then the one that carries more: pictures of glass have
/// no noise. Without `reflections` only the latter is taken.
pub fn look<'a>(
    shader: &Shader<'a>,
    reflections: Option<&Shader<'a>>,
    mut path: CameraPath,
    numbers: &'a Numbers,
    lambda: &mut Wavelengths,
    trace: &mut Trace<'_>,
) -> Look<'a> {
    let scene = shader.scene;
    let mut look = Look { aside: Spectrum::ZERO, point: None, distance: 0.0 };
    for round in 0..shader.options.bounces + MOST_PASSED {
        // Where the path left the scene its background counts, once.
        let CameraPath { ray, hit, beta, .. } = path;
        let Some(found) = hit else {
            if path.sees_lights {
                look.aside += shader.background(&ray, path.events, beta, lambda, trace);
            }
            return look;
        };
        let i = scene.interaction_of_light(&ray, &found);
        look.distance += i.t;
        // Emission counts along specular paths, and of what no light sample finds.
        if path.sees_lights || (path.events > 0 && scene.light(&i).is_none()) {
            look.aside += shader.emission(&i, beta, lambda, trace);
        }
        let choice = numbers.get_2d(1 + 8 * round, shader.pass).x;
        let surface = match path.passes_straight(scene, &i) {
            true => None,
            false => scene.scattering_along(&i, path.differential.as_ref(), choice, lambda),
        };
        match surface {
            // Pass interfaces straight on and advance the footprint.
            None => {
                path.differential = path.differential.map(|d| d.advance(i.t));
                path.ray = i.rest(&ray);
            }
            Some(_) if path.events >= shader.depth.max => return look,
            // Evaluate the surface and ask which specular ways lead on from it.
            Some((scattering, frame)) => {
                let ctx = nee::context(&i, &frame, &scattering.bsdf);
                let point = Point { i, frame, scattering, ctx, lambda: *lambda, beta, numbers, round };
                let (on, beside) = ways(&point);
                // At the first specular surface follow the weaker way once with a path of its own.
                if let (Some(s), Some(shader), 0) = (beside, reflections, path.events) {
                    look.aside += reflected(shader, &point, &s, path, lambda, trace);
                }
                // A surface that scatters otherwise ends the walk.
                if !point.scattering.bsdf.is_specular() {
                    look.point = Some(point);
                    return look;
                }
                let Some(s) = on.filter(|_| path.events < shader.options.bounces) else { return look };
                path = shader.extended(&point, &s, path);
            }
        }
        trace.pixel = None;
        if trace.counters.stop.is_asked() {
            return look;
        }
        path.hit = trace.nearest(scene, &path.ray);
    }
    look
}

/// Specular samples at a point: the one of largest weight, which is followed where nothing else scatters, and the
/// other. The choice between lobes is made by the first random number, in proportion to their weights: its ends take
/// both.
fn ways(point: &Point<'_>) -> (Option<BsdfSample>, Option<BsdfSample>) {
    let wo = point.frame.to_local(point.i.wo);
    let draw = |u| {
        let drawn = point.scattering.sample(wo, u, Vec2::splat(0.5), TransportMode::Radiance);
        drawn.filter(|s| s.lobe.is_specular())
    };
    let carried = |s: &BsdfSample| BsdfSample { weight: s.weight * s.pdf, ..*s };
    match (draw(0.0), draw(LAST)) {
        (Some(a), Some(b)) if a.lobe == b.lobe => (Some(a), None),
        // Undo the division by the probability of the choice: both ways are taken with certainty.
        (Some(a), Some(b)) => {
            let (a, b) = (carried(&a), carried(&b));
            let is_first = a.weight.max_element() >= b.weight.max_element();
            if is_first { (Some(a), Some(b)) } else { (Some(b), Some(a)) }
        }
        // Beside what scatters otherwise.
        (a, b) => (None, a.or(b).map(|s| carried(&s))),
    }
}

/// Light seen in a reflection, or through a pane.
fn reflected(
    shader: &Shader<'_>,
    point: &Point<'_>,
    s: &BsdfSample,
    path: CameraPath,
    lambda: &mut Wavelengths,
    trace: &mut Trace<'_>,
) -> Spectrum {
    if s.weight.max_element() < LEAST_REFLECTION {
        return Spectrum::ZERO;
    }
    // The reflection takes its own random numbers, by the next round.
    let path = shader.extended(point, s, CameraPath { round: point.round + 1, ..path });
    trace.pixel = None;
    let hit = trace.nearest(shader.scene, &path.ray);
    shader.follow(CameraPath { hit, ..path }, point.numbers, lambda, trace)
}

/// Tells objects apart, and what is seen of them straight from what is seen in mirrors.
pub fn object(i: &Interaction, round: u32) -> u32 {
    i.geometry ^ (i.id.instance.wrapping_add(1) ^ (round << 24)).wrapping_mul(0x9e37_79b9)
}

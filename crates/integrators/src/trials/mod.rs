//! Trials: before a picture a few of its samples tell which means against noise pay.
//!
//! Trials run in the first step of a session, on its own threads. They can be cancelled, and their time counts. Renders
//! of at least 2¹⁸ samples spend about a thirtieth of them on effort: `splitting` makes a sample in some cells of the
//! picture the mean of two or four paths, and where paths share, `effort` selects one to four light samples for each
//! vertex and the roulette threshold. `caustics` decides about photons; `sharing` selects the size of groups, if asked.

pub(crate) mod caustics;
mod effort;
mod probe;
mod sharing;
mod splitting;

use crate::{
    Plan, Stop, VarianceReduction, caustics::Caustics, guiding::Guides, path::PathTracer, precomputed::Precomputed,
};
use steradian_core::Scene;
use steradian_math::{Frame, Vec2, sobol, warp};

/// Photons are asked from this [`caustics::Outcome::gain`] on: they cost time, and paths that are shared err less than
/// those of the trial.
const WORTH: f64 = 1.8;

/// Pictures of fewer samples have no trials of sharing, effort and splitting, which take a thirtieth of so many each.
const FEWEST: u64 = 1 << 18;

/// Runs the trials of a scene, for the paths and pictures of a plan.
pub(crate) fn run<const MEDIA: bool>(
    scene: &Scene,
    path: &PathTracer<MEDIA>,
    variance_reduction: &VarianceReduction,
    plan: &Plan,
    stop: &Stop,
) -> Precomputed {
    // Such paths share nothing, and photons do not guide them.
    if path.depth.max <= 1 || scene.needs_scalar_path_tracer() {
        return Precomputed::default();
    }
    // 1. Photons, and by a trial whether they pay.
    let guides = Guides { caustics: Caustics::new(scene, stop), field: None };
    let mut precomputed = Precomputed { guides, stop: stop.clone(), ..Precomputed::default() };
    // Where they are not wanted they still tell what the picture lacks.
    if precomputed.guides.caustics.is_some() && variance_reduction.caustics != Some(true) {
        let outcome = caustics::trial(scene, path, &precomputed);
        if variance_reduction.caustics == Some(false) || outcome.gain < WORTH {
            precomputed.guides.caustics = None;
            precomputed.rarest_path_probability = outcome.rarest_path_probability;
        }
    }
    let samples = u64::from(scene.film().width) * u64::from(scene.film().height) * u64::from(plan.sampler.spp);
    // 2. A field of directions, by training, and whether it pays.
    if variance_reduction.guiding != Some(false) {
        let before = precomputed.guides.clone();
        precomputed.guides = before.clone().trained(scene, path, samples, stop);
        let pays = |guided: &Precomputed| caustics::trial(scene, path, guided).gain >= WORTH;
        if variance_reduction.guiding.is_none() && precomputed.guides.field.is_some() && !pays(&precomputed) {
            precomputed.guides = before;
        }
    }
    // 3. The size of groups, by request, by rule or by a trial.
    let is_open = !(MEDIA && scene.has_media()) && is_open(scene, stop);
    // Densities of ways through media that vary are not known, which sharing would need.
    let varies = MEDIA && scene.media().iter().any(|m| m.field.is_some());
    precomputed.group = match variance_reduction.reuse {
        _ if varies => 1,
        Some(group) => group,
        None if samples < FEWEST => 1,
        None => sharing::trial(path, scene, &Precomputed { is_open, ..precomputed.clone() }, samples),
    };
    precomputed.is_open = is_open && precomputed.group > 1;
    // 4. Effort; then path splitting, with that effort.
    match variance_reduction.effort {
        Some(effort) => precomputed.effort = effort,
        None if samples < FEWEST => {}
        None => {
            precomputed.effort = effort::trial(path, scene, &precomputed);
            if !plan.adaptive {
                precomputed.splitting = splitting::trial(path, scene, &precomputed, samples);
            }
        }
    }
    precomputed
}

/// True if the sky is met by more than a quarter of the directions from what the camera sees, by a few hundred of them.
fn is_open(scene: &Scene, stop: &Stop) -> bool {
    if scene.lights().environments.is_empty() {
        return false;
    }
    const EDGE: u32 = 16;
    let (mut seen, mut escaped) = (0, 0);
    // One cosine-distributed ray from each of some points that the camera sees.
    for k in (0..EDGE * EDGE).take_while(|_| !stop.is_asked()) {
        let size = Vec2::new(scene.film().width as f32, scene.film().height as f32);
        let place = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
        let ray = scene.camera().ray(scene.film(), place * size, Vec2::splat(0.5));
        let Some(hit) = scene.intersect(&ray) else { continue };
        let i = scene.interaction(&ray, &hit);
        let n = if i.surface.n.dot(i.wo) > 0.0 { i.surface.n } else { -i.surface.n };
        let w =
            Frame::from_z(n).to_world(warp::cosine_hemisphere(Vec2::from(sobol::shuffled_scrambled_sobol_2d(k, 1))));
        seen += 1;
        escaped += u32::from(!scene.occluded(&i.spawn(w)));
    }
    escaped * 4 > seen
}

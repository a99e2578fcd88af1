//! What is found out about a scene before a session.

use crate::{
    Plan, Stop,
    caustics::{Caustics, trial},
    effort::{self, PathEffort},
    reuse::{self, PathContinuation},
    splitting::{self, Splitting},
};
use steradian_core::Scene;
use steradian_math::{Frame, Vec2, sobol, warp};

/// Photons are asked from this [`trial::Outcome::gain`] on: they cost time, and paths that are shared err less than
/// those of the trial.
const WORTH: f64 = 1.8;

/// Pictures of fewer samples have no trials of effort and splitting, which take a thirtieth of so many each.
const FEWEST: u64 = 1 << 20;
/// The same of sharing: nothing is shared where the trial would take a good part of the time.
const FEWEST_SHARING: u64 = 1 << 18;

/// What path tracers do against noise. It changes how much samples err, not their mean.
#[derive(Clone, Copy, Debug, Default)]
pub struct VarianceReduction {
    /// Paths of neighbouring pixels that share what they find: 1 (none do), 4 or 16; `None` where a trial is to tell.
    pub reuse: Option<u32>,
    /// Whether photons look for light behind mirrors and glass beforehand: a gain where such light rules the noise, and
    /// some loss elsewhere. `None` where a trial is to tell.
    pub caustics: Option<bool>,
    /// Light samples and roulette threshold of paths that share, with as many paths everywhere; `None` where trials are
    /// to tell both.
    pub effort: Option<PathEffort>,
}

/// What integrators know beforehand. Of path tracers it decides about how much samples err, not about their mean.
#[derive(Clone, Debug, Default)]
pub struct Precomputed {
    /// How many paths share what they find; none where it is zero.
    pub(crate) group: u32,
    /// Whether much of what the camera sees lies under the sky, and paths share.
    pub is_open: bool,
    /// Where light lands that mirrors and glass focused.
    pub caustics: Option<Caustics>,
    /// How often one path of the picture finds what the rarest paths bring that carry a good part of the light, as far
    /// as a trial of photons showed.
    pub rarest: Option<f64>,
    /// Light samples and roulette threshold.
    pub effort: PathEffort,
    /// Path splitting per cell.
    pub splitting: Splitting,
    /// Whether paths are to end at once.
    pub stop: Stop,
}

impl Precomputed {
    /// Of a scene, for paths of a depth, and the pictures of a plan.
    pub(crate) fn new<const MEDIA: bool, S: PathContinuation<MEDIA>>(
        scene: &Scene,
        paths: &S,
        plan: &Plan,
        stop: &Stop,
    ) -> Self {
        let (depth, variance_reduction) = (paths.depth(), paths.variance_reduction());
        if depth.max <= 1 {
            return Self::default();
        }
        let mut precomputed = Self { caustics: Caustics::new(scene, stop), stop: stop.clone(), ..Self::default() };
        // Where they are not wanted they still tell what the picture lacks.
        if precomputed.caustics.is_some() && variance_reduction.caustics != Some(true) {
            let outcome = trial::trial::<MEDIA>(scene, &precomputed, depth);
            if variance_reduction.caustics == Some(false) || outcome.gain < WORTH {
                precomputed.caustics = None;
                precomputed.rarest = outcome.rarest;
            }
        }
        let samples = u64::from(scene.film.width) * u64::from(scene.film.height) * u64::from(plan.sampler.spp);
        let is_open = !(MEDIA && scene.has_media) && is_open(scene);
        // Densities of ways through media that vary are not known, which sharing would need.
        let varies = MEDIA && scene.media.iter().any(|m| m.field.is_some());
        precomputed.group = match variance_reduction.reuse {
            _ if varies => 1,
            Some(group) => group,
            None if samples < FEWEST_SHARING => 1,
            None => reuse::trial::trial(paths, scene, &Self { is_open, ..precomputed.clone() }, samples),
        };
        precomputed.is_open = is_open && precomputed.group > 1;
        match variance_reduction.effort {
            Some(effort) => precomputed.effort = effort,
            None if samples < FEWEST => {}
            None => {
                precomputed.effort = effort::trial(paths, scene, &precomputed);
                if !plan.adaptive {
                    precomputed.splitting = splitting::trial(paths, scene, &precomputed, samples);
                }
            }
        }
        precomputed
    }

    /// How many paths share what they find: 1 where none do.
    pub fn reuse(&self) -> u32 {
        self.group.max(1)
    }
}

/// Whether the sky is met by more than a quarter of the directions from what the camera sees, by a few hundred of them.
fn is_open(scene: &Scene) -> bool {
    if scene.lights.environments.is_empty() {
        return false;
    }
    const EDGE: u32 = 16;
    let (mut seen, mut escaped) = (0, 0);
    for k in 0..EDGE * EDGE {
        let size = Vec2::new(scene.film.width as f32, scene.film.height as f32);
        let place = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
        let ray = scene.camera.ray(&scene.film, place * size, Vec2::splat(0.5));
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

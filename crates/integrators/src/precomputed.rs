//! Prepared data of path tracers: group size, photons, effort, and path splitting.

use crate::{Plan, Stop, guiding::Guides};
use steradian_core::film::LayerInputs;
use steradian_request::MethodRequest;

/// Variance reduction of path tracers. It changes the error of samples, not their mean.
#[derive(Clone, Copy, Debug, Default)]
pub struct VarianceReduction {
    /// Paths of neighbouring pixels that share what they find: 1 (none do), 4 or 16; `None` where a trial is to tell.
    pub reuse: Option<u32>,
    /// Enables guiding by photons from behind mirrors and glass: a gain where such light rules the noise, and some loss
    /// elsewhere. `None` where a trial is to tell.
    pub caustics: Option<bool>,
    /// Enables guiding by what paths of a training found. `None` where the training is to tell.
    pub guiding: Option<bool>,
    /// Light samples and roulette threshold of paths that share, with as many paths everywhere; `None` where trials are
    /// to tell both.
    pub effort: Option<PathEffort>,
}

impl VarianceReduction {
    /// Settings by the options; `auto` leaves a choice to trials.
    pub fn of(options: &MethodRequest) -> Self {
        Self {
            reuse: options.word("reuse").parse().ok(),
            caustics: options.word("caustics").parse().ok(),
            guiding: options.word("guiding").parse().ok(),
            effort: (options.word("effort") == "even").then(PathEffort::default),
        }
    }

    /// Restricts it to a plan: light is kept apart by groups or bounces by paths that share nothing and take one light
    /// sample each, and errors of pixels are independent where nothing is shared.
    pub(crate) fn by(self, plan: &Plan) -> Self {
        if plan.has(LayerInputs::LIGHT_GROUPS) || plan.has(LayerInputs::BOUNCES) {
            return Self { reuse: Some(1), effort: Some(PathEffort::default()), ..self };
        }
        Self { reuse: self.reuse.or(plan.independent.then_some(1)), ..self }
    }
}

/// Light samples and roulette threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathEffort {
    /// Light samples at x.
    pub lights: u32,
    /// The throughput, from y on, below which roulette is played from the first event on; `None` for the rule of all
    /// paths.
    pub roulette_below: Option<f32>,
}

impl Default for PathEffort {
    fn default() -> Self {
        Self { lights: 1, roulette_below: None }
    }
}

/// Path splitting: number of paths that a sample is the mean of, by parts of the picture.
#[derive(Clone, Debug, Default)]
pub struct Splitting {
    /// By rows of squares; empty where one is enough everywhere.
    pub paths: Vec<u8>,
    /// Squares of a row.
    pub columns: u32,
    /// Edge of the squares, pixels.
    pub edge: u32,
}

impl Splitting {
    /// Number of paths of each sample of a pixel.
    pub fn paths(&self, [x, y]: [u32; 2]) -> u32 {
        if self.paths.is_empty() {
            1
        } else {
            self.paths[(y / self.edge * self.columns + x / self.edge) as usize].into()
        }
    }
}

/// Prepared data of integrators. For path tracers it decides about the error of samples, not about their mean.
#[derive(Clone, Debug, Default)]
pub struct Precomputed {
    /// Number of paths that share; 0 or 1 for none.
    pub group: u32,
    /// True if much of what the camera sees lies under the sky, and paths share.
    pub is_open: bool,
    /// Guides of directions.
    pub guides: Guides,
    /// Probability that one camera sample finds the rarest paths that carry a good part of the light, as far as a trial
    /// of photons showed.
    pub rarest_path_probability: Option<f64>,
    /// Light samples and roulette threshold.
    pub effort: PathEffort,
    /// Path splitting per cell.
    pub splitting: Splitting,
    /// Cancellation flag.
    pub stop: Stop,
}

impl Precomputed {
    /// Number of paths that share: 1 where none do.
    pub fn reuse(&self) -> u32 {
        self.group.max(1)
    }

    /// The guides, if there are any.
    #[inline]
    pub(crate) fn guide(&self) -> Option<&Guides> {
        (!self.guides.is_empty()).then_some(&self.guides)
    }
}

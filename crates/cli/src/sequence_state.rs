//! State that pictures of a sequence hand on.

use crate::denoise::Filter;
use steradian::{
    History, Render,
    denoise::{Outcome, Sequence},
    image::Image,
};

/// State that a picture of a sequence leaves to the next one.
#[derive(Debug, Default)]
pub struct SequenceState {
    /// History of its method.
    pub history: Option<History>,
    /// Exposure in stops, and its reason.
    pub exposure: Option<(f32, &'static str)>,
    /// State of its denoiser, and the number of frames that this has seen.
    pub denoiser: Option<(Sequence, u64)>,
}

impl SequenceState {
    /// Begins a picture, which is to be denoised with those before where it `is_temporal`: their noise is to differ.
    pub fn begin(&mut self, is_temporal: bool, render: &mut Render) {
        if is_temporal {
            let (_, frames) = self.denoiser.get_or_insert_default();
            render.plan.sampler.seed = render.plan.sampler.seed.wrapping_add(*frames);
        }
    }

    /// A picture without its noise, by a filter, or with what is known of those before.
    pub fn denoised(&mut self, noisy: &Image, filter: &Filter) -> Result<Outcome, steradian::Error> {
        match &mut self.denoiser {
            Some((sequence, frames)) => {
                *frames += 1;
                sequence.picture(noisy)
            }
            None => filter.picture(noisy, None),
        }
    }
}

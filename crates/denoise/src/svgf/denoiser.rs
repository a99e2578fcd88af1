//! Frame after frame.

use super::{
    accumulate::{Accumulated, accumulate},
    atrous::{Estimate, filter},
    reproject::Before,
    settings::Settings,
    surface::Surface,
    term::{Filtered, Term},
    variance::variance,
};
use crate::{
    error::Result,
    gbuffer::{GBuffer, check_size},
    image::Image,
};

/// Filters frame after frame, and keeps what was seen in those before.
#[derive(Clone, Debug)]
pub struct Denoiser {
    settings: Settings,
    /// The surfaces of the frame before.
    surfaces: Option<Image<Surface>>,
    /// The history of each term.
    histories: Vec<Image<Accumulated>>,
}

impl Denoiser {
    /// Without history.
    ///
    /// # Errors
    /// Where a setting is outside its range.
    pub fn new(settings: Settings) -> Result<Self> {
        settings.check()?;
        Ok(Self { settings, surfaces: None, histories: Vec::new() })
    }

    /// Its settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Forgets all frames: the next one begins anew, as after a cut.
    pub fn forget(&mut self) {
        self.surfaces = None;
        self.histories.clear();
    }

    /// Filters the terms of a frame. Each continues the term at its place in the frame before; more terms than there
    /// were begin anew, and so do all where the frame has another size. Uses the rayon pool it is called in; the result
    /// does not depend on the number of threads.
    ///
    /// # Errors
    /// Where images have different sizes, or no pixels. Histories stay as they were.
    pub fn frame(&mut self, terms: &[Term<'_>], gbuffer: &GBuffer) -> Result<Vec<Filtered>> {
        gbuffer.check()?;
        terms.iter().try_for_each(|term| check_size("radiance", term.radiance.size(), gbuffer.size()))?;
        if self.surfaces.as_ref().is_some_and(|surfaces| surfaces.size() != gbuffer.size()) {
            self.forget();
        }
        let surfaces = Surface::all(gbuffer);
        let histories = std::mem::take(&mut self.histories);
        let (filtered, histories) = (0..terms.len())
            .map(|i| {
                let accumulated = histories.get(i);
                let before = self.surfaces.as_ref().zip(accumulated);
                let before = before.map(|(surfaces, accumulated)| Before { accumulated, surfaces });
                self.term(&terms[i], gbuffer, &surfaces, before)
            })
            .unzip();
        (self.surfaces, self.histories) = (Some(surfaces), histories);
        Ok(filtered)
    }

    /// Filters a term, and gives the next frame's history of it.
    fn term(
        &self,
        term: &Term<'_>,
        gbuffer: &GBuffer,
        surfaces: &Image<Surface>,
        before: Option<Before<'_>>,
    ) -> (Filtered, Image<Accumulated>) {
        let settings = &self.settings;
        let [width, height] = gbuffer.size();
        let (samples, left_out) = term.samples(gbuffer);
        let mut accumulated = accumulate(&samples, gbuffer, surfaces, before, settings);
        let mut estimates = Image::by_rows(width, height, |x, y| {
            let Accumulated { color, length, .. } = accumulated.at(x, y);
            let variance = variance(&accumulated, surfaces, [x, y], settings);
            if length > 0 { Estimate::new(color, variance) } else { Estimate::unknown(variance) }
        });
        for iteration in 0..settings.iterations {
            estimates = filter(&estimates, surfaces, iteration, settings);
            if iteration == 0 {
                let colors = estimates.values().iter().map(|estimate| estimate.color);
                accumulated.values_mut().iter_mut().zip(colors).for_each(|(history, color)| history.color = color);
            }
        }
        let filtered = Filtered {
            radiance: Image::by_rows(width, height, |x, y| estimates.at(x, y).color * term.factor(gbuffer, x, y)),
            variance: Image::by_rows(width, height, |x, y| estimates.at(x, y).variance),
            history: Image::by_rows(width, height, |x, y| accumulated.at(x, y).length),
            left_out,
        };
        (filtered, accumulated)
    }
}

//! Frame after frame.

use steradian_accel::Lanes;

use super::{
    accumulate::{accumulate, keep},
    atrous::filter,
    estimates::Estimates,
    geometry::Geometry,
    history::History,
    settings::Settings,
    surface::Surface,
    term::{Filtered, Term},
    variance::{REACH, variances},
};
use crate::{
    error::Result,
    gbuffer::{GBuffer, check_size},
};

/// Filters frame after frame, and keeps what was seen in those before.
#[derive(Clone, Debug)]
pub struct Denoiser {
    settings: Settings,
    lanes: Lanes,
    history: Option<History>,
    /// Buffers of the frame before, kept so that memory is not allocated anew.
    estimates: Option<[Estimates; 2]>,
}

impl Denoiser {
    /// Without history.
    ///
    /// # Errors
    /// Where a setting is outside its range.
    pub fn new(settings: Settings) -> Result<Self> {
        settings.check()?;
        Ok(Self { settings, lanes: Lanes::best(), history: None, estimates: None })
    }

    /// Its settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Forgets all frames: the next one begins anew, as after a cut.
    pub fn forget(&mut self) {
        self.history = None;
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
        if self.history.as_ref().is_some_and(|history| history.surfaces.size() != gbuffer.size()) {
            self.forget();
        }
        let (size, margin) = (gbuffer.size(), self.margin(gbuffer.size()[0]));
        let how = (self.lanes, &self.settings);
        let surfaces = Surface::all(gbuffer);
        // Edge-stopping geometry in columns, with a margin that the widest gap reaches.
        let geometry = Geometry::new(&surfaces, margin);
        // Reuse the buffers of the frame before where they fit.
        let [mut estimates, mut filtered] = self
            .estimates
            .take()
            .filter(|[all, _]| all.are_of(size, terms.len()))
            .unwrap_or_else(|| [(), ()].map(|()| Estimates::unknown(size, terms.len(), margin)));
        let before = self.history.as_ref();
        // Temporal accumulation, then the variance that guides the spatial filter.
        let mut accumulated = accumulate((terms, gbuffer), &surfaces, before, &self.settings, &mut estimates);
        variances(&accumulated, &mut estimates, &geometry, how);
        // Means of histories and this frame, before filtering: their mean over the picture is kept.
        let noisy = self.settings.keeps_mean.then(|| estimates.colors());
        for iteration in 0..self.settings.iterations {
            filter(&estimates, &mut filtered, &geometry, iteration, how);
            std::mem::swap(&mut estimates, &mut filtered);
            if iteration == 0 {
                keep(&estimates.balanced(noisy.as_deref()), &mut accumulated);
            }
        }
        // Balance the outcome, and multiply the albedo back term by term.
        let balanced = estimates.balanced(noisy.as_deref());
        let result = terms.iter().zip(&balanced).enumerate();
        let result = result.map(|(i, (term, colors))| term.filtered(i, gbuffer, (colors, &estimates), &accumulated));
        let result = result.collect();
        self.history = Some(History { surfaces, accumulated });
        self.estimates = Some([estimates, filtered]);
        Ok(result)
    }

    /// Margin in columns, so wide that no tap of a filter is beyond it: none that is in the picture, at least.
    fn margin(&self, width: u32) -> usize {
        let filter = 1 << self.settings.iterations;
        filter.min(width as usize).max(REACH)
    }
}

#[cfg(test)]
mod tests {
    use steradian_accel::Isa;
    use steradian_math::{Vec2, Vec3};

    use super::*;
    use crate::image::Image;

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let (width, height) = (150, 40);
        let wave = |x: u32, y: u32, k: u32| ((x * 7 + y * 13 + k * 31) % 101) as f32 / 101.0;
        let gbuffer = GBuffer {
            depth: Image::from_fn(width, height, |x, y| 3.0 + 0.01 * wave(x, y, 1)),
            depth_gradient: Image::filled(width, height, Vec2::splat(0.003)),
            previous_depth: Image::filled(width, height, 3.0),
            normal: Image::from_fn(width, height, |x, y| Vec3::new(0.1 * wave(x, y, 2), 0.0, 1.0).normalize()),
            albedo: Image::filled(width, height, Vec3::splat(0.7)),
            id: Image::from_fn(width, height, |x, _| x / 70),
            motion: Image::filled(width, height, Vec2::new(0.25, -0.5)),
        };
        let found = Isa::ALL.map(|isa| {
            let mut denoiser = Denoiser { lanes: Lanes::of(isa), ..Denoiser::new(Settings::default()).unwrap() };
            let mut bits = Vec::new();
            for n in 0..6 {
                let radiance = Image::from_fn(width, height, |x, y| Vec3::new(wave(x, y, n), wave(y, x, n), 0.5));
                let filtered = denoiser.frame(&[Term { radiance: &radiance, has_albedo: true }], &gbuffer).unwrap();
                bits.extend(filtered[0].radiance.values().iter().map(|color| color.to_array().map(f32::to_bits)));
                bits.extend(filtered[0].variance.values().iter().map(|variance| [variance.to_bits(); 3]));
            }
            bits
        });
        assert!(found.iter().all(|bits| *bits == found[0]));
    }
}

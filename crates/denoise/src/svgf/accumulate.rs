//! Means over time.

use rayon::prelude::*;
use steradian_math::{Vec2, Vec3};

use super::{
    estimates::Estimates, history::History, reproject::Former, settings::Settings, surface::Surface, term::Term,
};
use crate::{gbuffer::GBuffer, image::Image, rows::Rows};

/// Means over the frames of a pixel's history.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Accumulated {
    pub color: Vec3,
    /// Means of luminance and of its square.
    pub moments: Vec2,
    /// Frames; 0 where there is no value yet.
    pub length: u32,
}

/// Adds the newest frame's samples to their histories: section 4.1. `estimates` take the colours.
pub(super) fn accumulate(
    (terms, gbuffer): (&[Term<'_>], &GBuffer),
    surfaces: &Image<Surface>,
    before: Option<&History>,
    settings: &Settings,
    estimates: &mut Estimates,
) -> Rows<Accumulated> {
    let luminance = estimates.luminance;
    let mut all = Rows::filled(gbuffer.size(), &vec![Accumulated::default(); terms.len()], 0);
    // Rows in parallel: reproject each pixel once for all terms.
    all.par_rows().zip(estimates.rows.par_rows()).for_each(|((y, mut row), (_, mut estimates))| {
        for x in 0..gbuffer.size()[0] {
            let surface = surfaces.at(x, y as u32);
            let former = before.map(|before| Former::of(&before.surfaces, gbuffer, &surface, x, y as u32));
            for (number, term) in terms.iter().enumerate() {
                let before = before.map(|before| &before.accumulated).filter(|before| number < before.planes());
                let history = before.zip(former).and_then(|(before, former)| former.history(before, number));
                let pixel = Pixel { term, gbuffer, surfaces, at: [x, y as u32], luminance };
                let accumulated = pixel.accumulate(history, settings);
                row.set(number, x as usize, accumulated);
                let Accumulated { color, length, .. } = accumulated;
                // A value that is missing is marked by its luminance, for the filter to fill in.
                let luminance = if length > 0 { luminance.dot(color) } else { f32::NAN };
                Estimates::set_color(&mut estimates, number, x as usize, color, luminance);
            }
        }
    });
    all
}

/// Makes histories of the colours of all terms, where there are any.
pub(super) fn keep(colors: &[Image<Vec3>], accumulated: &mut Rows<Accumulated>) {
    accumulated.par_rows().for_each(|(y, mut row)| {
        for (term, colors) in colors.iter().enumerate() {
            for x in 0..colors.width() {
                let color = colors.at(x, y as u32);
                // Pixels still without a value leave their history as it is.
                if !color.is_nan() {
                    row.get_mut(term, x as usize).color = color;
                }
            }
        }
    });
}

/// A pixel of a term.
struct Pixel<'a> {
    term: &'a Term<'a>,
    gbuffer: &'a GBuffer,
    surfaces: &'a Image<Surface>,
    at: [u32; 2],
    /// The weights of colours in luminance.
    luminance: Vec3,
}

impl Pixel<'_> {
    /// Adds its sample to its history.
    fn accumulate(&self, mut history: Option<Accumulated>, settings: &Settings) -> Accumulated {
        // Clamp the history first, where the light may have changed.
        if let (true, Some(history)) = (settings.clamp_history, &mut history) {
            self.clamp(history);
        }
        // Blend history and sample; either alone where the other is missing.
        match (history, self.term.sample(self.gbuffer, self.at)) {
            (Some(history), Some(sample)) => self.add(history, sample, settings),
            (Some(history), None) => history,
            (None, Some(color)) => Accumulated { color, moments: self.moments(color), length: 1 },
            (None, None) => Accumulated::default(),
        }
    }

    /// Limits a history to the box of the samples of its object around the pixel.
    fn clamp(&self, history: &mut Accumulated) {
        let ([x, y], [width, height]) = (self.at, self.gbuffer.size());
        // Bounds of the samples of the same object in the 3×3 pixels around (Karis 2014).
        let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for j in y.saturating_sub(1)..(y + 2).min(height) {
            for i in x.saturating_sub(1)..(x + 2).min(width) {
                let is_same = self.surfaces.at(i, j).id == self.surfaces.at(x, y).id;
                if let Some(sample) = self.term.sample(self.gbuffer, [i, j]).filter(|_| is_same) {
                    (least, most) = (least.min(sample), most.max(sample));
                }
            }
        }
        if least.x <= most.x {
            history.color = history.color.max(least).min(most);
        }
    }

    fn add(&self, history: Accumulated, sample: Vec3, settings: &Settings) -> Accumulated {
        let length = history.length.saturating_add(1);
        // c = lerp(c_history, c_frame, max(α, 1/n)): a plain mean at first, then an exponential one (section 4.1).
        let weight = |least: f32| least.max(1.0 / length as f32);
        Accumulated {
            color: history.color.lerp(sample, weight(settings.alpha)),
            moments: history.moments.lerp(self.moments(sample), weight(settings.moments_alpha)),
            length,
        }
    }

    fn moments(&self, sample: Vec3) -> Vec2 {
        // Raw moments of luminance: μ₁ = l, μ₂ = l².
        let luminance = self.luminance.dot(sample);
        Vec2::new(luminance, luminance * luminance)
    }
}

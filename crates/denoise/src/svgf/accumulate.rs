//! Means over time.

use steradian_math::{Vec2, Vec3, color::luminance};

use super::{reproject::Before, settings::Settings, surface::Surface};
use crate::{gbuffer::GBuffer, image::Image, kernel::visit};

/// Means over the frames of a pixel's history.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Accumulated {
    pub color: Vec3,
    /// Of luminance and its square.
    pub moments: Vec2,
    /// Frames; 0 where there is no value yet.
    pub length: u32,
}

/// Adds the newest frame's samples, NaN where they are left out, to their histories: section 4.1.
pub(super) fn accumulate(
    samples: &Image<Vec3>,
    gbuffer: &GBuffer,
    surfaces: &Image<Surface>,
    before: Option<Before<'_>>,
    settings: &Settings,
) -> Image<Accumulated> {
    let [width, height] = samples.size();
    Image::by_rows(width, height, |x, y| {
        let sample = Some(samples.at(x, y)).filter(|sample| !sample.is_nan());
        let mut history = before.and_then(|before| before.history(gbuffer, &surfaces.at(x, y), x, y));
        if let (true, Some(history)) = (settings.clamp_history, &mut history) {
            clamp(history, samples, surfaces, [x, y]);
        }
        match (history, sample) {
            (Some(history), Some(sample)) => add(history, sample, settings),
            (Some(history), None) => history,
            (None, Some(color)) => Accumulated { color, moments: moments_of(color), length: 1 },
            (None, None) => Accumulated::default(),
        }
    })
}

fn add(history: Accumulated, sample: Vec3, settings: &Settings) -> Accumulated {
    let length = history.length.saturating_add(1);
    let weight = |least: f32| least.max(1.0 / length as f32);
    Accumulated {
        color: history.color.lerp(sample, weight(settings.alpha)),
        moments: history.moments.lerp(moments_of(sample), weight(settings.moments_alpha)),
        length,
    }
}

fn moments_of(sample: Vec3) -> Vec2 {
    let luminance = luminance(sample);
    Vec2::new(luminance, luminance * luminance)
}

/// Limits a history to the box of the samples of its object around a pixel.
fn clamp(history: &mut Accumulated, samples: &Image<Vec3>, surfaces: &Image<Surface>, pixel: [u32; 2]) {
    let id = surfaces.at(pixel[0], pixel[1]).id;
    let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    visit(&[1.0; 3], pixel, samples.size(), 1, |tap| {
        let sample = samples.values()[tap.place];
        if surfaces.values()[tap.place].id == id && !sample.is_nan() {
            (least, most) = (least.min(sample), most.max(sample));
        }
    });
    if least.x <= most.x {
        history.color = history.color.max(least).min(most);
    }
}

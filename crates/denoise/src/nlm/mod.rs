//! Finished pictures: first-order regressions weighted by the noise of pixels and by the surfaces that they show.
//!
//! Windows are fitted by lines in place, normal and albedo, and overlap; a pixel is the mean of what all windows over
//! it tell (`regression`). Pixels of a window weigh by how alike their colours are to its centre's beyond what noise
//! explains, as in non-local means, and how alike the surfaces are (Bitterli and others, "Nonlinearly Weighted
//! First-order Regression for Denoising Monte Carlo Renderings", EGSR 2016; distances after Rousselle, Manzi, Zwicker,
//! "Robust Denoising using Feature and Color Information", Pacific Graphics 2013, sections 3 and 4).
//!
//! Departures from both: colours of single pixels of a guide are compared in place of patches, since its noise is low:
//! in the first pass it is the mean over 3×3 pixels, in the second the outcome of the first; surfaces weigh as well;
//! weights fall to nothing at the rim of the window; the variance of a pixel that tells others what it may be is held
//! to four times theirs, since a rare bright path would else be alike to all; colours are divided by the albedo
//! meanwhile; pixels far brighter than all around are held back before (`fireflies`); the light that was lost is
//! given back; one filter is used instead of a choice among several. Frames of an animation are filtered with what
//! those before saw by [`Sequence`].

mod estimate;
mod features;
mod fireflies;
mod local;
mod picture;
mod plane;
mod regression;
mod sequence;
mod settings;
mod window;

use steradian_accel::Lanes;
use steradian_math::Vec3;

use crate::{
    error::{Error, Result},
    image::Image,
};
use estimate::Estimate;
use features::Features;
pub(crate) use local::calm_variance;
pub use picture::Picture;
use regression::Pass;
pub use sequence::Sequence;
pub use settings::Settings;

/// A picture without most of its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Radiance; finite.
    pub radiance: Image<Vec3>,
    /// Pixels whose radiance was not finite. They have what their neighbours tell.
    pub not_finite: usize,
}

/// Filters a picture. Pixels without a surface stay as they are. Uses the rayon pool it is called in; the bits of the
/// result depend neither on the number of threads nor on the instruction set.
///
/// # Errors
/// Where images have different sizes or no pixels, and where a setting is outside its range.
pub fn denoise(picture: &Picture<'_>, settings: &Settings) -> Result<Denoised> {
    settings.check()?;
    picture.check()?;
    let features = Features::new(picture, settings);
    // Over albedo, with variances smoothed over each surface.
    let noisy = picture.noisy(&features, Lanes::best());
    let radiance = filter_by(&[&noisy, &noisy], &features, settings);
    Ok(picture.finish(&radiance, settings.keeps_mean))
}

/// Filters two pictures of one view with independent noise, such as two renders with different seeds: each with weights
/// that the other tells, so that no pixel's weight follows from its own noise (Rousselle, Knaus, Zwicker, "Adaptive
/// Rendering with Non-Local Means Filtering", SIGGRAPH Asia 2012, section 4). Gives their mean, and the relative error
/// that remains in it, told by their difference: the root of the mean of (a − b)² / 4 over ((a + b)² / 4 + 0.01).
/// Detail that both lost is not in it: it is a lower bound.
///
/// # Errors
/// As [`denoise`], and where the two have different sizes.
pub fn denoise_halves(halves: [&Picture<'_>; 2], settings: &Settings) -> Result<(Denoised, f64)> {
    settings.check()?;
    halves.iter().try_for_each(|half| half.check())?;
    let sizes = halves.map(|half| half.radiance.size());
    if sizes[0] != sizes[1] {
        return Err(Error::Size { what: "the other half", found: sizes[1], expected: sizes[0] });
    }
    // Cross filtering: each half is averaged with weights from the other, whose noise is independent.
    let features = halves.map(|half| Features::new(half, settings));
    let noisy = [0, 1].map(|i| halves[i].noisy(&features[i], Lanes::best()));
    let [a, b] = [0, 1].map(|i| {
        let radiance = filter_by(&[&noisy[1 - i], &noisy[i]], &features[i], settings);
        halves[i].finish(&radiance, settings.keeps_mean)
    });
    // Mean of both, and the relative error from half their difference: Var((a + b)/2) = E((a − b)²)/4.
    let (mut error, mut mean) = (0.0, a.radiance.clone());
    for (place, other) in mean.values_mut().iter_mut().zip(b.radiance.values()) {
        let (half_sum, half_difference) = ((*place + *other) * 0.5, (*place - *other) * 0.5);
        for c in 0..3 {
            let (sum, difference) = (f64::from(half_sum[c]), f64::from(half_difference[c]));
            error += difference * difference / (sum * sum + 0.01);
        }
        *place = half_sum;
    }
    let error = (error / (3 * mean.values().len()) as f64).sqrt();
    Ok((Denoised { radiance: mean, not_finite: a.not_finite.max(b.not_finite) }, error))
}

/// Two passes over `source`, the first guided by `guide`, the second by what the first gave.
fn filter_by([guide, source]: &[&Estimate; 2], features: &Features, settings: &Settings) -> Estimate {
    let lanes = Lanes::best();
    // The first pass gives a pilot estimate, whose noise is far less than that of the picture.
    let first = pilot(guide, features, settings, lanes);
    Pass { guide: &first, source, features, settings }.run(lanes)
}

/// The guide of the second pass: a picture after the first, with the noise that it still has.
fn pilot(noisy: &Estimate, features: &Features, settings: &Settings, lanes: Lanes) -> Estimate {
    let guide = noisy.blurred(features, lanes);
    let first = Pass { guide: &guide, source: noisy, features, settings }.run(lanes);
    first.with_noise_of(noisy, settings.pilot)
}

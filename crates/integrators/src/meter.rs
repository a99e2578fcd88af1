//! Light meters: radiance, irradiance and scalar irradiance at a point, and their photometric counterparts, with
//! confidence intervals.
//!
//! Radiances of a scene are per nanometre: RGB white of 1 is D65 of CIE Y = 1 (a constant spectrum of 1 has Y = 1), so
//! its luminance is 683 lm/W · ∫ȳ dλ = 72 983 cd/m².

pub use crate::receiver::Receiver;

use crate::{Counters, Depth, PathContext, dimension, path::PathTracer};
use rayon::prelude::*;
use steradian_core::{
    ColorMode, Scene,
    sampler::{PixelSampler, Sampler, SamplerKind},
};
use steradian_math::{
    Spectrum, Vec3,
    spectra::{
        Wavelengths,
        photometry::{Quantity, photometric_from_y},
    },
};

/// Independent estimates, of which the spread gives the confidence interval.
pub const REPLICATES: u32 = 32;
/// The 97.5 % quantile of Student's t for 31 degrees of freedom.
const STUDENT: f64 = 2.039_513;
/// Samples at which a measurement that asks for an error ends all the same.
pub const MOST_SAMPLES: u32 = 1 << 26;

/// Settings of a reading.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Samples, rounded up to a multiple of [`REPLICATES`]; where an error is asked for, those to begin with.
    pub samples: u32,
    /// Half-width of the confidence interval of the luminous quantity, relative to it, at which measuring ends.
    pub error: Option<f64>,
    /// Random seed.
    pub seed: u64,
    /// Enables scattering by media.
    pub media: bool,
    /// Path depth; light straight from lights counts as no event.
    pub depth: Depth,
}

/// A value and the half-width of its confidence interval of 95 %.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub value: f64,
    /// Half-width.
    pub plus_minus: f64,
}

/// Reading of a meter.
#[derive(Clone, Debug)]
pub struct Reading {
    /// Measured quantity; scalar irradiance counts as irradiance.
    pub quantity: Quantity,
    /// Linear Rec.709, in units per nanometre ([`Quantity::spectral_unit`]) of D65 of CIE Y = 1.
    pub rgb: [Estimate; 3],
    /// From 360 to 830 nm, in [`Quantity::unit`]; `None` in RGB mode, which knows no spectrum.
    pub radiant: Option<Estimate>,
    /// In [`Quantity::photometric_unit`].
    pub luminous: Estimate,
    /// Samples that were taken.
    pub samples: u32,
    /// Samples that were not finite, and count as black.
    pub nonfinite: u64,
}

/// Sums of one replicate: linear Rec.709, power in W, and CIE Y.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    values: [f64; 5],
    nonfinite: u64,
}

/// Reads a meter. The reading depends on the scene, the receiver and the settings, not on threads.
pub fn read(scene: &Scene, receiver: &Receiver, settings: &Settings) -> Reading {
    let receiver = off_surface(scene, receiver);
    // A meter sees lights.
    let settings = Settings { depth: Depth { hide_emitters: false, ..settings.depth }, ..*settings };
    let mut sums = [Sums::default(); REPLICATES as usize];
    let (mut done, mut asked) = (0, settings.samples.clamp(1, MOST_SAMPLES).div_ceil(REPLICATES));
    loop {
        sums.par_iter_mut().enumerate().for_each(|(k, sums)| {
            for index in done..asked {
                sums.take(scene, &receiver, &settings, (k as u32, index));
            }
        });
        done = asked;
        let reading = reading(scene, &receiver, &sums, done);
        let Estimate { value, plus_minus } = reading.luminous;
        let is_enough = settings.error.is_none_or(|e| plus_minus <= e * value.abs());
        if is_enough || done.saturating_mul(REPLICATES) >= MOST_SAMPLES {
            return reading;
        }
        asked = done * 2;
    }
}

/// One sample of a receiver, linear Rec.709, for what takes the means itself. It depends on the sampler alone; a plane
/// on a surface is to be moved [off](off_surface) it.
pub fn sample(scene: &Scene, receiver: &Receiver, settings: &Settings, sampler: &PixelSampler) -> Vec3 {
    let (light, lambda) = received(scene, receiver, settings, sampler);
    scene.mode().to_rgb(light, &lambda)
}

/// One sample of the light that a receiver takes, and its wavelengths.
fn received(
    scene: &Scene,
    receiver: &Receiver,
    settings: &Settings,
    sampler: &PixelSampler,
) -> (Spectrum, Wavelengths) {
    let mut lambda = scene.mode().wavelengths(|| sampler.get_1d(dimension::WAVELENGTH));
    if scene.is_timed() {
        lambda = lambda.at_time(sampler.get_1d(dimension::TIME));
    }
    // A fluorescent surface changes the wavelengths that the path goes on with, not those that are measured.
    let mut followed = lambda;
    let mut counters = Counters::default();
    let context = &mut PathContext { scene, sampler, lambda: &mut followed, counters: &mut counters };
    let depth = settings.depth;
    let light = match settings.media {
        true => PathTracer::<true> { depth }.received(receiver, context),
        false => PathTracer::<false> { depth }.received(receiver, context),
    };
    if followed.is_secondary_terminated() {
        lambda.terminate_secondary();
    }
    (light, lambda)
}

/// A receiver whose plane is moved off a surface that it may lie on.
pub fn off_surface(scene: &Scene, receiver: &Receiver) -> Receiver {
    let off = |p: Vec3, n: Vec3| {
        let bounds = scene.bounds();
        let size = if bounds.is_empty() { 0.0 } else { bounds.diagonal().length() };
        let step = 1e-6 * (size + p.abs().max_element());
        p + n * if step.is_finite() { step } else { 0.0 }
    };
    match *receiver {
        Receiver::Plane(p, n) => Receiver::Plane(off(p, n), n),
        Receiver::Disc(p, n, r) => Receiver::Disc(off(p, n), n, r),
        other => other,
    }
}

impl Sums {
    /// Adds a sample of a replicate.
    fn take(&mut self, scene: &Scene, receiver: &Receiver, settings: &Settings, (replicate, index): (u32, u32)) {
        let sampler = Sampler { kind: SamplerKind::Sobol, spp: 1, seed: settings.seed }.pixel(replicate, 0, index);
        let (light, lambda) = received(scene, receiver, settings, &sampler);
        let values = measures(scene.mode(), light, &lambda);
        if values.iter().any(|v| !v.is_finite()) {
            self.nonfinite += 1;
            return;
        }
        self.values.iter_mut().zip(values).for_each(|(sum, v)| *sum += v);
    }
}

/// Linear Rec.709, power and CIE Y of lanes.
fn measures(mode: ColorMode, light: Spectrum, lambda: &Wavelengths) -> [f64; 5] {
    let Vec3 { x: r, y: g, z: b } = mode.to_rgb(light, lambda);
    let power = match mode {
        ColorMode::Rgb => 0.0,
        // The mean over lanes of L/p estimates ∫ L dλ.
        ColorMode::Spectral => {
            (0..4).filter(|k| lambda.pdf[*k] > 0.0).map(|k| 0.25 * light[k] / lambda.pdf[k]).sum::<f32>()
        }
    };
    [r, g, b, power, mode.luminance(light, lambda)].map(f64::from)
}

/// Means and intervals of the replicates, each of `samples`.
fn reading(scene: &Scene, receiver: &Receiver, sums: &[Sums], samples: u32) -> Reading {
    // Where numbers of the scene are cd/m², those of W are less.
    let unit = scene.film().unit_luminance / photometric_from_y(1.0);
    let count = sums.len() as f64;
    let estimate = |k: usize| {
        let means = || sums.iter().map(|s| s.values[k] * unit / f64::from(samples));
        let value = means().sum::<f64>() / count;
        let variance = means().map(|m| (m - value).powi(2)).sum::<f64>() / (count - 1.0);
        Estimate { value, plus_minus: STUDENT * (variance / count).sqrt() }
    };
    let y = estimate(4);
    Reading {
        quantity: match receiver {
            Receiver::Radiance(..) => Quantity::Radiance,
            Receiver::Plane(..) | Receiver::Sphere(_) => Quantity::Irradiance,
            Receiver::Disc(..) | Receiver::Ball(..) => Quantity::Flux,
        },
        rgb: [0, 1, 2].map(estimate),
        radiant: (scene.mode() == ColorMode::Spectral).then(|| estimate(3)),
        luminous: Estimate { value: photometric_from_y(y.value), plus_minus: photometric_from_y(y.plus_minus) },
        samples: samples * REPLICATES,
        nonfinite: sums.iter().map(|s| s.nonfinite).sum(),
    }
}

//! Bands of wavelengths: the light of each part of the spectrum by itself.
//!
//! A path carries the radiance L of four wavelengths, each drawn with a density p. So a band with the sensitivity s(λ)
//! gets the mean over the four of s L / p: the one-sample estimate of ∫ s L dλ. Bands of a range of wavelengths have
//! s = 1/width within it, and hold the mean spectral radiance (pbrt-v4, 5.4.6, "SpectralFilm"). Sensitivities of any
//! shape are those of Mitsuba's `specfilm`, which are not normalised.
//!
//! Values are spectral radiances of the scene, W/(m² sr nm), before the film's exposure.

use std::ops::Range;
use steradian_math::{
    Spectrum,
    spectra::{Spd, Wavelengths, photometry::photometric_from_y},
};

/// Sensitivities of the bands of a film.
#[derive(Clone, Debug)]
pub enum Bands {
    /// Ranges of equal width, which part the whole range.
    Even {
        /// Wavelengths of the whole, nm.
        range: Range<f32>,
        /// Number of bands, above 0.
        count: u32,
    },
    /// Sensitivities of any shape, with their names.
    Curves(Vec<(String, Spd)>),
}

/// Light of a path at its wavelengths, by the density of each: one sample of the integral over wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandSample {
    /// Wavelengths, nm.
    pub lambda: [f32; 4],
    /// A quarter of radiance by density; zero of wavelengths that the path has lost.
    pub light: [f32; 4],
}

impl BandSample {
    /// The sample of a path's light; black where it is not finite.
    pub fn new(light: Spectrum, lambda: &Wavelengths) -> Self {
        let at = |k: usize| if lambda.pdf[k] > 0.0 { 0.25 * light[k] / lambda.pdf[k] } else { 0.0 };
        let light: [f32; 4] = std::array::from_fn(at);
        let is_finite = light.iter().all(|v| v.is_finite());
        Self { lambda: lambda.lambda, light: if is_finite { light } else { [0.0; 4] } }
    }
}

impl Bands {
    /// Most bands of a film.
    pub const MOST: u32 = 256;

    /// Number of bands.
    pub fn count(&self) -> usize {
        match self {
            Self::Even { count, .. } => *count as usize,
            Self::Curves(curves) => curves.len(),
        }
    }

    /// Factor from a film's values to W/(m² sr nm), by the film's exposure and the luminance of its unit.
    pub(crate) fn scale(imaging_ratio: f32, unit_luminance: f64) -> f32 {
        (unit_luminance / photometric_from_y(1.0) / f64::from(imaging_ratio)) as f32
    }

    /// Adds a sample to the sums of a pixel, one for each band.
    pub fn add(&self, sample: &BandSample, sums: &mut [f64]) {
        for (lambda, light) in sample.lambda.into_iter().zip(sample.light).filter(|(_, light)| *light != 0.0) {
            match self {
                Self::Even { range, count } => {
                    let bands = *count as f32 / (range.end - range.start);
                    let place = (lambda - range.start) * bands;
                    // The last wavelength belongs to the last band.
                    let last = *count as usize - 1;
                    if place >= 0.0 && lambda <= range.end {
                        sums[last.min(place as usize)] += f64::from(light) * f64::from(bands);
                    }
                }
                Self::Curves(curves) => {
                    for ((_, curve), sum) in curves.iter().zip(&mut *sums) {
                        *sum += f64::from(light) * f64::from(curve.eval(lambda));
                    }
                }
            }
        }
    }

    /// Names of the channels: of ranges by the middle wavelength, in the layout of Fichet, Pacanowski and Wilkie 2021
    /// ("An OpenEXR Layout for Spectral Images", section 3), in which a comma is the decimal mark.
    pub fn names(&self) -> Vec<String> {
        match self {
            Self::Even { range, count } => {
                let width = f64::from(range.end - range.start) / f64::from(*count);
                let middle = |band| f64::from(range.start) + (f64::from(band) + 0.5) * width;
                let text = |band| format!("{:.3}", middle(band)).replace('.', ",");
                (0..*count).map(|band| format!("S0.{}nm", text(band))).collect()
            }
            Self::Curves(curves) => curves.iter().map(|(name, _)| name.clone()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use steradian_math::spectra::{Blackbody, Curve};

    /// Means over each band of an estimate with many wavelengths, against sums over each tenth of a nanometre.
    fn agrees(bands: &Bands, exact: &[f64]) {
        let spd = Spd::Blackbody(Blackbody::normalized(3000.0));
        let n = 200_000;
        let mut sums = vec![0.0; bands.count()];
        for k in 0..n {
            let lambda = Wavelengths::sample_visible((k as f32 + 0.5) / n as f32);
            bands.add(&BandSample::new(spd.sample(&lambda), &lambda), &mut sums);
        }
        for (sum, exact) in sums.iter().zip(exact) {
            assert!((sum / f64::from(n) / exact - 1.0).abs() < 2e-3, "{} {exact}", sum / f64::from(n));
        }
    }

    /// The integral of a blackbody times a sensitivity.
    fn integral(range: Range<f64>, s: impl Fn(f64) -> f64) -> f64 {
        let spd = Spd::Blackbody(Blackbody::normalized(3000.0));
        let steps = ((range.end - range.start) * 10.0) as u32;
        let at = |k: u32| range.start + (f64::from(k) + 0.5) / 10.0;
        (0..steps).map(|k| f64::from(spd.eval(at(k) as f32)) * s(at(k)) / 10.0).sum()
    }

    #[test]
    fn ranges_hold_the_mean_of_a_blackbody() {
        let bands = Bands::Even { range: 400.0..700.0, count: 6 };
        let exact: Vec<f64> =
            (0..6).map(|b| 400.0 + 50.0 * f64::from(b)).map(|l| integral(l..l + 50.0, |_| 0.02)).collect();
        agrees(&bands, &exact);
    }

    #[test]
    fn curves_hold_the_integral_with_their_sensitivity() {
        let curve = |low: f32, high: f32| Spd::Curve(Arc::new(Curve::new([low, high], [0.0, 1.0]).expect("rising")));
        let bands = Bands::Curves(vec![("a".into(), curve(500.0, 600.0)), ("b".into(), curve(550.0, 650.0))]);
        let exact = [500.0, 550.0].map(|l| integral(l..l + 100.0, |x| (x - l) / 100.0));
        agrees(&bands, &exact);
    }

    /// A path that lost three of its wavelengths, and light that is not finite.
    #[test]
    fn lost_wavelengths_and_infinite_light_add_nothing() {
        let mut lambda = Wavelengths::sample_visible(0.3);
        lambda.terminate_secondary();
        let sample = BandSample::new(Spectrum::new([1.0, f32::NAN, 1.0, 1.0]), &lambda);
        assert!(sample.light[0] > 0.0 && sample.light[1..] == [0.0; 3]);
        assert_eq!(BandSample::new(Spectrum::splat(f32::INFINITY), &lambda).light, [0.0; 4]);
    }

    #[test]
    fn channels_have_the_names_of_the_layout() {
        let names = Bands::Even { range: 360.0..830.0, count: 8 }.names();
        assert_eq!((names[0].as_str(), names[7].as_str()), ("S0.389,375nm", "S0.800,625nm"));
    }
}

//! Counting photons: `E = hf`, the light on a pixel as a number of photons for each exposure, and what a sensor makes
//! of it: quantum efficiency, shot noise (Poisson), read noise (Gaussian), a full well and an analogue-to-digital
//! converter (Janesick, *Photon Transfer*, 2007).

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Picture, Report, Run, Series, Values};
use steradian_math::{
    hash::HashRng,
    photon_noise::{ln_factorial, normal, poisson},
    spectra::blackbody::{PLANCK, SPEED_OF_LIGHT},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "photons",
    doc: "photon counts of a sensor's pixels: shot noise, read noise, full well",
    source: "Janesick, Photon Transfer, 2007, chapters 2 and 3",
    parameters: &[
        Parameter::number("irradiance", 1e-4, (0.0, 1e6), "W/m²", "on the sensor"),
        Parameter::number("wavelength", 550.0, (1.0, 1e5), "nm", "of the light"),
        Parameter::number("pixel", 4.0, (0.01, 1e4), "µm", "edge of a pixel"),
        Parameter::number("exposure", 10.0, (0.0, 1e9), "ms", "time"),
        Parameter::number("efficiency", 0.6, (0.0, 1.0), "", "share of photons that free an electron"),
        Parameter::number("read-noise", 0.0, (0.0, 1e4), "e⁻", "standard deviation of reading a pixel"),
        Parameter::number("full-well", 1e5, (1.0, 1e9), "e⁻", "most electrons of a pixel"),
        Parameter::count("pixels", 65_536, (16, 1 << 22), "pixels that are read; the picture has a square of them"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let energy = PLANCK * SPEED_OF_LIGHT / (values.number("wavelength") * 1e-9);
    let area = (values.number("pixel") * 1e-6).powi(2);
    let photons = values.number("irradiance") * area * values.number("exposure") * 1e-3 / energy;
    let mean = photons * values.number("efficiency");
    let (read, well) = (values.number("read-noise"), values.number("full-well"));
    if mean > 1e12 {
        return Err(Error::Impossible(format!("{mean:.3e} electrons in a pixel are more than 1e12")));
    }
    let mut rng = HashRng::new(values.number("seed") as u64);
    let readings: Vec<f64> =
        (0..values.count("pixels")).map(|_| poisson(mean, &mut rng).min(well) + read * normal(&mut rng)).collect();
    let n = readings.len() as f64;
    let average = readings.iter().sum::<f64>() / n;
    let variance = readings.iter().map(|r| (r - average).powi(2)).sum::<f64>() / (n - 1.0);
    let mut report = Report::default();
    report.quantity("energy of a photon", energy, "J");
    report.quantity("photons on a pixel", photons, "");
    report.quantity("expected electrons", mean, "");
    report.quantity("mean of the readings", average, "e⁻");
    report.quantity("variance of the readings", variance, "");
    if average > 0.0 && variance > 0.0 {
        report.quantity("variance over mean", variance / average, "");
        report.quantity("signal over noise", average / variance.sqrt(), "");
    }
    let deviation = (mean + read * read).sqrt().max(0.5);
    let (low, high) = ((mean - 5.0 * deviation).floor(), (mean + 5.0 * deviation).ceil());
    let width = ((high - low) / 60.0).ceil().max(1.0);
    let bins = ((high - low) / width) as usize + 1;
    let mut counts = vec![0.0; bins];
    for r in &readings {
        let at = (r - low) / width;
        if (0.0..bins as f64).contains(&at) {
            counts[at as usize] += 1.0 / (n * width);
        }
    }
    let middle = |b: usize| low + (b as f64 + 0.5) * width;
    let histogram = counts.iter().enumerate().map(|(b, c)| (middle(b), *c)).collect();
    let mut chart =
        Chart::new("readings of pixels", Axis::linear("electrons"), Axis::linear("share for each electron"))
            .with(Series::line("readings", histogram).drawn(Marker::Dots));
    if read == 0.0 && mean > 0.0 && width == 1.0 {
        let mass = |k: f64| (k * mean.ln() - mean - ln_factorial(k)).exp();
        let points = (low.max(0.0) as u64..=high as u64).map(|k| (k as f64 + 0.5, mass(k as f64))).collect();
        chart = chart.with(Series::line("Poisson's distribution", points));
    } else {
        let density = |x: f64| {
            (-0.5 * ((x - mean) / deviation).powi(2)).exp() / (deviation * (2.0 * std::f64::consts::PI).sqrt())
        };
        let points = (0..bins).map(|b| (middle(b), density(middle(b)))).collect();
        chart = chart.with(Series::line("normal distribution", points));
    }
    report.chart = Some(chart);
    let edge = (readings.len() as f64).sqrt() as usize;
    let white = (2.0 * mean).max(1.0);
    report.picture =
        Some(Picture::from_fn(edge, edge, |x, y| [(readings[y * edge + x] / white) as f32; 3]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run_with(given: &[(&str, &str)]) -> Report {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// M136: the variance is the mean; with read noise it is larger by its square; a full well takes noise away.
    #[test]
    fn the_variance_is_the_mean() {
        for irradiance in ["1e-6", "1e-4", "1e-3"] {
            let r = run_with(&[("irradiance", irradiance)]);
            // The variance of a variance is 2/n of its square and 1/(n mean) more for Poisson numbers.
            let n = 65_536.0;
            let deviation = (2.0 / n + 1.0 / (n * r.value("expected electrons"))).sqrt();
            assert!((r.value("variance over mean") - 1.0).abs() < 4.0 * deviation, "{irradiance}");
            let off = r.value("mean of the readings") - r.value("expected electrons");
            assert!(off.abs() < 4.0 * (r.value("expected electrons") / n).sqrt());
        }
        let noisy = run_with(&[("read-noise", "20")]);
        let expected = noisy.value("expected electrons") + 400.0;
        assert!((noisy.value("variance of the readings") / expected - 1.0).abs() < 0.025);
        assert_eq!(run_with(&[("full-well", "1"), ("irradiance", "1")]).value("variance of the readings"), 0.0);
        assert_eq!(run_with(&[("irradiance", "0")]).value("mean of the readings"), 0.0);
    }
}

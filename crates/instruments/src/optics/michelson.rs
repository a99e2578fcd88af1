//! Michelson's interferometer: `I(d) = ½ ∫ S(λ) (1 + cos(4π d/λ)) dλ` over the displacement `d` of a mirror, relative
//! to the light at `d = 0` (Born, Wolf, *Principles of Optics*, §7.5.8). Fringes repeat every half wavelength and fade
//! over the coherence length `λ²/Δλ`.

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use std::f64::consts::PI;
use steradian_math::spectra::{cie, named};

pub const EXPERIMENT: Experiment = Experiment {
    name: "michelson",
    doc: "fringes of a Michelson interferometer with a laser, a line of some width, the sodium doublet, or white light",
    source: "Born, Wolf, Principles of Optics, §7.5.8",
    parameters: &[
        Parameter::choice("light", &["line", "doublet", "white"], "a line, the two sodium lines, or daylight (D65)"),
        Parameter::number("wavelength", 632.8, (10.0, 1e5), "nm", "of the line"),
        Parameter::number("width", 0.0, (0.0, 1000.0), "nm", "full width of the line at half its height (Gaussian)"),
        Parameter::number("travel", 3.0, (1e-3, 1e6), "µm", "displacement of the mirror, to either side of equal arms"),
    ],
    run: Run::Alone(run),
};

/// Wavelengths (nm) and their shares of the light.
fn spectrum(values: &Values) -> Result<Vec<(f64, f64)>, Error> {
    let lambda = values.number("wavelength");
    let mut lines: Vec<(f64, f64)> = match values.choice("light") {
        // NIST: D2 588.995 nm is twice as strong as D1 589.592 nm.
        "doublet" => vec![(588.995, 2.0), (589.592, 1.0)],
        "white" => (380..=780).map(|nm| (f64::from(nm), f64::from(named::d65().eval(nm as f32)))).collect(),
        _ => {
            let sigma = values.number("width") / (8.0 * 2f64.ln()).sqrt();
            if sigma == 0.0 {
                vec![(lambda, 1.0)]
            } else if 4.0 * sigma >= lambda {
                return Err(Error::Impossible("the line is so wide that it reaches wavelength 0".into()));
            } else {
                let step = |k: i32| f64::from(k) / 200.0 * 4.0;
                (-200..=200).map(|k| (lambda + sigma * step(k), (-0.5 * step(k).powi(2)).exp())).collect()
            }
        }
    };
    let sum: f64 = lines.iter().map(|l| l.1).sum();
    lines.iter_mut().for_each(|l| l.1 /= sum);
    Ok(lines)
}

/// `½ (1 + cos(4π d/λ))`; the displacement in µm, the wavelength in nm.
fn fringe(d: f64, lambda: f64) -> f64 {
    (2.0 * PI * d * 1e3 / lambda).cos().powi(2)
}

fn run(values: &Values) -> Result<Report, Error> {
    let lines = spectrum(values)?;
    let travel = values.number("travel");
    let intensity = |d: f64| lines.iter().map(|(l, s)| s * fringe(d, *l)).sum::<f64>();
    let mean: f64 = lines.iter().map(|(l, s)| s * l).sum();
    let mut report = Report::default();
    if let Some(period) = fringe_period(&intensity, mean) {
        report.quantity("fringe period (mirror)", period * 1e3, "nm");
    }
    if values.choice("light") == "doublet" {
        let (a, b) = (lines[0].0, lines[1].0);
        report.quantity("displacement between two places without fringes", a * b / (2.0 * (b - a)) * 1e-3, "µm");
    }
    if values.choice("light") == "line" && values.number("width") > 0.0 {
        report.quantity("coherence length λ²/Δλ", mean * mean / values.number("width") * 1e-3, "µm");
    }
    const POINTS: u32 = 6000;
    let place = |k: u32| travel * (2.0 * f64::from(k) / f64::from(POINTS) - 1.0);
    let points = (0..=POINTS).map(|k| (place(k), intensity(place(k)))).collect();
    report.chart = Some(
        Chart::new(
            "Michelson interferometer",
            Axis::linear("displacement of the mirror (µm)"),
            Axis::linear("relative intensity"),
        )
        .with(Series::line("intensity", points)),
    );
    const COLUMNS: usize = 960;
    let white: f64 = lines.iter().map(|(l, s)| s * cie::matching_linear(*l)[1]).sum();
    let columns: Vec<[f32; 3]> = (0..COLUMNS)
        .map(|x| {
            let d = travel * (2.0 * (x as f64 + 0.5) / COLUMNS as f64 - 1.0);
            let xyz: DVec3 = lines.iter().map(|(l, s)| DVec3::from(cie::matching_linear(*l)) * s * fringe(d, *l)).sum();
            rgb_from_xyz_in_gamut(if white > 0.0 { xyz / white } else { DVec3::splat(intensity(d)) })
        })
        .collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| columns[x]).to_image()?);
    Ok(report)
}

/// Displacement (µm) between the maximum at equal arms and the next, where there is one.
fn fringe_period(intensity: &impl Fn(f64) -> f64, lambda: f64) -> Option<f64> {
    let (a, b) = (0.35e-3 * lambda, 0.65e-3 * lambda);
    let step = (b - a) / 1000.0;
    let k = (1..1000).find(|k| {
        let at = |k: i32| intensity(a + step * f64::from(k));
        at(*k) >= at(k - 1) && at(*k) > at(k + 1)
    })?;
    // The vertex of the parabola through three samples.
    let [l, m, r] = [-1, 0, 1].map(|o| intensity(a + step * f64::from(k + o)));
    Some(a + step * (f64::from(k) + 0.5 * (l - r) / (l - 2.0 * m + r)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(given: &[(&str, &str)], name: &str) -> f64 {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap().value(name)
    }

    /// M143: the fringe period of the mirror is λ/2.
    #[test]
    fn fringes_repeat_every_half_wavelength() {
        for lambda in [400.0, 632.8, 1550.0] {
            let period = value(&[("wavelength", &lambda.to_string())], "fringe period (mirror)");
            assert!((period / (lambda / 2.0) - 1.0).abs() < 1e-5, "{period}");
        }
    }

    /// A Gaussian line of width Δλ: the visibility at a path difference of λ²/Δλ is exp(−π²/(4 ln 2)) of that at zero.
    #[test]
    fn fringes_fade_over_the_coherence_length() {
        let given = [("width".to_owned(), "2".to_owned())];
        let lines = spectrum(&Values::resolve(&EXPERIMENT, &given).unwrap()).unwrap();
        let coherence = 632.8 * 632.8 / 2.0 * 1e-3;
        let (mut least, mut most) = (1.0_f64, 0.0_f64);
        for k in 0..2000 {
            // Two periods around half the coherence length of displacement.
            let d = coherence / 2.0 + f64::from(k) / 2000.0 * 0.6328;
            let i: f64 = lines.iter().map(|(l, s)| s * fringe(d, *l)).sum();
            (least, most) = (least.min(i), most.max(i));
        }
        let visibility = (most - least) / (most + least);
        let exact = (-PI * PI / (4.0 * 2f64.ln())).exp();
        assert!((visibility / exact - 1.0).abs() < 0.03, "{visibility} {exact}");
    }

    /// The two lines of sodium are in step again after 0.29 mm of displacement: the contrast of the fringes, read off
    /// the summed lines, is least at half of that and one and a half times, at a third, as one line has twice the
    /// other's light.
    #[test]
    fn the_doublet_beats() {
        let given = [("light".to_owned(), "doublet".to_owned())];
        let lines = spectrum(&Values::resolve(&EXPERIMENT, &given).unwrap()).unwrap();
        let contrast = |d: f64| {
            let around = || (0..100).map(|k| d + f64::from(k) / 100.0 * 0.2946);
            let light = || around().map(|d| lines.iter().map(|(l, s)| s * fringe(d, *l)).sum::<f64>());
            let (least, most) = (light().fold(1.0, f64::min), light().fold(0.0, f64::max));
            (most - least) / (most + least)
        };
        let least_from = |from: u32| {
            (from..from + 290)
                .map(|k| (contrast(f64::from(k)), k))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or_default()
        };
        let (first, second) = (least_from(0), least_from(290));
        assert!((first.0 - 1.0 / 3.0).abs() < 0.01, "{first:?}");
        assert!((f64::from(second.1 - first.1) - 290.8).abs() < 3.0, "{first:?} {second:?}");
        let beat = value(&[("light", "doublet"), ("travel", "300")], "displacement between two places without fringes");
        assert!((beat - 290.8).abs() < 0.5, "{beat}");
    }
}

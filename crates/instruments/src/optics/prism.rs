//! A prism: deviation by angle of incidence, `δ = θ₁ + θ₂' − A` with Snell's law at both faces, and the minimum
//! deviation, where `n = sin((A + δ)/2) / sin(A/2)` (Born, Wolf, *Principles of Optics*, §4.7.2).

use super::refractive_index::{MEDIA, index};
use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use steradian_math::{
    golden_section::golden_section,
    spectra::{cie, dispersion::FRAUNHOFER, named},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "prism",
    doc: "deviation of light by a prism, its minimum, and the spectrum behind it",
    source: "Born, Wolf, Principles of Optics, eq. 4.7.21",
    parameters: &[
        Parameter::choice("glass", MEDIA, "what it is made of"),
        Parameter::number("n_d", 1.5168, (1.0, 5.0), "", "index at the d line, for glass=custom"),
        Parameter::number("abbe", 64.17, (0.1, 1e4), "", "Abbe number, for glass=custom"),
        Parameter::number("apex", 60.0, (1.0, 120.0), "°", "angle between the faces"),
        Parameter::number("incidence", 50.0, (-89.9, 89.9), "°", "angle of incidence of the picture's light"),
    ],
    run: Run::Alone(run),
};

/// Deviation in radians of light of index `n` at an angle of incidence; `None` where it is totally reflected inside.
fn deviation(n: f64, apex: f64, incidence: f64) -> Option<f64> {
    let inside = (incidence.sin() / n).asin();
    let sine = n * (apex - inside).sin();
    (sine.abs() <= 1.0).then(|| incidence + sine.asin() - apex)
}

/// Angle of incidence and deviation where it is least, by golden-section search; `None` where no light passes.
fn minimum(n: f64, apex: f64) -> Option<(f64, f64)> {
    let at = |i: f64| deviation(n, apex, i).unwrap_or(f64::INFINITY);
    let samples = (0..=1800).map(|k| (f64::from(k) / 10.0 - 90.0).to_radians());
    let best = samples.min_by(|a, b| at(*a).total_cmp(&at(*b)))?;
    let incidence = golden_section(at, best - 0.2_f64.to_radians(), best + 0.2_f64.to_radians());
    deviation(n, apex, incidence).map(|d| (incidence, d))
}

fn run(values: &Values) -> Result<Report, Error> {
    let glass = index(values.choice("glass"), values.number("n_d"), values.number("abbe"));
    let apex = values.number("apex").to_radians();
    let incidence = values.number("incidence").to_radians();
    let mut report = Report::default();
    report.quantity("Abbe number", glass.abbe(), "");
    let mut chart = Chart::new(
        format!("prism of {}, {}°", values.choice("glass"), values.number("apex")),
        Axis::linear("angle of incidence (°)"),
        Axis::linear("deviation (°)"),
    );
    for (line, nm) in ["F", "d", "C"].into_iter().zip(FRAUNHOFER) {
        let n = glass.eval(nm);
        report.quantity(format!("index at {line} ({nm:.1} nm)"), n, "");
        if let Some((at, least)) = minimum(n, apex) {
            report.quantity(format!("least deviation at {line}"), least.to_degrees(), "°");
            report.quantity(format!("its angle of incidence at {line}"), at.to_degrees(), "°");
        }
        let points = (0..=900).filter_map(|k| {
            let i = f64::from(k) / 10.0;
            deviation(n, apex, i.to_radians()).map(|d| (i, d.to_degrees()))
        });
        chart = chart.with(Series::line(format!("{line}, {nm:.0} nm"), points.collect()));
    }
    report.chart = Some(chart);
    let exits = |nm: f64| deviation(glass.eval(nm), apex, incidence).map(f64::to_degrees);
    let passing: Vec<_> = (380..=780).filter_map(|nm| exits(f64::from(nm)).map(|d| (f64::from(nm), d))).collect();
    let (Some(first), Some(last)) = (passing.first(), passing.last()) else {
        return Err(Error::Impossible(
            "at this angle of incidence all light is totally reflected inside the prism".into(),
        ));
    };
    report.quantity("spread of the spectrum, 380 to 780 nm", (first.1 - last.1).abs(), "°");
    // Red on the left, as in most pictures of spectra, over the angles that the visible takes.
    const COLUMNS: usize = 960;
    let (low, high) = (last.1.min(first.1), last.1.max(first.1));
    let margin = 0.05 * (high - low).max(1e-9);
    let mut columns = vec![DVec3::ZERO; COLUMNS];
    for k in 0..40_000 {
        let nm = 380.0 + 0.01 * (f64::from(k) + 0.5);
        let Some(d) = exits(nm) else { continue };
        let x = (d - low + margin) / (high - low + 2.0 * margin) * COLUMNS as f64;
        let weight = f64::from(named::d65().eval(nm as f32)) * 0.01 / cie::CIE_Y_INTEGRAL;
        columns[(x as usize).min(COLUMNS - 1)] += DVec3::from(cie::matching_linear(nm)) * weight;
    }
    let brightest = columns.iter().map(|c| c.y).fold(1e-30, f64::max);
    let rgb: Vec<[f32; 3]> = columns.iter().map(|c| rgb_from_xyz_in_gamut(*c / brightest)).collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| rgb[x]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M130: where the deviation is least, n = sin((A + δ)/2)/sin(A/2) and light passes symmetrically.
    #[test]
    fn the_least_deviation_tells_the_index() {
        for (n, apex) in [(1.5168, 60.0_f64), (1.7847, 60.0), (1.33, 45.0), (2.4, 30.0)] {
            let apex = apex.to_radians();
            let (incidence, least) = minimum(n, apex).unwrap();
            assert!((((apex + least) / 2.0).sin() / (apex / 2.0).sin() - n).abs() < 1e-12);
            assert!((incidence - (apex + least) / 2.0).abs() < 1e-6);
        }
        // A prism of diamond of 60° lets nothing through.
        assert!(minimum(2.42, 60f64.to_radians()).is_none());
    }

    #[test]
    fn a_prism_that_nothing_passes_is_refused() {
        let given = [("glass".to_owned(), "diamond".to_owned())];
        assert!(EXPERIMENT.run(&given, None).unwrap_err().to_string().contains("totally reflected"));
    }
}

//! Fraunhofer's lines: what is missing in sunlight. Atoms of the sun's outer layers absorb the lines that they emit
//! when they glow, and oxygen of the air takes the bands A and B (Kirchhoff, Bunsen 1860).
//!
//! The sun is a black body of 5772 K with lines of the equivalent widths that were measured, each a Gaussian of the
//! residual depth 0.9 blurred by the spectroscope: the area of a line does not depend on that.

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Label, Parameter, Picture, Report, Run, Series, Values, monochromatic,
};
use std::f64::consts::TAU;
use steradian_math::spectra::blackbody::planck_wavelength;

pub const EXPERIMENT: Experiment = Experiment {
    name: "fraunhofer",
    doc: "Fraunhofer's dark lines in the spectrum of the sun, by letter, element and strength",
    source: "Fraunhofer 1814; Moore, Minnaert, Houtgast 1966 (wavelengths, equivalent widths); Planck 1900",
    parameters: &[
        Parameter::number("from", 390.0, (380.0, 770.0), "nm", "begin of the spectrum"),
        Parameter::number("to", 700.0, (385.0, 780.0), "nm", "its end"),
        Parameter::number(
            "width",
            0.3,
            (0.02, 10.0),
            "nm",
            "full width at half the height that the spectroscope resolves",
        ),
        Parameter::choice("air", &["yes", "no"], "whether the bands of the air's oxygen are there"),
    ],
    run: Run::Alone(run),
};

/// A line or band.
struct Line {
    /// Fraunhofer's letter, or a later one.
    letter: &'static str,
    element: &'static str,
    /// In air, nm.
    wavelength: f64,
    /// Equivalent width, nm: the width of a black stripe that takes as much.
    width: f64,
    /// True for what the air takes, not the sun.
    is_of_air: bool,
}

const fn line(letter: &'static str, element: &'static str, wavelength: f64, width: f64) -> Line {
    Line { letter, element, wavelength, width, is_of_air: false }
}

/// Lines of the sun, and the middles of two bands of the air, whose widths are those of Bird and Riordan's coefficients
/// for an air mass of one.
const LINES: [Line; 16] = [
    line("K", "calcium", 393.368, 2.025),
    line("H", "calcium", 396.849, 1.547),
    line("h", "hydrogen", 410.175, 0.3133),
    line("g", "calcium", 422.674, 0.1476),
    line("f", "hydrogen", 434.048, 0.2855),
    line("e", "iron", 438.356, 0.1008),
    line("F", "hydrogen", 486.134, 0.3680),
    line("b4", "magnesium", 516.733, 0.0935),
    line("b2", "magnesium", 517.270, 0.1259),
    line("b1", "magnesium", 518.362, 0.1584),
    line("E", "iron", 526.955, 0.0478),
    line("D2", "sodium", 588.997, 0.0752),
    line("D1", "sodium", 589.594, 0.0564),
    line("C", "hydrogen", 656.281, 0.4020),
    Line { letter: "B", element: "oxygen", wavelength: 687.6, width: 1.2, is_of_air: true },
    Line { letter: "A", element: "oxygen", wavelength: 760.8, width: 2.3, is_of_air: true },
];

/// Full width at half the height over the standard deviation of a Gaussian.
const FWHM: f64 = 2.354_820_045;

/// Share of the light that a line takes at a distance, seen by a spectroscope of a standard deviation in nm.
fn taken(line: &Line, nm: f64, resolved: f64) -> f64 {
    let own = line.width / (0.9 * TAU.sqrt());
    let sigma = own.hypot(resolved);
    line.width / (sigma * TAU.sqrt()) * (-0.5 * ((nm - line.wavelength) / sigma).powi(2)).exp()
}

fn run(values: &Values) -> Result<Report, Error> {
    let [from, to] = ["from", "to"].map(|n| values.number(n));
    if to - from < 1.0 {
        return Err(Error::Impossible("the spectrum ends ('to') less than 1 nm after its begin ('from')".into()));
    }
    let with_air = values.choice("air") == "yes";
    let resolved = values.number("width") / FWHM;
    let lines = || LINES.iter().filter(move |l| with_air || !l.is_of_air);
    let left = |nm: f64| lines().map(|l| 1.0 - taken(l, nm, resolved)).product::<f64>();
    let sun = |nm: f64| planck_wavelength(nm * 1e-9, 5772.0) / planck_wavelength(500e-9, 5772.0);
    let mut report = Report::default();
    for l in lines().filter(|l| (from..=to).contains(&l.wavelength)) {
        report.quantity(format!("{}, {}", l.letter, l.element), l.wavelength, "nm");
        report.quantity(format!("width of {}", l.letter), l.width, "nm");
        report.quantity(format!("left at {}", l.letter), left(l.wavelength), "");
    }
    let at = |k: u32| from + (to - from) * f64::from(k) / 4000.0;
    let spectrum: Vec<(f64, f64)> = (0..=4000).map(at).map(|nm| (nm, sun(nm) * left(nm))).collect();
    let mut chart = Chart::new("sunlight", Axis::linear("wavelength (nm)"), Axis::linear("relative radiance"))
        .with(Series::line("spectrum", spectrum));
    // Labels of lines that have room.
    let mut last = f64::NEG_INFINITY;
    for l in lines().filter(|l| (from..to - 0.05 * (to - from)).contains(&l.wavelength)) {
        if l.wavelength - last > 0.03 * (to - from) {
            chart.labels.push(Label { at: (l.wavelength, 0.1), text: l.letter.to_owned() });
            last = l.wavelength;
        }
    }
    report.chart = Some(chart);
    // The spectrum as a spectroscope shows it, each wavelength as bright as its colour can be, so that dark lines show.
    const COLUMNS: usize = 960;
    let columns: Vec<[f32; 3]> = (0..COLUMNS)
        .map(|x| {
            let part = |k: u32| from + (to - from) * (x as f64 + (f64::from(k) + 0.5) / 8.0) / COLUMNS as f64;
            let color = monochromatic(part(4));
            let most = color.into_iter().fold(1e-30, f32::max);
            let left = (0..8).map(|k| left(part(k)) / 8.0).sum::<f64>() as f32;
            color.map(|c| c / most * left)
        })
        .collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| columns[x]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(given: &[(&str, &str)]) -> Report {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// Lines of hydrogen and sodium are where these gases glow (`optics lines`), to 0.03 nm.
    #[test]
    fn dark_lines_are_those_that_glow() {
        for element in ["hydrogen", "sodium"] {
            let glowing = super::super::lines::lines(element);
            for dark in LINES.iter().filter(|l| l.element == element) {
                assert!(glowing.iter().any(|g| (g.0 - dark.wavelength).abs() < 0.03), "{}", dark.letter);
            }
        }
    }

    /// The area that is missing at a line is its equivalent width, however coarse the spectroscope is.
    #[test]
    fn areas_are_equivalent_widths() {
        for width in ["0.1", "1"] {
            let r = with(&[("from", "640"), ("to", "672"), ("width", width), ("air", "no")]);
            let points = &r.chart.unwrap().series[0].points;
            let sun = |nm: f64| planck_wavelength(nm * 1e-9, 5772.0) / planck_wavelength(500e-9, 5772.0);
            let missing: f64 = points.iter().map(|p| 1.0 - p.1 / sun(p.0)).sum::<f64>() * 32.0 / 4000.0;
            assert!((missing / 0.402 - 1.0).abs() < 0.01, "{width}: {missing}");
        }
    }

    /// The air's oxygen takes what it takes in `optics air`.
    #[test]
    fn bands_of_the_air_are_as_wide_as_the_model_has_them() {
        for (letter, range) in [("B", 667.6..=710.0), ("A", 757.5..=780.0)] {
            let band = LINES.iter().find(|l| l.letter == letter).unwrap();
            let width = super::super::air::taken_by_oxygen(range);
            assert!((band.width / width - 1.0).abs() < 0.05, "{letter}: {width}");
        }
    }

    /// A fine spectroscope shows two lines of sodium, a coarse one their mean, 589.3 nm; without air there is no B.
    #[test]
    fn a_coarse_spectroscope_joins_the_lines_of_sodium() {
        let at = |r: &Report, nm: f64| {
            let points = &r.chart.as_ref().unwrap().series[0].points;
            points.iter().min_by(|a, b| (a.0 - nm).abs().total_cmp(&(b.0 - nm).abs())).unwrap().1
        };
        let range = [("from", "585"), ("to", "594")];
        let (fine, coarse) =
            (with(&[range[0], range[1], ("width", "0.1")]), with(&[range[0], range[1], ("width", "1.5")]));
        assert!(at(&fine, 589.3) > 1.5 * at(&fine, 589.0) && at(&coarse, 589.3) < at(&coarse, 588.5));
        assert!(with(&[("air", "no")]).value("left at B").is_nan() && with(&[]).value("left at B") < 0.6);
        assert!(EXPERIMENT.run(&[("from".to_owned(), "750".to_owned())], None).is_err());
    }
}

//! Matching functions: how much of three primary lights together looks like one wavelength.
//!
//! Of the real primaries of 700, 546.1 and 435.8 nm some amounts are negative (r̄, ḡ, b̄: CIE 1931, after Guild and
//! Wright): so much must be added to the other side of the comparison. Of the primaries X, Y and Z, which no lamp has,
//! none is (x̄, ȳ, z̄); the matrix of the 1931 resolutions leads from the ones to the others.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use glam::DVec3;
use steradian_math::{color::xyz::cie_rgb_from_xyz, spectra::cie};

pub const EXPERIMENT: Experiment = Experiment {
    name: "matching",
    doc: "matching functions of real primaries, which are negative in places, or of X, Y and Z",
    source: "CIE 1931; Wyszecki, Stiles, Color Science, §3.3.3; Fairman, Brill, Hemmendinger 1997",
    parameters: &[
        Parameter::choice("of", &["rgb", "xyz"], "the primaries of 700, 546.1 and 435.8 nm, or X, Y and Z"),
        Parameter::number("wavelength", 520.0, (380.0, 780.0), "nm", "that is matched"),
    ],
    run: Run::Alone(run),
};

/// Names of the functions.
const NAMES: [[&str; 3]; 2] = [["r̄", "ḡ", "b̄"], ["x̄", "ȳ", "z̄"]];

fn run(values: &Values) -> Result<Report, Error> {
    let is_xyz = values.choice("of") == "xyz";
    let matrix = cie_rgb_from_xyz();
    let functions = |nm: f64| {
        let xyz = DVec3::from(cie::matching_linear(nm));
        if is_xyz { xyz } else { matrix * xyz }
    };
    let names = NAMES[usize::from(is_xyz)];
    let nm = values.number("wavelength");
    let mut report = Report::default();
    let here = functions(nm);
    for (name, v) in names.into_iter().zip(here.to_array()) {
        report.quantity(name, v, "");
    }
    let negative: Vec<_> = names.into_iter().zip(here.to_array()).filter(|(_, v)| *v < 0.0).map(|(n, _)| n).collect();
    report.fact(
        "match",
        if negative.is_empty() {
            "the primaries mix to this wavelength".to_owned()
        } else {
            format!("{} must be added to the other side", negative.join(" and "))
        },
    );
    let curves: Vec<(f64, DVec3)> = (360..=830).map(f64::from).map(|nm| (nm, functions(nm))).collect();
    for (k, name) in names.into_iter().enumerate() {
        let least = curves.iter().min_by(|a, b| a.1[k].total_cmp(&b.1[k])).copied().unwrap_or_default();
        report.quantity(format!("least {name}"), least.1[k], "");
        report.quantity(format!("least {name} at"), least.0, "nm");
        report.quantity(format!("area of {name}"), curves.iter().map(|c| c.1[k]).sum(), "nm");
    }
    let chart = Chart::new("matching functions", Axis::linear("wavelength (nm)"), Axis::linear("amount"));
    let colors = [[0xc0, 0x30, 0x20], [0x20, 0x90, 0x30], [0x20, 0x40, 0xc0]];
    report.chart = Some(names.into_iter().zip(colors).enumerate().fold(chart, |chart, (k, (name, color))| {
        let points = curves.iter().filter(|c| (380.0..=780.0).contains(&c.0)).map(|c| (c.0, c.1[k])).collect();
        chart.with(Series::line(name, points).colored(color))
    }));
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(of: &str, nm: &str) -> Report {
        let given = [("of", of), ("wavelength", nm)].map(|(a, b)| (a.to_owned(), b.to_owned()));
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// M117: the table of 1931 (Wyszecki, Stiles, table I(5.5.3)), to what the published matrix, rounded as it is,
    /// keeps of it.
    #[test]
    fn real_primaries_are_those_of_the_table() {
        for (nm, table) in [
            ("440", [-0.002_61, 0.001_49, 0.312_28]),
            ("450", [-0.012_13, 0.006_78, 0.316_70]),
            ("500", [-0.071_73, 0.085_36, 0.047_76]),
            ("520", [-0.092_64, 0.174_68, 0.012_21]),
            ("600", [0.344_29, 0.062_46, -0.000_49]),
        ] {
            let r = with("rgb", nm);
            for (name, exact) in NAMES[0].into_iter().zip(table) {
                assert!((r.value(name) - exact).abs() < 5e-4, "{nm} {name}: {}", r.value(name));
            }
        }
        assert!(with("rgb", "520").facts[0].text.starts_with("r̄ must"));
        assert!(with("rgb", "700").value("ḡ").abs() < 1e-4);
    }

    /// Equal energy is white in both: equal areas. Red is needed negatively, most near 516 nm; nothing is of X, Y and
    /// Z.
    #[test]
    fn areas_are_equal_and_red_is_negative() {
        for (of, names, area) in [("rgb", NAMES[0], 18.91), ("xyz", NAMES[1], 106.86)] {
            let r = with(of, "555");
            for name in names {
                let found = r.value(&format!("area of {name}"));
                assert!((found / area - 1.0).abs() < 2e-3, "{name}: {found}");
                assert!(of == "rgb" || r.value(&format!("least {name}")) >= 0.0);
            }
        }
        let r = with("rgb", "555");
        assert!((r.value("least r̄ at") - 516.0).abs() < 3.0 && (r.value("least r̄") + 0.0936).abs() < 5e-4);
    }
}

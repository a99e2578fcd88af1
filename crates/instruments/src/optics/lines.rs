//! Line spectra: what glowing gases emit, and what a cool gas takes out of white light by the law of Beer and Lambert,
//! `exp(−τ)`.
//!
//! Hydrogen's lines follow Rydberg's formula `1/λ = R (1/2² − 1/n²)`, corrected for the index of air; the others are
//! strong lines of NIST's Atomic Spectra Database (air wavelengths, relative intensities).

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use steradian_math::spectra::{cie, named};

pub const EXPERIMENT: Experiment = Experiment {
    name: "lines",
    doc: "emission and absorption lines of gases, and the colour of their light",
    source: "Rydberg 1890; NIST Atomic Spectra Database; Beer, Lambert",
    parameters: &[
        Parameter::choice("element", &["hydrogen", "helium", "neon", "sodium", "mercury"], "the gas"),
        Parameter::choice("kind", &["emission", "absorption"], "glowing, or in front of white light"),
        Parameter::number("width", 1.0, (0.01, 20.0), "nm", "full width of a line at half its height (Gaussian)"),
        Parameter::number("depth", 2.0, (0.0, 100.0), "", "optical depth of the strongest line, for absorption"),
    ],
    run: Run::Alone(run),
};

/// Rydberg's constant for hydrogen (reduced mass), 1/m: R∞ / (1 + m_e/m_p).
const RYDBERG: f64 = 10_973_731.568_157 / (1.0 + 1.0 / 1_836.152_673_426);

/// Index of air at 15 °C in the visible (Edlén 1966, to the digits that matter here).
const AIR: f64 = 1.000_277;

/// Wavelengths (nm, in air) and relative intensities of an element's lines.
pub(super) fn lines(element: &str) -> Vec<(f64, f64)> {
    match element {
        // Intensities of the Balmer lines: NIST.
        "hydrogen" => [500_000.0, 180_000.0, 90_000.0, 70_000.0, 30_000.0]
            .into_iter()
            .zip(3..)
            .map(|(i, n)| (1e9 / (AIR * RYDBERG * (0.25 - 1.0 / f64::from(n * n))), i))
            .collect(),
        "helium" => vec![
            (388.865, 500.0),
            (402.619, 50.0),
            (447.148, 200.0),
            (471.315, 30.0),
            (492.193, 20.0),
            (501.568, 100.0),
            (587.562, 500.0),
            (667.815, 100.0),
            (706.519, 200.0),
            (728.135, 50.0),
        ],
        "neon" => vec![
            (540.056, 200.0),
            (585.249, 2000.0),
            (588.190, 1000.0),
            (594.483, 500.0),
            (597.553, 600.0),
            (603.000, 1000.0),
            (607.434, 1000.0),
            (609.616, 300.0),
            (614.306, 1000.0),
            (616.359, 1000.0),
            (621.728, 1000.0),
            (626.650, 1000.0),
            (633.443, 1000.0),
            (638.299, 1000.0),
            (640.225, 2000.0),
            (650.653, 1500.0),
            (659.895, 1000.0),
            (667.828, 500.0),
            (692.947, 1000.0),
            (703.241, 800.0),
            (717.394, 800.0),
            (724.517, 800.0),
        ],
        "sodium" => {
            vec![(568.820, 560.0), (588.995, 80_000.0), (589.592, 40_000.0), (615.423, 190.0), (616.075, 290.0)]
        }
        _ => vec![
            (404.656, 1800.0),
            (407.783, 150.0),
            (434.749, 400.0),
            (435.833, 4000.0),
            (546.074, 1100.0),
            (576.960, 240.0),
            (579.066, 280.0),
        ],
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let lines = lines(values.choice("element"));
    let strongest = lines.iter().map(|l| l.1).fold(0.0, f64::max);
    let sigma = values.number("width") / (8.0 * 2f64.ln()).sqrt();
    let profile =
        |nm: f64| lines.iter().map(|(l, i)| i / strongest * (-0.5 * ((nm - l) / sigma).powi(2)).exp()).sum::<f64>();
    let is_emission = values.choice("kind") == "emission";
    let depth = values.number("depth");
    let daylight = |nm: f64| f64::from(named::d65().eval(nm as f32));
    let spectrum = |nm: f64| if is_emission { profile(nm) } else { daylight(nm) * (-depth * profile(nm)).exp() };
    let mut report = Report::default();
    for (l, i) in &lines {
        report.quantity(format!("line {l:.1} nm"), i / strongest, "");
    }
    const PER_NM: u32 = 20;
    let samples = || (0..400 * PER_NM).map(|k| 380.0 + (f64::from(k) + 0.5) / f64::from(PER_NM));
    report.chart = Some(
        Chart::new(
            format!("{}, {}", values.choice("element"), values.choice("kind")),
            Axis::linear("wavelength (nm)"),
            Axis::linear("relative power for each nm"),
        )
        .with(Series::line("spectrum", samples().map(|nm| (nm, spectrum(nm))).collect())),
    );
    let xyz: DVec3 = samples().map(|nm| DVec3::from(cie::matching_linear(nm)) * spectrum(nm)).sum();
    let color = rgb_from_xyz_in_gamut(xyz / xyz.y.max(1e-30));
    for (name, c) in ["red", "green", "blue"].into_iter().zip(color) {
        report.quantity(format!("colour of the light at luminance 1, {name}"), f64::from(c), "");
    }
    // The spectrum as a spectroscope shows it.
    const COLUMNS: usize = 960;
    let columns: Vec<DVec3> = (0..COLUMNS)
        .map(|x| {
            (0..16)
                .map(|k| 380.0 + 400.0 * (x as f64 + (f64::from(k) + 0.5) / 16.0) / COLUMNS as f64)
                .map(|nm| DVec3::from(cie::matching_linear(nm)) * spectrum(nm) / 16.0)
                .sum()
        })
        .collect();
    let brightest = columns.iter().map(|c| c.max_element()).fold(1e-30, f64::max);
    let rgb: Vec<[f32; 3]> = columns.iter().map(|c| rgb_from_xyz_in_gamut(*c * (1.5 / brightest))).collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| rgb[x]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M139: Balmer's lines in air (NIST) to 0.03 nm; sodium is orange; absorption takes exp(−τ) out of a line.
    #[test]
    fn lines_are_where_they_are_measured() {
        for (found, exact) in lines("hydrogen").iter().zip([656.279, 486.135, 434.0472, 410.1734, 397.0075]) {
            assert!((found.0 - exact).abs() < 0.03, "{} {exact}", found.0);
        }
        let given = [("element".to_owned(), "sodium".to_owned())];
        let r = EXPERIMENT.run(&given, None).unwrap();
        let [red, green, blue] =
            ["red", "green", "blue"].map(|c| r.value(&format!("colour of the light at luminance 1, {c}")));
        assert!(red > green && green > 3.0 * blue, "{red} {green} {blue}");
        let given = [("element", "mercury"), ("kind", "absorption"), ("depth", "2")];
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let chart = EXPERIMENT.run(&given, None).unwrap().chart.unwrap();
        let at = |nm: f64| {
            chart.series[0].points.iter().min_by(|a, b| (a.0 - nm).abs().total_cmp(&(b.0 - nm).abs())).unwrap().1
        };
        let ratio = at(435.833) / f64::from(named::d65().eval(435.833));
        assert!((ratio / (-2f64).exp() - 1.0).abs() < 0.02, "{ratio}");
    }
}

//! The photoelectric effect: electrons leave a metal only where a photon's energy exceeds its work function; the
//! voltage that stops the fastest ones is `U = (hf − φ)/e` (Einstein 1905). Millikan's experiment finds `h` from the
//! slope. The current, `I = η e P/(hf)`, is proportional to the power at one frequency, and at one power falls with the
//! frequency, as there are fewer photons; below the threshold none flows, however strong the light. Work functions:
//! Michaelson, *J. Appl. Phys.* 48 (1977), polycrystalline.

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use steradian_math::{
    hash::HashRng,
    photon_noise::normal,
    spectra::blackbody::{PLANCK, SPEED_OF_LIGHT},
};

/// Charge of an electron, C (exact).
const CHARGE: f64 = 1.602_176_634e-19;

/// Metals and work functions in eV.
const METALS: [(&str, f64); 10] = [
    ("sodium", 2.75),
    ("caesium", 2.14),
    ("potassium", 2.30),
    ("calcium", 2.87),
    ("silver", 4.26),
    ("aluminium", 4.28),
    ("zinc", 4.33),
    ("copper", 4.65),
    ("gold", 5.1),
    ("platinum", 5.65),
];

pub const EXPERIMENT: Experiment = Experiment {
    name: "photoelectric",
    doc: "stopping voltage of photoelectrons by frequency, and Planck's constant from its slope",
    source: "Einstein 1905; Millikan 1916; Michaelson 1977 (work functions)",
    parameters: &[
        Parameter::choice(
            "metal",
            &["sodium", "caesium", "potassium", "calcium", "silver", "aluminium", "zinc", "copper", "gold", "platinum"],
            "of the cathode",
        ),
        Parameter::choice(
            "against",
            &["voltage", "power", "frequency"],
            "chart: stopping voltage, or current by power or frequency",
        ),
        Parameter::number("wavelength", 400.0, (1.0, 1e6), "nm", "of the light whose electrons are described"),
        Parameter::number("power", 1.0, (0.0, 1e6), "mW", "of the light"),
        Parameter::number("efficiency", 0.1, (0.0, 1.0), "", "electrons for each photon above the threshold"),
        Parameter::number("noise", 0.01, (0.0, 10.0), "V", "standard deviation of a measured voltage"),
        Parameter::count("readings", 40, (3, 100_000), "measured frequencies, evenly from the threshold to twice it"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed of the noise"),
    ],
    run: Run::Alone(run),
};

/// Slope and intercept of the least-squares line, and the standard deviation of the slope for noise of a given size.
fn line(points: &[(f64, f64)], noise: f64) -> (f64, f64, f64) {
    let n = points.len() as f64;
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let slope = sxy / sxx;
    (slope, my - slope * mx, noise / sxx.sqrt())
}

fn run(values: &Values) -> Result<Report, Error> {
    let metal = values.choice("metal");
    let work = METALS.iter().find(|m| m.0 == metal).map_or(f64::NAN, |m| m.1);
    let threshold = work * CHARGE / PLANCK;
    let noise = values.number("noise");
    let mut report = Report::default();
    report.quantity("work function", work, "eV");
    report.quantity("threshold frequency", threshold * 1e-12, "THz");
    report.quantity("threshold wavelength", SPEED_OF_LIGHT / threshold * 1e9, "nm");
    let photon = PLANCK * SPEED_OF_LIGHT / (values.number("wavelength") * 1e-9) / CHARGE;
    report.quantity("energy of a photon", photon, "eV");
    // Below the threshold no electron leaves, however strong the light is.
    report.quantity("greatest energy of an electron", (photon - work).max(0.0), "eV");
    report.quantity("current flows", f64::from(u8::from(photon > work)), "");
    let current = |power: f64, frequency: f64| {
        let is_freed = frequency > threshold;
        if is_freed { values.number("efficiency") * CHARGE * power * 1e-3 / (PLANCK * frequency) } else { 0.0 }
    };
    let (power, frequency) = (values.number("power"), SPEED_OF_LIGHT / (values.number("wavelength") * 1e-9));
    report.quantity("photons", power * 1e-3 / (PLANCK * frequency), "1/s");
    report.quantity("photocurrent", 1e6 * current(power, frequency), "µA");
    let mut rng = HashRng::new(values.number("seed") as u64);
    let count = values.count("readings");
    let readings: Vec<(f64, f64)> = (0..count)
        .map(|k| threshold * (1.0 + (k as f64 + 0.5) / count as f64))
        .map(|f| (f, PLANCK * f / CHARGE - work + noise * normal(&mut rng)))
        .collect();
    let (slope, intercept, deviation) = line(&readings, noise);
    report.quantity("h from the slope", slope * CHARGE, "J s");
    report.quantity("its standard deviation", deviation * CHARGE, "J s");
    report.quantity("work function from the intercept", -intercept, "eV");
    let fitted = [0.0, 2.0].map(|f| (f * threshold * 1e-12, slope * f * threshold + intercept));
    let steps = |to: f64| (0..=200).map(move |k| to * f64::from(k) / 200.0);
    let chart =
        |title: &str, x: &str, y: &str| Chart::new(format!("{title}, {metal}"), Axis::linear(x), Axis::linear(y));
    report.chart = Some(match values.choice("against") {
        "power" => {
            [0.8, 1.2, 1.6, 2.4].into_iter().fold(chart("photocurrent", "power (mW)", "current (µA)"), |c, f| {
                let points = steps(power.max(1e-3)).map(|p| (p, 1e6 * current(p, f * threshold))).collect();
                c.with(Series::line(format!("{:.0} THz", f * threshold * 1e-12), points))
            })
        }
        "frequency" => chart("photocurrent", "frequency (THz)", "current (µA)").with(Series::line(
            "current",
            steps(4.0 * threshold).map(|f| (f * 1e-12, 1e6 * current(power, f))).collect(),
        )),
        _ => chart("stopping voltage", "frequency (THz)", "stopping voltage (V)")
            .with(Series::line("readings", readings.iter().map(|r| (r.0 * 1e-12, r.1)).collect()).drawn(Marker::Dots))
            .with(Series::line("fitted line", fitted.to_vec())),
    });
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M137: no current below the threshold; the slope is h (CODATA 2018), which Millikan found to be 6.56e-34 J s to
    /// half a per cent where 6.62 is right (*Phys. Rev.* 7, 1916), and within four standard deviations with noise.
    /// Photons have 1239.84 eV nm; the thresholds of caesium and platinum are at 579 and 219 nm.
    #[test]
    fn the_slope_is_plancks_constant() {
        let run = |given: &[(&str, &str)]| {
            let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
            EXPERIMENT.run(&given, None).unwrap()
        };
        let exact = run(&[("noise", "0")]);
        assert!((exact.value("h from the slope") / 6.626_070_15e-34 - 1.0).abs() < 1e-10);
        assert!((exact.value("h from the slope") / 6.56e-34 - 1.0).abs() < 0.012);
        assert!((exact.value("energy of a photon") - 1_239.841_984 / 400.0).abs() < 1e-7);
        for (metal, nm) in [("caesium", 579.37), ("platinum", 219.44)] {
            assert!((run(&[("metal", metal)]).value("threshold wavelength") - nm).abs() < 0.01, "{metal}");
        }
        for seed in 0..20 {
            let r = run(&[("seed", &seed.to_string())]);
            let z = (r.value("h from the slope") - PLANCK) / r.value("its standard deviation");
            assert!(z.abs() < 4.0, "{seed}: {z}");
        }
        assert_eq!(run(&[("wavelength", "451.5")]).value("current flows"), 0.0);
        assert_eq!(run(&[("wavelength", "450")]).value("current flows"), 1.0);
        // 1 mW of 400 nm are 2.01e15 photons for each second, a tenth of which frees 32.3 µA; twice the power, twice as
        // much; half the wavelength, half as much; none below the threshold.
        let current = |given: &[(&str, &str)]| run(given).value("photocurrent");
        assert!((current(&[]) - 0.1 * 1e-3 / (1_239.841_984 / 400.0) * 1e6).abs() < 1e-6);
        assert!((run(&[]).value("photons") / 2.0137e15 - 1.0).abs() < 1e-4);
        assert!((current(&[("power", "2")]) / current(&[]) - 2.0).abs() < 1e-12);
        assert!((current(&[("wavelength", "200")]) / current(&[]) - 0.5).abs() < 1e-12);
        assert_eq!(current(&[("wavelength", "500"), ("power", "1000000")]), 0.0);
        for against in ["power", "frequency"] {
            let chart = run(&[("against", against)]).chart.unwrap();
            let zeros = chart.series[0].points.iter().filter(|p| p.1 == 0.0).count();
            assert!(
                zeros > 40 && chart.series.iter().any(|s| s.points.iter().any(|p| p.1 > 30.0)),
                "{against}: {zeros}"
            );
        }
        assert!(METALS.iter().all(|m| run(&[("metal", m.0)]).value("work function") == m.1));
    }
}

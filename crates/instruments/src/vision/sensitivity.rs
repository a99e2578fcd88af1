//! Spectral sensitivities: of the rods `V′(λ)` (CIE 1951, for eyes that are used to the dark), of the eye by day `V(λ)`
//! (CIE 1924), and of the three cones, Hunt, Pointer and Estévez's sums of x̄, ȳ and z̄, each scaled to a greatest
//! value of one.
//!
//! A lamp is as bright by night as `1700 lm/W ∫ Φ V′ dλ`, by day as `683 lm/W ∫ Φ V dλ`; both are 683 lm/W at 555 nm,
//! by the definition of the candela. The ratio of the two is sold as S/P.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use glam::DVec3;
use steradian_math::spectra::{blackbody::planck_wavelength, cie, named, photometry::LUMINOUS_EFFICACY};

pub const EXPERIMENT: Experiment = Experiment {
    name: "sensitivity",
    doc: "how sensitive rods and cones are to each wavelength, and lamps by night against lamps by day",
    source: "CIE 1924 (V), CIE 1951 (V′; ISO/CIE 23539); Estévez 1979; Hunt, The Reproduction of Colour, §36.5",
    parameters: &[
        Parameter::number("wavelength", 507.0, (380.0, 780.0), "nm", "that is described"),
        Parameter::choice("lamp", &["d65", "equal-energy", "black-body"], "whose luminances are compared"),
        Parameter::number("temperature", 2856.0, (500.0, 50_000.0), "K", "of the black body"),
    ],
    run: Run::Alone(run),
};

/// V′ from 380 nm to 780 nm, every 10 nm.
const SCOTOPIC: [f64; 41] = [
    5.89e-4, 2.209e-3, 9.29e-3, 0.034_84, 0.0966, 0.1998, 0.3281, 0.455, 0.567, 0.676, 0.793, 0.904, 0.982, 0.997,
    0.935, 0.811, 0.650, 0.481, 0.3288, 0.2076, 0.1212, 0.0655, 0.033_15, 0.015_93, 7.37e-3, 3.335e-3, 1.497e-3,
    6.77e-4, 3.129e-4, 1.48e-4, 7.15e-5, 3.533e-5, 1.78e-5, 9.14e-6, 4.78e-6, 2.546e-6, 1.379e-6, 7.6e-7, 4.25e-7,
    2.413e-7, 1.39e-7,
];

/// V′ at a wavelength in nm: the cubic through the logarithms of the four nearest values; zero outside the table.
fn scotopic(nm: f64) -> f64 {
    let x = (nm - 380.0) / 10.0;
    if !(0.0..=40.0).contains(&x) {
        return 0.0;
    }
    let first = (x as usize).saturating_sub(1).min(SCOTOPIC.len() - 4);
    let t = x - first as f64;
    // Lagrange's weights of the places 0, 1, 2, 3.
    let weight = |k: usize| (0..4).filter(|j| *j != k).map(|j| (t - j as f64) / (k as f64 - j as f64)).product::<f64>();
    SCOTOPIC.iter().skip(first).take(4).enumerate().map(|(k, v)| weight(k) * v.ln()).sum::<f64>().exp()
}

/// Largest responses of the cones, by which they are scaled.
fn cone_peaks() -> DVec3 {
    (390..=700).map(|nm| unscaled(f64::from(nm))).fold(DVec3::ZERO, DVec3::max)
}

fn unscaled(nm: f64) -> DVec3 {
    super::cones::lms_from_xyz() * DVec3::from(cie::matching_linear(nm))
}

/// `∫ Φ V′ dλ` and `∫ Φ V dλ`, weighted to be luminances.
fn luminances(power: impl Fn(f64) -> f64) -> (f64, f64) {
    let nm = || (380..=780).map(f64::from);
    let night: f64 = nm().map(|l| power(l) * scotopic(l)).sum();
    let day: f64 = nm().map(|l| power(l) * cie::matching_linear(l)[1]).sum();
    (night * night_efficacy(), day * LUMINOUS_EFFICACY)
}

/// Luminous efficacy at the maximum of V′, lm/W.
fn night_efficacy() -> f64 {
    // 540 THz.
    LUMINOUS_EFFICACY / scotopic(555.016)
}

fn run(values: &Values) -> Result<Report, Error> {
    let nm = values.number("wavelength");
    let peaks = cone_peaks();
    let cones = |nm: f64| (unscaled(nm) / peaks).max(DVec3::ZERO);
    let day = |nm: f64| cie::matching_linear(nm)[1];
    let mut report = Report::default();
    report.quantity("rods, V′", scotopic(nm), "");
    report.quantity("by day, V", day(nm), "");
    for (name, v) in ["L cones", "M cones", "S cones"].into_iter().zip(cones(nm).to_array()) {
        report.quantity(name, v, "");
    }
    report.quantity("efficacy by night", night_efficacy() * scotopic(nm), "lm/W");
    report.quantity("efficacy by day", LUMINOUS_EFFICACY * day(nm), "lm/W");
    let best = |s: &dyn Fn(f64) -> f64| {
        let nm = |k: u32| 380.0 + f64::from(k) / 10.0;
        (0..=4000).map(nm).max_by(|a, b| s(*a).total_cmp(&s(*b))).unwrap_or(0.0)
    };
    report.quantity("rods are most sensitive at", best(&scotopic), "nm");
    report.quantity("by day the eye is at", best(&day), "nm");
    for (k, name) in ["L cones at", "M cones at", "S cones at"].into_iter().enumerate() {
        report.quantity(name, best(&|nm| cones(nm)[k]), "nm");
    }
    report.quantity("efficacy of rods there", night_efficacy(), "lm/W");
    let kelvin = values.number("temperature");
    let (night, by_day) = luminances(|nm| match values.choice("lamp") {
        "equal-energy" => 1.0,
        "black-body" => planck_wavelength(nm * 1e-9, kelvin),
        _ => f64::from(named::d65().eval(nm as f32)),
    });
    report.quantity("luminance by night over that by day (S/P)", night / by_day, "");
    let curve = |s: &dyn Fn(f64) -> f64| (380..=780).map(f64::from).map(|nm| (nm, s(nm))).collect::<Vec<_>>();
    report.chart = Some(
        Chart::new("sensitivities", Axis::linear("wavelength (nm)"), Axis::linear("of the greatest"))
            .with(Series::line("rods, V′", curve(&scotopic)).colored([0x55, 0x55, 0x55]))
            .with(Series::line("by day, V", curve(&day)).colored([0x11, 0x11, 0x11]))
            .with(Series::line("L cones", curve(&|nm| cones(nm).x)).colored([0xc0, 0x30, 0x20]))
            .with(Series::line("M cones", curve(&|nm| cones(nm).y)).colored([0x20, 0x90, 0x30]))
            .with(Series::line("S cones", curve(&|nm| cones(nm).z)).colored([0x20, 0x40, 0xc0])),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// V′ between the values of the table, where CIE 1951 has others, and its maximum, 1 at 507 nm; 1700 lm/W (CIE
    /// 86-1990; ISO/CIE 23539).
    #[test]
    fn rods_are_as_the_standard_has_them() {
        for (nm, v) in [
            (405.0, 0.018_52),
            (425.0, 0.1436),
            (445.0, 0.3931),
            (465.0, 0.620),
            (485.0, 0.851),
            (505.0, 0.998),
            (515.0, 0.975),
            (535.0, 0.733),
            (555.0, 0.402),
            (575.0, 0.1602),
            (595.0, 0.0469),
            (625.0, 0.004_97),
        ] {
            assert!((scotopic(nm) / v - 1.0).abs() < 0.006, "{nm}: {}", scotopic(nm));
        }
        let r = EXPERIMENT.run(&[], None).unwrap();
        assert!((r.value("rods are most sensitive at") - 507.0).abs() < 0.7);
        assert!((r.value("rods, V′") - 1.0).abs() < 2e-3);
        assert!((r.value("efficacy of rods there") / 1700.0 - 1.0).abs() < 3e-3);
        assert!((r.value("by day the eye is at") - 555.0).abs() < 0.5);
        assert_eq!((scotopic(379.0), scotopic(781.0)), (0.0, 0.0));
    }

    /// S/P of a black body of 2856 K is 1.41, of D65 2.47 and of equal energy 2.27, as tables of lamps have them (CIE
    /// 191:2010).
    #[test]
    fn bluer_lamps_are_brighter_by_night() {
        for (lamp, ratio) in [("black-body", 1.41), ("d65", 2.47), ("equal-energy", 2.27)] {
            let r = EXPERIMENT.run(&[("lamp".to_owned(), lamp.to_owned())], None).unwrap();
            let found = r.value("luminance by night over that by day (S/P)");
            assert!((found / ratio - 1.0).abs() < 0.02, "{lamp}: {found}");
        }
    }

    /// Hunt has the maxima of the cones near 580, 545 and 440 nm.
    #[test]
    fn cones_have_their_places() {
        let r = EXPERIMENT.run(&[], None).unwrap();
        for (name, nm) in [("L cones at", 580.0), ("M cones at", 545.0), ("S cones at", 440.0)] {
            assert!((r.value(name) - nm).abs() < 7.0, "{name}: {}", r.value(name));
        }
    }
}

//! Light of the sun through the air: scattered by molecules (Rayleigh), absorbed by ozone, water and oxygen, dimmed by
//! haze, after Bird and Riordan's simple spectral model.
//!
//! - Rayleigh: `exp(−m/(λ⁴ (115.6406 − 1.335/λ²)))`, λ in µm.
//! - Haze: `exp(−τ₅₀₀ (λ/500 nm)^−1.14 m)`.
//! - Water: `exp(−0.2385 a w m/(1 + 20.07 a w m)^0.45)`, `w` in cm of precipitable water.
//! - Ozone: `exp(−a o m₃)`, `o` in cm at normal pressure (100 Dobson units are 0.1 cm), `m₃` for a layer at 22 km.
//! - Oxygen and other mixed gases: `exp(−1.41 a m/(1 + 118.93 a m)^0.45)`.
//!
//! The relative air mass is Kasten's, `m = 1/(sin h + 0.15 (h + 3.885°)^−1.253)`.

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use steradian_math::spectra::cie;

pub const EXPERIMENT: Experiment = Experiment {
    name: "air",
    doc: "what molecules, ozone, water, oxygen and haze of the air leave of sunlight at each wavelength",
    source: "Bird, Riordan 1984 (SERI/TR-215-2436), §2 and table 2-1; Kasten 1966 (air mass)",
    parameters: &[
        Parameter::number("elevation", 30.0, (0.5, 90.0), "°", "of the sun above the horizon"),
        Parameter::number("water", 1.42, (0.0, 10.0), "cm", "precipitable water"),
        Parameter::number("ozone", 0.34, (0.0, 1.0), "cm", "ozone at normal pressure; 0.34 is 340 Dobson units"),
        Parameter::number("haze", 0.1, (0.0, 3.0), "", "optical depth of haze at 500 nm"),
        Parameter::number("wavelength", 550.0, (300.0, 905.0), "nm", "that is described"),
    ],
    run: Run::Alone(run),
};

/// Wavelength (nm), irradiance above the air (W/(m² nm)), and coefficients of water, ozone and mixed gases.
const TABLE: [[f64; 5]; 55] = [
    [300.0, 0.5359, 0.0, 10.0, 0.0],
    [305.0, 0.5583, 0.0, 4.8, 0.0],
    [310.0, 0.622, 0.0, 2.7, 0.0],
    [315.0, 0.6927, 0.0, 1.35, 0.0],
    [320.0, 0.7151, 0.0, 0.8, 0.0],
    [325.0, 0.8329, 0.0, 0.38, 0.0],
    [330.0, 0.9619, 0.0, 0.16, 0.0],
    [335.0, 0.9319, 0.0, 0.075, 0.0],
    [340.0, 0.9006, 0.0, 0.04, 0.0],
    [345.0, 0.9113, 0.0, 0.019, 0.0],
    [350.0, 0.9755, 0.0, 0.007, 0.0],
    [360.0, 0.9759, 0.0, 0.0, 0.0],
    [370.0, 1.1199, 0.0, 0.0, 0.0],
    [380.0, 1.1038, 0.0, 0.0, 0.0],
    [390.0, 1.0338, 0.0, 0.0, 0.0],
    [400.0, 1.4791, 0.0, 0.0, 0.0],
    [410.0, 1.7013, 0.0, 0.0, 0.0],
    [420.0, 1.7404, 0.0, 0.0, 0.0],
    [430.0, 1.5872, 0.0, 0.0, 0.0],
    [440.0, 1.837, 0.0, 0.0, 0.0],
    [450.0, 2.005, 0.0, 0.003, 0.0],
    [460.0, 2.043, 0.0, 0.006, 0.0],
    [470.0, 1.987, 0.0, 0.009, 0.0],
    [480.0, 2.027, 0.0, 0.014, 0.0],
    [490.0, 1.896, 0.0, 0.021, 0.0],
    [500.0, 1.909, 0.0, 0.03, 0.0],
    [510.0, 1.927, 0.0, 0.04, 0.0],
    [520.0, 1.831, 0.0, 0.048, 0.0],
    [530.0, 1.891, 0.0, 0.063, 0.0],
    [540.0, 1.898, 0.0, 0.075, 0.0],
    [550.0, 1.892, 0.0, 0.085, 0.0],
    [570.0, 1.84, 0.0, 0.12, 0.0],
    [593.0, 1.768, 0.075, 0.119, 0.0],
    [610.0, 1.728, 0.0, 0.12, 0.0],
    [630.0, 1.658, 0.0, 0.09, 0.0],
    [656.0, 1.524, 0.0, 0.065, 0.0],
    [667.6, 1.531, 0.0, 0.051, 0.0],
    [690.0, 1.42, 0.016, 0.028, 0.15],
    [710.0, 1.399, 0.0125, 0.018, 0.0],
    [718.0, 1.374, 1.8, 0.015, 0.0],
    [724.4, 1.373, 2.5, 0.012, 0.0],
    [740.0, 1.298, 0.061, 0.01, 0.0],
    [752.5, 1.269, 0.0008, 0.008, 0.0],
    [757.5, 1.245, 0.0001, 0.007, 0.0],
    [762.5, 1.223, 1e-05, 0.006, 4.0],
    [767.5, 1.205, 1e-05, 0.005, 0.35],
    [780.0, 1.183, 0.0006, 0.0, 0.0],
    [800.0, 1.148, 0.036, 0.0, 0.0],
    [816.0, 1.091, 1.6, 0.0, 0.0],
    [823.7, 1.062, 2.5, 0.0, 0.0],
    [831.5, 1.038, 0.5, 0.0, 0.0],
    [840.0, 1.022, 0.155, 0.0, 0.0],
    [860.0, 0.9987, 1e-05, 0.0, 0.0],
    [880.0, 0.9472, 0.0026, 0.0, 0.0],
    [905.0, 0.8932, 7.0, 0.0, 0.0],
];

/// Transmittances at a wavelength, each in the order of [`CAUSES`].
struct Air {
    /// Relative mass of the air, and of the layer of ozone.
    mass: f64,
    ozone_mass: f64,
    water: f64,
    ozone: f64,
    haze: f64,
}

const CAUSES: [&str; 5] = ["molecules", "haze", "water", "ozone", "oxygen and other gases"];

impl Air {
    fn transmittances(&self, [nm, _, water, ozone, mixed]: [f64; 5]) -> [f64; 5] {
        let (square, mass) = ((1e-3 * nm).powi(2), self.mass);
        let (wet, gases) = (water * self.water * mass, mixed * mass);
        [
            (-mass / (square * square * (115.6406 - 1.335 / square))).exp(),
            (-self.haze * (nm / 500.0).powf(-1.14) * mass).exp(),
            (-0.2385 * wet / (1.0 + 20.07 * wet).powf(0.45)).exp(),
            (-ozone * self.ozone * self.ozone_mass).exp(),
            (-1.41 * gases / (1.0 + 118.93 * gases).powf(0.45)).exp(),
        ]
    }
}

/// Equivalent width, nm, of what oxygen takes between two rows of the table for an air mass of one.
#[cfg(test)]
pub(super) fn taken_by_oxygen(range: std::ops::RangeInclusive<f64>) -> f64 {
    let air = Air { mass: 1.0, ozone_mass: 1.0, water: 0.0, ozone: 0.0, haze: 0.0 };
    let rows: Vec<_> =
        TABLE.iter().filter(|r| range.contains(&r[0])).map(|r| (r[0], air.transmittances(*r)[4])).collect();
    rows.windows(2).map(|w| (w[1].0 - w[0].0) * (1.0 - 0.5 * (w[0].1 + w[1].1))).sum()
}

/// A row between those of the table; the last one beyond them.
fn row(nm: f64) -> [f64; 5] {
    let next = TABLE.iter().position(|r| r[0] >= nm).unwrap_or(TABLE.len() - 1).max(1);
    let (a, b) = (TABLE[next - 1], TABLE[next]);
    let t = ((nm - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

fn run(values: &Values) -> Result<Report, Error> {
    let elevation = values.number("elevation");
    let (sine, layer) = (elevation.to_radians().sin(), 22.0 / 6370.0);
    let air = Air {
        mass: (sine + 0.15 * (elevation + 3.885).powf(-1.253)).recip(),
        ozone_mass: (1.0 + layer) / (sine * sine + 2.0 * layer).sqrt(),
        water: values.number("water"),
        ozone: values.number("ozone"),
        haze: values.number("haze"),
    };
    let all = |r: [f64; 5]| air.transmittances(r).into_iter().product::<f64>();
    let mut report = Report::default();
    report.quantity("relative air mass", air.mass, "");
    let here = row(values.number("wavelength"));
    for (cause, t) in CAUSES.into_iter().zip(air.transmittances(here)) {
        report.quantity(format!("left by {cause}"), t, "");
    }
    report.quantity("left of the light", all(here), "");
    // By the trapezium rule between the rows of the table.
    let sum = |f: &dyn Fn([f64; 5]) -> f64| -> f64 {
        TABLE.windows(2).map(|w| 0.5 * (f(w[0]) + f(w[1])) * (w[1][0] - w[0][0])).sum()
    };
    report.quantity("irradiance above the air, 300 to 905 nm", sum(&|r| r[1]), "W/m²");
    report.quantity("direct irradiance below it, 300 to 905 nm", sum(&|r| r[1] * all(r)), "W/m²");
    report.quantity(
        "share below 320 nm that is left",
        {
            let short = |f: &dyn Fn([f64; 5]) -> f64| sum(&|r| if r[0] <= 320.0 { f(r) } else { 0.0 });
            short(&|r| r[1] * all(r)) / short(&|r| r[1])
        },
        "",
    );
    let xyz: DVec3 = (380..=780)
        .map(f64::from)
        .map(|nm| (nm, row(nm)))
        .map(|(nm, r)| DVec3::from(cie::matching_linear(nm)) * (r[1] * all(r)))
        .sum();
    for (name, c) in ["red", "green", "blue"].into_iter().zip(rgb_from_xyz_in_gamut(xyz / xyz.y.max(1e-30))) {
        report.quantity(format!("colour of the sun at luminance 1, {name}"), f64::from(c), "");
    }
    let curve = |f: &dyn Fn([f64; 5]) -> f64| TABLE.iter().map(|r| (r[0], f(*r))).collect::<Vec<_>>();
    let mut chart =
        Chart::new("sunlight through the air", Axis::linear("wavelength (nm)"), Axis::linear("share that is left"));
    for (k, cause) in CAUSES.into_iter().enumerate() {
        chart = chart.with(Series::line(cause, curve(&|r| air.transmittances(r)[k])).drawn(Marker::Dashed));
    }
    report.chart = Some(chart.with(Series::line("all", curve(&all)).colored([0x11, 0x11, 0x11])));
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(given: &[(&str, &str)]) -> Report {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// The sun overhead has an air mass of 1, at 30° of 2, at the horizon 38 (Kasten: 36.5 to 38); molecules have the
    /// optical depth of Hansen and Travis to a hundredth, 0.0973 at 550 nm; oxygen's A band
    /// takes 0.30 of 762.5 nm, `1 − exp(−5.64/476.72^0.45)`.
    #[test]
    fn masses_and_depths_are_the_known_ones() {
        let mass = |h: &str| with(&[("elevation", h)]).value("relative air mass");
        assert!((mass("90") - 1.0).abs() < 1e-3 && (mass("30") - 2.0).abs() < 0.01);
        assert!((25.0..38.0).contains(&mass("0.5")), "{}", mass("0.5"));
        for (nm, depth) in [("400", 0.3641), ("550", 0.0973), ("700", 0.0365)] {
            let r = with(&[("elevation", "90"), ("wavelength", nm)]);
            let found = -r.value("left by molecules").ln() / r.value("relative air mass");
            assert!((found / depth - 1.0).abs() < 0.02, "{nm}: {found}");
        }
        let band = with(&[("elevation", "90"), ("wavelength", "762.5")]);
        assert!((band.value("left by oxygen and other gases") - 0.7036).abs() < 1e-3);
        let clear = with(&[("wavelength", "780")]);
        assert!(clear.value("left by oxygen and other gases") > 0.999 && clear.value("left by ozone") > 0.999);
    }

    /// Ozone takes nearly all below 320 nm, and in the orange a few per cent (Chappuis); the low sun is red.
    #[test]
    fn ozone_and_dusk() {
        let noon = with(&[("elevation", "60"), ("wavelength", "610")]);
        assert!(noon.value("share below 320 nm that is left") < 0.25);
        assert!((0.94..0.97).contains(&noon.value("left by ozone")), "{}", noon.value("left by ozone"));
        let color =
            |h: &str, c: &str| with(&[("elevation", h)]).value(&format!("colour of the sun at luminance 1, {c}"));
        assert!(color("90", "blue") > 0.75 && color("2", "red") > 1.8 && color("2", "blue") < 0.1);
        // The solar constant is 1361 W/m², of which 62 to 63 % lie between 300 and 905 nm (ASTM E490).
        let above = noon.value("irradiance above the air, 300 to 905 nm");
        assert!((0.615..0.64).contains(&(above / 1361.0)), "{above}");
    }
}

//! Fraunhofer diffraction by a circular aperture: the Airy disc.
//!
//! `I(θ)/I(0) = (2 J₁(v)/v)²`, `v = π D sin θ / λ`; a share `1 − J₀² − J₁²` of the light is within `v` (Born, Wolf,
//! *Principles of Optics*, §8.5.2).

use super::bessel::bessel_j;
use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, monochromatic,
};
use std::f64::consts::PI;

pub const EXPERIMENT: Experiment = Experiment {
    name: "aperture",
    doc: "diffraction by a circular aperture (Airy disc) and the resolution of lenses and eyes",
    source: "Born, Wolf, Principles of Optics, eqs. 8.5.14 and 8.5.18",
    parameters: &[
        Parameter::number("diameter", 3.0, (1e-3, 1e5), "mm", "of the aperture, such as the pupil of an eye"),
        Parameter::number("wavelength", 550.0, (1.0, 1e6), "nm", "of the light"),
        Parameter::number("rings", 5.0, (0.5, 50.0), "", "dark rings that the picture shows"),
        Parameter::number(
            "exposure",
            3.0,
            (-20.0, 20.0),
            "EV",
            "of the picture; 0 makes the middle as bright as white",
        ),
    ],
    run: Run::Alone(run),
};

/// Relative intensity at `v = π D sin θ / λ`.
pub(super) fn airy(v: f64) -> f64 {
    if v.abs() < 1e-6 { 1.0 } else { (2.0 * bessel_j(1, v) / v).powi(2) }
}

/// The first zero of J₁ after `from`, by bisection of a change of sign.
fn next_zero(from: f64) -> f64 {
    let mut a = from;
    while bessel_j(1, a) * bessel_j(1, a + 0.1) > 0.0 {
        a += 0.1;
    }
    let mut b = a + 0.1;
    for _ in 0..60 {
        let m = 0.5 * (a + b);
        if bessel_j(1, a) * bessel_j(1, m) > 0.0 { a = m } else { b = m }
    }
    0.5 * (a + b)
}

fn run(values: &Values) -> Result<Report, Error> {
    let (diameter, lambda) = (values.number("diameter") * 1e-3, values.number("wavelength") * 1e-9);
    let zero = next_zero(1.0);
    let sine = zero * lambda / (PI * diameter);
    let mut report = Report::default();
    report.quantity("first dark ring, sin θ D/λ", zero / PI, "");
    if sine <= 1.0 {
        report.quantity("first dark ring", sine.asin().to_degrees() * 3600.0, "″");
    }
    report.quantity("light within it", 1.0 - bessel_j(0, zero).powi(2) - bessel_j(1, zero).powi(2), "");
    let first_ring = (1..400).map(|k| airy(zero + 0.008 * f64::from(k))).fold(0.0, f64::max);
    report.quantity("brightest place of the first bright ring", first_ring, "");
    let reach = values.number("rings") * PI * 1.1;
    let points = (0..=1000).map(|k| reach * f64::from(k) / 1000.0).map(|v| (v / PI, airy(v))).collect();
    report.chart = Some(
        Chart::new(
            format!("Airy disc of {} mm at {} nm", diameter * 1e3, lambda * 1e9),
            Axis::linear("sin θ · D/λ"),
            Axis::log("relative intensity").over(1e-5, 1.0),
        )
        .with(Series::line("intensity", points)),
    );
    const EDGE: usize = 512;
    let (color, gain) = (monochromatic(lambda * 1e9), values.number("exposure").exp2());
    let brightest = color.iter().copied().fold(0.0, f32::max);
    let color = if brightest > 0.0 { color.map(|c| c / brightest) } else { [1.0; 3] };
    // By radius once; the picture interpolates.
    let table: Vec<f64> = (0..=4096).map(|k| airy(1.5 * reach * f64::from(k) / 4096.0)).collect();
    let picture = Picture::from_fn(EDGE, EDGE, |x, y| {
        let (x, y) = (x as f64 + 0.5 - EDGE as f64 / 2.0, y as f64 + 0.5 - EDGE as f64 / 2.0);
        let at = x.hypot(y) / (EDGE as f64 / 2.0) / 1.5 * 4096.0;
        let (k, t) = (at as usize, at.fract());
        let i = table[k.min(4096)] * (1.0 - t) + table[(k + 1).min(4096)] * t;
        color.map(|c| c * (i * gain) as f32)
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M133: 1.21967 λ/D; 83.8 % of the light within; the first bright ring has 1.75 % of the middle.
    #[test]
    fn the_rings_are_those_in_print() {
        let report = EXPERIMENT.run(&[], None).unwrap();
        assert!((report.value("first dark ring, sin θ D/λ") - 1.219_669_891_266_504).abs() < 1e-12);
        assert!((report.value("light within it") - 0.837_785).abs() < 1e-6);
        assert!((report.value("brightest place of the first bright ring") - 0.017_498).abs() < 1e-6);
    }
}

//! Polarisation: Fresnel's reflectances of light polarised perpendicular (s) and parallel (p) to the plane of
//! incidence, Brewster's angle `tan θ_B = n₂/n₁`, the degree of polarisation of what is reflected, and Malus's law
//! `I = I₀ cos² α` behind two polarisers (Born, Wolf, *Principles of Optics*, §1.5).

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use steradian_math::golden_section::golden_section;

pub const EXPERIMENT: Experiment = Experiment {
    name: "polarization",
    doc: "reflectance of polarised light by angle, Brewster's angle, total reflection, Malus's law",
    source: "Born, Wolf, Principles of Optics, eqs. 1.5.21 and 1.5.26",
    parameters: &[
        Parameter::number("outside", 1.0, (0.1, 10.0), "", "index on the side of the light"),
        Parameter::number("inside", 1.5, (0.1, 10.0), "", "index on the other side"),
        Parameter::number("polarizers", 30.0, (-360.0, 360.0), "°", "angle between two polarisers, for Malus's law"),
    ],
    run: Run::Alone(run),
};

/// Reflectances (s, p) at an angle of incidence.
fn reflectances(n1: f64, n2: f64, theta: f64) -> (f64, f64) {
    let (ci, sine) = (theta.cos(), n1 / n2 * theta.sin());
    if sine >= 1.0 {
        return (1.0, 1.0);
    }
    let ct = (1.0 - sine * sine).sqrt();
    let s = (n1 * ci - n2 * ct) / (n1 * ci + n2 * ct);
    let p = (n2 * ci - n1 * ct) / (n2 * ci + n1 * ct);
    (s * s, p * p)
}

fn run(values: &Values) -> Result<Report, Error> {
    let (n1, n2) = (values.number("outside"), values.number("inside"));
    let at = |degrees: f64| reflectances(n1, n2, degrees.to_radians());
    let degree = |degrees: f64| {
        let (s, p) = at(degrees);
        if s + p > 0.0 { (s - p) / (s + p) } else { 0.0 }
    };
    // The angle where p is least, found on the curve itself.
    let limit = if n1 > n2 { (n2 / n1).asin().to_degrees() } else { 90.0 };
    let brewster = golden_section(|degrees| at(degrees).1, 0.0, limit);
    let mut report = Report::default();
    report.quantity("reflectance at 0°", at(0.0).0, "");
    report.quantity("angle without p (Brewster)", brewster, "°");
    report.quantity("degree of polarisation there", degree(brewster), "");
    if n1 > n2 {
        report.quantity("angle of total reflection", limit, "°");
    }
    let malus = values.number("polarizers").to_radians().cos().powi(2);
    report.quantity("transmitted by the second polariser (Malus)", malus, "");
    let curve = |f: &dyn Fn(f64) -> f64| (0..=900).map(|k| f64::from(k) / 10.0).map(|t| (t, f(t))).collect::<Vec<_>>();
    report.chart = Some(
        Chart::new(
            format!("from index {n1} to {n2}"),
            Axis::linear("angle of incidence (°)"),
            Axis::linear("reflectance; degree of polarisation").over(0.0, 1.0),
        )
        .with(Series::line("s", curve(&|t| at(t).0)))
        .with(Series::line("p", curve(&|t| at(t).1)))
        .with(Series::line("unpolarised", curve(&|t| 0.5 * (at(t).0 + at(t).1))))
        .with(Series::line("degree of polarisation", curve(&degree)).drawn(crate::laboratory::Marker::Dashed)),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::polarization::{Complex, Mueller, fresnel_reflection};

    /// M131: Brewster's angle of glass is 56.3099°, and what is reflected there is polarised completely.
    #[test]
    fn brewster_and_malus() {
        let report = EXPERIMENT.run(&[], None).unwrap();
        assert!((report.value("angle without p (Brewster)") - 1.5f64.atan().to_degrees()).abs() < 1e-5);
        assert!((report.value("degree of polarisation there") - 1.0).abs() < 1e-9);
        assert!((report.value("reflectance at 0°") - 0.04).abs() < 1e-12);
        assert!((report.value("transmitted by the second polariser (Malus)") - 0.75).abs() < 1e-12);
    }

    /// The renderer's Mueller matrices say the same, and two polarisers one after the other follow Malus's law.
    #[test]
    fn mueller_matrices_agree() {
        for degrees in [0.0, 30.0, 56.31, 80.0_f64] {
            let (s, p) = reflectances(1.0, 1.5, degrees.to_radians());
            let m = fresnel_reflection(degrees.to_radians().cos(), [Complex::new(1.5, 0.0); 4]);
            let light = m.of_unpolarized(steradian_math::Spectrum::ONE);
            assert!((f64::from(light.0[0][0]) - 0.5 * (s + p)).abs() < 1e-6);
            assert!((f64::from(light.linear_degree()[0]) - ((s - p) / (s + p)).abs()).abs() < 1e-5);
        }
        for degrees in [0.0, 30.0, 45.0, 90.0_f32] {
            let both = Mueller::polarizer(degrees.to_radians()) * Mueller::polarizer(0.0);
            let through = both.of_unpolarized(steradian_math::Spectrum::ONE).0[0][0];
            assert!((through - 0.5 * degrees.to_radians().cos().powi(2)).abs() < 1e-6);
        }
    }
}

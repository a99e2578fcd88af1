//! Fraunhofer diffraction by equal parallel slits.
//!
//! `I(θ)/I(0) = (sin β / β)² (sin Nγ / (N sin γ))²` with `β = π a sin θ / λ`, `γ = π d sin θ / λ` for `N` slits of
//! width `a` at the spacing `d` (Born, Wolf, *Principles of Optics*, §8.5.2 and §8.6.1).

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, monochromatic,
    rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use std::f64::consts::PI;
use steradian_math::spectra::{cie, named};

pub const EXPERIMENT: Experiment = Experiment {
    name: "slits",
    doc: "diffraction by one, two or more slits, on a distant screen",
    source: "Born, Wolf, Principles of Optics, eqs. 8.5.2 and 8.6.1",
    parameters: &[
        Parameter::count("count", 2, (1, 1000), "number of slits"),
        Parameter::number("width", 20.0, (0.01, 1e5), "µm", "width of a slit"),
        Parameter::number("spacing", 100.0, (0.01, 1e6), "µm", "from the middle of a slit to that of the next"),
        Parameter::number(
            "wavelength",
            550.0,
            (1.0, 1e6),
            "nm",
            "of the light; the picture of visible light has its colour",
        ),
        Parameter::choice("light", &["line", "white"], "one wavelength, or daylight (D65) in the picture"),
        Parameter::number("distance", 1.0, (1e-3, 1e6), "m", "to the screen"),
        Parameter::number("screen", 60.0, (1e-3, 1e6), "mm", "width of the screen"),
    ],
    run: Run::Alone(run),
};

/// Relative intensity at `sin θ`; lengths in metres.
pub(super) fn intensity(sin: f64, count: usize, width: f64, spacing: f64, lambda: f64) -> f64 {
    let beta = PI * width * sin / lambda;
    let envelope = if beta.abs() < 1e-8 { 1.0 } else { beta.sin() / beta };
    // sin Nγ / sin γ has period π up to its sign; near its poles it is N.
    let gamma = PI * spacing * sin / lambda;
    let gamma = gamma - PI * (gamma / PI).round();
    let n = count as f64;
    let fringes = if gamma.abs() < 1e-8 { 1.0 } else { (n * gamma).sin() / (n * gamma.sin()) };
    (envelope * fringes).powi(2)
}

fn run(values: &Values) -> Result<Report, Error> {
    let (count, width) = (values.count("count"), values.number("width") * 1e-6);
    let (spacing, lambda) = (values.number("spacing") * 1e-6, values.number("wavelength") * 1e-9);
    let (distance, screen) = (values.number("distance"), values.number("screen") * 1e-3);
    if count > 1 && spacing < width {
        return Err(Error::Impossible("slits overlap: 'spacing' is less than 'width'".into()));
    }
    let sin_at = |x: f64| x / x.hypot(distance);
    let mut report = Report::default();
    if lambda <= width {
        report.quantity("first minimum of a slit", (lambda / width).asin().to_degrees(), "°");
    }
    if count > 1 && lambda <= spacing {
        report.quantity("first order", (lambda / spacing).asin().to_degrees(), "°");
        report.quantity("spacing of fringes near the middle", 1e3 * distance * lambda / spacing, "mm");
    }
    const POINTS: usize = 4000;
    let place = |k: usize| screen * (k as f64 / (POINTS - 1) as f64 - 0.5);
    let points: Vec<_> =
        (0..POINTS).map(|k| (place(k) * 1e3, intensity(sin_at(place(k)), count, width, spacing, lambda))).collect();
    report.chart = Some(
        Chart::new(
            format!("{count} slits of {} µm, {} nm", width * 1e6, lambda * 1e9),
            Axis::linear("place on the screen (mm)"),
            Axis::linear("relative intensity").over(0.0, 1.0),
        )
        .with(Series::line("intensity", points)),
    );
    const COLUMNS: usize = 960;
    let is_white = values.choice("light") == "white";
    let color = |sin: f64| -> [f32; 3] {
        if !is_white {
            return monochromatic(lambda * 1e9).map(|c| c * intensity(sin, count, width, spacing, lambda) as f32);
        }
        let xyz: DVec3 = (380..=780)
            .step_by(4)
            .map(|nm| {
                let power = f64::from(named::d65().eval(nm as f32)) * 4.0;
                let i = intensity(sin, count, width, spacing, f64::from(nm) * 1e-9);
                DVec3::from(cie::matching_linear(f64::from(nm))) * (power * i / cie::CIE_Y_INTEGRAL)
            })
            .sum();
        rgb_from_xyz_in_gamut(xyz)
    };
    // Fringes narrower than a pixel are averaged.
    let columns: Vec<[f32; 3]> = (0..COLUMNS)
        .map(|x| {
            let mut sum = [0.0; 3];
            for k in 0..8 {
                let u = (x as f64 + (f64::from(k) + 0.5) / 8.0) / COLUMNS as f64 - 0.5;
                let c = color(sin_at(screen * u));
                sum = std::array::from_fn(|i| sum[i] + c[i] / 8.0);
            }
            sum
        })
        .collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| columns[x]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M133: zeros of one slit at a sin θ = mλ, maxima of a grating at d sin θ = mλ, N − 2 maxima between them.
    #[test]
    fn zeros_and_maxima_are_where_they_belong() {
        let (a, d, lambda) = (20e-6, 100e-6, 550e-9);
        for m in 1..10 {
            let m = f64::from(m);
            assert!(intensity(m * lambda / a, 1, a, d, lambda) < 1e-20);
            let envelope = intensity(m * lambda / d, 1, a, d, lambda);
            for count in [2, 5, 100] {
                assert!((intensity(m * lambda / d, count, a, d, lambda) - envelope).abs() < 1e-9);
            }
            // Midway between two orders two slits cancel.
            assert!(intensity((m - 0.5) * lambda / d, 2, a, d, lambda) < 1e-20);
        }
        let n = 6;
        let row: Vec<f64> =
            (1..2000).map(|k| intensity(f64::from(k) / 2000.0 * lambda / d, n, 1e-9, d, lambda)).collect();
        let maxima = row.windows(3).filter(|w| w[1] > w[0] && w[1] > w[2]).count();
        assert_eq!(maxima, n - 2);
    }

    /// Energy: ∫ (sin β/β)² dβ = π, so the intensity over sin θ integrates to λ/a.
    #[test]
    fn the_light_of_a_slit_is_all_there() {
        let (a, lambda) = (20e-6, 550e-9);
        let n = 2_000_000;
        let far = 4000.0 * lambda / a;
        let sum: f64 =
            (0..n).map(|k| intensity((f64::from(k) + 0.5) / f64::from(n) * far, 1, a, a, lambda)).sum::<f64>()
                * 2.0
                * far
                / f64::from(n);
        // What lies beyond m = 4000 is 1/(π² 4000) of it.
        assert!((sum / (lambda / a) - 1.0).abs() < 5e-5, "{}", sum / (lambda / a));
    }

    #[test]
    fn slits_that_overlap_are_refused() {
        let given = [("spacing".to_owned(), "10".to_owned())];
        assert!(EXPERIMENT.run(&given, None).is_err());
    }
}

//! A thin film between two media: Airy's sum `r = (r₁₂ + r₂₃ e^{2iβ})/(1 + r₁₂ r₂₃ e^{2iβ})`, `β = 2π n₂ d cos θ₂/λ`,
//! for both polarisations (Born, Wolf, *Principles of Optics*, §1.6.4).

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use rustfft::num_complex::Complex;
use std::f64::consts::TAU;
use steradian_math::spectra::{cie, named};

type C = Complex<f64>;

pub const EXPERIMENT: Experiment = Experiment {
    name: "film",
    doc: "light reflected and transmitted by a thin film: soap, oil, coatings (Newton's colours)",
    source: "Born, Wolf, Principles of Optics, eqs. 1.6.60 and 1.6.61",
    parameters: &[
        Parameter::number("outside", 1.0, (1.0, 5.0), "", "index on the side of the light"),
        Parameter::number("film", 1.33, (1.0, 5.0), "", "index of the film"),
        Parameter::number("inside", 1.0, (1.0, 5.0), "", "index behind the film"),
        Parameter::number("angle", 0.0, (0.0, 89.9), "°", "angle of incidence"),
        Parameter::number("thickness", 300.0, (0.0, 1e5), "nm", "whose reflectance is told"),
        Parameter::number("to", 1500.0, (10.0, 1e5), "nm", "greatest thickness of chart and picture"),
    ],
    run: Run::Alone(run),
};

/// Cosine of the refracted direction, imaginary beyond total reflection.
fn cosine(n1: f64, n: f64, sine: f64) -> C {
    let root = C::new(1.0 - (n1 / n * sine).powi(2), 0.0).sqrt();
    // Evanescent waves fade away from the surface.
    if root.im < 0.0 { -root } else { root }
}

/// Reflected and transmitted shares of unpolarised light; thickness and wavelength in nm.
fn shares(n: [f64; 3], thickness: f64, lambda: f64, theta: f64) -> (f64, f64) {
    let sine = theta.sin();
    let c = n.map(|m| cosine(n[0], m, sine));
    let beta = c[1] * (TAU * n[1] * thickness / lambda);
    let turn = (C::i() * beta * 2.0).exp();
    let mut sum = (0.0, 0.0);
    for is_p in [false, true] {
        let q = |k: usize| if is_p { c[k] / n[k] } else { c[k] * n[k] };
        let r = |a: usize, b: usize| (q(a) - q(b)) / (q(a) + q(b));
        let t = |a: usize, b: usize| q(a) * 2.0 / (q(a) + q(b));
        let below = C::from(1.0) + r(0, 1) * r(1, 2) * turn;
        let reflected = (r(0, 1) + r(1, 2) * turn) / below;
        let transmitted = t(0, 1) * t(1, 2) * (C::i() * beta).exp() / below;
        sum.0 += 0.5 * reflected.norm_sqr();
        sum.1 += 0.5 * transmitted.norm_sqr() * q(2).re / q(0).re;
    }
    sum
}

fn run(values: &Values) -> Result<Report, Error> {
    let n = [values.number("outside"), values.number("film"), values.number("inside")];
    let (theta, most) = (values.number("angle").to_radians(), values.number("to"));
    let mut report = Report::default();
    let (r, t) = shares(n, values.number("thickness"), 550.0, theta);
    report.quantity("reflectance at 550 nm", r, "");
    report.quantity("transmittance at 550 nm", t, "");
    report.quantity("reflectance + transmittance", r + t, "");
    let mut chart = Chart::new(
        format!("film of index {} between {} and {}", n[1], n[0], n[2]),
        Axis::linear("thickness (nm)"),
        Axis::linear("reflectance"),
    );
    for (nm, color) in [(650.0, [200, 40, 30]), (550.0, [40, 140, 50]), (450.0, [40, 70, 190])] {
        let points = (0..=800).map(|k| most * f64::from(k) / 800.0).map(|d| (d, shares(n, d, nm, theta).0)).collect();
        chart = chart.with(Series::line(format!("{nm} nm"), points).colored(color));
    }
    report.chart = Some(chart);
    const COLUMNS: usize = 960;
    let columns: Vec<DVec3> = (0..COLUMNS)
        .map(|x| most * (x as f64 + 0.5) / COLUMNS as f64)
        .map(|d| {
            (380..=780)
                .step_by(4)
                .map(|nm| {
                    let power = 4.0 * f64::from(named::d65().eval(nm as f32)) / cie::CIE_Y_INTEGRAL;
                    let r = shares(n, d, f64::from(nm), theta).0;
                    DVec3::from(cie::matching_linear(f64::from(nm))) * (power * r)
                })
                .sum()
        })
        .collect();
    let brightest = columns.iter().map(|c| c.y).fold(1e-30, f64::max);
    let rgb: Vec<[f32; 3]> = columns.iter().map(|c| rgb_from_xyz_in_gamut(*c * (0.9 / brightest))).collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| rgb[x]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M132: R + T = 1; a half wave changes nothing; a quarter wave of √(n₁n₃) reflects nothing.
    #[test]
    fn energy_half_waves_and_quarter_waves() {
        for (n, degrees) in
            [([1.0, 1.33, 1.0], 0.0), ([1.0, 1.38, 1.52], 45.0), ([1.5, 1.0, 1.5], 60.0), ([1.0, 2.4, 1.5], 80.0_f64)]
        {
            for d in [0.0, 37.0, 300.0, 5000.0] {
                let (r, t) = shares(n, d, 550.0, degrees.to_radians());
                assert!((r + t - 1.0).abs() < 1e-12 && r >= 0.0 && t >= 0.0, "{n:?} {degrees} {d}: {r} {t}");
            }
        }
        let bare = ((1.52f64 - 1.0) / (1.52 + 1.0)).powi(2);
        assert!((shares([1.0, 2.0, 1.52], 550.0 / 4.0, 550.0, 0.0).0 - bare).abs() < 1e-12);
        assert!(shares([1.0, 1.52f64.sqrt(), 1.52], 550.0 / (4.0 * 1.52f64.sqrt()), 550.0, 0.0).0 < 1e-25);
    }

    /// A gap of air in glass thinner than a wavelength lets light through beyond the angle of total reflection.
    #[test]
    fn light_tunnels_through_a_thin_gap() {
        let t = |d: f64| shares([1.5, 1.0, 1.5], d, 550.0, 50f64.to_radians()).1;
        assert!(t(20.0) > 0.9 && t(300.0) < t(200.0) && t(3000.0) < 1e-6);
    }
}

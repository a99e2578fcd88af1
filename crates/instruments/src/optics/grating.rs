//! A diffraction grating: its orders, `d (sin θ_m − sin θ_i) = m λ`, and its resolving power `λ/Δλ = m N`
//! (Born, Wolf, *Principles of Optics*, §8.6.1).

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use steradian_math::spectra::{cie, named};

pub const EXPERIMENT: Experiment = Experiment {
    name: "grating",
    doc: "orders of a diffraction grating, and the spectra that it spreads white light into",
    source: "Born, Wolf, Principles of Optics, eq. 8.6.8",
    parameters: &[
        Parameter::number("lines", 625.0, (0.1, 1e5), "1/mm", "lines for each millimetre (a CD has 625)"),
        Parameter::number("incidence", 0.0, (-89.9, 89.9), "°", "angle of incidence"),
        Parameter::number("wavelength", 550.0, (1.0, 1e6), "nm", "whose orders are listed"),
        Parameter::number("beam", 10.0, (1e-3, 1e5), "mm", "width of the grating that is lit"),
    ],
    run: Run::Alone(run),
};

/// Sine of the angle of an order; lengths in metres. `None` where the order does not exist.
fn order_sine(m: i32, lambda: f64, spacing: f64, incidence_sine: f64) -> Option<f64> {
    let s = incidence_sine + f64::from(m) * lambda / spacing;
    (s.abs() <= 1.0).then_some(s)
}

fn run(values: &Values) -> Result<Report, Error> {
    let spacing = 1e-3 / values.number("lines");
    let incidence = values.number("incidence").to_radians().sin();
    let lambda = values.number("wavelength") * 1e-9;
    let grooves = values.number("beam") * values.number("lines");
    let mut report = Report::default();
    report.quantity("spacing of lines", spacing * 1e6, "µm");
    let orders = || (-1000..=1000).filter_map(|m| order_sine(m, lambda, spacing, incidence).map(|s| (m, s)));
    for (m, sine) in orders().filter(|o| o.0.abs() <= 8) {
        report.quantity(format!("order {m}"), sine.asin().to_degrees(), "°");
        if m > 0 {
            report.quantity(format!("resolving power of order {m}"), f64::from(m) * grooves, "");
        }
    }
    let mut chart = Chart::new(
        format!("{} lines/mm at {}°", values.number("lines"), values.number("incidence")),
        Axis::linear("wavelength (nm)"),
        Axis::linear("angle (°)"),
    );
    for m in -3..=3 {
        let points: Vec<_> = (380..=780)
            .filter_map(|nm| {
                let s = order_sine(m, f64::from(nm) * 1e-9, spacing, incidence)?;
                Some((f64::from(nm), s.asin().to_degrees()))
            })
            .collect();
        if !points.is_empty() {
            chart = chart.with(Series::line(format!("order {m}"), points));
        }
    }
    report.chart = Some(chart);
    // The light that arrives between −90° and 90°, all orders equally strong; a wavelength's power is spread by dλ/dθ.
    const COLUMNS: usize = 960;
    let mut columns = vec![DVec3::ZERO; COLUMNS];
    for step in 0..4000 {
        let nm = 380.0 + 400.0 * (f64::from(step) + 0.5) / 4000.0;
        let weight = f64::from(named::d65().eval(nm as f32)) * 0.1 / cie::CIE_Y_INTEGRAL;
        let xyz = DVec3::from(cie::matching_linear(nm)) * weight;
        for s in (-40..=40).filter_map(|m| order_sine(m, nm * 1e-9, spacing, incidence)) {
            let x = (s.asin().to_degrees() + 90.0) / 180.0 * COLUMNS as f64;
            columns[(x as usize).min(COLUMNS - 1)] += xyz;
        }
    }
    let strongest = columns.iter().map(|c| c.y).fold(0.0, f64::max).max(1e-30);
    // The zeroth order is white and in one column; the picture is exposed for the spectra.
    let exposure = (4.0 * COLUMNS as f64 / 180.0).min(1.0 / strongest * 50.0);
    let rgb: Vec<[f32; 3]> = columns.iter().map(|c| rgb_from_xyz_in_gamut(*c * exposure)).collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| rgb[x]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M133: d sin θ = mλ; a CD under perpendicular light shows two orders of 550 nm on each side.
    #[test]
    fn orders_follow_the_grating_equation() {
        let report = EXPERIMENT.run(&[], None).unwrap();
        for m in [-2, -1, 0, 1, 2] {
            let angle = report.value(&format!("order {m}")).to_radians();
            assert!((1.6e-6 * angle.sin() - f64::from(m) * 550e-9).abs() < 1e-15, "{m}");
        }
        assert!(report.value("order 3").is_nan());
        assert_eq!(report.value("resolving power of order 2"), 2.0 * 6250.0);
    }
}

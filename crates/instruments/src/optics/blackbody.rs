//! Thermal light: Planck's law, with Wien's and Stefan and Boltzmann's laws found again from it by search and
//! quadrature, and its colour.

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use std::f64::consts::PI;
use steradian_math::{
    color::xyz::xyy_from_xyz,
    golden_section::golden_section,
    quadrature::gauss_legendre,
    spectra::{
        blackbody::{BOLTZMANN, PLANCK, SPEED_OF_LIGHT, STEFAN_BOLTZMANN, planck_wavelength},
        cie,
    },
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "blackbody",
    doc: "Planck's law at a temperature: where it is largest, how much it radiates, what colour it has",
    source: "Planck 1901; constants: SI 2019",
    parameters: &[
        Parameter::number("temperature", 6500.0, (1.0, 1e9), "K", "of the black body"),
        Parameter::number("from", 1000.0, (300.0, 1e6), "K", "left end of the picture's temperatures"),
        Parameter::number("to", 12_000.0, (300.0, 1e6), "K", "right end of the picture's temperatures"),
    ],
    run: Run::Alone(run),
};

/// ∫ B_λ dλ over all wavelengths: with `t = hc/λkT` and `u = t/(1 + t)` the integrand is smooth on (0, 1).
fn radiance(kelvin: f64) -> f64 {
    let c = PLANCK * SPEED_OF_LIGHT / (BOLTZMANN * kelvin);
    gauss_legendre(200)
        .into_iter()
        .map(|(x, w)| {
            let u = 0.5 * (x + 1.0);
            let t = u / (1.0 - u);
            let lambda = c / t;
            // dλ = c/t² dt, dt = du/(1 − u)².
            0.5 * w * planck_wavelength(lambda, kelvin) * c / (t * t) / (1.0 - u).powi(2)
        })
        .sum()
}

/// The wavelength where B_λ is largest, by golden section over the logarithm of the wavelength.
fn peak(kelvin: f64) -> f64 {
    golden_section(|l| -planck_wavelength(l.exp(), kelvin), (1e-4 / kelvin).ln(), (1e-1 / kelvin).ln()).exp()
}

/// XYZ of a black body's light at luminance 1.
fn xyz(kelvin: f64) -> glam::DVec3 {
    let xyz: glam::DVec3 = (0..=470)
        .step_by(2)
        .map(|k| 360.0 + f64::from(k))
        .map(|nm| glam::DVec3::from(cie::matching_linear(nm)) * planck_wavelength(nm * 1e-9, kelvin))
        .sum();
    if xyz.y > 0.0 { xyz / xyz.y } else { glam::DVec3::ZERO }
}

fn run(values: &Values) -> Result<Report, Error> {
    let kelvin = values.number("temperature");
    let (from, to) = (values.number("from"), values.number("to"));
    let mut report = Report::default();
    let top = peak(kelvin);
    report.quantity("wavelength of the maximum", top * 1e9, "nm");
    report.quantity("radiant exitance", PI * radiance(kelvin), "W/m²");
    report.quantity("its ratio to σT⁴", PI * radiance(kelvin) / (STEFAN_BOLTZMANN * kelvin.powi(4)), "");
    let visible: f64 = (380..780).map(|nm| planck_wavelength((f64::from(nm) + 0.5) * 1e-9, kelvin) * 1e-9).sum();
    report.quantity("share between 380 and 780 nm", visible / radiance(kelvin), "");
    let luminance: f64 = (360..=830)
        .map(|nm| planck_wavelength(f64::from(nm) * 1e-9, kelvin) * 1e-9 * cie::matching_linear(f64::from(nm))[1])
        .sum();
    report.quantity("luminance", 683.0 * luminance, "cd/m²");
    let [x, y, _] = xyy_from_xyz(xyz(kelvin));
    report.quantity("chromaticity x", x, "");
    report.quantity("chromaticity y", y, "");
    let (least, most) = ((top * 0.1).min(300e-9), (top * 10.0).max(800e-9));
    let points = (0..=600)
        .map(|k| least * (most / least).powf(f64::from(k) / 600.0))
        .map(|l| (l * 1e9, planck_wavelength(l, kelvin) * 1e-9))
        .collect();
    let largest = planck_wavelength(top, kelvin) * 1e-9;
    report.chart = Some(
        Chart::new(
            format!("black body of {kelvin} K"),
            Axis::log("wavelength (nm)"),
            Axis::log("spectral radiance (W/(m² sr nm))").over(largest * 1e-4, largest * 2.0),
        )
        .with(Series::line("B_λ", points)),
    );
    const COLUMNS: usize = 960;
    let colors: Vec<[f32; 3]> = (0..COLUMNS)
        .map(|c| from + (to - from) * (c as f64 + 0.5) / COLUMNS as f64)
        .map(|t| {
            // As bright as its strongest component allows.
            let rgb = rgb_from_xyz_in_gamut(xyz(t));
            let strongest = rgb.iter().copied().fold(1e-30, f32::max);
            rgb.map(|v| v / strongest)
        })
        .collect();
    report.picture = Some(Picture::from_fn(COLUMNS, 160, |x, _| colors[x]).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M134, M135: Wien's 445.81 nm at 6500 K, σT⁴, and the chromaticity of the Planckian locus at 6500 K (0.3135,
    /// 0.3236).
    #[test]
    fn the_laws_follow_from_plancks() {
        let report = EXPERIMENT.run(&[], None).unwrap();
        assert!((report.value("wavelength of the maximum") - 445.81).abs() < 0.005);
        for kelvin in [3.0, 300.0, 5778.0, 1e6] {
            let ratio = PI * radiance(kelvin) / (STEFAN_BOLTZMANN * f64::powi(kelvin, 4));
            assert!((ratio - 1.0).abs() < 1e-8, "{kelvin}: {ratio}");
        }
        assert!((report.value("chromaticity x") - 0.3135).abs() < 2e-4);
        assert!((report.value("chromaticity y") - 0.3236).abs() < 2e-4);
        assert!((planck_wavelength(550e-9, 5778.0) / 2.585_764e13 - 1.0).abs() < 1e-6);
    }
}

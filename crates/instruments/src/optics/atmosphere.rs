//! The colour of the sun and of the sky: single scattering in air.
//!
//! Optical depth of air from sea level upwards: `τ(λ) = 0.008569 λ⁻⁴ (1 + 0.0113 λ⁻² + 0.00013 λ⁻⁴)`, λ in µm (Hansen,
//! Travis 1974, eq. 2.30). Air thins exponentially with a scale height of 8.43 km around a globe of 6371 km; sunlight
//! is attenuated on its way in and out and scattered once with Rayleigh's phase function `3/(16π) (1 + cos²θ)`.

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use std::f64::consts::PI;
use steradian_math::spectra::{blackbody::planck_wavelength, cie};

pub const EXPERIMENT: Experiment = Experiment {
    name: "atmosphere",
    doc: "colours of the sun and the clear sky by single Rayleigh scattering",
    source: "Hansen, Travis 1974, eq. 2.30; Rayleigh 1871",
    parameters: &[
        Parameter::number("elevation", 30.0, (-5.0, 90.0), "°", "of the sun above the horizon"),
        Parameter::number("thickness", 1.0, (0.0, 10.0), "", "amount of air, relative to that above sea level"),
        Parameter::number("exposure", 0.0, (-20.0, 20.0), "EV", "of the picture"),
    ],
    run: Run::Alone(run),
};

const GLOBE: f64 = 6371.0;
const SCALE_HEIGHT: f64 = 8.43;
const TOP: f64 = 100.0;
/// Wavelengths, nm.
const LAMBDAS: std::ops::RangeInclusive<u32> = 380..=780;
const STEP: usize = 20;

/// Vertical optical depth at a wavelength in nm.
fn depth(nm: f64) -> f64 {
    let l2 = (nm * 1e-3).powi(-2);
    0.008_569 * l2 * l2 * (1.0 + 0.0113 * l2 + 0.000_13 * l2 * l2)
}

/// Amount of air on the way from a point (km from the middle of the globe) in a direction, relative to that above sea
/// level; `None` where the globe is in the way.
fn air_mass(from: DVec3, direction: DVec3) -> Option<f64> {
    let b = from.dot(direction);
    let to_edge = |radius: f64| {
        let d = b * b - from.length_squared() + radius * radius;
        (d > 0.0).then(|| d.sqrt())
    };
    if b < 0.0 && to_edge(GLOBE - 1e-6).is_some() {
        return None;
    }
    let length = -b + to_edge(GLOBE + TOP)?;
    const STEPS: u32 = 32;
    // Steps grow, as air is densest near where most rays begin.
    let sum = (0..STEPS)
        .map(|k| {
            let u = (f64::from(k) + 0.5) / f64::from(STEPS);
            let p = from + direction * (length * u * u);
            (-(p.length() - GLOBE).max(0.0) / SCALE_HEIGHT).exp() * 2.0 * u
        })
        .sum::<f64>();
    Some(sum * length / f64::from(STEPS) / SCALE_HEIGHT)
}

/// Radiance of the sky over the sun's irradiance (1/sr) in a direction, by wavelength.
fn sky(direction: DVec3, sun: DVec3, thickness: f64) -> Vec<f64> {
    let eye = DVec3::new(0.0, 0.0, GLOBE + 0.001);
    let b = eye.dot(direction);
    let length = -b + (b * b - eye.length_squared() + (GLOBE + TOP).powi(2)).max(0.0).sqrt();
    let phase = 3.0 / (16.0 * PI) * (1.0 + direction.dot(sun).powi(2));
    let mut radiance = vec![0.0; LAMBDAS.step_by(STEP).count()];
    const STEPS: u32 = 48;
    let mut before = 0.0;
    for k in 0..STEPS {
        let (u, v) = (f64::from(k) / f64::from(STEPS), f64::from(k + 1) / f64::from(STEPS));
        let (near, far) = (length * u * u, length * v * v);
        let p = eye + direction * (0.5 * (near + far));
        let air = (-(p.length() - GLOBE).max(0.0) / SCALE_HEIGHT).exp() * (far - near) / SCALE_HEIGHT;
        if let Some(sunward) = air_mass(p, sun) {
            for (r, nm) in radiance.iter_mut().zip(LAMBDAS.step_by(STEP)) {
                let tau = depth(f64::from(nm)) * thickness;
                *r += tau * air * phase * (-tau * (sunward + before + 0.5 * air)).exp();
            }
        }
        before += air;
    }
    radiance
}

/// The sun's spectrum at 5778 K, as luminance 1 without air.
fn sunlight(nm: f64) -> f64 {
    planck_wavelength(nm * 1e-9, 5778.0)
}

/// XYZ of shares of sunlight at the wavelengths.
fn xyz(shares: &[f64]) -> DVec3 {
    let white: f64 =
        LAMBDAS.step_by(STEP).map(|nm| cie::matching_linear(f64::from(nm))[1] * sunlight(f64::from(nm))).sum();
    LAMBDAS
        .step_by(STEP)
        .zip(shares)
        .map(|(nm, s)| DVec3::from(cie::matching_linear(f64::from(nm))) * sunlight(f64::from(nm)) * *s / white)
        .sum()
}

fn run(values: &Values) -> Result<Report, Error> {
    let (elevation, thickness) = (values.number("elevation").to_radians(), values.number("thickness"));
    let sun = DVec3::new(elevation.cos(), 0.0, elevation.sin());
    let eye = DVec3::new(0.0, 0.0, GLOBE + 0.001);
    let mass = air_mass(eye, sun);
    let mut report = Report::default();
    report.quantity("optical depth at 450 nm", depth(450.0) * thickness, "");
    report.quantity("optical depth at 650 nm", depth(650.0) * thickness, "");
    report.quantity("exponent of the wavelength", (depth(650.0) / depth(450.0)).ln() / (650f64 / 450.0).ln(), "");
    report.quantity("air before the sun", mass.unwrap_or(f64::INFINITY), "");
    let through = |nm: f64| mass.map_or(0.0, |m| (-depth(nm) * thickness * m).exp());
    let direct: Vec<f64> = LAMBDAS.step_by(STEP).map(|nm| through(f64::from(nm))).collect();
    report.quantity("sunlight that arrives (luminance)", xyz(&direct).y, "");
    let zenith = sky(DVec3::Z, sun, thickness);
    report.quantity("sky at the zenith (luminance over the sun's illuminance)", xyz(&zenith).y, "1/sr");
    let wavelengths = || LAMBDAS.step_by(STEP).map(f64::from);
    report.chart = Some(
        Chart::new(
            format!("sun at {}°", values.number("elevation")),
            Axis::linear("wavelength (nm)"),
            Axis::log("share of sunlight; sky in 1/sr"),
        )
        .with(Series::line("sunlight that arrives", wavelengths().zip(direct.iter().copied()).collect()))
        .with(Series::line("sky at the zenith", wavelengths().zip(zenith).collect())),
    );
    // The sky as a fisheye lens sees it, the sun's side on the right; the sun itself is drawn ten times as wide as it
    // is.
    const EDGE: usize = 256;
    let gain = 12.0 * values.number("exposure").exp2();
    let disc = rgb_from_xyz_in_gamut(xyz(&direct) * 4.0);
    let picture = Picture::from_fn(EDGE, EDGE, |px, py| {
        let (x, y) = (px as f64 + 0.5 - EDGE as f64 / 2.0, EDGE as f64 / 2.0 - py as f64 - 0.5);
        let r = x.hypot(y) / (EDGE as f64 / 2.0);
        if r >= 1.0 {
            return [0.0; 3];
        }
        let (theta, phi) = (r * PI / 2.0, y.atan2(x));
        let direction = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        if direction.dot(sun) > 2.66f64.to_radians().cos() {
            return disc;
        }
        rgb_from_xyz_in_gamut(xyz(&sky(direction, sun, thickness)) * gain)
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M140: λ⁻⁴ with a little more from dispersion; τ at 550 nm is 0.0973 (Hansen, Travis); the zenith's air mass is
    /// 1, the horizon's about 38 (Kasten, Young 1989, whose air is colder above).
    #[test]
    fn air_and_its_depth() {
        assert!((depth(550.0) - 0.0973).abs() < 5e-4, "{}", depth(550.0));
        let report = EXPERIMENT.run(&[], None).unwrap();
        let exponent = report.value("exponent of the wavelength");
        assert!((-4.15..-4.0).contains(&exponent), "{exponent}");
        let eye = DVec3::new(0.0, 0.0, GLOBE + 0.001);
        assert!((air_mass(eye, DVec3::Z).unwrap() - 1.0).abs() < 2e-3);
        let horizon = air_mass(eye, DVec3::X).unwrap();
        // ∫ for an exponential atmosphere: √(π R/2H) = 34.5 at grazing (Chapman's function).
        assert!((horizon - (PI * GLOBE / (2.0 * SCALE_HEIGHT)).sqrt()).abs() < 0.5, "{horizon}");
        assert!(air_mass(eye, -DVec3::Z).is_none());
    }

    /// A thin atmosphere: the sky at the zenith is τ P(θ).
    #[test]
    fn thin_air_scatters_in_proportion() {
        let sun = DVec3::new(0.6, 0.0, 0.8);
        let thin = sky(DVec3::Z, sun, 1e-4);
        for (r, nm) in thin.iter().zip(LAMBDAS.step_by(STEP)) {
            let exact = 1e-4 * depth(f64::from(nm)) * 3.0 / (16.0 * PI) * (1.0 + 0.64);
            assert!((r / exact - 1.0).abs() < 2e-3, "{nm}: {r} {exact}");
        }
    }
}

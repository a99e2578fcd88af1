//! Light seen by a fast observer: the Doppler factor `D = 1/(γ (1 − β cos θ'))` by the angle θ' from the direction of
//! motion as the observer sees it, aberration `cos θ' = (cos θ + β)/(1 + β cos θ)`, and radiance, which grows as `D⁴`
//! (`D⁵` for each wavelength). A black body keeps Planck's spectrum at `D` times its temperature (Rybicki, Lightman,
//! *Radiative Processes in Astrophysics*, §4.8 and §4.9).

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use std::f64::consts::PI;
use steradian_math::spectra::{blackbody::planck_wavelength, cie};

pub const EXPERIMENT: Experiment = Experiment {
    name: "doppler",
    doc: "Doppler shift, aberration and the searchlight effect for a fast observer",
    source: "Rybicki, Lightman, Radiative Processes in Astrophysics, eqs. 4.8, 4.12 and 4.97",
    parameters: &[
        Parameter::number("speed", 0.5, (0.0, 0.999_999), "c", "of the observer"),
        Parameter::number("wavelength", 550.0, (1e-3, 1e9), "nm", "of a line at rest"),
        Parameter::number("temperature", 5778.0, (100.0, 1e6), "K", "of stars all around, for the picture"),
    ],
    run: Run::Alone(run),
};

/// The Doppler factor (frequency seen over frequency at rest) by the angle seen.
fn factor(beta: f64, seen: f64) -> f64 {
    (1.0 - beta * beta).sqrt() / (1.0 - beta * seen.cos())
}

/// The angle seen of what is at an angle at rest.
fn aberration(beta: f64, angle: f64) -> f64 {
    // tan(θ'/2) = √((1 − β)/(1 + β)) tan(θ/2), which loses no digits.
    2.0 * (((1.0 - beta) / (1.0 + beta)).sqrt() * (angle / 2.0).tan()).atan()
}

fn run(values: &Values) -> Result<Report, Error> {
    let (beta, lambda) = (values.number("speed"), values.number("wavelength"));
    let mut report = Report::default();
    report.quantity("Lorentz factor γ", 1.0 / (1.0 - beta * beta).sqrt(), "");
    report.quantity("wavelength ahead", lambda / factor(beta, 0.0), "nm");
    report.quantity("wavelength abeam", lambda / factor(beta, PI / 2.0), "nm");
    report.quantity("wavelength astern", lambda / factor(beta, PI), "nm");
    report.quantity("what is abeam at rest is seen at", aberration(beta, PI / 2.0).to_degrees(), "°");
    report.quantity("radiance ahead over that at rest", factor(beta, 0.0).powi(4), "");
    // All light that meets a moving point: the mean of D⁴ over the sphere seen, γ² (1 + β²/3).
    let n = 20_000;
    let mean = (0..n)
        .map(|k| (1.0 - 2.0 * (f64::from(k) + 0.5) / f64::from(n)).acos())
        .map(|t| factor(beta, t).powi(4))
        .sum::<f64>()
        / f64::from(n);
    report.quantity("mean of radiance over all directions", mean, "");
    let degrees = || (0..=720).map(|k| f64::from(k) / 4.0);
    report.chart = Some(
        Chart::new(
            format!("at {beta} of the speed of light"),
            Axis::linear("angle seen, from the direction of motion (°)"),
            Axis::log("Doppler factor; radiance over that at rest"),
        )
        .with(Series::line("Doppler factor", degrees().map(|t| (t, factor(beta, t.to_radians()))).collect()))
        .with(Series::line("radiance", degrees().map(|t| (t, factor(beta, t.to_radians()).powi(4))).collect())),
    );
    // A sky of one temperature, with meridians and parallels of the frame at rest every 15°; the direction of motion in
    // the middle.
    let kelvin = values.number("temperature");
    let color = |d: f64| -> DVec3 {
        (0..40)
            .map(|k| 380.0 + 10.0 * (f64::from(k) + 0.5))
            .map(|nm| DVec3::from(cie::matching_linear(nm)) * planck_wavelength(nm * 1e-9, kelvin * d))
            .sum()
    };
    let white = color(1.0).y;
    if white <= 0.0 {
        return Err(Error::Impossible("at this temperature the sky has no visible light".into()));
    }
    const WIDTH: usize = 768;
    const HEIGHT: usize = 384;
    let rest = |seen: f64| aberration(-beta, seen);
    // Colours by the logarithm of the Doppler factor.
    let (least, most) = (factor(beta, PI), factor(beta, 0.0));
    let shifted: Vec<DVec3> = (0..512).map(|k| color(least * (most / least).powf(f64::from(k) / 511.0))).collect();
    let picture = Picture::from_fn(WIDTH, HEIGHT, |x, y| {
        // Longitude and latitude about the direction of motion.
        let longitude = (x as f64 + 0.5 - WIDTH as f64 / 2.0) / WIDTH as f64 * 2.0 * PI;
        let latitude = (HEIGHT as f64 / 2.0 - y as f64 - 0.5) / HEIGHT as f64 * PI;
        let w = DVec3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin());
        let seen = w.x.clamp(-1.0, 1.0).acos();
        let angle = rest(seen);
        let around = w.z.atan2(w.y);
        let near = |v: f64, width: f64| {
            let d = (v / 15.0 - (v / 15.0).round()).abs() * 15.0;
            d < width
        };
        let is_line = near(angle.to_degrees(), 0.5) || near(around.to_degrees(), 0.5 / angle.sin().max(0.05));
        let at = (factor(beta, seen) / least).ln() / (most / least).ln().max(1e-12) * 511.0;
        let xyz = shifted[(at.round() as usize).min(511)] / white;
        let gain = if is_line { 0.1 } else { 0.4 };
        // Brightness by its root: the searchlight spans many stops.
        let rgb = rgb_from_xyz_in_gamut(xyz / xyz.y.max(1e-30));
        rgb.map(|c| c * (gain * xyz.y.powf(0.25)) as f32)
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M138: D = γ(1 − β cos θ) for the angle at rest (of light that comes towards the observer, with the sign turned),
    /// and both forms agree; aberration and its inverse; the mean of D⁴ is γ²(1 + β²/3).
    #[test]
    fn shift_aberration_and_mean() {
        for beta in [0.0, 0.1, 0.5, 0.99] {
            let gamma = 1.0 / (1.0f64 - beta * beta).sqrt();
            for degrees in [0.0, 10.0, 90.0, 179.0_f64] {
                let angle = degrees.to_radians();
                let seen = aberration(beta, angle);
                let by_rest = gamma * (1.0 + beta * angle.cos());
                assert!((factor(beta, seen) / by_rest - 1.0).abs() < 1e-12);
                let cosine = (angle.cos() + beta) / (1.0 + beta * angle.cos());
                assert!((seen.cos() - cosine).abs() < 1e-12 && (aberration(-beta, seen) - angle).abs() < 1e-12);
            }
            let given = [("speed".to_owned(), beta.to_string())];
            let r = EXPERIMENT.run(&given, None).unwrap();
            let exact = gamma * gamma * (1.0 + beta * beta / 3.0);
            assert!((r.value("mean of radiance over all directions") / exact - 1.0).abs() < 1e-3, "{beta}");
        }
    }
}

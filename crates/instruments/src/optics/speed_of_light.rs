//! The speed of light as it was found: from the moon Io of Jupiter, between the teeth of a wheel, by a turning mirror.
//!
//! - Rømer (1676) had eclipses of Io 22 minutes late where the earth was across its orbit, which are 16 min 38 s; with
//!   the orbit of today `c = 2 AU / Δt` is a quarter too small.
//! - Fizeau (1849) stopped light by the next tooth: it goes to the mirror and back, `2 d`, while the wheel of `N` teeth
//!   turns by half a tooth's period, `1/(2 N ν)`, so `c = 4 d N ν`. His turns can be read to a few per cent.
//! - Foucault (1862) measured by how much, `s = 2 · 2π ν · (2 d/c) · r`, the image is displaced that a turning mirror
//!   makes at the distance `r` of light that met it twice: 0.7 mm on a scale that he read to a hundredth.

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use std::f64::consts::PI;
use steradian_math::spectra::blackbody::SPEED_OF_LIGHT;

pub const EXPERIMENT: Experiment = Experiment {
    name: "speed-of-light",
    doc: "the speed of light as Rømer, Fizeau and Foucault measured it, with the numbers that they had",
    source: "Rømer 1676 (Journal des sçavans); Fizeau 1849 (C. R. 29, 90); Foucault 1862 (C. R. 55, 501 and 792)",
    parameters: &[
        Parameter::choice("method", &["fizeau", "roemer", "foucault"], "whose experiment"),
        Parameter::number("delay", 22.0, (1.0, 100.0), "min", "Rømer: of light across the orbit of the earth"),
        Parameter::number("wheel-distance", 8633.0, (1.0, 1e6), "m", "Fizeau: from the wheel to the mirror"),
        Parameter::count("teeth", 720, (1, 100_000), "Fizeau: of the wheel"),
        Parameter::number("turns", 12.6, (1e-3, 1e6), "1/s", "Fizeau: of the wheel at the first extinction"),
        Parameter::number(
            "mirror-distance",
            20.2,
            (0.1, 1e6),
            "m",
            "Foucault: way from the turning mirror to the last",
        ),
        Parameter::number("mirror-turns", 400.0, (1.0, 1e5), "1/s", "Foucault: of the mirror"),
        Parameter::number("radius", 1.0, (0.01, 100.0), "m", "Foucault: from the turning mirror to the scale"),
        Parameter::number("displacement", 0.68, (1e-3, 1e3), "mm", "Foucault: of the image on the scale"),
    ],
    run: Run::Alone(run),
};

/// Astronomical unit, m (IAU 2012).
const ORBIT: f64 = 149_597_870_700.0;

fn run(values: &Values) -> Result<Report, Error> {
    let number = |name: &str| values.number(name);
    let method = values.choice("method");
    // The reading, the reading that the true speed gives, the speed as a function of the reading, and light's way.
    let (label, reading, right, speed, way): (_, _, _, Box<dyn Fn(f64) -> f64>, _) = match method {
        "roemer" => {
            let speed = |minutes: f64| 2.0 * ORBIT / (60.0 * minutes);
            ("delay (min)", number("delay"), 2.0 * ORBIT / SPEED_OF_LIGHT / 60.0, Box::new(speed), 2.0 * ORBIT)
        }
        "foucault" => {
            let (d, r) = (number("mirror-distance"), number("radius"));
            let angle = 4.0 * PI * number("mirror-turns") * 2.0 * d;
            let speed = move |mm: f64| angle * r / (1e-3 * mm);
            ("displacement (mm)", number("displacement"), 1e3 * angle * r / SPEED_OF_LIGHT, Box::new(speed), 2.0 * d)
        }
        _ => {
            let (d, teeth) = (number("wheel-distance"), number("teeth"));
            let speed = move |turns: f64| 4.0 * d * teeth * turns;
            ("turns (1/s)", number("turns"), SPEED_OF_LIGHT / (4.0 * d * teeth), Box::new(speed), 2.0 * d)
        }
    };
    let found = speed(reading);
    let mut report = Report::default();
    report.quantity("speed of light found", found * 1e-3, "km/s");
    report.quantity("true speed in vacuum", SPEED_OF_LIGHT * 1e-3, "km/s");
    report.quantity("error", 100.0 * (found / SPEED_OF_LIGHT - 1.0), "%");
    report.quantity("way of the light", way, "m");
    report.quantity("time that light needs for it", way / SPEED_OF_LIGHT, "s");
    report.quantity("reading that gives the true speed", right, "");
    report.fact(
        "published",
        match method {
            "roemer" => "22 min (Rømer); Huygens made it 212 000 km/s, with an orbit that was taken too small",
            "foucault" => "298 000 km/s, to 500 km/s",
            _ => "70 948 leagues of 25 to the degree for each second, 315 000 km/s",
        },
    );
    let points = (0..=100)
        .map(|k| {
            right.min(reading) * 0.8 + (right.max(reading) * 1.2 - right.min(reading) * 0.8) * f64::from(k) / 100.0
        })
        .map(|reading| (reading, 1e-3 * speed(reading)));
    report.chart = Some(
        Chart::new(format!("speed of light, {method}"), Axis::linear(label), Axis::linear("km/s"))
            .with(Series::line("by the reading", points.collect()))
            .with(Series::line("found", vec![(reading, 1e-3 * found)]).drawn(Marker::Dots))
            .with(Series::line("true", vec![(right, 1e-3 * SPEED_OF_LIGHT)]).drawn(Marker::Dots)),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(given: &[(&str, &str)]) -> Report {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// Each finds what was published, to the digits of its reading; light needs 16 min 38 s across the orbit of the
    /// earth.
    #[test]
    fn each_finds_what_was_published() {
        let fizeau = with(&[]).value("speed of light found");
        assert!((fizeau - 313_274.3).abs() < 0.1 && (fizeau / 315_000.0 - 1.0).abs() < 0.006);
        let roemer = with(&[("method", "roemer")]);
        assert!((roemer.value("speed of light found") - 226_663.4).abs() < 0.1);
        assert!((roemer.value("time that light needs for it") - 998.0).abs() < 0.1);
        let foucault = with(&[("method", "foucault")]).value("speed of light found");
        assert!((foucault / 298_000.0 - 1.0).abs() < 0.005, "{foucault}");
    }

    /// With the reading that is told for it, each finds the true speed.
    #[test]
    fn the_right_reading_gives_the_true_speed() {
        for (method, reading) in [("roemer", "delay"), ("fizeau", "turns"), ("foucault", "displacement")] {
            let right = with(&[("method", method)]).value("reading that gives the true speed").to_string();
            let again = with(&[("method", method), (reading, &right)]);
            assert!(again.value("error").abs() < 1e-9, "{method}");
        }
    }
}

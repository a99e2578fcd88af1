//! Distances of stars: by parallax, the angle that the radius of the earth's orbit has there, `d/pc = 1/(p/″)`; and by
//! standard candles, whose absolute magnitude `M`, that at 10 pc, is known: `m − M = 5 lg(d/10 pc) + A`, with the
//! extinction `A` by dust between.
//!
//! Candles: Cepheids, which shine the more the longer their period `P` is, `M_V = −2.43 (lg P/d − 1) − 4.05` (Leavitt
//! 1912; Benedict et al. 2007), and supernovae of type Ia at their brightest, `M_B = −19.3` (Hillebrandt, Niemeyer
//! 2000). Light falls with the square of the distance: five magnitudes are a factor of 100 (Pogson 1856).

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};

pub const EXPERIMENT: Experiment = Experiment {
    name: "distance",
    doc: "distances of stars by parallax and by standard candles, with magnitudes",
    source: "Pogson 1856; Leavitt 1912; Benedict et al. 2007 (Cepheids); Hillebrandt, Niemeyer 2000 (supernovae)",
    parameters: &[
        Parameter::choice("by", &["parallax", "candle", "cepheid", "supernova"], "what is known of the star"),
        Parameter::number("parallax", 379.21, (1e-3, 1e6), "mas", "for by=parallax (Sirius)"),
        Parameter::number("parallax-error", 1.58, (0.0, 1e6), "mas", "standard deviation of the parallax"),
        Parameter::number("magnitude", -1.46, (-30.0, 40.0), "mag", "apparent, of the star"),
        Parameter::number("absolute", 4.83, (-30.0, 40.0), "mag", "for by=candle: absolute magnitude (the sun)"),
        Parameter::number("period", 10.0, (1.0, 200.0), "d", "for by=cepheid"),
        Parameter::number("extinction", 0.0, (0.0, 50.0), "mag", "by dust on the way"),
    ],
    run: Run::Alone(run),
};

/// Parsec in m: the distance at which an astronomical unit has one second of arc.
const PARSEC: f64 = 149_597_870_700.0 * 648_000.0 / std::f64::consts::PI;

/// Light-year in m, of 365.25 days.
const LIGHT_YEAR: f64 = 299_792_458.0 * 365.25 * 86_400.0;

/// Absolute magnitude of the sun in V (Willmer 2018).
const SUN: f64 = 4.83;

fn run(values: &Values) -> Result<Report, Error> {
    let apparent = values.number("magnitude") - values.number("extinction");
    let candle = match values.choice("by") {
        "candle" => Some(values.number("absolute")),
        "cepheid" => Some(-2.43 * (values.number("period").log10() - 1.0) - 4.05),
        "supernova" => Some(-19.3),
        _ => None,
    };
    let mut report = Report::default();
    let parsecs = match candle {
        Some(absolute) => 10f64.powf(1.0 + 0.2 * (apparent - absolute)),
        None => {
            let (angle, error) = (values.number("parallax"), values.number("parallax-error"));
            if error < angle {
                report.quantity("nearest, within the error", 1e3 / (angle + error), "pc");
                report.quantity("farthest, within the error", 1e3 / (angle - error), "pc");
            } else {
                report.fact("error", "as large as the parallax: the star may be at any distance beyond the nearest");
                report.quantity("nearest, within the error", 1e3 / (angle + error), "pc");
            }
            1e3 / angle
        }
    };
    let modulus = 5.0 * (parsecs.log10() - 1.0);
    let absolute = candle.unwrap_or(apparent - modulus);
    report.quantity("distance", parsecs, "pc");
    report.quantity("distance in light-years", parsecs * PARSEC / LIGHT_YEAR, "ly");
    report.quantity("parallax there", 1e3 / parsecs, "mas");
    report.quantity("distance modulus", modulus, "mag");
    report.quantity("absolute magnitude", absolute, "mag");
    report.quantity("luminosity", 10f64.powf(0.4 * (SUN - absolute)), "suns");
    let ways = || (0..=120).map(|k| parsecs * 10f64.powf(f64::from(k) / 40.0 - 1.5));
    let extinction = values.number("extinction");
    let seen = |d: f64| absolute + 5.0 * (d.log10() - 1.0) + extinction;
    report.chart = Some(
        Chart::new("apparent magnitude by distance", Axis::log("distance (pc)"), Axis::linear("magnitude"))
            .with(Series::line("a star like this", ways().map(|d| (d, seen(d))).collect()))
            .with(
                Series::line("the sun", ways().map(|d| (d, SUN + 5.0 * (d.log10() - 1.0))).collect())
                    .drawn(Marker::Dashed),
            )
            .with(Series::line("this star", vec![(parsecs, seen(parsecs))]).drawn(Marker::Dots)),
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

    /// Sirius (Hipparcos: 379.21 mas, −1.46 mag) is 2.637 pc or 8.60 light-years away, of absolute magnitude 1.43, and
    /// 23 times as bright as the sun in V; Proxima (768.07 mas) is 4.2465 light-years away; a parsec is 3.2616
    /// light-years.
    #[test]
    fn stars_are_where_the_catalogues_have_them() {
        let sirius = with(&[]);
        assert!((sirius.value("distance") - 2.637).abs() < 5e-4);
        assert!((sirius.value("distance in light-years") - 8.60).abs() < 5e-3);
        assert!((sirius.value("absolute magnitude") - 1.43).abs() < 0.01);
        assert!((sirius.value("luminosity") - 23.0).abs() < 0.5);
        let proxima = with(&[("parallax", "768.07")]);
        assert!((proxima.value("distance in light-years") - 4.2465).abs() < 1e-4);
        assert!((PARSEC / LIGHT_YEAR - 3.261_563_78).abs() < 1e-8);
    }

    /// A candle at 10 pc has its absolute magnitude; a modulus of 24.47 (Andromeda) is 783 kpc; the sun from its own
    /// distance, 1 AU = 4.848e-6 pc, has −26.74; the Cepheid of 10 days has −4.05; dust makes nearer stars look
    /// farther.
    #[test]
    fn candles_tell_the_distance() {
        assert!((with(&[("by", "candle"), ("magnitude", "4.83")]).value("distance") - 10.0).abs() < 1e-12);
        let andromeda = with(&[("by", "candle"), ("absolute", "0"), ("magnitude", "24.47")]);
        assert!((andromeda.value("distance") / 783e3 - 1.0).abs() < 1e-3);
        let sun = with(&[("by", "candle"), ("magnitude", "-26.74")]).value("distance");
        assert!((sun * PARSEC / 149_597_870_700.0 - 1.0).abs() < 0.01, "{sun}");
        assert!((with(&[("by", "cepheid")]).value("absolute magnitude") + 4.05).abs() < 1e-12);
        let dusty = with(&[("by", "supernova"), ("magnitude", "10"), ("extinction", "5")]).value("distance");
        let clear = with(&[("by", "supernova"), ("magnitude", "10")]).value("distance");
        assert!((clear / dusty - 10.0).abs() < 1e-9);
        assert!(with(&[("parallax-error", "400")]).facts[0].text.contains("any distance"));
    }
}

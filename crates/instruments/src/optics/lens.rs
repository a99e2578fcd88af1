//! A thin lens: circles of confusion, depth of field, near- and far-sighted eyes, and chromatic aberration.
//!
//! `1/f = 1/s + 1/s'`; a point at the distance `s` makes a disc of diameter `D |1/s' − 1/s'_sensor| s'_sensor` on a
//! sensor at `s'_sensor` (Born, Wolf, *Principles of Optics*, §4.4). The power of a lens follows the index,
//! `1/f ∝ n − 1`, so the focal lengths for two lines differ by `f/V`.

use super::refractive_index::{MEDIA, at_lines, index};
use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};

pub const EXPERIMENT: Experiment = Experiment {
    name: "lens",
    doc: "depth of field of a thin lens or an eye with a refractive error, and its chromatic aberration",
    source: "Born, Wolf, Principles of Optics, §4.4.2 and §4.7.3",
    parameters: &[
        Parameter::number("focal", 50.0, (0.01, 1e5), "mm", "focal length at the d line (17 is an eye's)"),
        Parameter::number("aperture", 25.0, (1e-3, 1e4), "mm", "diameter of the lens or pupil"),
        Parameter::number("focus", 2.0, (1e-3, 1e9), "m", "distance that is in focus"),
        Parameter::number(
            "error",
            0.0,
            (-30.0, 30.0),
            "dpt",
            "error of an eye: negative for near-sighted, positive for far-sighted",
        ),
        Parameter::number("object", 1.0, (1e-3, 1e9), "m", "distance whose circle of confusion is told"),
        Parameter::number("acceptable", 30.0, (1e-3, 1e5), "µm", "greatest circle of confusion that counts as sharp"),
        Parameter::choice("glass", MEDIA, "what the lens is made of, for chromatic aberration"),
        Parameter::number("n_d", 1.5168, (1.0001, 5.0), "", "index at the d line, for glass=custom"),
        Parameter::number("abbe", 64.17, (0.1, 1e4), "", "Abbe number, for glass=custom"),
    ],
    run: Run::Alone(run),
};

/// Diameter of the disc that a point makes: vergences in dioptres (1/m), the diameter of the lens in any unit of
/// length. `power` is the lens's, `image` the vergence 1/s' of its sensor.
fn confusion(diameter: f64, power: f64, image: f64, object: f64) -> f64 {
    diameter * ((power - object) / image - 1.0).abs()
}

fn run(values: &Values) -> Result<Report, Error> {
    let power = 1e3 / values.number("focal");
    let focus = 1.0 / values.number("focus");
    if focus >= power {
        return Err(Error::Impossible(
            "'focus' is not farther away than the focal length: nothing can be in focus".into(),
        ));
    }
    let image = power - focus;
    // A near-sighted eye is too strong: seen through it, everything is as if it had that much more power.
    let error = values.number("error");
    let power_of_eye = power - error;
    let diameter = values.number("aperture") * 1e3; // µm
    let acceptable = values.number("acceptable");
    let mut report = Report::default();
    report.quantity("distance of the sensor", 1e3 / image, "mm");
    report.quantity("f-number", 1e3 / (power * values.number("aperture")), "");
    let at = |object: f64| confusion(diameter, power_of_eye, image, 1.0 / object);
    report.quantity("circle of confusion of the object", at(values.number("object")), "µm");
    report.quantity("distance that is sharp", 1.0 / (power_of_eye - image), "m");
    // |(P − V)/I − 1| D ≤ c  ⇔  V between P − I(1 ± c/D).
    let (near, far) =
        (power_of_eye - image * (1.0 - acceptable / diameter), power_of_eye - image * (1.0 + acceptable / diameter));
    let distance = |v: f64| if v > 0.0 { 1.0 / v } else { f64::INFINITY };
    report.quantity("sharp from", distance(near), "m");
    report.quantity("sharp to", distance(far), "m");
    let glass = index(values.choice("glass"), values.number("n_d"), values.number("abbe"));
    let [f, d, c] = at_lines(&glass);
    let focal = |n: f64| values.number("focal") * (d - 1.0) / (n - 1.0);
    report.quantity("focal length at F (486 nm)", focal(f), "mm");
    report.quantity("focal length at C (656 nm)", focal(c), "mm");
    report.quantity("difference over f/V", (focal(c) - focal(f)) / (values.number("focal") / glass.abbe()), "");
    let lines = [("F, 486 nm", f, [40, 70, 190]), ("d, 588 nm", d, [180, 140, 20]), ("C, 656 nm", c, [200, 40, 30])];
    let mut chart = Chart::new(
        format!("circle of confusion, f = {} mm", values.number("focal")),
        Axis::log("distance of the object (m)"),
        Axis::linear("circle of confusion (µm)"),
    );
    let (least, most) = (1.5 / power, values.number("focus").max(values.number("object")) * 20.0);
    for (name, n, color) in lines {
        let power = power_of_eye * (n - 1.0) / (d - 1.0);
        let points = (0..=600)
            .map(|k| least * (most / least).powf(f64::from(k) / 600.0))
            .map(|s| (s, confusion(diameter, power, image, 1.0 / s)))
            .collect();
        chart = chart.with(Series::line(name, points).colored(color));
    }
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run_with(given: &[(&str, &str)]) -> Report {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// M53: the closed form A f |s − s_f| / (s (s_f − f)).
    #[test]
    fn circles_of_confusion_have_their_closed_form() {
        let (f, a, focus) = (0.05, 0.025, 2.0);
        for object in ["0.5", "1", "1.9", "2", "7", "1000000"] {
            let s: f64 = object.parse().unwrap();
            let exact = a * f * (s - focus).abs() / (s * (focus - f)) * 1e6;
            let found = run_with(&[("object", object)]).value("circle of confusion of the object");
            assert!((found - exact).abs() < 1e-9 * (1.0 + exact), "{object}: {found} {exact}");
        }
        let r = run_with(&[]);
        for limit in [r.value("sharp from"), r.value("sharp to")] {
            let c = run_with(&[("object", &limit.to_string())]).value("circle of confusion of the object");
            assert!((c - 30.0).abs() < 1e-6, "{c}");
        }
    }

    /// An eye of −2 dpt that is relaxed (focus far away) sees sharply at half a metre; the colours' focal lengths
    /// differ by about f/V.
    #[test]
    fn near_sight_and_colours() {
        let eye = [("focal", "17"), ("focus", "1000000000"), ("error", "-2"), ("aperture", "4"), ("object", "0.5")];
        let r = run_with(&eye);
        assert!((r.value("distance that is sharp") - 0.5).abs() < 1e-6);
        assert!(r.value("circle of confusion of the object") < 1e-4);
        assert!((r.value("difference over f/V") - 1.0).abs() < 0.01);
    }
}

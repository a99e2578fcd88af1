//! The blind spot: where the optic nerve leaves the eye there are no receptors (Mariotte 1668). In the field of view it
//! is an ellipse around a point 15.5° to the temple and 1.5° below the line of sight, 5.5° wide and 7.5° high, as
//! perimetry has it. A dot that lies in it is not seen, nor is anything missed: the ground is filled in.
//!
//! The card has a cross and a dot, `d tan α` apart for an eye at the distance `d` that looks at the cross.

use crate::laboratory::{Error, Experiment, Parameter, Picture, Report, Run, Values};

pub const EXPERIMENT: Experiment = Experiment {
    name: "blind-spot",
    doc: "a card on which a dot vanishes in the blind spot, and the distances at which it does",
    source: "Mariotte 1668; Harrington, The Visual Fields; Armaly 1969 (size and place)",
    parameters: &[
        Parameter::choice("eye", &["right", "left"], "the open one"),
        Parameter::number("distance", 40.0, (10.0, 200.0), "cm", "from the eye to the card"),
        Parameter::number("pitch", 0.25, (0.05, 2.0), "mm", "from pixel to pixel of the display"),
        Parameter::number("dot", 3.0, (0.2, 12.0), "°", "diameter of the dot, as the eye sees it"),
    ],
    run: Run::Alone(run),
};

/// Angles from the line of sight to the middle, to the temple and downwards, degrees.
pub(super) const MIDDLE: [f64; 2] = [15.5, 1.5];

/// Width and height, degrees.
pub(super) const SIZE: [f64; 2] = [5.5, 7.5];

/// Greatest width of a card, pixels.
const WIDEST: f64 = 8192.0;

/// Tests a direction, by its angles to the temple and downwards, for lying within a spot shrunk by an angle.
pub(super) fn contains(temporal: f64, below: f64, shrunk: f64) -> bool {
    let [a, b] = SIZE.map(|size| 0.5 * size - shrunk);
    let (x, y) = ((temporal - MIDDLE[0]) / a, (below - MIDDLE[1]) / b);
    a > 0.0 && b > 0.0 && x * x + y * y <= 1.0
}

fn run(values: &Values) -> Result<Report, Error> {
    let [distance, pitch, dot] = [10.0 * values.number("distance"), values.number("pitch"), values.number("dot")];
    let tan = |degrees: f64| degrees.to_radians().tan();
    let (across, below) = (distance * tan(MIDDLE[0]), distance * tan(MIDDLE[1]));
    let radius = distance * (tan(MIDDLE[0] + 0.5 * dot) - tan(MIDDLE[0]));
    let mut report = Report::default();
    report.quantity("the dot beside the cross", across, "mm");
    report.quantity("the dot below the cross", below, "mm");
    report.quantity("diameter of the dot", 2.0 * radius, "mm");
    report.quantity("width of the blind spot on the card", distance * (tan(18.25) - tan(12.75)), "mm");
    // The same card from other distances.
    let is_lost = |d: f64| {
        let angle = |mm: f64| (mm / d).atan().to_degrees();
        contains(angle(across), angle(below), 0.5 * (angle(across + radius) - angle(across - radius)))
    };
    let at = |k: u32| distance * (0.5 + f64::from(k) / 1000.0);
    if let (true, Some(near), Some(far)) =
        (is_lost(distance), (0..=1500).map(at).find(|d| is_lost(*d)), (0..=1500).rev().map(at).find(|d| is_lost(*d)))
    {
        report.quantity("nearest distance at which it vanishes", 0.1 * near, "cm");
        report.quantity("farthest distance at which it vanishes", 0.1 * far, "cm");
        let other = if values.choice("eye") == "left" { "right" } else { "left" };
        report.fact("the dot", format!("vanishes: close the {other} eye and look at the cross"));
    } else {
        report.fact("the dot", "is larger than the blind spot: its rim stays");
    }
    let margin = (3.0 * radius).max(0.2 * across);
    let width = ((across + 2.0 * margin) / pitch).ceil();
    let height = ((below + 2.0 * margin) / pitch).ceil();
    if width > WIDEST {
        let why = format!("the card is {width} pixels wide, {WIDEST} at most: shorten 'distance' or enlarge 'pitch'");
        return Err(Error::Impossible(why));
    }
    let side = if values.choice("eye") == "left" { -1.0 } else { 1.0 };
    let arm = 0.1 * across;
    let picture = Picture::from_fn(width as usize, height as usize, |x, y| {
        // In mm from the cross, to the temple and down.
        let place = (x as f64 + 0.5) * pitch;
        let (u, v) =
            (if side > 0.0 { place } else { width * pitch - place } - margin, (y as f64 + 0.5) * pitch - margin);
        let is_cross = u.abs().min(v.abs()) < 0.1 * arm && u.abs().max(v.abs()) < arm;
        let is_dot = (u - across).hypot(v - below) < radius;
        [if is_cross || is_dot { 0.0 } else { 1.0 }; 3]
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(given: &[(&str, &str)]) -> Report {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// 40 cm · tan 15.5° = 11.09 cm; a dot of 3° vanishes there and at a tenth more or less, one of 6° does not.
    #[test]
    fn a_small_dot_vanishes() {
        let r = with(&[]);
        assert!((r.value("the dot beside the cross") - 110.93).abs() < 0.01);
        assert!((r.value("the dot below the cross") - 10.47).abs() < 0.01);
        assert!(r.facts[0].text.contains("close the left eye"));
        let (near, far) =
            (r.value("nearest distance at which it vanishes"), r.value("farthest distance at which it vanishes"));
        assert!((36.0..39.0).contains(&near) && (41.0..45.0).contains(&far), "{near} {far}");
        assert!(with(&[("dot", "6")]).facts[0].text.contains("rim stays"));
    }

    /// The card has the dot on the side of the temple, and black where it should be.
    #[test]
    fn the_dot_lies_on_the_side_of_the_temple() {
        for (eye, is_right) in [("right", true), ("left", false)] {
            let image = with(&[("eye", eye), ("pitch", "1")]).picture.unwrap();
            let (w, h, red) = (image.width(), image.height(), image.channel("R").unwrap());
            let black =
                |half: usize| (0..w * h).filter(|i| (i % w >= w / 2) == (half == 1) && red[*i] == 0.0).count() as f64;
            let radius = 400.0 * (17f64.to_radians().tan() - 15.5f64.to_radians().tan());
            let dot = black(usize::from(is_right));
            assert!((dot / (std::f64::consts::PI * radius * radius) - 1.0).abs() < 0.05, "{eye} {dot}");
        }
    }
}

//! Pictures that the eye misreads, and what on-centre cells make of them: Mach bands, Hermann's grid, Cornsweet's edge,
//! simultaneous contrast, Chevreul's steps.

use super::receptive_field::Plane;
use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values};

pub const EXPERIMENT: Experiment = Experiment {
    name: "illusion",
    doc: "Mach bands, Hermann's grid, Cornsweet's edge, simultaneous contrast and Chevreul's steps, with the retina's response",
    source: "Mach 1865; Hermann 1870; Cornsweet 1970; Chevreul 1839; Rodieck 1965",
    parameters: &[
        Parameter::choice("pattern", &["mach", "hermann", "cornsweet", "contrast", "chevreul"], "which"),
        Parameter::count("size", 384, (32, 4096), "edge of the picture in pixels"),
        Parameter::number("center", 3.0, (0.3, 100.0), "px", "standard deviation of the centre of the receptive field"),
        Parameter::number("surround", 12.0, (0.3, 200.0), "px", "standard deviation of its surround"),
    ],
    run: Run::Alone(run),
};

/// Luminance of a pattern at `(u, v)` in [0, 1]².
fn luminance(pattern: &str, u: f64, v: f64) -> f64 {
    match pattern {
        // A ramp between two even fields.
        "mach" => 0.1 + 0.5 * ((u - 0.35) / 0.3).clamp(0.0, 1.0),
        "hermann" => {
            let street = |t: f64| (t * 5.0).fract() > 0.82;
            if street(u + 0.036) || street(v + 0.036) { 0.8 } else { 0.02 }
        }
        // Both halves are equal but for the edge.
        "cornsweet" => {
            let d = u - 0.5;
            0.3 + 0.12 * d.signum() * (1.0 - d.abs() / 0.12).max(0.0).powi(2)
        }
        "contrast" => {
            let x = if u < 0.5 { u - 0.25 } else { u - 0.75 };
            let is_patch = x.abs() < 0.08 && (v - 0.5).abs() < 0.08;
            if is_patch {
                0.25
            } else if u < 0.5 {
                0.05
            } else {
                0.7
            }
        }
        _ => 0.05 + 0.75 * ((u * 8.0).floor().min(7.0) / 7.0),
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let (pattern, size) = (values.choice("pattern"), values.count("size"));
    let (center, surround) = (values.number("center"), values.number("surround"));
    if center >= surround {
        return Err(Error::Impossible("the surround must be wider than the center".into()));
    }
    let at = |k: usize| (k as f64 + 0.5) / size as f64;
    let picture = Picture::from_fn(size, size, |x, y| [luminance(pattern, at(x), at(y)) as f32; 3]);
    let plane = Plane::of(&picture);
    let response = plane.response("on", center, surround);
    let mut report = Report::default();
    let value = |u: f64, v: f64| response[(v * size as f64) as usize * size + (u * size as f64) as usize];
    match pattern {
        "mach" => {
            let row = &response[size / 2 * size..(size / 2 + 1) * size];
            let extreme = |is_better: fn(f64, f64) -> bool| {
                (1..size).fold(0, |best, x| if is_better(row[x], row[best]) { x } else { best })
            };
            report.quantity("dark band at", at(extreme(|a, b| a < b)), "of the width");
            report.quantity("bright band at", at(extreme(|a, b| a > b)), "of the width");
        }
        "hermann" => {
            // A crossing of streets, and the middle of a street between crossings.
            report.quantity("response at a crossing", value(0.546, 0.546), "");
            report.quantity("response in a street", value(0.546, 0.446), "");
        }
        "contrast" => {
            report.quantity("response at the patch on dark", value(0.25, 0.5 - 0.075), "");
            report.quantity("response at the patch on bright", value(0.75, 0.5 - 0.075), "");
        }
        _ => {}
    }
    let row = size / 2 * size..(size / 2 + 1) * size;
    let points = |v: &[f64]| v[row.clone()].iter().enumerate().map(|(x, v)| (at(x), *v)).collect::<Vec<_>>();
    report.chart = Some(
        Chart::new(format!("{pattern}, middle row"), Axis::linear("place"), Axis::linear("luminance; response"))
            .with(Series::line("luminance", points(&plane.values)))
            .with(Series::line("response of on-centre cells", points(&response))),
    );
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run_with(pattern: &str) -> Report {
        EXPERIMENT.run(&[("pattern".to_owned(), pattern.to_owned())], None).unwrap()
    }

    /// M121: the bands are at the ends of the ramp; crossings answer less than streets (and look darker); the patch on
    /// dark answers more.
    #[test]
    fn the_retina_sees_what_people_see() {
        let mach = run_with("mach");
        assert!((mach.value("dark band at") - 0.35).abs() < 0.03 && (mach.value("bright band at") - 0.65).abs() < 0.03);
        let grid = run_with("hermann");
        assert!(grid.value("response at a crossing") < 0.8 * grid.value("response in a street"));
        let contrast = run_with("contrast");
        assert!(contrast.value("response at the patch on dark") > contrast.value("response at the patch on bright"));
    }
}

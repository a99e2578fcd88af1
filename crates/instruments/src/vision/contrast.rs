//! Contrast sensitivity: `A(f) = 2.6 (0.0192 + 0.114 f) e^{−(0.114 f)^{1.1}}`, `f` in cycles per degree (Mannos,
//! Sakrison 1974, eq. 5.3), and the chart of Campbell and Robson, whose frequency grows to the right and whose contrast
//! falls upwards: where its stripes vanish is one's own curve.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values};
use std::f64::consts::TAU;

pub const EXPERIMENT: Experiment = Experiment {
    name: "contrast-sensitivity",
    doc: "the contrast sensitivity of the eye, and the chart of Campbell and Robson",
    source: "Mannos, Sakrison 1974, eq. 5.3; Campbell, Robson 1968",
    parameters: &[
        Parameter::number("distance", 0.6, (0.01, 1000.0), "m", "from the eye to the picture"),
        Parameter::number("pitch", 0.25, (1e-3, 100.0), "mm", "from pixel to pixel of the display"),
        Parameter::count("size", 768, (64, 4096), "width of the picture in pixels"),
        Parameter::number("luminance", 0.2, (0.01, 1.0), "", "mean of the picture"),
    ],
    run: Run::Alone(run),
};

/// Sensitivity relative to its maximum.
fn sensitivity(f: f64) -> f64 {
    2.6 * (0.0192 + 0.114 * f) * (-(0.114 * f).powf(1.1)).exp()
}

fn run(values: &Values) -> Result<Report, Error> {
    let pixel = (values.number("pitch") * 1e-3 / values.number("distance")).atan().to_degrees();
    let mut report = Report::default();
    report.quantity("pixels for each degree", 1.0 / pixel, "");
    let finest = 0.5 / pixel;
    report.quantity("finest pattern of the display", finest, "cycles/°");
    report.quantity("sensitivity there", sensitivity(finest), "");
    let top = (1..6000).map(|k| f64::from(k) / 100.0).max_by(|a, b| sensitivity(*a).total_cmp(&sensitivity(*b)));
    report.quantity("frequency seen best", top.unwrap_or(0.0), "cycles/°");
    let points = (0..=400).map(|k| 0.1 * 600f64.powf(f64::from(k) / 400.0)).map(|f| (f, sensitivity(f))).collect();
    report.chart = Some(
        Chart::new(
            "contrast sensitivity",
            Axis::log("cycles per degree"),
            Axis::log("relative sensitivity").over(1e-3, 1.2),
        )
        .with(Series::line("Mannos, Sakrison", points)),
    );
    // Log frequency from 1/400 to 1/4 cycle per pixel; contrast from 1 below to 10⁻³ above.
    let width = values.count("size");
    let height = width * 2 / 3;
    let mean = values.number("luminance");
    let mut phases = Vec::with_capacity(width);
    let mut phase = 0.0;
    for x in 0..width {
        phases.push(phase);
        phase += TAU * 0.0025 * 100f64.powf((x as f64 + 0.5) / width as f64);
    }
    let picture = Picture::from_fn(width, height, |x, y| {
        let contrast = 10f64.powf(-3.0 * (1.0 - (y as f64 + 0.5) / height as f64));
        [(mean * (1.0 + contrast * phases[x].sin())) as f32; 3]
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mannos and Sakrison's curve is largest near 8 cycles per degree, where it is close to one.
    #[test]
    fn eight_cycles_are_seen_best() {
        let r = EXPERIMENT.run(&[], None).unwrap();
        assert!((r.value("frequency seen best") - 7.9).abs() < 0.2);
        assert!((sensitivity(7.9) - 0.98).abs() < 0.02 && sensitivity(60.0) < 0.01 && sensitivity(0.1) < 0.1);
    }
}

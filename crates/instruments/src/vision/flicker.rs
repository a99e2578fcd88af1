//! Flicker and motion: an exposure of length `T` averages light over time, so a flicker of frequency `f` keeps
//! `|sin(π f T)/(π f T)|` of its contrast; the eye fuses what is above a frequency that grows with the logarithm of the
//! light (Ferry 1892, Porter 1902).

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Picture, Report, Run, Series, Values};
use std::f64::consts::{PI, TAU};

pub const EXPERIMENT: Experiment = Experiment {
    name: "flicker",
    doc: "how much of a flicker an exposure keeps, and above which frequency the eye sees none",
    source: "Ferry 1892; Porter 1902; Hecht, Verrijp 1933 (slope)",
    parameters: &[
        Parameter::number("frequency", 100.0, (0.0, 1e5), "Hz", "of the light's flicker"),
        Parameter::number("exposure", 8.0, (1e-3, 1e5), "ms", "time over which light is averaged"),
        Parameter::number("modulation", 1.0, (0.0, 1.0), "", "contrast of the flicker"),
        Parameter::number("luminance", 100.0, (1e-4, 1e6), "cd/m²", "of the light"),
    ],
    run: Run::Alone(run),
};

/// Contrast of the averages of `1 + m sin(2π f t)` over windows of length `t`, found from the averages themselves.
fn kept(frequency: f64, exposure: f64, modulation: f64) -> f64 {
    if frequency == 0.0 {
        return modulation;
    }
    const STARTS: u32 = 720;
    let averages = (0..STARTS).map(|k| {
        let start = f64::from(k) / f64::from(STARTS) / frequency;
        let (a, b) = (TAU * frequency * start, TAU * frequency * (start + exposure));
        1.0 + modulation * (a.cos() - b.cos()) / (b - a)
    });
    let (least, most) = averages.fold((f64::INFINITY, 0.0_f64), |(l, m), v| (l.min(v), m.max(v)));
    (most - least) / (most + least)
}

fn run(values: &Values) -> Result<Report, Error> {
    let (frequency, exposure) = (values.number("frequency"), values.number("exposure") * 1e-3);
    let modulation = values.number("modulation");
    let mut report = Report::default();
    report.quantity("contrast that is kept", kept(frequency, exposure, modulation), "");
    let x = PI * frequency * exposure;
    report.quantity("m |sin x / x|, x = π f T", modulation * if x == 0.0 { 1.0 } else { (x.sin() / x).abs() }, "");
    // 12 Hz for each decade of luminance, 37 Hz at 10 cd/m² (daylight vision).
    let fusion = (37.0 + 12.0 * (values.number("luminance") / 10.0).log10()).clamp(5.0, 90.0);
    report.quantity("critical flicker frequency", fusion, "Hz");
    report.quantity("the eye sees it flicker", f64::from(u8::from(frequency > 0.0 && frequency < fusion)), "");
    let far = 4.0 / exposure;
    let points = (1..=400).map(|k| far * f64::from(k) / 400.0).map(|f| (f, kept(f, exposure, modulation))).collect();
    report.chart = Some(
        Chart::new(
            format!("exposure of {} ms", exposure * 1e3),
            Axis::linear("frequency of the flicker (Hz)"),
            Axis::linear("contrast that is kept"),
        )
        .with(Series::line("averages", points))
        .with(
            Series::line("this flicker", vec![(frequency, kept(frequency, exposure, modulation))]).drawn(Marker::Dots),
        ),
    );
    // A rolling shutter reads a row after the other over two periods of mains light, and shows the flicker as bands.
    let row_time = 0.04 / 512.0;
    let picture = Picture::from_fn(512, 512, |_, y| {
        let (a, b) = (TAU * frequency * y as f64 * row_time, TAU * frequency * (y as f64 * row_time + exposure));
        let v = if a == b { 1.0 } else { 1.0 + modulation * (a.cos() - b.cos()) / (b - a) };
        [(0.4 * v) as f32; 3]
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M122: the response of an exposure is a sinc; whole periods leave nothing.
    #[test]
    fn exposures_filter_by_a_sinc() {
        for (f, t) in [(100.0, 0.003), (100.0, 0.008), (37.0, 0.1), (1000.0, 0.0041)] {
            let x = PI * f * t;
            assert!((kept(f, t, 0.8) - 0.8 * (x.sin() / x).abs()).abs() < 1e-4, "{f} {t}");
        }
        assert!(kept(100.0, 0.02, 1.0) < 1e-12);
        assert_eq!(kept(0.0, 0.02, 0.7), 0.7);
    }
}

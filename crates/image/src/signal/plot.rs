//! Pictures of signals: side-by-side panels, and a plot of the spectrum along its axes.

use super::{Dft, Peak, Prefilter, alias};
use crate::{Image, Result};
use std::fmt::Write;

/// Five panels in a row: the picture, its spectrum, the spectrum after sampling at every `step`-th pixel, the samples
/// spread over their pixels, and the same after a prefilter. Spectra are logarithmic, from 10⁻⁵ of the strongest, with
/// frequency zero in the middle.
///
/// # Errors
/// As [`Dft::new`].
pub fn panels(plane: &[f32], width: usize, height: usize, step: usize, filter: Prefilter) -> Result<Image> {
    const GAP: usize = 4;
    let dft = Dft::new(plane, width, height)?;
    let sampled = Dft::new(&super::comb(plane, width, step), width, height)?;
    let held = |plane: &[f32]| -> Vec<f32> {
        (0..plane.len()).map(|i| plane[i / width / step * step * width + i % width / step * step]).collect()
    };
    let all = [
        plane.to_vec(),
        log_spectrum(&dft),
        log_spectrum(&sampled),
        held(plane),
        held(&super::prefilter(&dft, filter, step)),
    ];
    let across = all.len() * (width + GAP) - GAP;
    let mut pixels = vec![[1.0_f32; 3]; across * height];
    for (k, panel) in all.iter().enumerate() {
        for (i, &v) in panel.iter().enumerate() {
            pixels[i / width * across + k * (width + GAP) + i % width] = [v; 3];
        }
    }
    Image::from_rgb(across, height, &pixels)
}

/// Amplitudes with frequency zero in the middle, by their logarithm, in `[0, 1]`.
fn log_spectrum(dft: &Dft) -> Vec<f32> {
    let amplitudes = dft.amplitudes();
    let most = amplitudes.iter().fold(f64::MIN_POSITIVE, |a, &b| a.max(b));
    let (w, h) = (dft.width, dft.height);
    let at = |i: usize| {
        let (x, y) = ((i % w + w - w / 2) % w, (i / w + h - h / 2) % h);
        (1.0 + (amplitudes[y * w + x] / most).max(1e-5).log10() / 5.0) as f32
    };
    (0..w * h).map(at).collect()
}

/// A plot of amplitudes against the frequency across (the strongest of each column of the spectrum), with half the
/// sampling rate, the prefilter's response, and arrows from waves to their aliases.
pub fn spectrum_svg(dft: &Dft, peaks: &[Peak], step: usize, filter: Prefilter) -> String {
    const W: f64 = 520.0;
    const H: f64 = 300.0;
    const LEFT: f64 = 76.0;
    const TOP: f64 = 30.0;
    let amplitudes = dft.amplitudes();
    let column = |x: usize| (0..dft.height).map(|y| amplitudes[y * dft.width + x]).fold(0.0, f64::max);
    let most = (1..amplitudes.len()).map(|i| amplitudes[i]).fold(f64::MIN_POSITIVE, f64::max);
    let px = |f: f64| LEFT + W * f / 0.5;
    let py = |a: f64| TOP + H * (-(a / most).clamp(1e-5, 1.0).log10() / 5.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" font-family=\"sans-serif\" \
         font-size=\"15\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        W + LEFT + 20.0,
        H + TOP + 56.0
    );
    let mut line = |text: std::fmt::Arguments<'_>| {
        let _ = writeln!(svg, "{text}");
    };
    let (right, bottom) = (LEFT + W, TOP + H);
    line(format_args!("<path d=\"M{LEFT},{TOP} V{bottom} H{right}\" fill=\"none\" stroke=\"black\"/>"));
    for tick in 0..=5 {
        let f = 0.1 * f64::from(tick);
        let x = px(f);
        line(format_args!("<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{f:.1}</text>", bottom + 20.0));
        let y = TOP + H * f64::from(tick) / 5.0;
        let value = ["1", "0.1", "0.01", "0.001", "0.0001", "0.00001"][tick as usize];
        line(format_args!("<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{value}</text>", LEFT - 6.0, y + 5.0));
    }
    let lines = if filter == Prefilter::None { "" } else { " (blue: the picture, green: the prefilter)" };
    line(format_args!(
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">cycles per pixel, across{lines}</text>",
        LEFT + W / 2.0,
        bottom + 44.0
    ));
    // Half the rate.
    let limit = px(0.5 / step as f64);
    line(format_args!("<path d=\"M{limit:.1},{TOP} V{bottom}\" stroke=\"#c00\" stroke-dasharray=\"4 3\"/>"));
    let anchor = if limit > LEFT + W / 2.0 { "end" } else { "start" };
    line(format_args!(
        "<text x=\"{limit:.1}\" y=\"{:.1}\" fill=\"#c00\" text-anchor=\"{anchor}\">half the rate of the samples</text>",
        TOP - 10.0
    ));
    let path = |points: &mut dyn Iterator<Item = (f64, f64)>| -> String {
        let mut d = String::new();
        for (k, (x, y)) in points.enumerate() {
            let _ = write!(d, "{}{x:.2},{y:.2}", if k == 0 { "M" } else { " L" });
        }
        d
    };
    let half = dft.width / 2;
    let spectrum = path(&mut (0..=half).map(|x| (px(x as f64 / dft.width as f64), py(column(x % dft.width)))));
    line(format_args!("<path d=\"{spectrum}\" fill=\"none\" stroke=\"#06c\"/>"));
    if filter != Prefilter::None {
        let response = path(&mut (0..=200).map(|k| {
            let f = 0.5 * f64::from(k) / 200.0;
            (px(f), py(most * filter.response([f, 0.0], step).abs()))
        }));
        line(format_args!("<path d=\"{response}\" fill=\"none\" stroke=\"#080\"/>"));
    }
    for peak in peaks.iter().filter(|p| p.is_aliased) {
        let (from, to) = (px(peak.frequency[0].abs()), px(alias(peak.frequency[0], 1.0 / step as f64).abs()));
        let y = py(peak.amplitude * 0.5);
        let lift = y - 30.0;
        line(format_args!(
            "<path d=\"M{from:.1},{y:.1} Q{:.1},{lift:.1} {to:.1},{y:.1}\" fill=\"none\" stroke=\"#c60\"/>",
            (from + to) / 2.0
        ));
        line(format_args!("<circle cx=\"{to:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#c60\"/>"));
    }
    svg.push_str("</svg>\n");
    svg
}

//! Charts as SVG: the title and the name of the upright axis above, the legend below, so that neither covers a curve.

use super::chart::{Axis, Chart, Marker, Series};
use crate::svg::{self, Entry, FONT, LINE, MARGIN, WIDTH, escape, number, power_of_ten};
use base64::{Engine as _, prelude::BASE64_STANDARD};
use std::fmt::Write;

/// Height of what is between the axes, and the most of it where both axes have one scale.
const HEIGHT: f64 = 320.0;
const TALLEST: f64 = 520.0;
/// Most entries of a legend.
const ENTRIES: usize = 16;
const COLORS: [[u8; 3]; 8] = [
    [0x1f, 0x5f, 0xa8],
    [0xd0, 0x5a, 0x1e],
    [0x2f, 0x86, 0x3c],
    [0xa8, 0x2c, 0x62],
    [0x6b, 0x4f, 0xa0],
    [0x8a, 0x6d, 0x1f],
    [0x1d, 0x87, 0x8e],
    [0x55, 0x55, 0x55],
];

/// A linear or logarithmic map from values to the picture.
struct Scale {
    from: f64,
    to: f64,
    start: f64,
    length: f64,
    is_log: bool,
}

impl Scale {
    fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let usable = |v: &f64| v.is_finite() && (!axis.is_log || *v > 0.0);
        let (from, to) = axis.range.unwrap_or_else(|| {
            values.filter(usable).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
        });
        let (from, to) = match (from <= to, axis.is_log) {
            (true, true) => (from.log10(), to.log10()),
            (true, false) => (from, to),
            (false, _) => (0.0, 1.0),
        };
        let (from, to) =
            if to - from > 1e-12 * from.abs().max(to.abs()).max(1e-300) { (from, to) } else { (from - 0.5, to + 0.5) };
        Self { from, to, start: 0.0, length: 1.0, is_log: axis.is_log }
    }

    fn span(&self) -> f64 {
        self.to - self.from
    }

    fn at(&self, v: f64) -> Option<f64> {
        let v = if self.is_log { v.log10() } else { v };
        let p = self.start + (v - self.from) / self.span() * self.length;
        // Far outside is clipped by the picture; numbers stay short.
        p.is_finite().then(|| p.clamp(-1e5, 1e5))
    }

    /// Values at round distances, at most `most` intervals, with their text.
    fn ticks(&self, most: f64) -> Vec<(f64, String)> {
        if self.is_log && self.span() >= 1.0 {
            let step = (self.span() / most).ceil().max(1.0) as i32;
            let (a, b) = (self.from.ceil() as i32, self.to.floor() as i32);
            // Short numbers in digits: small exponents are hard to read in small pictures.
            let text = |v: f64, e: i32| if (-3..=4).contains(&e) { number(v) } else { power_of_ten(e) };
            if b - a >= 2 {
                return (a..=b).step_by(step as usize).map(|e| (10f64.powi(e), text(10f64.powi(e), e))).collect();
            }
            // Few powers of ten: two and five times these, too.
            let between = (a - 1..=b).flat_map(|e| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(e)));
            let is_in = |v: &f64| (self.from - 1e-9..=self.to + 1e-9).contains(&v.log10());
            return between.filter(is_in).map(|v| (v, number(v))).collect();
        }
        let (a, b) = if self.is_log { (10f64.powf(self.from), 10f64.powf(self.to)) } else { (self.from, self.to) };
        let raw = (b - a) / most;
        let unit = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * unit).find(|s| *s >= raw).unwrap_or(raw);
        let first = (a / step).ceil() as i64;
        let values = (first..).map(|k| k as f64 * step).take_while(|v| *v <= b + 1e-9 * step).take(64);
        values.map(|v| (v, number(v))).collect()
    }

    /// As many ticks along the horizontal as their texts have room for.
    fn ticks_across(&self) -> Vec<(f64, String)> {
        let fits = |ticks: &Vec<(f64, String)>| {
            let places: Vec<_> = ticks.iter().filter_map(|t| Some((self.at(t.0)?, svg::width(&t.1)))).collect();
            places.windows(2).all(|w| w[1].0 - w[0].0 >= 0.5 * (w[0].1 + w[1].1) + 8.0)
        };
        let tried = [8.0, 6.0, 5.0, 4.0, 3.0, 2.0].map(|most| self.ticks(most));
        tried.iter().find(|t| fits(t)).cloned().unwrap_or_else(|| self.ticks(1.0))
    }
}

/// The colour of the series with the number `k`.
fn hex(series: &Series, k: usize) -> String {
    let [r, g, b] = series.color.unwrap_or(COLORS[k % COLORS.len()]);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Draws a series.
fn curve(svg: &mut String, series: &Series, color: &str, x: &Scale, y: &Scale) {
    let placed = series.points.iter().map(|p| x.at(p.0).zip(y.at(p.1)));
    if series.marker == Marker::Dots {
        for (px, py) in placed.flatten() {
            let _ = writeln!(svg, "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3.5\" fill=\"{color}\"/>");
        }
        return;
    }
    let (mut d, mut pen_is_up) = (String::new(), true);
    for place in placed {
        match place {
            Some((px, py)) => {
                let _ = write!(d, "{}{px:.1} {py:.1}", if pen_is_up { 'M' } else { 'L' });
                pen_is_up = false;
            }
            None => pen_is_up = true,
        }
    }
    let style = match series.marker {
        Marker::Area => format!("Z\" fill=\"{color}\" fill-opacity=\"0.25\" stroke=\"{color}"),
        Marker::Dashed => format!("\" fill=\"none\" stroke-width=\"1.6\" stroke-dasharray=\"6 4\" stroke=\"{color}"),
        _ => format!("\" fill=\"none\" stroke-width=\"2\" stroke=\"{color}"),
    };
    let _ = writeln!(svg, "<path d=\"{d}{style}\"/>");
}

/// Scales of the axes.
struct Frame {
    x: Scale,
    y: Scale,
    /// Left, top, right and bottom.
    sides: [f64; 4],
}

impl Frame {
    fn new(chart: &Chart, top: f64) -> Self {
        let all = || chart.series.iter().flat_map(|s| &s.points);
        let (x, y) = (Scale::new(&chart.x, all().map(|p| p.0)), Scale::new(&chart.y, all().map(|p| p.1)));
        let numbers = y.ticks(6.0).iter().map(|t| svg::width(&t.1)).fold(0.0, f64::max);
        let (left, right) = (MARGIN + numbers + 8.0, WIDTH - MARGIN - 12.0);
        let (mut w, mut h) = (right - left, HEIGHT);
        if chart.is_isometric {
            let unit = (w / x.span()).min(TALLEST / y.span());
            (w, h) = (unit * x.span(), unit * y.span());
        }
        // What is narrow stands in the middle.
        let left = left + 0.5 * (right - left - w);
        Self {
            x: Scale { start: left, length: w, ..x },
            y: Scale { start: top + h, length: -h, ..y },
            sides: [left, top, left + w, top + h],
        }
    }

    /// The ground, lines and numbers at round values, and the border.
    fn draw(&self, svg: &mut String, chart: &Chart) {
        let [left, top, right, bottom] = self.sides;
        let (w, h) = (right - left, bottom - top);
        let grid = if let Some(backdrop) = &chart.backdrop {
            let _ = writeln!(
                svg,
                "<image x=\"{left:.1}\" y=\"{top:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" preserveAspectRatio=\"none\" \
                 xlink:href=\"data:image/png;base64,{}\"/>",
                BASE64_STANDARD.encode(&backdrop.png)
            );
            "stroke=\"white\" stroke-opacity=\"0.15\""
        } else {
            "stroke=\"#e4e4e4\""
        };
        for (v, text) in self.x.ticks_across() {
            let Some(p) = self.x.at(v) else { continue };
            // The first and the last stay within the picture.
            let half = 0.5 * svg::width(&text);
            let (place, y) = (p.min(WIDTH - half).max(half), bottom + 20.0);
            let _ = writeln!(
                svg,
                "<path d=\"M{p:.1} {top:.1}V{bottom:.1}\" {grid}/><text x=\"{place:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{text}</text>"
            );
        }
        for (v, text) in self.y.ticks(6.0) {
            let Some(p) = self.y.at(v) else { continue };
            let (x, y) = (left - 8.0, p + 5.0);
            let _ = writeln!(
                svg,
                "<path d=\"M{left:.1} {p:.1}H{right:.1}\" {grid}/><text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{text}</text>"
            );
        }
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" fill=\"none\" stroke=\"#888\"/>"
        );
    }
}

impl Chart {
    /// As SVG.
    pub fn svg(&self) -> String {
        let mut body = String::new();
        let mut top = 26.0;
        top += svg::paragraph(&mut body, &self.title, top, "font-weight=\"bold\"");
        top += svg::paragraph(&mut body, &self.y.label, top, "fill=\"#444\"") - FONT + 9.0;
        let frame = Frame::new(self, top);
        frame.draw(&mut body, self);
        let [left, top, right, bottom] = frame.sides;
        let _ = write!(
            body,
            "<clipPath id=\"plot\"><rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\n\
             <g clip-path=\"url(#plot)\">\n",
            right - left,
            bottom - top
        );
        for (k, series) in self.series.iter().enumerate() {
            curve(&mut body, series, &hex(series, k), &frame.x, &frame.y);
        }
        body.push_str("</g>\n");
        for label in &self.labels {
            let Some((x, y)) = frame.x.at(label.at.0).zip(frame.y.at(label.at.1)) else { continue };
            svg::rimmed(&mut body, [x + 7.0, y + 5.0], &label.text);
        }
        let mut below = bottom + 44.0;
        for line in svg::wrap(&self.x.label, WIDTH - 2.0 * MARGIN) {
            // In the middle of the axis, as far as the picture's sides let it be.
            let half = 0.5 * svg::width(&line);
            let x = (0.5 * (left + right)).min(WIDTH - MARGIN - half).max(MARGIN + half);
            let _ = writeln!(
                body,
                "<text x=\"{x:.1}\" y=\"{below:.1}\" fill=\"#444\" text-anchor=\"middle\">{}</text>",
                escape(&line)
            );
            below += LINE;
        }
        below -= FONT - 4.0;
        below += self.legend(&mut body, below);
        format!("{}{body}</svg>\n", svg::open(below + 4.0))
    }

    /// The names of the series, where there are several, below a height; how much room they take.
    fn legend(&self, svg: &mut String, top: f64) -> f64 {
        let named: Vec<_> = self.series.iter().enumerate().filter(|s| !s.1.name.is_empty()).collect();
        if named.len() < 2 {
            return 0.0;
        }
        let entries: Vec<_> = named
            .iter()
            .take(ENTRIES)
            .map(|(k, series)| {
                let color = hex(series, *k);
                let is_dot = series.marker == Marker::Dots;
                let dashes = if series.marker == Marker::Dashed { " stroke-dasharray=\"6 3\"" } else { "" };
                let stroke = if is_dot { format!("fill=\"{color}\"") } else { format!("stroke=\"{color}\"{dashes}") };
                Entry { stroke, is_dot, text: &series.name }
            })
            .collect();
        let mut rows = String::new();
        let height = svg::legend(&mut rows, &entries, top);
        if self.backdrop.is_some() {
            // Grey, on which light and dark lines can be seen.
            let _ = writeln!(
                svg,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{height:.1}\" rx=\"4\" fill=\"#999\"/>",
                MARGIN - 6.0,
                top - 3.0,
                WIDTH - 2.0 * MARGIN + 12.0
            );
        }
        svg.push_str(&rows);
        height
    }
}

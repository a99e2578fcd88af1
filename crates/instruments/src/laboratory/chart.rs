//! Line charts: series of points over two axes, as SVG and as a table.

use serde::Serialize;
use std::fmt::Write;

/// An axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// Whether it is logarithmic; values that are not positive are left out then.
    pub is_log: bool,
    /// From where to where; by the data where not given.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis that spans the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis that spans the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), is_log: true, range: None }
    }

    /// The same axis over a range.
    pub fn over(self, from: f64, to: f64) -> Self {
        Self { range: Some((from, to)), ..self }
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Marker {
    /// A line through the points.
    #[default]
    Line,
    /// A dashed line.
    Dashed,
    /// Dots.
    Dots,
    /// A closed, filled outline.
    Area,
}

/// A named sequence of points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Its name, in the legend and the table.
    pub name: String,
    /// The points.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub marker: Marker,
    /// An sRGB colour; one by its place in the chart where not given.
    pub color: Option<[u8; 3]>,
}

impl Series {
    /// A line.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, marker: Marker::Line, color: None }
    }

    /// The same points, drawn otherwise.
    pub fn drawn(self, marker: Marker) -> Self {
        Self { marker, ..self }
    }

    /// The same points in a colour.
    pub fn colored(self, color: [u8; 3]) -> Self {
        Self { color: Some(color), ..self }
    }
}

/// A chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// Above it.
    pub title: String,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// Whether a unit has the same length on both axes.
    pub is_isometric: bool,
    /// What it shows.
    pub series: Vec<Series>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 76.0;
const TOP: f64 = 40.0;
const RIGHT: f64 = 24.0;
const BOTTOM: f64 = 60.0;
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
    fn new(axis: &Axis, values: impl Iterator<Item = f64>, start: f64, length: f64) -> Self {
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
        Self { from, to, start, length, is_log: axis.is_log }
    }

    fn at(&self, v: f64) -> Option<f64> {
        let v = if self.is_log { v.log10() } else { v };
        let p = self.start + (v - self.from) / (self.to - self.from) * self.length;
        // Far outside is clipped by the picture; numbers stay short.
        p.is_finite().then(|| p.clamp(-1e5, 1e5))
    }

    /// Values at round distances, with their text.
    fn ticks(&self) -> Vec<(f64, String)> {
        if self.is_log && self.to - self.from >= 1.0 {
            let step = ((self.to - self.from) / 8.0).ceil().max(1.0) as i32;
            let (a, b) = (self.from.ceil() as i32, self.to.floor() as i32);
            return (a..=b).step_by(step as usize).map(|e| (10f64.powi(e), power_of_ten(e))).collect();
        }
        let (a, b) = if self.is_log { (10f64.powf(self.from), 10f64.powf(self.to)) } else { (self.from, self.to) };
        let raw = (b - a) / 7.0;
        let unit = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * unit).find(|s| *s >= raw).unwrap_or(raw);
        let digits = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        let first = (a / step).ceil() as i64;
        (first..)
            .map(|k| k as f64 * step)
            .take_while(|v| *v <= b + 1e-9 * step)
            .take(64)
            .map(|v| {
                let text = if v != 0.0 && !(1e-4..1e6).contains(&v.abs()) {
                    format!("{v:.3e}")
                } else {
                    format!("{v:.digits$}")
                };
                (v, text)
            })
            .collect()
    }
}

/// `10ⁿ` with a superscript.
fn power_of_ten(e: i32) -> String {
    let digits: String = e
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            d => char::from_u32(0x2070 + d.to_digit(10).unwrap_or(0)).unwrap_or(d),
        })
        .collect();
    format!("10{digits}")
}

/// Text that may stand in XML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
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
            let _ = writeln!(svg, "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3\" fill=\"{color}\"/>");
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
        Marker::Dashed => format!("\" fill=\"none\" stroke-dasharray=\"6 4\" stroke=\"{color}"),
        _ => format!("\" fill=\"none\" stroke-width=\"1.6\" stroke=\"{color}"),
    };
    let _ = writeln!(svg, "<path d=\"{d}{style}\"/>");
}

impl Chart {
    /// A chart without series.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, is_isometric: false, series: Vec::new() }
    }

    /// With one more series.
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// As SVG.
    pub fn svg(&self) -> String {
        let all = || self.series.iter().flat_map(|s| &s.points);
        let (mut w, mut h) = (WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
        let x = Scale::new(&self.x, all().map(|p| p.0), LEFT, w);
        let y = Scale::new(&self.y, all().map(|p| p.1), TOP + h, -h);
        let (x, y) = if self.is_isometric {
            let unit = (w / (x.to - x.from)).min(1.6 * h / (y.to - y.from));
            w = unit * (x.to - x.from);
            h = unit * (y.to - y.from);
            (Scale { length: w, ..x }, Scale { start: TOP + h, length: -h, ..y })
        } else {
            (x, y)
        };
        let (right, bottom) = (LEFT + w, TOP + h);
        let (width, height) = (right + RIGHT, bottom + BOTTOM);
        let mut svg = String::new();
        let _ = write!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
             height=\"{height:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
             <clipPath id=\"plot\"><rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{w:.1}\" height=\"{h:.1}\"/></clipPath>\n\
             <text x=\"{LEFT}\" y=\"22\" font-size=\"15\">{}</text>\n",
            escape(&self.title)
        );
        self.frame(&mut svg, &x, &y, [w, h]);
        svg.push_str("<g clip-path=\"url(#plot)\">\n");
        for (k, series) in self.series.iter().enumerate() {
            curve(&mut svg, series, &hex(series, k), &x, &y);
        }
        svg.push_str("</g>\n");
        self.legend(&mut svg, right);
        svg.push_str("</svg>\n");
        svg
    }

    /// Lines and numbers at round values, the border, and the names of the axes.
    fn frame(&self, svg: &mut String, x: &Scale, y: &Scale, [w, h]: [f64; 2]) {
        let (right, bottom) = (LEFT + w, TOP + h);
        for (v, text) in x.ticks() {
            let Some(p) = x.at(v) else { continue };
            let _ = writeln!(
                svg,
                "<path d=\"M{p:.1} {TOP}V{bottom:.1}\" stroke=\"#e4e4e4\"/><text x=\"{p:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>",
                bottom + 18.0
            );
        }
        for (v, text) in y.ticks() {
            let Some(p) = y.at(v) else { continue };
            let _ = writeln!(
                svg,
                "<path d=\"M{LEFT} {p:.1}H{right:.1}\" stroke=\"#e4e4e4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                LEFT - 6.0,
                p + 4.0
            );
        }
        let _ = writeln!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{w:.1}\" height=\"{h:.1}\" fill=\"none\" stroke=\"#888\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(18 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            LEFT + w / 2.0,
            bottom + 40.0,
            escape(&self.x.label),
            TOP + h / 2.0,
            escape(&self.y.label)
        );
    }

    /// The names of the series, where there are several, up to the plot's `right` end.
    fn legend(&self, svg: &mut String, right: f64) {
        let named: Vec<_> = self.series.iter().enumerate().filter(|s| !s.1.name.is_empty()).collect();
        if named.len() > 1 {
            let (letters, rows) =
                (named.iter().map(|s| s.1.name.chars().count()).max().unwrap_or(0), named.len().min(16));
            let (width, height) = (42.0 + 6.6 * letters as f64, 10.0 + 16.0 * rows as f64);
            let (x, y) = (right - width - 2.0, TOP + 2.0);
            let _ = writeln!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y}\" width=\"{width:.1}\" height=\"{height}\" fill=\"white\" fill-opacity=\"0.8\"/>"
            );
            for (row, (k, series)) in named.into_iter().take(16).enumerate() {
                let color = hex(series, k);
                let at = TOP + 18.0 + 16.0 * row as f64;
                let _ = writeln!(
                    svg,
                    "<path d=\"M{:.1} {:.1}h18\" stroke=\"{color}\" stroke-width=\"3\"/>\
                     <text x=\"{:.1}\" y=\"{at:.1}\" text-anchor=\"end\">{}</text>",
                    right - 26.0,
                    at - 4.0,
                    right - 32.0,
                    escape(&series.name)
                );
            }
        }
    }

    /// As text: a line of `series x y`, separated by tabs, for each point, below a line of headings.
    pub fn table(&self) -> String {
        let mut text = format!("series\t{}\t{}\n", self.x.label, self.y.label);
        for series in &self.series {
            for (x, y) in &series.points {
                let _ = writeln!(text, "{}\t{x}\t{y}", series.name);
            }
        }
        text
    }
}

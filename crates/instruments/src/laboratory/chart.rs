//! Line charts: series of points over two axes, as a table and (`draw.rs`) as SVG.

use serde::Serialize;
use std::fmt::Write;

/// An axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity on the axis, with its unit.
    pub label: String,
    /// Enables a logarithmic scale; values that are not positive are left out then.
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

    /// Sets the range of the axis.
    pub fn over(self, from: f64, to: f64) -> Self {
        Self { range: Some((from, to)), ..self }
    }
}

/// Mark of a series.
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
    /// Mark of the series.
    pub marker: Marker,
    /// An sRGB colour; one by its place in the chart where not given.
    pub color: Option<[u8; 3]>,
}

impl Series {
    /// A line.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, marker: Marker::Line, color: None }
    }

    /// Sets the mark of the series.
    pub fn drawn(self, marker: Marker) -> Self {
        Self { marker, ..self }
    }

    /// Sets the sRGB colour of the series.
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
    /// True if a unit has the same length on both axes.
    pub is_isometric: bool,
    /// Series drawn in the chart.
    pub series: Vec<Series>,
    /// Background picture; the ground is dark then.
    #[serde(skip)]
    pub backdrop: Option<Backdrop>,
    /// Words at points.
    #[serde(skip)]
    pub labels: Vec<Label>,
}

/// A picture behind a chart, over all of its axes, which have ranges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Backdrop {
    /// A file of PNG.
    pub png: Vec<u8>,
}

/// Words to the right of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The point.
    pub at: (f64, f64),
    /// Text of the label.
    pub text: String,
}

impl Chart {
    /// A chart without series.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        let (series, labels) = (Vec::new(), Vec::new());
        Self { title: title.into(), x, y, is_isometric: false, series, backdrop: None, labels }
    }

    /// With one more series.
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
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

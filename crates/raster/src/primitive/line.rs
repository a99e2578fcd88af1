//! Lines.

use super::{
    Edge, Primitive, Setup,
    setup::{corner, relative},
    window::{self, Port},
};
use crate::{samples::SUBPIXELS, stages::Vertex, state::LineMode, varyings::Varyings};

const UNIT: i64 = SUBPIXELS as i64;
const HALF: i64 = UNIT / 2;

/// Edges, how many of them count, and the first pixels and those after the last.
type Outline = ([Edge; 4], u8, [i32; 2], [i32; 2]);

impl<V: Varyings> Setup<'_, V> {
    /// Takes a line.
    pub fn line(&mut self, ends: [&Vertex<V>; 2], provoking: usize, id: u32) {
        self.line_part(ends, ends[provoking], id, None);
    }

    /// A line, or an edge of a triangle of this side and with this depth bias.
    pub(super) fn line_part(&mut self, ends: [&Vertex<V>; 2], provoking: &Vertex<V>, id: u32, of: Option<(bool, f64)>) {
        let Some((port, _)) = self.admit(provoking, ends.into_iter()) else { return };
        // Clip in homogeneous coordinates, then project both ends.
        let (planes, count) = self.planes(port);
        let Some(parts) = planes.clip_line(ends.map(corner), count) else {
            self.chunk.counters.outside += 1;
            return;
        };
        let p = [port.project(parts[0].position), port.project(parts[1].position)];
        let mode = match self.window.raster.line_mode {
            LineMode::Bresenham if self.window.extent.samples > 1 => LineMode::Rectangle,
            mode => mode,
        };
        let Some((edges, edge_count, min, max)) = (match mode {
            LineMode::Bresenham => self.diamonds(p, port),
            LineMode::Rectangle => self.rectangle(p, port, 0.0),
            LineMode::Smooth => self.rectangle(p, port, 0.5),
        }) else {
            self.chunk.counters.empty += 1;
            return;
        };
        let (front, bias) = of.unwrap_or((true, 0.0));
        let [from, to] = p.map(|corner| corner.at.map(|x| f64::from(x) / f64::from(SUBPIXELS)));
        // Gradients of the attribute planes: along the line from 0 to 1, across it in pixels.
        let d = [to[0] - from[0], to[1] - from[1]];
        let squared = d[0] * d[0] + d[1] * d[1];
        let length = squared.sqrt();
        let (along, across) = if squared > 0.0 {
            ([d[0] / squared, d[1] / squared], [-d[1] / length, d[0] / length])
        } else {
            ([0.0; 2], [0.0; 2])
        };
        let rise = p[1].depth - p[0].depth;
        let zero = parts[0].floats;
        let flat = provoking.varyings.to_floats();
        let attributes = self.store_attributes([&zero, &parts[1].floats, &zero], &flat);
        let (inv_w, inv_w_scale) = relative([p[0].inv_w, p[1].inv_w, p[0].inv_w]);
        self.bin(Primitive {
            edges,
            edge_count,
            front,
            smooth: mode == LineMode::Smooth,
            viewport: provoking.viewport as u8,
            layer: provoking.layer as u16,
            min,
            max,
            id,
            attributes,
            origin: from,
            weights: [along, across],
            depth: [p[0].depth + bias, rise * along[0], rise * along[1]],
            depth_range: port.depth_range,
            inv_w,
            inv_w_scale,
            line: [self.window.raster.line_width / 2.0, length as f32],
        });
    }

    /// The pixels of the diamond-exit rule: one in each column that the line crosses (of lines that are steeper than
    /// 45°, in each row), where at the ends those count whose diamond the line leaves. Wider lines have as many along
    /// the column.
    fn diamonds(&self, p: [window::Corner; 2], port: &Port) -> Option<Outline> {
        let at = p.map(|corner| corner.at.map(i64::from));
        let d = [at[1][0] - at[0][0], at[1][1] - at[0][1]];
        if d == [0, 0] {
            return None;
        }
        // Step along the axis of greater extent.
        let major = usize::from(d[1].abs() > d[0].abs());
        let minor = 1 - major;
        let (dm, dn) = (d[major], d[minor]);
        let centre = |column: i64| column * UNIT + HALF;
        // Row of the line at the centre of a column, as the half-open edges below choose it.
        let row = |column: i64| {
            // Pixel row by exact integer division: (y₀·run + rise·(x − x₀)) / run.
            let (rise, run) = if dm > 0 { (dn, dm) } else { (-dn, -dm) };
            (at[0][minor] * run + rise * (centre(column) - at[0][major])).div_euclid(run * UNIT)
        };
        let in_diamond = |end: [i64; 2], column: i64, row: i64| {
            (end[major] - centre(column)).abs() + (end[minor] - centre(row)).abs() < HALF
        };
        // Diamond-exit rule (OpenGL 4.6, 14.5.1): the first pixel counts if the line begins before its centre or within
        // its diamond, the last one if the line leaves its diamond.
        let sign = dm.signum();
        let start = at[0][major].div_euclid(UNIT);
        let end = at[1][major].div_euclid(UNIT);
        let begins =
            (centre(start) - at[0][major]) * sign >= 0 || in_diamond(at[0], start, at[0][minor].div_euclid(UNIT));
        let leaves = (at[1][major] - centre(end)) * sign > 0 && !in_diamond(at[1], end, row(end));
        let mut first = if begins { start } else { start + sign };
        let mut last = if leaves { end } else { end - sign };
        if (last - first) * sign < 0 {
            return None;
        }
        if sign < 0 {
            (first, last) = (last, first);
        }
        let width = i64::from(self.window.raster.line_width.round().max(1.0) as i32);
        let shift = (width * HALF) as i32;
        // The edges run along the line in the direction of rising columns.
        let (low, high) = if sign > 0 { (p[0].at, p[1].at) } else { (p[1].at, p[0].at) };
        let moved = |point: [i32; 2], by: i32| {
            let mut point = point;
            point[minor] += by;
            point
        };
        // Rows with centres in (line − w/2, line + w/2]: of a line along the border of two rows, the one below.
        let mut lower = Edge::through(moved(low, -shift), moved(high, -shift));
        let mut upper = Edge::through(moved(high, shift), moved(low, shift));
        if major == 1 {
            // Columns and rows change places, and with them the side that is inside.
            lower = negated(lower);
            upper = negated(upper);
        }
        lower.c -= 1;
        let ends = [at[0][minor], at[1][minor]];
        let (mut min, mut max) = ([0; 2], [0; 2]);
        (min[major], max[major]) = (first as i32, last as i32 + 1);
        // A pixel more on each side, since the line is drawn on to the centres of its last columns.
        min[minor] = ((ends[0].min(ends[1]) - i64::from(shift)).div_euclid(UNIT) - 1) as i32;
        max[minor] = ((ends[0].max(ends[1]) + i64::from(shift)).div_euclid(UNIT) + 2) as i32;
        let limit = |axis: usize| (min[axis].max(port.min[axis]), max[axis].min(port.max[axis]));
        let ((x0, x1), (y0, y1)) = (limit(0), limit(1));
        Some(([lower, upper, Edge::default(), Edge::default()], 2, [x0, y0], [x1, y1]))
    }

    /// A rectangle around the line, larger by so many pixels on each side.
    fn rectangle(&self, p: [window::Corner; 2], port: &Port, margin: f64) -> Option<Outline> {
        // Offset the ends along the line and across it by half the width.
        let d = [0, 1].map(|axis| f64::from(p[1].at[axis]) - f64::from(p[0].at[axis]));
        let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
        if length == 0.0 {
            return None;
        }
        let along = d.map(|x| x / length * margin * f64::from(SUBPIXELS));
        let half = (f64::from(self.window.raster.line_width) / 2.0 + margin) * f64::from(SUBPIXELS);
        let across = [-d[1] / length * half, d[0] / length * half];
        let corner = |end: usize, side: f64| {
            let outward = if end == 0 { -1.0 } else { 1.0 };
            [0, 1].map(|axis| {
                let at = f64::from(p[end].at[axis]) + outward * along[axis] + side * across[axis];
                at.round_ties_even() as i32
            })
        };
        // Clockwise with y down: `across` is to the right of the line.
        let corners = [corner(0, -1.0), corner(1, -1.0), corner(1, 1.0), corner(0, 1.0)];
        let edges = std::array::from_fn(|i| Edge::between(corners[i], corners[(i + 1) % 4]));
        let bound = |axis: usize| {
            let values = corners.map(|c| c[axis]);
            (values.iter().copied().min().unwrap_or(0), values.iter().copied().max().unwrap_or(0))
        };
        let ((x0, x1), (y0, y1)) = (bound(0), bound(1));
        let (min, max) = self.pixels([x0, y0], [x1, y1], (port.min, port.max));
        Some((edges, 4, min, max))
    }
}

fn negated(edge: Edge) -> Edge {
    Edge { a: -edge.a, b: -edge.b, c: -edge.c }
}

//! Points: squares around their vertex.

use super::{Edge, Primitive, Setup};
use crate::{samples::SUBPIXELS, stages::Vertex, varyings::Varyings};

/// The largest point in pixels.
const LARGEST: f32 = 2048.0;

impl<V: Varyings> Setup<'_, V> {
    /// Takes a point.
    pub fn point(&mut self, vertex: &Vertex<V>, id: u32) {
        self.point_part(vertex, vertex, id, None);
    }

    /// A point, or a corner of a triangle of this side and with this depth bias.
    pub(super) fn point_part(&mut self, vertex: &Vertex<V>, provoking: &Vertex<V>, id: u32, of: Option<(bool, f64)>) {
        let Some((port, _)) = self.admit(provoking, std::iter::once(vertex)) else { return };
        let corner = super::setup::corner(vertex);
        let (planes, count) = self.planes(port);
        // Points are drawn whole or not at all. Sizes that are no number count as 0.
        let size = if vertex.point_size > 0.0 { vertex.point_size.min(LARGEST) } else { 0.0 };
        if planes.outside(&corner, count) != 0 || size == 0.0 {
            self.chunk.counters.outside += 1;
            return;
        }
        let p = port.project(vertex.position);
        // A square around the projected vertex, as four edges clockwise with y down.
        let half = (f64::from(size) * f64::from(SUBPIXELS) / 2.0).round_ties_even() as i32;
        let (low, high) = (p.at.map(|x| x - half), p.at.map(|x| x + half));
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        let edges = std::array::from_fn(|i| Edge::between(corners[i], corners[(i + 1) % 4]));
        let (min, max) = self.pixels(low, high, (port.open_min, port.open_max));
        let floats = corner.floats;
        let flat = provoking.varyings.to_floats();
        let attributes = self.store_attributes([&floats, &floats, &floats], &flat);
        let (front, bias) = of.unwrap_or((true, 0.0));
        // Point coordinates run from 0 to 1 across the square.
        let width = f64::from(2 * half) / f64::from(SUBPIXELS);
        let step = if width > 0.0 { 1.0 / width } else { 0.0 };
        self.bin(Primitive {
            edges,
            edge_count: 4,
            front,
            smooth: false,
            viewport: provoking.viewport as u8,
            layer: provoking.layer as u16,
            min,
            max,
            id,
            attributes,
            origin: low.map(|x| f64::from(x) / f64::from(SUBPIXELS)),
            weights: [[step, 0.0], [0.0, step]],
            depth: [p.depth + bias, 0.0, 0.0],
            depth_range: port.depth_range,
            inv_w: [1.0, 0.0, 0.0],
            inv_w_scale: p.inv_w as f32,
            line: [0.0; 2],
        });
    }
}

//! From vertices in clip space to primitives that tiles can draw: clipping, projection, edges and planes.
//!
//! Window positions have 8 bits below the pixel. Edge functions are exact in 64 bits, and fit 32 within a block, since
//! primitives are clipped at ±32000 pixels.

mod clip;
mod line;
mod point;
mod setup;
mod triangle;
mod window;

pub(crate) use setup::{Chunk, Setup};
pub(crate) use window::Window;

/// A half plane in sub-pixel units: a·x + b·y + c ≥ 0 is inside. The top-left rule is in `c`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Edge {
    pub a: i32,
    pub b: i32,
    pub c: i64,
}

impl Edge {
    /// The half plane to the right of the way from one point to the other (y down). Of points on it, those belong to it
    /// that are on a left edge or a top one.
    pub fn between(from: [i32; 2], to: [i32; 2]) -> Self {
        let mut edge = Self::through(from, to);
        // Points on the edge belong to one side only; integer coordinates make "greater than zero" the same as "at
        // least one".
        if !(edge.a > 0 || (edge.a == 0 && edge.b > 0)) {
            edge.c -= 1;
        }
        edge
    }

    /// The closed half plane.
    pub fn through(from: [i32; 2], to: [i32; 2]) -> Self {
        // The cross product of the edge and the way to the point, expanded into a plane.
        let (a, b) = (from[1] - to[1], to[0] - from[0]);
        Self { a, b, c: -(i64::from(a) * i64::from(from[0]) + i64::from(b) * i64::from(from[1])) }
    }

    #[inline(always)]
    pub fn at(&self, x: i64, y: i64) -> i64 {
        // E(x, y) = a·x + b·y + c in 64 bits, exact within the guard band.
        i64::from(self.a) * x + i64::from(self.b) * y + self.c
    }
}

/// A primitive in the window. Pixels belong to it that are in the box and whose samples are inside all edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Primitive {
    pub edges: [Edge; 4],
    pub edge_count: u8,
    pub front: bool,
    /// A line with smooth borders: alpha is multiplied with coverage.
    pub smooth: bool,
    pub viewport: u8,
    pub layer: u16,
    /// Pixels: from (inclusive) to (exclusive); never outside the framebuffer.
    pub min: [i32; 2],
    pub max: [i32; 2],
    pub id: u32,
    /// Index of its first attribute.
    pub attributes: u32,
    /// Origin of the attribute planes, in pixels.
    pub origin: [f64; 2],
    /// Gradients of the weights of the second and third corner, which are 0 at the origin. For points: their
    /// coordinates. For lines: the way along it (0 to 1), and the distance from it in pixels.
    pub weights: [[f64; 2]; 2],
    /// Depth at the origin, and its gradient.
    pub depth: [f64; 3],
    /// Depths are clamped to this range.
    pub depth_range: [f32; 2],
    /// 1/w of the first corner, and the differences of the others to it, divided by the largest.
    pub inv_w: [f32; 3],
    /// The largest 1/w.
    pub inv_w_scale: f32,
    /// Half the width and the length of a smooth line, in pixels.
    pub line: [f32; 2],
}

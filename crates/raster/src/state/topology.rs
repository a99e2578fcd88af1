//! Which vertices form which primitive.

use super::MAX_PATCH_VERTICES;
use crate::error::{Result, refuse};

/// Primitives that the vertices of a draw form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    /// A point each.
    Points,
    /// A line for each two.
    Lines,
    /// A line from each to the next.
    LineStrip,
    /// As a strip, and a line from the last to the first.
    LineLoop,
    /// A triangle for each three.
    Triangles,
    /// A triangle for each with the two before it; every other is turned round.
    TriangleStrip,
    /// A triangle of the first, each and the next.
    TriangleFan,
    /// Four for each line: the one before, start, end, the one after.
    LinesAdjacency,
    /// A strip of lines with the one before the first and the one after the last.
    LineStripAdjacency,
    /// Six for each triangle: corners at 0, 2, 4, the vertex across the following edge after each.
    TrianglesAdjacency,
    /// A strip of triangles with the vertices across their edges.
    TriangleStripAdjacency,
    /// So many vertices for each patch, at most 32.
    Patches(u32),
}

/// Which vertex of a primitive gives its flat varyings, layer and viewport.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Provoking {
    /// The first.
    First,
    /// The last.
    Last,
}

/// The shape of the primitives that reach the rasteriser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    Point,
    Line,
    Triangle,
}

/// The vertices of a primitive by their place among those of the draw: `count` of them, and which one provokes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners {
    pub places: [u32; 6],
    pub count: usize,
    pub provoking: usize,
}

impl Topology {
    pub(super) fn check(self) -> Result<()> {
        match self {
            Self::Patches(0) => refuse("Pipeline::new", "a patch needs vertices"),
            Self::Patches(n) if n > MAX_PATCH_VERTICES => {
                refuse("Pipeline::new", format!("patches of {n} vertices; at most {MAX_PATCH_VERTICES}"))
            }
            _ => Ok(()),
        }
    }

    /// The shape; none for patches.
    pub(crate) fn shape(self) -> Option<Shape> {
        match self {
            Self::Points => Some(Shape::Point),
            Self::Lines | Self::LineStrip | Self::LineLoop | Self::LinesAdjacency | Self::LineStripAdjacency => {
                Some(Shape::Line)
            }
            Self::Triangles
            | Self::TriangleStrip
            | Self::TriangleFan
            | Self::TrianglesAdjacency
            | Self::TriangleStripAdjacency => Some(Shape::Triangle),
            Self::Patches(_) => None,
        }
    }

    /// Number of primitives that `vertices` vertices form.
    pub fn primitives(self, vertices: u64) -> u64 {
        let n = vertices;
        match self {
            Self::Points => n,
            Self::Lines => n / 2,
            Self::LineStrip => n.saturating_sub(1),
            Self::LineLoop => {
                if n < 2 {
                    0
                } else {
                    n
                }
            }
            Self::Triangles => n / 3,
            Self::TriangleStrip | Self::TriangleFan => n.saturating_sub(2),
            Self::LinesAdjacency => n / 4,
            Self::LineStripAdjacency => n.saturating_sub(3),
            Self::TrianglesAdjacency => n / 6,
            Self::TriangleStripAdjacency => (n / 2).saturating_sub(2),
            Self::Patches(size) => n / u64::from(size.max(1)),
        }
    }

    /// The vertices of primitive `k` of `n` vertices; not for patches, whose vertices follow each other.
    #[inline]
    pub(crate) fn corners(self, k: u32, n: u32, provoking: Provoking) -> Corners {
        let mut places = [0; 6];
        let first = provoking == Provoking::First;
        let mut set = |list: &[u32], provoking: usize| {
            places[..list.len()].copy_from_slice(list);
            (list.len(), provoking)
        };
        let end = |last: usize| if first { 0 } else { last };
        let odd = k % 2 == 1;
        let (count, provoking) = match self {
            Self::Points => set(&[k], 0),
            Self::Lines => set(&[2 * k, 2 * k + 1], end(1)),
            Self::LineStrip => set(&[k, k + 1], end(1)),
            Self::LineLoop => set(&[k, if k + 1 == n { 0 } else { k + 1 }], end(1)),
            Self::Triangles => set(&[3 * k, 3 * k + 1, 3 * k + 2], end(2)),
            Self::TriangleStrip if odd => set(&[k, k + 2, k + 1], if first { 0 } else { 1 }),
            Self::TriangleStrip => set(&[k, k + 1, k + 2], end(2)),
            Self::TriangleFan => set(&[0, k + 1, k + 2], if first { 1 } else { 2 }),
            Self::LinesAdjacency => set(&[4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3], if first { 1 } else { 2 }),
            Self::LineStripAdjacency => set(&[k, k + 1, k + 2, k + 3], if first { 1 } else { 2 }),
            Self::TrianglesAdjacency => {
                let i = 6 * k;
                set(&[i, i + 1, i + 2, i + 3, i + 4, i + 5], if first { 0 } else { 4 })
            }
            Self::TriangleStripAdjacency => set(
                &strip_adjacency(k, n / 2 - 2),
                if first {
                    0
                } else if odd {
                    2
                } else {
                    4
                },
            ),
            Self::Patches(_) => (0, 0),
        };
        Corners { places, count, provoking }
    }
}

/// The six vertices of triangle `k` of `count` in a strip with adjacency, in our order (OpenGL 4.6, table 10.2: corners
/// and the vertices across edges 12, 23, 31). Even: corners 2k, 2k+2, 2k+4. Odd triangles are turned round.
fn strip_adjacency(k: u32, count: u32) -> [u32; 6] {
    let i = 2 * k;
    // Across the edge to the triangle before: that one's far corner, or the given one for the first.
    let before = if k == 0 { 1 } else { i - 2 };
    // Across the edge to the triangle after.
    let after = if k + 1 == count { i + 5 } else { i + 6 };
    if k % 2 == 1 { [i, i + 3, i + 4, after, i + 2, before] } else { [i, before, i + 2, after, i + 4, i + 3] }
}

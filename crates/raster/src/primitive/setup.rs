//! Primitives of a job: what is in the view is cut, projected and put into the lists of the tiles.

use super::{
    Edge, Primitive, Window,
    clip::{Corner, Planes, is_inside},
    window::Port,
};
use crate::{
    counters::Counters,
    render_target::TILE,
    samples::SUBPIXELS,
    stages::Vertex,
    varyings::{Varyings, any_is},
};

/// The primitives of a job, ready for the tiles.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    pub primitives: Vec<Primitive>,
    /// For each primitive: the floats of its first corner, then the differences of the second to it, then of the third.
    pub attributes: Vec<f32>,
    /// Places in `primitives`, sorted by tile.
    pub list: Vec<u32>,
    /// Start of the list of each tile, and the end of the last.
    pub starts: Vec<u32>,
    pub counters: Counters,
}

/// Takes assembled primitives.
pub(crate) struct Setup<'a, V: Varyings> {
    pub(super) window: &'a Window,
    pub(super) chunk: Chunk,
    /// Tile and primitive, in order of primitives.
    pairs: Vec<(u32, u32)>,
    marker: std::marker::PhantomData<V>,
}

/// Number of planes of the view.
const VIEW_PLANES: u32 = 7;

impl<'a, V: Varyings> Setup<'a, V> {
    pub const HAS_CLIP: bool = any_is(V::MODES, true);
    pub const HAS_CULL: bool = any_is(V::MODES, false);

    pub fn new(window: &'a Window) -> Self {
        Self { window, chunk: Chunk::default(), pairs: Vec::new(), marker: std::marker::PhantomData }
    }

    /// The planes that `position` is outside of: w, near, far, left, right, bottom, top. `None` if it is not finite.
    #[inline]
    pub(super) fn view_code(&self, position: glam::Vec4) -> Option<u32> {
        if !position.is_finite() {
            return None;
        }
        let [x, y, z, w] = position.to_array();
        let raster = &self.window.raster;
        // Outcodes: one bit for each plane of the view volume (Cohen and Sutherland).
        let near = match raster.depth_range {
            crate::state::DepthRange::ZeroToOne => z < 0.0,
            crate::state::DepthRange::MinusOneToOne => z < -w,
        };
        let clip = raster.depth_clip;
        // Compare with w before the division, so that corners behind the eye get the right code.
        let bits = [w <= 0.0, near && clip, z > w && clip, x < -w, x > w, y < -w, y > w];
        Some((0..VIEW_PLANES).fold(0, |code, i| code | u32::from(bits[i as usize]) << i))
    }

    /// Counts a primitive, and says whether it may be seen: viewport and planes of its corners that are not all outside
    /// one of them. The code is 0 where nothing can cut it.
    #[inline]
    pub(super) fn admit<'v>(
        &mut self,
        provoking: &Vertex<V>,
        vertices: impl Iterator<Item = &'v Vertex<V>> + Clone,
    ) -> Option<(&'a Port, u32)>
    where
        V: 'v,
    {
        self.chunk.counters.primitives += 1;
        if self.window.raster.discard {
            return None;
        }
        let port = self.window.ports.get(provoking.viewport as usize);
        let (Some(port), true) = (port, provoking.layer < self.window.extent.layers) else {
            self.chunk.counters.outside += 1;
            return None;
        };
        // Trivial rejection where all corners lie outside one plane: the conjunction of their codes is not zero.
        let (mut all, mut any) = (!0, 0);
        for vertex in vertices.clone() {
            let Some(code) = self.view_code(vertex.position) else {
                self.chunk.counters.not_finite += 1;
                return None;
            };
            all &= code;
            any |= code;
        }
        if Self::HAS_CULL && self.culled_by_distance(vertices) {
            all = !0;
        }
        if all != 0 {
            self.chunk.counters.outside += 1;
            return None;
        }
        Some((port, any))
    }

    fn culled_by_distance<'v>(&self, vertices: impl Iterator<Item = &'v Vertex<V>> + Clone) -> bool
    where
        V: 'v,
    {
        // Cull distances: dropped where one of them is negative at all vertices.
        let is_out = |i: usize, v: &Vertex<V>| !is_inside(v.varyings.to_floats().as_ref()[i].into());
        let modes = V::MODES.iter().enumerate().filter(|(_, mode)| **mode == crate::varyings::Mode::Cull);
        modes.into_iter().any(|(i, _)| vertices.clone().all(|v| is_out(i, v)))
    }

    pub(super) fn planes<'p>(&'p self, port: &'p Port) -> (Planes<'p>, usize) {
        let planes = Planes { modes: V::MODES, raster: &self.window.raster, port };
        let count = planes.count(Self::HAS_CLIP);
        (planes, count)
    }

    /// Pixels with a sample in the box between these sub-pixel positions, within these limits.
    #[inline]
    pub(super) fn pixels(&self, min: [i32; 2], max: [i32; 2], limits: ([i32; 2], [i32; 2])) -> ([i32; 2], [i32; 2]) {
        let pattern = &self.window.pattern;
        // First pixel whose last sample may lie inside, and last pixel whose first sample may.
        let first = |axis: usize| (min[axis] - pattern.max[axis] + SUBPIXELS - 1).div_euclid(SUBPIXELS);
        let last = |axis: usize| (max[axis] - pattern.min[axis]).div_euclid(SUBPIXELS) + 1;
        ([0, 1].map(|i| first(i).max(limits.0[i])), [0, 1].map(|i| last(i).min(limits.1[i])))
    }

    /// Stores the attributes of the corners: `provoking` gives the flat ones.
    #[inline]
    pub(super) fn store_attributes(&mut self, corners: [&V::Floats; 3], provoking: &V::Floats) -> u32 {
        let attributes = &mut self.chunk.attributes;
        let start = attributes.len() as u32;
        let [a, b, c] = corners.map(|floats| floats.as_ref());
        for (i, mode) in V::MODES.iter().enumerate() {
            attributes.push(if *mode == crate::varyings::Mode::Flat { provoking.as_ref()[i] } else { a[i] });
        }
        // Store differences to the first corner: interpolation is then two multiplications and additions.
        attributes.extend(b.iter().zip(a).map(|(b, a)| b - a));
        attributes.extend(c.iter().zip(a).map(|(c, a)| c - a));
        start
    }

    /// Adds a primitive to the tiles that it may touch.
    pub(super) fn bin(&mut self, primitive: Primitive) {
        let (min, max) = (primitive.min, primitive.max);
        if min[0] >= max[0] || min[1] >= max[1] {
            self.chunk.counters.empty += 1;
            return;
        }
        let number = self.chunk.primitives.len() as u32;
        let extent = self.window.extent;
        let tile = TILE as i32;
        // List the primitive in every tile of its box; tiles that an edge excludes are left out where the box is large.
        let [first, last] = [min.map(|x| x / tile), max.map(|x| (x - 1) / tile)];
        let many = first[0] != last[0] && first[1] != last[1];
        let before = self.pairs.len();
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                if many && misses(&primitive, column * tile, row * tile) {
                    continue;
                }
                // Tiles are numbered layer by layer and row by row.
                let rows = u32::from(primitive.layer) * extent.tile_rows() + row as u32;
                self.pairs.push((rows * extent.tile_columns() + column as u32, number));
            }
        }
        if self.pairs.len() == before {
            self.chunk.counters.empty += 1;
            return;
        }
        self.chunk.counters.binned += (self.pairs.len() - before) as u64;
        self.chunk.primitives.push(primitive);
    }

    /// The primitives with the lists of their tiles.
    pub fn finish(mut self) -> Chunk {
        // Counting sort by tile: within a tile the order of submission stays.
        let mut starts = vec![0; self.window.extent.tiles() + 1];
        for (tile, _) in &self.pairs {
            starts[*tile as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut list = vec![0; self.pairs.len()];
        for (tile, primitive) in self.pairs {
            let place = &mut next[tile as usize];
            list[*place as usize] = primitive;
            *place += 1;
        }
        self.chunk.list = list;
        self.chunk.starts = starts;
        self.chunk
    }
}

/// 1/w of three corners as [`Primitive`] has them: the first and differences to it in units of the largest, and the
/// largest.
#[inline]
pub(super) fn relative(inv_w: [f64; 3]) -> ([f32; 3], f32) {
    if inv_w[0] == inv_w[1] && inv_w[0] == inv_w[2] {
        return ([1.0, 0.0, 0.0], inv_w[0] as f32);
    }
    let largest = inv_w[0].max(inv_w[1]).max(inv_w[2]);
    // Scale by the largest 1/w, so that far and near primitives have the same relative precision.
    let [a, b, c] = inv_w.map(|x| (x / largest) as f32);
    ([a, b - a, c - a], largest as f32)
}

/// True if the tile at this pixel lies outside one of the primitive's edges.
fn misses(primitive: &Primitive, x: i32, y: i32) -> bool {
    // The tile's corner farthest inside the edge decides.
    let corner = |gradient: i32, start: i32| {
        let start = i64::from(start) * i64::from(SUBPIXELS);
        if gradient > 0 { start + i64::from(TILE as i32 * SUBPIXELS) } else { start }
    };
    let outside = |edge: &Edge| edge.at(corner(edge.a, x), corner(edge.b, y)) < 0;
    primitive.edges[..usize::from(primitive.edge_count)].iter().any(outside)
}

/// A vertex as a corner in clip space.
#[inline]
pub(super) fn corner<V: Varyings>(vertex: &Vertex<V>) -> Corner<V::Floats> {
    Corner { position: vertex.position, floats: vertex.varyings.to_floats() }
}

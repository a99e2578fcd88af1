//! Partition of the pixels into groups that share paths and move from sample to sample.
//!
//! The film is cut into blocks of 4 × 4 pixels, and the pixels of each block are dealt out, at random, to 16 layers. A
//! group has the pixels of one layer in a square window of blocks. For every sample of a pixel the windows of its layer
//! lie elsewhere, and those of different layers never lie alike: what a group finds spreads over its window, and over
//! all samples smoothly about it, without an edge anywhere. Neighbouring pixels belong to different layers, so the
//! errors that members share appear scattered like ordinary noise.
//!
//! A pixel keeps its layer and its rank, so its numbers can be parts of a point set over the pixels about it and all
//! samples.

use crate::adaptive::CELL;
use steradian_core::sampler::{PixelSampler, Sampler};
use steradian_math::hash::{ONE_MINUS_EPSILON, combine32, mix32};

/// Tile edge, pixels. Tiles are aligned to the frame, whatever its crop.
pub const TILE: u32 = 16;
/// Most pixels of a group.
pub const MAX_GROUP: usize = 16;
/// Cells along the edge of a tile.
pub const CELLS: u32 = TILE / CELL;
/// log₂ of the edge of a block, pixels.
const BLOCK_BITS: u32 = 2;
const BLOCK: u32 = 1 << BLOCK_BITS;
/// Blocks along the edge of a tile.
const BLOCKS: u32 = TILE / BLOCK;

/// The groups of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Partition {
    /// Blocks along the edge of a window.
    edge: u32,
    seed: u32,
}

/// The window of a group.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Its first block: column and row.
    origin: [i32; 2],
    layer: u32,
}

/// A pixel of a group.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Column in the frame.
    pub x: u32,
    /// Row in the frame.
    pub y: u32,
    layer: u32,
}

/// The number of the cell in which a pixel of the frame lies.
pub fn cell_of(x: u32, y: u32) -> usize {
    (y % TILE / CELL * CELLS + x % TILE / CELL) as usize
}

impl Place {
    /// A pixel that shares nothing.
    pub fn alone([x, y]: [u32; 2]) -> Self {
        Self { x, y, layer: 0 }
    }
}

impl Partition {
    /// Layers, each of which has one pixel of every block.
    pub const LAYERS: u32 = BLOCK * BLOCK;

    /// Groups of `size` pixels, a power of four up to [`MAX_GROUP`].
    pub fn new(size: u32, seed: u64) -> Self {
        Self {
            edge: size.isqrt().clamp(1, BLOCKS).next_power_of_two(),
            seed: mix32(seed as u32 ^ (seed >> 32) as u32 ^ 0x3c6e_f372),
        }
    }

    /// Pixels of a group.
    pub fn size(&self) -> u32 {
        self.edge * self.edge
    }

    /// The windows that begin in a tile, given by column and row, for the samples of a number; those that begin one
    /// tile before a frame reach into it.
    pub fn windows(&self, [column, row]: [i32; 2], sample: u32) -> impl Iterator<Item = Window> + '_ {
        let windows = BLOCKS / self.edge;
        (0..Self::LAYERS * windows * windows).map(move |k| {
            let (layer, at) = (k % Self::LAYERS, k / Self::LAYERS);
            let offset = self.offset(sample, layer);
            let origin = |tile: i32, at: u32, offset: u32| tile * BLOCKS as i32 + (at * self.edge + offset) as i32;
            Window { origin: [origin(column, at % windows, offset[0]), origin(row, at / windows, offset[1])], layer }
        })
    }

    /// The windows of another partition that make up the window of a layer that begins with a tile.
    pub fn parts(&self, tile: [i32; 2], layer: u32, of: &Self) -> impl Iterator<Item = Window> + use<> {
        let (edge, parts) = (of.edge, self.edge / of.edge);
        (0..parts * parts).map(move |k| {
            let origin = |tile: i32, at: u32| tile * BLOCKS as i32 + (at * edge) as i32;
            Window { origin: [origin(tile[0], k % parts), origin(tile[1], k / parts)], layer }
        })
    }

    /// Windows with as many pixels together as the largest group has, about a cell that is given by its first pixel.
    pub fn about(&self, cell: [u32; 2], chance: u32) -> impl Iterator<Item = Window> + use<> {
        let edge = self.edge;
        (0..MAX_GROUP as u32 / self.size()).map(move |k| {
            // A cell is two blocks wide: larger windows are centred on it, smaller ones lie in it.
            let at = |axis: usize| {
                let inside = CELL / BLOCK;
                let offset = if edge > inside { -((edge - inside) as i32) / 2 } else { 0 };
                let step = (k >> axis & 1) * inside.saturating_sub(edge);
                (cell[axis] / BLOCK + step) as i32 + offset
            };
            Window { origin: [at(0), at(1)], layer: chance.wrapping_add(k) % Self::LAYERS }
        })
    }

    /// Offset of the windows of a layer, modulo their size, for a sample: in as many samples as there are places each
    /// is met once, the first few lie far apart, and so do those of different layers for one sample.
    fn offset(&self, sample: u32, layer: u32) -> [u32; 2] {
        // Bits of the sample's number, from the lowest on, halve the distance, along the diagonal first.
        let bit = |v: u32, k: u32| v >> k & 1;
        let (mut x, mut y) = (0, 0);
        for k in 0..self.edge.trailing_zeros() {
            let (a, b) = (bit(sample, 2 * k) ^ bit(layer, 2 * k), bit(sample, 2 * k + 1) ^ bit(layer, 2 * k + 1));
            (x, y) = (x << 1 | (a ^ b), y << 1 | a);
        }
        [x, y]
    }

    /// The pixels of a group with columns and rows that are not negative, of which some may lie beyond the frame.
    pub fn places(&self, window: Window) -> impl Iterator<Item = Place> + '_ {
        (0..self.size()).filter_map(move |k| {
            let at = |origin: i32, step: u32| u32::try_from(origin + step as i32).ok();
            let block = [at(window.origin[0], k % self.edge)?, at(window.origin[1], k / self.edge)?];
            let pixel = permuted(window.layer, combine32(combine32(self.seed, block[0]), block[1]));
            let (x, y) = (block[0] * BLOCK + pixel % BLOCK, block[1] * BLOCK + pixel / BLOCK);
            Some(Place { x, y, layer: window.layer })
        })
    }

    /// The numbers of a pixel's sample that are stratified over the pixels about it too.
    pub fn joint(&self, sampler: &Sampler, place: &Place, sample: u32) -> PixelSampler {
        let ([column, row], edge) = ([place.x / BLOCK, place.y / BLOCK], self.edge);
        let joint = sampler.group(column / edge, row / edge, place.layer, sample, self.size());
        joint.member(row % edge * edge + column % edge)
    }

    /// A number of a sample that all pixels of a layer have in common. Those of a pixel are stratified, and so are
    /// those of a block for each sample, also modulo one quarter, since wavelengths are told from the number in steps
    /// of that.
    pub fn common(&self, sampler: &Sampler, place: &Place, sample: u32, dimension: u32) -> f32 {
        let common = sampler.group(u32::MAX, u32::MAX, 0, sample, 1).member(0).get_1d(dimension);
        let shift = (place.layer % BLOCK) as f32 / BLOCK as f32 + place.layer as f32 / (BLOCK * Self::LAYERS) as f32;
        (common + shift).fract().min(ONE_MINUS_EPSILON)
    }
}

/// The place of a number below 16 in a random order: rounds of what can be undone on four bits.
fn permuted(mut v: u32, seed: u32) -> u32 {
    const MASK: u32 = Partition::LAYERS - 1;
    for round in 0..3 {
        let key = seed >> (10 * round);
        v = (v ^ key) & MASK;
        v = v.wrapping_mul(key >> 3 | 1) & MASK;
        v ^= v >> 2;
        v = v.wrapping_add(key >> 6) & MASK;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For every sample each pixel is in one group, and groups are whole but for the frame's edges.
    #[test]
    fn groups_are_a_partition_for_every_sample() {
        for size in [1, 4, 16] {
            let partition = Partition::new(size, 7);
            assert_eq!(partition.size(), size);
            for sample in 0..20 {
                let mut met = vec![0; 48 * 48];
                for row in -1..3 {
                    for column in -1..3 {
                        for window in partition.windows([column, row], sample) {
                            let places: Vec<Place> = partition.places(window).collect();
                            assert!(places.len() as u32 <= size);
                            for p in places.iter().filter(|p| p.x < 48 && p.y < 48) {
                                met[(p.y * 48 + p.x) as usize] += 1;
                            }
                        }
                    }
                }
                assert!(met.iter().all(|n| *n == 1), "{size}, sample {sample}: {met:?}");
            }
        }
    }

    /// Pixels share the less often the farther apart they are, and no place of the film is another one's edge: how
    /// often a pixel shares with the one four columns on is the same everywhere, for one sample of all layers as for
    /// all samples of one.
    #[test]
    fn no_place_has_an_edge() {
        let partition = Partition::new(16, 3);
        let of = |sample: u32, layer: u32, block: u32| (block + 16 - partition.offset(sample, layer)[0]) / 4;
        for (a, b, times) in [(0, 1, 12), (1, 2, 12), (2, 3, 12), (3, 4, 12), (5, 7, 8), (6, 9, 4), (4, 8, 0)] {
            for k in 0..16 {
                let in_sample = (0..16).filter(|layer| of(k, *layer, a) == of(k, *layer, b)).count();
                let in_layer = (0..16).filter(|sample| of(*sample, k, a) == of(*sample, k, b)).count();
                assert_eq!([in_sample, in_layer], [times; 2], "blocks {a} and {b}");
            }
        }
    }

    /// Orders of blocks are permutations, and all places are about equally likely for each number.
    #[test]
    fn orders_are_permutations() {
        let mut counts = [[0_u32; 16]; 16];
        for seed in 0..16_000 {
            let mut met = 0_u32;
            for v in 0..16 {
                let p = permuted(v, mix32(seed));
                met |= 1 << p;
                counts[v as usize][p as usize] += 1;
            }
            assert_eq!(met, 0xffff);
        }
        assert!(counts.iter().flatten().all(|n| (850..1150).contains(n)), "{counts:?}");
    }
}

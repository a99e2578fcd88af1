//! Which pixels share paths: a partition of a tile into groups, the same for all samples.
//!
//! Each group has one pixel, chosen at random, of each of N square blocks that lie together. So its members are near each other, while
//! the errors that they share appear scattered like ordinary noise, and are not seen as blotches.

use crate::adaptive::CELL;
use steradian_core::sampler::{GroupSampler, Sampler};
use steradian_math::hash::{combine32, mix32};

/// Tile edge, pixels. Tiles are aligned to the frame, whatever its crop.
pub const TILE: u32 = 16;
/// Cells along the edge of a tile.
pub const CELLS: u32 = TILE / CELL;
const PIXELS: usize = (TILE * TILE) as usize;

/// A partition of a tile.
pub struct Partition {
    corner: [u32; 2],
    /// Pixels per group.
    size: u32,
    /// Pixels by group, as `y · TILE + x`.
    order: [u8; PIXELS],
}

/// A pixel of a group.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Column in the frame.
    pub x: u32,
    /// Row in the frame.
    pub y: u32,
    /// Number in the group.
    pub rank: u32,
}

/// Edge of the blocks of which a group has one pixel each. Members that are nearer share more; from two on, neighbours mostly belong to
/// different groups.
const BLOCK: u32 = 2;

/// The number of the cell in which a pixel of the frame lies.
pub fn cell_of(x: u32, y: u32) -> usize {
    (y % TILE / CELL * CELLS + x % TILE / CELL) as usize
}

impl Partition {
    /// For the tile whose first pixel is `corner`, into groups of `size` pixels, a power of four.
    pub fn new(corner: [u32; 2], size: u32, seed: u64) -> Self {
        let edge = size.isqrt().clamp(1, TILE / 2);
        let block = BLOCK;
        let region = edge * block;
        let mut order = [0; PIXELS];
        let hash = combine32(combine32(mix32(seed as u32 ^ (seed >> 32) as u32 ^ 0x3c6e_f372), corner[0]), corner[1]);
        let per_region = block * block;
        let mut numbers = [0_u8; PIXELS];
        for (r, ry, rx) in grid(TILE / region) {
            for (b, by, bx) in grid(edge) {
                // Which group has which pixel of the block.
                let pixels = &mut numbers[..per_region as usize];
                shuffle(pixels, combine32(hash, r * PIXELS as u32 + b));
                for (g, p) in pixels.iter().enumerate() {
                    let p = u32::from(*p);
                    let x = rx * region + bx * block + p % block;
                    let y = ry * region + by * block + p / block;
                    let group = r * per_region + g as u32;
                    order[(group * edge * edge + b) as usize] = (y * TILE + x) as u8;
                }
            }
        }
        // Which number a block has in a group is left to chance too.
        for (g, group) in order.chunks_mut((edge * edge) as usize).enumerate() {
            permute(group, combine32(hash ^ 0x510e_527f, g as u32));
        }
        Self { corner, size: edge * edge, order }
    }

    /// How many groups there are.
    pub fn groups(&self) -> u32 {
        PIXELS as u32 / self.size
    }

    /// The groups of a cell ([`cell_of`]).
    pub fn groups_of(&self, cell: usize) -> impl Iterator<Item = u32> + '_ {
        (0..self.groups()).filter(move |g| {
            let [x, y] = self.first(*g);
            cell_of(x, y) == cell
        })
    }

    /// A pixel of a group, in the frame.
    pub fn first(&self, group: u32) -> [u32; 2] {
        let p = u32::from(self.order[(group * self.size) as usize]);
        [self.corner[0] + p % TILE, self.corner[1] + p / TILE]
    }

    /// The pixels of a group, of which some may lie beyond the frame.
    pub fn places(&self, group: u32) -> impl Iterator<Item = Place> + '_ {
        let first = (group * self.size) as usize;
        self.order[first..first + self.size as usize].iter().zip(0..).map(|(p, rank)| {
            let p = u32::from(*p);
            Place { x: self.corner[0] + p % TILE, y: self.corner[1] + p / TILE, rank }
        })
    }

    /// The numbers that members share with their group: one point set for all members and samples.
    pub fn sampler(&self, sampler: &Sampler, group: u32, index: u32) -> GroupSampler {
        sampler.group(self.corner[0], self.corner[1], group, index, self.size)
    }
}

/// Number, row and column of the cells of a square.
fn grid(edge: u32) -> impl Iterator<Item = (u32, u32, u32)> {
    (0..edge * edge).map(move |i| (i, i / edge, i % edge))
}

/// The numbers from zero in random order.
fn shuffle(numbers: &mut [u8], seed: u32) {
    numbers.iter_mut().zip(0..).for_each(|(n, i)| *n = i);
    permute(numbers, seed);
}

/// A random order (Fisher and Yates).
fn permute(items: &mut [u8], seed: u32) {
    for i in (1..items.len()).rev() {
        let j = (u64::from(combine32(seed, i as u32)) * (i as u64 + 1)) >> 32;
        items.swap(i, j as usize);
    }
}

//! Render targets: colour targets, depth and stencil, in tiles of 64² pixels that threads own one at a time.

mod color;
mod depth_stencil;
mod framebuffer;

pub use color::ColorTarget;
pub use depth_stencil::{DepthFormat, DepthTarget, StencilTarget};
pub(crate) use framebuffer::Tile;
pub use framebuffer::{Framebuffer, Layout};

use rayon::prelude::*;

use crate::{
    error::{Result, refuse},
    state::{MAX_SIZE, Multisample},
};

/// Side of a tile in pixels.
pub(crate) const TILE: u32 = 64;
/// Side of a block in pixels.
pub(crate) const BLOCK: u32 = 8;
/// Blocks of a tile.
pub(crate) const TILE_BLOCKS: usize = ((TILE / BLOCK) * (TILE / BLOCK)) as usize;
/// Pixels of a block.
pub(crate) const BLOCK_PIXELS: usize = (BLOCK * BLOCK) as usize;
/// Pixels of a tile.
pub(crate) const TILE_PIXELS: usize = TILE_BLOCKS * BLOCK_PIXELS;
/// The most layers.
pub const MAX_LAYERS: u32 = 2048;

/// Size of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Layers.
    pub layers: u32,
    /// Samples of a pixel.
    pub samples: u32,
}

impl Extent {
    /// One layer with one sample.
    pub const fn new(width: u32, height: u32) -> Self {
        Self { width, height, layers: 1, samples: 1 }
    }

    /// With so many samples.
    pub const fn samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// With so many layers.
    pub const fn layers(self, layers: u32) -> Self {
        Self { layers, ..self }
    }

    pub(crate) fn check(self, call: &'static str) -> Result<()> {
        let Self { width, height, layers, samples } = self;
        if width == 0 || height == 0 || width > MAX_SIZE || height > MAX_SIZE {
            return refuse(call, format!("{width} × {height} pixels; each side is from 1 to {MAX_SIZE}"));
        }
        if layers == 0 || layers > MAX_LAYERS {
            return refuse(call, format!("{layers} layers; from 1 to {MAX_LAYERS}"));
        }
        Multisample::check(samples, call)?;
        // 2³⁰ samples are 4 GiB of depths.
        let total = self.tiles() as u64 * TILE_PIXELS as u64 * u64::from(samples);
        if total > 1 << 30 {
            return refuse(call, format!("{total} samples in all; at most 2³⁰"));
        }
        Ok(())
    }

    /// Pixels, layers and samples.
    fn samples_in_order(self) -> impl Iterator<Item = ([u32; 2], u32, u32)> {
        let pixels = (0..self.height).flat_map(move |y| (0..self.width).map(move |x| [x, y]));
        let layers = (0..self.layers).flat_map(move |layer| pixels.clone().map(move |at| (at, layer)));
        layers.flat_map(move |(at, layer)| (0..self.samples).map(move |sample| (at, layer, sample)))
    }

    pub(crate) const fn tile_columns(self) -> u32 {
        self.width.div_ceil(TILE)
    }

    pub(crate) const fn tile_rows(self) -> u32 {
        self.height.div_ceil(TILE)
    }

    pub(crate) const fn tiles(self) -> usize {
        self.tile_columns() as usize * self.tile_rows() as usize * self.layers as usize
    }

    /// Puts a layer's first samples, of `size` values each, into rows without gaps.
    pub(crate) fn untile<T: Copy + Default + Send + Sync>(self, tiled: &[T], size: usize, layer: u32) -> Vec<T> {
        let mut rows = vec![T::default(); self.width as usize * self.height as usize * size];
        rows.par_chunks_mut(self.width as usize * size).enumerate().for_each(|(y, row)| {
            // The pixels of a block's row lie one after the other.
            for (block, run) in row.chunks_mut(BLOCK as usize * size).enumerate() {
                if let Some(place) = self.place([block as u32 * BLOCK, y as u32], layer, 0) {
                    run.copy_from_slice(&tiled[place * size..][..run.len()]);
                }
            }
        });
        rows
    }

    /// The place of a sample among those of the target: tiles, in each samples, in each blocks, in each pixels.
    pub(crate) fn place(self, [x, y]: [u32; 2], layer: u32, sample: u32) -> Option<usize> {
        if x >= self.width || y >= self.height || layer >= self.layers || sample >= self.samples {
            return None;
        }
        let tile = (layer * self.tile_rows() + y / TILE) * self.tile_columns() + x / TILE;
        let block = (y % TILE / BLOCK) * (TILE / BLOCK) + x % TILE / BLOCK;
        let pixel = (y % BLOCK) * BLOCK + x % BLOCK;
        let plane = tile as usize * self.samples as usize + sample as usize;
        Some((plane * TILE_BLOCKS + block as usize) * BLOCK_PIXELS + pixel as usize)
    }
}

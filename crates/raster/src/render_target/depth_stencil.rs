//! Depth and stencil targets.

use super::{BLOCK_PIXELS, Extent, TILE_BLOCKS, TILE_PIXELS};
use crate::error::Result;

/// Storage format of depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthFormat {
    /// To multiples of 1/(2¹⁶ − 1).
    Unorm16,
    /// To multiples of 1/(2²⁴ − 1).
    Unorm24,
    /// To 32-bit floats.
    Float32,
}

impl DepthFormat {
    /// The number of steps, 0 for floats.
    pub(crate) fn steps(self) -> f64 {
        match self {
            Self::Unorm16 => 65535.0,
            Self::Unorm24 => 16_777_215.0,
            Self::Float32 => 0.0,
        }
    }

    /// The depth that is stored.
    #[inline]
    pub fn round(self, depth: f32) -> f32 {
        let steps = self.steps();
        if steps == 0.0 { depth } else { ((f64::from(depth) * steps).round_ties_even() / steps) as f32 }
    }

    /// The smallest difference near depth `largest`, the unit of
    /// [`DepthBias::constant`](crate::state::DepthBias::constant).
    pub(crate) fn smallest_step(self, largest: f32) -> f64 {
        match self {
            Self::Float32 => {
                let exponent = (largest.abs().to_bits() >> 23) as i32 - 127;
                2f64.powi(exponent.max(-126) - 23)
            }
            _ => 1.0 / self.steps(),
        }
    }
}

/// Depths in [0, 1].
#[derive(Clone, Debug)]
pub struct DepthTarget {
    extent: Extent,
    format: DepthFormat,
    /// Depths tile by tile ([`Extent::place`]).
    pub(super) depths: Vec<f32>,
    /// Bounds [least, largest] of the depths of each block, all samples together: not tight.
    pub(super) bounds: Vec<[f32; 2]>,
}

impl DepthTarget {
    /// A target of this size, cleared to 1.
    ///
    /// # Errors
    /// Where the size is beyond the limits.
    pub fn new(extent: Extent, format: DepthFormat) -> Result<Self> {
        extent.check("DepthTarget::new")?;
        let depths = vec![1.0; extent.tiles() * extent.samples as usize * TILE_PIXELS];
        Ok(Self { extent, format, depths, bounds: vec![[1.0; 2]; extent.tiles() * TILE_BLOCKS] })
    }

    /// Its size.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Its format.
    pub fn format(&self) -> DepthFormat {
        self.format
    }

    /// Fills all layers and samples with a depth, clamped to [0, 1] and rounded to the format; NaN gives 0.
    pub fn clear(&mut self, depth: f32) {
        let depth = self.format.round(if depth.is_nan() { 0.0 } else { depth.clamp(0.0, 1.0) });
        self.depths.fill(depth);
        self.bounds.fill([depth; 2]);
    }

    /// Takes the depth of each pixel, layer and sample; NaN gives 0.
    pub(crate) fn load(&mut self, depth: impl Fn([u32; 2], u32, u32) -> f32) {
        self.bounds.fill([f32::INFINITY, f32::NEG_INFINITY]);
        for (at, layer, sample) in self.extent.samples_in_order() {
            let Some(place) = self.extent.place(at, layer, sample) else { continue };
            let value = depth(at, layer, sample);
            let value = if value.is_nan() { 0.0 } else { value };
            self.depths[place] = value;
            let tile = place / (TILE_PIXELS * self.extent.samples as usize);
            let [least, largest] = &mut self.bounds[tile * TILE_BLOCKS + place / BLOCK_PIXELS % TILE_BLOCKS];
            (*least, *largest) = (least.min(value), largest.max(value));
        }
        // Blocks that are all outside.
        self.bounds.iter_mut().filter(|[least, largest]| least > largest).for_each(|bounds| *bounds = [1.0; 2]);
    }

    /// The depth of a sample; `None` outside.
    pub fn sample(&self, pixel: [u32; 2], layer: u32, sample: u32) -> Option<f32> {
        self.extent.place(pixel, layer, sample).map(|place| self.depths[place])
    }

    /// The depths of a layer's first samples, row by row.
    pub fn to_rows(&self, layer: u32) -> Vec<f32> {
        self.extent.untile(&self.depths, 1, layer)
    }

    /// Bounds of the depths of the 8×8 block with this pixel, which hold but need not be tight: a hierarchical depth
    /// buffer.
    pub fn block_bounds(&self, pixel: [u32; 2], layer: u32) -> Option<[f32; 2]> {
        let place = self.extent.place(pixel, layer, 0)?;
        let tile = place / (TILE_PIXELS * self.extent.samples as usize);
        let block = place / BLOCK_PIXELS % TILE_BLOCKS;
        Some(self.bounds[tile * TILE_BLOCKS + block])
    }
}

/// Stencil values.
#[derive(Clone, Debug)]
pub struct StencilTarget {
    extent: Extent,
    /// Values tile by tile ([`Extent::place`]).
    pub(super) values: Vec<u8>,
}

impl StencilTarget {
    /// A target of this size, cleared to 0.
    ///
    /// # Errors
    /// Where the size is beyond the limits.
    pub fn new(extent: Extent) -> Result<Self> {
        extent.check("StencilTarget::new")?;
        Ok(Self { extent, values: vec![0; extent.tiles() * extent.samples as usize * TILE_PIXELS] })
    }

    /// Its size.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Fills all layers and samples.
    pub fn clear(&mut self, value: u8) {
        self.values.fill(value);
    }

    /// Takes the value of each pixel, layer and sample.
    pub(crate) fn load(&mut self, value: impl Fn([u32; 2], u32, u32) -> u8) {
        for (at, layer, sample) in self.extent.samples_in_order() {
            if let Some(place) = self.extent.place(at, layer, sample) {
                self.values[place] = value(at, layer, sample);
            }
        }
    }

    /// The value of a sample; `None` outside.
    pub fn sample(&self, pixel: [u32; 2], layer: u32, sample: u32) -> Option<u8> {
        self.extent.place(pixel, layer, sample).map(|place| self.values[place])
    }

    /// The values of a layer's first samples, row by row.
    pub fn to_rows(&self, layer: u32) -> Vec<u8> {
        self.extent.untile(&self.values, 1, layer)
    }
}

//! Targets that are drawn into together.

use glam::Vec4;

use super::{ColorTarget, DepthFormat, DepthTarget, Extent, StencilTarget, TILE, TILE_BLOCKS, TILE_PIXELS};
use crate::{
    error::{Result, refuse},
    format::Format,
    state::MAX_TARGETS,
};

/// Formats of a framebuffer: what a pipeline is made for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Formats of the colour targets.
    pub colors: Vec<Format>,
    /// Format of the depths.
    pub depth: Option<DepthFormat>,
    /// True if there is a stencil target.
    pub stencil: bool,
    /// Samples of a pixel.
    pub samples: u32,
}

/// Colour targets, depth and stencil of one size.
#[derive(Clone, Debug)]
pub struct Framebuffer {
    extent: Extent,
    colors: Vec<ColorTarget>,
    depth: Option<DepthTarget>,
    stencil: Option<StencilTarget>,
}

impl Framebuffer {
    /// A framebuffer of these targets. They belong to it, so no shader can read what it draws to;
    /// [`into_parts`](Self::into_parts) gives them back.
    ///
    /// # Errors
    /// Where there is no target, there are too many, or sizes, layers or samples differ.
    pub fn new(colors: Vec<ColorTarget>, depth: Option<DepthTarget>, stencil: Option<StencilTarget>) -> Result<Self> {
        const CALL: &str = "Framebuffer::new";
        if colors.len() > MAX_TARGETS {
            return refuse(CALL, format!("{} colour targets; at most {MAX_TARGETS}", colors.len()));
        }
        let extents = || {
            let colors = colors.iter().map(ColorTarget::extent);
            colors.chain(depth.as_ref().map(DepthTarget::extent)).chain(stencil.as_ref().map(StencilTarget::extent))
        };
        let Some(extent) = extents().next() else {
            return refuse(CALL, "no target");
        };
        if let Some(other) = extents().find(|e| *e != extent) {
            return refuse(CALL, format!("targets of different size: {extent:?} and {other:?}"));
        }
        Ok(Self { extent, colors, depth, stencil })
    }

    /// One colour target, and depths as floats.
    ///
    /// # Errors
    /// Where the size is beyond the limits, or the format cannot be drawn to.
    pub fn with_color_and_depth(extent: Extent, color: Format) -> Result<Self> {
        let depth = DepthTarget::new(extent, DepthFormat::Float32)?;
        Self::new(vec![ColorTarget::new(extent, color)?], Some(depth), None)
    }

    /// Depths as floats alone.
    ///
    /// # Errors
    /// Where the size is beyond the limits.
    pub fn with_depth(extent: Extent) -> Result<Self> {
        Self::new(Vec::new(), Some(DepthTarget::new(extent, DepthFormat::Float32)?), None)
    }

    /// Its size.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Its formats.
    pub fn layout(&self) -> Layout {
        Layout {
            colors: self.colors.iter().map(ColorTarget::format).collect(),
            depth: self.depth.as_ref().map(DepthTarget::format),
            stencil: self.stencil.is_some(),
            samples: self.extent.samples,
        }
    }

    /// A colour target.
    ///
    /// # Panics
    /// Where there is none of this number.
    pub fn color(&self, target: usize) -> &ColorTarget {
        &self.colors[target]
    }

    /// The depths.
    pub fn depth(&self) -> Option<&DepthTarget> {
        self.depth.as_ref()
    }

    /// The stencil values.
    pub fn stencil(&self) -> Option<&StencilTarget> {
        self.stencil.as_ref()
    }

    /// Fills all colour targets, and depths and stencil where they are.
    pub fn clear(&mut self, color: Vec4, depth: f32, stencil: u8) {
        self.colors.iter_mut().for_each(|target| target.clear(color));
        self.clear_depth(depth);
        self.clear_stencil(stencil);
    }

    /// Fills one colour target.
    pub fn clear_color(&mut self, target: usize, color: Vec4) {
        if let Some(target) = self.colors.get_mut(target) {
            target.clear(color);
        }
    }

    /// Fills the depths.
    pub fn clear_depth(&mut self, depth: f32) {
        if let Some(target) = &mut self.depth {
            target.clear(depth);
        }
    }

    /// Fills the stencil values.
    pub fn clear_stencil(&mut self, value: u8) {
        if let Some(target) = &mut self.stencil {
            target.clear(value);
        }
    }

    /// The targets.
    pub fn into_parts(self) -> (Vec<ColorTarget>, Option<DepthTarget>, Option<StencilTarget>) {
        (self.colors, self.depth, self.stencil)
    }

    /// The tiles, layer by layer and row by row.
    pub(crate) fn tiles(&mut self) -> Vec<Tile<'_>> {
        let extent = self.extent;
        let plane = TILE_PIXELS * extent.samples as usize;
        let mut colors: Vec<_> = self
            .colors
            .iter_mut()
            .map(|target| {
                let bytes = target.tile_bytes();
                target.texels.chunks_exact_mut(bytes)
            })
            .collect();
        let mut depths = self
            .depth
            .as_mut()
            .map(|target| (target.depths.chunks_exact_mut(plane), target.bounds.chunks_exact_mut(TILE_BLOCKS)));
        let mut stencils = self.stencil.as_mut().map(|target| target.values.chunks_exact_mut(plane));
        let mut tiles = Vec::with_capacity(extent.tiles());
        for layer in 0..extent.layers {
            for row in 0..extent.tile_rows() {
                for column in 0..extent.tile_columns() {
                    let mut tile = Tile {
                        origin: [column * TILE, row * TILE],
                        layer,
                        colors: std::array::from_fn(|_| Default::default()),
                        depths: Default::default(),
                        bounds: Default::default(),
                        stencils: Default::default(),
                    };
                    for (slot, chunks) in tile.colors.iter_mut().zip(&mut colors) {
                        *slot = chunks.next().unwrap_or_default();
                    }
                    if let Some((depths, bounds)) = &mut depths {
                        tile.depths = depths.next().unwrap_or_default();
                        tile.bounds = bounds.next().unwrap_or_default();
                    }
                    if let Some(stencils) = &mut stencils {
                        tile.stencils = stencils.next().unwrap_or_default();
                    }
                    tiles.push(tile);
                }
            }
        }
        tiles
    }
}

/// One tile of all targets; slices of targets that are not there are empty. In each, samples, blocks and pixels as in
/// [`Extent::place`].
pub(crate) struct Tile<'a> {
    pub origin: [u32; 2],
    pub layer: u32,
    pub colors: [&'a mut [u8]; MAX_TARGETS],
    pub depths: &'a mut [f32],
    pub bounds: &'a mut [[f32; 2]],
    pub stencils: &'a mut [u8],
}

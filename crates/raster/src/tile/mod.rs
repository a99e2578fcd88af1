//! Drawing a tile: its primitives in order, block by block of 8×8 pixels, in strips of 8×2.
//!
//! Render targets are stored tile by tile, then block by block, so that threads own slices and no `unsafe` is needed.
//! Weights of corners follow from the exact edge functions in `f64`, once for each strip, so that slivers keep their
//! precision. The bounds of the depths of each block rule out primitives behind it (`bounds`).

mod bounds;
mod coverage;
mod lanes;
mod shade;
mod tests;
mod write;

use crate::{
    counters::Counters,
    primitive::{Chunk, Primitive},
    render_target::{BLOCK, TILE, TILE_BLOCKS, Tile},
    samples::Pattern,
    stages::FragmentShader,
};
pub(crate) use bounds::HiddenBy;
pub(crate) use tests::DepthPlan;
pub(crate) use write::ColorPlan;

use crate::state::{MAX_TARGETS, State};

/// Decisions taken when a pipeline is made.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Tests and their writes come before the fragment shader.
    pub early: bool,
    /// Test that may rule out a block or a sample before the fragment shader runs, if any may.
    pub hidden_by: HiddenBy,
    /// The fragment shader runs for each sample.
    pub per_sample: bool,
    /// The fragment shader's depth counts.
    pub shader_depth: bool,
    pub depth: Option<DepthPlan>,
    pub colors: [Option<ColorPlan>; MAX_TARGETS],
}

/// Draws tiles.
pub(crate) struct TileDrawer<'a, F: FragmentShader> {
    pub shader: &'a F,
    pub state: &'a State,
    pub plan: &'a Plan,
    pub pattern: &'a Pattern,
    pub counters: Counters,
    /// For each block, how often it was covered in part since its depth bounds were last made tight.
    parts: [u8; TILE_BLOCKS],
}

/// Location of a strip: in the tile, and its first pixel.
#[derive(Clone, Copy)]
struct Strip {
    block: usize,
    /// Which of the four strips of the block.
    index: usize,
    pixel: [i32; 2],
}

/// One bit for each of the 8×2 pixels of a strip, row by row, for each sample.
type Masks = [u16; 16];

impl<'a, F: FragmentShader> TileDrawer<'a, F> {
    pub fn new(shader: &'a F, state: &'a State, plan: &'a Plan, pattern: &'a Pattern) -> Self {
        Self { shader, state, plan, pattern, counters: Counters::default(), parts: [0; TILE_BLOCKS] }
    }

    /// Draws what the chunks have for the tile of this number.
    pub fn draw(&mut self, tile: &mut Tile, number: usize, chunks: &[Chunk]) {
        self.parts = [0; TILE_BLOCKS];
        for chunk in chunks {
            // Chunks and the lists in them keep the order of submission, which blending and equal depths depend on.
            let [start, end] = [chunk.starts[number], chunk.starts[number + 1]];
            for &place in &chunk.list[start as usize..end as usize] {
                let primitive = &chunk.primitives[place as usize];
                self.primitive(tile, primitive, &chunk.attributes[primitive.attributes as usize..]);
            }
        }
    }

    fn primitive(&mut self, tile: &mut Tile, primitive: &Primitive, attributes: &[f32]) {
        let origin = tile.origin.map(|x| x as i32);
        let block = BLOCK as i32;
        // Visit the blocks of 8×8 pixels that the primitive's box touches.
        let from = [0, 1].map(|i| (primitive.min[i] - origin[i]).max(0) / block);
        let to = [0, 1].map(|i| ((primitive.max[i] - origin[i]).min(TILE as i32) + block - 1) / block);
        for row in from[1]..to[1] {
            for column in from[0]..to[0] {
                let pixel = [origin[0] + column * block, origin[1] + row * block];
                self.block(tile, primitive, attributes, (row * (TILE as i32 / block) + column) as usize, pixel);
            }
        }
    }

    fn block(&mut self, tile: &mut Tile, primitive: &Primitive, attributes: &[f32], block: usize, pixel: [i32; 2]) {
        let Some(coverage) = coverage::Block::new(primitive, self.pattern, pixel) else { return };
        // Hierarchical depth test: skip the block where the primitive lies behind all that is stored there.
        let bounds = self.plan.depth.as_ref().map(|depth| depth.bounds(primitive, self.pattern, pixel));
        if let Some(bounds) = bounds
            && self.plan.hidden_by.hides(bounds, tile.bounds[block])
        {
            self.counters.hidden_blocks += 1;
            return;
        }
        let mut any = false;
        for index in coverage.strips() {
            let mut masks = [0; 16];
            coverage.strip(self.pattern, index, self.state.multisample.mask, &mut masks);
            if masks.iter().any(|&m| m != 0) {
                any = true;
                let strip = Strip { block, index, pixel: [pixel[0], pixel[1] + 2 * index as i32] };
                self.strip(tile, primitive, attributes, strip, masks);
            }
        }
        // The upper depth bound may move only if every sample of the block was certainly written.
        if let (true, Some(bounds)) = (any, bounds) {
            let whole = coverage.is_whole() && self.plan.early && self.state.stencil.is_none() && self.all_samples();
            self.update_bounds(tile, block, bounds, whole);
        }
    }

    fn all_samples(&self) -> bool {
        let all = (1u32 << self.pattern.count) - 1;
        self.state.multisample.mask & all == all
    }

    fn strip(&mut self, tile: &mut Tile, primitive: &Primitive, attributes: &[f32], strip: Strip, mut masks: Masks) {
        let count = self.pattern.count;
        let union = |masks: &Masks| masks[..count].iter().fold(0, |all, m| all | m);
        self.counters.covered_pixels += u64::from(union(&masks).count_ones());
        // Early tests shade only what is visible. Otherwise samples that are certainly hidden are dropped, and tests
        // follow the shader.
        if self.plan.early {
            for (sample, mask) in masks[..count].iter_mut().enumerate() {
                *mask = self.test(tile, primitive, strip, sample, *mask, None);
            }
        } else if self.plan.hidden_by != HiddenBy::Nothing {
            for (sample, mask) in masks[..count].iter_mut().enumerate() {
                *mask = self.visible(tile, primitive, strip, sample, *mask);
            }
        }
        if union(&masks) == 0 {
            return;
        }
        // Depth-only passes end here.
        if F::EMPTY && self.plan.early {
            self.count_samples(&masks);
            return;
        }
        // Sample shading: one invocation for each covered sample.
        if self.plan.per_sample {
            for sample in 0..count {
                let mut one = [0; 16];
                one[sample] = masks[sample];
                if one[sample] != 0 {
                    self.shade(tile, primitive, attributes, strip, one, Some(sample));
                }
            }
        } else {
            self.shade(tile, primitive, attributes, strip, masks, None);
        }
    }

    fn count_samples(&mut self, masks: &Masks) {
        self.counters.samples_passed += masks.iter().map(|m| u64::from(m.count_ones())).sum::<u64>();
    }
}

//! Hierarchical depth: bounds of the depths of each block rule out primitives behind them.

use super::{TileDrawer, tests::DepthPlan};
use crate::{
    primitive::Primitive,
    render_target::{BLOCK, BLOCK_PIXELS, TILE_PIXELS, Tile},
    samples::{Pattern, SUBPIXELS},
    stages::FragmentShader,
    state::Compare,
};

/// Which comparison may rule out samples before the fragment shader runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HiddenBy {
    /// None may.
    Nothing,
    /// This one.
    Depth(Compare),
}

impl HiddenBy {
    /// True if no depth within `new` passes against any within `old`.
    #[inline]
    pub fn hides(self, new: [f32; 2], old: [f32; 2]) -> bool {
        match self {
            Self::Depth(Compare::Less) => new[0] >= old[1],
            Self::Depth(Compare::LessEqual) => new[0] > old[1],
            Self::Depth(Compare::Greater) => new[1] <= old[0],
            Self::Depth(Compare::GreaterEqual) => new[1] < old[0],
            Self::Depth(Compare::Equal) => new[0] > old[1] || new[1] < old[0],
            Self::Depth(Compare::Never) => true,
            _ => false,
        }
    }
}

impl DepthPlan {
    /// Bounds of the depths of a primitive in a block.
    #[inline]
    pub fn bounds(&self, primitive: &Primitive, pattern: &Pattern, pixel: [i32; 2]) -> [f32; 2] {
        let units = f64::from(SUBPIXELS);
        // Interval arithmetic on the depth plane: each axis adds its least and greatest change over the samples of the
        // block.
        let [start, dx, dy] = primitive.depth;
        let along = |gradient: f64, axis: usize| {
            let at = f64::from(pixel[axis]) - primitive.origin[axis];
            let low = gradient * (at + f64::from(pattern.min[axis]) / units);
            let high = gradient * (at + f64::from(BLOCK - 1) + f64::from(pattern.max[axis]) / units);
            (low.min(high), low.max(high))
        };
        let ((x0, x1), (y0, y1)) = (along(dx, 0), along(dy, 1));
        let (low, high) = (start + x0 + y0, start + x1 + y1);
        // Depths of lanes are rounded a few times on their way, and then to the format.
        let margin = 1e-6 * (low.abs().max(high.abs())) + self.half_step;
        let [near, far] = primitive.depth_range;
        [((low - margin) as f32).clamp(near, far), ((high + margin) as f32).clamp(near, far)]
    }
}

/// Parts that are drawn into a block before its bounds are made tight again.
const PARTS: u8 = 8;

impl<F: FragmentShader> TileDrawer<'_, F> {
    /// Keeps the bounds of a block true after a primitive with depths in `new` was drawn there, all over it or in part.
    pub(super) fn update_bounds(&mut self, tile: &mut Tile, block: usize, new: [f32; 2], whole: bool) {
        let Some(depth) = &self.plan.depth else { return };
        if !depth.write {
            return;
        }
        let bounds = &mut tile.bounds[block];
        let new = if self.plan.shader_depth { [0.0, 1.0] } else { new };
        // A passed less-test can only lower depths: the lower bound follows the primitive, the upper one falls only
        // where the whole block was overwritten.
        match depth.compare {
            Compare::Less | Compare::LessEqual => {
                bounds[0] = bounds[0].min(new[0]);
                if whole {
                    bounds[1] = bounds[1].min(new[1]);
                }
            }
            Compare::Greater | Compare::GreaterEqual => {
                bounds[1] = bounds[1].max(new[1]);
                if whole {
                    bounds[0] = bounds[0].max(new[0]);
                }
            }
            Compare::Never => {}
            _ => *bounds = [bounds[0].min(new[0]), bounds[1].max(new[1])],
        }
        // Bounds loosen as parts are drawn: after several of them take the exact minimum and maximum of the stored
        // depths.
        self.parts[block] += u8::from(!whole);
        if self.parts[block] >= PARTS {
            self.parts[block] = 0;
            let mut tight = [[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]];
            for sample in 0..self.pattern.count {
                let start = sample * TILE_PIXELS + block * BLOCK_PIXELS;
                // Eight running minima and maxima fill vector registers.
                for row in tile.depths[start..start + BLOCK_PIXELS].chunks_exact(8) {
                    for i in 0..8 {
                        tight[0][i] = if row[i] < tight[0][i] { row[i] } else { tight[0][i] };
                        tight[1][i] = if row[i] > tight[1][i] { row[i] } else { tight[1][i] };
                    }
                }
            }
            tile.bounds[block] = [
                tight[0].iter().fold(f32::INFINITY, |a, b| a.min(*b)),
                tight[1].iter().fold(f32::NEG_INFINITY, |a, b| a.max(*b)),
            ];
        }
    }
}

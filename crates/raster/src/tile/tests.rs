//! Depth and stencil tests of a strip.

use super::{Strip, TileDrawer, lanes};
use crate::{
    primitive::Primitive,
    render_target::{BLOCK_PIXELS, DepthFormat, TILE_PIXELS, Tile},
    samples::SUBPIXELS,
    stages::FragmentShader,
    state::{Compare, DepthState, StencilFace, StencilOp},
};

/// The depth test.
#[derive(Clone, Debug)]
pub(crate) struct DepthPlan {
    pub compare: Compare,
    pub write: bool,
    /// Number of steps of the format, 0 for floats, and half of one.
    steps: f64,
    pub half_step: f64,
}

impl DepthPlan {
    pub fn new(state: DepthState, format: DepthFormat) -> Self {
        let steps = format.steps();
        let half_step = if steps > 0.0 { 0.5 / steps + 1e-7 } else { 0.0 };
        Self { compare: state.compare, write: state.write, steps, half_step }
    }

    fn round(&self, depths: &mut [f32; 16]) {
        if self.steps > 0.0 {
            for depth in depths {
                *depth = ((f64::from(*depth) * self.steps).round_ties_even() / self.steps) as f32;
            }
        }
    }
}

/// Lanes where the comparison holds.
#[inline(always)]
fn passing(compare: Compare, new: &[f32; 16], old: &[f32]) -> u16 {
    let old: &[f32; 16] = old.try_into().unwrap_or(&[0.0; 16]);
    match compare {
        Compare::Never => 0,
        Compare::Less => lanes::bits_where(|i| new[i] < old[i]),
        Compare::Equal => lanes::bits_where(|i| new[i] == old[i]),
        Compare::LessEqual => lanes::bits_where(|i| new[i] <= old[i]),
        Compare::Greater => lanes::bits_where(|i| new[i] > old[i]),
        Compare::NotEqual => lanes::bits_where(|i| new[i] != old[i]),
        Compare::GreaterEqual => lanes::bits_where(|i| new[i] >= old[i]),
        Compare::Always => !0,
    }
}

impl Primitive {
    /// Depths in a strip, at this offset in the pixels.
    #[inline]
    pub(super) fn depths(&self, pixel: [i32; 2], offset: [i32; 2]) -> [f32; 16] {
        let at =
            |axis: usize| f64::from(pixel[axis]) + f64::from(offset[axis]) / f64::from(SUBPIXELS) - self.origin[axis];
        let [start, dx, dy] = self.depth;
        let first = (start + dx * at(0) + dy * at(1)) as f32;
        let (dx, dy) = (dx as f32, dy as f32);
        let [near, far] = self.depth_range;
        let mut depths = [0.0; 16];
        for (i, depth) in depths.iter_mut().enumerate() {
            let value = first + (dx * lanes::COLUMN[i] as f32 + dy * lanes::ROW[i] as f32);
            let value = if value > near { value } else { near };
            *depth = if value < far { value } else { far };
        }
        depths
    }
}

impl<F: FragmentShader> TileDrawer<'_, F> {
    /// Index of the strip's first value of a sample.
    fn start(strip: Strip, sample: usize) -> usize {
        sample * TILE_PIXELS + strip.block * BLOCK_PIXELS + strip.index * 16
    }

    /// Samples that the depth test lets pass; nothing is written.
    pub(super) fn visible(&self, tile: &Tile, primitive: &Primitive, strip: Strip, sample: usize, mask: u16) -> u16 {
        let Some(plan) = &self.plan.depth else { return mask };
        if mask == 0 {
            return 0;
        }
        let start = Self::start(strip, sample);
        let mut depths = primitive.depths(strip.pixel, self.pattern.offsets[sample]);
        plan.round(&mut depths);
        mask & passing(plan.compare, &depths, &tile.depths[start..start + 16])
    }

    /// Stencil and depth test with what they write; gives the samples that pass. `depths` replaces those of the
    /// primitive.
    #[inline]
    pub(super) fn test(
        &self,
        tile: &mut Tile,
        primitive: &Primitive,
        strip: Strip,
        sample: usize,
        mask: u16,
        depths: Option<&[f32; 16]>,
    ) -> u16 {
        if mask == 0 {
            return 0;
        }
        let start = Self::start(strip, sample);
        let stencil = self.state.stencil.as_ref().filter(|_| !tile.stencils.is_empty());
        let face = stencil.map(|stencil| if primitive.front { stencil.front } else { stencil.back });
        let mut passed = mask;
        if let Some(face) = &face {
            let values = &tile.stencils[start..start + 16];
            let compares = |i: usize| face.compare.passes(face.reference & face.read_mask, values[i] & face.read_mask);
            passed &= lanes::bits_where(compares);
        }
        let stencil_passed = passed;
        if let Some(plan) = &self.plan.depth {
            let mut new = match depths {
                Some(depths) => *depths,
                None => primitive.depths(strip.pixel, self.pattern.offsets[sample]),
            };
            plan.round(&mut new);
            let old = &mut tile.depths[start..start + 16];
            passed &= passing(plan.compare, &new, old);
            if plan.write && passed != 0 {
                for (i, old) in old.iter_mut().enumerate() {
                    *old = if passed & (1 << i) != 0 { new[i] } else { *old };
                }
            }
        }
        if let Some(face) = &face {
            let values = &mut tile.stencils[start..start + 16];
            update(face, values, face.fail, mask & !stencil_passed);
            update(face, values, face.depth_fail, stencil_passed & !passed);
            update(face, values, face.pass, passed);
        }
        passed
    }
}

/// Applies an operation to the stencil values of these lanes.
fn update(face: &StencilFace, values: &mut [u8], op: StencilOp, mask: u16) {
    if op == StencilOp::Keep || mask == 0 {
        return;
    }
    for (i, value) in values.iter_mut().enumerate() {
        if mask & (1 << i) != 0 {
            let new = op.apply(*value, face.reference);
            *value = (*value & !face.write_mask) | (new & face.write_mask);
        }
    }
}

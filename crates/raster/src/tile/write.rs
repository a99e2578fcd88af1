//! Colours into targets: blending, logic operations, masks.

use glam::Vec4;

use super::{Masks, Strip, TileDrawer, shade::quad_lanes};
use crate::{
    format::{Format, Numeric, encode_rgba8},
    output::FragmentOutput,
    primitive::Primitive,
    render_target::{BLOCK_PIXELS, TILE_PIXELS, Tile},
    stages::FragmentShader,
    state::{BlendState, ColorState, LogicOp},
};

/// Blending and writing of the colours of a target.
#[derive(Clone, Debug)]
pub(crate) struct ColorPlan {
    format: Format,
    bytes: usize,
    blend: Option<BlendState>,
    logic: Option<LogicOp>,
    write: [bool; 4],
    constant: Vec4,
    /// Colours of normalised formats are clamped before they are blended.
    limits: Option<(Vec4, Vec4)>,
}

impl ColorPlan {
    pub fn new(format: Format, state: ColorState, logic: Option<LogicOp>, constant: [f32; 4]) -> Self {
        let limits = match format.numeric() {
            Numeric::Unorm | Numeric::Srgb => Some((Vec4::ZERO, Vec4::ONE)),
            Numeric::Snorm => Some((Vec4::NEG_ONE, Vec4::ONE)),
            _ => None,
        };
        let constant = Vec4::from_array(constant);
        let constant = limits.map_or(constant, |(low, high)| constant.clamp(low, high));
        // Logic operations are ignored for floating-point and sRGB formats, as OpenGL has it.
        let logic = logic.filter(|_| !matches!(format.numeric(), Numeric::Float | Numeric::Srgb));
        Self { format, bytes: format.bytes(), blend: state.blend, logic, write: state.write, constant, limits }
    }

    /// True if the colour in the target does not matter.
    fn replaces(&self) -> bool {
        self.blend.is_none() && self.logic.is_none() && self.write == [true; 4]
    }

    /// True for the commonest target: four channels of 8 bits that are replaced.
    fn is_plain(&self) -> bool {
        self.format == Format::Rgba8Unorm && self.replaces()
    }

    /// Writes one sample that depends on what is there.
    fn combine(&self, texel: &mut [u8], source: Vec4, second: Vec4) {
        // Read, modify, write: a logic operation on the encoded bits, or blending of the decoded colours.
        let old = self.format.read(texel);
        if let Some(op) = self.logic {
            let mut new = [0; 16];
            self.format.write(source, &mut new);
            for (new, old) in new.iter_mut().zip(&*texel) {
                *new = op.apply(*new, *old);
            }
            return self.masked(texel, self.format.read(&new), old);
        }
        let Some(blend) = &self.blend else {
            return self.masked(texel, source, old);
        };
        let clamped = |color: Vec4| self.limits.map_or(color, |(low, high)| color.max(low).min(high));
        self.masked(texel, blend.blend(clamped(source), clamped(second), old, self.constant), old);
    }

    fn masked(&self, texel: &mut [u8], new: Vec4, old: Vec4) {
        let mut color = old.to_array();
        for ((color, new), write) in color.iter_mut().zip(new.to_array()).zip(self.write) {
            if write {
                *color = new;
            }
        }
        self.format.write(Vec4::from_array(color), texel);
    }
}

impl<F: FragmentShader> TileDrawer<'_, F> {
    pub(super) fn write(
        &self,
        tile: &mut Tile,
        primitive: &Primitive,
        strip: Strip,
        masks: &Masks,
        outputs: &[Option<[F::Output; 4]>; 4],
    ) {
        let count = self.pattern.count;
        let union = masks[..count].iter().fold(0, |all, m| all | m);
        let start = strip.block * BLOCK_PIXELS + strip.index * 16;
        for (target, plan) in self.plan.colors.iter().enumerate().take(F::Output::COLORS) {
            let Some(plan) = plan else { continue };
            let texels = &mut *tile.colors[target];
            if plan.is_plain() && !primitive.smooth && !self.state.multisample.alpha_to_one {
                write_plain::<F>(texels, start, (&masks[..count], target), outputs);
                continue;
            }
            // Write quad by quad, lane by lane, and within a pixel every covered sample.
            for (q, quad) in outputs.iter().enumerate() {
                let Some(quad) = quad else { continue };
                for (lane, output) in quad_lanes(q).into_iter().zip(quad) {
                    if union >> lane & 1 == 0 {
                        continue;
                    }
                    let mut color = output.color(target);
                    if primitive.smooth {
                        color.w *= smooth_coverage(primitive, strip, lane);
                    }
                    if self.state.multisample.alpha_to_one {
                        color.w = 1.0;
                    }
                    // Encode once for all samples of the pixel.
                    let mut texel = [0; 16];
                    if plan.replaces() {
                        plan.format.write(color, &mut texel);
                    }
                    for sample in (0..count).filter(|&s| masks[s] >> lane & 1 != 0) {
                        let place = (sample * TILE_PIXELS + start + lane) * plan.bytes;
                        let there = &mut texels[place..place + plan.bytes];
                        if plan.replaces() {
                            there.copy_from_slice(&texel[..plan.bytes]);
                        } else {
                            plan.combine(there, color, output.second());
                        }
                    }
                }
            }
        }
    }
}

/// Replaces texels of four bytes.
#[inline(always)]
fn write_plain<F: FragmentShader>(
    texels: &mut [u8],
    start: usize,
    (masks, target): (&[u16], usize),
    outputs: &[Option<[F::Output; 4]>; 4],
) {
    for (q, quad) in outputs.iter().enumerate() {
        let Some(quad) = quad else { continue };
        // Written out: the compiler does not always inline `map`.
        let texel = |i: usize| encode_rgba8(quad[i].color(target));
        let colors = [texel(0), texel(1), texel(2), texel(3)];
        for (sample, mask) in masks.iter().enumerate() {
            let Some(strip) = texels[(sample * TILE_PIXELS + start) * 4..].first_chunk_mut::<64>() else { continue };
            for (lane, color) in quad_lanes(q).into_iter().zip(colors) {
                if mask >> lane & 1 != 0 {
                    strip[4 * lane..4 * lane + 4].copy_from_slice(&color);
                }
            }
        }
    }
}

/// Coverage of a pixel by a smooth line: a ramp of one pixel at its sides and ends.
fn smooth_coverage(primitive: &Primitive, strip: Strip, lane: usize) -> f32 {
    let half_pixel = 0.5;
    let at = [lane as i32 % 8, lane as i32 / 8];
    let p = [0, 1].map(|axis| f64::from(strip.pixel[axis] + at[axis]) + half_pixel - primitive.origin[axis]);
    // Distances of the pixel's centre along the line and across it.
    let [along, across] = primitive.weights.map(|g| (g[0] * p[0] + g[1] * p[1]) as f32);
    let [half_width, length] = primitive.line;
    // Linear ramps at both sides and at both ends; thin lines never exceed their width.
    let beside = (half_width + 0.5 - across.abs()).clamp(0.0, 1.0).min(2.0 * half_width);
    let from_end = (along * length).min((1.0 - along) * length);
    beside * (from_end + 0.5).clamp(0.0, 1.0)
}

//! Runs the fragment shader on the quads of a strip.

use glam::Vec2;

use super::{Masks, Strip, TileDrawer};
use crate::{
    fragment::Quad,
    output::{DepthOutput, FragmentOutput},
    primitive::Primitive,
    render_target::Tile,
    samples::{Pattern, SUBPIXELS},
    stages::FragmentShader,
    varyings::{Floats, Mode, Varyings, any_centroid},
};

/// The lanes of a strip that quad `q` has.
#[inline(always)]
pub(super) const fn quad_lanes(q: usize) -> [usize; 4] {
    [2 * q, 2 * q + 1, 8 + 2 * q, 9 + 2 * q]
}

/// Four values, written out: compilers do not always inline `map` and `from_fn`, and what they leave in memory is slow.
#[inline(always)]
fn four<T>(value: impl Fn(usize) -> T) -> [T; 4] {
    [value(0), value(1), value(2), value(3)]
}

/// Weights of the second and third corner at four points: linear in the window, and with perspective.
struct Weights {
    linear: [[f32; 4]; 2],
    perspective: [[f32; 4]; 2],
    inv_w: [f32; 4],
}

impl Weights {
    /// At points given relative to a pixel.
    #[inline(always)]
    fn new(primitive: &Primitive, pixel: [i32; 2], points: [[f32; 2]; 4]) -> Self {
        let at = [0, 1].map(|axis| f64::from(pixel[axis]) - primitive.origin[axis]);
        // Barycentric weights at the points, as planes in the window; the start is found in `f64` so that far origins
        // lose nothing.
        let along = |[gx, gy]: [f64; 2]| {
            let start = (gx * at[0] + gy * at[1]) as f32;
            let (gx, gy) = (gx as f32, gy as f32);
            four(|i| start + (gx * points[i][0] + gy * points[i][1]))
        };
        let linear = [along(primitive.weights[0]), along(primitive.weights[1])];
        let [first, second, third] = primitive.inv_w;
        // Equal w at all corners: the map to the window is affine, and no division is needed.
        if second == 0.0 && third == 0.0 {
            return Self { linear, perspective: linear, inv_w: [first * primitive.inv_w_scale; 4] };
        }
        let mut perspective = linear;
        let mut inv_w = [0.0; 4];
        for i in 0..4 {
            // 1/w is linear in the window; weights with perspective are b_i·(1/w_i)/(1/w) (Blinn, "Hyperbolic
            // Interpolation", 1992).
            let relative = first + (linear[0][i] * second + linear[1][i] * third);
            // Helpers may lie where the plane of the primitive meets the eye's.
            let w = 1.0 / if relative.abs() > 1e-30 { relative } else { 1e-30 };
            inv_w[i] = relative * primitive.inv_w_scale;
            perspective[0][i] *= (first + second) * w;
            perspective[1][i] *= (first + third) * w;
        }
        Self { linear, perspective, inv_w }
    }
}

impl<F: FragmentShader> TileDrawer<'_, F> {
    /// Shades the quads with samples in `masks`, makes the tests that are left and writes. `sample`: the one that is
    /// shaded, if the shader runs at each.
    pub(super) fn shade(
        &mut self,
        tile: &mut Tile,
        primitive: &Primitive,
        attributes: &[f32],
        strip: Strip,
        mut masks: Masks,
        sample: Option<usize>,
    ) {
        let count = self.pattern.count;
        let union = masks[..count].iter().fold(0, |all, m| all | m);
        let mut outputs: [Option<[F::Output; 4]>; 4] = [None; 4];
        for (q, output) in outputs.iter_mut().enumerate() {
            // Shade whole quads, with helpers where pixels are uncovered, so that differences between neighbours are
            // derivatives.
            let lanes = quad_lanes(q);
            if lanes.iter().any(|lane| union >> lane & 1 != 0) {
                let quad = self.quad(tile.layer, primitive, attributes, (strip, q), &masks, sample);
                self.counters.fragments += u64::from(quad.coverage.iter().filter(|&&c| c != 0).count() as u32);
                let shaded = self.shader.shade_quad(&quad);
                if F::Output::DISCARDS || F::Output::MASK || self.state.multisample.alpha_to_coverage {
                    for (lane, output) in lanes.into_iter().zip(&shaded) {
                        self.restrict(&mut masks, lane, output);
                    }
                }
                *output = Some(shaded);
            }
        }
        // Late tests, for shaders that discard or set depth.
        if !self.plan.early {
            for (s, mask) in masks[..count].iter_mut().enumerate() {
                let depths = self.plan.shader_depth.then(|| self.shader_depths(primitive, strip, s, &outputs));
                *mask = self.test(tile, primitive, strip, s, *mask, depths.as_ref());
            }
        }
        self.count_samples(&masks);
        self.write(tile, primitive, strip, &masks, &outputs);
    }

    /// Takes samples from a pixel that its output does not write.
    fn restrict(&self, masks: &mut Masks, lane: usize, output: &F::Output) {
        let mut keep = if output.discarded() { 0 } else { output.mask() };
        if self.state.multisample.alpha_to_coverage {
            // As many samples as alpha says, rounded to nearest; a fixed order is enough.
            let alpha = output.color(0).w.clamp(0.0, 1.0);
            let samples = (alpha * self.pattern.count as f32 + 0.5) as u32;
            keep &= (1u32 << samples) - 1;
        }
        for (sample, mask) in masks.iter_mut().enumerate() {
            if keep >> sample & 1 == 0 {
                *mask &= !(1 << lane);
            }
        }
    }

    /// The depths that the shader gave.
    fn shader_depths(
        &self,
        primitive: &Primitive,
        strip: Strip,
        sample: usize,
        outputs: &[Option<[F::Output; 4]>; 4],
    ) -> [f32; 16] {
        let mut depths = primitive.depths(strip.pixel, self.pattern.offsets[sample]);
        let [near, far] = primitive.depth_range;
        for (q, output) in outputs.iter().enumerate() {
            let Some(output) = output else { continue };
            for (lane, output) in quad_lanes(q).into_iter().zip(output) {
                let given = output.depth();
                let given = if given.is_nan() { far } else { given.clamp(near, far) };
                // Conservative depth: a declared direction limits what the shader may do to the interpolated depth.
                depths[lane] = match F::Output::DEPTH {
                    DepthOutput::Greater => given.max(depths[lane]),
                    DepthOutput::Less => given.min(depths[lane]),
                    _ => given,
                };
            }
        }
        depths
    }

    /// The quad of this number in a strip, interpolated.
    #[inline]
    fn quad(
        &self,
        layer: u32,
        primitive: &Primitive,
        attributes: &[f32],
        (strip, q): (Strip, usize),
        masks: &Masks,
        sample: Option<usize>,
    ) -> Quad<F::Varyings> {
        type V<F> = <F as FragmentShader>::Varyings;
        let modes = V::<F>::MODES;
        let lanes = quad_lanes(q);
        let count = self.pattern.count;
        let bit = |s: usize, lane: usize| u32::from(masks[s] >> lane & 1) << s;
        let coverage = match count {
            1 => four(|i| bit(0, lanes[i])),
            _ => four(|i| (0..count).fold(0, |c, s| c | bit(s, lanes[i]))),
        };
        let units = SUBPIXELS as f32;
        let offset_of = |s: usize| self.pattern.offsets[s].map(|x| x as f32 / units);
        let centre = sample.map_or([0.5; 2], offset_of);
        let pixel = [strip.pixel[0] + 2 * q as i32, strip.pixel[1]];
        let point = |lane: usize, [x, y]: [f32; 2]| [(lane & 1) as f32 + x, (lane >> 1) as f32 + y];
        let weights = Weights::new(primitive, pixel, four(|lane| point(lane, centre)));
        // Extrapolation at uncovered centres is avoided by moving the point to the centroid of the covered samples.
        let centroids = if any_centroid(modes) && count > 1 && sample.is_none() {
            let points = std::array::from_fn(|lane| point(lane, self.centroid(coverage[lane])));
            Some(Weights::new(primitive, pixel, points))
        } else {
            None
        };
        let at_centroid = centroids.as_ref().unwrap_or(&weights);
        let n = modes.len();
        let (first, rest) = attributes.split_at(n);
        let (second, third) = rest.split_at(n);
        let third = &third[..n];
        let mut floats = <V<F> as Varyings>::Floats::ZERO_QUAD;
        for (i, float) in floats.as_mut().iter_mut().enumerate() {
            let [u, v] = match modes[i] {
                Mode::Flat => {
                    *float = [first[i]; 4];
                    continue;
                }
                Mode::Linear | Mode::LinearSample => &weights.linear,
                Mode::LinearCentroid => &at_centroid.linear,
                Mode::Centroid => &at_centroid.perspective,
                Mode::Perspective | Mode::Sample | Mode::Clip | Mode::Cull => &weights.perspective,
            };
            // Attribute plane: a₀ + u·(a₁ − a₀) + v·(a₂ − a₀).
            for lane in 0..4 {
                float[lane] = first[i] + (u[lane] * second[i] + v[lane] * third[i]);
            }
        }
        let floats = floats.as_ref();
        let sample_offset = sample.map_or(Pattern::centre(), |s| self.pattern.offsets[s]);
        let depths = primitive.depths(strip.pixel, sample_offset);
        Quad {
            varyings: four(|lane| V::<F>::from_floats(|i| floats[i][lane])),
            origin: pixel.map(|x| x as u32),
            offset: Vec2::from_array(centre),
            depth: four(|i| depths[lanes[i]]),
            inv_w: weights.inv_w,
            coverage,
            front_facing: primitive.front,
            primitive_id: primitive.id,
            layer,
            viewport: u32::from(primitive.viewport),
            sample: sample.unwrap_or(0) as u32,
            sample_count: count as u32,
            coordinates: four(|lane| Vec2::new(weights.linear[0][lane], weights.linear[1][lane])),
        }
    }

    /// The centroid of these samples of a pixel; its centre if all or none are meant.
    fn centroid(&self, coverage: u32) -> [f32; 2] {
        let count = self.pattern.count;
        if coverage == 0 || coverage.count_ones() as usize == count {
            return [0.5; 2];
        }
        // Average the offsets of the covered samples.
        let mut sum = [0; 2];
        for sample in (0..count).filter(|s| coverage >> s & 1 != 0) {
            sum = [0, 1].map(|axis| sum[axis] + self.pattern.offsets[sample][axis]);
        }
        sum.map(|x| x as f32 / (coverage.count_ones() * SUBPIXELS as u32) as f32)
    }
}

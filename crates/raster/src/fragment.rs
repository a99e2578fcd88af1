//! Input of a fragment shader: a pixel of a 2×2 quad, with its neighbours for derivatives.

use std::ops::{Add, Sub};

use glam::{Vec2, Vec4};

use crate::samples::sample_position;

/// Four neighbouring pixels that are shaded together: 0 top left, 1 top right, 2 bottom left, 3 bottom right.
#[derive(Clone, Copy, Debug)]
pub struct Quad<V> {
    /// The varyings. Where a pixel is not covered they are those of the primitive's plane.
    pub varyings: [V; 4],
    /// Column and row of the top left pixel; both are even.
    pub origin: [u32; 2],
    /// The place within the pixel that is shaded: its centre, or a sample.
    pub offset: Vec2,
    /// Depths in the window.
    pub depth: [f32; 4],
    /// 1/w, interpolated.
    pub inv_w: [f32; 4],
    /// The covered samples of each pixel that passed the tests so far; those without any are helpers.
    pub coverage: [u32; 4],
    /// True if the primitive shows its front, which points and lines do.
    pub front_facing: bool,
    /// Number of the primitive in its draw, or what the geometry shader set.
    pub primitive_id: u32,
    /// The layer of the framebuffer.
    pub layer: u32,
    /// The viewport.
    pub viewport: u32,
    /// The sample that is shaded, where the shader runs at each sample; else 0.
    pub sample: u32,
    /// Samples in each pixel.
    pub sample_count: u32,
    /// Positions of the fragments within a point, from (0, 0) at its top left to (1, 1); barycentric weights of the
    /// second and third corner in triangles, linear in the window.
    pub coordinates: [Vec2; 4],
}

/// One pixel of a [`Quad`].
#[derive(Clone, Copy, Debug)]
pub struct Fragment<'a, V> {
    /// The whole quad.
    pub quad: &'a Quad<V>,
    /// Which of the four.
    pub lane: usize,
}

impl<'a, V> Fragment<'a, V> {
    #[inline(always)]
    pub(crate) fn new(quad: &'a Quad<V>, lane: usize) -> Self {
        Self { quad, lane }
    }

    /// Its varyings.
    #[inline(always)]
    pub fn varyings(&self) -> &'a V {
        &self.quad.varyings[self.lane]
    }

    /// Column and row of the pixel, from the top left.
    #[inline(always)]
    pub fn pixel(&self) -> [u32; 2] {
        [self.quad.origin[0] + (self.lane & 1) as u32, self.quad.origin[1] + (self.lane >> 1) as u32]
    }

    /// Position in the window (x right, y down; the first pixel's centre is (½, ½)), depth, 1/w. GLSL: `gl_FragCoord`.
    #[inline(always)]
    pub fn position(&self) -> Vec4 {
        let [x, y] = self.pixel();
        Vec4::new(
            x as f32 + self.quad.offset.x,
            y as f32 + self.quad.offset.y,
            self.quad.depth[self.lane],
            self.quad.inv_w[self.lane],
        )
    }

    /// True if the primitive shows its front.
    #[inline(always)]
    pub fn front_facing(&self) -> bool {
        self.quad.front_facing
    }

    /// Number of the primitive.
    #[inline(always)]
    pub fn primitive_id(&self) -> u32 {
        self.quad.primitive_id
    }

    /// True for a helper invocation, which runs only for the derivatives of its neighbours.
    #[inline(always)]
    pub fn is_helper(&self) -> bool {
        self.coverage() == 0
    }

    /// The covered samples, one bit each. GLSL: `gl_SampleMaskIn`.
    #[inline(always)]
    pub fn coverage(&self) -> u32 {
        self.quad.coverage[self.lane]
    }

    /// Position of the fragment within its point, y down.
    #[inline(always)]
    pub fn point_coord(&self) -> Vec2 {
        self.quad.coordinates[self.lane]
    }

    /// The place of the shaded sample in its pixel.
    #[inline(always)]
    pub fn sample_position(&self) -> Vec2 {
        Vec2::from_array(sample_position(self.quad.sample_count, self.quad.sample))
    }

    /// Difference of `f` of the varyings from this pixel's column to the other column of the quad, in this row. GLSL:
    /// `dFdxFine`.
    #[inline(always)]
    pub fn dx<T: Sub<Output = T>>(&self, f: impl Fn(&V) -> T) -> T {
        let row = self.lane & 2;
        f(&self.quad.varyings[row + 1]) - f(&self.quad.varyings[row])
    }

    /// Difference of `f` of the varyings from the upper row of the quad to the lower, in this column. GLSL: `dFdyFine`,
    /// with y down.
    #[inline(always)]
    pub fn dy<T: Sub<Output = T>>(&self, f: impl Fn(&V) -> T) -> T {
        let column = self.lane & 1;
        f(&self.quad.varyings[column + 2]) - f(&self.quad.varyings[column])
    }

    /// As [`dx`](Self::dx), the upper row's for all four pixels. GLSL: `dFdxCoarse`.
    #[inline(always)]
    pub fn dx_coarse<T: Sub<Output = T>>(&self, f: impl Fn(&V) -> T) -> T {
        f(&self.quad.varyings[1]) - f(&self.quad.varyings[0])
    }

    /// As [`dy`](Self::dy), the left column's for all four pixels. GLSL: `dFdyCoarse`.
    #[inline(always)]
    pub fn dy_coarse<T: Sub<Output = T>>(&self, f: impl Fn(&V) -> T) -> T {
        f(&self.quad.varyings[2]) - f(&self.quad.varyings[0])
    }

    /// |∂/∂x| + |∂/∂y| of a number. GLSL: `fwidth`.
    #[inline(always)]
    pub fn width(&self, f: impl Fn(&V) -> f32) -> f32 {
        self.dx(&f).abs().add(self.dy(&f).abs())
    }
}

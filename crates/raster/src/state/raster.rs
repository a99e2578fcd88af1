//! From primitives to fragments.

use super::{Compare, MAX_SIZE};
use crate::{
    error::{Result, refuse},
    samples::SAMPLE_COUNTS,
};

/// Which side is the front: the order of corners as seen on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrontFace {
    /// Corners run counter-clockwise.
    CounterClockwise,
    /// Corners run clockwise.
    Clockwise,
}

/// Which triangles are dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "names say what they are")]
pub enum Cull {
    None,
    Front,
    Back,
    Both,
}

/// Part of a triangle that is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolygonMode {
    /// Its inside.
    Fill,
    /// Its three edges.
    Line,
    /// Its three corners.
    Point,
}

/// Rasterisation rule of lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineMode {
    /// The diamond-exit rule (Bresenham's pixels), widened along the minor axis. With several samples, a rectangle.
    Bresenham,
    /// A rectangle around the segment.
    Rectangle,
    /// A rectangle whose alpha is multiplied with how much of the pixel it covers.
    Smooth,
}

/// Which pixels belong to a triangle besides those whose samples it covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conservative {
    /// No others.
    Off,
    /// All pixels that it touches.
    Overestimate,
    /// Only pixels that it covers wholly.
    Underestimate,
}

/// Depth bias of triangles: constant × smallest step + slope × steepest slope, clamped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthBias {
    /// In smallest resolvable differences of the depth format (2⁻²⁴ of the largest depth's binade for floats).
    pub constant: f32,
    /// Times max(|∂z/∂x|, |∂z/∂y|).
    pub slope: f32,
    /// Limit of the sum: at most it if positive, at least it if negative, none at 0.
    pub clamp: f32,
}

/// Range of depths in clip space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthRange {
    /// 0 ≤ z ≤ w is visible (wgpu, Vulkan, Direct3D).
    ZeroToOne,
    /// −w ≤ z ≤ w is visible (OpenGL).
    MinusOneToOne,
}

/// From primitives to fragments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterState {
    /// Which side is the front.
    pub front_face: FrontFace,
    /// Which triangles are dropped.
    pub cull: Cull,
    /// Part of triangles that is drawn.
    pub polygon_mode: PolygonMode,
    /// Rasterisation rule of lines.
    pub line_mode: LineMode,
    /// Width of lines in pixels.
    pub line_width: f32,
    /// Depth bias of triangles.
    pub depth_bias: DepthBias,
    /// Cuts at the near and far plane; without, depths beyond are clamped to the viewport's.
    pub depth_clip: bool,
    /// Range of depths in clip space.
    pub depth_range: DepthRange,
    /// Conservative rasterisation of triangles.
    pub conservative: Conservative,
    /// Nothing reaches the fragment shader; for [`capture`](crate::Pipeline::capture) and counters.
    pub discard: bool,
}

impl Default for RasterState {
    fn default() -> Self {
        Self {
            front_face: FrontFace::CounterClockwise,
            cull: Cull::None,
            polygon_mode: PolygonMode::Fill,
            line_mode: LineMode::Bresenham,
            line_width: 1.0,
            depth_bias: DepthBias::default(),
            depth_clip: true,
            depth_range: DepthRange::ZeroToOne,
            conservative: Conservative::Off,
            discard: false,
        }
    }
}

impl RasterState {
    pub(super) fn check(&self) -> Result<()> {
        const CALL: &str = "Pipeline::new";
        if !(self.line_width > 0.0 && self.line_width <= 2048.0) {
            return refuse(CALL, format!("the line width {} must be in (0, 2048] pixels", self.line_width));
        }
        let bias = self.depth_bias;
        if ![bias.constant, bias.slope, bias.clamp].iter().all(|x| x.is_finite()) {
            return refuse(CALL, format!("the depth bias {bias:?} must be finite"));
        }
        Ok(())
    }
}

/// Samples of a pixel and what decides about them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Multisample {
    /// 1, 2, 4, 8 or 16: those of the framebuffer.
    pub count: u32,
    /// The samples that may be written, one bit each.
    pub mask: u32,
    /// The alpha of target 0 chooses how many of the covered samples are written.
    pub alpha_to_coverage: bool,
    /// Alpha is 1 after that.
    pub alpha_to_one: bool,
}

impl Default for Multisample {
    fn default() -> Self {
        Self { count: 1, mask: !0, alpha_to_coverage: false, alpha_to_one: false }
    }
}

impl Multisample {
    /// So many samples.
    pub fn samples(count: u32) -> Self {
        Self { count, ..Self::default() }
    }

    pub(crate) fn check(count: u32, call: &'static str) -> Result<()> {
        if SAMPLE_COUNTS.contains(&count) {
            return Ok(());
        }
        refuse(call, format!("{count} samples; there are 1, 2, 4, 8 and 16"))
    }
}

/// Mapping of clip space to the window: x right and y down from the top left, depth from `near` to `far`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Left edge in pixels.
    pub x: f32,
    /// Top edge in pixels.
    pub y: f32,
    /// Width in pixels.
    pub width: f32,
    /// Height in pixels.
    pub height: f32,
    /// Depth of the near plane, in [0, 1].
    pub near: f32,
    /// Depth of the far plane, in [0, 1]; may be less than `near`.
    pub far: f32,
}

impl Viewport {
    /// A viewport of this size at the top left, with depths from 0 to 1.
    pub const fn new(width: f32, height: f32) -> Self {
        Self { x: 0.0, y: 0.0, width, height, near: 0.0, far: 1.0 }
    }

    pub(super) fn check(&self) -> Result<()> {
        const CALL: &str = "Pipeline::new";
        let limit = MAX_SIZE as f32;
        let inside = |start: f32, size: f32| start >= -limit && size > 0.0 && start + size <= limit;
        if !(inside(self.x, self.width) && inside(self.y, self.height)) {
            return refuse(CALL, format!("the viewport {self:?} must have a size and lie within ±{MAX_SIZE} pixels"));
        }
        if !((0.0..=1.0).contains(&self.near) && (0.0..=1.0).contains(&self.far)) {
            return refuse(
                CALL,
                format!("the depths {} and {} of the viewport must be in [0, 1]", self.near, self.far),
            );
        }
        Ok(())
    }
}

/// A rectangle of pixels; what lies outside the framebuffer does not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Depths that make a test pass at first: what to clear to.
impl Compare {
    /// 1 where the smaller wins, 0 where the larger does.
    pub fn far(self) -> f32 {
        if matches!(self, Self::Greater | Self::GreaterEqual) { 0.0 } else { 1.0 }
    }
}

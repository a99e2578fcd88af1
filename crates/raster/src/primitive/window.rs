//! From clip space to the window.

use glam::Vec4;

use crate::{
    render_target::{DepthFormat, Extent},
    samples::{Pattern, SUBPIXELS},
    state::{DepthRange, MAX_SIZE, RasterState, Rect, State, Viewport},
};

/// The largest window coordinate in pixels: beyond, primitives are clipped, so that edges are exact in 64 bits and fit
/// 32 within a block.
const LARGEST: f64 = 32000.0;
/// No corner is beyond this.
const BORDER: f64 = 32700.0;

/// A viewport ready for use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Port {
    centre: [f64; 2],
    half: [f64; 2],
    depth_scale: f64,
    depth_offset: f64,
    pub depth_range: [f32; 2],
    /// Guard band: distance from the centre of the view, in half viewports, up to which primitives are not clipped.
    pub guard: [f64; 2],
    /// Pixels inside viewport, scissor and framebuffer.
    pub min: [i32; 2],
    pub max: [i32; 2],
    /// Pixels inside scissor and framebuffer.
    pub open_min: [i32; 2],
    pub open_max: [i32; 2],
}

/// A corner in the window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// In sub-pixel units.
    pub at: [i32; 2],
    pub depth: f64,
    pub inv_w: f64,
}

/// All that setup needs to know of state and framebuffer.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    pub ports: Vec<Port>,
    pub pattern: Pattern,
    pub extent: Extent,
    pub raster: RasterState,
    pub depth_format: DepthFormat,
}

impl Window {
    pub fn new(state: &State, extent: Extent, depth_format: Option<DepthFormat>) -> Self {
        let whole = [Viewport::new(extent.width as f32, extent.height as f32)];
        let viewports = if state.viewports.is_empty() { &whole[..] } else { &state.viewports };
        let ports = viewports.iter().enumerate().map(|(i, viewport)| {
            let scissor = if state.scissors.len() == 1 { state.scissors.first() } else { state.scissors.get(i) };
            Port::new(viewport, scissor, extent, state.raster.depth_range)
        });
        Self {
            ports: ports.collect(),
            pattern: Pattern::new(extent.samples),
            extent,
            raster: state.raster,
            depth_format: depth_format.unwrap_or(DepthFormat::Float32),
        }
    }
}

impl Port {
    fn new(viewport: &Viewport, scissor: Option<&Rect>, extent: Extent, range: DepthRange) -> Self {
        let half = [f64::from(viewport.width) / 2.0, f64::from(viewport.height) / 2.0];
        let centre = [f64::from(viewport.x) + half[0], f64::from(viewport.y) + half[1]];
        let (near, far) = (f64::from(viewport.near), f64::from(viewport.far));
        // Viewport transform of depth: z_w = z·scale + offset.
        let (depth_scale, depth_offset) = match range {
            DepthRange::ZeroToOne => (far - near, near),
            DepthRange::MinusOneToOne => ((far - near) / 2.0, (far + near) / 2.0),
        };
        let size = [extent.width.min(MAX_SIZE) as i32, extent.height.min(MAX_SIZE) as i32];
        let (mut open_min, mut open_max) = ([0; 2], size);
        if let Some(rect) = scissor {
            let (start, length) = ([rect.x, rect.y], [rect.width, rect.height]);
            for axis in 0..2 {
                open_min[axis] = start[axis].min(MAX_SIZE) as i32;
                open_max[axis] = (start[axis].saturating_add(length[axis]).min(MAX_SIZE) as i32).min(size[axis]);
            }
        }
        // Viewport, scissor and framebuffer limit the pixels that may be drawn.
        let (mut min, mut max) = (open_min, open_max);
        let start = [viewport.x, viewport.y];
        let length = [viewport.width, viewport.height];
        for axis in 0..2 {
            // Pixels whose centres are in the viewport.
            min[axis] = min[axis].max((start[axis] - 0.5).ceil() as i32);
            max[axis] = max[axis].min((start[axis] + length[axis] - 0.5).ceil() as i32);
        }
        Self {
            centre,
            half,
            depth_scale,
            depth_offset,
            depth_range: [viewport.near.min(viewport.far), viewport.near.max(viewport.far)],
            // Guard band in units of half viewports: up to where fixed-point coordinates stay exact.
            guard: [0, 1].map(|axis| (LARGEST - centre[axis].abs()) / half[axis]),
            min,
            max,
            open_min,
            open_max,
        }
    }

    /// The corner at a position inside the guard band with w > 0.
    #[inline]
    pub fn project(&self, position: Vec4) -> Corner {
        // Perspective division, viewport transform, and rounding to sub-pixels.
        let inv_w = 1.0 / f64::from(position.w);
        let x = self.centre[0] + f64::from(position.x) * inv_w * self.half[0];
        // Clip space has y up, the window y down.
        let y = self.centre[1] - f64::from(position.y) * inv_w * self.half[1];
        // Corners that a cut at the guard band left outside it, by the rounding of huge coordinates, are moved onto its
        // border.
        // Added to 3·2⁵¹ a number is rounded to a whole one, ties to even, which the low bits of the sum are.
        let units = |x: f64| {
            let rounded = x.clamp(-BORDER, BORDER) * f64::from(SUBPIXELS) + 6_755_399_441_055_744.0;
            (rounded.to_bits() as u32).cast_signed()
        };
        Corner {
            at: [units(x), units(y)],
            depth: self.depth_offset + f64::from(position.z) * inv_w * self.depth_scale,
            inv_w,
        }
    }
}

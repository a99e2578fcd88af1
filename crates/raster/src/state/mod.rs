//! Fixed state of a pipeline: topology, rasterisation, tests, blending.

mod blend;
mod depth_stencil;
mod raster;
mod topology;

pub use blend::{BlendEquation, BlendFactor, BlendState, ColorState, LogicOp};
pub use depth_stencil::{Compare, DepthState, StencilFace, StencilOp, StencilState};
pub use raster::{
    Conservative, Cull, DepthBias, DepthRange, FrontFace, LineMode, Multisample, PolygonMode, RasterState, Rect,
    Viewport,
};
pub(crate) use topology::Shape;
pub use topology::{Provoking, Topology};

use crate::error::{Result, refuse};

/// The most colour targets.
pub const MAX_TARGETS: usize = 8;
/// The most viewports.
pub const MAX_VIEWPORTS: usize = 16;
/// The largest coordinate of a viewport, in pixels, and the largest side of a framebuffer.
pub const MAX_SIZE: u32 = 16384;
/// The most vertices of a patch.
pub const MAX_PATCH_VERTICES: u32 = 32;

/// The state of a pipeline. Start from [`State::default`], and change fields.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Topology of the vertices.
    pub topology: Topology,
    /// Which vertex gives flat varyings, layer and viewport.
    pub provoking: Provoking,
    /// The index that ends a strip, fan, loop or list and starts another.
    pub restart: Option<u32>,
    /// From primitives to fragments.
    pub raster: RasterState,
    /// The depth test; none without.
    pub depth: Option<DepthState>,
    /// The stencil test; none without.
    pub stencil: Option<StencilState>,
    /// Blending and write mask of each colour target; targets beyond the list use the default.
    pub color: Vec<ColorState>,
    /// The constant of blend factors.
    pub blend_constant: [f32; 4],
    /// Bitwise operation on colours instead of blending. Float formats are written as if it were [`LogicOp::Copy`].
    pub logic_op: Option<LogicOp>,
    /// Samples.
    pub multisample: Multisample,
    /// Viewports. Without any: one that fills the framebuffer.
    pub viewports: Vec<Viewport>,
    /// Scissor rectangle of each viewport. Without any: no limit.
    pub scissors: Vec<Rect>,
}

impl Default for State {
    fn default() -> Self {
        Self {
            topology: Topology::Triangles,
            provoking: Provoking::First,
            restart: None,
            raster: RasterState::default(),
            depth: None,
            stencil: None,
            color: Vec::new(),
            blend_constant: [0.0; 4],
            logic_op: None,
            multisample: Multisample::default(),
            viewports: Vec::new(),
            scissors: Vec::new(),
        }
    }
}

impl State {
    /// Checks the rules that do not depend on a framebuffer.
    pub(crate) fn check(&self) -> Result<()> {
        const CALL: &str = "Pipeline::new";
        self.topology.check()?;
        self.raster.check()?;
        if self.color.len() > MAX_TARGETS {
            return refuse(CALL, format!("{} colour states; at most {MAX_TARGETS}", self.color.len()));
        }
        if !self.blend_constant.iter().all(|x| x.is_finite()) {
            return refuse(CALL, format!("the blend constant {:?} must be finite", self.blend_constant));
        }
        if self.logic_op.is_some() && self.color.iter().any(|c| c.blend.is_some()) {
            return refuse(CALL, "a logic operation takes the place of blending: set one of the two");
        }
        if self.viewports.len() > MAX_VIEWPORTS {
            return refuse(CALL, format!("{} viewports; at most {MAX_VIEWPORTS}", self.viewports.len()));
        }
        for viewport in &self.viewports {
            viewport.check()?;
        }
        if self.scissors.len() > 1 && self.scissors.len() != self.viewports.len() {
            let (scissors, viewports) = (self.scissors.len(), self.viewports.len());
            return refuse(
                CALL,
                format!("{scissors} scissor rectangles for {viewports} viewports; one each, or one for all"),
            );
        }
        Ok(())
    }
}

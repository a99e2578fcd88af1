//! Outputs of fragment shaders.

use glam::{IVec4, UVec4, Vec4};

/// The class of values of a colour target; the shader's must be the target's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Floats: normalised and floating-point formats.
    Float,
    /// Unsigned integers.
    Uint,
    /// Signed integers.
    Sint,
}

/// Depth output of a shader, and its relation to the primitive's depth (GLSL: `depth_any`, `depth_greater`,
/// `depth_less`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthOutput {
    /// None is written.
    None,
    /// Anything.
    Any,
    /// At least that of the primitive; what is less is raised to it.
    Greater,
    /// At most that of the primitive; what is more is lowered to it.
    Less,
}

/// The output of a fragment shader. `()` writes no colour, [`Vec4`] one, an array several; [`Option`] may discard;
/// [`WithDepth`], [`WithMask`] and [`DualSource`] add to another output. [`UVec4`] and [`IVec4`] are for integer
/// targets.
pub trait FragmentOutput: Copy {
    /// Number of colours.
    const COLORS: usize;
    /// Their class.
    const CLASS: Class = Class::Float;
    /// True if it may be discarded.
    const DISCARDS: bool = false;
    /// Kind of its depth.
    const DEPTH: DepthOutput = DepthOutput::None;
    /// True if it has a sample mask.
    const MASK: bool = false;
    /// True if it has a second source colour.
    const DUAL: bool = false;
    /// True if nothing is to be written.
    #[inline(always)]
    fn discarded(&self) -> bool {
        false
    }
    /// The colour for a target, red first. Integers as bits.
    fn color(&self, target: usize) -> Vec4;
    /// The second source colour.
    #[inline(always)]
    fn second(&self) -> Vec4 {
        Vec4::ZERO
    }
    /// The depth.
    #[inline(always)]
    fn depth(&self) -> f32 {
        0.0
    }
    /// The samples that may be written, one bit each.
    #[inline(always)]
    fn mask(&self) -> u32 {
        !0
    }
}

impl FragmentOutput for () {
    const COLORS: usize = 0;
    #[inline(always)]
    fn color(&self, _: usize) -> Vec4 {
        Vec4::ZERO
    }
}

impl FragmentOutput for Vec4 {
    const COLORS: usize = 1;
    #[inline(always)]
    fn color(&self, _: usize) -> Vec4 {
        *self
    }
}

impl FragmentOutput for UVec4 {
    const COLORS: usize = 1;
    const CLASS: Class = Class::Uint;
    #[inline(always)]
    fn color(&self, _: usize) -> Vec4 {
        Vec4::from_array(self.to_array().map(f32::from_bits))
    }
}

impl FragmentOutput for IVec4 {
    const COLORS: usize = 1;
    const CLASS: Class = Class::Sint;
    #[inline(always)]
    fn color(&self, _: usize) -> Vec4 {
        Vec4::from_array(self.to_array().map(|x| f32::from_bits(x.cast_unsigned())))
    }
}

impl<const N: usize> FragmentOutput for [Vec4; N] {
    const COLORS: usize = N;
    #[inline(always)]
    fn color(&self, target: usize) -> Vec4 {
        self[target]
    }
}

/// `None` discards the fragment.
impl<O: FragmentOutput> FragmentOutput for Option<O> {
    const COLORS: usize = O::COLORS;
    const CLASS: Class = O::CLASS;
    const DISCARDS: bool = true;
    const DEPTH: DepthOutput = O::DEPTH;
    const MASK: bool = O::MASK;
    const DUAL: bool = O::DUAL;
    #[inline(always)]
    fn discarded(&self) -> bool {
        self.is_none_or(|output| output.discarded())
    }
    #[inline(always)]
    fn color(&self, target: usize) -> Vec4 {
        self.map_or(Vec4::ZERO, |output| output.color(target))
    }
    #[inline(always)]
    fn second(&self) -> Vec4 {
        self.map_or(Vec4::ZERO, |output| output.second())
    }
    #[inline(always)]
    fn depth(&self) -> f32 {
        self.map_or(0.0, |output| output.depth())
    }
    #[inline(always)]
    fn mask(&self) -> u32 {
        self.map_or(0, |output| output.mask())
    }
}

/// Any depth ([`DepthOutput::Any`]).
pub const DEPTH_ANY: u8 = 0;
/// [`DepthOutput::Greater`].
pub const DEPTH_GREATER: u8 = 1;
/// [`DepthOutput::Less`].
pub const DEPTH_LESS: u8 = 2;

/// Colours and a depth in [0, 1], of which `LAYOUT` ([`DEPTH_ANY`], [`DEPTH_GREATER`], [`DEPTH_LESS`]) says what is
/// known.
#[derive(Clone, Copy, Debug)]
pub struct WithDepth<O, const LAYOUT: u8 = DEPTH_ANY> {
    /// The rest.
    pub output: O,
    /// The depth in the window, after the depth range.
    pub depth: f32,
}

impl<O: FragmentOutput, const LAYOUT: u8> FragmentOutput for WithDepth<O, LAYOUT> {
    const COLORS: usize = O::COLORS;
    const CLASS: Class = O::CLASS;
    const DISCARDS: bool = O::DISCARDS;
    const DEPTH: DepthOutput = match LAYOUT {
        DEPTH_GREATER => DepthOutput::Greater,
        DEPTH_LESS => DepthOutput::Less,
        _ => DepthOutput::Any,
    };
    const MASK: bool = O::MASK;
    const DUAL: bool = O::DUAL;
    #[inline(always)]
    fn discarded(&self) -> bool {
        self.output.discarded()
    }
    #[inline(always)]
    fn color(&self, target: usize) -> Vec4 {
        self.output.color(target)
    }
    #[inline(always)]
    fn second(&self) -> Vec4 {
        self.output.second()
    }
    #[inline(always)]
    fn depth(&self) -> f32 {
        self.depth
    }
    #[inline(always)]
    fn mask(&self) -> u32 {
        self.output.mask()
    }
}

/// Colours and a mask of samples.
#[derive(Clone, Copy, Debug)]
pub struct WithMask<O> {
    /// The rest.
    pub output: O,
    /// The samples that may be written, one bit each.
    pub mask: u32,
}

impl<O: FragmentOutput> FragmentOutput for WithMask<O> {
    const COLORS: usize = O::COLORS;
    const CLASS: Class = O::CLASS;
    const DISCARDS: bool = O::DISCARDS;
    const DEPTH: DepthOutput = O::DEPTH;
    const MASK: bool = true;
    const DUAL: bool = O::DUAL;
    #[inline(always)]
    fn discarded(&self) -> bool {
        self.output.discarded()
    }
    #[inline(always)]
    fn color(&self, target: usize) -> Vec4 {
        self.output.color(target)
    }
    #[inline(always)]
    fn second(&self) -> Vec4 {
        self.output.second()
    }
    #[inline(always)]
    fn depth(&self) -> f32 {
        self.output.depth()
    }
    #[inline(always)]
    fn mask(&self) -> u32 {
        self.mask & self.output.mask()
    }
}

/// A colour and a second one that blend factors may use.
#[derive(Clone, Copy, Debug)]
pub struct DualSource {
    /// The colour.
    pub first: Vec4,
    /// The factor's colour.
    pub second: Vec4,
}

impl FragmentOutput for DualSource {
    const COLORS: usize = 1;
    const DUAL: bool = true;
    #[inline(always)]
    fn color(&self, _: usize) -> Vec4 {
        self.first
    }
    #[inline(always)]
    fn second(&self) -> Vec4 {
        self.second
    }
}

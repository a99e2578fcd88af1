//! Blending of a fragment's colour with the colour in the target.

use glam::Vec4;

/// Factor on a colour before the blend equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "names say what they are")]
pub enum BlendFactor {
    Zero,
    One,
    Source,
    OneMinusSource,
    SourceAlpha,
    OneMinusSourceAlpha,
    Target,
    OneMinusTarget,
    TargetAlpha,
    OneMinusTargetAlpha,
    Constant,
    OneMinusConstant,
    ConstantAlpha,
    OneMinusConstantAlpha,
    /// min(source alpha, 1 − target alpha); 1 for alpha.
    SourceAlphaSaturate,
    /// The second colour of a [`DualSource`](crate::output::DualSource).
    Second,
    OneMinusSecond,
    SecondAlpha,
    OneMinusSecondAlpha,
}

impl BlendFactor {
    pub(crate) fn is_dual(self) -> bool {
        matches!(self, Self::Second | Self::OneMinusSecond | Self::SecondAlpha | Self::OneMinusSecondAlpha)
    }

    #[inline]
    fn value(self, source: Vec4, second: Vec4, target: Vec4, constant: Vec4) -> Vec4 {
        match self {
            Self::Zero => Vec4::ZERO,
            Self::One => Vec4::ONE,
            Self::Source => source,
            Self::OneMinusSource => Vec4::ONE - source,
            Self::SourceAlpha => Vec4::splat(source.w),
            Self::OneMinusSourceAlpha => Vec4::splat(1.0 - source.w),
            Self::Target => target,
            Self::OneMinusTarget => Vec4::ONE - target,
            Self::TargetAlpha => Vec4::splat(target.w),
            Self::OneMinusTargetAlpha => Vec4::splat(1.0 - target.w),
            Self::Constant => constant,
            Self::OneMinusConstant => Vec4::ONE - constant,
            Self::ConstantAlpha => Vec4::splat(constant.w),
            Self::OneMinusConstantAlpha => Vec4::splat(1.0 - constant.w),
            Self::SourceAlphaSaturate => Vec4::splat(source.w.min(1.0 - target.w)).with_w(1.0),
            Self::Second => second,
            Self::OneMinusSecond => Vec4::ONE - second,
            Self::SecondAlpha => Vec4::splat(second.w),
            Self::OneMinusSecondAlpha => Vec4::splat(1.0 - second.w),
        }
    }
}

/// Equation that joins the weighted colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlendEquation {
    /// s·F + t·G.
    Add,
    /// s·F − t·G.
    Subtract,
    /// t·G − s·F.
    ReverseSubtract,
    /// min(s, t), without factors.
    Min,
    /// max(s, t), without factors.
    Max,
}

impl BlendEquation {
    #[inline]
    fn join(self, source: Vec4, target: Vec4, source_factor: Vec4, target_factor: Vec4) -> Vec4 {
        match self {
            Self::Add => source * source_factor + target * target_factor,
            Self::Subtract => source * source_factor - target * target_factor,
            Self::ReverseSubtract => target * target_factor - source * source_factor,
            Self::Min => source.min(target),
            Self::Max => source.max(target),
        }
    }
}

/// Blending of one target: factors and equations, alpha apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlendState {
    /// Equation for red, green and blue.
    pub color: BlendEquation,
    /// Factors of source and target for red, green and blue.
    pub color_factors: [BlendFactor; 2],
    /// Equation for alpha.
    pub alpha: BlendEquation,
    /// Factors of source and target for alpha.
    pub alpha_factors: [BlendFactor; 2],
}

impl BlendState {
    /// One equation and pair of factors for both colour and alpha.
    pub const fn new(equation: BlendEquation, source: BlendFactor, target: BlendFactor) -> Self {
        Self { color: equation, color_factors: [source, target], alpha: equation, alpha_factors: [source, target] }
    }

    /// The source, opaque by its alpha, over the target; colours are not multiplied with alpha.
    pub const OVER: Self = Self {
        color: BlendEquation::Add,
        color_factors: [BlendFactor::SourceAlpha, BlendFactor::OneMinusSourceAlpha],
        alpha: BlendEquation::Add,
        alpha_factors: [BlendFactor::One, BlendFactor::OneMinusSourceAlpha],
    };
    /// The source over the target, where colours are multiplied with alpha already.
    pub const PREMULTIPLIED_OVER: Self =
        Self::new(BlendEquation::Add, BlendFactor::One, BlendFactor::OneMinusSourceAlpha);
    /// The sum.
    pub const ADD: Self = Self::new(BlendEquation::Add, BlendFactor::One, BlendFactor::One);

    pub(crate) fn is_dual(&self) -> bool {
        self.color_factors.iter().chain(&self.alpha_factors).any(|f| f.is_dual())
    }

    /// Result of blending `source` with `target`.
    #[inline]
    pub fn blend(&self, source: Vec4, second: Vec4, target: Vec4, constant: Vec4) -> Vec4 {
        let factors = |factors: [BlendFactor; 2]| factors.map(|f| f.value(source, second, target, constant));
        let [source_color, target_color] = factors(self.color_factors);
        let color = self.color.join(source, target, source_color, target_color);
        if self.alpha == self.color && self.alpha_factors == self.color_factors {
            return color;
        }
        let [source_alpha, target_alpha] = factors(self.alpha_factors);
        color.with_w(self.alpha.join(source, target, source_alpha, target_alpha).w)
    }
}

/// Blending and write mask of one colour target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColorState {
    /// Blending; without it the source takes the place of the target.
    pub blend: Option<BlendState>,
    /// Which of red, green, blue and alpha are written.
    pub write: [bool; 4],
}

impl Default for ColorState {
    fn default() -> Self {
        Self { blend: None, write: [true; 4] }
    }
}

impl ColorState {
    /// Blended so.
    pub const fn blended(blend: BlendState) -> Self {
        Self { blend: Some(blend), write: [true; 4] }
    }
}

/// A bitwise operation on the stored bits of source s and target t.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "names say what they are")]
pub enum LogicOp {
    Clear,
    And,
    /// s ∧ ¬t
    AndReverse,
    Copy,
    /// ¬s ∧ t
    AndInverted,
    NoOp,
    Xor,
    Or,
    Nor,
    Equivalent,
    Invert,
    /// s ∨ ¬t
    OrReverse,
    CopyInverted,
    /// ¬s ∨ t
    OrInverted,
    Nand,
    Set,
}

impl LogicOp {
    /// The operation on bits.
    #[inline]
    pub fn apply(self, s: u8, t: u8) -> u8 {
        match self {
            Self::Clear => 0,
            Self::And => s & t,
            Self::AndReverse => s & !t,
            Self::Copy => s,
            Self::AndInverted => !s & t,
            Self::NoOp => t,
            Self::Xor => s ^ t,
            Self::Or => s | t,
            Self::Nor => !(s | t),
            Self::Equivalent => !(s ^ t),
            Self::Invert => !t,
            Self::OrReverse => s | !t,
            Self::CopyInverted => !s,
            Self::OrInverted => !s | t,
            Self::Nand => !(s & t),
            Self::Set => !0,
        }
    }
}

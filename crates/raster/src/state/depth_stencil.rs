//! Depth and stencil tests.

/// A comparison of a new value with the one that is there: `new < old` for [`Compare::Less`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "names say what they are")]
pub enum Compare {
    Never,
    Less,
    Equal,
    LessEqual,
    Greater,
    NotEqual,
    GreaterEqual,
    Always,
}

impl Compare {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Never,
        Self::Less,
        Self::Equal,
        Self::LessEqual,
        Self::Greater,
        Self::NotEqual,
        Self::GreaterEqual,
        Self::Always,
    ];

    /// True if `new` passes against `old`.
    #[inline(always)]
    pub fn passes<T: PartialOrd>(self, new: T, old: T) -> bool {
        match self {
            Self::Never => false,
            Self::Less => new < old,
            Self::Equal => new == old,
            Self::LessEqual => new <= old,
            Self::Greater => new > old,
            Self::NotEqual => new != old,
            Self::GreaterEqual => new >= old,
            Self::Always => true,
        }
    }
}

/// The depth test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthState {
    /// Comparison that passes.
    pub compare: Compare,
    /// Enables writing of the depths that pass.
    pub write: bool,
}

impl DepthState {
    /// The closer wins; of equals the first.
    pub const LESS: Self = Self { compare: Compare::Less, write: true };
    /// The closer wins where depths are reversed: 1 near, 0 far.
    pub const GREATER: Self = Self { compare: Compare::Greater, write: true };
}

/// Operation on a stencil value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "names say what they are")]
pub enum StencilOp {
    Keep,
    Zero,
    Replace,
    IncrementClamp,
    DecrementClamp,
    IncrementWrap,
    DecrementWrap,
    Invert,
}

impl StencilOp {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Keep,
        Self::Zero,
        Self::Replace,
        Self::IncrementClamp,
        Self::DecrementClamp,
        Self::IncrementWrap,
        Self::DecrementWrap,
        Self::Invert,
    ];

    /// The new value, before the write mask.
    #[inline]
    pub fn apply(self, old: u8, reference: u8) -> u8 {
        match self {
            Self::Keep => old,
            Self::Zero => 0,
            Self::Replace => reference,
            Self::IncrementClamp => old.saturating_add(1),
            Self::DecrementClamp => old.saturating_sub(1),
            Self::IncrementWrap => old.wrapping_add(1),
            Self::DecrementWrap => old.wrapping_sub(1),
            Self::Invert => !old,
        }
    }
}

/// The stencil test of one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StencilFace {
    /// Compares reference ∧ mask with value ∧ mask.
    pub compare: Compare,
    /// The reference value.
    pub reference: u8,
    /// The bits that are compared.
    pub read_mask: u8,
    /// The bits that are written.
    pub write_mask: u8,
    /// Operation if the stencil test fails.
    pub fail: StencilOp,
    /// Operation if it passes, and the depth test fails.
    pub depth_fail: StencilOp,
    /// Operation if both pass.
    pub pass: StencilOp,
}

impl Default for StencilFace {
    fn default() -> Self {
        Self {
            compare: Compare::Always,
            reference: 0,
            read_mask: !0,
            write_mask: !0,
            fail: StencilOp::Keep,
            depth_fail: StencilOp::Keep,
            pass: StencilOp::Keep,
        }
    }
}

/// The stencil test of both sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StencilState {
    /// Test of fronts, points and lines.
    pub front: StencilFace,
    /// Test of backs.
    pub back: StencilFace,
}

//! Parameters of textures, and lookups with them (OpenGL 4.6 core, sections 8.10, 8.14 and 8.17).

use glam::Vec4;

use super::{
    context::Context,
    error::{invalid_enum, invalid_operation, invalid_value},
    names::written,
    storage::Storage,
};
use crate::{
    error::Result,
    state::Compare,
    texture::{Filter, Sampler, TextureKind, ViewRange, Wrap},
};

/// A parameter of a texture or, but for its levels, of a sampler (tables 8.14 and 23.18).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextureParameter {
    /// The first level of lookups; 0 at first.
    BaseLevel(u32),
    /// The last level of lookups; 1000 at first.
    MaxLevel(u32),
    /// Filter for texels that are larger than pixels; `Linear` at first.
    Magnify(Filter),
    /// Filter for texels that are smaller than pixels, and between levels; `Nearest` and `Linear` at first, for
    /// rectangles `Linear` without levels.
    Minify(Filter, Option<Filter>),
    /// Addressing of coordinates outside, in s, t and r; `Repeat` at first, for rectangles `ClampToEdge`.
    Wrap([Wrap; 3]),
    /// Limits of the level of detail.
    LodRange([f32; 2]),
    /// Number that is added to the level of detail.
    LodBias(f32),
    /// Colour of the border.
    Border(Vec4),
    /// Comparison of depths with a reference; `LessEqual` at first.
    Compare(Compare),
}

/// Parameters of a texture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    base: u32,
    max: u32,
    sampler: Sampler,
}

impl Parameters {
    pub fn new(kind: TextureKind) -> Self {
        let sampler = match kind {
            TextureKind::Rectangle => Sampler { magnify: Filter::Linear, minify: Filter::Linear, ..Sampler::NEAREST },
            _ => Sampler { minify: Filter::Nearest, ..Sampler::default() },
        };
        Self { base: 0, max: 1000, sampler }
    }

    /// Sets a parameter, if the kind has it (section 8.10).
    fn set(&mut self, kind: TextureKind, parameter: TextureParameter, call: &'static str) -> Result<()> {
        use TextureParameter::{BaseLevel, MaxLevel, Minify, Wrap as WrapOf};
        let is_of_level = matches!(parameter, BaseLevel(_) | MaxLevel(_));
        if kind == TextureKind::Buffer || kind.is_multisample() && !is_of_level {
            return invalid_enum(call, format_args!("{parameter:?}, which a {kind:?} texture does not have"));
        }
        match parameter {
            BaseLevel(level) if level > 0 && !kind.has_levels() => {
                return invalid_operation(call, format_args!("base level {level} of a {kind:?} texture"));
            }
            Minify(_, Some(_)) if kind == TextureKind::Rectangle => {
                return invalid_enum(call, "a Rectangle texture has no levels to filter between");
            }
            WrapOf(wrap)
                if kind == TextureKind::Rectangle
                    && !wrap.iter().all(|wrap| matches!(wrap, Wrap::ClampToEdge | Wrap::ClampToBorder)) =>
            {
                return invalid_enum(call, format_args!("{wrap:?}; coordinates of Rectangle textures are clamped"));
            }
            BaseLevel(level) => self.base = level,
            MaxLevel(level) => self.max = level,
            _ => return set_sampling(&mut self.sampler, parameter, call),
        }
        Ok(())
    }

    pub fn sampler(&self) -> Sampler {
        self.sampler
    }

    /// The part of the storage that lookups see: levels from the base to the last, both clamped to those that are there
    /// (section 8.17: storage is immutable).
    pub fn seen(&self, storage: &Storage) -> ViewRange {
        let last = storage.levels() - 1;
        let base = self.base.min(last);
        let first = storage.range.levels.start;
        ViewRange { levels: first + base..first + self.max.clamp(base, last) + 1, ..storage.range.clone() }
    }
}

/// Sets a parameter of a sampler (section 8.2).
pub(super) fn set_sampling(sampler: &mut Sampler, parameter: TextureParameter, call: &'static str) -> Result<()> {
    use TextureParameter::{BaseLevel, Border, Compare, LodBias, LodRange, Magnify, MaxLevel, Minify, Wrap};
    match parameter {
        BaseLevel(_) | MaxLevel(_) => {
            return invalid_enum(call, format_args!("{parameter:?}, which a sampler does not have"));
        }
        LodRange([low, high])
            if !matches!(low.partial_cmp(&high), Some(std::cmp::Ordering::Less | std::cmp::Ordering::Equal)) =>
        {
            return invalid_value(call, format_args!("levels of detail from {low} to {high}"));
        }
        LodBias(bias) if bias.is_nan() => return invalid_value(call, "the bias is no number"),
        Magnify(filter) => sampler.magnify = filter,
        Minify(filter, levels) => (sampler.minify, sampler.levels) = (filter, levels),
        Wrap(wrap) => sampler.wrap = wrap,
        LodRange(range) => sampler.lod_range = range,
        LodBias(bias) => sampler.lod_bias = bias,
        Border(color) => sampler.border = color,
        Compare(compare) => sampler.compare = compare,
    }
    Ok(())
}

impl Context {
    /// Sets a parameter of a texture.
    ///
    /// # Errors
    /// For names without objects, parameters that the kind does not have or only with other values, and values that are
    /// no numbers.
    pub fn texture_parameter(&self, texture: u32, parameter: TextureParameter) -> Result<()> {
        const CALL: &str = "texture_parameter";
        let texture = self.shared.borrow().textures.object(texture, CALL)?;
        let mut texture = written(&texture, CALL)?;
        let kind = texture.kind;
        texture.parameters.set(kind, parameter, CALL)
    }
}

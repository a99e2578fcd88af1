//! Sized pixel formats, and how values become bits and bits values.
//!
//! A texel is up to 128 bits, little-endian; channels lie from the lowest bit up in the order of the format's name,
//! except in those of at most 16 bits with channels of less than 8 (`Rgb565`, `Rgba4`, `Rgba2` and so on), where as in
//! OpenGL red has the highest bits.

mod pack;
mod small_float;
mod table;

pub(crate) use pack::{decode_rgba8, encode_rgba8};
pub use table::Format;

use crate::output::Class;

/// Numeric meaning of a channel's bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numeric {
    /// c / (2ⁿ − 1).
    Unorm,
    /// max(c / (2ⁿ⁻¹ − 1), −1).
    Snorm,
    /// An unsigned integer.
    Uint,
    /// A signed integer.
    Sint,
    /// IEEE 754 of 16 or 32 bits, or unsigned with 5 bits of exponent (10, 11 bits).
    Float,
    /// 8 bits through the sRGB curve; alpha linear.
    Srgb,
    /// Three mantissas of 9 bits with an exponent of 5 bits.
    SharedExponent,
    /// Depth: 16 or 24 bits normalised, or a float.
    Depth,
    /// Stencil.
    Stencil,
    /// Depth and stencil.
    DepthStencil,
}

impl Format {
    /// Bytes of a texel.
    pub const fn bytes(self) -> usize {
        let (_, bits, _) = self.layout();
        (bits[0] as usize + bits[1] as usize + bits[2] as usize + bits[3] as usize).div_ceil(8)
    }

    /// Numeric meaning of the channels.
    pub const fn numeric(self) -> Numeric {
        self.layout().0
    }

    /// Bits of red, green, blue and alpha; 0 where there is no such channel.
    pub const fn bits(self) -> [u8; 4] {
        self.layout().1
    }

    /// The class of its values.
    pub const fn class(self) -> Class {
        match self.numeric() {
            Numeric::Uint | Numeric::Stencil => Class::Uint,
            Numeric::Sint => Class::Sint,
            _ => Class::Float,
        }
    }

    /// True if colours can be drawn to it.
    pub const fn is_color_renderable(self) -> bool {
        !matches!(self.numeric(), Numeric::Depth | Numeric::Stencil | Numeric::DepthStencil | Numeric::SharedExponent)
    }

    /// True if its values can be averaged.
    pub const fn is_filterable(self) -> bool {
        matches!(self.class(), Class::Float) && !matches!(self.numeric(), Numeric::DepthStencil)
    }

    /// True if values can be blended in it.
    pub const fn is_blendable(self) -> bool {
        matches!(self.class(), Class::Float) && self.is_color_renderable()
    }
}

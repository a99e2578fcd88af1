//! Formats of vertex attributes (OpenGL 4.6 core, tables 10.2 and 10.3, sections 2.3.5 and 10.3.8).

use glam::{DVec4, Vec4};
use half::f16;

use crate::format::Format;

/// Type of the components of an attribute in memory, lowest byte first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComponentType {
    /// 8 bits, signed.
    I8,
    /// 8 bits, unsigned.
    U8,
    /// 16 bits, signed.
    I16,
    /// 16 bits, unsigned.
    U16,
    /// 32 bits, signed.
    I32,
    /// 32 bits, unsigned.
    U32,
    /// 32 bits, signed, in units of 2⁻¹⁶.
    Fixed,
    /// A float of 16 bits.
    F16,
    /// A float of 32 bits.
    F32,
    /// A float of 64 bits.
    F64,
    /// Four signed components in 32 bits: 10 each for x (the lowest), y and z, 2 for w.
    Int2_10_10_10,
    /// Four unsigned components in 32 bits: 10 each for x (the lowest), y and z, 2 for w.
    Uint2_10_10_10,
    /// Three unsigned floats in 32 bits: 11 each for x (the lowest) and y, 10 for z.
    Float10_11_11,
}

/// Number and order of the components of an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Components {
    /// x.
    One,
    /// x, y.
    Two,
    /// x, y, z.
    Three,
    /// x, y, z, w.
    Four,
    /// z, y, x, w: `GL_BGRA`, for normalised bytes and for 2_10_10_10.
    Bgra,
}

impl Components {
    const fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Three => 3,
            Self::Four | Self::Bgra => 4,
        }
    }
}

/// Values that shaders get of the components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conversion {
    /// Floats of the same value: `glVertexAttribFormat`.
    Float,
    /// Floats of [0, 1] for unsigned and of [−1, 1] for signed integers: `glVertexAttribFormat` with `normalized`.
    /// Floats and fixed-point numbers stay as they are.
    Normalized,
    /// Bits of integers ([`f32::from_bits`]): `glVertexAttribIFormat`.
    Integer,
    /// Doubles: `glVertexAttribLFormat`.
    Long,
}

/// Format of an attribute in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AttributeFormat {
    /// Type of a component.
    pub component: ComponentType,
    /// Number and order.
    pub components: Components,
    /// Values for shaders.
    pub conversion: Conversion,
}

/// Broken rule of a format.
pub(crate) enum FormatError {
    /// The conversion does not take the type.
    Type(String),
    /// Type and number of components do not go together.
    Pair(String),
}

impl AttributeFormat {
    /// So many floats of 32 bits.
    pub const fn floats(components: Components) -> Self {
        Self { component: ComponentType::F32, components, conversion: Conversion::Float }
    }

    /// Bytes of an attribute.
    pub const fn bytes(self) -> usize {
        let component = match self.component {
            ComponentType::I8 | ComponentType::U8 => 1,
            ComponentType::I16 | ComponentType::U16 | ComponentType::F16 => 2,
            ComponentType::F64 => 8,
            ComponentType::Int2_10_10_10 | ComponentType::Uint2_10_10_10 | ComponentType::Float10_11_11 => return 4,
            ComponentType::I32 | ComponentType::U32 | ComponentType::Fixed | ComponentType::F32 => 4,
        };
        component * self.components.count()
    }

    /// The rules of table 10.3 and section 10.3.2.
    pub(crate) fn check(self) -> Result<(), FormatError> {
        use ComponentType::{F64, Float10_11_11, I8, I16, I32, Int2_10_10_10, U8, U16, U32, Uint2_10_10_10};
        let Self { component, components, conversion } = self;
        match conversion {
            Conversion::Integer if !matches!(component, I8 | U8 | I16 | U16 | I32 | U32) => {
                return Err(FormatError::Type(format!("{component:?} components are no integers")));
            }
            Conversion::Long if component != F64 => {
                return Err(FormatError::Type(format!("{component:?} components are no doubles")));
            }
            _ => {}
        }
        let packed = matches!(component, Int2_10_10_10 | Uint2_10_10_10);
        let pair = if packed && components.count() != 4 {
            "has four components"
        } else if component == Float10_11_11 && components != Components::Three {
            "has three components"
        } else if components == Components::Bgra && !packed && component != U8 {
            "is not for Bgra"
        } else if components == Components::Bgra && conversion != Conversion::Normalized {
            "is normalised in Bgra"
        } else {
            return Ok(());
        };
        Err(FormatError::Pair(format!("{component:?} {pair}; the format has {components:?} and {conversion:?}")))
    }

    /// Components of the attribute in the first bytes; those that are not there are 0, the last 1.
    pub(super) fn decode(self, bytes: &[u8]) -> DVec4 {
        let mut stored = [0.0, 0.0, 0.0, 1.0];
        match self.component {
            ComponentType::Int2_10_10_10 | ComponentType::Uint2_10_10_10 => {
                let word = u32::from_le_bytes(first(bytes));
                for (value, (shift, bits)) in stored.iter_mut().zip([(0, 10), (10, 10), (20, 10), (30, 2)]) {
                    // The component at the highest bits of the word.
                    let top = word << (32 - bits - shift);
                    *value = match self.component {
                        ComponentType::Int2_10_10_10 => {
                            self.integer(i64::from(top.cast_signed() >> (32 - bits)), bits - 1)
                        }
                        _ => self.integer(i64::from(top >> (32 - bits)), bits),
                    };
                }
            }
            ComponentType::Float10_11_11 => {
                let value = Format::Rg11B10Float.decode(u128::from(u32::from_le_bytes(first(bytes))));
                stored = value.as_dvec4().to_array();
            }
            _ => {
                let count = self.components.count();
                for (value, part) in stored.iter_mut().zip(bytes.chunks_exact(self.bytes() / count)).take(count) {
                    *value = self.component_of(part);
                }
            }
        }
        if self.components == Components::Bgra {
            stored.swap(0, 2);
        }
        DVec4::from_array(stored)
    }

    /// The value of a component that is not packed.
    fn component_of(self, bytes: &[u8]) -> f64 {
        match self.component {
            ComponentType::I8 => self.integer(i64::from(i8::from_le_bytes(first(bytes))), 7),
            ComponentType::U8 => self.integer(i64::from(bytes[0]), 8),
            ComponentType::I16 => self.integer(i64::from(i16::from_le_bytes(first(bytes))), 15),
            ComponentType::U16 => self.integer(i64::from(u16::from_le_bytes(first(bytes))), 16),
            ComponentType::I32 => self.integer(i64::from(i32::from_le_bytes(first(bytes))), 31),
            ComponentType::U32 => self.integer(i64::from(u32::from_le_bytes(first(bytes))), 32),
            ComponentType::Fixed => f64::from(i32::from_le_bytes(first(bytes))) / 65536.0,
            ComponentType::F16 => f16::from_le_bytes(first(bytes)).to_f64(),
            ComponentType::F32 => f64::from(f32::from_le_bytes(first(bytes))),
            ComponentType::F64 => f64::from_le_bytes(first(bytes)),
            ComponentType::Int2_10_10_10 | ComponentType::Uint2_10_10_10 | ComponentType::Float10_11_11 => 0.0,
        }
    }

    /// An integer of so many bits beside the sign, as it is or normalised (equations 2.1 and 2.2).
    fn integer(self, value: i64, bits: u32) -> f64 {
        let value = value as f64;
        if self.conversion == Conversion::Normalized { (value / ((1u64 << bits) - 1) as f64).max(-1.0) } else { value }
    }

    /// The value of a shader's input of 32 bits: integers as bits.
    pub(super) fn narrow(self, value: DVec4) -> Vec4 {
        match (self.conversion, self.component) {
            (Conversion::Integer, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) => {
                Vec4::from_array(value.to_array().map(|x| f32::from_bits(x as u32)))
            }
            (Conversion::Integer, _) => {
                Vec4::from_array(value.to_array().map(|x| f32::from_bits((x as i32).cast_unsigned())))
            }
            _ => value.as_vec4(),
        }
    }
}

/// The first bytes, zero beyond the end.
fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}

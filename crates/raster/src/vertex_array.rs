//! Attributes of vertices from bytes: formats, strides, divisors (OpenGL 4.6, section 10.3).

use glam::Vec4;

use crate::{
    error::{Result, refuse},
    format::{Format, Numeric},
};

/// One attribute: where its bytes are and what they mean.
#[derive(Clone, Copy, Debug)]
pub struct Attribute<'a> {
    /// The bytes.
    pub bytes: &'a [u8],
    /// Format of the values. Integers of `Unorm` and `Snorm` formats become floats in [0, 1] and [−1, 1].
    pub format: Format,
    /// Integers of `Uint` and `Sint` formats become floats of the same value instead of bits.
    pub integers_to_floats: bool,
    /// The byte of the first vertex.
    pub offset: usize,
    /// Bytes from one vertex to the next; 0 repeats the first.
    pub stride: usize,
    /// 0: one for each vertex; n: one for n instances, from the first on.
    pub divisor: u32,
}

/// Attributes by number; those that are not enabled have a constant value.
#[derive(Clone, Debug, Default)]
pub struct VertexArray<'a> {
    attributes: Vec<Option<Attribute<'a>>>,
    constants: Vec<Vec4>,
}

/// The most attributes.
pub const MAX_ATTRIBUTES: usize = 32;

impl<'a> VertexArray<'a> {
    /// No attributes: all are (0, 0, 0, 1).
    pub fn new() -> Self {
        Self::default()
    }

    /// Enables an attribute.
    ///
    /// # Errors
    /// For numbers from 32 on and formats that no attribute has.
    pub fn attribute(mut self, number: usize, attribute: Attribute<'a>) -> Result<Self> {
        const CALL: &str = "VertexArray::attribute";
        if number >= MAX_ATTRIBUTES {
            return refuse(CALL, format!("attribute {number}; there are {MAX_ATTRIBUTES}"));
        }
        let numeric = attribute.format.numeric();
        if matches!(
            numeric,
            Numeric::Srgb | Numeric::Depth | Numeric::Stencil | Numeric::DepthStencil | Numeric::SharedExponent
        ) {
            return refuse(CALL, format!("{:?} is no format of an attribute", attribute.format));
        }
        if self.attributes.len() <= number {
            self.attributes.resize(number + 1, None);
        }
        self.attributes[number] = Some(attribute);
        Ok(self)
    }

    /// The value of an attribute that is not enabled.
    pub fn constant(mut self, number: usize, value: Vec4) -> Self {
        if number < MAX_ATTRIBUTES {
            if self.constants.len() <= number {
                self.constants.resize(number + 1, Vec4::W);
            }
            self.constants[number] = value;
        }
        self
    }

    /// The value for a vertex and an instance, the latter counted from the draw's first. Channels that are not there
    /// are 0, the last 1; so is all that lies beyond the bytes.
    #[inline]
    pub fn fetch(&self, number: usize, vertex: u32, instance: u32) -> Vec4 {
        let Some(Some(attribute)) = self.attributes.get(number) else {
            return self.constants.get(number).copied().unwrap_or(Vec4::W);
        };
        let element = instance.checked_div(attribute.divisor).unwrap_or(vertex);
        let start = (element as usize).checked_mul(attribute.stride).and_then(|at| at.checked_add(attribute.offset));
        let bytes = attribute.format.bytes();
        let Some(texel) = start.and_then(|at| attribute.bytes.get(at..at.checked_add(bytes)?)) else {
            return Vec4::W;
        };
        let value = attribute.format.read(texel);
        if !attribute.integers_to_floats {
            return value;
        }
        match attribute.format.numeric() {
            Numeric::Uint => Vec4::from_array(value.to_array().map(|x| x.to_bits() as f32)),
            Numeric::Sint => Vec4::from_array(value.to_array().map(|x| x.to_bits().cast_signed() as f32)),
            _ => value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_fetched_byte_by_byte() {
        // Position as three floats, colour as four normalised bytes, a signed short, 18 bytes apart.
        let mut bytes = vec![0xee; 5];
        for vertex in 0..4i16 {
            for axis in 0..3 {
                bytes.extend((f32::from(vertex) + 0.25 * axis as f32).to_le_bytes());
            }
            bytes.extend([0, 51, 102, 255]);
            bytes.extend((-100 * vertex).to_le_bytes());
        }
        let part = |format, offset: usize, divisor| Attribute {
            bytes: &bytes,
            format,
            integers_to_floats: true,
            offset: 5 + offset,
            stride: 18,
            divisor,
        };
        let array = VertexArray::new()
            .attribute(0, part(Format::Rgb32Float, 0, 0))
            .and_then(|a| a.attribute(3, part(Format::Rgba8Unorm, 12, 0)))
            .and_then(|a| a.attribute(4, part(Format::R16Sint, 16, 2)))
            .unwrap()
            .constant(7, Vec4::splat(5.0));
        assert_eq!(array.fetch(0, 2, 0), Vec4::new(2.0, 2.25, 2.5, 1.0));
        assert_eq!(array.fetch(3, 1, 0), Vec4::new(0.0, 0.2, 0.4, 1.0));
        // Two instances share a value.
        assert_eq!([0, 1, 2, 3, 6].map(|i| array.fetch(4, 9, i).x), [0.0, 0.0, -100.0, -100.0, -300.0]);
        assert_eq!((array.fetch(7, 0, 0), array.fetch(8, 0, 0)), (Vec4::splat(5.0), Vec4::W));
        // Beyond the bytes, also where numbers overflow.
        assert_eq!((array.fetch(0, 4, 0), array.fetch(0, u32::MAX, 0)), (Vec4::W, Vec4::W));
        let wide = Attribute { stride: usize::MAX, ..part(Format::R8Uint, 0, 0) };
        assert_eq!(VertexArray::new().attribute(0, wide).unwrap().fetch(0, 3, 0), Vec4::W);
        assert!(VertexArray::new().attribute(40, part(Format::R8Uint, 0, 0)).is_err());
        assert!(VertexArray::new().attribute(0, part(Format::Depth16, 0, 0)).unwrap_err().rule.contains("Depth16"));
    }
}

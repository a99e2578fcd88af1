//! Attributes of vertices from bytes: formats, strides, divisors (OpenGL 4.6, section 10.3).

mod format;
#[cfg(test)]
mod tests;

pub(crate) use format::FormatError;
pub use format::{AttributeFormat, ComponentType, Components, Conversion};

use glam::{DVec4, Vec4};

use crate::{
    error::{Result, refuse},
    stages::VertexInput,
};

/// One attribute: its bytes and what they mean.
#[derive(Clone, Copy, Debug)]
pub struct Attribute<'a> {
    /// The bytes.
    pub bytes: &'a [u8],
    /// Format of the values.
    pub format: AttributeFormat,
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
        if let Err(FormatError::Type(rule) | FormatError::Pair(rule)) = attribute.format.check() {
            return refuse(CALL, rule);
        }
        if self.attributes.len() <= number {
            self.attributes.resize(number + 1, None);
        }
        self.attributes[number] = Some(attribute);
        Ok(self)
    }

    /// The value of an attribute that is not enabled; integers as bits.
    pub fn constant(mut self, number: usize, value: Vec4) -> Self {
        if number < MAX_ATTRIBUTES {
            if self.constants.len() <= number {
                self.constants.resize(number + 1, Vec4::W);
            }
            self.constants[number] = value;
        }
        self
    }

    /// The value for a vertex of a draw whose instances begin with `base_instance`: its element is that of the vertex,
    /// or with a divisor ⌊(instance − base) / divisor⌋ + base. Components that are not there are 0, the last 1; so is
    /// all that lies beyond the bytes.
    #[inline]
    pub fn fetch(&self, number: usize, vertex: VertexInput, base_instance: u32) -> Vec4 {
        let Some(Some(attribute)) = self.attributes.get(number) else {
            return self.constants.get(number).copied().unwrap_or(Vec4::W);
        };
        let value = attribute.value(vertex, base_instance).unwrap_or(DVec4::W);
        attribute.format.narrow(value)
    }

    /// As [`fetch`](Self::fetch), in doubles: exact for each type.
    pub fn fetch_double(&self, number: usize, vertex: VertexInput, base_instance: u32) -> DVec4 {
        let Some(Some(attribute)) = self.attributes.get(number) else {
            return self.constants.get(number).map_or(DVec4::W, |value| value.as_dvec4());
        };
        attribute.value(vertex, base_instance).unwrap_or(DVec4::W)
    }
}

impl Attribute<'_> {
    fn value(&self, vertex: VertexInput, base_instance: u32) -> Option<DVec4> {
        let of_instance = vertex.instance.wrapping_sub(base_instance).checked_div(self.divisor);
        let element = of_instance.map_or(vertex.vertex as usize, |steps| steps as usize + base_instance as usize);
        let start = element.checked_mul(self.stride)?.checked_add(self.offset)?;
        let end = start.checked_add(self.format.bytes())?;
        Some(self.format.decode(self.bytes.get(start..end)?))
    }
}

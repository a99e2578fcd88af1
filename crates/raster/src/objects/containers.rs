//! Vertex arrays, which attach buffers (OpenGL 4.6 core, section 10.3).
//!
//! An attachment is a reference: the attached object lives as long as it. Containers belong to one context.

use glam::Vec4;

use super::{
    buffers::Buffer,
    context::Context,
    error::{invalid_enum, invalid_operation, invalid_value},
    names::{Object, refers_to},
};
use crate::{
    error::Result,
    vertex_array::{Attribute, AttributeFormat, Components, FormatError, MAX_ATTRIBUTES},
};

/// The largest offset of an attribute in its vertex, in bytes.
const MAX_RELATIVE_OFFSET: usize = 2047;
/// The most bytes from one vertex to the next.
const MAX_STRIDE: usize = 2048;

/// Buffer of a binding of a vertex array (section 10.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexBuffer {
    /// Name of the buffer; 0 for none.
    pub buffer: u32,
    /// Byte of the first vertex.
    pub offset: usize,
    /// Bytes from one vertex to the next, at most 2048; 0 repeats the first.
    pub stride: usize,
}

/// Attribute of a vertex array.
#[derive(Clone, Copy, Debug)]
pub(super) struct AttributeState {
    pub enabled: bool,
    pub format: AttributeFormat,
    /// Bytes from the first of the vertex to the first of the attribute.
    pub relative_offset: usize,
    pub binding: usize,
}

/// Binding of a vertex array.
#[derive(Clone, Debug, Default)]
pub(super) struct VertexBinding {
    pub buffer: Option<Object<Buffer>>,
    pub offset: usize,
    pub stride: usize,
    pub divisor: u32,
}

#[derive(Debug)]
pub(super) struct VertexArrayObject {
    pub attributes: [AttributeState; MAX_ATTRIBUTES],
    pub bindings: [VertexBinding; MAX_ATTRIBUTES],
    pub elements: Option<Object<Buffer>>,
}

impl Default for VertexArrayObject {
    fn default() -> Self {
        let format = AttributeFormat::floats(Components::Four);
        Self {
            attributes: std::array::from_fn(|binding| AttributeState {
                enabled: false,
                format,
                relative_offset: 0,
                binding,
            }),
            bindings: std::array::from_fn(|_| VertexBinding { stride: 16, ..VertexBinding::default() }),
            elements: None,
        }
    }
}

impl VertexArrayObject {
    /// Takes a buffer out of all attachments.
    pub fn detach(&mut self, buffer: &Object<Buffer>) {
        let slots = self.bindings.iter_mut().map(|binding| &mut binding.buffer).chain([&mut self.elements]);
        slots.filter(|slot| refers_to(slot, buffer)).for_each(|slot| *slot = None);
    }
}

impl Context {
    /// Enables an attribute of a vertex array: it is read from its buffer (section 10.3.2).
    ///
    /// # Errors
    /// For names without objects and attributes from 32 on.
    pub fn enable_vertex_array_attrib(&mut self, array: u32, attribute: usize) -> Result<()> {
        self.attribute(array, attribute, "enable_vertex_array_attrib", |state| state.enabled = true)
    }

    /// Disables an attribute of a vertex array: it has the context's constant value (section 10.3.2).
    ///
    /// # Errors
    /// For names without objects and attributes from 32 on.
    pub fn disable_vertex_array_attrib(&mut self, array: u32, attribute: usize) -> Result<()> {
        self.attribute(array, attribute, "disable_vertex_array_attrib", |state| state.enabled = false)
    }

    /// Sets the format of an attribute and its offset in the vertex, at most 2047 bytes (section 10.3.2):
    /// `glVertexArrayAttribFormat`, and with conversions `Integer` and `Long` those with `I` and `L`.
    ///
    /// # Errors
    /// For names without objects, attributes from 32 on, formats that no attribute has, and offsets beyond 2047.
    pub fn vertex_array_attrib_format(
        &mut self,
        array: u32,
        attribute: usize,
        format: AttributeFormat,
        relative_offset: usize,
    ) -> Result<()> {
        const CALL: &str = "vertex_array_attrib_format";
        if relative_offset > MAX_RELATIVE_OFFSET {
            return invalid_value(
                CALL,
                format_args!("relative offset {relative_offset}; at most {MAX_RELATIVE_OFFSET}"),
            );
        }
        match format.check() {
            Ok(()) => self.attribute(array, attribute, CALL, |state| {
                (state.format, state.relative_offset) = (format, relative_offset);
            }),
            Err(FormatError::Type(rule)) => invalid_enum(CALL, rule),
            Err(FormatError::Pair(rule)) => invalid_operation(CALL, rule),
        }
    }

    /// Chooses the binding that an attribute is read from; without, that of its own number.
    ///
    /// # Errors
    /// For names without objects, and attributes and bindings from 32 on.
    pub fn vertex_array_attrib_binding(&mut self, array: u32, attribute: usize, binding: usize) -> Result<()> {
        const CALL: &str = "vertex_array_attrib_binding";
        check_number(binding, "binding", CALL)?;
        self.attribute(array, attribute, CALL, |state| state.binding = binding)
    }

    /// Attaches a buffer to a binding of a vertex array.
    ///
    /// # Errors
    /// For names without objects, bindings from 32 on, and strides beyond 2048.
    pub fn vertex_array_vertex_buffer(&mut self, array: u32, binding: usize, source: VertexBuffer) -> Result<()> {
        const CALL: &str = "vertex_array_vertex_buffer";
        let VertexBuffer { buffer, offset, stride } = source;
        if stride > MAX_STRIDE {
            return invalid_value(CALL, format_args!("stride {stride}; at most {MAX_STRIDE}"));
        }
        let buffer = self.attached_buffer(buffer, CALL)?;
        self.binding(array, binding, CALL, |state| *state = VertexBinding { buffer, offset, stride, ..*state })
    }

    /// Sets the divisor of a binding: 0 for one value for each vertex, n for one for n instances (section 10.3.4).
    ///
    /// # Errors
    /// For names without objects and bindings from 32 on.
    pub fn vertex_array_binding_divisor(&mut self, array: u32, binding: usize, divisor: u32) -> Result<()> {
        self.binding(array, binding, "vertex_array_binding_divisor", |state| state.divisor = divisor)
    }

    /// Attaches the buffer of indices; 0 detaches (section 10.3.10).
    ///
    /// # Errors
    /// For names without objects.
    pub fn vertex_array_element_buffer(&mut self, array: u32, buffer: u32) -> Result<()> {
        const CALL: &str = "vertex_array_element_buffer";
        let array = self.vertex_arrays.object(array, CALL)?;
        array.borrow_mut().elements = self.attached_buffer(buffer, CALL)?;
        Ok(())
    }

    /// Sets the value of an attribute where it is not enabled, integers as bits; (0, 0, 0, 1) at first. It belongs to
    /// the context, not to the vertex array (section 10.2).
    ///
    /// # Errors
    /// For attributes from 32 on.
    pub fn vertex_attrib(&mut self, attribute: usize, value: Vec4) -> Result<()> {
        check_number(attribute, "attribute", "vertex_attrib")?;
        self.constants[attribute] = value;
        Ok(())
    }

    fn attached_buffer(&self, name: u32, call: &'static str) -> Result<Option<Object<Buffer>>> {
        if name == 0 { Ok(None) } else { self.shared.borrow().buffers.object(name, call).map(Some) }
    }

    fn attribute(
        &mut self,
        array: u32,
        attribute: usize,
        call: &'static str,
        change: impl FnOnce(&mut AttributeState),
    ) -> Result<()> {
        let array = self.vertex_arrays.object(array, call)?;
        check_number(attribute, "attribute", call)?;
        change(&mut array.borrow_mut().attributes[attribute]);
        Ok(())
    }

    fn binding(
        &mut self,
        array: u32,
        binding: usize,
        call: &'static str,
        change: impl FnOnce(&mut VertexBinding),
    ) -> Result<()> {
        let array = self.vertex_arrays.object(array, call)?;
        check_number(binding, "binding", call)?;
        change(&mut array.borrow_mut().bindings[binding]);
        Ok(())
    }
}

/// An attribute of these bytes.
pub(super) fn source<'a>(bytes: &'a [u8], attribute: &AttributeState, binding: &VertexBinding) -> Attribute<'a> {
    Attribute {
        bytes,
        format: attribute.format,
        offset: binding.offset.saturating_add(attribute.relative_offset),
        stride: binding.stride,
        divisor: binding.divisor,
    }
}

fn check_number(number: usize, what: &str, call: &'static str) -> Result<()> {
    if number >= MAX_ATTRIBUTES {
        return invalid_value(call, format_args!("{what} {number}; there are {MAX_ATTRIBUTES}"));
    }
    Ok(())
}

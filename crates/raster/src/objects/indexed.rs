//! Indexed bindings of buffers: uniform and storage blocks, and atomic counters (OpenGL 4.6 core, section 6.1.1).

use super::{
    buffers::Buffer,
    context::{BufferTarget, Context},
    error::{invalid_enum, invalid_value},
    names::Object,
};
use crate::error::Result;

/// The most bytes of a uniform block.
pub(super) const MAX_UNIFORM_BYTES: usize = 1 << 16;

/// Bytes of a buffer that are bound to an index.
#[derive(Clone, Debug)]
pub(super) struct IndexedBuffer {
    pub buffer: Object<Buffer>,
    pub offset: usize,
    /// Number of bytes; `None` for all that the buffer has.
    pub size: Option<usize>,
}

/// Number of indices of a target, and the number that offsets are multiples of.
fn limits(target: BufferTarget, call: &'static str) -> Result<(u32, usize)> {
    match target {
        BufferTarget::Uniform => Ok((84, 16)),
        BufferTarget::ShaderStorage => Ok((16, 16)),
        BufferTarget::AtomicCounter => Ok((8, 4)),
        _ => invalid_enum(call, format_args!("{target:?} has no indices")),
    }
}

impl Context {
    /// Binds all of a buffer to an index of `Uniform` (84), `ShaderStorage` (16) or `AtomicCounter` (8), and to the
    /// target itself; the name 0 unbinds.
    ///
    /// # Errors
    /// For other targets, indices beyond the last, and names that were not generated.
    pub fn bind_buffer_base(&mut self, target: BufferTarget, index: u32, buffer: u32) -> Result<()> {
        self.bind_indexed((target, index), buffer, (0, None), "bind_buffer_base")
    }

    /// Binds bytes of a buffer, `(offset, size)`, to an index, as [`bind_buffer_base`](Self::bind_buffer_base) does all
    /// of it.
    ///
    /// # Errors
    /// As there, and for no bytes, and offsets that are no multiple of 16, or of 4 for counters.
    pub fn bind_buffer_range(
        &mut self,
        target: BufferTarget,
        index: u32,
        buffer: u32,
        (offset, size): (usize, usize),
    ) -> Result<()> {
        const CALL: &str = "bind_buffer_range";
        let (_, alignment) = limits(target, CALL)?;
        if size == 0 {
            return invalid_value(CALL, "the size must be positive");
        }
        if !offset.is_multiple_of(alignment) {
            return invalid_value(CALL, format_args!("offset {offset} is no multiple of {alignment}"));
        }
        self.bind_indexed((target, index), buffer, (offset, Some(size)), CALL)
    }

    fn bind_indexed(
        &mut self,
        (target, index): (BufferTarget, u32),
        name: u32,
        (offset, size): (usize, Option<usize>),
        call: &'static str,
    ) -> Result<()> {
        let (count, _) = limits(target, call)?;
        if index >= count {
            return invalid_value(call, format_args!("index {index} of {target:?}; there are {count}"));
        }
        if name == 0 {
            self.indexed.remove(&(target, index));
            self.buffers.remove(&target);
            return Ok(());
        }
        let buffer = self.shared.borrow_mut().buffers.first_use(name, call, Buffer::new)?;
        self.buffers.insert(target, std::rc::Rc::clone(&buffer));
        self.indexed.insert((target, index), IndexedBuffer { buffer, offset, size });
        Ok(())
    }
}

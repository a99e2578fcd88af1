//! Calls on buffers (OpenGL 4.6 core, chapter 6). The rules are those of the buffers themselves.

use std::rc::Rc;

use super::{
    buffers::{BufferFlags, BufferParameters, Contents, Mapping, Usage},
    context::{BufferRef, Context},
    names::written,
};
use crate::{error::Result, format::Format};

impl Context {
    /// Gives a buffer immutable storage.
    ///
    /// # Errors
    /// For no bytes, flags that do not fit each other, storage that is immutable already, and more than
    /// [`MAX_BUFFER_BYTES`](super::MAX_BUFFER_BYTES).
    pub fn buffer_storage(&self, buffer: impl Into<BufferRef>, data: Contents, flags: BufferFlags) -> Result<()> {
        const CALL: &str = "buffer_storage";
        written(&self.buffer(buffer, CALL)?, CALL)?.storage(data, flags, CALL)
    }

    /// Gives a buffer mutable storage in the place of what it has; a mapping of that ends.
    ///
    /// # Errors
    /// For immutable storage, and more than [`MAX_BUFFER_BYTES`](super::MAX_BUFFER_BYTES).
    pub fn buffer_data(&self, buffer: impl Into<BufferRef>, data: Contents, usage: Usage) -> Result<()> {
        const CALL: &str = "buffer_data";
        written(&self.buffer(buffer, CALL)?, CALL)?.data(data, usage, CALL)
    }

    /// Writes bytes from an offset on.
    ///
    /// # Errors
    /// Beyond the end, to a buffer that is mapped but not persistently, to immutable storage without `DYNAMIC_STORAGE`.
    pub fn buffer_sub_data(&self, buffer: impl Into<BufferRef>, offset: usize, data: &[u8]) -> Result<()> {
        const CALL: &str = "buffer_sub_data";
        written(&self.buffer(buffer, CALL)?, CALL)?.sub_data(offset, data, CALL)
    }

    /// Reads bytes from an offset on.
    ///
    /// # Errors
    /// Beyond the end, and from a buffer that is mapped but not persistently.
    pub fn get_buffer_sub_data(&self, buffer: impl Into<BufferRef>, offset: usize, size: usize) -> Result<Vec<u8>> {
        const CALL: &str = "get_buffer_sub_data";
        Ok(self.buffer(buffer, CALL)?.borrow().read(offset, size, CALL)?.to_vec())
    }

    /// Fills bytes from an offset on, `(offset, size)`, with a texel of a format.
    ///
    /// # Errors
    /// For formats that buffer textures do not have, a texel of another length, an offset or size that is no multiple
    /// of the texel's, a range beyond the end, and a buffer that is mapped but not persistently.
    pub fn clear_buffer_sub_data(
        &self,
        buffer: impl Into<BufferRef>,
        format: Format,
        range: (usize, usize),
        texel: &[u8],
    ) -> Result<()> {
        const CALL: &str = "clear_buffer_sub_data";
        written(&self.buffer(buffer, CALL)?, CALL)?.clear(format, range, texel, CALL)
    }

    /// Copies `size` bytes from one buffer to another, each with the offset of the first byte.
    ///
    /// # Errors
    /// For ranges beyond the ends, ranges of one buffer that overlap, and buffers that are mapped but not persistently.
    pub fn copy_buffer_sub_data(
        &self,
        (from, from_offset): (impl Into<BufferRef>, usize),
        (to, to_offset): (impl Into<BufferRef>, usize),
        size: usize,
    ) -> Result<()> {
        const CALL: &str = "copy_buffer_sub_data";
        let (from, to) = (self.buffer(from, CALL)?, self.buffer(to, CALL)?);
        if Rc::ptr_eq(&from, &to) {
            return written(&from, CALL)?.copy_within(from_offset, to_offset, size, CALL);
        }
        let (from, mut to) = (from.borrow(), written(&to, CALL)?);
        let source = from.read(from_offset, size, CALL)?;
        to.write(to_offset, size, CALL)?.copy_from_slice(source);
        Ok(())
    }

    /// Gives up the contents of a range; they become zero.
    ///
    /// # Errors
    /// Beyond the end, and for a buffer that is mapped but not persistently.
    pub fn invalidate_buffer_sub_data(&self, buffer: impl Into<BufferRef>, offset: usize, size: usize) -> Result<()> {
        const CALL: &str = "invalidate_buffer_sub_data";
        written(&self.buffer(buffer, CALL)?, CALL)?.invalidate(offset, size, CALL)
    }

    /// Maps a range of a buffer.
    ///
    /// # Errors
    /// For an empty range or one beyond the end, a buffer that is mapped already, flags that do not fit each other, and
    /// flags that the storage lacks.
    pub fn map_buffer_range(
        &self,
        buffer: impl Into<BufferRef>,
        offset: usize,
        size: usize,
        access: BufferFlags,
    ) -> Result<Mapping> {
        const CALL: &str = "map_buffer_range";
        let buffer = self.buffer(buffer, CALL)?;
        let number = written(&buffer, CALL)?.map(offset, size, access, CALL)?;
        Ok(Mapping { buffer, number })
    }

    /// Brings bytes that were written through a mapping into the buffer; the offset counts from the mapping's first.
    ///
    /// # Errors
    /// For buffers that are not mapped, or without `MAP_FLUSH_EXPLICIT`, and ranges beyond the end of the mapping.
    pub fn flush_mapped_buffer_range(&self, buffer: impl Into<BufferRef>, offset: usize, size: usize) -> Result<()> {
        const CALL: &str = "flush_mapped_buffer_range";
        written(&self.buffer(buffer, CALL)?, CALL)?.flush(offset, size, CALL)
    }

    /// Ends a mapping. Bytes that were written are in the buffer then, with `MAP_FLUSH_EXPLICIT` only those flushed.
    ///
    /// # Errors
    /// For buffers that are not mapped.
    pub fn unmap_buffer(&self, buffer: impl Into<BufferRef>) -> Result<()> {
        const CALL: &str = "unmap_buffer";
        written(&self.buffer(buffer, CALL)?, CALL)?.unmap(CALL)
    }

    /// Makes the client's and the commands' bytes of a persistent mapping that is not coherent visible to each other:
    /// `glMemoryBarrier` with `CLIENT_MAPPED_BUFFER_BARRIER_BIT` (section 7.13.2), for one buffer.
    ///
    /// # Errors
    /// An error for names without a buffer.
    pub fn client_mapped_buffer_barrier(&self, buffer: impl Into<BufferRef>) -> Result<()> {
        const CALL: &str = "client_mapped_buffer_barrier";
        written(&self.buffer(buffer, CALL)?, CALL)?.synchronize();
        Ok(())
    }

    /// State of a buffer.
    ///
    /// # Errors
    /// An error for names without a buffer.
    pub fn get_buffer_parameters(&self, buffer: impl Into<BufferRef>) -> Result<BufferParameters> {
        Ok(self.buffer(buffer, "get_buffer_parameters")?.borrow().parameters())
    }
}

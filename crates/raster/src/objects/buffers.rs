//! Buffer objects: stores of bytes, and their mappings (OpenGL 4.6 core, chapter 6).
//!
//! Commands take effect at once here, so a mapping has nobody to wait for. A mapping that is not coherent still shows
//! why programs must flush: bytes that are written through it stay beside the store until they are flushed, until a
//! barrier, or until the buffer is unmapped.

use std::ops::{BitOr, Range};

use super::{
    error::{invalid_enum, invalid_operation, invalid_value, out_of_memory},
    names::{Object, written},
};
use crate::{
    error::Result,
    format::{Format, Numeric},
};

/// The most bytes of a buffer: 2³⁰.
pub const MAX_BUFFER_BYTES: usize = 1 << 30;

/// Flags of immutable storage and of mappings, with OpenGL's bits (sections 6.2 and 6.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BufferFlags(u32);

impl BufferFlags {
    /// No flag.
    pub const NONE: Self = Self(0);
    /// A mapping may be read.
    pub const MAP_READ: Self = Self(0x1);
    /// A mapping may be written.
    pub const MAP_WRITE: Self = Self(0x2);
    /// The bytes of the mapped range need not be kept; they become zero.
    pub const MAP_INVALIDATE_RANGE: Self = Self(0x4);
    /// The bytes of the whole buffer need not be kept; they become zero.
    pub const MAP_INVALIDATE_BUFFER: Self = Self(0x8);
    /// Written bytes reach the buffer by `flush_mapped_buffer_range` alone; the others are lost.
    pub const MAP_FLUSH_EXPLICIT: Self = Self(0x10);
    /// Mapping does not wait for commands. Commands take effect at once, so it changes nothing.
    pub const MAP_UNSYNCHRONIZED: Self = Self(0x20);
    /// The buffer may be used while it is mapped.
    pub const MAP_PERSISTENT: Self = Self(0x40);
    /// Written bytes are seen at once by commands, and bytes of commands by the mapping.
    pub const MAP_COHERENT: Self = Self(0x80);
    /// `buffer_sub_data` may write to immutable storage.
    pub const DYNAMIC_STORAGE: Self = Self(0x100);
    /// The store may lie in the client's memory, as all of them do here.
    pub const CLIENT_STORAGE: Self = Self(0x200);

    /// The flags of these bits; bits that no flag has are found when the flags are used.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// True if all of these flags are set.
    pub const fn contains(self, flags: Self) -> bool {
        self.0 & flags.0 == flags.0
    }

    const fn intersects(self, flags: Self) -> bool {
        self.0 & flags.0 != 0
    }

    const fn without(self, flags: Self) -> Self {
        Self(self.0 & !flags.0)
    }
}

impl BitOr for BufferFlags {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

const READ_OR_WRITE: BufferFlags = BufferFlags(0x3);
const STORAGE_FLAGS: BufferFlags = BufferFlags(0x3c3);
const MAP_FLAGS: BufferFlags = BufferFlags(0xff);
/// Flags of mutable storage (table 6.3).
const MUTABLE: BufferFlags = BufferFlags(0x103);

/// Hint about how a mutable store will be used: how often it is written and read, and by whom (table 6.2). It changes
/// nothing here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "names say what they are")]
pub enum Usage {
    StreamDraw,
    StreamRead,
    StreamCopy,
    #[default]
    StaticDraw,
    StaticRead,
    StaticCopy,
    DynamicDraw,
    DynamicRead,
    DynamicCopy,
}

/// Contents of a new store.
#[derive(Clone, Copy, Debug)]
pub enum Contents<'a> {
    /// These bytes.
    Bytes(&'a [u8]),
    /// So many bytes, which OpenGL leaves undefined; they are zero.
    Size(usize),
}

impl Contents<'_> {
    fn store(self, call: &'static str) -> Result<Vec<u8>> {
        let size = match self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Size(size) => size,
        };
        let mut store = Vec::new();
        if size > MAX_BUFFER_BYTES || store.try_reserve_exact(size).is_err() {
            return out_of_memory(call, format_args!("{size} bytes; at most {MAX_BUFFER_BYTES}"));
        }
        match self {
            Self::Bytes(bytes) => store.extend_from_slice(bytes),
            Self::Size(_) => store.resize(size, 0),
        }
        Ok(store)
    }
}

/// State of a buffer (table 23.7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferParameters {
    /// Bytes of the store.
    pub size: usize,
    /// Usage hint of mutable storage; `DynamicDraw` for immutable storage.
    pub usage: Usage,
    /// True after `buffer_storage`.
    pub is_immutable: bool,
    /// Flags of the storage.
    pub flags: BufferFlags,
    /// Flags of the mapping, if there is one.
    pub access: Option<BufferFlags>,
    /// First byte and number of bytes of the mapping; zero without one.
    pub mapped: (usize, usize),
}

/// A store of bytes with its state.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    flags: BufferFlags,
    usage: Usage,
    immutable: bool,
    map: Option<Map>,
    /// Number of mappings so far: tells a mapping that ended from one that lasts.
    maps: u64,
}

/// A mapped range.
#[derive(Debug)]
struct Map {
    range: Range<usize>,
    access: BufferFlags,
    /// Bytes of a mapping whose writes are not seen at once, and the ranges of them that were written.
    beside: Option<(Vec<u8>, Vec<Range<usize>>)>,
}

impl Buffer {
    /// A buffer without a store, as it is when its object comes into being.
    pub fn new() -> Self {
        Self { flags: MUTABLE, ..Self::default() }
    }

    pub fn parameters(&self) -> BufferParameters {
        let map = self.map.as_ref();
        BufferParameters {
            size: self.bytes.len(),
            usage: self.usage,
            is_immutable: self.immutable,
            flags: self.flags,
            access: map.map(|map| map.access),
            mapped: map.map_or((0, 0), |map| (map.range.start, map.range.len())),
        }
    }

    /// Makes an immutable store (section 6.2).
    pub fn storage(&mut self, data: Contents, flags: BufferFlags, call: &'static str) -> Result<()> {
        if flags.without(STORAGE_FLAGS) != BufferFlags::NONE {
            return invalid_value(call, format_args!("{flags:?} has bits that storage does not have"));
        }
        if matches!(data, Contents::Size(0) | Contents::Bytes([])) {
            return invalid_value(call, "the size must be positive");
        }
        if flags.contains(BufferFlags::MAP_PERSISTENT) && !flags.intersects(READ_OR_WRITE) {
            return invalid_value(call, "MAP_PERSISTENT needs MAP_READ or MAP_WRITE");
        }
        if flags.contains(BufferFlags::MAP_COHERENT) && !flags.contains(BufferFlags::MAP_PERSISTENT) {
            return invalid_value(call, "MAP_COHERENT needs MAP_PERSISTENT");
        }
        self.replace(data, call)?;
        (self.flags, self.usage, self.immutable) = (flags, Usage::DynamicDraw, true);
        Ok(())
    }

    /// Makes a mutable store in the place of the one before (section 6.2).
    pub fn data(&mut self, data: Contents, usage: Usage, call: &'static str) -> Result<()> {
        self.replace(data, call)?;
        (self.flags, self.usage) = (MUTABLE, usage);
        Ok(())
    }

    fn replace(&mut self, data: Contents, call: &'static str) -> Result<()> {
        if self.immutable {
            return invalid_operation(call, "the storage is immutable");
        }
        // A mapping of the store before ends with it.
        self.bytes = data.store(call)?;
        self.map = None;
        Ok(())
    }

    /// Bytes of a range that a command reads.
    pub fn read(&self, offset: usize, size: usize, call: &'static str) -> Result<&[u8]> {
        let range = self.used(offset, size, call)?;
        Ok(&self.bytes[range])
    }

    /// Bytes of a range that a command writes.
    pub fn write(&mut self, offset: usize, size: usize, call: &'static str) -> Result<&mut [u8]> {
        let range = self.used(offset, size, call)?;
        Ok(&mut self.bytes[range])
    }

    /// All bytes, for a command that reads what it finds.
    pub fn all(&self, call: &'static str) -> Result<&[u8]> {
        self.read(0, self.bytes.len(), call)
    }

    /// Checks a range that a command uses: it must be there, and the buffer must not be mapped but persistently.
    fn used(&self, offset: usize, size: usize, call: &'static str) -> Result<Range<usize>> {
        let range = within(offset, size, self.bytes.len(), "buffer", call)?;
        match &self.map {
            Some(map) if !map.access.contains(BufferFlags::MAP_PERSISTENT) => {
                invalid_operation(call, "the buffer is mapped, and not persistently")
            }
            _ => Ok(range),
        }
    }

    /// Writes bytes from the client (section 6.2.1).
    pub fn sub_data(&mut self, offset: usize, data: &[u8], call: &'static str) -> Result<()> {
        let range = self.used(offset, data.len(), call)?;
        if self.immutable && !self.flags.contains(BufferFlags::DYNAMIC_STORAGE) {
            return invalid_operation(call, "immutable storage without DYNAMIC_STORAGE");
        }
        self.bytes[range].copy_from_slice(data);
        Ok(())
    }

    /// Fills a range with a texel (section 6.2.1).
    pub fn clear(
        &mut self,
        format: Format,
        (offset, size): (usize, usize),
        texel: &[u8],
        call: &'static str,
    ) -> Result<()> {
        let bytes = format.bytes();
        if !is_of_buffers(format) {
            return invalid_enum(call, format_args!("{format:?} is no format of buffers"));
        }
        if texel.len() != bytes {
            return invalid_value(call, format_args!("a texel of {} bytes; {format:?} has {bytes}", texel.len()));
        }
        if !offset.is_multiple_of(bytes) || !size.is_multiple_of(bytes) {
            let rule = format_args!("offset {offset} and size {size} are not both multiples of {bytes}, the texel");
            return invalid_value(call, rule);
        }
        self.write(offset, size, call)?.chunks_exact_mut(bytes).for_each(|part| part.copy_from_slice(texel));
        Ok(())
    }

    /// Copies bytes of a buffer to others of it that do not overlap them (section 6.6).
    pub fn copy_within(&mut self, from: usize, to: usize, size: usize, call: &'static str) -> Result<()> {
        let (source, target) = (self.used(from, size, call)?, self.used(to, size, call)?);
        if source.start < target.end && target.start < source.end {
            return invalid_value(call, format_args!("bytes {source:?} and {target:?} of one buffer overlap"));
        }
        self.bytes.copy_within(source, to);
        Ok(())
    }

    /// Gives up the contents of a range; they become zero (section 6.5).
    pub fn invalidate(&mut self, offset: usize, size: usize, call: &'static str) -> Result<()> {
        self.write(offset, size, call)?.fill(0);
        Ok(())
    }

    /// Maps a range (section 6.3); the number of the mapping.
    pub fn map(&mut self, offset: usize, size: usize, access: BufferFlags, call: &'static str) -> Result<u64> {
        const DISCARDS: BufferFlags = BufferFlags(0x2c);
        let range = within(offset, size, self.bytes.len(), "buffer", call)?;
        if access.without(MAP_FLAGS) != BufferFlags::NONE {
            return invalid_value(call, format_args!("{access:?} has bits that mappings do not have"));
        }
        let refused = if self.map.is_some() {
            Some("the buffer is mapped already")
        } else if size == 0 {
            Some("the range is empty")
        } else if !access.intersects(READ_OR_WRITE) {
            Some("neither MAP_READ nor MAP_WRITE is set")
        } else if access.contains(BufferFlags::MAP_READ) && access.intersects(DISCARDS) {
            Some("MAP_READ together with MAP_INVALIDATE_RANGE, MAP_INVALIDATE_BUFFER or MAP_UNSYNCHRONIZED")
        } else if access.contains(BufferFlags::MAP_FLUSH_EXPLICIT) && !access.contains(BufferFlags::MAP_WRITE) {
            Some("MAP_FLUSH_EXPLICIT needs MAP_WRITE")
        } else if !self.flags.contains(BufferFlags(access.0 & STORAGE_FLAGS.0)) {
            Some("the storage lacks MAP_READ, MAP_WRITE, MAP_PERSISTENT or MAP_COHERENT of the access")
        } else {
            None
        };
        if let Some(rule) = refused {
            return invalid_operation(call, rule);
        }
        if access.contains(BufferFlags::MAP_INVALIDATE_BUFFER) {
            self.bytes.fill(0);
        } else if access.contains(BufferFlags::MAP_INVALIDATE_RANGE) {
            self.bytes[range.clone()].fill(0);
        }
        // Nobody looks at a buffer that is mapped but not persistently, so its mapping may be the store itself.
        let flushed = access.contains(BufferFlags::MAP_FLUSH_EXPLICIT);
        let apart = access.contains(BufferFlags::MAP_PERSISTENT) && !access.contains(BufferFlags::MAP_COHERENT);
        let beside = (flushed || apart).then(|| (self.bytes[range.clone()].to_vec(), Vec::new()));
        self.map = Some(Map { range, access, beside });
        self.maps += 1;
        Ok(self.maps)
    }

    /// Brings written bytes of a part of the mapping into the store (section 6.3.1).
    pub fn flush(&mut self, offset: usize, size: usize, call: &'static str) -> Result<()> {
        let Some(map) = &mut self.map else { return invalid_operation(call, "the buffer is not mapped") };
        if !map.access.contains(BufferFlags::MAP_FLUSH_EXPLICIT) {
            return invalid_operation(call, "the buffer is mapped without MAP_FLUSH_EXPLICIT");
        }
        let part = within(offset, size, map.range.len(), "mapping", call)?;
        map.publish(&mut self.bytes, &part);
        Ok(())
    }

    /// Ends the mapping (section 6.3.2).
    pub fn unmap(&mut self, call: &'static str) -> Result<()> {
        let Some(mut map) = self.map.take() else { return invalid_operation(call, "the buffer is not mapped") };
        if !map.access.contains(BufferFlags::MAP_FLUSH_EXPLICIT) {
            let all = 0..map.range.len();
            map.publish(&mut self.bytes, &all);
        }
        Ok(())
    }

    /// Ends the mapping if there is one.
    pub fn end_mapping(&mut self) {
        // Only the lack of a mapping is refused.
        let _ = self.unmap("");
    }

    /// Makes client and commands see each other's bytes of a persistent mapping: a barrier of mapped buffers.
    pub fn synchronize(&mut self) {
        let Some(map) = &mut self.map else { return };
        if !map.access.contains(BufferFlags::MAP_FLUSH_EXPLICIT) {
            let all = 0..map.range.len();
            map.publish(&mut self.bytes, &all);
        }
        // What was not written since is read from the store again.
        if let Some((beside, written)) = &mut map.beside {
            let mut fresh = self.bytes[map.range.clone()].to_vec();
            written.iter().for_each(|range| fresh[range.clone()].copy_from_slice(&beside[range.clone()]));
            *beside = fresh;
        }
    }
}

impl Map {
    /// Copies the written bytes of a part to the store.
    fn publish(&mut self, bytes: &mut [u8], part: &Range<usize>) {
        let Some((beside, written)) = &mut self.beside else { return };
        let mut rest = Vec::new();
        for range in written.drain(..) {
            let (start, end) = (range.start.max(part.start), range.end.min(part.end));
            if start >= end {
                rest.push(range);
                continue;
            }
            bytes[self.range.start + start..self.range.start + end].copy_from_slice(&beside[start..end]);
            // Parts before and after still wait.
            rest.extend([range.start..start, end..range.end].into_iter().filter(|range| !range.is_empty()));
        }
        *written = rest;
    }
}

/// A mapped range of a buffer, in place of OpenGL's pointer. It ends when the buffer is unmapped, deleted or given
/// other storage; what is done with it afterwards is refused.
#[derive(Debug)]
pub struct Mapping {
    pub(super) buffer: Object<Buffer>,
    pub(super) number: u64,
}

impl Mapping {
    /// Writes bytes from an offset on, which counts from the first byte of the mapping.
    ///
    /// # Errors
    /// After the end of the mapping, beyond its range, without `MAP_WRITE`, and from within a draw that reads the
    /// buffer.
    pub fn write(&self, offset: usize, data: &[u8]) -> Result<()> {
        const CALL: &str = "Mapping::write";
        let mut buffer = written(&self.buffer, CALL)?;
        let Buffer { bytes, map: Some(map), maps, .. } = &mut *buffer else { return ended(CALL) };
        if *maps != self.number {
            return ended(CALL);
        }
        if !map.access.contains(BufferFlags::MAP_WRITE) {
            return invalid_operation(CALL, "the buffer is mapped without MAP_WRITE");
        }
        let part = within(offset, data.len(), map.range.len(), "mapping", CALL)?;
        match &mut map.beside {
            Some((beside, written)) => {
                beside[part.clone()].copy_from_slice(data);
                written.push(part);
            }
            None => bytes[map.range.start..][part].copy_from_slice(data),
        }
        Ok(())
    }

    /// Reads bytes from an offset on, which counts from the first byte of the mapping.
    ///
    /// # Errors
    /// After the end of the mapping, beyond its range, or without `MAP_READ`.
    pub fn read(&self, offset: usize, size: usize) -> Result<Vec<u8>> {
        const CALL: &str = "Mapping::read";
        let buffer = self.buffer.borrow();
        let Some(map) = buffer.map.as_ref().filter(|_| buffer.maps == self.number) else { return ended(CALL) };
        if !map.access.contains(BufferFlags::MAP_READ) {
            return invalid_operation(CALL, "the buffer is mapped without MAP_READ");
        }
        let part = within(offset, size, map.range.len(), "mapping", CALL)?;
        Ok(match &map.beside {
            Some((beside, _)) => beside[part].to_vec(),
            None => buffer.bytes[map.range.start..][part].to_vec(),
        })
    }
}

fn ended<T>(call: &'static str) -> Result<T> {
    invalid_operation(call, "the mapping has ended")
}

/// The range of these bytes, if it lies within so many.
fn within(offset: usize, size: usize, length: usize, of: &str, call: &'static str) -> Result<Range<usize>> {
    match offset.checked_add(size) {
        Some(end) if end <= length => Ok(offset..end),
        _ => invalid_value(call, format_args!("{size} bytes from {offset} on; the {of} has {length}")),
    }
}

/// True for the formats of buffer textures (table 8.16): channels of 8, 16 or 32 bits, three only of 32.
fn is_of_buffers(format: Format) -> bool {
    let bits = format.bits();
    let channels = bits.iter().filter(|bits| **bits > 0).count();
    let equal = bits.iter().all(|other| *other == 0 || *other == bits[0]);
    let size = if channels == 3 { bits[0] == 32 } else { matches!(bits[0], 8 | 16 | 32) };
    let numeric = matches!(format.numeric(), Numeric::Unorm | Numeric::Uint | Numeric::Sint | Numeric::Float);
    equal && size && numeric && !matches!(format, Format::Bgra8Unorm)
}

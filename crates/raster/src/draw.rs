//! Draw calls: vertices or indices, and instances.

use std::ops::Range;

use crate::front::Stream;

/// A draw call.
#[derive(Clone, Debug)]
pub struct Draw<'a> {
    pub(crate) stream: Stream<'a>,
    pub(crate) instances: Range<u32>,
    pub(crate) number: u32,
}

impl<'a> Draw<'a> {
    fn new(stream: Stream<'a>) -> Self {
        Self { stream, instances: 0..1, number: 0 }
    }

    /// The vertices of these numbers.
    pub fn vertices(range: Range<u32>) -> Self {
        Self::new(Stream::Range { first: range.start, count: range.end.saturating_sub(range.start) })
    }

    /// The vertices that these indices name. At most 2³² − 1 indices count.
    pub fn indexed(indices: &'a [u32]) -> Self {
        Self::new(Stream::Long(&indices[..indices.len().min(u32::MAX as usize)], 0))
    }

    /// The vertices that these indices name.
    pub fn indexed_short(indices: &'a [u16]) -> Self {
        Self::new(Stream::Short(&indices[..indices.len().min(u32::MAX as usize)], 0))
    }

    /// Instances of these numbers; without, number 0 alone.
    pub fn instances(self, instances: Range<u32>) -> Self {
        Self { instances, ..self }
    }

    /// Sets the base vertex: a number that is added to each index.
    pub fn base_vertex(self, base: i32) -> Self {
        let stream = match self.stream {
            Stream::Short(indices, _) => Stream::Short(indices, base),
            Stream::Long(indices, _) => Stream::Long(indices, base),
            range @ Stream::Range { .. } => range,
        };
        Self { stream, ..self }
    }

    /// With this number in a multi-draw.
    pub(crate) fn numbered(&self, number: u32) -> Self {
        Self { number, ..self.clone() }
    }
}

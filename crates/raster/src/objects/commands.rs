//! Draw calls: arrays, elements, instances, several at once, and from parameters in a buffer (OpenGL 4.6 core, sections
//! 10.4 and 10.5). Each becomes a list of single draws.

use std::ops::{Range, RangeInclusive};

use super::{
    buffers::Buffer,
    context::{BufferTarget, Context},
    draws::Output,
    error::{as_operation, invalid_operation, invalid_value},
    inputs::Inputs,
};
use crate::{counters::Counters, draw::Draw, error::Result};

/// Type of indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndexType {
    /// 8 bits.
    U8,
    /// 16 bits.
    U16,
    /// 32 bits.
    U32,
}

impl IndexType {
    const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 => 4,
        }
    }

    /// The index of all ones, which may restart a strip.
    const fn all_ones(self) -> u32 {
        u32::MAX >> (32 - 8 * self.bytes())
    }
}

/// Indices of a draw, in the buffer of the vertex array that is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elements {
    /// Number of indices.
    pub count: usize,
    /// Their type.
    pub index: IndexType,
    /// Byte of the first.
    pub offset: usize,
    /// Number that is added to each.
    pub base_vertex: i32,
}

/// Parameters of draws, in the buffer that is bound to `DrawIndirect`: words of 32 bits, lowest byte first. Those of
/// arrays are the number of vertices, that of instances, the first vertex and the first instance; those of elements the
/// number of indices, that of instances, the first index, the base vertex and the first instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indirect {
    /// Byte of the first draw; a multiple of 4.
    pub offset: usize,
    /// Number of draws.
    pub count: usize,
    /// Bytes from one draw to the next; a multiple of 4, or 0 where they follow each other.
    pub stride: usize,
}

/// A single draw.
#[derive(Clone, Debug)]
pub(super) struct Command {
    pub vertices: Vertices,
    pub instances: Range<u32>,
}

/// Vertices of a draw: those of numbers, or those of indices and the number that is added to them.
#[derive(Clone, Debug)]
pub(super) enum Vertices {
    Arrays(Range<u32>),
    Elements(Vec<u32>, i32),
}

impl Command {
    pub fn draw(&self) -> Draw<'_> {
        let draw = match &self.vertices {
            Vertices::Arrays(range) => Draw::vertices(range.clone()),
            Vertices::Elements(indices, base) => Draw::indexed(indices).base_vertex(*base),
        };
        draw.instances(self.instances.clone())
    }
}

impl Context {
    /// Draws vertices of these numbers and instances of these. The closure makes the pipeline and draws by it.
    ///
    /// # Errors
    /// Without a vertex array, for enabled attributes without buffers, buffers that are mapped but not persistently, a
    /// framebuffer that is not complete, and what the closure returns.
    pub fn draw_arrays<P>(&mut self, vertices: Range<u32>, instances: Range<u32>, program: P) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        let command = Command { vertices: Vertices::Arrays(vertices), instances };
        self.submit(&[command], "draw_arrays", program)
    }

    /// Draws vertices that indices name, and instances of these numbers. The closure makes the pipeline and draws by
    /// it.
    ///
    /// # Errors
    /// As [`draw_arrays`](Self::draw_arrays), and without a buffer of indices, or with indices beyond its end.
    pub fn draw_elements<P>(&mut self, elements: Elements, instances: Range<u32>, program: P) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        const CALL: &str = "draw_elements";
        let command = self.elements(elements, instances, CALL)?;
        self.submit(&[command], CALL, program)
    }

    /// Draws one instance of vertices that indices name, all of which lie in a range before the base vertex is added.
    /// An index of all ones may restart strips, and lies in each range.
    ///
    /// # Errors
    /// As [`draw_elements`](Self::draw_elements), for an empty range, and for indices outside of it.
    pub fn draw_range_elements<P>(
        &mut self,
        range: RangeInclusive<u32>,
        elements: Elements,
        program: P,
    ) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        const CALL: &str = "draw_range_elements";
        if range.is_empty() {
            return invalid_value(CALL, format_args!("the range {range:?} is empty"));
        }
        let command = self.elements(elements, 0..1, CALL)?;
        if let Vertices::Elements(indices, _) = &command.vertices {
            let restart = elements.index.all_ones();
            if let Some(index) = indices.iter().find(|index| !range.contains(index) && **index != restart) {
                return invalid_operation(CALL, format_args!("index {index} is outside of {range:?}"));
            }
        }
        self.submit(&[command], CALL, program)
    }

    /// Draws several ranges of vertices, one after the other; `VertexInput::draw` counts them.
    ///
    /// # Errors
    /// As [`draw_arrays`](Self::draw_arrays).
    pub fn multi_draw_arrays<P>(&mut self, draws: &[Range<u32>], program: P) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        let commands: Vec<Command> = draws
            .iter()
            .map(|vertices| Command { vertices: Vertices::Arrays(vertices.clone()), instances: 0..1 })
            .collect();
        self.submit(&commands, "multi_draw_arrays", program)
    }

    /// Draws several lists of indices, one after the other, each with its base vertex; `VertexInput::draw` counts them.
    ///
    /// # Errors
    /// As [`draw_elements`](Self::draw_elements); if one is refused, none is drawn.
    pub fn multi_draw_elements<P>(&mut self, draws: &[Elements], program: P) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        const CALL: &str = "multi_draw_elements";
        let commands: Result<Vec<Command>> = draws.iter().map(|draw| self.elements(*draw, 0..1, CALL)).collect();
        self.submit(&commands?, CALL, program)
    }

    /// Draws vertices as parameters in a buffer say: `glMultiDrawArraysIndirect`, with a count of 1
    /// `glDrawArraysIndirect`.
    ///
    /// # Errors
    /// As [`draw_arrays`](Self::draw_arrays), and without a buffer of parameters, for an offset or stride that is no
    /// multiple of 4, and for parameters beyond the buffer's end or that number more than 2³² vertices or instances.
    pub fn multi_draw_arrays_indirect<P>(&mut self, draws: Indirect, program: P) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        const CALL: &str = "multi_draw_arrays_indirect";
        let commands = self.indirect(draws, None, CALL)?;
        self.submit(&commands, CALL, program)
    }

    /// Draws elements of a type as parameters in a buffer say: `glMultiDrawElementsIndirect`, with a count of 1
    /// `glDrawElementsIndirect`.
    ///
    /// # Errors
    /// As [`multi_draw_arrays_indirect`](Self::multi_draw_arrays_indirect), and without a buffer of indices, or with
    /// indices beyond its end.
    pub fn multi_draw_elements_indirect<P>(&mut self, index: IndexType, draws: Indirect, program: P) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        const CALL: &str = "multi_draw_elements_indirect";
        let commands = self.indirect(draws, Some(index), CALL)?;
        self.submit(&commands, CALL, program)
    }

    /// Draws as [`multi_draw_elements_indirect`](Self::multi_draw_elements_indirect) or, without a type of indices, as
    /// [`multi_draw_arrays_indirect`](Self::multi_draw_arrays_indirect), but as many times as the word at a byte of the
    /// buffer says that is bound to `Parameter`, and at most `draws.count` times:
    /// `glMultiDrawElementsIndirectCount` and `glMultiDrawArraysIndirectCount`.
    ///
    /// # Errors
    /// As those calls, without a buffer bound to `Parameter`, for an offset that is no multiple of 4 or beyond its end.
    pub fn multi_draw_indirect_count<P>(
        &mut self,
        index: Option<IndexType>,
        count_offset: usize,
        draws: Indirect,
        program: P,
    ) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        const CALL: &str = "multi_draw_indirect_count";
        check_multiple(count_offset, "count's offset", CALL)?;
        let buffer = self.buffer(BufferTarget::Parameter, CALL)?;
        let count = word(as_operation(buffer.borrow().read(count_offset, 4, CALL))?);
        let draws = Indirect { count: draws.count.min(count as usize), ..draws };
        let commands = self.indirect(draws, index, CALL)?;
        self.submit(&commands, CALL, program)
    }

    /// A draw of indices, which are read now.
    fn elements(&self, elements: Elements, instances: Range<u32>, call: &'static str) -> Result<Command> {
        let Some(buffer) = self.bound_buffer(BufferTarget::ElementArray) else {
            return invalid_operation(call, "the vertex array has no buffer of indices");
        };
        let size = elements.index.bytes();
        let Some(bytes) = elements.count.checked_mul(size) else {
            return invalid_value(call, format_args!("{} indices", elements.count));
        };
        let indices = buffer.borrow().read(elements.offset, bytes, call)?.chunks_exact(size).map(word).collect();
        Ok(Command { vertices: Vertices::Elements(indices, elements.base_vertex), instances })
    }

    /// Draws of parameters in a buffer: of elements if there is a type of indices.
    fn indirect(&self, draws: Indirect, index: Option<IndexType>, call: &'static str) -> Result<Vec<Command>> {
        check_multiple(draws.offset, "offset", call)?;
        check_multiple(draws.stride, "stride", call)?;
        let buffer = self.buffer(BufferTarget::DrawIndirect, call)?;
        let records = parameters(&buffer.borrow(), draws, if index.is_some() { 5 } else { 4 }, call)?;
        let draw = |record: &Vec<u32>| {
            // Of vertices: count, instances, first, first instance; of indices, base vertex before the last.
            let (count, instances, first, base) = (record[0], record[1], record[2], record[record.len() - 1]);
            let Some(instances) = base.checked_add(instances).map(|end| base..end) else {
                return invalid_value(call, format_args!("{instances} instances from {base} on"));
            };
            if let Some(index) = index {
                let offset = (first as usize).saturating_mul(index.bytes());
                let elements = Elements { count: count as usize, index, offset, base_vertex: record[3].cast_signed() };
                return self.elements(elements, instances, call);
            }
            match first.checked_add(count) {
                Some(end) => Ok(Command { vertices: Vertices::Arrays(first..end), instances }),
                None => invalid_value(call, format_args!("{count} vertices from {first} on")),
            }
        };
        records.iter().map(draw).collect()
    }
}

/// Records of so many words each.
fn parameters(buffer: &Buffer, draws: Indirect, words: usize, call: &'static str) -> Result<Vec<Vec<u32>>> {
    let size = 4 * words;
    let stride = if draws.stride == 0 { size } else { draws.stride };
    let Some(last) = draws.count.checked_sub(1) else { return Ok(Vec::new()) };
    let Some(bytes) = last.checked_mul(stride).and_then(|before| before.checked_add(size)) else {
        return invalid_operation(call, format_args!("{} draws, {stride} bytes apart", draws.count));
    };
    let bytes = as_operation(buffer.read(draws.offset, bytes, call))?;
    let record = |number: usize| bytes[number * stride..][..size].chunks_exact(4).map(word).collect();
    Ok((0..draws.count).map(record).collect())
}

fn check_multiple(number: usize, of: &str, call: &'static str) -> Result<()> {
    if number.is_multiple_of(4) {
        Ok(())
    } else {
        invalid_value(call, format_args!("{of} {number} is no multiple of 4"))
    }
}

/// The number of these bytes, at most four, lowest first.
fn word(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

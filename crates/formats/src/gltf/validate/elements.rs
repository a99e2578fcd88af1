//! The numbers of accessors as they are stored, one element after the other.

use super::{
    Issues,
    document::{Accessor, Document, component_size, index, number},
};
use crate::gltf::container::Bytes;
use serde_json::Value;

/// Bytes that may be looked at in any file.
const ALWAYS: u64 = 1 << 20;
/// Most times that each byte of the buffers may be read.
const PASSES: u64 = 8;

/// The loaded buffers, and how much of them may still be looked at.
pub(super) struct Data<'a> {
    buffers: &'a [Option<Bytes>],
    left: u64,
}

impl<'a> Data<'a> {
    pub fn new(buffers: &'a [Option<Bytes>]) -> Self {
        let all: u64 = buffers.iter().flatten().map(|b| b.as_slice().len() as u64).sum();
        Self { buffers, left: all.saturating_mul(PASSES).saturating_add(ALWAYS) }
    }

    fn pay(&mut self, bytes: u64) -> Option<()> {
        self.left = self.left.checked_sub(bytes)?;
        Some(())
    }

    /// The bytes of a buffer view from an offset on.
    pub fn view(&self, document: &Document<'_>, view: usize, offset: u64) -> Option<&'a [u8]> {
        let view = document.list("bufferViews").get(view)?;
        let bytes = self.buffers.get(index(view, "buffer")?)?.as_ref()?.as_slice();
        let start = usize::try_from(number(view, "byteOffset")).ok()?;
        let end = start.checked_add(usize::try_from(number(view, "byteLength")).ok()?)?;
        bytes.get(start..end)?.get(usize::try_from(offset).ok()?..)
    }

    /// Calls `see` with each element's number and its components, normalised or not as `stored` says. `None` where they
    /// cannot be had, which other checks have reported, or where too much would have to be looked at.
    pub fn visit(
        &mut self,
        document: &Document<'_>,
        number_of: usize,
        is_stored: bool,
        mut see: impl FnMut(usize, &[f64]),
    ) -> Option<()> {
        let accessor = document.accessors.get(number_of).filter(|a| a.is_known())?;
        if document.packed.contains(&number_of) {
            return None;
        }
        let element = accessor.element() as usize;
        let count = usize::try_from(accessor.count).ok()?;
        let (bytes, stride) = match accessor.view {
            Some(view) => {
                let stride = number(document.view(accessor)?, "byteStride") as usize;
                let bytes = self.view(document, view, accessor.offset)?;
                let stride = if stride == 0 { element } else { stride };
                let needed = count.checked_sub(1)?.checked_mul(stride)?.checked_add(element)?;
                (bytes.get(..needed)?, stride)
            }
            None => (&[][..], element),
        };
        self.pay(accessor.count.checked_mul(element as u64)?)?;
        let sparse = &document.list("accessors")[number_of]["sparse"];
        let mut changes = if sparse.is_object() { Some(self.changes(document, accessor, sparse)?) } else { None };
        let mut values = [0.0; 16];
        let channels = accessor.channels();
        for k in 0..count {
            let start = k * stride;
            match bytes.get(start..start + element) {
                Some(bytes) => components(accessor, bytes, is_stored, &mut values),
                None => values = [0.0; 16],
            }
            if let Some(Changes { places, values: replaced, next }) = &mut changes
                && places.get(*next) == Some(&(k as u32))
            {
                components(accessor, &replaced[*next * element..], is_stored, &mut values);
                *next += 1;
            }
            see(k, &values[..channels]);
        }
        Some(())
    }

    /// Replaced elements of a sparse accessor; `None` unless their indices increase.
    fn changes(&mut self, document: &Document<'_>, accessor: &Accessor<'_>, sparse: &Value) -> Option<Changes<'a>> {
        let count = usize::try_from(number(sparse, "count")).ok()?;
        let places = self.places(document, sparse)?;
        if places.windows(2).any(|w| w[0] >= w[1]) {
            return None;
        }
        let part = &sparse["values"];
        let values = self.view(document, index(part, "bufferView")?, number(part, "byteOffset"))?;
        let length = count.checked_mul(accessor.element() as usize)?;
        Some(Changes { places, values: values.get(..length)?, next: 0 })
    }

    /// The indices of a sparse accessor.
    fn places(&mut self, document: &Document<'_>, sparse: &Value) -> Option<Vec<u32>> {
        let part = &sparse["indices"];
        let size = component_size(number(part, "componentType")) as usize;
        let count = usize::try_from(number(sparse, "count")).ok()?;
        let bytes = self.view(document, index(part, "bufferView")?, number(part, "byteOffset"))?;
        let bytes = bytes.get(..count.checked_mul(size)?)?;
        self.pay(bytes.len() as u64)?;
        let word = |b: &[u8]| b.iter().rev().fold(0u32, |word, byte| word << 8 | u32::from(*byte));
        (size > 0).then(|| bytes.chunks_exact(size).map(word).collect())
    }

    /// Sparse indices increase and stay below the accessor's count.
    pub fn check_sparse(&mut self, document: &Document<'_>, issues: &mut Issues) {
        for (k, (accessor, value)) in document.accessors.iter().zip(document.list("accessors")).enumerate() {
            let Some(places) = value.get("sparse").and_then(|sparse| self.places(document, sparse)) else { continue };
            let place = format!("/accessors/{k}/sparse/indices");
            if let Some(n) = places.iter().position(|p| u64::from(*p) >= accessor.count) {
                let message = format!("index {n} is {}, but the accessor has {} elements", places[n], accessor.count);
                issues.add(&place, message);
            }
            if let Some(n) = places.windows(2).position(|w| w[0] >= w[1]) {
                issues.add(&place, format!("index {} is {} and not more than the one before", n + 1, places[n + 1]));
            }
        }
    }
}

/// The replaced elements of a sparse accessor.
struct Changes<'a> {
    places: Vec<u32>,
    values: &'a [u8],
    next: usize,
}

/// The components of an element whose bytes are there.
fn components(accessor: &Accessor<'_>, bytes: &[u8], is_stored: bool, values: &mut [f64; 16]) {
    let (size, rows, column) = (accessor.size() as usize, accessor.rows(), accessor.column() as usize);
    let is_normalized = accessor.is_normalized && !is_stored;
    let scaled = |v: f64, most: f64| if is_normalized { (v / most).max(-1.0) } else { v };
    for (k, value) in values.iter_mut().enumerate().take(accessor.channels()) {
        let b = &bytes[k / rows * column + k % rows * size..];
        *value = match accessor.component {
            5120 => scaled(f64::from(b[0] as i8), 127.0),
            5121 => scaled(f64::from(b[0]), 255.0),
            5122 => scaled(f64::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            5123 => scaled(f64::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            5125 => f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            _ => f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        };
    }
}

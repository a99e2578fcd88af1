//! Accessors: typed views of buffers, interleaved, normalised, sparse.

use super::{Reader, container::Bytes, json::At, meshopt};

/// Most values of an accessor without data, all zero.
const MOST_ZEROS: usize = 1 << 24;

/// Component type of an accessor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The numbers of an element of an accessor with this type of number, if it has that.
    pub fn channels_of(self, accessor: &At<'_>) -> Option<usize> {
        let is_same = accessor.value["componentType"].as_u64().and_then(Self::new) == Some(self);
        channels(accessor).filter(|_| is_same)
    }

    /// The number at the start of some bytes, which are there.
    fn read(self, b: &[u8], is_normalized: bool) -> f32 {
        let n = |v: f32, most: f32| if is_normalized { (v / most).max(-1.0) } else { v };
        match self {
            Self::I8 => n(f32::from(b[0] as i8), 127.0),
            Self::U8 => n(f32::from(b[0]), 255.0),
            Self::I16 => n(f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => n(f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => n(u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, u32::MAX as f32),
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }
}

/// Some bytes and how they are laid out.
#[derive(Clone)]
pub(super) struct View {
    pub bytes: Bytes,
    pub stride: usize,
}

/// The data of an accessor that were unpacked for it.
pub(super) struct Decoded {
    pub component: Component,
    pub count: usize,
    pub view: View,
}

/// An accessor whose bytes are known to be there.
struct Layout {
    component: Component,
    channels: usize,
    count: usize,
    is_normalized: bool,
    /// `None`: all zero.
    view: Option<View>,
}

impl Layout {
    fn element(&self) -> usize {
        self.component.size() * self.channels
    }
}

/// The numbers of an element by an accessor's 'type'.
fn channels(accessor: &At<'_>) -> Option<usize> {
    Some(match accessor.text("type")? {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return None,
    })
}

impl Reader<'_> {
    /// The bytes of a buffer view, and its stride.
    pub(super) fn buffer_view(&mut self, root: &At<'_>, at: &At<'_>, name: &str) -> Option<(Bytes, Option<usize>)> {
        let (number, view) = self.index(root, at, name, "bufferViews")?;
        let bytes = match meshopt::of(&view) {
            Some(packed) => self.unpacked_view(root, number, &view, &packed)?,
            None => self.view_bytes(root, &view)?,
        };
        let stride = view.get("byteStride").and_then(|s| usize::try_from(s.value.as_u64()?).ok());
        Some((bytes, stride.filter(|s| *s > 0)))
    }

    /// The part of a buffer that an object with 'buffer', 'byteOffset' and 'byteLength' names.
    pub(super) fn view_bytes(&mut self, root: &At<'_>, view: &At<'_>) -> Option<Bytes> {
        let (index, buffer) = self.index(root, view, "buffer", "buffers")?;
        let size = |name: &str| view.get(name).and_then(|v| v.value.as_u64()).and_then(|v| usize::try_from(v).ok());
        let (offset, Some(length)) = (size("byteOffset").unwrap_or(0), size("byteLength")) else {
            self.error(view, "a buffer view needs a 'byteLength'");
            return None;
        };
        // A buffer that failed was reported when it was loaded.
        let Some(bytes) = self.buffers.get(index).cloned().flatten() else {
            if !self.import.diagnostics.has_errors() {
                self.error(&buffer, "the data of this buffer is not there");
            }
            return None;
        };
        let Some(part) = bytes.part(offset, length) else {
            let there = bytes.as_slice().len();
            self.error(
                view,
                format!("the view ends at byte {}, but the buffer has {there}", offset.saturating_add(length)),
            );
            return None;
        };
        Some(part)
    }

    fn layout(&mut self, root: &At<'_>, number: usize, accessor: &At<'_>) -> Option<Layout> {
        let code = accessor.get("componentType").and_then(|c| c.value.as_u64());
        let Some(component) = code.and_then(Component::new) else {
            self.error(accessor, "'componentType' is not one of 5120, 5121, 5122, 5123, 5125, 5126");
            return None;
        };
        let Some(channels) = channels(accessor) else {
            self.error(accessor, "'type' is not one of SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3, MAT4");
            return None;
        };
        let count = accessor.get("count").and_then(|c| c.value.as_u64()).and_then(|c| usize::try_from(c).ok());
        let Some(count) = count else {
            self.error(accessor, "an accessor needs a 'count'");
            return None;
        };
        let is_normalized = accessor.value["normalized"] == true;
        let mut layout = Layout { component, channels, count, is_normalized, view: None };
        if let Some(Decoded { component, count, view }) = self.decoded.get(&number) {
            return Some(Layout { component: *component, count: *count, view: Some(view.clone()), ..layout });
        }
        if accessor.get("bufferView").is_none() {
            if count > MOST_ZEROS {
                self.error(accessor, format!("{count} values without a buffer view are more than {MOST_ZEROS}"));
                return None;
            }
            return Some(layout);
        }
        let (bytes, stride) = self.buffer_view(root, accessor, "bufferView")?;
        let offset = accessor.get("byteOffset").and_then(|o| o.value.as_u64()).unwrap_or(0) as usize;
        let (element, there) = (layout.element(), bytes.as_slice().len());
        let stride = stride.unwrap_or(element);
        let needed = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(element)?.checked_add(offset));
        if needed.is_none_or(|n| n > there) || stride < element && count > 1 {
            let message = format!("{count} values of {element} bytes do not fit into its buffer view of {there} bytes");
            self.error(accessor, message);
            return None;
        }
        let bytes = bytes.part(offset.min(there), there - offset.min(there))?;
        layout.view = Some(View { bytes, stride });
        Some(layout)
    }

    /// The values of an accessor of `N` channels; integers as they stand, normalised ones as numbers in [−1, 1]. `name`
    /// is the member of `at` that holds its index. What is wrong is reported.
    pub(super) fn floats<const N: usize>(&mut self, root: &At<'_>, at: &At<'_>, name: &str) -> Option<Vec<[f32; N]>> {
        let (number, accessor) = self.index(root, at, name, "accessors")?;
        let layout = self.layout(root, number, &accessor)?;
        if layout.channels != N {
            let kind = accessor.text("type").unwrap_or_default();
            self.error(&accessor, format!("'{name}' needs values of {N} numbers, but this accessor has type {kind}"));
            return None;
        }
        let mut values = vec![[0.0; N]; layout.count];
        if let Some(view) = &layout.view {
            let (bytes, size) = (view.bytes.as_slice(), layout.component.size());
            for (value, element) in values.iter_mut().zip(bytes.chunks(view.stride.max(1))) {
                for (k, v) in value.iter_mut().enumerate() {
                    *v = layout.component.read(&element[k * size..], layout.is_normalized);
                }
            }
        }
        if let Some(sparse) = accessor.get("sparse") {
            let (indices, changes) = self.sparse::<N>(root, &sparse, &layout)?;
            for (index, change) in indices.into_iter().zip(changes) {
                match values.get_mut(index as usize) {
                    Some(value) => *value = change,
                    None => {
                        let count = values.len();
                        self.error(&sparse, format!("the sparse index {index} is past the {count} values"));
                        return None;
                    }
                }
            }
        }
        if let Some(k) = values.iter().position(|v| v.iter().any(|x| !x.is_finite())) {
            self.error(&accessor, format!("value {k} is infinite or NaN"));
            return None;
        }
        Some(values)
    }

    /// The values of an accessor of whole numbers.
    pub(super) fn integers<const N: usize>(&mut self, root: &At<'_>, at: &At<'_>, name: &str) -> Option<Vec<[u32; N]>> {
        let (number, accessor) = self.index(root, at, name, "accessors")?;
        let layout = self.layout(root, number, &accessor)?;
        if layout.channels != N || !matches!(layout.component, Component::U8 | Component::U16 | Component::U32) {
            self.error(&accessor, format!("'{name}' needs {N} unsigned integers for each value"));
            return None;
        }
        let Some(view) = &layout.view else { return Some(vec![[0; N]; layout.count]) };
        Some(integers(view.bytes.as_slice(), view.stride, layout.component, layout.count))
    }

    /// The indices and values that a sparse accessor replaces.
    fn sparse<const N: usize>(
        &mut self,
        root: &At<'_>,
        sparse: &At<'_>,
        layout: &Layout,
    ) -> Option<(Vec<u32>, Vec<[f32; N]>)> {
        let count = sparse.get("count").and_then(|c| c.value.as_u64()).and_then(|c| usize::try_from(c).ok());
        let (Some(count), Some(indices), Some(values)) = (count, sparse.get("indices"), sparse.get("values")) else {
            self.error(sparse, "a sparse accessor needs 'count', 'indices' and 'values'");
            return None;
        };
        let code = indices.get("componentType").and_then(|c| c.value.as_u64()).and_then(Component::new);
        let Some(component @ (Component::U8 | Component::U16 | Component::U32)) = code else {
            self.error(&indices, "sparse indices are unsigned integers");
            return None;
        };
        let mut part = |at: &At<'_>, element: usize| -> Option<Bytes> {
            let (bytes, _) = self.buffer_view(root, at, "bufferView")?;
            let offset = at.get("byteOffset").and_then(|o| o.value.as_u64()).unwrap_or(0);
            let needed = element.checked_mul(count);
            let part = needed.and_then(|needed| bytes.part(usize::try_from(offset).ok()?, needed));
            if part.is_none() {
                self.error(at, format!("{count} sparse values do not fit into the buffer view"));
            }
            part
        };
        let places = part(&indices, component.size())?;
        let data = part(&values, layout.element())?;
        let places = integers::<1>(places.as_slice(), component.size(), component, count);
        let size = layout.component.size();
        let changes = data
            .as_slice()
            .chunks_exact(layout.element())
            .map(|e| std::array::from_fn(|k| layout.component.read(&e[k * size..], layout.is_normalized)))
            .collect();
        Some((places.into_iter().map(|[i]| i).collect(), changes))
    }
}

/// Unsigned integers, whose bytes are known to be there.
fn integers<const N: usize>(bytes: &[u8], stride: usize, component: Component, count: usize) -> Vec<[u32; N]> {
    let size = component.size();
    let read = |b: &[u8]| match component {
        Component::U8 | Component::I8 => u32::from(b[0]),
        Component::U16 | Component::I16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
        Component::U32 | Component::F32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
    };
    bytes.chunks(stride.max(1)).take(count).map(|element| std::array::from_fn(|k| read(&element[k * size..]))).collect()
}

//! The binary data: views aligned to four bytes, accessors with their bounds, and the container.

use serde_json::{Value as Json, json};

/// Contents of the document's one buffer.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    pub views: Vec<Json>,
    pub accessors: Vec<Json>,
    pub bytes: Vec<u8>,
}

/// `ARRAY_BUFFER` and `ELEMENT_ARRAY_BUFFER`.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

impl Buffer {
    /// A view of bytes.
    pub fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.views.len() - 1
    }

    /// An accessor of vectors of N floats for vertices; with the bounds that positions need.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]], bounds: bool) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(VERTICES));
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let mut accessor = json!({ "bufferView": view, "componentType": 5126, "count": values.len(), "type": kind });
        if bounds {
            let fold = |start: f32, f: fn(f32, f32) -> f32| {
                values.iter().fold([start; N], |m, v| std::array::from_fn(|i| f(m[i], v[i])))
            };
            accessor["min"] = json!(fold(f32::INFINITY, f32::min).to_vec());
            accessor["max"] = json!(fold(f32::NEG_INFINITY, f32::max).to_vec());
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor of vertex indices.
    pub fn indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let all = triangles.as_flattened();
        let most = all.iter().copied().max().unwrap_or(0);
        // The largest value of a type restarts primitives.
        let (kind, bytes): (u32, Vec<u8>) = if most < u32::from(u16::MAX) {
            (5123, all.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect())
        } else {
            (5125, all.iter().flat_map(|i| i.to_le_bytes()).collect())
        };
        let view = self.view(&bytes, Some(INDICES));
        self.accessors.push(json!({ "bufferView": view, "componentType": kind, "count": all.len(), "type": "SCALAR" }));
        self.accessors.len() - 1
    }
}

/// The binary container of a document and its buffer.
pub(super) fn glb(mut json: Vec<u8>, mut bin: Vec<u8>) -> Result<Vec<u8>, String> {
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let chunk = if bin.is_empty() { 0 } else { 8 + bin.len() };
    let length = u32::try_from(12 + 8 + json.len() + chunk)
        .map_err(|_| "a .glb holds at most 4 GiB; write .gltf instead".to_owned())?;
    let mut out = Vec::with_capacity(length as usize);
    out.extend(b"glTF");
    out.extend(2u32.to_le_bytes());
    out.extend(length.to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    if !bin.is_empty() {
        out.extend((bin.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(bin);
    }
    Ok(out)
}

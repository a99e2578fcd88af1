//! glTF 2.0: `.glb` with everything in it, `.gltf` with a buffer and pictures beside it.

mod buffer;
mod material;
mod scene;
mod texture;

use super::{Written, exchange::Exchange};
use buffer::Buffer;
use serde_json::{Map, Value as Json, json};
use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    path::Path,
};
use steradian_scene::SceneDesc;

/// Writes a scene as glTF 2.0; `binary` in one file.
pub(super) fn write(desc: &SceneDesc, path: &Path, binary: bool) -> Result<Written, String> {
    let mut writer = Writer {
        x: Exchange::new(desc, path),
        binary,
        buffer: Buffer::default(),
        lists: BTreeMap::new(),
        extensions: BTreeSet::new(),
        materials: HashMap::new(),
        meshes: HashMap::new(),
        geometry: HashMap::new(),
        known: HashMap::new(),
        lights: Vec::new(),
        shines: false,
    };
    writer.scene();
    if let Some(fault) = writer.x.beside.fault.take() {
        return Err(fault);
    }
    let mut root = Map::new();
    root.insert("asset".into(), json!({ "version": "2.0", "generator": "Steradian" }));
    root.insert("scene".into(), json!(0));
    if !writer.lights.is_empty() {
        root.insert("extensions".into(), json!({ "KHR_lights_punctual": { "lights": writer.lights } }));
        writer.extensions.insert("KHR_lights_punctual");
    }
    if !writer.extensions.is_empty() {
        root.insert("extensionsUsed".into(), json!(writer.extensions));
    }
    for (name, list) in writer.lists {
        root.insert(name.into(), Json::Array(list));
    }
    let Buffer { views, accessors, bytes } = writer.buffer;
    if !bytes.is_empty() {
        root.insert("bufferViews".into(), Json::Array(views));
        root.insert("accessors".into(), Json::Array(accessors));
        let mut buffer = json!({ "byteLength": bytes.len() });
        if !binary {
            let name = writer.x.beside.add("meshes", "buffer.bin", bytes.clone());
            buffer["uri"] = json!(texture::uri(&name));
        }
        root.insert("buffers".into(), json!([buffer]));
    }
    // Empty lists are not allowed.
    root.retain(|_, v| v.as_array().is_none_or(|a| !a.is_empty()));
    let text = if binary { serde_json::to_vec(&root) } else { serde_json::to_vec_pretty(&root) };
    let text = text.map_err(|e| e.to_string())?;
    let bytes = if binary { buffer::glb(text, bytes)? } else { text };
    Ok(Written { bytes, files: writer.x.beside.take_files(), diagnostics: writer.x.diagnostics })
}

struct Writer<'a> {
    x: Exchange<'a>,
    binary: bool,
    buffer: Buffer,
    /// The top-level lists of the document: `nodes`, `meshes`, `materials`, …
    lists: BTreeMap<&'static str, Vec<Json>>,
    extensions: BTreeSet<&'static str>,
    /// By material, emission and medium.
    materials: HashMap<String, Option<material::Look>>,
    /// By geometry and material.
    meshes: HashMap<String, usize>,
    /// Attributes and indices by what they are made of.
    geometry: HashMap<String, Json>,
    /// Samplers, images and textures that there are.
    known: HashMap<String, usize>,
    lights: Vec<Json>,
    /// True if the emission of some surface is stronger than 1, so that readers add no light of their own.
    shines: bool,
}

impl Writer<'_> {
    /// Adds to a top-level list; the index there.
    fn push(&mut self, list: &'static str, value: Json) -> usize {
        let list = self.lists.entry(list).or_default();
        list.push(value);
        list.len() - 1
    }
}

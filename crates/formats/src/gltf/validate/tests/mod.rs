//! Documents that break one rule each.

mod data;
mod law;
mod links;
mod schema;

use super::super::tests::data;
use crate::{Options, gltf::import_bytes};
use serde_json::{Value, json};

/// The buffer of the sound document.
fn buffer() -> Vec<u8> {
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let mut bytes = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]); // 0: positions
    bytes.extend([0.0, 0.0, 1.0].repeat(3).iter().flat_map(|v: &f32| v.to_le_bytes())); // 36: normals
    bytes.extend(floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0])); // 72: coordinates
    bytes.extend([0, 0, 1, 0, 2, 0, 0, 0]); // 96: indices and two bytes of padding
    bytes.extend(floats(&[0.0, 1.0])); // 104: times
    bytes.extend(floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])); // 112: rotations
    bytes.extend([0; 12]); // 144: joints
    bytes.extend([1.0, 0.0, 0.0, 0.0].repeat(3).iter().flat_map(|v: &f32| v.to_le_bytes())); // 156: weights
    bytes.extend(floats(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0])); // 204
    bytes.extend([1.0, 0.0, 0.0, 1.0].repeat(3).iter().flat_map(|v: &f32| v.to_le_bytes())); // 268: tangents
    bytes
}

/// A valid document that has one of nearly everything.
fn sound(bytes: &[u8]) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0, "skin": 0 },
            { "children": [2], "rotation": [0, 0, 0, 1] },
            { "mesh": 1, "camera": 0 },
        ],
        "cameras": [
            { "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1, "zfar": 10 } },
            { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 10 } },
        ],
        "skins": [{ "joints": [1], "inverseBindMatrices": 7 }],
        "meshes": [
            { "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "JOINTS_0": 5, "WEIGHTS_0": 6 }, "indices": 3 }] },
            { "primitives": [{
                "attributes": { "POSITION": 0, "NORMAL": 1, "TANGENT": 9, "TEXCOORD_0": 2 },
                "material": 0,
                "targets": [{ "POSITION": 0 }],
            }], "weights": [0] },
        ],
        "materials": [{
            "name": "paint",
            "alphaMode": "MASK",
            "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 1], "roughnessFactor": 0.5, "baseColorTexture": { "index": 0 } },
        }],
        "textures": [{ "source": 0, "sampler": 0 }],
        "samplers": [{ "wrapS": 33071 }],
        "images": [{ "uri": "picture.png" }],
        "animations": [{
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "rotation" } }],
            "samplers": [{ "input": 4, "output": 8 }],
        }],
        "buffers": [{ "byteLength": bytes.len(), "uri": data(bytes) }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36, "target": 34962 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 36, "target": 34962 },
            { "buffer": 0, "byteOffset": 72, "byteLength": 24, "target": 34962 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 8, "target": 34963 },
            { "buffer": 0, "byteOffset": 104, "byteLength": 40 },
            { "buffer": 0, "byteOffset": 144, "byteLength": 12, "target": 34962 },
            { "buffer": 0, "byteOffset": 156, "byteLength": 48, "target": 34962 },
            { "buffer": 0, "byteOffset": 204, "byteLength": 64 },
            { "buffer": 0, "byteOffset": 268, "byteLength": 48, "target": 34962 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2" },
            { "bufferView": 3, "componentType": 5123, "count": 3, "type": "SCALAR" },
            { "bufferView": 4, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1] },
            { "bufferView": 5, "componentType": 5121, "count": 3, "type": "VEC4" },
            { "bufferView": 6, "componentType": 5126, "count": 3, "type": "VEC4" },
            { "bufferView": 7, "componentType": 5126, "count": 1, "type": "MAT4" },
            { "bufferView": 4, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC4" },
            { "bufferView": 8, "componentType": 5126, "count": 3, "type": "VEC4" },
        ],
    })
}

/// The sound document with values set at pointers; `null` removes.
fn changed(changes: &[(&str, Value)], bytes: &[u8]) -> Value {
    let mut root = sound(bytes);
    for (pointer, value) in changes {
        let (above, last) = pointer.rsplit_once('/').unwrap();
        let last = last.replace("~1", "/");
        match root.pointer_mut(above).unwrap_or_else(|| panic!("{pointer}")) {
            Value::Object(members) if value.is_null() => drop(members.remove(&last)),
            Value::Object(members) => drop(members.insert(last, value.clone())),
            Value::Array(items) if last == "-" => items.push(value.clone()),
            Value::Array(items) => items[last.parse::<usize>().unwrap()] = value.clone(),
            _ => panic!("{pointer}"),
        }
    }
    root
}

/// The first lines of all messages about some bytes.
fn messages_of(bytes: Vec<u8>) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("picture.png"), PNG).unwrap();
    let import = import_bytes(&folder.path().join("a.gltf"), bytes, &Options::default());
    import.diagnostics.iter().map(|d| d.to_string().lines().next().unwrap().to_owned()).collect()
}

/// A picture of one pixel.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0:~\x9bU\0\0\0\nIDATx\x9cc`\0\0\0\x02\0\x01H\xaf\xa4q\0\0\0\0IEND\xaeB`\x82";

/// The messages of the sound document with a change.
fn messages(changes: &[(&str, Value)]) -> Vec<String> {
    messages_of(changed(changes, &buffer()).to_string().into_bytes())
}

/// Asserts that changes give a message that names a place and says something.
#[track_caller]
fn breaks(changes: &[(&str, Value)], place: &str, words: &str) {
    let all = messages(changes);
    let start = format!(": {place}: ");
    assert!(all.iter().any(|m| m.contains(&start) && m.contains(words)), "{place}: {words}\n{all:#?}");
}

#[test]
fn the_sound_document_breaks_no_rule() {
    assert_eq!(messages(&[]), [""; 0]);
}

//! Rules of the data.

use super::{Value, breaks, buffer, changed, data, json, messages, messages_of};

/// Asserts that the sound document breaks a rule after bytes of its buffer, and some values, are replaced.
#[track_caller]
fn breaks_with(patches: &[(usize, &[u8])], changes: &[(&str, Value)], place: &str, words: &str) {
    let mut bytes = buffer();
    for (at, patch) in patches {
        bytes[*at..at + patch.len()].copy_from_slice(patch);
    }
    let all = messages_of(changed(changes, &bytes).to_string().into_bytes());
    let start = format!(": {place}: ");
    assert!(all.iter().any(|m| m.contains(&start) && m.contains(words)), "{place}: {words}\n{all:#?}");
}

fn float(value: f32) -> [u8; 4] {
    value.to_le_bytes()
}

#[test]
fn bounds_are_what_they_say() {
    breaks(
        &[("/accessors/0/max", json!([0.5, 1, 0]))],
        "/accessors/0/max/0",
        "0.5 is declared, but 1 elements are more",
    );
    breaks(
        &[("/accessors/0/max", json!([2, 1, 0]))],
        "/accessors/0/max/0",
        "no element reaches it: the right value is 1",
    );
    breaks(
        &[("/accessors/0/min", json!([0, 0.5, 0]))],
        "/accessors/0/min/1",
        "0.5 is declared, but 2 elements are less",
    );
    breaks(&[("/accessors/0/min", json!([0, -1, 0]))], "/accessors/0/min/1", "no element reaches it");
    let empty = json!({ "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] });
    assert_eq!(messages(&[("/accessors/-", empty)]), [""; 0]);
    // Integers are compared as they are stored, and single precision is what counts.
    breaks(&[("/accessors/3/max", json!([9]))], "/accessors/3/max/0", "the right value is 2");
    let tenth = [("/accessors/4/max", json!([0.1]))];
    let mut bytes = buffer();
    bytes[108..112].copy_from_slice(&float(0.1));
    assert_eq!(messages_of(changed(&tenth, &bytes).to_string().into_bytes()), [""; 0]);
    breaks_with(
        &[(72, &float(f32::NAN))],
        &[
            ("/meshes/1", json!({ "primitives": [{ "attributes": { "POSITION": 0 } }] })),
            ("/nodes/2/weights", json!(null)),
        ],
        "/accessors/2",
        "element 0 is NaN",
    );
}

#[test]
fn vertices_have_sound_values() {
    let at = |name: &str| format!("/meshes/1/primitives/0/attributes/{name}");
    let skinned = |name: &str| format!("/meshes/0/primitives/0/attributes/{name}");
    breaks_with(&[(44, &float(2.0))], &[], &skinned("NORMAL"), "element 0 must have length 1, not 2");
    breaks_with(&[(268, &float(0.0))], &[], &at("TANGENT"), "must have length 1, not 0");
    breaks_with(&[(280, &float(0.5))], &[], &at("TANGENT"), "the sign 1 or -1");
    breaks_with(&[(168, &float(2.0))], &[(&at("COLOR_0"), json!(6))], &at("COLOR_0"), "must be from 0 to 1, not 2");
    breaks_with(&[(144, &[3])], &[], &skinned("JOINTS_0"), "a joint that its skin does not have: 3");
    breaks_with(&[(156, &float(0.5)), (160, &float(0.5))], &[], &skinned("JOINTS_0"), "has a joint twice: 0");
    breaks_with(&[(156, &float(-1.0))], &[], &skinned("WEIGHTS_0"), "has a negative weight, -1");
    breaks_with(&[(156, &float(0.5))], &[], &skinned("WEIGHTS_0"), "weights of the sum 1, not 0.5");
}

#[test]
fn indices_refer_to_vertices() {
    let place = "/meshes/0/primitives/0/indices";
    let unread = [("/scenes/0/nodes", json!([1]))];
    breaks_with(&[(98, &[255, 255])], &unread, place, "must not restart a primitive");
    // Where the reader cannot go on, it says so.
    breaks_with(&[(98, &[3, 0])], &[], place, "only 3 vertices");
    breaks_with(&[(98, &[3, 0])], &unread, place, "a vertex that is not there: 3");
}

#[test]
fn sparse_indices_increase() {
    let sparse =
        json!({ "count": 2, "indices": { "bufferView": 9, "componentType": 5123 }, "values": { "bufferView": 7 } });
    let view = ("/bufferViews/-", json!({ "buffer": 0, "byteOffset": 96, "byteLength": 8 }));
    let unused = json!({ "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse });
    let changes = [view, ("/accessors/-", unused)];
    breaks_with(&[(96, &[2, 0, 1, 0])], &changes, "/accessors/10/sparse/indices", "index 1 is 1 and not more");
    breaks_with(
        &[(96, &[2, 0, 7, 0])],
        &changes,
        "/accessors/10/sparse/indices",
        "index 1 is 7, but the accessor has 3",
    );
}

#[test]
fn key_frames_and_matrices_are_sound() {
    let input = "/animations/0/samplers/0/input";
    breaks_with(&[(104, &float(-1.0))], &[], input, "must not be negative, as a time");
    breaks_with(&[(108, &float(0.0))], &[], input, "element 1 must be more than the time before");
    breaks_with(&[(124, &float(0.5))], &[], "/animations/0/channels/0/sampler", "a rotation of length 1, not 0.5");
    breaks_with(&[(216, &float(1.0))], &[], "/skins/0/inverseBindMatrices", "in it stands 1");
}

#[test]
fn pictures_are_what_they_are_declared_to_be() {
    let picture = |uri: String| {
        [
            ("/images/0", json!({ "uri": uri })),
            ("/textures", json!(null)),
            ("/materials", json!(null)),
            ("/meshes/1/primitives/0/material", json!(null)),
        ]
    };
    let uri = |media: &str, bytes: &[u8]| data(bytes).replace("application/octet-stream", media);
    assert_eq!(messages(&picture(uri("image/png", super::PNG))), [""; 0]);
    breaks(&picture(uri("image/jpeg", super::PNG)), "/images/0/uri", "is 'image/png', but 'image/jpeg' is declared");
    breaks(&picture(uri("image/png", &super::PNG[..20])), "/images/0", "cut off");
    breaks(&picture(uri("image/png", b"\x89PNG\r\n\x1a\n\0\0\0\x0dIDATxxxxxxxxxxxxxxxxxxxx")), "/images/0", "no PNG");
    breaks(&picture(uri("image/jpeg", b"\xff\xd8\xff\xe0\0\x01xxxxx")), "/images/0", "a segment of it is malformed");
    breaks(&picture(uri("image/jpeg", b"\xff\xd8\xff\xe0\0\x04xx")), "/images/0", "cut off");
    breaks(&picture(uri("image/webp", b"RIFF\0\0\0\0WEBPVP8 ")), "/images/0", "needs the extension 'EXT_texture_webp'");
    breaks(&picture("missing.png".into()), "/images/0", "cannot find 'missing.png'");
}

/// Assets of Khronos, Blender and others keep the rules, but for these.
#[test]
fn valid_assets_break_no_rule() {
    // Magnum's are test files that break rules on purpose; the others do by mistake: two channels of one target, and
    // a normal texture of the coat without tangents.
    const KNOWN: [&str; 3] = ["magnum", "24_animation_pointer", "ClearCoatTest"];
    let Some(root) = crate::mesh::test_files::assets() else { return };
    let (mut folders, mut count) = (vec![root.join("gltf")], 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && !KNOWN.iter().any(|known| path.ends_with(known)) {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
                count += 1;
                let import = crate::gltf::import(&path, &crate::Options::default());
                let all: Vec<String> = import.diagnostics.iter().map(ToString::to_string).collect();
                assert!(!all.iter().any(|m| m.starts_with("warning: ")), "{}: {all:#?}", path.display());
            }
        }
    }
    assert!(count > 25, "{count}");
}

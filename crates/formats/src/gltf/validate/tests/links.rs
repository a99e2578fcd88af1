//! Rules between objects.

use super::{Value, breaks, json, messages};

#[test]
fn buffers_views_and_accessors_fit() {
    breaks(&[("/buffers/0/uri", json!("data:text/plain;base64,AAAA"))], "/buffers/0/uri", "not 'text/plain'");
    breaks(&[("/bufferViews/0/byteStride", json!(40))], "/bufferViews/0/byteStride", "exceeds the view of 36");
    breaks(&[("/bufferViews/3/byteStride", json!(4))], "/bufferViews/3/byteStride", "not one of indices");
    breaks(&[("/bufferViews/-", json!({ "buffer": 0, "byteLength": 9999 }))], "/bufferViews/9/byteLength", "9999");
    breaks(&[("/accessors/0/normalized", json!(true))], "/accessors/0/normalized", "8 and 16 bits");
    let accessor = |view: u64, offset: u64, component: u64, count: u64, kind: &str| json!({ "bufferView": view, "byteOffset": offset, "componentType": component, "count": count, "type": kind });
    breaks(&[("/accessors/-", accessor(7, 2, 5126, 1, "SCALAR"))], "/accessors/10/byteOffset", "multiple of the 4");
    breaks(&[("/accessors/-", accessor(7, 1, 5121, 1, "MAT2"))], "/accessors/10/byteOffset", "multiples of 4");
    breaks(&[("/accessors/-", accessor(7, 0, 5126, 17, "SCALAR"))], "/accessors/10", "end at byte 68 of a view of 64");
    // Matrices of bytes have padding.
    breaks(&[("/accessors/-", accessor(7, 0, 5121, 6, "MAT3"))], "/accessors/10", "end at byte 72");
    let odd = [
        ("/bufferViews/-", json!({ "buffer": 0, "byteOffset": 2, "byteLength": 16 })),
        ("/accessors/-", accessor(9, 0, 5126, 1, "SCALAR")),
    ];
    breaks(&odd, "/accessors/10", "starts at byte 2 of the buffer");
    let narrow = [
        ("/bufferViews/-", json!({ "buffer": 0, "byteLength": 16, "byteStride": 4 })),
        ("/accessors/-", accessor(9, 0, 5126, 1, "VEC3")),
    ];
    breaks(&narrow, "/accessors/10", "has 12 bytes, but the stride of its view is 4");
    breaks(&[("/accessors/1/min", json!([0]))], "/accessors/1/min", "instead of 3 for VEC3");
    breaks(
        &[("/accessors/5/max", json!([0, 0, 0, 300]))],
        "/accessors/5/max/3",
        "no value that the component type 5121",
    );
}

#[test]
fn sparse_accessors_fit() {
    let sparse = |count: u64, indices: Value, values: Value| {
        let mut indices = indices;
        indices["componentType"] = json!(5123);
        [("/accessors/1/sparse", json!({ "count": count, "indices": indices, "values": values }))]
    };
    let bad = sparse(4, json!({ "bufferView": 4 }), json!({ "bufferView": 7 }));
    breaks(&bad, "/accessors/1/sparse/count", "4 elements are replaced, but the accessor has 3");
    let bad = sparse(1, json!({ "bufferView": 4, "byteOffset": 1 }), json!({ "bufferView": 7 }));
    breaks(&bad, "/accessors/1/sparse/indices/byteOffset", "multiple of the 2");
    let bad = sparse(1, json!({ "bufferView": 4 }), json!({ "bufferView": 0 }));
    breaks(&bad, "/accessors/1/sparse/values/bufferView", "neither 'byteStride' nor 'target'");
}

#[test]
fn data_has_one_use() {
    let indices = "/meshes/0/primitives/0/indices";
    breaks(&[("/meshes/1/primitives/0/indices", json!(4))], "/animations/0/samplers/0/input", "accessor 4 is used as");
    breaks(&[("/bufferViews/3/target", json!(34962))], indices, "buffer view 3 holds vertex attributes");
    breaks(
        &[("/bufferViews/3/target", json!(null)), ("/bufferViews/3/byteStride", json!(4))],
        indices,
        "no 'byteStride'",
    );
    let stride = ("/bufferViews/4/byteStride", json!(16));
    breaks(&[stride], "/animations/0/samplers/0/input", "no 'byteStride'");
    breaks(&[("/bufferViews/7/byteStride", json!(64))], "/skins/0/inverseBindMatrices", "no 'byteStride'");
    let image = [
        ("/images/0", json!({ "bufferView": 8, "mimeType": "image/png" })),
        ("/textures", json!(null)),
        ("/materials", json!(null)),
        ("/meshes/1/primitives/0/material", json!(null)),
        ("/bufferViews/8", json!({ "buffer": 0, "byteLength": 48, "byteStride": 16 })),
    ];
    breaks(&image, "/images/0/bufferView", "no 'byteStride'");
    let attribute = "/meshes/1/primitives/0/attributes/_A";
    breaks(
        &[
            ("/accessors/-", json!({ "bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR" })),
            (attribute, json!(10)),
        ],
        attribute,
        "needs a 'byteStride'",
    );
    breaks(
        &[
            ("/accessors/-", json!({ "bufferView": 5, "componentType": 5121, "count": 3, "type": "VEC3" })),
            (attribute, json!(10)),
        ],
        attribute,
        "multiple of 4 bytes",
    );
}

#[test]
fn primitives_have_sound_attributes() {
    let at = "/meshes/1/primitives/0/attributes";
    let with = |name: &str| format!("{at}/{name}");
    breaks(&[(&with("COLOUR"), json!(1))], &with("COLOUR"), "no name of an attribute");
    breaks(&[(&with("TEXCOORD_01"), json!(2))], &with("TEXCOORD_01"), "no name of an attribute");
    breaks(&[(&with("TEXCOORD_2"), json!(2))], at, "numbered from 0 without gaps");
    breaks(&[(&with("JOINTS_0"), json!(5))], at, "1 sets of 'JOINTS', but 0 of 'WEIGHTS'");
    breaks(&[("/accessors/0/min", json!(null))], &with("POSITION"), "needs 'min' and 'max'");
    breaks(
        &[("/accessors/5/componentType", json!(5122))],
        "/meshes/0/primitives/0/attributes/JOINTS_0",
        "VEC4 of SHORT",
    );
    breaks(
        &[("/accessors/5/componentType", json!(5125))],
        "/meshes/0/primitives/0/attributes/JOINTS_0",
        "UNSIGNED_INT",
    );
    breaks(&[("/accessors/2/count", json!(2))], &with("TEXCOORD_0"), "2 elements");
    let indices = json!({ "bufferView": 3, "componentType": 5122, "count": 3, "type": "SCALAR" });
    breaks(&[("/accessors/3", indices)], "/meshes/0/primitives/0/indices", "SCALAR of SHORT cannot be used here");
    breaks(
        &[(&with("TEXCOORD_0"), json!(null))],
        "/meshes/1/primitives/0/material",
        "needs the attribute 'TEXCOORD_0'",
    );
    let coat = json!({ "KHR_materials_clearcoat": { "clearcoatNormalTexture": { "index": 0 } } });
    let used = ("/extensionsUsed", json!(["KHR_materials_clearcoat"]));
    let bare = [used, ("/materials/0/extensions", coat), (&with("TANGENT"), json!(null))];
    breaks(&bare, "/meshes/1/primitives/0/material", "'NORMAL' and 'TANGENT'");
    let quantized = ("/extensionsUsed", json!(["KHR_mesh_quantization"]));
    breaks(&[quantized], "/extensionsUsed/0", "'extensionsRequired' too");
}

#[test]
fn morph_targets_match_their_primitives() {
    let target = "/meshes/1/primitives/0/targets/0";
    let with = |name: &str| format!("{target}/{name}");
    breaks(&[(&with("JOINTS_0"), json!(5))], &with("JOINTS_0"), "attribute of a morph target");
    breaks(&[(&with("COLOR_0"), json!(6))], &with("COLOR_0"), "no attribute of this name to morph");
    breaks(&[(&with("NORMAL"), json!(2))], &with("NORMAL"), "VEC2 of FLOAT cannot be used here");
    let short = json!({ "bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3", "min": [0, 0, 0], "max": [1, 0, 0] });
    breaks(&[("/accessors/-", short), (&with("POSITION"), json!(10))], &with("POSITION"), "2 elements stand here, but");
    let second = json!({ "attributes": { "POSITION": 0 } });
    breaks(&[("/meshes/1/primitives/-", second)], "/meshes/1/primitives/1", "0 morph targets stand here");
    breaks(&[("/meshes/1/weights", json!([0, 0]))], "/meshes/1/weights", "2 weights stand here for 1 morph targets");
    breaks(&[("/nodes/2/weights", json!([0, 0]))], "/nodes/2/weights", "2 weights stand here for 1 morph targets");
}

#[test]
fn nodes_form_trees() {
    let lone = |nodes: &[Value]| {
        let mut changes = vec![];
        changes.extend(nodes.iter().map(|node| ("/nodes/-", node.clone())));
        changes
    };
    breaks(&lone(&[json!({ "children": [4] }), json!({ "children": [3] })]), "/nodes/4", "its own descendant");
    breaks(&lone(&[json!({ "children": [3] })]), "/nodes/3", "its own descendant");
    breaks(&lone(&[json!({ "children": [2] })]), "/nodes/3/children/0", "a child of node 1 already");
    breaks(&[("/scenes/-", json!({ "nodes": [2] }))], "/scenes/1/nodes/0", "node 2 is a child of node 1");
    breaks(&[("/nodes/1/rotation", json!([0, 0, 0, 0.5]))], "/nodes/1/rotation", "has length 1, not 0.5000");
    let identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    breaks(&[("/nodes/1/matrix", json!(identity))], "/nodes/1/matrix", "either a matrix or");
    let shear = [1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    breaks(&[("/nodes/2/matrix", json!(shear))], "/nodes/2/matrix", "no product of");
}

#[test]
fn skins_fit_their_nodes() {
    breaks(&[("/nodes/2/skin", json!(0))], "/nodes/2", "no attribute 'JOINTS_0'");
    let apart = [("/nodes/-", json!({})), ("/skins/0/joints", json!([3])), ("/scenes/0/nodes", json!([0, 1]))];
    breaks(&apart, "/nodes/0", "not in the scene of this node");
    let two = [("/nodes/-", json!({})), ("/skins/-", json!({ "joints": [1, 3] }))];
    breaks(&two, "/skins/1/joints", "one root node in common");
    breaks(&[("/skins/0/skeleton", json!(2))], "/skins/0/skeleton", "neither joint 1 nor above it");
    breaks(
        &[("/skins/-", json!({ "joints": [1, 2], "inverseBindMatrices": 7 }))],
        "/skins/1/inverseBindMatrices",
        "too few",
    );
    breaks(
        &[("/skins/-", json!({ "joints": [1], "inverseBindMatrices": 9 }))],
        "/skins/1/inverseBindMatrices",
        "MAT4 of FLOAT",
    );
}

#[test]
fn animations_fit_their_targets() {
    let target = "/animations/0/channels/0/target";
    breaks(&[("/animations/0/channels/0/sampler", json!(3))], "/animations/0/channels/0/sampler", "no samplers[3]");
    let moved = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1];
    breaks(&[("/nodes/1/matrix", json!(moved))], target, "has a matrix");
    breaks(&[(target, json!({ "node": 1, "path": "weights" }))], target, "no morph targets");
    let twice = json!({ "sampler": 0, "target": { "node": 1, "path": "rotation" } });
    breaks(&[("/animations/0/channels/-", twice)], "/animations/0/channels/1/target", "channel 0 of this animation");
    let input = "/animations/0/samplers/0/input";
    breaks(&[("/accessors/4/componentType", json!(5125))], input, "SCALAR of UNSIGNED_INT");
    breaks(&[("/accessors/4/min", json!(null))], input, "holds times and needs 'min' and 'max'");
    let spline = ("/animations/0/samplers/0/interpolation", json!("CUBICSPLINE"));
    breaks(&[spline.clone(), ("/accessors/4/count", json!(1))], input, "at least 2 key frames, not 1");
    let channel = "/animations/0/channels/0/sampler";
    breaks(&[spline], channel, "2 values stand in the output for 6 of 2 key frames");
    breaks(&[("/animations/0/channels/0/target/path", json!("scale"))], channel, "VEC3 of FLOAT can");
    let linear = ("/animations/0/samplers/-", json!({ "input": 4, "output": 8, "interpolation": "CUBICSPLINE" }));
    breaks(&[linear], "/animations/0/samplers/1/output", "splines and values");
    let pointer = |path: &str, pointer: &str| {
        let extension = json!({ "KHR_animation_pointer": { "pointer": pointer } });
        [
            ("/extensionsUsed", json!(["KHR_animation_pointer"])),
            (target, json!({ "node": 1, "path": path, "extensions": extension })),
        ]
    };
    let place = format!("{target}/extensions/KHR_animation_pointer");
    breaks(&pointer("pointer", "/nodes/0/scale"), &place, "no 'node'");
    breaks(&pointer("scale", "/nodes/0/scale"), &place, "the path 'pointer'");
    breaks(&pointer("pointer", "nodes/0"), &format!("{place}/pointer"), "begins with '/'");
}

#[test]
fn single_objects_are_consistent() {
    breaks(&[("/asset/minVersion", json!("2.1"))], "/asset/minVersion", "2.1 is more than the version 2.0");
    let required = ("/extensionsRequired", json!(["KHR_materials_ior"]));
    breaks(&[required], "/extensionsRequired/0", "'extensionsUsed' must have it too");
    breaks(&[("/cameras/1/orthographic/xmag", json!(0))], "/cameras/1/orthographic/xmag", "not be zero");
    breaks(&[("/cameras/0/perspective/zfar", json!(0.05))], "/cameras/0/perspective", "zfar 0.05 must be more");
    breaks(&[("/cameras/1/type", json!("perspective"))], "/cameras/1", "type 'perspective' needs 'perspective'");
    let lamp = |light: Value| {
        [
            ("/extensionsUsed", json!(["KHR_lights_punctual"])),
            ("/extensions", json!({ "KHR_lights_punctual": { "lights": [light] } })),
        ]
    };
    let place = "/extensions/KHR_lights_punctual/lights/0";
    breaks(&lamp(json!({ "type": "spot" })), place, "'spot' is missing");
    let narrow = json!({ "type": "spot", "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.1 } });
    breaks(&lamp(narrow), &format!("{place}/spot/outerConeAngle"), "more than the inner one");
    let variants = [
        ("/extensionsUsed", json!(["KHR_materials_variants"])),
        ("/extensions", json!({ "KHR_materials_variants": { "variants": [{ "name": "a" }] } })),
        (
            "/meshes/1/primitives/0/extensions",
            json!({ "KHR_materials_variants": { "mappings": [{ "variants": [0], "material": 0 }, { "variants": [0], "material": 0 }] } }),
        ),
    ];
    let place = "/meshes/1/primitives/0/extensions/KHR_materials_variants/mappings/1/variants/0";
    breaks(&variants, place, "variant 0 has a material already");
    breaks(&[("/images/0/mimeType", json!("image/webp"))], "/images/0", "needs the extension 'EXT_texture_webp'");
    breaks(&[("/images/0/mimeType", json!("image/webp"))], "/textures/0/source", "'image/png' or 'image/jpeg'");
}

/// Large documents without deep trees or bounds are checked in linear time.
#[test]
fn large_documents_are_judged() {
    let count = 200_000;
    let nodes: Vec<Value> = (0..count).map(|k| json!({ "children": [(k + 1) % count] })).collect();
    let all = messages(&[
        ("/nodes", json!(nodes)),
        ("/scenes/0/nodes", json!([0])),
        ("/skins", json!(null)),
        ("/animations", json!(null)),
    ]);
    assert!(all.iter().any(|m| m.contains("199995 more places like /nodes/0")), "{all:#?}");
}

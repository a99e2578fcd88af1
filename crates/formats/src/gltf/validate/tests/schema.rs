//! Rules of the schema.

use super::{breaks, json, messages};

#[test]
fn values_have_their_types() {
    breaks(&[("/asset/generator", json!(1))], "/asset/generator", "text is expected, not 1");
    breaks(&[("/accessors/0/normalized", json!(0))], "/accessors/0/normalized", "true or false");
    breaks(&[("/accessors/0/min", json!(0))], "/accessors/0/min", "an array is expected");
    breaks(&[("/materials/0/extensions", json!([]))], "/materials/0/extensions", "an object is expected");
    breaks(&[("/cameras/0/perspective/aspectRatio", json!("4:3"))], "/cameras/0/perspective/aspectRatio", "a number");
    // Items of arrays.
    breaks(&[("/accessors/0/max/1", json!("x"))], "/accessors/0/max/1", "a number is expected, not \"x\"");
    breaks(&[("/textures/-", json!(7))], "/textures/1", "an object is expected, not 7");
    // Indices.
    breaks(&[("/skins/0/skeleton", json!(-1))], "/skins/0/skeleton", "a whole number that is not negative");
    breaks(&[("/skins/0/skeleton", json!("a"))], "/skins/0/skeleton", "a whole number");
    breaks(&[("/bufferViews/1/byteOffset", json!(36.0))], "/bufferViews/1/byteOffset", "without a fraction");
}

#[test]
fn values_are_in_their_ranges() {
    breaks(&[("/accessors/0/count", json!(0))], "/accessors/0/count", "0 is less than 1");
    breaks(&[("/bufferViews/0/byteStride", json!(256))], "/bufferViews/0/byteStride", "256 is more than 252");
    breaks(&[("/bufferViews/0/byteStride", json!(14))], "/bufferViews/0/byteStride", "not a multiple of 4");
    breaks(&[("/materials/0/emissiveFactor", json!([0, 2, 0]))], "/materials/0/emissiveFactor/1", "outside of 0 to 1");
    breaks(&[("/cameras/1/orthographic/znear", json!(-1))], "/cameras/1/orthographic/znear", "less than 0");
    breaks(&[("/cameras/1/orthographic/zfar", json!(0))], "/cameras/1/orthographic/zfar", "not more than 0");
    breaks(&[("/bufferViews/0/byteOffset", json!(-4))], "/bufferViews/0/byteOffset", "negative");
    // Lists of words and codes.
    breaks(&[("/materials/0/alphaMode", json!("GLASS"))], "/materials/0/alphaMode", "not one of 'OPAQUE', 'MASK'");
    breaks(&[("/bufferViews/0/target", json!(1))], "/bufferViews/0/target", "1 is not one of 34962, 34963");
    breaks(&[("/samplers/0/minFilter", json!(1))], "/samplers/0/minFilter", "1 is not one of");
    breaks(&[("/asset/minVersion", json!("2"))], "/asset/minVersion", "a version such as \"2.0\"");
}

#[test]
fn arrays_and_objects_have_their_members() {
    breaks(
        &[("/accessors/1/min", json!([0, 0, 0, 0, 0]))],
        "/accessors/1/min",
        "5 values stand here instead of 1 or 2",
    );
    breaks(&[("/scenes/0/nodes", json!([0, 1, 1]))], "/scenes/0/nodes/2", "1 stands more than once");
    breaks(&[("/extensionsUsed", json!([]))], "/extensionsUsed", "must not be empty");
    breaks(&[("/meshes/1/primitives/0/targets/0", json!({}))], "/meshes/1/primitives/0/targets/0", "not be empty");
    breaks(&[("/animations/0/samplers/0/input", json!(null))], "/animations/0/samplers/0", "'input' is missing");
    breaks(&[("/cameras/0/orthographic", json!({}))], "/cameras/0", "exactly one of 'orthographic' and 'perspective'");
    breaks(&[("/images/0/bufferView", json!(7))], "/images/0", "exactly one of 'uri' and 'bufferView'");
    let sparse = json!({ "componentType": 5126, "count": 3, "type": "VEC3", "byteOffset": 0 });
    breaks(&[("/accessors/1", sparse)], "/accessors/1/byteOffset", "needs 'bufferView'");
    breaks(&[("/nodes/2/mesh", json!(null)), ("/nodes/2/weights", json!([1]))], "/nodes/2/weights", "needs 'mesh'");
}

#[test]
fn uris_are_well_formed() {
    for (uri, why) in [
        ("a%zz.png", "hexadecimal"),
        ("1:a.png", "a colon follows a scheme"),
        ("data:image/png;base64", "no comma"),
        ("data:image/png;;base64,AAAA", "no media type"),
        ("data:image/png;base64,a!bc", "not base64"),
        ("data:image/png;base64,abcde", "cut off"),
    ] {
        breaks(
            &[("/materials/0/pbrMetallicRoughness", json!(null)), ("/images/0/uri", json!(uri))],
            "/images/0/uri",
            why,
        );
    }
}

#[test]
fn extensions_are_declared_and_stand_where_they_belong() {
    let unlit = json!({ "KHR_materials_unlit": {} });
    let place = "/materials/0/extensions/KHR_materials_unlit";
    breaks(&[("/materials/0/extensions", unlit.clone())], place, "not declared in 'extensionsUsed'");
    let used = ("/extensionsUsed", json!(["KHR_materials_unlit", "KHR_materials_ior"]));
    assert_eq!(messages(&[used.clone(), ("/materials/0/extensions", unlit.clone())]), [""; 0]);
    breaks(
        &[used.clone(), ("/nodes/1/extensions", unlit)],
        "/nodes/1/extensions/KHR_materials_unlit",
        "does not belong",
    );
    let ior = ("/materials/0/extensions", json!({ "KHR_materials_ior": { "ior": "glass" } }));
    breaks(&[used, ior], "/materials/0/extensions/KHR_materials_ior/ior", "a number is expected");
    breaks(&[("/nodes/1/extensions", json!({ "VND_x": 1 }))], "/nodes/1/extensions/VND_x", "an object is expected");
}

#[test]
fn references_lead_somewhere() {
    for (pointer, value, of) in [
        ("/scene", json!(3), "scenes[3]"),
        ("/scenes/-", json!({ "nodes": [9] }), "nodes[9]"),
        ("/skins/0/skeleton", json!(9), "nodes[9]"),
        ("/bufferViews/8/buffer", json!(2), "buffers[2]"),
        ("/textures/0/source", json!(2), "images[2]"),
        ("/animations/0/samplers/0/output", json!(99), "accessors[99]"),
    ] {
        let place = if pointer == "/scenes/-" { "/scenes/1/nodes/0" } else { pointer };
        breaks(&[(pointer, value)], place, &format!("there is no {of}"));
    }
}

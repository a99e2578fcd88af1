//! Small documents with a known meaning, the shared assets, and mutants of both.

use super::{framed_box, import};
use crate::{Import, Options};
use base64::{Engine as _, prelude::BASE64_STANDARD};
use steradian_math::DVec3;
use steradian_scene::{Animation, Fidelity, SpectrumValue, Value};

/// Floats as a data URI.
pub(super) fn data(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes))
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A document of one triangle, with members added to the root, the node, the primitive and the material.
fn triangle(root: &str, node: &str, primitive: &str, material: &str) -> String {
    let buffer = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    format!(
        r#"{{
  "asset": {{ "version": "2.0" }},
  "buffers": [{{ "byteLength": 36, "uri": "{}" }}],
  "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}],
  "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] }}],
  "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }}, "material": 0 {primitive} }}] }}],
  "materials": [{{ "name": "paint" {material} }}],
  "nodes": [{{ "mesh": 0 {node} }}]
  {root}
}}"#,
        data(&buffer)
    )
}

fn read_with(text: impl AsRef<[u8]>, defines: &[(&str, &str)]) -> Import {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let defines = defines.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
    import(&path, &Options { defines, ..Options::default() })
}

fn read(text: impl AsRef<[u8]>) -> Import {
    read_with(text, &[])
}

fn sound(text: impl AsRef<[u8]>) -> Import {
    let import = read(text);
    let messages: Vec<_> = import.diagnostics.iter().map(ToString::to_string).collect();
    assert!(!import.diagnostics.has_errors(), "{messages:#?}");
    import
}

/// The errors, each with its place.
fn faults(text: impl AsRef<[u8]>) -> Vec<String> {
    let import = read(text);
    assert!(import.diagnostics.has_errors());
    import.diagnostics.iter().map(ToString::to_string).collect()
}

#[test]
fn a_triangle_is_placed_framed_and_lit() {
    let desc = sound(triangle("", r#", "translation": [1, 2, 3], "scale": [2, 2, 2]"#, "", "")).desc;
    assert_eq!((desc.shapes.len(), desc.cameras.len(), desc.lights.len()), (2, 1, 1), "with a ground and a sky");
    assert_eq!(desc.meshes[0].triangles, [[0, 1, 2]]);
    let p = desc.shapes[0].world_from_object.matrix.transform_point3(DVec3::new(1.0, 0.0, 0.0));
    assert!((p - DVec3::new(3.0, 2.0, 3.0)).length() < 1e-12);
    let material = desc.node(desc.shapes[0].material.unwrap());
    assert_eq!((material.kind.as_str(), material.name.as_deref()), ("metallic_roughness", Some("paint")));
    assert_eq!((material.float("metallic"), material.float("roughness")), (Some(1.0), Some(1.0)));
}

#[test]
fn materials_and_their_extensions_arrive() {
    let material = r#", "pbrMetallicRoughness": { "baseColorFactor": [0.2, 0.4, 0.6, 0.5], "metallicFactor": 0.3, "roughnessFactor": 0.7 },
        "emissiveFactor": [1, 0.5, 0], "alphaMode": "BLEND", "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 4 }, "KHR_materials_ior": { "ior": 1.33 },
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 1, 1] },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.9, "clearcoatRoughnessFactor": 0.1 },
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": 1.5707963267948966 } }"#;
    let desc = sound(triangle("", "", "", material)).desc;
    let shape = &desc.shapes[0];
    let mask = desc.node(shape.material.unwrap());
    assert_eq!((mask.kind.as_str(), mask.float("opacity")), ("mask", Some(0.5)));
    let m = desc.node(mask.node("material").unwrap());
    let numbers = ["metallic", "roughness", "eta", "transmission", "clearcoat", "clearcoat_roughness", "anisotropy"];
    assert_eq!(numbers.map(|n| m.float(n).unwrap()), [0.3, 0.7, 1.33, 1.0, 0.9, 0.1, 0.5]);
    assert!((m.float("anisotropy_rotation").unwrap() - 90.0).abs() < 1e-9);
    assert_eq!(m.bool("thin"), Some(false));
    let medium = desc.node(shape.interior.unwrap());
    let Some(Value::Spectrum(SpectrumValue::Rgb(sigma, _))) = medium.get("sigma_a") else { panic!() };
    // σ = −ln(c)/d; a component of one keeps its light up to rounding of the least colour.
    assert!((sigma[0] - 0.5f64.ln().abs() / 2.0).abs() < 1e-12 && sigma[1].abs() < 1e-12);
    let light = desc.node(shape.emission.unwrap());
    assert_eq!(light.get("radiance"), Some(&Value::Spectrum(SpectrumValue::Rgb([4.0, 2.0, 0.0], Default::default()))));
    // It is a lamp: no sky is added.
    assert!(desc.lights.is_empty());
}

/// Coats have their own normals, also where the base alone has a map; directions of grooves keep red and green.
#[test]
fn coats_have_normals_of_their_own_and_grooves_directions() {
    let pixel = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
    let root =
        format!(r#", "images": [{{ "uri": "data:image/png;base64,{pixel}" }}], "textures": [{{ "source": 0 }}]"#);
    let of = |material: &str| {
        let desc = sound(triangle(&root, "", "", material)).desc;
        let id = desc.shapes[0].material.unwrap();
        (desc, id)
    };
    let coat = r#""KHR_materials_clearcoat": {
        "clearcoatFactor": 1, "clearcoatNormalTexture": { "index": 0, "scale": 0.5 } }"#;
    let grooves = r#""KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyTexture": { "index": 0 } }"#;
    let (desc, id) = of(&format!(r#", "extensions": {{ {coat}, {grooves} }}"#));
    let node = desc.node(id);
    let map = desc.node(node.node("coat_normal_map").unwrap());
    assert_eq!((map.bool("raw"), map.string("channel")), (Some(true), Some("color")));
    assert_eq!((node.float("coat_normal_map_strength"), node.get("normal_map")), (Some(0.5), None));
    let directions = desc.node(node.node("anisotropy_direction").unwrap());
    assert_eq!((directions.bool("raw"), directions.string("channel")), (Some(true), Some("color")));
    // Written and read again they are the same.
    let written = crate::write::write(&desc, std::path::Path::new("a.glb")).unwrap();
    let again = sound(&written.bytes).desc;
    let back = again.node(again.shapes[0].material.unwrap());
    let numbers = |n: &steradian_scene::Node| ["coat_normal_map_strength", "clearcoat"].map(|name| n.float(name));
    assert_eq!((numbers(back), numbers(node)), ([Some(0.5), Some(1.0)], [Some(0.5), Some(1.0)]));
    for name in ["coat_normal_map", "anisotropy_direction"] {
        let [was, is] = [(&desc, node), (&again, back)].map(|(d, n)| d.node(n.node(name).unwrap()).string("channel"));
        assert_eq!((was, is), (Some("color"), Some("color")), "{name}");
    }
    let base =
        r#", "normalTexture": { "index": 0 }, "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 1 } }"#;
    let (desc, id) = of(base);
    assert_eq!((desc.node(id).string("coat_normals"), desc.node(id).get("coat_normal_map")), (Some("own"), None));
}

#[test]
fn strips_fans_and_morph_targets() {
    let strip = triangle("", "", r#", "mode": 5"#, "");
    assert_eq!(sound(strip).desc.meshes[0].triangles, [[0, 1, 2]]);
    let fan = triangle("", "", r#", "mode": 6"#, "");
    assert_eq!(sound(fan).desc.meshes[0].triangles, [[1, 2, 0]]);
    let lines = sound(triangle("", "", r#", "mode": 2"#, "")).desc;
    assert_eq!(lines.shapes.len(), 4, "with a ground");
    assert!(lines.shapes[..3].iter().all(|s| lines.node(s.node).kind == "cylinder"));
    let points = sound(triangle("", "", r#", "mode": 0"#, "")).desc;
    assert!(points.shapes[..3].iter().all(|s| points.node(s.node).kind == "sphere"));
    let morphed = triangle("", r#", "weights": [0.5]"#, r#", "targets": [{ "POSITION": 0 }]"#, "");
    assert_eq!(sound(morphed).desc.meshes[0].positions[1], [1.5, 0.0, 0.0]);
}

#[test]
fn cameras_look_along_minus_z_and_lights_too() {
    let root = r#", "cameras": [{ "type": "perspective", "perspective": { "yfov": 1, "aspectRatio": 2 } }],
        "scenes": [{ "nodes": [0, 1] }],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional", "intensity": 3, "color": [1, 0.5, 0] }] } }"#;
    let text = triangle(root, "", "", "").replace(
        r#""nodes": [{ "mesh": 0  }]"#,
        r#""nodes": [{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 5], "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476],
            "extensions": { "KHR_lights_punctual": { "light": 0 } } }]"#,
    );
    let desc = sound(text.clone()).desc;
    let camera = desc.node(desc.cameras[0]);
    let forward = camera.transform("to_world").unwrap().matrix.transform_vector3(DVec3::Z);
    // A quarter turn about y takes −z to −x.
    assert!((forward - DVec3::NEG_X).length() < 1e-9, "{forward}");
    assert!((camera.float("fov").unwrap() - 1f64.to_degrees()).abs() < 1e-12);
    let film = desc.node(desc.film.unwrap());
    assert_eq!((film.int("width"), film.int("height")), (Some(1536), Some(768)));
    let light = desc.node(desc.lights[0]);
    assert!((DVec3::from(light.vec3("direction").unwrap()) - DVec3::NEG_X).length() < 1e-9);
    // Shadows get a little light from all sides, of a share of the lamp's, unless there is to be none, and in files of
    // our own.
    let dim = desc.node(desc.lights[1]);
    let radiance = dim.float("radiance").unwrap();
    assert!(dim.kind == "environment" && (0.02..0.04).contains(&radiance), "{dim:?}");
    assert_eq!(desc.lights.len(), 2);
    assert_eq!(read_with(&text, &[("sky", "none")]).desc.lights.len(), 1);
    let own = text.replace(r#""version": "2.0""#, r#""version": "2.0", "generator": "Steradian""#);
    assert!(own != text && sound(own).desc.lights.len() == 1);
}

#[test]
fn animations_pose_the_scene() {
    let mut buffer = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    buffer.extend(floats(&[0.0, 2.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0]));
    let text = format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "buffers": [{{ "byteLength": 68, "uri": "{}" }}],
        "bufferViews": [{{ "buffer": 0, "byteLength": 68 }}],
        "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }},
            {{ "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 2, "type": "SCALAR" }},
            {{ "bufferView": 0, "byteOffset": 44, "componentType": 5126, "count": 2, "type": "VEC3" }}],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}] }}], "nodes": [{{ "mesh": 0 }}],
        "animations": [{{ "name": "slide", "channels": [{{ "sampler": 0, "target": {{ "node": 0, "path": "translation" }} }}],
            "samplers": [{{ "input": 1, "output": 2 }}] }}] }}"#,
        data(&buffer)
    );
    let x = |defines: &[(&str, &str)]| {
        let import = read_with(&text, defines);
        assert!(!import.diagnostics.has_errors());
        import.desc.shapes[0].world_from_object.matrix.w_axis.x
    };
    assert_eq!(x(&[]), 0.0);
    assert!((x(&[("at", "0.5s")]) - 2.5).abs() < 1e-6);
    assert!((x(&[("at", "9"), ("animation", "slide")]) - 10.0).abs() < 1e-6);
    assert!(read_with(&text, &[("at", "1"), ("animation", "jump")]).diagnostics.has_errors());
    let animations = read_with(&text, &[]).desc.animations;
    assert_eq!(animations, [Animation { name: Some("slide".into()), times: [0.0, 2.0], channels: 1 }]);
    // The box of all moments, by which the camera stands still.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slide.gltf");
    std::fs::write(&path, &text).unwrap();
    let framed = |at: &str| {
        let defines = [("at".to_owned(), at.to_owned())].into();
        framed_box(&path, &Options { defines, ..Options::default() }).unwrap()
    };
    assert_eq!(framed("1"), [DVec3::new(5.0, 0.0, 0.0), DVec3::new(6.0, 1.0, 0.0)]);
    let whole = [framed("0")[0], framed("2")[1]];
    let camera = |at: &str, framing| {
        let defines = [("at".to_owned(), at.to_owned())].into();
        let desc = import(&path, &Options { defines, framing, ..Options::default() }).desc;
        desc.node(desc.cameras[0]).transform("to_world").unwrap()
    };
    assert_ne!(camera("0", None), camera("2", None));
    assert_eq!(camera("0", Some(whole)), camera("2", Some(whole)));
    // With a shutter that is open for half a second it moves.
    let moving = read_with(&text, &[("at", "0.5"), ("shutter", "0.5s")]).desc;
    let instance = &moving.instances[0];
    let [start, end] = [instance.world_from_group, instance.movement.unwrap().end].map(|t| t.matrix.w_axis.x);
    assert!((start - 2.5).abs() < 1e-6 && (end - 5.0).abs() < 1e-6, "{start} {end}");
    assert!(read_with(&text, &[("shutter", "1")]).diagnostics.has_errors());
    assert!(read_with(&text, &[("at", "1"), ("shutter", "long")]).diagnostics.has_errors());
}

#[test]
fn faults_are_placed() {
    let text = triangle("", "", "", r#", "pbrMetallicRoughness": { "baseColorTexture": { "index": 7 } }"#);
    let message = &faults(text)[0];
    assert!(
        message.contains("/materials/0/pbrMetallicRoughness/baseColorTexture/index: there is no textures[7]"),
        "{message}"
    );
    assert!(message.contains("a.gltf:7:"), "{message}");
    let first = |text: String| faults(text)[0].clone();
    let message = first(triangle(r#", "extensionsRequired": ["KHR_lights_punctal"]"#, "", "", ""));
    assert!(message.contains("did you mean 'KHR_lights_punctual'?"), "{message}");
    assert!(first(triangle(r#", "extensionsRequired": ["EXT_texture_avif"]"#, "", "", "")).contains("not implemented"));
    assert!(first(triangle("", "", r#", "indices": 0"#, "")).contains("unsigned integers"));
    assert!(
        first(
            triangle("", r#", "children": [0]"#, "", "")
                .replace("\"nodes\": [{", "\"scene\": 0, \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{")
        )
        .contains("met twice")
    );
    assert!(first(triangle("", "", "", "").replace("\"count\": 3", "\"count\": 4000000000000")).contains("do not fit"));
    assert!(first(triangle("", "", "", "").replace("\"2.0\"", "\"1.0\"")).contains("version 1.0"));
    assert!(
        first(triangle("", "", "", "").replace("\"byteLength\": 36, \"uri\"", "\"byteLength\": 37, \"uri\""))
            .contains("36 of the 37")
    );
    let message = first("{ \"asset\": { \"version\": \"2.0\" }, \n \"nodes\": [ }".into());
    assert!(message.contains("not JSON") && message.contains("a.gltf:2:"), "{message}");
    assert!(first("{}".into()).contains("not glTF"));
    let escaping = triangle("", "", "", "").replace("data:application", "../../etc/passwd?x=data:application");
    assert!(first(escaping).contains("leads out of the folder"));
}

#[test]
fn losses_are_told() {
    let losses = |text: String| -> Vec<(Option<Fidelity>, String)> {
        sound(text).diagnostics.iter().map(|d| (d.fidelity, d.message.clone())).collect()
    };
    let used = losses(triangle(r#", "extensionsUsed": ["EXT_texture_avif", "VND_none"]"#, "", "", ""));
    assert!(used.iter().all(|l| l.0 == Some(Fidelity::Dropped)) && used.len() == 2, "{used:?}");
    let wide = losses(triangle("", "", "", r#", "pbrMetallicRoughness": { "roughnessFactor": 1.5 }"#));
    assert!(wide[0].1.contains("outside of 0 to 1"), "{wide:?}");
}

/// Planes of cameras are followed; textures that tracing makes needless are told.
#[test]
fn planes_of_cameras_are_followed_and_needless_textures_told() {
    let camera = |lens: &str| {
        let root = format!(r#", "cameras": [{{ "type": {lens} }}]"#);
        let desc = sound(triangle(&root, r#", "camera": 0"#, "", "")).desc;
        let camera = desc.node(desc.cameras[0]);
        (camera.float("near"), camera.float("far"))
    };
    let perspective = camera(r#""perspective", "perspective": { "yfov": 1, "znear": 0.5, "zfar": 7 }"#);
    assert_eq!(perspective, (Some(0.5), Some(7.0)));
    let endless = camera(r#""perspective", "perspective": { "yfov": 1, "znear": 0.5 }"#);
    assert_eq!(endless, (Some(0.5), None));
    let orthographic = camera(r#""orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 9 }"#);
    assert_eq!(orthographic, (Some(0.0), Some(9.0)));

    let textures = r#", "extensionsUsed": ["KHR_materials_volume"], "textures": [{ "source": 0 }],
        "images": [{ "mimeType": "image/png", "uri": "data:image/png;base64,iVBORw0KGgo=" }]"#;
    for (material, pointer) in [
        (r#", "occlusionTexture": { "index": 0, "strength": 0.5 }"#, "/materials/0/occlusionTexture"),
        (
            r#", "extensions": { "KHR_materials_volume": { "thicknessTexture": { "index": 0 } } }"#,
            "/materials/0/extensions/KHR_materials_volume/thicknessTexture",
        ),
    ] {
        let import = sound(triangle(textures, "", "", material));
        let said: Vec<String> = import.diagnostics.iter().map(|d| format!("{}: {}", d.kind(), d.message)).collect();
        let note = format!("note: {pointer}: this texture has no effect");
        assert_eq!(said.iter().filter(|s| s.starts_with(&note)).count(), 1, "{said:?}");
    }
}

#[test]
fn packed_pictures_are_used_where_there_is_no_other() {
    for (extension, kind) in [("EXT_texture_webp", "webp"), ("KHR_texture_basisu", "ktx2")] {
        let file = |texture: &str| {
            let root = format!(
                r#", "extensionsUsed": ["{extension}"],
                "textures": [{{ {texture} "extensions": {{ "{extension}": {{ "source": 1 }} }} }}],
                "images": [{{ "mimeType": "image/png", "uri": "data:image/png;base64,AAAA" }},
                    {{ "mimeType": "image/{kind}", "uri": "data:image/{kind};base64,AAAA" }}]"#
            );
            let material = r#", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } }"#;
            let desc = sound(triangle(&root, "", "", material)).desc;
            desc.embedded.keys().map(|path| path.display().to_string()).collect::<Vec<_>>()
        };
        assert!(file("")[0].ends_with("a.gltf#/images/1"));
        assert!(file("\"source\": 0,")[0].ends_with("a.gltf#/images/0"));
    }
}

/// Every file of the assets is read; those that need what is not implemented say so.
#[test]
fn the_assets_are_read() {
    let Some(root) = crate::mesh::test_files::assets() else { return };
    let mut count = 0;
    let mut folders = vec![root.join("gltf")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            if !path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
                continue;
            }
            // Whatever a file is called: glTF begins like this.
            let begin = std::fs::read(&path).unwrap();
            if !begin.starts_with(b"glTF") && !begin.trim_ascii_start().starts_with(b"{") {
                continue;
            }
            count += 1;
            let import = import(&path, &Options::default());
            let errors: Vec<_> =
                import.diagnostics.iter().map(ToString::to_string).filter(|m| m.starts_with("error")).collect();
            assert!(errors.iter().all(|e| e.contains("not implemented")), "{}: {errors:#?}", path.display());
        }
    }
    assert!(count > 30, "{count}");
}

#[test]
fn mutants_do_not_panic() {
    let material = r#", "normalTexture": { "index": 0 }, "alphaMode": "MASK", "extensions": { "KHR_materials_volume": { "thicknessFactor": 1 } }"#;
    let text = triangle(
        r#", "scenes": [{ "nodes": [0] }], "skins": [{ "joints": [0] }]"#,
        r#", "rotation": [0, 0, 0, 1], "weights": [1]"#,
        r#", "targets": [{ "POSITION": 0 }], "mode": 4"#,
        material,
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.gltf");
    crate::mesh::test_files::mutants(text.as_bytes(), 3_000, |bytes| {
        std::fs::write(&path, bytes).unwrap();
        let _ = import(&path, &Options::default());
    });
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    let json = text.replace(char::is_whitespace, "");
    glb.extend(((json.len() + 20) as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json.as_bytes());
    crate::mesh::test_files::mutants(&glb, 1_000, |bytes| {
        std::fs::write(&path, bytes).unwrap();
        let _ = import(&path, &Options::default());
    });
}

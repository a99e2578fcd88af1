//! glTF documents and scenes in Steradian's own language: faults of the text, and numbers that no scene should hold.

use crate::case::{Case, Expect, POISON};
use Expect::{Either, Picture, Refused, Warned};

/// A glTF document of a triangle, with places where numbers are poisoned.
const GLTF: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
"extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": @5}]}},
"nodes": [{"mesh": 0, "translation": [@0, 0, 0], "rotation": [0, 0, @0, 1], "scale": [1, @1, 1]},
 {"camera": 0, "translation": [0, 0, @3]}, {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 2, 2]}],
"cameras": [{"type": "perspective", "perspective": {"yfov": @0.7, "znear": @0.1, "aspectRatio": @1}}],
"materials": [{"pbrMetallicRoughness": {"baseColorFactor": [@0.5, 1, 1, 1], "roughnessFactor": @0.5}, "emissiveFactor": [0, @0.5, 0],
 "alphaCutoff": @0.5, "alphaMode": "MASK", "extensions": {"KHR_materials_ior": {"ior": @1.5}}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": @0}, "indices": 1, "material": @0, "mode": @4}]}],
"accessors": [{"bufferView": @0, "byteOffset": @0, "componentType": @5126, "count": @3, "type": "VEC3"},
 {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
"bufferViews": [{"buffer": @0, "byteLength": @36, "byteOffset": @0, "byteStride": @12}, {"buffer": 0, "byteOffset": 36, "byteLength": @6}],
"buffers": [{"byteLength": @42, "uri": "data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]}"#;

/// A scene in Steradian's own language, with such places.
const OWN: &str = "steradian: @1
film: {film: rgb, width: 16, height: 16}
materials: {m: {material: conductor, eta: {rgb: [@0.2, 1, 1]}, k: {wavelengths: [400, 700], values: [3, @2]}, alpha_u: @0.3}}
media: {fog: {medium: homogeneous, sigma_s: @0.1, phase: {phase: hg, g: @0.2}}}
meshes: {t: {positions: [@0 0 1  1 0 1  0 1 1], triangles: [0 1 @2], uvs: [0 0 1 @0 0 1]}}
camera: {camera: perspective, fov: @40, to_world: {look_at: [0 0 @0], from: [0 0 -5]}}
lights: [{light: environment, radiance: {blackbody: @5000}}, {light: point, position: [0 @3 0], intensity: @4}]
shapes: [{shape: sphere, radius: @1, material: m, interior: fog, exterior: null, to_world: [{scale: @1}, {rotate: [0 @1 0], degrees: @9}]}
 {shape: mesh, mesh: t, emission: {light: area, radiance: @2}}]
groups: {g: [{shape: disk, radius: @1, height: 0, material: @m}]}
instances: [{group: g, to_world: {matrix: [1 0 0 @0  0 1 0 0  0 0 1 0  0 0 0 @1]}}]
";

/// A text with the number of one place after the other replaced; `@name` is no place.
fn poisoned(file: &'static str, template: &'static str) -> impl Iterator<Item = Case> {
    let place = |(at, _): &(usize, &str)| template.as_bytes().get(at + 1).is_some_and(u8::is_ascii_digit);
    let places: Vec<usize> = template.match_indices('@').filter(place).map(|(at, _)| at).collect();
    let sound = move |text: &str| {
        let mut out = String::new();
        let mut rest = text;
        while let Some(at) = rest.find('@') {
            let is_place = rest.as_bytes().get(at + 1).is_some_and(u8::is_ascii_digit);
            out += &rest[..at + usize::from(!is_place)];
            rest = &rest[at + 1..];
        }
        out + rest
    };
    let first = Case::new(format!("{file} as it is"), file, sound(template), Picture);
    let poisoned = places.into_iter().flat_map(move |at| {
        let end =
            template[at + 1..].find(|c: char| !c.is_ascii_digit() && c != '.').map_or(template.len(), |n| at + 1 + n);
        POISON.iter().map(move |number| {
            let text = format!("{}{number}{}", sound(&template[..at]), sound(&template[end..]));
            Case::new(format!("{file} with {number} at {at}"), file, text, Expect::of_number(number))
        })
    });
    std::iter::once(first).chain(poisoned).map(|mut case| {
        case.small = true;
        case
    })
}

/// glTF.
pub fn gltf() -> impl Iterator<Item = Case> {
    let c = |name: &str, text: &str, expect| Case::new(name, "s.gltf", text, expect);
    let with = |entry: &str| format!("{{\"asset\": {{\"version\": \"2.0\"}}, {entry}}}");
    let mut faults = vec![
        c("empty", "", Refused("")),
        c("a list", "[]", Refused("")),
        c("another version", "{\"asset\": {\"version\": \"3.0\"}}", Refused("version")),
        c("deep", &"[".repeat(1 << 20), Refused("")),
        c(
            "node that is its own child",
            &with("\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"children\": [0]}]"),
            Refused(""),
        ),
        c("unknown required extension", &with("\"extensionsRequired\": [\"XYZ_none\"]"), Refused("XYZ_none")),
        c("buffer far away", &with("\"buffers\": [{\"byteLength\": 4, \"uri\": \"../../../etc/passwd\"}]"), Either),
    ];
    faults.push(Case::new(
        "a head of a .glb and no more",
        "s.glb",
        &b"glTF\x02\0\0\0\xff\xff\xff\xff"[..],
        Refused(""),
    ));
    faults.into_iter().chain(poisoned("s.gltf", GLTF))
}

/// Steradian's own language.
pub fn own() -> impl Iterator<Item = Case> {
    let c = |name: &str, text: &str, expect| Case::new(name, "s.steradian", text, expect);
    let scene = |entry: &str| {
        format!("steradian: 1\nfilm: {{film: rgb, width: 8, height: 8}}\ncamera: {{camera: perspective}}\n{entry}")
    };
    let faults = vec![
        c("empty", "", Refused("empty")),
        c("zeros", &"\0".repeat(4096), Refused("")),
        c("deep", &format!("steradian: 1 shapes: {}", "[".repeat(1 << 20)), Refused("nested")),
        c("unknown kind", &scene("shapes: [{shape: spere}]"), Refused("sphere")),
        c(
            "unknown material",
            &scene("materials: {a: {material: difuse}} shapes: [{shape: sphere, material: a}]"),
            Either,
        ),
        c("unknown parameter", &scene("lights: [{light: environment, scael: 2}]"), Warned("did you mean 'scale'")),
        c("node of itself", &scene("materials: {a: {material: two_sided, front: @a}}"), Refused("no node 'a' above")),
        c("wrong family", &scene("shapes: [{shape: sphere, material: {light: point}}]"), Refused("expected here, not")),
        c("mesh without a mesh", &scene("shapes: [{shape: mesh}]"), Refused("")),
        c("film that is a camera", &scene("filter: {camera: perspective}"), Refused("pixel filter")),
        c("node that begins with a value", &scene("shapes: [{rgb: [1, 1, 1]}]"), Refused("no family")),
        c(
            "huge film",
            "steradian: 1\nfilm: {film: rgb, width: 4294967296, height: 8}\ncamera: {camera: perspective}",
            Refused(""),
        ),
    ];
    faults.into_iter().chain(poisoned("s.steradian", OWN))
}

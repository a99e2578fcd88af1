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

/// A stage with such places.
const USD: &str = r#"#usda 1.0
(
    upAxis = "Z"
    timeCodesPerSecond = @24
    startTimeCode = @1
)
def Xform "W" {
    double3 xformOp:translate.timeSamples = { 1: (0, @0, 0), 5: (1, 0, 0) }
    float3 xformOp:rotateXYZ = (0, 0, @10)
    quatf xformOp:orient = (1, 0, @0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:orient"]
    def Camera "C" {
        float focalLength = @35
        float horizontalAperture = @20
        float fStop = @2
        float focusDistance = @4
        float2 clippingRange = (@1, 100)
        double3 xformOp:translate = (0, -5, 0)
        double xformOp:rotateX = 90
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
    }
    def Mesh "M" {
        int[] faceVertexCounts = [@3, 3]
        int[] faceVertexIndices = [0, 1, @2, 0, 2, 3]
        point3f[] points = [(@0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
        texCoord2f[] primvars:st = [(@0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
        rel material:binding = </W/L>
        def GeomSubset "S" {
            uniform token familyName = "materialBind"
            int[] indices = [@1]
        }
    }
    def Material "L" {
        token outputs:surface.connect = </W/L/P.outputs:surface>
        def Shader "P" {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (@1, 0, 0)
            color3f inputs:emissiveColor = (0, @0, 0)
            float inputs:roughness = @0.5
            float inputs:ior = @1.5
            float inputs:opacity = @0.5
            float inputs:opacityThreshold = @0
        }
    }
    def Cone "K" {
        double radius = @1
        double height = @2
    }
    def PointInstancer "I" {
        rel prototypes = </W/I/B>
        int[] protoIndices = [@0, 0]
        point3f[] positions = [(@0, 0, 0), (1, 1, 1)]
        def Cube "B" {
            double size = @1
        }
    }
    def BasisCurves "H" {
        uniform token basis = "bspline"
        uniform token wrap = "pinned"
        int[] curveVertexCounts = [@2, 4]
        point3f[] points = [(@0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 0, 1), (1, 1, 2), (2, 1, 2)]
        float[] widths = [@0.1, 0.2] (interpolation = "uniform")
        color3f[] primvars:displayColor = [(@1, 0, 0), (0, 1, 0)] (interpolation = "uniform")
        int[] primvars:displayColor:indices = [@0, 1]
    }
    def Points "D" {
        point3f[] points = [(@0, 0, 0), (0, 0, 1)]
        float[] widths = [@0.1, 0.2]
        color3f[] primvars:displayColor = [(@1, 0, 0), (0, 1, 0)] (interpolation = "vertex")
    }
    def RectLight "R" {
        float inputs:intensity = @5
        float inputs:exposure = @1
        float inputs:width = @1
        bool inputs:normalize = true
    }
    def SphereLight "B" {
        float inputs:radius = @1
        float inputs:shaping:cone:angle = @30
        float inputs:colorTemperature = @5000
        bool inputs:enableColorTemperature = true
    }
}
"#;

/// A document of materials with such places.
const MTLX: &str = r#"<materialx version="1.39">
  <remap name="r" type="float">
    <input name="in" type="float" value="@3"/>
    <input name="inhigh" type="float" value="@2"/>
  </remap>
  <power name="p" type="float">
    <input name="in1" type="float" nodename="r"/>
    <input name="in2" type="float" value="@2"/>
  </power>
  <open_pbr_surface name="S" type="surfaceshader">
    <input name="base_metalness" type="float" nodename="p"/>
    <input name="base_color" type="color3" value="0.5, @0.5, 0.5"/>
    <input name="specular_ior" type="float" value="@1.5"/>
    <input name="transmission_weight" type="float" value="@0.5"/>
    <input name="transmission_depth" type="float" value="@1"/>
    <input name="transmission_color" type="color3" value="@0.5, 1, 1"/>
    <input name="transmission_scatter" type="color3" value="@1, 0, 1"/>
    <input name="transmission_scatter_anisotropy" type="float" value="@0"/>
    <input name="transmission_dispersion_abbe_number" type="float" value="@20"/>
    <input name="coat_weight" type="float" value="@1"/>
    <input name="coat_ior" type="float" value="@1"/>
    <input name="thin_film_thickness" type="float" value="@1"/>
    <input name="emission_luminance" type="float" value="@1"/>
    <input name="geometry_opacity" type="float" value="@1"/>
  </open_pbr_surface>
  <surfacematerial name="M" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="S"/>
  </surfacematerial>
</materialx>"#;

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

/// Stages in text and in binary form.
pub fn usd() -> impl Iterator<Item = Case> {
    let c = |name: &str, text: &str, expect| Case::new(name, "s.usda", text, expect);
    let mut laughs = String::from("#usda 1.0\n");
    for level in 0..8 {
        let child = |k| format!("def \"c{k}\" (references = </l{}>) {{\n}}\n", level + 1);
        laughs += &format!("def \"l{level}\" {{\n{}}}\n", (0..10).map(child).collect::<String>());
    }
    let mut faults = vec![
        c("empty", "", Refused("#usda")),
        c("head alone", "#usda 1.0\n", Warned("no surfaces")),
        c("deep prims", &format!("#usda 1.0\n{}", "def \"a\" {".repeat(1 << 18)), Refused("nested")),
        c("deep lists", &format!("#usda 1.0\ndef \"a\" {{ int[] x = {}", "[".repeat(1 << 20)), Refused("")),
        c("deep options", &format!("#usda 1.0\ndef \"a\" {}", "(references = @b@ ".repeat(1 << 18)), Refused("")),
        c("its own sublayer", "#usda 1.0\n(subLayers = [@s.usda@])\ndef Cube \"c\" {\n}\n", Picture),
        c("its own reference", "#usda 1.0\n(defaultPrim = \"a\")\ndef \"a\" (references = @s.usda@) {\n}\n", Either),
        c("laughs", &laughs, Refused("more than")),
        c("far away", "#usda 1.0\ndef \"a\" (references = @../../../etc/passwd@) {\n}\ndef Cube \"c\" {\n}\n", Either),
    ];
    let mut head = b"PXR-USDC\0\x08\0\0\0\0\0\0".to_vec();
    faults.push(Case::new("a binary head and no more", "s.usdc", head.clone(), Refused("")));
    head.extend([0x18, 0, 0, 0, 0, 0, 0, 0]);
    head.extend([0xff; 64]);
    faults.push(Case::new("a binary head and nonsense", "s.usdc", head, Refused("")));
    faults.push(Case::new("an archive without members", "s.usdz", b"PK\x03\x04PK\x05\x06".to_vec(), Refused("")));
    let m = |name: &str, text: &str, expect| Case::new(name, "s.mtlx", text, expect);
    let many: String = (0..3000)
        .map(|k| format!("<add name='n{k}' type='float'/><surfacematerial name='m{k}' type='material'/>"))
        .collect();
    faults.extend([
        m("no materials", "<materialx version='1.39'/>", Warned("no surfaces")),
        m("materials times nodes", &format!("<materialx>{many}</materialx>"), Refused("more than")),
        m("deep graphs", &format!("<materialx>{}", "<nodegraph name='g'>".repeat(1 << 18)), Refused("nest")),
        m("a node without end", &format!("<materialx>{}", "<a ".repeat(1 << 18)), Refused("")),
    ]);
    faults.into_iter().chain(poisoned("s.usda", USD)).chain(poisoned("s.mtlx", MTLX)).map(|mut case| {
        case.small = true;
        case
    })
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

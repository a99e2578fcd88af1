//! Scenes in coordinates of a country are seen as they are at the origin: single precision would lose their details.

use std::sync::Arc;
use steradian::{CompileOptions, Layer, Loaded, Quality, Scene, compile, formats::Options, image::Image, load, render};

/// A place in UTM coordinates, where single precision has steps of half a metre.
const FAR: [f64; 3] = [448_262.3, 5_411_932.7, 35.1];
const ORIGIN: [f64; 3] = [0.0; 3];

/// Compiles a scene of texts, and gives what was said.
fn scene(extension: &str, text: &str) -> (Arc<Scene>, String) {
    let name = format!("far.{extension}");
    let loaded = load::load_bytes(&name, text.as_bytes().to_vec(), Some(extension), &Options::default());
    compiled(&loaded, text)
}

fn compiled(loaded: &Loaded, text: &str) -> (Arc<Scene>, String) {
    assert!(!loaded.diagnostics.has_errors(), "{:?} in {text}", loaded.diagnostics);
    let options = CompileOptions { size: Some((24, 24)), ..CompileOptions::default() };
    let compiled = compile(&loaded.desc, &options);
    let said = compiled.diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; ");
    (Arc::new(compiled.scene.unwrap_or_else(|| panic!("{said} in {text}"))), said)
}

fn picture(scene: &Arc<Scene>, integrator: &str) -> Image {
    let integrator = Some(format!("{integrator}:reuse=1,caustics=false,effort=even,max_depth=3"));
    let layers = vec![Layer::POSITION];
    render(scene, &Quality { spp: Some(64), integrator, layers, ..Quality::default() }).expect("a picture")
}

/// The mean of a channel's differences, over the mean of its values.
fn difference(a: &Image, b: &Image, channel: &str) -> f64 {
    let [a, b] = [a, b].map(|image| image.channel(channel).expect("a channel"));
    let sum = |of: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| of((*a).into(), (*b).into())).sum::<f64>();
    sum(&|a, b| (a - b).abs()) / sum(&|a, _| a.abs())
}

/// Steps of 3 cm, as the vertices and triangles of a mesh.
fn stairs() -> (String, String) {
    let (mut points, mut triangles) = (String::new(), String::new());
    for k in 0..10 {
        let (x, z) = (f64::from((k + 1) / 2) * 0.3 - 0.75, f64::from(k / 2) * 0.03);
        points += &format!("{x} -1 {z} {x} 1 {z} ");
        if k > 0 {
            let a = 2 * k - 2;
            triangles += &format!("{a} {} {} {a} {} {} ", a + 2, a + 3, a + 3, a + 1);
        }
    }
    (points, triangles)
}

/// Camera, lamp, a placed mesh, a group, a ball and a solid texture, all of it at a place.
fn pbrt([x, y, z]: [f64; 3]) -> String {
    let (points, triangles) = stairs();
    let mesh = format!("Shape \"trianglemesh\" \"point3 P\" [ {points} ] \"integer indices\" [ {triangles} ]");
    format!(
        "LookAt {} {} {} {x} {y} {z} 0 0 1
Camera \"perspective\" \"float fov\" [ 40 ]
WorldBegin
LightSource \"point\" \"point3 from\" [ {} {y} {} ] \"rgb I\" [ 5 5 5 ]
AttributeBegin
Translate {x} {y} {z}
Scale .5 .5 .5
Translate .31 .31 .31
Texture \"steps\" \"spectrum\" \"checkerboard\" \"integer dimension\" [ 3 ]
    \"rgb tex1\" [ .2 .2 .2 ] \"rgb tex2\" [ .8 .8 .8 ]
AttributeEnd
Material \"diffuse\" \"texture reflectance\" \"steps\"
ObjectBegin \"stairs\"
{mesh}
ObjectEnd
AttributeBegin
Translate {x} {y} {z}
{mesh}
Translate 0 0 .4
Shape \"sphere\" \"float radius\" [ .2 ]
AttributeEnd
AttributeBegin
Translate {x} {} {z}
Rotate 30 0 0 1
ObjectInstance \"stairs\"
AttributeEnd
",
        x - 1.0,
        y - 3.0,
        z + 2.0,
        x - 1.0,
        z + 2.5,
        y + 2.0
    )
}

fn mitsuba([x, y, z]: [f64; 3]) -> String {
    format!(
        "<scene version=\"3.0.0\"><integrator type=\"path\"/>
<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><transform name=\"to_world\">
<lookat origin=\"{}, {}, {}\" target=\"{x}, {y}, {z}\" up=\"0, 0, 1\"/></transform></sensor>
<emitter type=\"spot\"><transform name=\"to_world\">
<lookat origin=\"{x}, {}, {}\" target=\"{x}, {y}, {z}\" up=\"0, 0, 1\"/></transform>
<rgb name=\"intensity\" value=\"20, 20, 20\"/><float name=\"cutoff_angle\" value=\"30\"/></emitter>
<shape type=\"cube\"><transform name=\"to_world\"><scale z=\"0.03\"/>
<translate x=\"{x}\" y=\"{y}\" z=\"{z}\"/>
</transform></shape>
<shape type=\"sphere\">
<point name=\"center\" x=\"{x}\" y=\"{y}\" z=\"{}\"/><float name=\"radius\" value=\"0.3\"/></shape>
<shape type=\"rectangle\"><transform name=\"to_world\"><scale x=\"4\" y=\"4\"/>
<translate x=\"{x}\" y=\"{y}\" z=\"{z}\"/>
</transform></shape></scene>",
        x - 1.0,
        y - 3.0,
        z + 2.0,
        y - 1.0,
        z + 3.0,
        z + 0.3
    )
}

/// A scene in our language, with a cloud whose place is its own, and a plane.
fn native([x, y, z]: [f64; 3]) -> String {
    let (points, triangles) = stairs();
    format!(
        "steradian: 1
materials: {{w: {{material: diffuse, reflectance: 0.5}}, c: {{material: interface}}}}
media: {{m: {{medium: cloud, sigma_a: 0.5, sigma_s: 3, p0: [-0.5,-0.5,0], p1: [0.5,0.5,0.6],
    to_world: {{translate: [{x},{y},{z}]}}}}}}
camera: {{camera: perspective, fov: 40, to_world: {{look_at: [{x},{y},{z}], from: [{},{},{}], up: [0,0,1]}}}}
lights: [{{light: point, position: [{x},{y},{}], intensity: 8}}]
shapes: [
{{shape: mesh, mesh: {{positions: [{points}], triangles: [{triangles}]}},
    to_world: {{translate: [{x},{y},{z}]}}, material: w}}
{{shape: plane, normal: [0,0,1], distance: 0.1, to_world: {{translate: [{x},{y},{z}]}}, material: w}}
{{shape: sphere, center: [{x},{y},{}], radius: 0.3, material: c, interior: m}}
]
",
        x - 1.0,
        y - 3.0,
        z + 2.0,
        z + 3.0,
        z + 0.3
    )
}

#[test]
fn places_far_away_look_like_the_origin() {
    for (extension, text, integrator) in
        [("pbrt", pbrt as fn([f64; 3]) -> String, "path"), ("xml", mitsuba, "path"), ("steradian", native, "volpath")]
    {
        let [(near, _), (far, said)] = [ORIGIN, FAR].map(|place| scene(extension, &text(place)));
        assert!(!said.contains("details are lost"), "{extension}: {said}");
        let [a, b] = [&near, &far].map(|scene| picture(scene, integrator));
        let differs = difference(&a, &b, "G");
        assert!(differs < 0.01, "{extension}: {differs}");
        // Places are told in the world of the file, where the centre of the picture is what the camera looks at.
        let far_x = b.channel("P.X").expect("positions")[12 * 24 + 12];
        let near_x = a.channel("P.X").expect("positions")[12 * 24 + 12];
        assert!((f64::from(far_x - near_x) - FAR[0]).abs() < 0.1, "{extension}: {far_x} {near_x}");
    }
}

/// Mesh files in double precision keep their digits in scenes that name them.
#[test]
fn mesh_files_far_away_look_like_the_origin() {
    let folder = tempfile::tempdir().expect("a folder");
    let stored = |place: [f64; 3], name: &str, is_ply: bool| {
        let (points, triangles) = stairs();
        let [points, triangles] = [points, triangles]
            .map(|text| text.split_whitespace().map(|v| v.parse::<f64>().expect("a number")).collect::<Vec<_>>());
        let vertices = points.chunks(3).map(|p| format!("{} {} {}", p[0] + place[0], p[1] + place[1], p[2] + place[2]));
        let (lead, first) = if is_ply { ("", 0.0) } else { ("v ", 1.0) };
        let mut out = vertices.map(|v| format!("{lead}{v}\n")).collect::<String>();
        let lead = if is_ply { "3" } else { "f" };
        for t in triangles.chunks(3) {
            out += &format!("{lead} {} {} {}\n", t[0] + first, t[1] + first, t[2] + first);
        }
        let header = format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            points.len() / 3,
            triangles.len() / 3
        );
        let out = if is_ply { header + &out } else { out };
        std::fs::write(folder.path().join(name), out).expect("written");
    };
    for (extension, kind) in [("pbrt", "ply"), ("xml", "ply"), ("xml", "obj")] {
        let [(near, _), (far, said)] = [ORIGIN, FAR].map(|place| {
            stored(place, &format!("stairs.{kind}"), kind == "ply");
            let [x, y, z] = place;
            let (ex, ey, ez) = (x - 1.0, y - 3.0, z + 2.0);
            let text = match extension {
                "pbrt" => format!(
                    "LookAt {ex} {ey} {ez} {x} {y} {z} 0 0 1\nCamera \"perspective\" \"float fov\" [ 40 ]\nWorldBegin\n\
                     LightSource \"distant\" \"point3 from\" [ -1 0 3 ] \"point3 to\" [ 0 0 0 ]\n\
                     Shape \"plymesh\" \"string filename\" \"stairs.ply\""
                ),
                _ => format!(
                    "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\">\
                     <float name=\"fov\" value=\"40\"/><transform name=\"to_world\">\
                     <lookat origin=\"{ex}, {ey}, {ez}\" target=\"{x}, {y}, {z}\" up=\"0, 0, 1\"/></transform></sensor>\
                     <emitter type=\"directional\"><vector name=\"direction\" x=\"1\" y=\"0\" z=\"-3\"/></emitter>\
                     <shape type=\"{kind}\"><string name=\"filename\" value=\"stairs.{kind}\"/></shape></scene>"
                ),
            };
            let path = folder.path().join(format!("scene.{extension}"));
            std::fs::write(&path, &text).expect("written");
            compiled(&load(&path, &Options::default()), &text)
        });
        assert!(!said.contains("details are lost"), "{extension}, {kind}: {said}");
        let [a, b] = [&near, &far].map(|scene| picture(scene, "path"));
        let differs = difference(&a, &b, "G");
        assert!(differs < 0.01, "{extension}, {kind}: {differs}");
    }
}

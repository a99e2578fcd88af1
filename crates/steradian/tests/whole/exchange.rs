//! Scenes that are written in the languages of other programs and read again give the same pictures, or the writer says
//! why not.

#![expect(clippy::print_stdout, reason = "tests say what they skipped and measured")]

use std::path::{Path, PathBuf};
use steradian::{
    ColorMode, CompileOptions, Loaded, Quality, compile,
    formats::{Options, write},
    image::Image,
    load, render,
    scene::{Fidelity, Instance, SceneDesc},
};

fn picture(desc: &SceneDesc, name: &str) -> Image {
    // Of the film's shape: angles of view may be of either axis.
    let film = desc.film.map(|f| desc.node(f));
    let side = |name: &str| film.and_then(|f| f.float(name)).unwrap_or(48.0);
    let size = (48, (48.0 * side("height") / side("width")).round() as u32);
    let options = CompileOptions { size: Some(size), mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let compiled = compile(desc, &options);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{name}: {:?}", compiled.diagnostics));
    let integrator = Some("volpath:reuse=1,caustics=false,effort=even,max_depth=4".to_owned());
    render(&std::sync::Arc::new(scene), &Quality { spp: Some(16), integrator, ..Quality::default() }).expect(name)
}

fn means(image: &Image) -> [f64; 3] {
    ["R", "G", "B"].map(|c| {
        let plane = image.channel(c).expect("a colour");
        plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
    })
}

/// Writes a scene into a folder; the file, and what was lost.
fn written(desc: &SceneDesc, folder: &Path, file: &str) -> (PathBuf, Vec<String>) {
    let path = folder.join(file);
    let written = write::write(desc, &path).expect(file);
    for (name, bytes) in &written.files {
        let name = folder.join(name);
        std::fs::create_dir_all(name.parent().expect("a folder")).expect("a folder");
        std::fs::write(name, bytes).expect("written");
    }
    std::fs::write(&path, &written.bytes).expect("written");
    let losses = written.diagnostics.iter().filter(|d| d.fidelity.is_some());
    (path, losses.map(|d| format!("{:?}: {}", d.fidelity.unwrap_or(Fidelity::Unused), d.message)).collect())
}

/// Converts step by step; the last description and all losses.
fn gone(path: &Path, steps: &[&str], folder: &Path) -> (SceneDesc, Vec<String>) {
    let mut losses = Vec::new();
    let mut desc = opened(path);
    for (i, extension) in steps.iter().enumerate() {
        let (file, lost) = written(&desc, folder, &format!("step{i}.{extension}"));
        losses.extend(lost);
        desc = opened(&file);
    }
    (desc, losses)
}

fn opened(path: &Path) -> SceneDesc {
    let Loaded { desc, diagnostics, .. } = load(path, &Options::default());
    assert!(!diagnostics.has_errors(), "{}: {diagnostics:?}", path.display());
    desc
}

/// The largest relative difference of means of a scene and what a chain of formats makes of it, with its losses.
fn difference(path: &Path, steps: &[&str]) -> (f64, Vec<String>) {
    let folder = tempfile::tempdir().expect("a folder");
    let (after, losses) = gone(path, steps, folder.path());
    let name = format!("{} {steps:?}", path.display());
    let (a, b) = (means(&picture(&opened(path), &name)), means(&picture(&after, &name)));
    let off = (0..3).map(|c| (b[c] / a[c] - 1.0).abs()).fold(0.0, f64::max);
    println!("{name}: {off:.5}, {} losses", losses.len());
    (off, losses)
}

fn scene(text: &str, extension: &str, folder: &Path) -> PathBuf {
    let path = folder.join(format!("scene.{extension}"));
    std::fs::write(&path, text).expect("written");
    path
}

/// Everything in it has an exact counterpart.
const MITSUBA: &str = r#"<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="5"/></integrator>
<sensor type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.02"/><float name="focus_distance" value="5"/>
 <transform name="to_world"><lookat origin="0.5,1.5,5" target="0,0.3,0" up="0,1,0"/></transform>
 <film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="32"/><rfilter type="tent"/></film>
 <sampler type="independent"><integer name="sample_count" value="16"/></sampler></sensor>
<bsdf type="twosided" id="board"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.8,0.4,0.2"/>
 <rgb name="color1" value="0.1,0.2,0.3"/><transform name="to_uv"><scale x="4" y="3"/></transform></texture></bsdf></bsdf>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/></transform><ref id="board"/></shape>
<shape type="sphere"><point name="center" x="-1" y="0.5" z="0"/><float name="radius" value="0.5"/>
 <bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.2"/></bsdf></shape>
<shape type="sphere"><point name="center" x="0.3" y="0.5" z="0.4"/><float name="radius" value="0.5"/>
 <bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf></shape>
<shape type="cylinder"><point name="p0" x="1.5" y="0" z="0"/><point name="p1" x="1.5" y="1" z="0"/><float name="radius" value="0.3"/>
 <bsdf type="mask"><float name="opacity" value="0.6"/><bsdf type="twosided"><bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.2,0.5,0.3"/></bsdf></bsdf></bsdf></shape>
<shape type="shapegroup" id="g"><shape type="cube"><transform name="to_world"><scale value="0.2"/></transform>
 <bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"/><bsdf type="plastic"><boolean name="nonlinear" value="true"/></bsdf></bsdf></shape></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><translate x="-0.3" y="0.2" z="1.5"/></transform></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><rotate y="1" angle="30"/><translate x="1" y="0.2" z="1.3"/></transform></shape>
<shape type="disk"><transform name="to_world"><rotate x="1" angle="90"/><translate y="3"/></transform><emitter type="area"><rgb name="radiance" value="9,8,7"/></emitter></shape>
<emitter type="constant"><rgb name="radiance" value="0.2,0.3,0.4"/></emitter>
<emitter type="spot"><rgb name="intensity" value="10,9,8"/><transform name="to_world"><lookat origin="2,3,2" target="0,0,0" up="0,1,0"/></transform></emitter>
<emitter type="directional"><vector name="direction" x="0.3" y="-1" z="-0.5"/><rgb name="irradiance" value="1,1,1.2"/></emitter>
<emitter type="point"><point name="position" x="-2" y="2" z="2"/><spectrum name="intensity" value="400:3, 500:5, 700:4"/></emitter>
</scene>"#;

#[test]
fn mitsubas_own_scenes_are_written_exactly() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(MITSUBA, "xml", folder.path());
    let (off, losses) = difference(&path, &["xml"]);
    assert!(losses.is_empty(), "{losses:?}");
    assert!(off < 1e-5, "{off}");
}

/// Light along 30°, 45° ahead of the fast axis of a quarter-wave plate, becomes left-circular, which the last filter
/// passes.
const FILTERS: &str = r#"<scene version="3.0.0"><integrator type="path"/>
<sensor type="orthographic">
 <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/></transform>
 <bsdf type="polarizer"><spectrum name="theta" value="30"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><translate z="1"/></transform>
 <bsdf type="retarder"><float name="theta" value="-15"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><translate z="2"/></transform>
 <bsdf type="circular"><boolean name="left_handed" value="true"/>
  <rgb name="transmittance" value="0.8,0.4,0"/></bsdf></shape>
<emitter type="constant"><rgb name="radiance" value="1"/></emitter></scene>"#;

#[test]
fn polarising_filters_are_read_and_written_exactly() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(FILTERS, "xml", folder.path());
    let read = load(&path, &Options::default()).diagnostics;
    assert!(read.iter().all(|d| d.fidelity.is_none()), "{read:?}");
    let options = CompileOptions { size: Some((8, 8)), mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    for steps in [&[][..], &["xml"], &["steradian", "xml"]] {
        let (desc, losses) = gone(&path, steps, folder.path());
        assert!(losses.is_empty(), "{losses:?}");
        let compiled = std::sync::Arc::new(compile(&desc, &options).scene.expect("a scene"));
        for (name, part) in [("stokes:rr_depth=9", 0.5), ("path:rr_depth=9,effort=even", 0.25)] {
            let found = means(&render(&compiled, &Quality { spp: Some(4), ..Quality::of(name) }).expect(name));
            let is_near = |(found, tint): (&f64, f64)| (found - part * tint).abs() < 5e-4 * tint + 1e-7;
            assert!(found.iter().zip([0.8, 0.4, 0.0]).all(is_near), "{name} {steps:?}: {found:?}");
        }
        let left_out = Quality::of("path").render(&compiled).expect("path").left_out(&compiled);
        assert!(left_out.is_some_and(|l| l.of("path").contains("'stokes' renders it")));
        assert_eq!(Quality::of("stokes").render(&compiled).expect("stokes").left_out(&compiled), None);
    }
}

#[test]
fn mitsubas_scenes_go_through_pbrt() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(MITSUBA, "xml", folder.path());
    for steps in [&["pbrt"][..], &["pbrt", "xml"], &["steradian", "pbrt"]] {
        let (off, losses) = difference(&path, steps);
        // Named are: sides that reflect, masking and shadowing, the coat, the spot's edge.
        assert!(off < 0.02, "{steps:?}: {off} {losses:?}");
        for word in ["on both sides", "masking and shadowing", "'coateddiffuse'", "spot's edge"] {
            assert!(losses.iter().any(|l| l.contains(word)), "{word} is not in {losses:?}");
        }
    }
}

#[test]
fn our_scenes_go_around() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for name in ["showcase.pbrt", "showcase.xml"] {
        for steps in [&["xml"][..], &["pbrt"], &["xml", "pbrt"], &["pbrt", "xml"], &["steradian", "pbrt"]] {
            let (off, losses) = difference(&root.join(name), steps);
            assert!(off < 5e-3 || !losses.is_empty(), "{name} {steps:?}: {off} without a named loss");
        }
    }
}

/// A quad with a picture over it, a metal ball, a lamp and a sun.
const SIMPLE: &str = r#"<scene version="3.0.0">
<integrator type="path"/>
<sensor type="perspective"><float name="fov" value="40"/><string name="fov_axis" value="y"/>
 <transform name="to_world"><lookat origin="0.5,1.5,5" target="0,0.3,0" up="0,1,0"/></transform>
 <film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="36"/><rfilter type="box"/></film></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/></transform>
 <bsdf type="twosided"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="floor.png"/>
 <transform name="to_uv"><scale x="2" y="3"/><rotate z="1" angle="30"/></transform></texture></bsdf></bsdf></shape>
<shape type="cube"><transform name="to_world"><scale x="-0.5" y="0.5" z="0.5"/><translate y="0.6"/></transform>
 <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.3,0.5,0.7"/></bsdf></bsdf></shape>
<shape type="shapegroup" id="g"><shape type="rectangle"><transform name="to_world"><scale value="0.3"/></transform>
 <bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><translate x="-1.3" y="0.4" z="0.5"/></transform></shape>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate y="3"/></transform>
 <emitter type="area"><rgb name="radiance" value="9,8,7"/></emitter></shape>
<emitter type="directional"><vector name="direction" x="0.3" y="-1" z="-0.5"/><rgb name="irradiance" value="1,1,1.2"/></emitter>
<emitter type="point"><point name="position" x="-2" y="2" z="2"/><rgb name="intensity" value="4,5,6"/></emitter>
</scene>"#;

#[test]
fn what_gltf_holds_is_written_exactly() {
    let folder = tempfile::tempdir().expect("a folder");
    let pixels: Vec<[f32; 3]> = (0..64).map(|i| [(i % 8) as f32 / 8.0, (i / 8) as f32 / 8.0, 0.5]).collect();
    let picture = Image::from_rgb(8, 8, &pixels).expect("a picture");
    steradian::image::write(&folder.path().join("floor.png"), &picture, &Default::default()).expect("written");
    let path = scene(SIMPLE, "xml", folder.path());
    for steps in [&["glb"][..], &["gltf"], &["steradian", "glb"], &["glb", "steradian", "gltf"]] {
        let (off, losses) = difference(&path, steps);
        assert!(losses.is_empty(), "{steps:?}: {losses:?}");
        // Samples of lights are drawn in another order.
        assert!(off < 5e-3, "{steps:?}: {off}");
    }
}

#[test]
fn gltf_files_keep_the_rules_of_buffers() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(MITSUBA, "xml", folder.path());
    let (file, _) = written(&opened(&path), folder.path(), "out.glb");
    let bytes = std::fs::read(file).expect("written");
    let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((&bytes[..4], u32_at(4), u32_at(8)), (&b"glTF"[..], 2, bytes.len()));
    let json = u32_at(12);
    assert_eq!((&bytes[16..20], json % 4), (&b"JSON"[..], 0));
    let bin = u32_at(20 + json);
    assert_eq!((&bytes[24 + json..28 + json], bin % 4), (&b"BIN\0"[..], 0));
    let root: serde_json::Value = serde_json::from_slice(&bytes[20..20 + json]).expect("JSON");
    let list = |name: &str| root[name].as_array().cloned().unwrap_or_default();
    assert!(root["buffers"][0]["byteLength"].as_u64().expect("a length") as usize <= bin);
    let views = list("bufferViews");
    for view in &views {
        let (start, length) = (view["byteOffset"].as_u64().expect("set"), view["byteLength"].as_u64().expect("set"));
        assert!(start % 4 == 0 && (start + length) as usize <= bin, "{view}");
    }
    let accessors = list("accessors");
    for mesh in list("meshes") {
        for primitive in mesh["primitives"].as_array().expect("primitives") {
            let position = &accessors[primitive["attributes"]["POSITION"].as_u64().expect("positions") as usize];
            let indices = &accessors[primitive["indices"].as_u64().expect("indices") as usize];
            let view = &views[position["bufferView"].as_u64().expect("a view") as usize];
            let start = 28 + json + view["byteOffset"].as_u64().expect("set") as usize;
            let count = position["count"].as_u64().expect("a count") as usize;
            let floats = bytes[start..start + 12 * count].chunks_exact(4);
            let floats: Vec<f32> = floats.map(|c| f32::from_le_bytes(c.try_into().expect("four"))).collect();
            for axis in 0..3 {
                let values = floats.iter().skip(axis).step_by(3).copied();
                let (low, high) = values.fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(v), h.max(v)));
                assert_eq!(position["min"][axis].as_f64().map(|v| v as f32), Some(low));
                assert_eq!(position["max"][axis].as_f64().map(|v| v as f32), Some(high));
            }
            assert!(indices["count"].as_u64().expect("a count") % 3 == 0 && position["componentType"] == 5126);
        }
    }
    let used: Vec<String> = list("extensionsUsed").iter().map(|e| e.as_str().unwrap_or_default().to_owned()).collect();
    let text = String::from_utf8_lossy(&bytes[20..20 + json]).into_owned();
    for part in text.split('"').filter(|p| p.starts_with("KHR_")) {
        assert!(used.iter().any(|u| u == part), "{part} is not in {used:?}");
    }
}

#[test]
fn what_cannot_be_expressed_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "Film \"rgb\" \"integer xresolution\" [8] \"integer yresolution\" [8]\nCamera \"perspective\"\nWorldBegin\n\
        LightSource \"infinite\"\nTexture \"t\" \"spectrum\" \"marble\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n\
        Shape \"sphere\" \"float phimax\" [200]\nMaterial \"coatedconductor\"\nShape \"disk\"\n";
    let path = scene(text, "pbrt", folder.path());
    let (_, losses) = gone(&path, &["xml"], folder.path());
    let (off, losses_of_pbrt) = difference(&path, &["pbrt"]);
    assert!(off < 1e-5 && losses_of_pbrt.is_empty(), "{off} {losses_of_pbrt:?}");
    let (_, gltf) = gone(&path, &["glb"], folder.path());
    for word in ["texture 'marble'", "light 'environment'", "'coated_conductor'"] {
        assert!(gltf.iter().any(|l| l.contains(word)), "{word} is not in {gltf:?}");
    }
    for word in ["texture 'marble'", "'sphere' that is cut", "'coated_conductor'"] {
        assert!(losses.iter().any(|l| l.contains(word)), "{word} is not in {losses:?}");
    }
}

/// Light that goes below layered surfaces is kept in the own language; elsewhere it is left out by name, and the base
/// has the colour of what comes back.
#[test]
fn light_below_layers_is_told_where_it_is_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    for (kind, weight) in [("openpbr", "subsurface_weight"), ("principled", "subsurface")] {
        let text = format!(
            "steradian: 1
            shapes: [{{shape: sphere, material: {{material: {kind}, {weight}: 1, base_color: {{rgb: [1, 0, 0]}},
            subsurface_color: {{rgb: [0, 0, 1]}}}}}}]"
        );
        let path = scene(&text, "steradian", folder.path());
        let (kept, losses) = gone(&path, &["steradian"], folder.path());
        assert!(losses.is_empty() && kept.nodes.iter().any(|n| n.float(weight) == Some(1.0)), "{losses:?}");
        for extension in ["xml", "pbrt", "glb"] {
            let (desc, losses) = gone(&path, &[extension], folder.path());
            assert!(losses.iter().any(|l| l.contains(&format!("'{weight}' of '{kind}'"))), "{extension}: {losses:?}");
            let material = desc.nodes.iter().find(|n| n.get("base_color").or(n.get("reflectance")).is_some());
            let color = format!("{:?}", material.and_then(|n| n.get("base_color").or(n.get("reflectance"))));
            assert!(color.contains("[0.0, 0.0, 1.0]") || color.contains("Rgb([0.0, 0.0,"), "{extension}: {color}");
        }
    }
}

/// Motion and exposure stay in pbrt's language; other formats say that everything stands still.
#[test]
fn motion_goes_through_pbrt_and_is_reported_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("moving.pbrt");
    let text = "TransformTimes 2 4 LookAt 0 0 -4  0 0 0  0 1 0\n\
         ActiveTransform EndTime Translate 0.2 0 0 ActiveTransform All\n\
         Camera \"perspective\" \"float shutteropen\" 2.5 \"float shutterclose\" 3.5\nWorldBegin\n\
         LightSource \"infinite\" \"rgb L\" [1 1 1]\n\
         AttributeBegin ActiveTransform EndTime Translate 1 0.3 0 Rotate 80 0 0 1 ActiveTransform All\n\
         Shape \"bilinearmesh\" \"point3 P\" [-1 -0.2 0 1 -0.2 0 -1 0.2 0 1 0.2 0] AttributeEnd";
    std::fs::write(&file, text).expect("written");
    let desc = opened(&file);
    let before = picture(&desc, "before");
    let (again, losses) = gone(&file, &["pbrt", "steradian", "pbrt"], folder.path());
    assert!(losses.is_empty(), "{losses:?}");
    let after = picture(&again, "after");
    let [a, b] = [&before, &after].map(|p| p.channel("G").expect("green"));
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>() / a.len() as f32;
    assert!(apart < 1e-4, "{apart}");
    let still = SceneDesc {
        instances: desc.instances.iter().map(|i| Instance { movement: None, ..i.clone() }).collect(),
        ..desc
    };
    let still = picture(&still, "still");
    let moved =
        a.iter().zip(still.channel("G").expect("green")).map(|(a, b)| (a - b).abs()).sum::<f32>() / a.len() as f32;
    assert!(moved > 3e-3, "nothing moves: {moved}");
    for extension in ["xml", "gltf"] {
        let (_, losses) = written(&opened(&file), folder.path(), &format!("moving.{extension}"));
        assert_eq!(losses.iter().filter(|l| l.contains("stands still")).count(), 2, "{extension}: {losses:?}");
    }
}

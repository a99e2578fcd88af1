//! Light that enters layered surfaces (`openpbr`, `principled`) and leaves them elsewhere, and media inside glTF's.

use crate::subsurface::seen;
use std::{path::Path, sync::Arc};
use steradian::{
    CompileOptions, Quality, Scene, compile,
    formats::Options,
    load,
    math::spectra::ColorMode,
    render,
    scene::{Family, Node, SceneDesc, Severity},
};

/// A ball, seen from afar under an even sky of one, so that each point of its face counts by its cosine.
fn ball(material: &str) -> Arc<Scene> {
    under("{light: environment, radiance: {rgb: [1, 1, 1]}}", material)
}

/// The ball under some light, with a camera that sees from −1 to 1 in both directions.
fn under(light: &str, material: &str) -> Arc<Scene> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.steradian");
    std::fs::write(&path, text(light, material)).expect("written");
    compiled(&loaded(&path))
}

fn text(light: &str, material: &str) -> String {
    let world = format!(
        "shapes: [{{shape: sphere, radius: 1, material: {{{material}}}}}]
         lights: [{light}]"
    );
    crate::subsurface::text("path", &world)
}

fn loaded(path: &Path) -> SceneDesc {
    let loaded = load(path, &Options::default());
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    loaded.desc
}

fn compiled(desc: &SceneDesc) -> Arc<Scene> {
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let compiled = compile(desc, &options);
    assert!(compiled.diagnostics.is_empty(), "{:?}", compiled.diagnostics);
    Arc::new(compiled.scene.expect("a scene"))
}

/// The mean of a picture of a ball that reflects nothing.
fn sky_alone() -> f64 {
    seen(&ball("material: diffuse, reflectance: 0"), 16)[0].0
}

/// Albedo of a ball's face under an even sky.
fn albedo(material: &str, spp: u32, sky: f64) -> [f64; 3] {
    seen(&ball(material), spp).map(|(mean, _)| (mean - sky) / (1.0 - sky))
}

const COLOR: [f64; 3] = [0.8, 0.5, 0.2];
const DENSE: &str = "subsurface_color: {rgb: [0.8, 0.5, 0.2]}, subsurface_radius: 0.004";
const DENSE_DISNEY: &str = "subsurface: 1, subsurface_color: {rgb: [0.8, 0.5, 0.2]}, subsurface_scale: 0.004";

/// A dense medium without an interface above sends back the colour that was asked for.
#[test]
fn dense_media_have_the_colour_that_is_asked_for() {
    let sky = sky_alone();
    for material in [
        format!("material: openpbr, specular_weight: 0, subsurface_weight: 1, {DENSE}"),
        format!(
            "material: openpbr, specular_weight: 0, subsurface_weight: 1, subsurface_scatter_anisotropy: 0.6, {DENSE}"
        ),
        format!("material: principled, specular: 0, {DENSE_DISNEY}"),
        format!("material: principled, specular: 0, subsurface_method: normalized_diffusion, {DENSE_DISNEY}"),
    ] {
        let found = albedo(&material, 8, sky);
        let is_near = found.iter().zip(COLOR).all(|(a, b)| (a - b).abs() < 0.02);
        assert!(is_near, "{material}: {found:?}");
    }
}

/// With nothing above it is the medium of material `subsurface` at an index of one, through which light shows:
/// 5σ of the frames, and 0.004.
#[test]
fn layered_surfaces_have_the_medium_of_material_subsurface() {
    let mfp = "{rgb: [0.6, 0.3, 0.15]}";
    let reference = format!(
        "material: subsurface, method: random_walk, eta: 1, reflectance: {{rgb: [0.8, 0.5, 0.2]}}, mfp: {mfp}, g: 0.3"
    );
    let reference = seen(&ball(&reference), 48);
    for material in [
        "material: openpbr, specular_weight: 0, subsurface_weight: 1, subsurface_color: {rgb: [0.8, 0.5, 0.2]},
         subsurface_radius: 0.6, subsurface_radius_scale: {rgb: [1, 0.5, 0.25]}, subsurface_scatter_anisotropy: 0.3"
            .to_owned(),
        format!(
            "material: principled, specular: 0, base_color: {{rgb: [0.8, 0.5, 0.2]}}, subsurface: 1,
             subsurface_radius: {mfp}, subsurface_scale: 1, subsurface_anisotropy: 0.3"
        ),
    ] {
        let found = seen(&ball(&material), 48);
        for ((a, va), (b, vb)) in found.into_iter().zip(reference) {
            let is_near = (a - b).abs() < 5.0 * (va + vb).sqrt() && (a - b).abs() < 4e-3;
            assert!(is_near, "{material}: {found:?}, not {reference:?}");
        }
    }
}

/// A dense medium under an interface sends back what a diffuse base of its colour does, and where it is part of the
/// base, the mean of both. Under coat and fuzz, whose losses by both directions a diffuse base has, it is a little
/// brighter. Darkening by the coat grows with the albedo, so that it has no such means: it is off.
#[test]
fn a_dense_medium_looks_like_a_diffuse_base() {
    let sky = sky_alone();
    for (layers, allowed) in [("", 0.02), (", coat_weight: 0.5, coat_darkening: 0, fuzz_weight: 0.3", 0.045)] {
        let of = |weight: f64| {
            let base = "material: openpbr, base_color: {rgb: [0.2, 0.5, 0.8]}";
            albedo(&format!("{base}, subsurface_weight: {weight}, {DENSE}{layers}"), 8, sky)
        };
        let diffuse = format!("material: openpbr, base_color: {{rgb: [0.8, 0.5, 0.2]}}{layers}");
        let [whole, half, none, diffuse] = [of(1.0), of(0.5), of(0.0), albedo(&diffuse, 8, sky)];
        for k in 0..3 {
            let more = whole[k] - diffuse[k];
            assert!(more > -0.01 && more < allowed, "{layers}: {whole:?}, diffuse {diffuse:?}");
            assert!((half[k] - 0.5 * (whole[k] + none[k])).abs() < 0.01, "{none:?} {half:?} {whole:?}");
        }
    }
}

/// Without absorption no more comes back than arrives, and under a bare interface nearly all.
#[test]
fn white_media_are_white() {
    let openpbr = "subsurface_weight: 1, subsurface_color: 1, subsurface_radius: 0.1";
    let disney = "subsurface: 1, base_color: 1, subsurface_scale: 0.1";
    for (material, medium, least) in [
        ("openpbr, specular_roughness: 0", openpbr, 0.99),
        ("openpbr, specular_roughness: 0.5", openpbr, 0.99),
        ("openpbr, specular_roughness: 0.2, coat_weight: 1, fuzz_weight: 0.5", openpbr, 0.96),
        ("principled, roughness: 0.3", disney, 0.97),
        ("principled, roughness: 0.4, clearcoat: 1, clearcoat_gloss: 1, sheen: 1", disney, 0.95),
    ] {
        let what = format!("material: {material}, {medium}");
        for (mean, variance) in seen(&ball(&what), 8) {
            let noise = 5.0 * variance.sqrt().max(2e-4);
            assert!(mean < 1.003 + noise && mean > least - noise, "{what}: {mean} ± {}", variance.sqrt());
        }
    }
}

/// If none of the base is a medium the picture has the bits that it has without.
#[test]
fn without_a_weight_nothing_changes() {
    for kind in ["openpbr", "principled"] {
        let plain = ball(&format!("material: {kind}"));
        let weight = if kind == "openpbr" { "subsurface_weight" } else { "subsurface" };
        let with = ball(&format!("material: {kind}, {weight}: 0, subsurface_color: 0.1, subsurface_radius: 3"));
        let quality = Quality { spp: Some(4), seed: Some(3), ..Quality::default() };
        let pictures = [plain, with].map(|scene| render(&scene, &quality).expect("a picture"));
        assert!(pictures[0].channel("G") == pictures[1].channel("G"), "{kind}");
    }
}

/// Weights, colours and lengths may vary over the surface: textures of one value give the bits of that value.
#[test]
fn weights_and_lengths_may_be_textures() {
    let texture = |v: &str| format!("{{texture: checkerboard, a: {v}, b: {v}}}");
    for (kind, names) in [
        ("openpbr", ["subsurface_weight", "subsurface_color", "subsurface_radius"]),
        ("principled", ["subsurface", "subsurface_color", "subsurface_scale"]),
    ] {
        let [plain, textured] = [false, true].map(|is_textured| {
            let value = |v: &str| if is_textured { texture(v) } else { v.to_owned() };
            let of = |k: usize, v: &str| format!("{}: {}", names[k], value(v));
            ball(&format!("material: {kind}, {}, {}, {}", of(0, "0.6"), of(1, "0.5"), of(2, "0.25")))
        });
        let quality = Quality { spp: Some(4), seed: Some(3), ..Quality::default() };
        let pictures = [plain, textured].map(|scene| {
            assert!(scene.has_subsurface());
            render(&scene, &quality).expect("a picture")
        });
        let [a, b] = pictures.each_ref().map(|p| p.channel("G").expect("green"));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5), "{kind}");
    }
}

/// Light from behind comes through, more of it where it goes further.
#[test]
fn light_from_behind_comes_through() {
    let light = "{light: distant, radiance: {rgb: [3, 3, 3]}, direction: [0, 0, 1]}";
    let of = |radius: f64| {
        let material = format!("material: openpbr, subsurface_weight: 1, subsurface_radius: {radius}");
        seen(&under(light, &material), 64)[0].0
    };
    let [short, long] = [of(0.05), of(0.4)];
    assert!(long > 3.0 * short && short >= 0.0 && long > 0.02, "{short} {long}");
}

/// Methods that do not follow light below surfaces name the material; previews show a diffuse surface of both colours.
#[test]
fn other_methods_name_the_material() {
    let openpbr =
        "material: openpbr, specular_weight: 0, base_color: 0.2, subsurface_weight: 0.5, subsurface_color: 0.8";
    let disney = "material: principled, specular: 0, base_color: 0.2, subsurface: 0.5, subsurface_color: 0.8";
    for (material, name) in [(openpbr, "'openpbr'"), (disney, "'principled'")] {
        let scene = ball(material);
        assert!(scene.has_subsurface());
        for method in ["bdpt", "sppm", "whitted", "transient"] {
            let quality = Quality { integrator: Some(method.into()), spp: Some(1), ..Quality::default() };
            let refusal = render(&scene, &quality).expect_err("it is refused").to_string();
            assert!(refusal.contains("below surfaces") && refusal.contains(name), "{refusal}");
        }
        let quality = Quality { integrator: Some("raster".into()), spp: Some(4), ..Quality::default() };
        let picture = render(&scene, &quality).expect("a picture");
        let middle = picture.channel("G").expect("green")[12 * 24 + 12];
        assert!((middle - 0.5).abs() < 0.1, "{name}: {middle}");
    }
    assert!(!ball("material: openpbr, geometry_thin_walled: true, subsurface_weight: 1").has_subsurface());
}

/// Numbers out of their ranges are told by name.
#[test]
fn numbers_out_of_range_are_told() {
    for (material, name) in [
        ("openpbr, subsurface_weight: 1.5", "subsurface_weight"),
        ("openpbr, subsurface_weight: 1, subsurface_radius: -1", "subsurface_radius"),
        ("openpbr, subsurface_weight: 1, subsurface_scatter_anisotropy: 2", "subsurface_scatter_anisotropy"),
        ("principled, subsurface: -0.5", "subsurface"),
        ("principled, subsurface: 1, subsurface_method: walk", "subsurface_method"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("scene.steradian");
        std::fs::write(&path, text("", &format!("material: {material}"))).expect("written");
        let loaded = load(&path, &Options::default());
        let compiled = compile(&loaded.desc, &CompileOptions::default());
        let all = loaded.diagnostics.iter().chain(compiled.diagnostics.iter());
        let told = all.map(|d| d.message.clone()).collect::<Vec<_>>().join("; ");
        assert!(told.contains(name), "{material}: {told}");
    }
}

/// glTF's KHR_materials_volume_scatter below KHR_materials_diffuse_transmission: a cube of a dense medium, whose
/// boundary lets all pass that its facets do not reflect. Of light that meets the face straight on the part E enters
/// less, and what comes to it from within is diffuse and reflected by Ē, so that `E + (1 − E)(1 − Ē) c/(1 − Ē c)` comes
/// back where `c` is the multi-scatter albedo: E is 0.04 for an index of 1.5, Ē = 2 ∫ F μ dμ of
/// Schlick's F is 0.04 + 0.96/21.
#[test]
fn media_of_gltf_have_their_multiscatter_colour() {
    let folder = tempfile::tempdir().expect("a folder");
    let corner = |k: u32| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.0f32 } else { -1.0 });
    let faces: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut bytes: Vec<u8> = faces.iter().flatten().flat_map(|k| corner(*k)).flat_map(f32::to_le_bytes).collect();
    let indices = (0..6u16).flat_map(|f| [0, 1, 2, 0, 2, 3].map(|k| 4 * f + k));
    bytes.extend(indices.flat_map(u16::to_le_bytes));
    std::fs::write(folder.path().join("cube.bin"), &bytes).expect("written");
    let scale = (-1.0f64).exp();
    let gltf = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0, 1]}}],
        "nodes": [{{"mesh": 0}}, {{"camera": 0, "translation": [0, 0, 5]}}],
        "cameras": [{{"type": "orthographic",
            "orthographic": {{"xmag": 0.3, "ymag": 0.3, "znear": 0.1, "zfar": 100}}}}],
        "extensionsUsed": ["KHR_materials_volume", "KHR_materials_volume_scatter",
            "KHR_materials_diffuse_transmission"],
        "materials": [{{"pbrMetallicRoughness": {{"metallicFactor": 0, "roughnessFactor": 0}}, "extensions": {{
            "KHR_materials_diffuse_transmission": {{"diffuseTransmissionFactor": 1}},
            "KHR_materials_volume": {{"thicknessFactor": 1, "attenuationDistance": 0.01,
                "attenuationColor": [{scale}, {scale}, {scale}]}},
            "KHR_materials_volume_scatter": {{"multiscatterColor": [0.8, 0.5, 0.2]}}}}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3",
                "min": [-1, -1, -1], "max": [1, 1, 1]}},
            {{"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 288}}, {{"buffer": 0, "byteOffset": 288, "byteLength": 72}}],
        "buffers": [{{"uri": "cube.bin", "byteLength": 360}}]}}"#
    );
    let path = folder.path().join("cube.gltf");
    std::fs::write(&path, gltf).expect("written");
    let import = load(&path, &Options::default());
    assert!(import.diagnostics.iter().all(|d| d.severity < Severity::Error), "{:?}", import.diagnostics);
    let mut desc = import.desc;
    let sky = desc.add(Node::new(Family::Light, "environment", None).with("radiance", 1.0));
    desc.lights = vec![sky];
    let options = CompileOptions { mode: Some(ColorMode::Rgb), size: Some((12, 12)), ..CompileOptions::default() };
    let scene = Arc::new(compile(&desc, &options).scene.expect("a scene"));
    let quality = Quality {
        integrator: Some("volpath:max_depth=10000".into()),
        spp: Some(48),
        seed: Some(1),
        ..Quality::default()
    };
    let picture = render(&scene, &quality).expect("a picture");
    let (face, mean) = (0.04, 0.04 + 0.96 / 21.0);
    for (name, c) in ["R", "G", "B"].into_iter().zip(COLOR) {
        let plane = picture.channel(name).expect("a colour");
        let found = plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64;
        let expected = face + (1.0 - face) * (1.0 - mean) * c / (1.0 - mean * c);
        assert!((found - expected).abs() < 0.02, "{name}: {found}, not {expected}");
    }
}

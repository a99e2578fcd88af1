//! glTF's single-sided faces: rays of every kind pass those that they meet from behind.

use steradian::{
    CompileOptions, Quality, Scene, compile, load,
    math::{Ray, Vec3},
    render,
};

/// A triangle that faces +z, with a material and a scale of its node, before a white sky, seen from z = 3 or -3. It
/// stands at so many places, of which the first is at the origin; more than one are instances.
fn scene_of(material: &str, scale: &str, is_behind: bool, places: usize) -> Scene {
    let turn = if is_behind { r#""translation":[0,0,-3],"rotation":[0,1,0,0]"# } else { r#""translation":[0,0,3]"# };
    let instanced = r#","extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}"#;
    let instanced = if places > 1 { instanced } else { "" };
    let corners = [-9.0_f32, -9.0, 0.0, 9.0, -9.0, 0.0, 0.0, 9.0, 0.0];
    let translations = (0..places).flat_map(|i| [100.0 * i as f32, 0.0, 0.0]);
    let numbers: Vec<u8> = corners.into_iter().chain(translations).flat_map(|v| v.to_le_bytes()).collect();
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,1]}}],
        "nodes":[{{"mesh":0,"scale":{scale}{instanced}}},{{"camera":0,{turn}}}],
        "cameras":[{{"type":"perspective","perspective":{{"yfov":0.2,"znear":0.1,"aspectRatio":1}}}}],
        "extensionsUsed":["KHR_materials_unlit","KHR_materials_transmission","EXT_mesh_gpu_instancing"],"materials":[{material}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-9,-9,0],"max":[9,9,0]}},
        {{"bufferView":0,"byteOffset":36,"componentType":5126,"count":{places},"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}}],"buffers":[{{"byteLength":{length},"uri":"t.bin"}}]}}"#,
        length = numbers.len()
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.bin"), numbers).unwrap();
    let path = folder.path().join("scene.gltf");
    std::fs::write(&path, text).unwrap();
    let loaded = load(&path, &Default::default());
    assert!(!loaded.diagnostics.has_errors(), "{:?}", loaded.diagnostics);
    compile(&loaded.desc, &CompileOptions { size: Some((8, 8)), ..CompileOptions::default() }).scene.expect("a scene")
}

const MIRRORED: &str = "[-1,1,1]";
const PLAIN: &str = "[1,1,1]";

/// Single rays and many at once, of surfaces in the world and of groups, mirrored ones too.
#[test]
fn rays_pass_the_back() {
    let transmits = r#"{"extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5}}}"#;
    let cases = [("{}", false), (r#"{"doubleSided":true}"#, true), (transmits, true)];
    for (material, is_met) in cases {
        for (scale, places) in [(PLAIN, 1), (MIRRORED, 1), (PLAIN, 20), (MIRRORED, 20)] {
            let scene = scene_of(material, scale, false, places);
            assert_eq!(scene.placements().is_empty(), places == 1);
            let rays: Vec<Ray> = (0..256)
                .map(|i| {
                    let side = if i % 2 == 0 { 1.0 } else { -1.0 };
                    let aside = Vec3::new(0.01 * (i / 16) as f32, 0.01 * (i % 16) as f32, 0.0);
                    Ray { t_max: 4.0, ..Ray::new(aside + Vec3::Z * side, Vec3::Z * -side) }
                })
                .collect();
            let (mut hits, mut occluded) = (vec![None; 256], vec![false; 256]);
            scene.intersect_batch(&rays, &mut hits);
            scene.occluded_batch(&rays, &mut occluded);
            for (i, ray) in rays.iter().enumerate() {
                let expected = i % 2 == 0 || is_met;
                let found = [scene.intersect(ray).is_some(), hits[i].is_some(), scene.occluded(ray), occluded[i]];
                assert_eq!(found, [expected; 4], "{material}, scale {scale}, {places} places, ray {i}");
            }
        }
    }
}

/// From behind there is the sky, for every method; a face that looks the same in any light has its colour from the
/// front.
#[test]
fn every_method_sees_the_sky_from_behind() {
    let material = |more: &str| {
        format!(
            r#"{{"pbrMetallicRoughness":{{"baseColorFactor":[0,0.25,0,1]}},{more}
            "extensions":{{"KHR_materials_unlit":{{}}}}}}"#
        )
    };
    let mean = |scene: Scene, integrator: &str| {
        let scene = &std::sync::Arc::new(scene);
        let quality = Quality { integrator: Some(integrator.into()), spp: Some(4), ..Quality::default() };
        let picture = render(scene, &quality).expect("a picture");
        picture.channel("R").unwrap().iter().map(|v| f64::from(*v)).sum::<f64>() / 64.0
    };
    for integrator in ["path", "volpath", "direct", "whitted", "raster"] {
        let red = |more: &str, is_behind| mean(scene_of(&material(more), PLAIN, is_behind, 1), integrator);
        assert!(red("", true) > 0.1, "{integrator}: the sky is red too, {}", red("", true));
        for (more, is_behind) in [("", false), ("\"doubleSided\":true,", false), ("\"doubleSided\":true,", true)] {
            assert!(red(more, is_behind) < 1e-6, "{integrator}: {more} {is_behind}: {}", red(more, is_behind));
        }
    }
}

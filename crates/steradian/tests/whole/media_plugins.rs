//! Every medium of pbrt-v4 with every parameter that its manual has, as files: each is read and compiled without a
//! word; what is no parameter, and what there is not, is named. And what glowing ones look like.

use std::path::Path;
use steradian::{CompileOptions, Quality, compile, formats::Options, load, render};
use steradian_testkit::nanovdb;

/// A box of a medium, from z = 0 to 1, before an orthographic camera.
fn boxed(medium: &str, light: &str) -> String {
    format!(
        r#"LookAt 0 0 -3  0 0 0  0 1 0
        Camera "orthographic" "float screenwindow" [-.3 .3 -.3 .3]
        Film "rgb" "integer xresolution" 8 "integer yresolution" 8
        PixelFilter "box"
        Integrator "volpath" "integer maxdepth" 100
        WorldBegin
        {light}
        MakeNamedMedium "m" "string type" {medium}
        MediumInterface "m" ""
        Material "interface"
        Shape "trianglemesh" "point3 P" [-2 -2 0 2 -2 0 2 2 0 -2 2 0  -2 -2 1 2 -2 1 2 2 1 -2 2 1]
            "integer indices" [0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  3 7 6 3 6 2  0 4 7 0 7 3  1 2 6 1 6 5]"#
    )
}

/// Messages about a scene on its way to the render, without the one that the sampler is ours.
fn said(folder: &Path, text: &str) -> Vec<String> {
    let path = folder.join("scene.pbrt");
    std::fs::write(&path, text).unwrap();
    let loaded = load(path, &Options::default());
    let messages = |d: &steradian::scene::Diagnostics| {
        d.iter().map(|d| d.message.clone()).filter(|m| !m.starts_with("sampler ")).collect::<Vec<_>>()
    };
    let mut all = messages(&loaded.diagnostics);
    if !loaded.diagnostics.has_errors() {
        let compiled = compile(&loaded.desc, &CompileOptions::default());
        all.extend(messages(&compiled.diagnostics));
        assert_eq!(compiled.scene.is_none(), compiled.diagnostics.has_errors());
    }
    all
}

const LAMP: &str = r#"LightSource "infinite""#;
const SIZE: &str = r#""integer nx" 2 "integer ny" 1 "integer nz" 1 "point3 p0" [-2 -2 0] "point3 p1" [2 2 1]"#;

#[test]
fn all_parameters_of_pbrt() {
    let folder = tempfile::tempdir().unwrap();
    let sigma = r#""rgb sigma_a" [.1 .2 .3] "spectrum sigma_s" [300 1 900 2] "float g" .3"#;
    let grid = format!(r#"{SIZE} {sigma} "float density" [1 2] "float scale" 2"#);
    let colors = r#""rgb sigma_a" [.1 .2 .3 .4 .5 .6]"#;
    let lit = [
        format!(r#""homogeneous" {sigma} "float scale" 2"#),
        r#""homogeneous" "string preset" "Wholemilk" "float scale" 2 "float g" -.3"#.into(),
        format!(r#""uniformgrid" {grid}"#),
        format!(r#""rgbgrid" {SIZE} {colors} "rgb sigma_s" [1 1 1 2 2 2] "float scale" 2 "float g" .3"#),
        format!(r#""rgbgrid" {SIZE} {colors}"#),
        format!(r#""rgbgrid" {SIZE} "rgb sigma_s" [1 1 1 2 2 2]"#),
        format!(
            r#""cloud" "float density" 2 "float wispiness" .5 "float frequency" 4 {sigma}
            "point3 p0" [-2 -2 0] "point3 p1" [2 2 1]"#
        ),
    ];
    // These are lights themselves.
    let glowing = [
        format!(r#""homogeneous" {sigma} "blackbody Le" 3000 "float Lescale" 2"#),
        r#""homogeneous" "string preset" "Coke" "rgb Le" [1 2 3]"#.into(),
        format!(r#""uniformgrid" {grid} "rgb Le" [1 2 3]"#),
        format!(r#""uniformgrid" {grid} "spectrum Le" [300 1 900 2] "float Lescale" [1 2]"#),
        format!(r#""uniformgrid" {grid} "float temperature" [3000 4000]"#),
        format!(
            r#""uniformgrid" {grid} "float temperature" [3000 4000] "float Lescale" [1 2]
            "float temperatureoffset" 100 "float temperaturescale" 1.5"#
        ),
        format!(r#""uniformgrid" {grid} "float temperature" [3000 4000] "float temperaturecutoff" 100"#),
        format!(r#""rgbgrid" {SIZE} {colors} "rgb Le" [1 2 3 4 5 6]"#),
        format!(r#""rgbgrid" {SIZE} {colors} "rgb Le" [1 2 3 4 5 6] "float Lescale" 2"#),
    ];
    for (media, light) in [(&lit[..], LAMP), (&glowing[..], "")] {
        for medium in media {
            assert_eq!(said(folder.path(), &boxed(medium, light)), [""; 0], "{medium}");
            let wrong = said(folder.path(), &boxed(&format!("{medium} \"float nothing\" 1"), light));
            assert!(wrong.len() == 1 && wrong[0].contains("'nothing'"), "{medium}: {wrong:?}");
        }
    }
    let grids = [nanovdb("d", [2; 3], &[1.0; 8]), nanovdb("t", [1; 3], &[3000.0])];
    std::fs::write(folder.path().join("c.nvdb"), grids.concat()).unwrap();
    let vdb = format!(
        r#""nanovdb" "string filename" "c.nvdb" "string gridname" "d" "string temperaturename" "t" "float Lescale" 2
        "float temperatureoffset" 100 "float temperaturescale" 2 {sigma} "float scale" 2"#
    );
    assert_eq!(said(folder.path(), &boxed(&vdb, "")), [""; 0]);
    for (name, bytes, fault) in
        [("e.nvdb", &b""[..], "by its first bytes"), ("s.nvdb", &grids[0][..800], "ends within")]
    {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        let refused = said(folder.path(), &boxed(&vdb.replace("c.nvdb", name), LAMP));
        assert!(refused.len() == 1 && refused[0].contains(fault), "{refused:?}");
    }
    let other = said(folder.path(), &boxed(&vdb.replace(r#""d""#, r#""e""#), LAMP));
    assert!(other.len() == 1 && other[0].contains("no grid 'e' (it has: d, t)"), "{other:?}");
    let both = format!(r#""uniformgrid" {grid} "rgb Le" [1 2 3] "float temperature" [3000 4000]"#);
    let refused = said(folder.path(), &boxed(&both, ""));
    assert!(refused.len() == 1 && refused[0].contains("not by both"), "{refused:?}");
}

/// A volume file is, to the bit, the grid of its numbers with a voxel of zeros around them, where the matrix places it,
/// and so is a grid of temperatures that has another box.
#[test]
fn volumes_of_files_are_grids() {
    let folder = tempfile::tempdir().unwrap();
    let number = |[x, y, z]: [usize; 3]| (x + 2 * y + 3 * z + 1) as f32;
    // Four × three × two voxels, and the zeros.
    let (size, around) = ([4, 3, 2], [6, 5, 4]);
    let voxels = |[nx, ny, nz]: [usize; 3]| {
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    };
    let density: Vec<f32> = voxels(size).map(number).collect();
    let inner = |at: [usize; 3]| {
        let index: [usize; 3] = std::array::from_fn(|a| at[a].wrapping_sub(1));
        (0..3).all(|a| index[a] < size[a]).then_some(index)
    };
    let list = |value: &dyn Fn([usize; 3]) -> f32| {
        voxels(around).map(|at| inner(at).map_or(0.0, value).to_string()).collect::<Vec<_>>().join(" ")
    };
    let heat = |index: [usize; 3]| if index.iter().all(|i| *i < 2) { 4000.0 } else { 0.0 };
    let files = [nanovdb("density", size, &density), nanovdb("temperature", [2; 3], &[4000.0; 8])];
    let coefficients = r#""rgb sigma_a" [.5 .3 .2] "rgb sigma_s" [.1 .2 .3] "float scale" .5"#;
    let bounds = r#""point3 p0" [-1.5 -1.5 -1.5] "point3 p1" [4.5 3.5 2.5]"#;
    let cells = r#""integer nx" 6 "integer ny" 5 "integer nz" 4"#;
    for (count, temperature) in [(1, String::new()), (2, format!(r#""float temperature" [{}]"#, list(&heat)))] {
        std::fs::write(folder.path().join("c.nvdb"), files[..count].concat()).unwrap();
        let grid = format!(r#""uniformgrid" {cells} {bounds} "float density" [{}] {temperature}"#, list(&number));
        let [file, grid] = [r#""nanovdb" "string filename" "c.nvdb""#, &grid].map(|medium| {
            let place = format!("{LAMP} AttributeBegin Scale .125 .125 .125 Translate -1.5 -1 3");
            let scene = boxed(&format!("{medium} {coefficients} AttributeEnd"), &place);
            assert_eq!(said(folder.path(), &scene), [""; 0]);
            seen_in(folder.path(), &scene, 16)
        });
        assert_eq!(file, grid, "{count} grids");
    }
}

fn seen(text: &str) -> [f64; 3] {
    let folder = tempfile::tempdir().unwrap();
    seen_in(folder.path(), text, 1024)
}

/// Means of a picture.
fn seen_in(folder: &Path, text: &str, spp: u32) -> [f64; 3] {
    let path = folder.join("scene.pbrt");
    std::fs::write(&path, text).unwrap();
    let scene = compile(&load(&path, &Options::default()).desc, &CompileOptions::default()).scene.expect("a scene");
    let picture =
        render(&std::sync::Arc::new(scene), &Quality { spp: Some(spp), ..Quality::default() }).expect("a picture");
    ["R", "G", "B"].map(|c| picture.channel(c).unwrap().iter().map(|v| f64::from(*v)).sum::<f64>() / 64.0)
}

fn is_near(what: &str, found: [f64; 3], expected: [f64; 3]) {
    for (f, e) in found.iter().zip(expected) {
        assert!((f / e - 1.0).abs() < 0.02, "{what}: {found:?}, not {expected:?}");
    }
}

/// ∫ B(T(z)) σ(z) e^(−∫σ) dz by pbrt's formulae, where density and temperature fade to half at both faces; B is
/// Planck's law over its maximum times the unnormalised CIE curves. The numbers are from quadrature elsewhere; 2 % is
/// five times the standard error.
#[test]
fn glowing_grids_are_as_bright_as_in_pbrt() {
    let absorbing = r#""spectrum sigma_a" [300 1 900 1] "spectrum sigma_s" [300 0 900 0]"#;
    let grid = |kelvin: f64, more: &str| {
        let kelvin = [kelvin; 8].map(|t| t.to_string()).join(" ");
        let medium = format!(
            r#""uniformgrid" {absorbing} "integer nx" 2 "integer ny" 2 "integer nz" 2 "point3 p0" [-2 -2 0]
            "point3 p1" [2 2 1] "float density" [1 1 1 1 1 1 1 1] "float temperature" [{kelvin}] {more}"#
        );
        seen(&boxed(&medium, ""))
    };
    is_near("3000 K", grid(3000.0, ""), [34.724, 15.823, 4.765]);
    let scaled = grid(4000.0, r#""float temperatureoffset" 1000 "float temperaturescale" 2"#);
    is_near("(4000 K − 1000 K) · 2", scaled, [62.670, 51.165, 44.849]);
    // Constant within the box seen: Le (1 − e^(−σ)) σ_a/σ, here of Le times ∫ȳ, and of σ_a = σ.
    let part = 106.856_895 * (1.0 - (-1.0_f64).exp());
    let even = r#""rgbgrid" "rgb sigma_a" [1 1 1] "rgb sigma_s" [0 0 0] "rgb Le" [1 .5 .25] "float Lescale" 2
        "point3 p0" [-1e4 -1e4 -1e4] "point3 p1" [1e4 1e4 1e4]"#;
    is_near("colours", seen(&boxed(even, "")), [2.0 * part, part, 0.5 * part]);
}

/// Scenes that have media are rendered with them where the file names no integrator, and where one is named that leaves
/// them out, that is said: of each format.
#[test]
fn media_are_rendered_unless_a_path_tracer_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let read = |path: &Path| {
        let loaded = load(path, &Options::default());
        let compiled = compile(&loaded.desc, &CompileOptions::default());
        let said: Vec<_> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
        (compiled.scene.unwrap_or_else(|| panic!("{said:?}")), said)
    };
    let pbrt = boxed(r#""homogeneous""#, LAMP);
    let named = pbrt.replace("\"volpath\"", "\"path\"");
    let unnamed = pbrt.replace("Integrator \"volpath\" \"integer maxdepth\" 100", "");
    let mitsuba = |integrator: &str| {
        format!(
            "<scene version='3.0.0'>{integrator}<sensor type='perspective'/><emitter type='constant'/>
             <shape type='cube'><bsdf type='null'/><medium name='interior' type='homogeneous'/></shape></scene>"
        )
    };
    let triangle = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let gltf = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "extensionsUsed":["KHR_materials_transmission","KHR_materials_volume"],
        "materials":[{{"extensions":{{"KHR_materials_transmission":{{"transmissionFactor":1}},
        "KHR_materials_volume":{{"thicknessFactor":1,"attenuationDistance":1,"attenuationColor":[0.1,0.5,0.9]}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{triangle}"}}]}}"#
    );
    for (name, text) in [("u.pbrt", unnamed), ("u.xml", mitsuba("")), ("u.gltf", gltf)] {
        let (scene, said) = read(&file(name, &text));
        let render = Quality::default().render(&scene).unwrap();
        assert_eq!((scene.has_media(), render.name), (true, "volpath"), "{name}: {said:?}");
        assert_eq!(render.left_out(&scene), None);
    }
    for (name, text) in [("n.pbrt", named), ("n.xml", mitsuba("<integrator type='path'/>"))] {
        let (scene, said) = read(&file(name, &text));
        for quality in [Quality::default(), Quality::of("path")] {
            let render = quality.render(&scene).unwrap();
            let left_out = render.left_out(&scene).expect("media are left out");
            let (what, instead) = (left_out.missing(), left_out.instead);
            assert_eq!((render.name, &*what, instead), ("path", "participating media", "volpath"), "{name}: {said:?}");
        }
    }
}

//! Scenes of other formats, written in Steradian's own language and read again, give the same pictures bit for bit.

#![expect(clippy::print_stdout, reason = "tests say what they skipped and measured")]

use std::path::{Path, PathBuf};
use steradian::{
    CompileOptions, Loaded, Quality, compile,
    formats::{Options, native},
    image::Image,
    load, render,
    scene::SceneDesc,
};

fn picture(desc: &SceneDesc, name: &str) -> Image {
    let options = CompileOptions { size: Some((24, 18)), ..CompileOptions::default() };
    let compiled = compile(desc, &options);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{name}: {:?}", compiled.diagnostics));
    let integrator = Some("path:reuse=1,caustics=false,effort=even,max_depth=4".to_owned());
    render(&std::sync::Arc::new(scene), &Quality { spp: Some(2), integrator, ..Quality::default() }).expect(name)
}

fn goes_around(path: &Path) {
    let name = path.display().to_string();
    let Loaded { desc, diagnostics, .. } = load(path, &Options::default());
    assert!(!diagnostics.has_errors(), "{name}: {diagnostics:?}");
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("scene.steradian");
    let written = native::write(&desc, &own).expect(&name);
    for (file, bytes) in &written.files {
        let file = folder.path().join(file);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        std::fs::write(file, bytes).expect("written");
    }
    std::fs::write(&own, &written.text).expect("written");
    let again = load(&own, &Options::default());
    assert!(!again.diagnostics.has_errors(), "{name}: {:?}", again.diagnostics);
    assert_eq!(native::write(&again.desc, &own).expect(&name).text, written.text, "{name}");
    assert_eq!(again.desc.meshes, desc.meshes, "{name}");
    let (before, after) = (picture(&desc, &name), picture(&again.desc, &name));
    for (a, b) in before.channels().iter().zip(after.channels()) {
        let differ = a.data.iter().zip(&b.data).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        assert_eq!(differ, 0, "{name}: values of {} that differ", a.name);
    }
}

#[test]
fn our_scenes_go_around() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for name in ["showcase.pbrt", "showcase.xml", "gem.ply"] {
        goes_around(&root.join(name));
    }
    for scene in ["builtin:cornell-box", "builtin:veach-mis"] {
        if !load(scene, &Options::default()).diagnostics.has_errors() {
            goes_around(Path::new(scene));
        }
    }
}

/// Scene files below a folder, at most so many bytes large.
fn scenes(folder: &Path, most: u64, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        let small = entry.metadata().is_ok_and(|m| m.len() <= most);
        if path.is_dir() {
            scenes(&path, most, found);
        } else if small && path.extension().is_some_and(|e| ["pbrt", "xml", "glb", "gltf"].iter().any(|k| e == *k)) {
            found.push(path);
        }
    }
}

#[test]
fn shared_scenes_go_around() {
    let Some(assets) = steradian_testkit::asset("") else { return };
    let mut found = Vec::new();
    scenes(&assets, 300_000, &mut found);
    found.sort();
    assert!(!found.is_empty(), "no scene in {}", assets.display());
    let mut gone = 0;
    for path in &found {
        // Parts of scenes and files for tests of faults are not scenes by themselves.
        let Loaded { desc, diagnostics, .. } = load(path, &Options::default());
        let is_light = desc.face_count() < 300_000 && desc.meshes.iter().map(|m| m.bytes()).sum::<usize>() < 20 << 20;
        let complete = !diagnostics.has_errors() && !desc.cameras.is_empty() && is_light;
        if complete
            && compile(&desc, &CompileOptions { size: Some((4, 4)), ..CompileOptions::default() }).scene.is_some()
        {
            goes_around(path);
            gone += 1;
        }
    }
    println!("{gone} of {} files went around", found.len());
    assert!(gone > 20, "only {gone} of {}", found.len());
}

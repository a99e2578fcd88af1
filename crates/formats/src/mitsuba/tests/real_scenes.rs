//! Published scenes, read whole.

use super::*;
use crate::mitsuba::import;

fn xml_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            xml_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "xml") {
            found.push(path);
        }
    }
}

/// The scenes of a folder without the parts that only make sense when included.
fn scenes(sub: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    xml_files(&shared(sub), &mut found);
    found.retain(|p| {
        !p.components().any(|c| ["fragments", "include"].contains(&c.as_os_str().to_str().unwrap_or_default()))
    });
    if found.is_empty() {
        println!("skipped: no scenes in {sub}");
    }
    found
}

#[test]
fn published_scenes_are_read_whole() {
    for file in scenes("assets/mitsuba").into_iter().chain(scenes("peers/scenes")) {
        let import = import(&file, &Options::default());
        // A mesh of the last scene is generated, and may not be there.
        let errors: Vec<String> = errors(&import).into_iter().filter(|e| !e.contains("displaced_1m.ply")).collect();
        assert_eq!(errors, Vec::<String>::new(), "{}", file.display());
        assert!(!import.diagnostics.is_lossy(), "{}", file.display());
        let unused = |d: &&Diagnostic| d.fidelity == Some(steradian_scene::Fidelity::Unused);
        assert_eq!(import.diagnostics.iter().find(unused), None, "{}", file.display());
        let desc = &import.desc;
        assert!(desc.cameras.len() == 1 && desc.face_count() > 0, "{}", file.display());
        assert!(!desc.lights.is_empty() || desc.shapes.iter().any(|s| s.emission.is_some()), "{}", file.display());
        for mesh in &desc.meshes {
            mesh.validate().unwrap();
        }
    }
}

#[test]
fn the_cornell_box_is_what_it_says() {
    let file = shared("assets/mitsuba/cornell-box/scene_v3.xml");
    if !file.exists() {
        println!("skipped: {} is absent", file.display());
        return;
    }
    let desc = import(&file, &Options::default()).desc;
    assert_eq!(desc.node(desc.integrator.unwrap()).int("max_depth"), Some(64));
    let film = desc.node(desc.film.unwrap());
    assert_eq!((film.int("width"), desc.node(desc.filter.unwrap()).kind.as_str()), (Some(1024), "tent"));
    let camera = only(&desc, &desc.cameras);
    assert_eq!((camera.float("fov"), camera.string("fov_axis")), (Some(19.5), Some("x")));
    let to_world = camera.transform("to_world").unwrap();
    let axes = [steradian_math::DVec3::X, steradian_math::DVec3::Z].map(|a| to_world.vector(a).to_array());
    assert_eq!(axes, [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]);
    let lamps: Vec<_> = desc.shapes.iter().filter_map(|s| s.emission).collect();
    assert_eq!(only(&desc, &lamps).get("radiance"), Some(&rgb([17.0, 12.0, 4.0])));
    assert_eq!((desc.shapes.len(), desc.face_count()), (8, 36));
}

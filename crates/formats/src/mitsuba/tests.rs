//! Tests of the whole reader.

use super::*;
use std::path::PathBuf;
use steradian_scene::{Diagnostic, Severity};

fn assets(sub: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")).join(sub)
}

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

#[test]
fn real_scenes_are_read_without_errors() {
    let mut files = Vec::new();
    xml_files(&assets("assets/mitsuba"), &mut files);
    xml_files(&assets("peers/scenes"), &mut files);
    if files.is_empty() {
        println!("skipped: there are no scenes");
        return;
    }
    for file in files {
        let start = std::time::Instant::now();
        let import = import(&file, &Options::default());
        println!(
            "{} {:?} shapes {} faces {}",
            file.display(),
            start.elapsed(),
            import.desc.shapes.len(),
            import.desc.face_count()
        );
        for d in import.diagnostics.iter() {
            println!("{d}");
        }
    }
}

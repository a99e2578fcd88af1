//! Opening scenes of any format.

use crate::cornell;
use std::{path::Path, time::Duration, time::Instant};
use steradian_formats::{Import, Options};
use steradian_scene::{Diagnostic, Diagnostics, SceneDesc, Severity};

/// A scene as it was read.
#[derive(Debug)]
pub struct Loaded {
    /// The description; complete where there are no errors.
    pub desc: SceneDesc,
    /// What the reader has to say.
    pub diagnostics: Diagnostics,
    /// Time spent reading.
    pub time: Duration,
}

/// The formats by extension: what is read, and with what.
pub const EXTENSIONS: &[(&str, &str)] = &[
    ("pbrt", "pbrt-v4 scene, also gzip-compressed (.pbrt.gz)"),
    ("xml", "Mitsuba scene: version 3, 2, or 0.6"),
    ("obj", "Wavefront model with materials"),
    ("ply", "polygon model"),
];

/// Reads a scene. `builtin:NAME` names one of the built-in scenes ([`cornell::BUILTIN`]); other names are files, told apart by
/// extension, then by content.
pub fn load(name: &str, options: &Options) -> Loaded {
    let start = Instant::now();
    let import = read(name, options);
    Loaded { desc: import.desc, diagnostics: import.diagnostics, time: start.elapsed() }
}

fn read(name: &str, options: &Options) -> Import {
    if let Some(builtin) = name.strip_prefix("builtin:") {
        return match cornell::builtin(builtin) {
            Some(desc) => Import { desc, diagnostics: Diagnostics::default() },
            None => {
                let known = cornell::BUILTIN.iter().map(|b| b.0).collect::<Vec<_>>().join(", ");
                failed(format!("there is no built-in scene '{builtin}'"), Some(format!("built in are {known}")))
            }
        };
    }
    let path = Path::new(name);
    if !path.exists() {
        return failed(format!("cannot find the scene '{name}'"), None);
    }
    if path.is_dir() {
        return failed(format!("'{name}' is a folder; give the scene file in it"), None);
    }
    let lower = name.to_ascii_lowercase();
    let stem = lower.strip_suffix(".gz").unwrap_or(&lower);
    match Path::new(stem).extension().and_then(|e| e.to_str()) {
        Some("pbrt") => steradian_formats::pbrt::import(path, options),
        Some("xml") => steradian_formats::mitsuba::import(path, options),
        Some("obj" | "ply") => steradian_formats::mesh::model::import(path, options),
        Some("gltf" | "glb") => failed("glTF scenes are not implemented yet".into(), None),
        _ => {
            let known = EXTENSIONS.iter().map(|e| format!(".{}", e.0)).collect::<Vec<_>>().join(", ");
            failed(format!("'{name}' is not a kind of scene that can be read"), Some(format!("known are {known}")))
        }
    }
}

fn failed(message: String, help: Option<String>) -> Import {
    let mut import = Import::default();
    import.diagnostics.push(Diagnostic { severity: Severity::Error, fidelity: None, message, location: None, help });
    import
}

//! From a [`SceneDesc`] to the files of other programs.
//!
//! A writer says exactly what the description says, approximates it, or leaves it out, and reports the last two by name
//! in [`Written::diagnostics`]. Meshes and pictures that the format cannot hold become files beside the document.

mod coat;
mod colour;
mod exchange;
mod frame;
mod gltf;
mod mesh;
mod mitsuba;
mod pbrt;
mod picture;
mod solid;
mod surface;

pub use mesh::{MESH_EXTENSIONS, placed, triangulated, write_mesh};

use crate::native;
use std::path::{Path, PathBuf};
use steradian_scene::{Diagnostics, SceneDesc};

/// A document, what goes beside it, and what it does not say as the description does.
#[derive(Debug, Default)]
pub struct Written {
    /// The document.
    pub bytes: Vec<u8>,
    /// Meshes and pictures by their names relative to the document.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// Approximations and omissions, with positions in the files that were read.
    pub diagnostics: Diagnostics,
}

/// The extensions of documents that can be written, and what they are.
pub const EXTENSIONS: &[(&str, &str)] = &[
    ("steradian", "Steradian's own language"),
    ("xml", "Mitsuba 3"),
    ("pbrt", "pbrt-v4"),
    ("gltf", "glTF 2.0"),
    ("glb", "glTF 2.0 in one file"),
];

/// Writes a description in the format that the extension of `path` names; `path` is where the document will be, so that
/// files are named from there.
///
/// # Errors
/// A message, where the extension is none of [`EXTENSIONS`], or something has no place in the notation: numbers that
/// are NaN, paths that are not UTF-8.
pub fn write(desc: &SceneDesc, path: &Path) -> Result<Written, String> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    if extension == "steradian" {
        let native::Written { text, files } = native::write(desc, path)?;
        return Ok(Written { bytes: text.into_bytes(), files, diagnostics: Diagnostics::default() });
    }
    // Materials of other formats have no light and no medium of their own.
    let carried = steradian_scene::carried(desc);
    let (desc, told) = carried.as_ref().map_or((desc, [].as_slice()), |(desc, told)| (desc, told.as_slice()));
    let mut written = match extension.as_str() {
        "xml" => mitsuba::write(desc, path),
        "pbrt" => pbrt::write(desc, path),
        "gltf" => gltf::write(desc, path, false),
        "glb" => gltf::write(desc, path, true),
        _ => {
            let known = EXTENSIONS.iter().map(|(e, what)| format!(".{e} ({what})")).collect::<Vec<_>>().join(", ");
            Err(format!("'{}': scenes are written as {known}; other formats are read only", path.display()))
        }
    }?;
    for (id, what) in told {
        written.diagnostics.approximated(&desc.sources, desc.node(*id).span, what.clone());
    }
    Ok(written)
}

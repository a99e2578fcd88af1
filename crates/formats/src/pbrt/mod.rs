//! Scenes of pbrt-v4 (<https://pbrt.org/fileformat-v4>).
//!
//! The text is read once, front to back: `lexer` makes tokens, `param` the typed parameters of a directive, `directive`
//! carries directives out on a graphics state, and one file per family (`camera`, `film`, `light`, `material`, …)
//! translates models into Steradian's vocabulary. Nothing recurses on the input, and every fault is reported where it
//! stands while reading goes on.

mod arguments;
mod blocks;
mod build;
mod camera;
mod dict;
mod directive;
mod film;
mod lexer;
mod light;
mod material;
mod medium;
mod mesh_files;
mod option;
mod param;
mod preset;
mod reader;
mod report;
mod sampling;
mod scene;
mod shape;
mod spectrum;
mod state;
mod texture;
mod transform;

#[cfg(test)]
mod tests;

use crate::{
    Import, Options,
    files::{self, SearchPath},
};
use reader::Reader;
use std::path::Path;
use steradian_scene::{Diagnostics, Format, SceneDesc, Sources};

/// Reads a scene file, plain or gzip-compressed, with all files it includes and all meshes it names.
///
/// The description is complete where the diagnostics hold no error. Images and volumes are not read; their paths are
/// resolved.
pub fn import(path: &Path, options: &Options) -> Import {
    match files::read(path, &options.limits) {
        Ok(text) => {
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let mut import = read(path, text, folder, options);
            import.desc.path = Some(path.into());
            import
        }
        Err(fault) => {
            let mut diagnostics = Diagnostics::default();
            diagnostics.error(&Sources::default(), None, fault.to_string());
            Import { desc: SceneDesc { format: Format::Pbrt, ..SceneDesc::default() }, diagnostics }
        }
    }
}

/// Reads a scene from memory. `name` stands for the file in messages; files that the scene names are looked for in
/// `folder` first.
pub fn import_text(name: &str, text: impl Into<Vec<u8>>, folder: &Path, options: &Options) -> Import {
    read(Path::new(name), text.into(), folder, options)
}

fn read(path: &Path, text: Vec<u8>, folder: &Path, options: &Options) -> Import {
    let mut reader = Reader::new(options, SearchPath::new(Some(folder), options));
    reader.read(path, text);
    let mut desc = reader.scene.desc;
    desc.format = Format::Pbrt;
    desc.sources = reader.scene.report.sources;
    Import { desc, diagnostics: reader.scene.report.diagnostics }
}

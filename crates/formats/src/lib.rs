//! Scene and mesh files ⇄ [`steradian_scene::SceneDesc`], with located diagnostics.
//!
//! A reader translates names and conventions, and writes defaults out where those of the format differ from ours, so
//! that later stages need not know the format. The few exceptions are decided by `SceneDesc::format`: the default
//! colour mode, masking–shadowing of microfacets (height-correlated as in pbrt, separable as in Mitsuba), whether
//! models that only reflect do so on both sides (not in Mitsuba), the default size of the frame, the up axis of
//! lat-long images, and the units of projectors.
//!
//! Reading goes on after faults. A message has a severity, a place (`Span`: file, line, column, excerpt with carets),
//! help, and for losses a *fidelity*: `approximated`, `dropped` or `unused`. With `--strict` the first two are errors.
//! Parameters that nothing in a directive reads are reported by the reader, since it knows the file's own names.
//!
//! Sizes that a file declares are held against the bytes present before anything is allocated (`limits`), and
//! nesting is followed with explicit stacks or to a stated depth.

mod companion_files;
pub mod files;
pub mod gltf;
#[cfg(test)]
mod law;
mod limits;
pub mod mesh;
pub mod mitsuba;
pub mod native;
pub mod pbrt;
pub mod readers;
pub mod usd;
pub mod write;
mod xml;

pub use limits::Limits;
pub use readers::Reader;
use std::{collections::BTreeMap, path::PathBuf};
use steradian_math::DVec3;
use steradian_scene::{Diagnostics, SceneDesc};
use steradian_schema::Kinds;

/// Options of the scene readers.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Bounds on what a file may ask for.
    pub limits: Limits,
    /// Values for `$parameters` of Mitsuba scenes, and choices in glTF scenes (`-D name=value`).
    pub defines: BTreeMap<String, String>,
    /// Folders searched after the scene's own.
    pub search: Vec<PathBuf>,
    /// The folder that all files a scene names must be in: of scenes that somebody else sent. Anywhere without.
    pub within: Option<PathBuf>,
    /// The box that the camera of a model without one shows, its corners in the world: of all frames of a sequence. By
    /// default that of the model.
    pub framing: Option<[DVec3; 2]>,
    /// Kinds that files may name beside those of the schema.
    pub kinds: Kinds,
}

/// Result of reading a scene: a description that is complete where there are no errors among the diagnostics.
#[derive(Debug, Default)]
pub struct Import {
    /// The scene.
    pub desc: SceneDesc,
    /// Errors, warnings and notes of the reader.
    pub diagnostics: Diagnostics,
}

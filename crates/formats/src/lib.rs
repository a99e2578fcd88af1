//! Scene and mesh files ⇄ [`steradian_scene::SceneDesc`], with located diagnostics.

mod beside;
pub mod files;
pub mod gltf;
#[cfg(test)]
mod law;
mod limits;
pub mod mesh;
pub mod mitsuba;
pub mod native;
pub mod pbrt;
pub mod write;

pub use limits::Limits;
use std::{collections::BTreeMap, path::PathBuf};
use steradian_math::DVec3;
use steradian_scene::{Diagnostics, SceneDesc};

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
}

/// Result of reading a scene: a description that is complete where there are no errors among the diagnostics.
#[derive(Debug, Default)]
pub struct Import {
    /// The scene.
    pub desc: SceneDesc,
    /// Errors, warnings and notes of the reader.
    pub diagnostics: Diagnostics,
}

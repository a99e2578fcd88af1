//! Scene and mesh files ⇄ [`steradian_scene::SceneDesc`], with located diagnostics.

pub mod files;
pub mod mesh;
pub mod mitsuba;
pub mod pbrt;

use std::{collections::BTreeMap, path::PathBuf};
use steradian_scene::{Diagnostics, SceneDesc};

/// What a reader may use.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Largest file read, in bytes (after gzip too).
    pub file_bytes: u64,
    /// Most files a scene may include, nested or in sequence.
    pub includes: usize,
    /// Deepest nesting of includes.
    pub include_depth: usize,
    /// Deepest nesting of attribute blocks or XML elements.
    pub nesting: usize,
    /// Most instances.
    pub instances: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { file_bytes: 8 << 30, includes: 10_000, include_depth: 15, nesting: 10_000, instances: 50_000_000 }
    }
}

/// How to read a scene.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Bounds on what a file may ask for.
    pub limits: Limits,
    /// Values for `$parameters` of Mitsuba scenes (`-D name=value`).
    pub defines: BTreeMap<String, String>,
    /// Folders searched after the scene's own.
    pub search: Vec<PathBuf>,
}

/// What reading gave: a description that is complete where there are no errors among the diagnostics.
#[derive(Debug, Default)]
pub struct Import {
    /// The scene.
    pub desc: SceneDesc,
    /// What the reader has to say.
    pub diagnostics: Diagnostics,
}

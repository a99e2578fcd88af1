//! Mesh files that shapes name: read once each, in parallel, when the scene text is done.

use super::report::Report;
use crate::{
    Limits, files,
    mesh::{
        ply::{self, PlyFile, PlyOptions},
        recentre,
    },
};
use rayon::prelude::*;
use std::{collections::HashMap, path::PathBuf, sync::Arc};
use steradian_scene::{Mesh, SceneDesc, Span};

/// A file to read, and who asked first.
struct Job {
    mesh: usize,
    path: PathBuf,
    span: Span,
}

/// The files asked for so far.
#[derive(Default)]
pub(super) struct MeshFiles {
    by_path: HashMap<PathBuf, usize>,
    jobs: Vec<Job>,
}

impl MeshFiles {
    /// The index that the file's mesh will have.
    pub fn add(&mut self, desc: &mut SceneDesc, path: PathBuf, span: Span) -> usize {
        if let Some(&mesh) = self.by_path.get(&path) {
            return mesh;
        }
        let mesh = desc.add_mesh(Mesh::default());
        self.by_path.insert(path.clone(), mesh);
        self.jobs.push(Job { mesh, path, span });
        mesh
    }

    /// Reads all files into their places.
    pub fn read(&mut self, desc: &mut SceneDesc, report: &mut Report, limits: &Limits) {
        let jobs = std::mem::take(&mut self.jobs);
        let meshes: Vec<_> = jobs.par_iter().map(|job| read(job, limits)).collect();
        let mut origins = Vec::new();
        for (job, mesh) in jobs.into_iter().zip(meshes) {
            report.sources.add(job.path, Vec::new());
            match mesh {
                Ok(file) => {
                    if let Some(warning) = file.warning() {
                        report.warn(job.span, warning);
                    }
                    origins.push((job.mesh, file.origin));
                    desc.meshes[job.mesh] = Arc::new(file.mesh);
                }
                Err(message) => report.error(job.span, message),
            }
        }
        recentre::put_back(desc, &origins);
    }
}

fn read(job: &Job, limits: &Limits) -> Result<PlyFile, String> {
    let bytes = files::read(&job.path, limits).map_err(|e| e.to_string())?;
    // pbrt renders faces of four corners as bilinear patches.
    let file = ply::read(&bytes, &PlyOptions { keep_quads: true, recentre: true, ..PlyOptions::default() })
        .map_err(|e| format!("cannot read the mesh '{}': {e}", job.path.display()))?;
    match file.mesh.validate() {
        Ok(()) => Ok(file),
        Err(fault) => Err(format!("the mesh '{}' is faulty: {fault}", job.path.display())),
    }
}

//! Mesh files: queued while the scene is translated, read in parallel afterwards.

use super::{normals, reader::Reader};
use crate::{Limits, files, mesh};
use rayon::prelude::*;
use std::{collections::HashMap, path::PathBuf, sync::Arc};
use steradian_math::Transform;
use steradian_scene::{Mesh, Span};

/// The format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum MeshFormat {
    Obj,
    Ply,
    /// With the index of the mesh in the file.
    Serialized(usize),
}

/// Everything the mesh of a shape depends on: shapes that agree in it share the mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct MeshKey {
    pub format: MeshFormat,
    pub path: PathBuf,
    /// Flat shading; `None` leaves it to the file.
    pub face_normals: Option<bool>,
    pub flip_uvs: bool,
    pub flip_normals: bool,
    /// The linear part of a transform under which normals must be computed in the world, as bits.
    linear: Option<[u64; 9]>,
}

impl MeshKey {
    /// A file as it is, placed in the world.
    pub fn new(format: MeshFormat, path: PathBuf, world_from_object: &Transform) -> Self {
        let m = &world_from_object.matrix;
        let linear = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.truncate().to_array());
        let bits = || std::array::from_fn(|i| linear[i / 3][i % 3].to_bits());
        let linear = (!normals::keeps_angles(world_from_object)).then(bits);
        Self { format, path, face_normals: None, flip_uvs: false, flip_normals: false, linear }
    }

    /// The linear part as a transform.
    fn transform(&self) -> Transform {
        let Some(bits) = self.linear else { return Transform::IDENTITY };
        let m = bits.map(f64::from_bits);
        Transform::from_columns([m[0], m[1], m[2], 0., m[3], m[4], m[5], 0., m[6], m[7], m[8], 0., 0., 0., 0., 1.])
    }
}

/// Meshes to read: where each goes, and the shape that first asked for it.
#[derive(Debug, Default)]
pub(super) struct MeshQueue {
    indices: HashMap<MeshKey, usize>,
    jobs: Vec<(MeshKey, usize, Span)>,
}

impl Reader<'_> {
    /// The index that a mesh will have in the description.
    pub fn queue_mesh(&mut self, key: MeshKey, span: Span) -> usize {
        if let Some(&index) = self.meshes.indices.get(&key) {
            return index;
        }
        let index = self.desc.add_mesh(Mesh::default());
        self.meshes.indices.insert(key.clone(), index);
        self.meshes.jobs.push((key, index, span));
        index
    }

    /// Reads all queued meshes into their places.
    pub fn read_meshes(&mut self) {
        let jobs = std::mem::take(&mut self.meshes.jobs);
        let limits = &self.options.limits;
        let read: Vec<Result<Loaded, String>> = jobs.par_iter().map(|(key, ..)| load(key, limits)).collect();
        let mut origins = Vec::new();
        for ((key, index, span), mesh) in jobs.into_iter().zip(read) {
            self.desc.sources.note(key.path);
            match mesh {
                Ok(Loaded { mesh, origin, warning }) => {
                    self.desc.meshes[index] = Arc::new(mesh);
                    origins.push((index, origin));
                    if let Some(warning) = warning {
                        self.warn(span, warning);
                    }
                }
                Err(message) => self.error(span, message),
            }
        }
        mesh::recentre::put_back(&mut self.desc, &origins);
    }
}

/// A mesh, what was taken from its positions, and what is to be said of the file.
struct Loaded {
    mesh: Mesh,
    origin: [f64; 3],
    warning: Option<String>,
}

/// Reads a mesh and makes of it what Mitsuba would.
fn load(key: &MeshKey, limits: &Limits) -> Result<Loaded, String> {
    let mut bytes = files::read(&key.path, limits).map_err(|e| e.to_string())?;
    let fault = |e: mesh::MeshError| format!("cannot read the mesh '{}': {e}", key.path.display());
    let mut flat = key.face_normals.unwrap_or(false);
    let (mut warning, mut origin) = (None, [0.0; 3]);
    let mut mesh = match key.format {
        MeshFormat::Ply => {
            let options = mesh::ply::PlyOptions { recentre: true, ..Default::default() };
            let read = mesh::ply::read(&bytes, &options).map_err(fault)?;
            (warning, origin) = (read.warning(), read.origin);
            read.mesh
        }
        MeshFormat::Obj => {
            let options = mesh::obj::ObjOptions { merge: true, flip_v: key.flip_uvs, recentre: true };
            let read = mesh::obj::read(&mesh::text::to_utf8(std::mem::take(&mut bytes)), &options).map_err(fault)?;
            (warning, origin) = (read.skipped.warning(), read.origin);
            read.meshes.into_iter().next().unwrap_or_default().mesh
        }
        MeshFormat::Serialized(index) => {
            let read = mesh::serialized::read(&bytes, index).map_err(fault)?;
            flat = key.face_normals.unwrap_or(read.face_normals);
            read.mesh
        }
    };
    drop(bytes);
    if flat {
        mesh.normals.clear();
    } else if mesh.normals.is_empty() {
        normals::compute(&mut mesh, &key.transform(), key.format == MeshFormat::Obj);
    }
    if key.flip_uvs && key.format != MeshFormat::Obj {
        normals::flip_uvs(&mut mesh);
    }
    if key.flip_normals {
        normals::flip(&mut mesh);
    }
    Ok(Loaded { mesh, origin, warning })
}

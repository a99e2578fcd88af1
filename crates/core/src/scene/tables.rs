//! Inventory of a scene: number of records of each kind, and their memory.

use super::Scene;
use crate::medium::Field;
use std::{collections::HashSet, sync::Arc};

/// Records of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Table {
    /// Name of the kind.
    pub name: &'static str,
    /// Number of records.
    pub count: usize,
    /// Bytes of the records and of what they point to, each once: vertices, texels, cells.
    pub bytes: usize,
}

impl Scene {
    /// Bytes of shapes and of the structure that rays go through.
    pub fn geometry_bytes(&self) -> usize {
        self.shape_bytes() + self.parts.accel.bytes()
    }

    fn shape_bytes(&self) -> usize {
        let mut seen = HashSet::new();
        let shapes = self.parts.geometries.iter().filter(|g| seen.insert(g.shape.address())).map(|g| g.shape.bytes());
        size_of_val(&self.parts.geometries[..]) + shapes.sum::<usize>()
    }

    /// Its tables. Of materials the records alone count, not the tables of coats and measurements; index lists that
    /// several meshes share count for each of them.
    pub fn tables(&self) -> Vec<Table> {
        let parts = &self.parts;
        let mut fields = HashSet::new();
        let field = |f: &Arc<Field>| if fields.insert(Arc::as_ptr(f)) { f.bytes() } else { 0 };
        let media = size_of_val(&parts.media[..])
            + parts.media.iter().filter_map(|m| m.field.as_ref()).map(field).sum::<usize>();
        let table = |name, count, bytes| Table { name, count, bytes };
        vec![
            table("shapes", parts.geometries.len(), self.shape_bytes()),
            table("instances", parts.placements.len(), size_of_val(&parts.placements[..])),
            table("ray structure", 1, parts.accel.bytes()),
            table("materials", parts.materials.len(), size_of_val(&parts.materials[..])),
            table("textures", parts.textures.len(), parts.textures.bytes()),
            table("lights", parts.lights.lights.len(), parts.lights.bytes()),
            table("media", parts.media.len(), media),
        ]
    }
}

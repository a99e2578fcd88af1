//! What a scene holds: how many records of each kind, and what they take.

use super::Scene;
use crate::{medium::Field, shape::Shape};
use std::{collections::HashSet, sync::Arc};

/// Records of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Table {
    /// What they are.
    pub name: &'static str,
    /// How many.
    pub count: usize,
    /// Bytes of the records and of what they point to, each once: vertices, texels, cells.
    pub bytes: usize,
}

impl Scene {
    /// Its tables. Of materials the records alone count, not the tables of coats and measurements.
    pub fn tables(&self) -> Vec<Table> {
        let parts = &self.parts;
        let mut seen = HashSet::new();
        let geometry = parts.geometries.iter().filter(|g| seen.insert(address(&g.shape))).map(|g| g.shape.bytes());
        let shapes = size_of_val(&parts.geometries[..]) + geometry.sum::<usize>();
        let mut fields = HashSet::new();
        let field = |f: &Arc<Field>| if fields.insert(Arc::as_ptr(f)) { f.bytes() } else { 0 };
        let media = size_of_val(&parts.media[..])
            + parts.media.iter().filter_map(|m| m.field.as_ref()).map(field).sum::<usize>();
        let table = |name, count, bytes| Table { name, count, bytes };
        vec![
            table("shapes", parts.geometries.len(), shapes),
            table("instances", parts.placements.len(), size_of_val(&parts.placements[..])),
            table("ray structure", 1, parts.accel.bytes()),
            table("materials", parts.materials.len(), size_of_val(&parts.materials[..])),
            table("textures", parts.textures.len(), parts.textures.bytes()),
            table("lights", parts.lights.lights.len(), parts.lights.bytes()),
            table("media", parts.media.len(), media),
        ]
    }
}

/// Where a shape's geometry is; planes, which point to nothing, are all at none.
fn address(shape: &Shape) -> usize {
    match shape {
        Shape::Mesh(m) => Arc::as_ptr(m).addr(),
        Shape::Quadric(q) => Arc::as_ptr(q).addr(),
        Shape::Patches(m) => Arc::as_ptr(m).addr(),
        Shape::Curves(c) => Arc::as_ptr(c).addr(),
        Shape::Field(f) => Arc::as_ptr(f).addr(),
        Shape::Sdf(s) => Arc::as_ptr(s).addr(),
        Shape::Plane(_) => 0,
    }
}

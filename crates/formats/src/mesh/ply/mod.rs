//! PLY, the polygon file format (Turk 1994): text and binary of either byte order.

mod cursor;
mod encode;
mod faces;
mod header;
mod layout;
mod vertices;

pub(crate) use encode::encode;

use super::{MeshError, MeshErrorKind as Kind};
use cursor::Cursor;
use header::Element;
use steradian_scene::Mesh;

/// How to read a PLY file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlyOptions {
    /// Faces of four corners become bilinear patches (pbrt's meaning) instead of two triangles.
    pub keep_quads: bool,
}

/// What a PLY file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyFile {
    /// The mesh.
    pub mesh: Mesh,
    /// Vertices whose normal is not finite, as exporters write where faces have no area; it is zero in the mesh.
    pub bad_normals: usize,
}

impl PlyFile {
    /// What there is to say of the file beyond the mesh.
    pub fn warning(&self) -> Option<String> {
        (self.bad_normals > 0).then(|| format!("{} normals are not finite; they are left out", self.bad_normals))
    }
}

/// Reads a mesh.
///
/// Elements other than `vertex`, `face` and `tristrips` are passed over, as are properties without a meaning. Polygons
/// are triangulated. `color` and properties named by Mitsuba's rule (`{name}_x`, `{name}_y`, …) become attributes;
/// colours of integer types are scaled to `[0, 1]` and decoded from sRGB, texture coordinates of integer types are
/// scaled.
///
/// # Errors
/// [`MeshError`] with the line (header, text) or byte (binary data) for anything that is malformed: truncated data,
/// counts the file cannot hold, unknown types, absent coordinates, positions and texture coordinates that are not
/// finite, indices out of range.
pub fn read(bytes: &[u8], options: &PlyOptions) -> Result<PlyFile, MeshError> {
    let header = header::parse(bytes)?;
    let mut cursor = Cursor::new(bytes, &header);
    let mut mesh = None;
    // Faces need the vertices: where they stand first, they are passed over and read afterwards.
    let mut surfaces: Vec<(&Element, usize)> = Vec::new();
    let meaningful = |e: &Element| matches!(e.name.as_str(), "vertex" | "face" | "tristrips");
    // What follows the last element of interest need not be read.
    let end = header.elements.iter().rposition(meaningful).map_or(0, |i| i + 1);
    for (i, element) in header.elements[..end].iter().enumerate() {
        header.check_count(bytes, element, cursor.left())?;
        if meaningful(element) && header.elements[..i].iter().any(|e| e.name == element.name) {
            let message = format!("element '{}' is declared more than once", element.name);
            return Err(MeshError::in_text(Kind::Syntax, bytes, element.offset, message));
        }
        if element.name == "vertex" {
            if u32::try_from(element.count).is_err() {
                let message = format!("{} vertices, more than 32-bit indices can name", element.count);
                return Err(MeshError::in_text(Kind::TooLarge, bytes, element.offset, message));
            }
            mesh = Some(vertices::read(&mut cursor, element)?);
            continue;
        }
        if meaningful(element) {
            surfaces.push((element, cursor.at));
        }
        if i + 1 < end {
            cursor.skip(element)?;
        }
    }
    let mut file =
        mesh.ok_or_else(|| MeshError::in_text(Kind::Missing, bytes, header.data, "the file has no element 'vertex'"))?;
    let mesh = &mut file.mesh;
    let has_faces = surfaces.iter().any(|(e, _)| e.name == "face" && e.count > 0);
    for (element, at) in surfaces {
        cursor.at = at;
        if element.name == "face" {
            faces::read(&mut cursor, element, mesh, options)?;
        } else if !has_faces {
            faces::read_strips(&mut cursor, element, mesh)?;
        }
    }
    Ok(file)
}

#[cfg(test)]
mod tests;

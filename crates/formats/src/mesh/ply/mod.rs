//! PLY, the polygon file format (Turk 1994): text and binary of either byte order.

mod cursor;
mod encode;
mod faces;
mod header;
mod layout;
mod vertices;
mod wedges;

pub(crate) use encode::encode;

use super::{MeshError, MeshErrorKind as Kind};
use cursor::Cursor;
use header::Element;
use steradian_scene::Mesh;

/// Options of the PLY reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlyOptions {
    /// Faces of four corners become bilinear patches (pbrt's meaning) instead of two triangles.
    pub keep_quads: bool,
    /// Texture coordinates at the corners of faces are read, for which vertices are split.
    pub corner_uvs: bool,
    /// Positions of georeferenced files are read in double precision and moved near the origin ([`PlyFile::origin`]).
    pub recentre: bool,
}

/// Contents of a PLY file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyFile {
    /// The mesh.
    pub mesh: Mesh,
    /// Vertices whose normal is not finite, as exporters write where faces have no area; it is zero in the mesh.
    pub bad_normals: usize,
    /// Vertices whose texture coordinates are not finite; they are zero in the mesh.
    pub bad_uvs: usize,
    /// Vertices whose position is not finite; no face has them.
    pub bad_vertices: usize,
    /// Faces that were left out since they have such a vertex.
    pub bad_faces: usize,
    /// Names of the pictures that the mesh is textured with.
    pub pictures: Vec<String>,
    /// Offset subtracted from all positions; zero but where [`PlyOptions::recentre`] asks for it and the first vertex
    /// is far from the origin.
    pub origin: [f64; 3],
}

impl PlyFile {
    /// Warning about non-finite vertices, normals and texture coordinates; `None` where there are none.
    pub fn warning(&self) -> Option<String> {
        let parts = [
            (self.bad_vertices, format!("vertices are not finite; the {} faces at them are left out", self.bad_faces)),
            (self.bad_normals, "normals are not finite; they are left out".into()),
            (self.bad_uvs, "texture coordinates are not finite; they are zero".into()),
        ];
        let said: Vec<String> =
            parts.iter().filter(|p| p.0 > 0).map(|(count, what)| format!("{count} {what}")).collect();
        (!said.is_empty()).then(|| said.join("; "))
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
/// counts the file cannot hold, unknown types, absent coordinates, indices out of range.
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
            mesh = Some(vertices::read(&mut cursor, element, options.recentre)?);
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
    file.pictures.clone_from(&header.pictures);
    let mesh = &mut file.mesh;
    let bad: Vec<usize> = (0..mesh.positions.len()).filter(|&i| !vertices::is_finite(&mesh.positions[i])).collect();
    file.bad_vertices = bad.len();
    let has_faces = surfaces.iter().any(|(e, _)| e.name == "face" && e.count > 0);
    for (element, at) in surfaces {
        cursor.at = at;
        if element.name == "face" {
            file.bad_faces += faces::read(&mut cursor, element, mesh, options, !bad.is_empty())?;
        } else if !has_faces {
            faces::read_strips(&mut cursor, element, mesh)?;
            file.bad_faces += if bad.is_empty() { 0 } else { faces::leave_out_bad(mesh) };
        }
    }
    // Their places are those of sound vertices, so that boxes around all vertices stay what they are.
    let sound = mesh.positions.iter().copied().find(|p| vertices::is_finite(p)).unwrap_or_default();
    for vertex in bad {
        mesh.positions[vertex] = sound;
    }
    Ok(file)
}

#[cfg(test)]
mod tests;

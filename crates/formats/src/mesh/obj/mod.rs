//! Wavefront OBJ (Alias|Wavefront, "Object Files", Advanced Visualizer manual, appendix B1): polygons and what belongs
//! to them.

mod build;
mod lines;
mod parse;

use super::{MeshError, text::trim};
pub(super) use lines::Lines;
use steradian_scene::Mesh;

/// Options of the OBJ reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjOptions {
    /// All faces become one mesh, whatever objects, groups and materials there are (Mitsuba's meaning).
    pub merge: bool,
    /// Texture coordinates are turned over: `v` becomes `1 − v`.
    pub flip_v: bool,
    /// Positions of georeferenced files are read in double precision and moved near the origin ([`ObjFile::origin`]).
    pub recentre: bool,
}

/// The faces of one object, group and material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjMesh {
    /// As the last `o` before the faces names it; empty without one, and in merged meshes.
    pub object: String,
    /// As the last `g` names it, several names with blanks between.
    pub group: String,
    /// As the last `usemtl` names it.
    pub material: Option<String>,
    /// Offset in the file of that `usemtl`.
    pub material_offset: usize,
    /// Vertices are shared by corners that agree in position, texture coordinate and normal. Colours of vertices
    /// (`v x y z r g b`) are the attribute `color`. Corners that lack a normal where others have one get that of their
    /// face.
    pub mesh: Mesh,
}

/// A material library that the file names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Library {
    /// The file name, as written.
    pub name: String,
    /// Offset of the `mtllib` in the file.
    pub offset: usize,
}

/// A name as written, cut where it is longer than any that is meant: it is copied with each change of names.
pub(super) fn name(text: &[u8]) -> String {
    const LONGEST: usize = 255;
    let text = trim(text);
    String::from_utf8_lossy(&text[..text.len().min(LONGEST)]).into_owned()
}

/// Counts of skipped or repaired elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Statements `p`.
    pub points: usize,
    /// Statements `l`.
    pub lines: usize,
    /// Faces of less than three corners.
    pub degenerate: usize,
    /// Statements of free-form curves and surfaces.
    pub free_form: usize,
    /// Texture coordinates and normals that corners of faces name, but that the file does not have: such corners have
    /// none.
    pub references: usize,
    /// Colours of vertices that are not finite: they are white.
    pub colors: usize,
    /// Texture coordinates and normals that are not finite: they are zero.
    pub not_finite: usize,
    /// Faces at vertices whose position is not finite: they are left out.
    pub bad_faces: usize,
    /// Statements that OBJ does not have.
    pub unknown: usize,
    /// Offset of the first of those.
    pub unknown_offset: usize,
}

impl Skipped {
    /// Warning about repaired faces and colours; `None` where there are none.
    pub fn warning(&self) -> Option<String> {
        let parts = [
            (self.references, "texture coordinates and normals that faces name and the file has not"),
            (self.colors, "colours of vertices that are not finite"),
            (self.not_finite, "texture coordinates and normals that are not finite"),
            (self.bad_faces, "faces at vertices that are not finite"),
        ];
        let said: Vec<String> =
            parts.iter().filter(|p| p.0 > 0).map(|(count, what)| format!("{count} {what} are left out")).collect();
        (!said.is_empty()).then(|| said.join("; "))
    }
}

/// The contents of an OBJ file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjFile {
    /// In the order in which their first faces stand; no mesh is empty.
    pub meshes: Vec<ObjMesh>,
    /// Material libraries in order, each once.
    pub libraries: Vec<Library>,
    /// Counts of skipped or repaired elements.
    pub skipped: Skipped,
    /// Offset subtracted from all positions; zero but where [`ObjOptions::recentre`] asks for it and the first vertex
    /// is far from the origin.
    pub origin: [f64; 3],
}

/// Reads an OBJ file.
///
/// # Errors
/// [`MeshError`] with the line for numbers that are malformed, and for indices of positions that are zero or out of
/// range.
pub fn read(bytes: &[u8], options: &ObjOptions) -> Result<ObjFile, MeshError> {
    let parsed = parse::parse(bytes, options)?;
    build::build(bytes, parsed)
}

#[cfg(test)]
mod tests;

//! Faces with an index for each quantity into meshes with one index per vertex.

use super::{
    ObjFile, ObjMesh,
    parse::{Corner, NONE, Parsed, Part},
};
use crate::mesh::{MeshError, MeshErrorKind as Kind, polygon::Triangulator};
use std::collections::HashMap;
use steradian_scene::{Attribute, Domain, Mesh};

/// Cuts polygons and shares vertices.
pub(super) fn build(bytes: &[u8], mut parsed: Parsed) -> Result<ObjFile, MeshError> {
    let parts = std::mem::take(&mut parsed.parts);
    let mut meshes = Vec::with_capacity(parts.len());
    let sound = parsed.positions.iter().map(|p| p.iter().all(|v| v.is_finite())).collect::<Vec<bool>>();
    let has_bad = sound.contains(&false);
    let mut work = Work {
        sharing: Sharing { first: vec![NONE; parsed.positions.len()], ..Sharing::default() },
        cutter: Triangulator::default(),
    };
    for mut part in parts {
        if part.faces.is_empty() {
            continue;
        }
        check_indices(bytes, &mut part, &mut parsed)?;
        if has_bad {
            parsed.skipped.bad_faces += leave_out_bad(&mut part, &sound);
            if part.faces.is_empty() {
                continue;
            }
        }
        let mesh = work.mesh(bytes, &part, &parsed)?;
        let (object, group) = (std::mem::take(&mut part.object), std::mem::take(&mut part.group));
        meshes.push(ObjMesh { object, group, material: part.material, material_offset: part.material_offset, mesh });
    }
    Ok(ObjFile { meshes, libraries: parsed.libraries, skipped: parsed.skipped, origin: parsed.origin })
}

/// Holds the indices against what the whole file has. Texture coordinates and normals that are not there are left out.
fn check_indices(bytes: &[u8], part: &mut Part, parsed: &mut Parsed) -> Result<(), MeshError> {
    let counts = [parsed.positions.len(), parsed.uvs.len(), parsed.normals.len()];
    for (at, corner) in part.corners.iter_mut().enumerate() {
        if corner[0] as usize >= counts[0] {
            let face = part.faces.partition_point(|f| f.0 <= at);
            let offset = part.faces.get(face).map_or(0, |f| f.1);
            let index = u64::from(corner[0]) + 1;
            let message = format!("the face refers to number {index} of the vertices, but the file has {}", counts[0]);
            return Err(MeshError::in_text(Kind::IndexOutOfRange, bytes, offset, message));
        }
        for k in 1..3 {
            if corner[k] != NONE && corner[k] as usize >= counts[k] {
                corner[k] = NONE;
                parsed.skipped.references += 1;
            }
        }
    }
    Ok(())
}

/// Leaves out the faces at vertices whose position is not finite; gives how many.
fn leave_out_bad(part: &mut Part, sound: &[bool]) -> usize {
    let (faces, corners) = (std::mem::take(&mut part.faces), std::mem::take(&mut part.corners));
    let (mut start, count) = (0, faces.len());
    for (end, at) in faces {
        let face = &corners[start..end];
        start = end;
        if face.iter().all(|c| sound[c[0] as usize]) {
            part.corners.extend_from_slice(face);
            part.faces.push((part.corners.len(), at));
        }
    }
    count - part.faces.len()
}

struct Work {
    sharing: Sharing,
    cutter: Triangulator,
}

impl Work {
    fn mesh(&mut self, bytes: &[u8], part: &Part, parsed: &Parsed) -> Result<Mesh, MeshError> {
        let has_uvs = part.corners.iter().any(|c| c[1] != NONE);
        let has_normals = part.corners.iter().any(|c| c[2] != NONE);
        let mut triangles = Vec::with_capacity(part.faces.len());
        let mut indices = Vec::new();
        let mut start = 0;
        // Normals made for faces that lack them count on after those of the file.
        let mut made: Vec<[f32; 3]> = Vec::new();
        for &(end, at) in &part.faces {
            let corners = &part.corners[start..end];
            start = end;
            let mut face_normal = NONE;
            if has_normals && corners.iter().any(|c| c[2] == NONE) {
                face_normal = u32::try_from(parsed.normals.len() + made.len()).unwrap_or(NONE);
                made.push(newell(corners.iter().map(|c| parsed.positions[c[0] as usize])));
            }
            indices.clear();
            for &c in corners {
                let c = if c[2] == NONE { [c[0], c[1], face_normal] } else { c };
                indices.push(self.sharing.vertex(c));
            }
            let position = |k: usize| parsed.positions[corners[k][0] as usize];
            let emit = |t: [usize; 3]| triangles.push(t.map(|k| indices[k]));
            self.cutter.cut(corners.len(), position, emit).map_err(|_| {
                let message = format!("a concave face of {} corners is too complex", corners.len());
                MeshError::in_text(Kind::TooLarge, bytes, at, message)
            })?;
        }

        let vertices = self.sharing.take();
        let positions = vertices.iter().map(|c| parsed.positions[c[0] as usize]).collect();
        let mut mesh = Mesh { positions, triangles: triangles.into(), ..Mesh::default() };
        if has_uvs {
            mesh.uvs = vertices.iter().map(|c| parsed.uvs.get(c[1] as usize).copied().unwrap_or_default()).collect();
        }
        if has_normals {
            let normal = |i: usize| parsed.normals.get(i).or_else(|| made.get(i - parsed.normals.len()));
            mesh.normals = vertices.iter().map(|c| normal(c[2] as usize).copied().unwrap_or_default()).collect();
        }
        if !parsed.colors.is_empty() {
            let color = |c: &Corner| parsed.colors.get(c[0] as usize).copied().unwrap_or([1.0; 3]);
            let data = vertices.iter().flat_map(color).collect();
            mesh.attributes.push(Attribute { name: "color".into(), domain: Domain::Vertex, channels: 3, data });
        }
        Ok(mesh)
    }
}

/// The direction a polygon faces (Newell's method); zero where it has no area.
fn newell(points: impl Iterator<Item = [f32; 3]> + Clone) -> [f32; 3] {
    let mut n = [0.0f64; 3];
    for (a, b) in points.clone().zip(points.clone().skip(1).chain(points.take(1))) {
        let (a, b) = (a.map(f64::from), b.map(f64::from));
        n[0] += (a[1] - b[1]) * (a[2] + b[2]);
        n[1] += (a[2] - b[2]) * (a[0] + b[0]);
        n[2] += (a[0] - b[0]) * (a[1] + b[1]);
    }
    let length = n.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { n.map(|v| (v / length) as f32) } else { [0.0; 3] }
}

/// Gives each different corner a vertex. The first vertices of a position are chained; those of the few positions with
/// many variants go to a hash table, so that no file makes the chains long.
#[derive(Default)]
struct Sharing {
    /// First vertex in this mesh for each position in the file.
    first: Vec<u32>,
    /// The corners, and the next vertex of the same position.
    vertices: Vec<(Corner, u32)>,
    crowded: HashMap<Corner, u32>,
}

impl Sharing {
    const LONGEST: usize = 24;

    #[inline]
    fn vertex(&mut self, corner: Corner) -> u32 {
        let new = self.vertices.len() as u32;
        let mut link = &mut self.first[corner[0] as usize];
        for _ in 0..Self::LONGEST {
            if *link == NONE {
                *link = new;
                self.vertices.push((corner, NONE));
                return new;
            }
            let at = *link;
            let (other, next) = &mut self.vertices[at as usize];
            if *other == corner {
                return at;
            }
            link = next;
        }
        *self.crowded.entry(corner).or_insert_with(|| {
            self.vertices.push((corner, NONE));
            new
        })
    }

    /// The corners of all vertices; what follows is another mesh.
    fn take(&mut self) -> Vec<Corner> {
        self.crowded.clear();
        let vertices: Vec<Corner> = self.vertices.drain(..).map(|v| v.0).collect();
        vertices.iter().for_each(|c| self.first[c[0] as usize] = NONE);
        vertices
    }
}

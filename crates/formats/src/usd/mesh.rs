//! Meshes: UsdGeomMesh with its primvars, and UsdGeomSubset.

use super::{
    Loss, Reader,
    look::{Channels, Look},
    nodes::{Drawn, Form, Inherited},
    stage::Prim,
    value::Value,
};
use crate::mesh::polygon::Triangulator;
use glam::Vec3;
use std::sync::Arc;
use steradian_scene::{Attribute, Domain, Mesh};

/// Faces of a mesh that share a material.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub mesh: usize,
    /// The subset's path, where the faces are of one.
    pub subset: Option<String>,
    pub channels: Channels,
}

/// Elements that have one value each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Constant,
    Uniform,
    Vertex,
    FaceVarying,
}

/// Values over a mesh.
struct Primvar {
    values: Vec<f32>,
    width: usize,
    indices: Option<Vec<u32>>,
    interpolation: Interpolation,
}

impl Primvar {
    /// The value at a corner of a face.
    fn at(&self, face: usize, corner: usize, point: usize) -> &[f32] {
        let element = match self.interpolation {
            Interpolation::Constant => 0,
            Interpolation::Uniform => face,
            Interpolation::Vertex => point,
            Interpolation::FaceVarying => corner,
        };
        let element = match &self.indices {
            Some(indices) => indices.get(element).map_or(0, |k| *k as usize),
            None => element,
        };
        self.values.get(element * self.width..(element + 1) * self.width).unwrap_or_default()
    }

    /// True if corners at one point may have different values.
    fn splits(&self) -> bool {
        matches!(self.interpolation, Interpolation::Uniform | Interpolation::FaceVarying)
    }
}

/// A mesh as the stage has it.
struct Geometry {
    points: Vec<[f32; 3]>,
    counts: Vec<u32>,
    /// The first corner of each face.
    starts: Vec<usize>,
    corners: Vec<u32>,
    is_left_handed: bool,
    normals: Option<Primvar>,
    uvs: Option<Primvar>,
    /// Further values by name, for textures.
    others: Vec<(String, Primvar)>,
}

impl Reader<'_> {
    /// Draws a mesh, or curves as one.
    pub(super) fn mesh(&mut self, prim: &Prim, is_curves: bool, state: &Inherited) {
        if self.stage.names(prim, "apiSchemas").iter().any(|name| name == "MeshLightAPI") {
            self.count(Loss::Dropped("meshes do not shine as lights (MeshLightAPI)".into()), prim, None);
        }
        let key = prim.key();
        let parts = match self.meshes.get(&key) {
            Some(parts) => parts.clone(),
            None => {
                let parts = if is_curves { self.strands(prim) } else { self.parts(prim) };
                self.meshes.insert(key, parts.clone());
                parts
            }
        };
        for part in parts {
            let own = part.subset.as_ref().and_then(|name| {
                let subset = self.stage.child(prim, name);
                self.binding(&subset)
            });
            let material = own.map(|b| b.0).or_else(|| state.material.clone());
            let look = self.look(prim, material.as_deref(), part.channels);
            let Look { material, emission, tangents } = look;
            let name = prim.name().to_owned();
            self.draw(Drawn {
                name,
                form: Form::Mesh { mesh: part.mesh, tangents },
                place: state.place,
                material,
                emission,
            });
        }
    }

    /// The mesh data of a prim, by subsets that bind materials.
    fn parts(&mut self, prim: &Prim) -> Vec<Part> {
        let Some(geometry) = self.geometry(prim) else { return Vec::new() };
        let channels = Channels { color: geometry.others.iter().any(|o| o.0 == "displayColor") };
        let count = geometry.counts.len();
        let holes = self.integers(prim, "holeIndices").unwrap_or_default();
        let mut free = vec![true; count];
        holes.iter().for_each(|k| {
            if let Some(flag) = free.get_mut(*k as usize) {
                *flag = false;
            }
        });
        let mut parts = Vec::new();
        for name in self.stage.children(prim) {
            let subset = self.stage.child(prim, &name);
            if self.stage.type_name(&subset) != "GeomSubset" {
                continue;
            }
            let family = self.word(&subset, "familyName");
            let element = self.word(&subset, "elementType");
            if element.is_some_and(|e| e != "face") || family.is_some_and(|f| f != "materialBind") {
                continue;
            }
            let Some(indices) = self.integers(&subset, "indices") else { continue };
            if let Some(k) = indices.iter().find(|k| **k as usize >= count) {
                self.fault(&subset, "indices", format!("there is no face {k}: the mesh has {count}"));
                continue;
            }
            let faces = indices
                .into_iter()
                .filter(|k| free.get_mut(*k as usize).is_some_and(std::mem::take))
                .collect::<Vec<_>>();
            parts.extend(self.part(prim, &geometry, &faces, Some(name), channels));
        }
        let rest: Vec<u32> = (0..count as u32).filter(|k| free.get(*k as usize) == Some(&true)).collect();
        parts.extend(self.part(prim, &geometry, &rest, None, channels));
        parts
    }

    fn part(
        &mut self,
        prim: &Prim,
        geometry: &Geometry,
        faces: &[u32],
        subset: Option<String>,
        channels: Channels,
    ) -> Option<Part> {
        let mesh = match geometry.mesh(faces) {
            Some(mesh) => mesh,
            None => {
                self.fault(prim, "faceVertexIndices", "a polygon is too complex to be cut into triangles".into());
                return None;
            }
        };
        if mesh.triangles.is_empty() {
            return None;
        }
        if let Err(fault) = mesh.validate() {
            self.fault(prim, "points", fault.to_string());
            return None;
        }
        Some(Part { mesh: self.stage.import.desc.add_mesh(Arc::new(mesh)), subset, channels })
    }

    fn geometry(&mut self, prim: &Prim) -> Option<Geometry> {
        let points = self.stage.value(prim, "points");
        let counts = self.integers(prim, "faceVertexCounts")?;
        let corners = self.integers(prim, "faceVertexIndices")?;
        let Some(points) = points.as_ref().and_then(Value::floats) else {
            self.count(Loss::Dropped("meshes without points are left out".into()), prim, None);
            return None;
        };
        let points: Vec<[f32; 3]> = points.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let total: u64 = counts.iter().map(|c| u64::from(*c)).sum();
        if total != corners.len() as u64 {
            let message = format!("the faces have {total} corners, and {} indices are given", corners.len());
            self.fault(prim, "faceVertexCounts", message);
            return None;
        }
        if let Some(k) = corners.iter().find(|k| **k as usize >= points.len()) {
            self.fault(prim, "faceVertexIndices", format!("there is no point {k}: there are {}", points.len()));
            return None;
        }
        let starts = counts.iter().scan(0, |sum, count| Some(std::mem::replace(sum, *sum + *count as usize))).collect();
        let is_left_handed = self.word(prim, "orientation").as_deref() == Some("leftHanded");
        let mut geometry =
            Geometry { points, counts, starts, corners, is_left_handed, normals: None, uvs: None, others: Vec::new() };
        let scheme = self.word(prim, "subdivisionScheme").unwrap_or_else(|| "catmullClark".into());
        if scheme == "none" {
            geometry.normals = self
                .primvar(prim, "primvars:normals", 3, &geometry)
                .or_else(|| self.primvar(prim, "normals", 3, &geometry));
        } else {
            let what = format!("the cage of a '{scheme}' subdivision surface is drawn, with smooth normals");
            self.count(Loss::Approximated(what), prim, None);
            geometry.normals = Some(geometry.smooth());
        }
        for name in self.stage.properties(prim) {
            let Some(short) = name.strip_prefix("primvars:").filter(|n| !n.contains(':')) else { continue };
            let type_name =
                self.stage.property_field(prim, &name, "typeName").and_then(Value::text).unwrap_or_default();
            let is_pair =
                type_name.starts_with("texCoord2") || matches!(type_name, "float2[]" | "double2[]" | "half2[]");
            match short {
                "displayColor" => {
                    let color = self.primvar(prim, &name, 3, &geometry);
                    geometry.others.extend(
                        color
                            .filter(|c| c.interpolation != Interpolation::Constant)
                            .map(|c| ("displayColor".into(), c)),
                    );
                }
                "st" => geometry.uvs = self.primvar(prim, &name, 2, &geometry),
                _ if is_pair => {
                    let values = self.primvar(prim, &name, 2, &geometry);
                    geometry.others.extend(values.map(|v| (short.to_owned(), v)));
                }
                _ => {}
            }
        }
        // The only coordinates are those that textures without a name of theirs use.
        if geometry.uvs.is_none()
            && let Some(k) = geometry.others.iter().position(|o| o.1.width == 2)
        {
            let (_, first) = geometry.others.get(k)?;
            geometry.uvs = Some(Primvar { values: first.values.clone(), indices: first.indices.clone(), ..*first });
        }
        Some(geometry)
    }

    /// A list of integers that are not negative; `None`, told, where others are there.
    pub(super) fn integers(&mut self, prim: &Prim, name: &str) -> Option<Vec<u32>> {
        let Some(value) = self.stage.value(prim, name) else { return Some(Vec::new()) };
        let numbers = value.numbers();
        let integers = numbers.and_then(|numbers| {
            let whole = |v: &f64| (*v >= 0.0 && *v <= f64::from(u32::MAX) && v.fract() == 0.0).then_some(*v as u32);
            numbers.iter().map(whole).collect()
        });
        if integers.is_none() {
            self.fault(prim, name, "whole numbers from 0 on are expected".into());
        }
        integers
    }

    /// Values over a mesh; `None` where there are none, or where their number is wrong, which is told.
    fn primvar(&mut self, prim: &Prim, name: &str, width: usize, geometry: &Geometry) -> Option<Primvar> {
        let value = self.stage.value(prim, name)?;
        let values = value.floats()?.into_owned();
        if values.is_empty() {
            return None;
        }
        let word = self.stage.property_field(prim, name, "interpolation").and_then(Value::text);
        let interpolation = match (word, name) {
            (Some("uniform"), _) => Interpolation::Uniform,
            (Some("vertex" | "varying"), _) | (None, "normals") => Interpolation::Vertex,
            (Some("faceVarying"), _) => Interpolation::FaceVarying,
            _ => Interpolation::Constant,
        };
        let indexed = format!("{name}:indices");
        let indices = match self.stage.value(prim, &indexed) {
            Some(_) => Some(self.integers(prim, &indexed)?),
            None => None,
        };
        let needed = match interpolation {
            Interpolation::Constant => 1,
            Interpolation::Uniform => geometry.counts.len(),
            Interpolation::Vertex => geometry.points.len(),
            Interpolation::FaceVarying => geometry.corners.len(),
        };
        let there = values.len() / width;
        let found = indices.as_ref().map_or(there, Vec::len);
        let is_out = indices.iter().flatten().any(|k| *k as usize >= there);
        if found < needed || is_out || values.len() % width != 0 {
            let span = self.stage.span(prim, Some(name));
            let word = word_of(interpolation);
            let what = format!(
                "{}.{name}: {found} values ({there} of their own) are not the {needed} of '{word}': they are left out",
                prim.path
            );
            self.stage.dropped(span, what);
            return None;
        }
        Some(Primvar { values, width, indices, interpolation })
    }
}

fn word_of(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Constant => "constant",
        Interpolation::Uniform => "uniform",
        Interpolation::Vertex => "vertex",
        Interpolation::FaceVarying => "faceVarying",
    }
}

impl Geometry {
    /// Corners of a face, as points.
    fn face(&self, face: usize) -> &[u32] {
        let start = self.starts.get(face).copied().unwrap_or(0);
        let count = self.counts.get(face).map_or(0, |c| *c as usize);
        self.corners.get(start..start + count).unwrap_or_default()
    }

    fn point(&self, k: u32) -> [f32; 3] {
        self.points.get(k as usize).copied().unwrap_or_default()
    }

    /// Normals at points: the means of the faces around, by area.
    fn smooth(&self) -> Primvar {
        let mut sums = vec![Vec3::ZERO; self.points.len()];
        for face in 0..self.counts.len() {
            let corners = self.face(face);
            let Some(&first) = corners.first() else { continue };
            let origin = Vec3::from(self.point(first));
            let normal: Vec3 = corners
                .windows(2)
                .map(|w| (Vec3::from(self.point(w[0])) - origin).cross(Vec3::from(self.point(w[1])) - origin))
                .sum();
            let normal = if self.is_left_handed { -normal } else { normal };
            for k in corners {
                if let Some(sum) = sums.get_mut(*k as usize) {
                    *sum += normal;
                }
            }
        }
        let values = sums.iter().flat_map(|n| n.normalize_or_zero().to_array()).collect();
        Primvar { values, width: 3, indices: None, interpolation: Interpolation::Vertex }
    }

    /// The triangles of some faces; `None` if a polygon is too complex.
    fn mesh(&self, faces: &[u32]) -> Option<Mesh> {
        let all = || self.normals.iter().chain(&self.uvs).chain(self.others.iter().map(|o| &o.1));
        let splits = all().any(Primvar::splits);
        let is_whole = faces.len() == self.counts.len();
        let mut mesh = Mesh::default();
        let mut others: Vec<Vec<f32>> = vec![Vec::new(); self.others.len()];
        let mut vertices = vec![u32::MAX; if splits { 0 } else { self.points.len() }];
        let mut triangles = Vec::new();
        let mut triangulator = Triangulator::default();
        let mut add = |mesh: &mut Mesh, face: usize, corner: usize, point: u32| {
            let vertex = mesh.positions.len() as u32;
            mesh.positions.push(self.point(point));
            if let Some(normals) = &self.normals {
                mesh.normals.push(normals.at(face, corner, point as usize).try_into().unwrap_or_default());
            }
            if let Some(uvs) = &self.uvs {
                mesh.uvs.push(uvs.at(face, corner, point as usize).try_into().unwrap_or_default());
            }
            for ((_, values), data) in self.others.iter().zip(&mut others) {
                data.extend_from_slice(values.at(face, corner, point as usize));
            }
            vertex
        };
        if is_whole && !splits {
            for (k, vertex) in vertices.iter_mut().enumerate() {
                *vertex = add(&mut mesh, 0, 0, k as u32);
            }
        }
        let mut corners = Vec::new();
        for face in faces.iter().map(|k| *k as usize) {
            let start = self.starts.get(face).copied().unwrap_or(0);
            corners.clear();
            for (k, point) in self.face(face).iter().enumerate() {
                let known = vertices.get(*point as usize).copied().filter(|v| *v != u32::MAX);
                let vertex = known.unwrap_or_else(|| add(&mut mesh, face, start + k, *point));
                if let Some(slot) = vertices.get_mut(*point as usize) {
                    *slot = vertex;
                }
                corners.push(vertex);
            }
            let at = |k: usize| corners.get(k).copied().unwrap_or(0);
            let position = |k: usize| mesh.positions.get(at(k) as usize).copied().unwrap_or_default();
            let turned = self.is_left_handed;
            let emit = |[a, b, c]: [usize; 3]| {
                triangles.push(if turned { [at(a), at(c), at(b)] } else { [at(a), at(b), at(c)] })
            };
            triangulator.cut(corners.len(), position, emit).ok()?;
        }
        mesh.triangles = triangles.into();
        mesh.attributes = self
            .others
            .iter()
            .zip(others)
            .map(|((name, values), data)| Attribute {
                name: name.clone(),
                domain: Domain::Vertex,
                channels: values.width,
                data,
            })
            .collect();
        Some(mesh)
    }
}

//! Texture atlases of the meshes of a scene ([`steradian_unwrap`]): all of them in one atlas, at one scale.

use crate::Error;
use std::{f64::consts::PI, ops::Range};
use steradian_formats::write;
use steradian_image::Image;
use steradian_math::{DVec2, DVec3, Transform};
use steradian_scene::{Attribute, Domain, Mesh, SceneDesc, Shape};
use steradian_unwrap as atlas;
pub use steradian_unwrap::{Atlas, MOST_TRIANGLES, Metrics, Options};

/// Name of the attribute with a second set of texture coordinates.
pub(crate) const SECOND: &str = "uv1";
/// Name of the attribute of triangles with the number of their chart, beside a second set.
pub(crate) const CHART: &str = "atlas_chart";

/// Origin of the seams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seams {
    /// Edges at which the surface turns by more than an angle.
    #[default]
    Angle,
    /// Edges at which the meshes' own texture coordinates jump.
    Keep,
}

/// Settings of an atlas and of the meshes over it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// Charts and packing.
    pub options: Options,
    /// Origin of the seams.
    pub seams: Seams,
    /// True if the meshes keep their texture coordinates, and those of the atlas are a second set.
    pub is_second: bool,
    /// True if (0, 0) is the upper left corner of a picture, as in glTF, not the lower left.
    pub from_top: bool,
}

/// Meshes over one atlas.
#[derive(Clone, Debug)]
pub struct Unwrapped {
    /// The atlas of all triangles in the world, shape by shape.
    pub atlas: Atlas,
    /// The scene, with a mesh of its own for each shape.
    pub desc: SceneDesc,
    /// Shapes that are no meshes and have no place in the atlas.
    pub left_out: usize,
    /// Corners of all triangles in the world.
    corners: Vec<[DVec3; 3]>,
}

/// A shape with a mesh.
struct Part {
    /// Number of its group, or none for shapes that stand alone, and its number there.
    place: (Option<usize>, usize),
    /// Its mesh with triangles alone.
    mesh: Mesh,
    world_from_object: Transform,
    /// Its triangles among those of the atlas.
    triangles: Range<usize>,
    /// Its vertices before they were split.
    vertices: Range<u32>,
}

/// Unwraps all meshes of a scene.
///
/// # Errors
/// [`Error::CannotUnwrap`] where there are none, or they are too large, broken, or do not fit.
pub fn unwrap(desc: &SceneDesc, settings: &Settings) -> Result<Unwrapped, Error> {
    let refused = |why: String| Error::CannotUnwrap(why);
    let faces = desc.meshes.iter().map(|m| m.triangles.len() + 2 * m.patches.len()).sum::<usize>();
    if faces > MOST_TRIANGLES {
        return Err(refused(atlas::Error::TooLarge(faces).to_string()));
    }
    let (parts, left_out) = parts(desc)?;
    if parts.is_empty() {
        return Err(refused("there is no mesh in it".into()));
    }
    let (mut positions, mut triangles, mut seams) = (Vec::new(), Vec::new(), Vec::new());
    for part in &parts {
        let first = part.vertices.start;
        if settings.seams == Seams::Keep {
            seams.extend(jumps(&part.mesh).into_iter().map(|ends| ends.map(|i| i + first)));
        }
        positions.extend(write::placed(&part.mesh, &part.world_from_object).positions);
        triangles.extend(part.mesh.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    let mut options = settings.options;
    if settings.seams == Seams::Keep {
        options.seam_angle = PI;
    }
    let mesh = atlas::Mesh { positions: &positions, triangles: &triangles, seams: &seams };
    let atlas = atlas::unwrap(&mesh, &options).map_err(|e| refused(e.to_string()))?;
    let mut desc = desc.clone();
    for part in &parts {
        let number = desc.add_mesh(part.over(&atlas, settings));
        let (group, shape) = part.place;
        let shapes = match group {
            Some(group) => &mut desc.groups[group].shapes,
            None => &mut desc.shapes,
        };
        shapes[shape].mesh = Some(number);
    }
    let corner = |i: u32| DVec3::from(positions[i as usize].map(f64::from));
    let corners = triangles.iter().map(|t| t.map(corner)).collect();
    Ok(Unwrapped { atlas, desc, left_out, corners })
}

/// The shapes that are meshes, and the number of others.
fn parts(desc: &SceneDesc) -> Result<(Vec<Part>, usize), Error> {
    let alone = desc.shapes.iter().enumerate().map(|(i, shape)| ((None, i), shape));
    let grouped = desc.groups.iter().enumerate();
    let grouped = grouped.flat_map(|(g, group)| group.shapes.iter().enumerate().map(move |(i, s)| ((Some(g), i), s)));
    let (mut parts, mut left_out, mut vertices, mut triangles) = (Vec::new(), 0, 0_u32, 0);
    for (place, shape) in alone.chain(grouped) {
        let Some(mesh) = shape.mesh.and_then(|m| desc.meshes.get(m)) else {
            left_out += 1;
            continue;
        };
        let mesh = write::triangulated(mesh);
        let (from, count) = (triangles, mesh.triangles.len());
        triangles += count;
        // Shapes may share meshes, which are not bounded together then.
        let end = u32::try_from(mesh.positions.len()).ok().and_then(|n| vertices.checked_add(n));
        let Some(end) = end.filter(|_| triangles <= MOST_TRIANGLES) else {
            return Err(Error::CannotUnwrap(atlas::Error::TooLarge(triangles).to_string()));
        };
        let world_from_object = shape.world_from_object;
        parts.push(Part { place, mesh, world_from_object, triangles: from..triangles, vertices: vertices..end });
        vertices = end;
    }
    Ok((parts, left_out))
}

/// Edges at which a mesh's texture coordinates jump.
fn jumps(mesh: &Mesh) -> Vec<[u32; 2]> {
    if mesh.uvs.is_empty() {
        return Vec::new();
    }
    let place = |i: u32| mesh.positions[i as usize].map(|x| (x + 0.0).to_bits());
    let mut sides: Vec<([[u32; 3]; 2], [u32; 2])> = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| if place(a) <= place(b) { [a, b] } else { [b, a] })
        .map(|ends| (ends.map(place), ends))
        .collect();
    sides.sort_unstable();
    let uvs = |ends: [u32; 2]| ends.map(|i| mesh.uvs[i as usize]);
    let groups = sides.chunk_by(|a, b| a.0 == b.0);
    groups.filter(|g| g.iter().any(|s| uvs(s.1) != uvs(g[0].1))).map(|g| g[0].1).collect()
}

impl Part {
    /// The mesh with its vertices split and the coordinates of the atlas.
    fn over(&self, atlas: &Atlas, settings: &Settings) -> Mesh {
        let triangles = &atlas.triangles[self.triangles.clone()];
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let source = |i: u32| (atlas.sources[i as usize] - self.vertices.start) as usize;
        let number = |i: u32| used.partition_point(|u| *u < i) as u32;
        let mesh = &self.mesh;
        let uv = |i: &u32| {
            let [u, v] = atlas.uvs[*i as usize];
            [u, if settings.from_top { 1.0 - v } else { v }]
        };
        let uvs: Vec<[f32; 2]> = used.iter().map(uv).collect();
        let keeps = settings.is_second && !mesh.uvs.is_empty();
        let mut attributes: Vec<Attribute> = mesh.attributes.iter().map(|a| gathered(a, &used, source)).collect();
        if settings.is_second {
            attributes.retain(|a| a.name != SECOND && a.name != CHART);
            let data = uvs.iter().flatten().copied().collect();
            attributes.push(Attribute { name: SECOND.into(), domain: Domain::Vertex, channels: 2, data });
            // Numbers are below 2²⁴, as those of triangles, so that they are exact.
            let data = atlas.charts[self.triangles.clone()].iter().map(|chart| *chart as f32).collect();
            attributes.push(Attribute { name: CHART.into(), domain: Domain::Face, channels: 1, data });
        }
        let of = |values: &[[f32; 3]]| {
            let values: Vec<[f32; 3]> =
                if values.is_empty() { Vec::new() } else { used.iter().map(|i| values[source(*i)]).collect() };
            values
        };
        Mesh {
            positions: of(&mesh.positions),
            normals: of(&mesh.normals),
            tangents: if keeps { of(&mesh.tangents) } else { Vec::new() },
            uvs: if keeps { used.iter().map(|i| mesh.uvs[source(*i)]).collect() } else { uvs },
            triangles: triangles.iter().map(|t| t.map(number)).collect(),
            patches: Vec::new(),
            attributes,
        }
    }
}

/// An attribute of the vertices that are used.
fn gathered(attribute: &Attribute, used: &[u32], source: impl Fn(u32) -> usize) -> Attribute {
    let channels = attribute.channels;
    match attribute.domain {
        Domain::Face => attribute.clone(),
        Domain::Vertex => Attribute {
            data: used.iter().flat_map(|i| &attribute.data[source(*i) * channels..][..channels]).copied().collect(),
            ..attribute.clone()
        },
    }
}

impl Unwrapped {
    /// All shapes as one mesh in the world. Of several shapes, attributes stay behind, and normals that not all have.
    ///
    /// # Errors
    /// [`Error::CannotUnwrap`] for instances: what is at several places would have one place in the atlas.
    pub fn merged(&self) -> Result<Mesh, Error> {
        if !self.desc.instances.is_empty() {
            return Err(Error::CannotUnwrap("instances cannot be one mesh: write a .glb or .gltf".into()));
        }
        let mesh_of = |shape: &Shape| shape.mesh.and_then(|m| self.desc.meshes.get(m));
        let shapes = self.desc.shapes.iter().filter_map(|s| Some((s, mesh_of(s)?)));
        let placed: Vec<Mesh> = shapes.map(|(s, mesh)| write::placed(mesh, &s.world_from_object)).collect();
        if let [one] = &placed[..] {
            return Ok(one.clone());
        }
        let mut whole = Mesh::default();
        let has_normals = placed.iter().all(|m| !m.normals.is_empty());
        let mut triangles = Vec::new();
        for mesh in placed {
            let first = whole.positions.len() as u32;
            triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + first)));
            whole.positions.extend(mesh.positions);
            whole.uvs.extend(mesh.uvs);
            if has_normals {
                whole.normals.extend(mesh.normals);
            }
        }
        whole.triangles = triangles.into();
        Ok(whole)
    }

    /// A picture of the atlas: on the left its charts in different colours, on the right its triangles by their
    /// stretch, from blue (half the mean scale) over white to red (twice).
    ///
    /// # Errors
    /// [`Error::Failed`] where there is no memory for it.
    pub fn picture(&self, size: usize) -> Result<Image, Error> {
        let mut pixels = vec![[0.02_f32; 3]; 2 * size * size];
        let scale = (self.atlas.metrics.utilisation / self.atlas.metrics.area).sqrt();
        for (t, corners) in self.atlas.triangles.iter().enumerate() {
            let uvs = corners.map(|i| DVec2::from(self.atlas.uvs[i as usize].map(f64::from)));
            let Some([most, least]) = atlas::stretch(self.corners[t], uvs) else { continue };
            let colors =
                [hue(self.atlas.charts[t]), stretch_color((0.5 * (most * most + least * least)).sqrt() * scale)];
            let points = uvs.map(|uv| DVec2::new(uv.x, 1.0 - uv.y) * size as f64);
            covered(points, size, |x, y| {
                for (half, color) in colors.iter().enumerate() {
                    pixels[y * 2 * size + half * size + x] = *color;
                }
            });
        }
        Image::from_rgb(2 * size, size, &pixels).map_err(|e| Error::Failed(e.to_string()))
    }
}

/// A colour for a number, far from those of the numbers beside it.
fn hue(number: u32) -> [f32; 3] {
    let turn = (f64::from(number) * 0.618_033_988_749_895).fract() as f32;
    let value = [0.8, 0.5, 0.65][number as usize % 3];
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| {
        let distance = (turn - shift + 0.5).rem_euclid(1.0) - 0.5;
        value * (2.0 - 6.0 * distance.abs()).clamp(0.1, 1.0)
    })
}

/// Blue for what is half as large on the surface as in the mean, white, and red for what is twice as large.
fn stretch_color(stretch: f64) -> [f32; 3] {
    let t = stretch.log2().clamp(-1.0, 1.0) as f32;
    let rest = 1.0 - t.abs();
    if t < 0.0 { [0.8 * rest, 0.8 * rest, 0.8] } else { [0.8, 0.8 * rest, 0.8 * rest] }
}

/// Calls back for each pixel whose centre is in a triangle.
pub(crate) fn covered(points: [DVec2; 3], size: usize, mut paint: impl FnMut(usize, usize)) {
    let low = points[0].min(points[1]).min(points[2]);
    let high = points[0].max(points[1]).max(points[2]);
    let pixel = |x: f64| (x.max(0.0) as usize).min(size);
    let sign = (points[1] - points[0]).perp_dot(points[2] - points[0]).signum();
    for y in pixel(low.y)..pixel(high.y + 1.0) {
        for x in pixel(low.x)..pixel(high.x + 1.0) {
            let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let is_left = |i: usize| sign * (points[(i + 1) % 3] - points[i]).perp_dot(p - points[i]) >= 0.0;
            if (0..3).all(is_left) {
                paint(x, y);
            }
        }
    }
}

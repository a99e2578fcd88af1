//! Meshes: primitives of all modes, morph targets and skins.

use super::{Reader, draco, json::At, material::Look};
use glam::DMat3;
use std::sync::Arc;
use steradian_math::{DMat4, DVec3, Transform};
use steradian_scene::{Attribute, Domain, Family, Group, Instance, Mesh, Movement, Node, Shape};

/// From so many places on, a mesh is stored once and placed as instances.
const INSTANCED_FROM: usize = 16;
/// Radius of points and lines over the diagonal of the scene.
const STROKE: f64 = 1.0 / 500.0;
/// Most points and lines that are drawn.
const MOST_STROKES: usize = 200_000;

/// The joints of a skin: from the mesh's space at rest into the world.
pub(super) struct Skin {
    pub joints: Vec<DMat4>,
}

/// A primitive's triangles in the description, and what a material may use of them.
#[derive(Clone, Debug)]
pub(super) struct Data {
    pub mesh: usize,
    pub channels: Channels,
    corners: [DVec3; 2],
}

/// Optional vertex attributes of a primitive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Channels {
    /// Colours of vertices, attribute `color`.
    pub color: bool,
    /// Opacities of vertices, attribute `alpha`.
    pub alpha: bool,
    /// Tangents of vertices, attribute `tangent`.
    pub tangent: bool,
}

/// Points and lines in the world, to be drawn when the size of the scene is known.
pub(super) struct Strokes {
    look: Look,
    points: Vec<DVec3>,
    lines: Vec<[DVec3; 2]>,
}

/// The arrays of a primitive, posed.
struct Vertices {
    mesh: Mesh,
    channels: Channels,
}

impl Reader<'_> {
    /// Adds the primitives of a mesh at some places.
    pub(super) fn mesh(
        &mut self,
        root: &At<'_>,
        index: usize,
        mesh: &At<'_>,
        weights: &[f64],
        skin: Option<&Skin>,
        places: &[DMat4],
    ) {
        for (number, primitive) in mesh.list("primitives").enumerate() {
            let mode = primitive.get("mode").map_or(Some(4), |m| m.value.as_u64());
            match mode {
                Some(0..=3) => self.strokes(root, &primitive, mode.unwrap_or(0), weights, skin, places),
                Some(4..=6) => {
                    let is_fixed = skin.is_none() && weights.iter().all(|w| *w == 0.0);
                    let known = self.meshes.get(&(index, number)).filter(|_| is_fixed).cloned();
                    let data = match known {
                        Some(data) => data,
                        None => {
                            let data = self.triangles(root, &primitive, mode.unwrap_or(4), weights, skin);
                            if is_fixed {
                                self.meshes.insert((index, number), data.clone());
                            }
                            data
                        }
                    };
                    if let Some(data) = data {
                        let look = self.look(root, &primitive, data.channels);
                        self.place(&data, look, places, mesh.label());
                    }
                }
                _ => {
                    let at = primitive.get("mode").unwrap_or_else(|| primitive.clone());
                    self.error(&at, "a mode is a number from 0 (points) to 6 (triangle fan)");
                }
            }
        }
    }

    fn place(&mut self, data: &Data, look: Look, places: &[DMat4], name: Option<String>) {
        let visible: Vec<DMat4> = places.iter().copied().filter(|p| p.determinant().abs() > 1e-30).collect();
        for place in &visible {
            for k in 0..8 {
                let pick = |bit: usize, axis: usize| data.corners[k >> bit & 1][axis];
                self.include(place.transform_point3(DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))));
            }
        }
        let mut node = Node::new(Family::Shape, "mesh", None);
        node.name = name;
        if look.is_single_sided {
            node.set("single_sided", true, None);
        }
        if look.uses_tangents {
            node.set("tangents", if data.channels.tangent { "tangent" } else { "mikktspace_down" }, None);
        }
        let desc = &mut self.import.desc;
        let shape = Shape {
            mesh: Some(data.mesh),
            material: look.material,
            emission: look.emission,
            interior: look.interior,
            is_medium_boundary: look.interior.is_some(),
            ..Shape::new(desc.add(node))
        };
        // Instances bound no medium. Those that emit become as many lights anyway.
        let is_many = visible.len() >= INSTANCED_FROM && look.emission.is_none();
        if (is_many || self.moved.is_some()) && look.interior.is_none() {
            desc.groups.push(Group { name: String::new(), shapes: vec![shape] });
            let group = desc.groups.len() - 1;
            let movement = |matrix: DMat4| {
                self.moved.map(|moved| Movement { end: Transform { matrix: moved * matrix }, times: [0.0, 1.0] })
            };
            desc.instances.extend(
                visible.into_iter().map(|matrix| Instance {
                    movement: movement(matrix),
                    ..Instance::new(group, Transform { matrix })
                }),
            );
        } else {
            desc.shapes.extend(
                visible.into_iter().map(|matrix| Shape { world_from_object: Transform { matrix }, ..shape.clone() }),
            );
        }
    }

    fn include(&mut self, p: DVec3) {
        let [low, high] = &mut self.bounds;
        (*low, *high) = (low.min(p), high.max(p));
    }

    /// The triangles of a primitive; `None`, reported, where they are malformed, or where there are none.
    fn triangles(
        &mut self,
        root: &At<'_>,
        primitive: &At<'_>,
        mode: u64,
        weights: &[f64],
        skin: Option<&Skin>,
    ) -> Option<Data> {
        self.unpack_draco(root, primitive)?;
        let vertices = self.vertices(root, primitive, weights, skin);
        let order = vertices.as_ref().and_then(|v| self.order(root, primitive, v.mesh.positions.len()));
        let mode = if self.decoded.is_empty() { mode } else { 4 };
        self.decoded.clear();
        let (Vertices { mut mesh, channels }, order) = (vertices?, order?);
        mesh.triangles = match mode {
            4 => order.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            5 => order
                .windows(3)
                .enumerate()
                .map(|(k, t)| if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] })
                .collect(),
            _ => order.get(1..).unwrap_or_default().windows(2).map(|t| [t[0], t[1], order[0]]).collect(),
        };
        if mode == 5 {
            mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        }
        if mesh.triangles.is_empty() {
            return None;
        }
        if let Err(fault) = mesh.validate() {
            self.error(primitive, fault.to_string());
            return None;
        }
        let corners = mesh
            .positions
            .iter()
            .map(|p| DVec3::from(p.map(f64::from)))
            .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
        Some(Data { mesh: self.import.desc.add_mesh(Arc::new(mesh)), channels, corners })
    }

    /// The indices of a primitive, or one for each vertex in order.
    fn order(&mut self, root: &At<'_>, primitive: &At<'_>, count: usize) -> Option<Vec<u32>> {
        if primitive.get("indices").is_none() {
            return Some((0..count as u32).collect());
        }
        let order: Vec<u32> = self.integers::<1>(root, primitive, "indices")?.into_iter().map(|[i]| i).collect();
        if let Some(k) = order.iter().position(|i| *i as usize >= count) {
            let at = primitive.get("indices").unwrap_or_else(|| primitive.clone());
            self.error(&at, format!("index {k} refers to vertex {}, but there are only {count} vertices", order[k]));
            return None;
        }
        Some(order)
    }

    /// The vertices of a primitive, morphed and skinned.
    fn vertices(
        &mut self,
        root: &At<'_>,
        primitive: &At<'_>,
        weights: &[f64],
        skin: Option<&Skin>,
    ) -> Option<Vertices> {
        let attributes = primitive.get("attributes").unwrap_or_else(|| primitive.clone());
        if attributes.get("POSITION").is_none() {
            self.dropped(primitive, "a primitive without POSITION is left out");
            return None;
        }
        let mut mesh = Mesh { positions: self.floats::<3>(root, &attributes, "POSITION")?, ..Mesh::default() };
        let count = mesh.positions.len();
        if attributes.get("NORMAL").is_some() {
            mesh.normals = self.floats::<3>(root, &attributes, "NORMAL")?;
        }
        if attributes.get("TEXCOORD_0").is_some() {
            mesh.uvs = self.floats::<2>(root, &attributes, "TEXCOORD_0")?;
        }
        let mut channels = Channels::default();
        let attribute = |name: &str, channels: usize, data: Vec<f32>| Attribute {
            name: name.into(),
            domain: Domain::Vertex,
            channels,
            data,
        };
        for set in 1..8 {
            let name = format!("TEXCOORD_{set}");
            if attributes.get(&name).is_some() {
                let data = self.floats::<2>(root, &attributes, &name)?.into_flattened();
                mesh.attributes.push(attribute(&format!("uv{set}"), 2, data));
            }
        }
        if attributes.get("COLOR_0").is_some() {
            let (_, accessor) = self.index(root, &attributes, "COLOR_0", "accessors")?;
            let data = if accessor.text("type") == Some("VEC4") {
                let rgba = self.floats::<4>(root, &attributes, "COLOR_0")?;
                channels.alpha = rgba.iter().any(|c| c[3] != 1.0);
                if channels.alpha {
                    mesh.attributes.push(attribute("alpha", 1, rgba.iter().map(|c| c[3]).collect()));
                }
                rgba.into_iter().flat_map(|[r, g, b, _]| [r, g, b]).collect()
            } else {
                self.floats::<3>(root, &attributes, "COLOR_0")?.into_flattened()
            };
            channels.color = true;
            mesh.attributes.push(attribute("color", 3, data));
        }
        let mut tangents = Vec::new();
        if attributes.get("TANGENT").is_some() && !mesh.normals.is_empty() {
            tangents = self.floats::<4>(root, &attributes, "TANGENT")?;
        }
        for (target, weight) in primitive.list("targets").zip(weights).filter(|t| *t.1 != 0.0) {
            self.morph(root, &target, *weight as f32, &mut mesh, &mut tangents)?;
        }
        if let Some(skin) = skin {
            self.skinned(root, &attributes, skin, &mut mesh, &mut tangents)?;
        }
        if !tangents.is_empty() {
            channels.tangent = true;
            mesh.attributes.push(attribute("tangent", 4, tangents.into_flattened()));
        }
        let is_sound = |what: &str, found: usize| (found == count).then_some(()).ok_or_else(|| what.to_owned());
        let lengths = [("NORMAL", mesh.normals.len()), ("TEXCOORD_0", mesh.uvs.len())];
        let wrong = lengths.into_iter().filter(|l| l.1 > 0).find_map(|(what, found)| is_sound(what, found).err());
        let wrong =
            wrong.or_else(|| mesh.attributes.iter().find_map(|a| is_sound(&a.name, a.data.len() / a.channels).err()));
        if let Some(what) = wrong {
            self.error(&attributes, format!("'{what}' has another number of values than POSITION ({count})"));
            return None;
        }
        Some(Vertices { mesh, channels })
    }

    fn morph(
        &mut self,
        root: &At<'_>,
        target: &At<'_>,
        weight: f32,
        mesh: &mut Mesh,
        tangents: &mut [[f32; 4]],
    ) -> Option<()> {
        let mut deltas = |name: &str| match target.get(name) {
            Some(_) => self.floats::<3>(root, target, name),
            None => Some(Vec::new()),
        };
        let (positions, normals, along) = (deltas("POSITION")?, deltas("NORMAL")?, deltas("TANGENT")?);
        let add = |values: &mut [[f32; 3]], deltas: &[[f32; 3]]| {
            for (v, d) in values.iter_mut().zip(deltas) {
                *v = std::array::from_fn(|k| v[k] + weight * d[k]);
            }
        };
        add(&mut mesh.positions, &positions);
        add(&mut mesh.normals, &normals);
        for (v, d) in tangents.iter_mut().zip(&along) {
            (0..3).for_each(|k| v[k] += weight * d[k]);
        }
        Some(())
    }

    fn skinned(
        &mut self,
        root: &At<'_>,
        attributes: &At<'_>,
        skin: &Skin,
        mesh: &mut Mesh,
        tangents: &mut [[f32; 4]],
    ) -> Option<()> {
        let count = mesh.positions.len();
        let mut sum = vec![DMat4::ZERO; count];
        for set in 0..4 {
            let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
            if attributes.get(&joints).is_none() || attributes.get(&weights).is_none() {
                break;
            }
            let (joints, weights) =
                (self.integers::<4>(root, attributes, &joints)?, self.floats::<4>(root, attributes, &weights)?);
            for ((matrix, joints), weights) in sum.iter_mut().zip(&joints).zip(&weights) {
                for (joint, weight) in joints.iter().zip(weights).filter(|w| *w.1 != 0.0) {
                    let Some(place) = skin.joints.get(*joint as usize) else {
                        let there = skin.joints.len();
                        self.error(attributes, format!("a vertex names joint {joint}, but the skin has {there}"));
                        return None;
                    };
                    *matrix += *place * f64::from(*weight);
                }
            }
        }
        let vector =
            |m: &DMat3, v: [f32; 3]| (*m * DVec3::from(v.map(f64::from))).normalize_or_zero().as_vec3().to_array();
        for (k, matrix) in sum.iter_mut().enumerate() {
            // Weights that do not sum to one are scaled; a vertex without any stays where it is.
            let total = matrix.w_axis.w;
            *matrix = if total.abs() > 1e-6 { *matrix * (1.0 / total) } else { DMat4::IDENTITY };
            let p = matrix.transform_point3(DVec3::from(mesh.positions[k].map(f64::from)));
            mesh.positions[k] = p.as_vec3().to_array();
            let linear = DMat3::from_mat4(*matrix);
            if let Some(n) = mesh.normals.get_mut(k) {
                let cofactor = DMat3::from_cols(
                    linear.y_axis.cross(linear.z_axis),
                    linear.z_axis.cross(linear.x_axis),
                    linear.x_axis.cross(linear.y_axis),
                );
                *n = vector(&cofactor, *n);
            }
            if let Some(t) = tangents.get_mut(k) {
                let [x, y, z] = vector(&linear, [t[0], t[1], t[2]]);
                *t = [x, y, z, t[3]];
            }
        }
        Some(())
    }

    /// Keeps the points or lines of a primitive for when the size of the scene is known.
    fn strokes(
        &mut self,
        root: &At<'_>,
        primitive: &At<'_>,
        mode: u64,
        weights: &[f64],
        skin: Option<&Skin>,
        places: &[DMat4],
    ) {
        if let Some(packed) = primitive.extension(draco::NAME) {
            self.error(&packed, "points and lines cannot be packed by Draco in glTF");
            return;
        }
        let Some(Vertices { mesh, .. }) = self.vertices(root, primitive, weights, skin) else { return };
        let Some(order) = self.order(root, primitive, mesh.positions.len()) else { return };
        let drawn: usize = self.strokes.iter().map(|s| s.points.len() + s.lines.len()).sum();
        if drawn + order.len().saturating_mul(places.len()) > MOST_STROKES {
            self.dropped(primitive, format!("more than {MOST_STROKES} points and lines: these are left out"));
            return;
        }
        let look = self.look(root, primitive, Channels::default());
        let mut strokes = Strokes { look, points: Vec::new(), lines: Vec::new() };
        for place in places {
            let at = |i: u32| place.transform_point3(DVec3::from(mesh.positions[i as usize].map(f64::from)));
            match mode {
                0 => strokes.points.extend(order.iter().map(|i| at(*i))),
                1 => strokes.lines.extend(order.chunks_exact(2).map(|l| [at(l[0]), at(l[1])])),
                _ => {
                    strokes.lines.extend(order.windows(2).map(|l| [at(l[0]), at(l[1])]));
                    if let (2, [first, .., last]) = (mode, order.as_slice()) {
                        strokes.lines.push([at(*last), at(*first)]);
                    }
                }
            }
        }
        strokes.points.iter().chain(strokes.lines.as_flattened()).for_each(|p| self.include(*p));
        self.strokes.push(strokes);
    }

    /// Draws points and lines as spheres and cylinders.
    pub(super) fn place_strokes(&mut self) {
        let [low, high] = self.bounds;
        let radius = ((high - low).length() * STROKE).clamp(1e-9, 1e9);
        let radius = if radius.is_finite() { radius } else { 1.0 };
        let desc = &mut self.import.desc;
        for Strokes { look, points, lines } in std::mem::take(&mut self.strokes) {
            let spheres = points
                .into_iter()
                .map(|p| Node::new(Family::Shape, "sphere", None).with("center", p.to_array()).with("radius", radius));
            let cylinders = lines.into_iter().filter(|[a, b]| a.distance(*b) > 1e-3 * radius).map(|[a, b]| {
                Node::new(Family::Shape, "cylinder", None)
                    .with("p0", a.to_array())
                    .with("p1", b.to_array())
                    .with("radius", radius)
            });
            for node in spheres.chain(cylinders) {
                let shape = Shape { material: look.material, emission: look.emission, ..Shape::new(desc.add(node)) };
                desc.shapes.push(shape);
            }
        }
    }
}

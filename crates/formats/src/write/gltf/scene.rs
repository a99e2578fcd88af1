//! Nodes: shapes, instances, lights and cameras.

use super::{Json, Writer};
use crate::write::{
    exchange::{Source, spot_flux},
    frame, solid, surface,
};
use serde_json::{Map, json};
use std::f64::consts::PI;
use steradian_math::{DVec3, Transform};
use steradian_scene::{Domain, Mesh, NodeId, Shape, Value};

impl Writer<'_> {
    pub(super) fn scene(&mut self) {
        let desc = self.x.desc;
        self.x.stands_still("this glTF");
        let mut roots: Vec<usize> = Vec::new();
        for shape in &desc.shapes {
            if let Some(node) = self.shape(shape) {
                roots.push(self.push("nodes", node));
            }
        }
        for instance in &desc.instances {
            let shapes = desc.groups.get(instance.group).map_or(&[][..], |g| &g.shapes);
            let children: Vec<usize> = shapes
                .iter()
                .filter_map(|s| {
                    let node = self.shape(s)?;
                    Some(self.push("nodes", node))
                })
                .collect();
            if !children.is_empty() {
                let mut node = json!({ "children": children });
                place(&mut node, &instance.world_from_group);
                roots.push(self.push("nodes", node));
            }
        }
        for &light in &desc.lights {
            if let Some(node) = self.light(light) {
                roots.push(self.push("nodes", node));
            }
        }
        for &camera in &desc.cameras {
            if let Some(node) = self.camera(camera) {
                roots.push(self.push("nodes", node));
            }
        }
        if let Some(node) = desc.integrator.map(|i| self.x.node(i))
            && (node.int("max_depth").is_some_and(|d| d >= 0) || matches!(node.kind.as_str(), "direct" | "whitted"))
        {
            self.x.approximated(node, "glTF says nothing of integrators: light is scattered any number of times");
        }
        if let Some(film) = desc.film.map(|f| self.x.node(f)) {
            self.x.note(film, "the size of the frame, its filter and its sampler are no part of glTF");
            self.x.without(film, &["full_well", "sensor", "white_balance"]);
        }
        if !self.shines && self.lights.is_empty() {
            let text = "nothing in the glTF file lights it: programs that read it add a sky of their own";
            self.x.diagnostics.approximated(&desc.sources, None, text);
        }
        self.push("scenes", json!({ "nodes": roots }));
    }

    /// The area of a shape in the world.
    pub(super) fn area(&self, shape: &Shape) -> f64 {
        let t = &shape.world_from_object;
        match shape.mesh.and_then(|m| self.x.desc.meshes.get(m)) {
            Some(mesh) => surface::area(mesh, t),
            None => match solid::Quadric::of(self.x.node(shape.node)) {
                Some((q, moved)) => match solid::similarity(t) {
                    Some(s) => q.area() * s * s,
                    None => surface::area(&q.mesh(), &(*t * moved)),
                },
                None => 1.0,
            },
        }
    }

    fn shape(&mut self, shape: &Shape) -> Option<Json> {
        let node = self.x.node(shape.node);
        let (mesh, moved) = match node.kind.as_str() {
            "mesh" | "loop_subdivision" => {
                if node.kind == "loop_subdivision" {
                    self.x.approximated(node, "glTF subdivides no surfaces; the coarse mesh stands for it");
                }
                self.x.without(node, &["displacement", "alpha"]);
                let mesh = shape.mesh.and_then(|m| self.x.desc.meshes.get(m))?;
                if surface::has_curved_patches(mesh) {
                    self.x.approximated(node, "bilinear patches become two triangles each");
                }
                ((**mesh).clone(), Transform::IDENTITY)
            }
            "sphere" | "disk" | "cylinder" => {
                self.x.approximated(node, format!("a '{}' becomes triangles", node.kind));
                let (quadric, moved) = solid::Quadric::of(node)?;
                (quadric.mesh(), moved)
            }
            "plane" => {
                self.x.approximated(node, "an infinite plane becomes a large square");
                (solid::plane(node)?, Transform::IDENTITY)
            }
            "bezier_patch" => {
                self.x.approximated(node, "Bézier patches become triangles");
                (solid::bezier(node)?, Transform::IDENTITY)
            }
            "height_field" if solid::height_field(node).is_some() => {
                self.x.approximated(node, "a height field becomes triangles");
                (solid::height_field(node)?, Transform::IDENTITY)
            }
            other => {
                self.x.dropped(node, format!("shape '{other}' cannot be expressed and is left out"));
                return None;
            }
        };
        let look = self.look(shape)?;
        let world = shape.world_from_object * moved;
        let flat = node.bool("flat").unwrap_or(false);
        let baked = if world.swaps_handedness() { format!("{:?}", world.matrix) } else { String::new() };
        let what = match shape.mesh {
            Some(m) => format!("mesh {m}"),
            None => format!("{node:?}"),
        };
        let key = format!("{what} {flat} {} {baked} {}", shape.reverse_orientation, look.vertices);
        let world_of = if world.swaps_handedness() { Transform::IDENTITY } else { world };
        let geometry = match self.geometry.get(&key) {
            Some(known) => known.clone(),
            None => {
                let (mesh, _) = surface::oriented(&mesh, &world, shape.reverse_orientation, flat);
                if mesh.triangles.is_empty() || mesh.positions.is_empty() {
                    return None;
                }
                let geometry = self.primitive(&mesh, look.vertices);
                self.geometry.insert(key.clone(), geometry.clone());
                geometry
            }
        };
        let key = format!("{key} {}", look.material);
        let index = match self.meshes.get(&key) {
            Some(&known) => known,
            None => {
                let mut primitive = geometry;
                primitive["material"] = json!(look.material);
                let index = self.push("meshes", json!({ "primitives": [primitive] }));
                self.meshes.insert(key, index);
                index
            }
        };
        let mut out = json!({ "mesh": index });
        if let Some(name) = &node.name {
            out["name"] = json!(name);
        }
        place(&mut out, &world_of);
        Some(out)
    }

    /// Attributes and indices of a mesh.
    fn primitive(&mut self, mesh: &Mesh, colors: bool) -> Json {
        let mut attributes = Map::new();
        attributes.insert("POSITION".into(), json!(self.buffer.floats(&mesh.positions, true)));
        if !mesh.normals.is_empty() {
            let unit: Vec<[f32; 3]> = mesh.normals.iter().map(|n| unit(*n)).collect();
            attributes.insert("NORMAL".into(), json!(self.buffer.floats(&unit, false)));
        }
        if !mesh.uvs.is_empty() {
            attributes.insert("TEXCOORD_0".into(), json!(self.buffer.floats(&mesh.uvs, false)));
        }
        for a in mesh.attributes.iter().filter(|a| a.domain == Domain::Vertex) {
            if a.name == "color" && colors && a.channels >= 3 {
                let values: Vec<[f32; 3]> = a.data.chunks_exact(a.channels).map(|c| [c[0], c[1], c[2]]).collect();
                attributes.insert("COLOR_0".into(), json!(self.buffer.floats(&values, false)));
            } else if let (Some(set), 2) = (a.name.strip_prefix("uv").and_then(|s| s.parse::<u8>().ok()), a.channels) {
                let values: Vec<[f32; 2]> = a.data.chunks_exact(2).map(|c| [c[0], c[1]]).collect();
                attributes.insert(format!("TEXCOORD_{set}"), json!(self.buffer.floats(&values, false)));
            }
        }
        json!({ "attributes": attributes, "indices": self.buffer.indices(&mesh.triangles) })
    }

    fn light(&mut self, id: NodeId) -> Option<Json> {
        let node = self.x.node(id);
        let to_world = match node.get("to_world") {
            Some(Value::Transform(t)) => *t,
            _ => Transform::IDENTITY,
        };
        let vec = |name: &str, default: [f64; 3]| match node.get(name) {
            Some(Value::Vec3(v)) => *v,
            _ => default,
        };
        let color = |w: &mut Self, quantity: &str, target: &str, flux: f64| {
            let k = w.x.light_scale(node, quantity, target, flux);
            match w.x.emission(node, quantity) {
                Source::Plain(c) => c.emitted_rgb().map(|v| v * k),
                Source::Texture(_) => [k; 3],
            }
        };
        let (mut light, rgb, at) = match node.kind.as_str() {
            "point" => {
                let rgb = color(self, "intensity", "power", 4.0 * PI);
                let p = to_world.point(DVec3::from(vec("position", [0.0; 3])));
                (json!({ "type": "point" }), rgb, Transform::translate(p))
            }
            "distant" => {
                let rgb = color(self, "radiance", "illuminance", 1.0);
                (
                    json!({ "type": "directional" }),
                    rgb,
                    looking(DVec3::ZERO, DVec3::from(vec("direction", [0.0, 0.0, 1.0]))),
                )
            }
            "spot" => {
                let cone = node.float("cone_angle").unwrap_or(30.0);
                let start = node.float("falloff_start").unwrap_or(25.0).clamp(0.0, cone);
                let rgb = color(self, "intensity", "power", spot_flux(cone, start));
                if cone > 90.0 {
                    self.x.approximated(node, "the cone of a spot ends at 90 degrees in glTF");
                }
                if node.string("falloff") != Some("quadratic") && start < cone {
                    self.x.approximated(node, "the spot's edge falls off by the square of a line in the cosine");
                }
                self.x.without(node, &["texture"]);
                let outer = cone.min(90.0).to_radians().min(PI / 2.0);
                // The inner angle is the smaller.
                let inner = start.to_radians().min(outer * 0.9999);
                let axis = to_world.vector(DVec3::Z);
                let spot = json!({ "type": "spot", "spot": { "innerConeAngle": inner, "outerConeAngle": outer } });
                (spot, rgb, looking(to_world.point(DVec3::ZERO), axis))
            }
            other => {
                self.x.dropped(node, format!("light '{other}' cannot be expressed and is left out"));
                return None;
            }
        };
        let intensity = rgb.into_iter().fold(0.0, f64::max);
        light["intensity"] = json!(intensity);
        light["color"] = json!(rgb.map(|v| if intensity > 0.0 { v / intensity } else { 1.0 }));
        if let Some(name) = &node.name {
            light["name"] = json!(name);
        }
        self.lights.push(light);
        let mut out = json!({ "extensions": { "KHR_lights_punctual": { "light": self.lights.len() - 1 } } });
        place(&mut out, &at);
        Some(out)
    }

    fn camera(&mut self, id: NodeId) -> Option<Json> {
        let node = self.x.node(id);
        let is_perspective = node.kind == "perspective";
        if !is_perspective && node.kind != "orthographic" {
            self.x.dropped(node, format!("the camera '{}' cannot be expressed and is left out", node.kind));
            return None;
        }
        if node.float("lens_radius").is_some_and(|r| r > 0.0) {
            self.x.dropped(node, "'lens_radius' of a camera is left out: everything is sharp");
        }
        self.x.without(node, &["medium"]);
        let (w, aspect) = frame::window(self.x.desc, node);
        let half = [0.5 * (w[1] - w[0]).abs(), 0.5 * (w[3] - w[2]).abs()];
        let center = [0.5 * (w[0] + w[1]), 0.5 * (w[2] + w[3])];
        let mut to_world = match node.get("to_world") {
            Some(Value::Transform(t)) => *t,
            _ => Transform::IDENTITY,
        };
        let near = node.float("near").filter(|n| *n > 0.0).unwrap_or(1e-2);
        let far = node.float("far").filter(|far| *far > near);
        let camera = if is_perspective {
            if center.iter().any(|c| c.abs() > 1e-6) {
                self.x.approximated(node, "the camera's window is centred in glTF");
            }
            let fov = 2.0 * half[1].atan();
            let mut lens = json!({ "yfov": fov, "aspectRatio": aspect, "znear": near });
            if let Some(far) = far {
                lens["zfar"] = json!(far);
            }
            json!({ "type": "perspective", "perspective": lens })
        } else {
            to_world = to_world * Transform::translate(DVec3::new(center[0], center[1], 0.0));
            let far = far.unwrap_or(1e4);
            json!({ "type": "orthographic", "orthographic": { "xmag": half[0], "ymag": half[1], "znear": 0.0, "zfar": far } })
        };
        // glTF's cameras look along −z.
        let turned = to_world * Transform::scale(DVec3::new(1.0, 1.0, -1.0));
        if turned.swaps_handedness() {
            self.x.approximated(node, "a camera that mirrors its picture does not in glTF");
        }
        let index = self.push("cameras", camera);
        let mut out = json!({ "camera": index });
        if let Some(name) = &node.name {
            out["name"] = json!(name);
        }
        place(&mut out, &turned);
        Some(out)
    }
}

/// A transform whose −z leads along a direction.
fn looking(from: DVec3, direction: DVec3) -> Transform {
    let z = -direction.normalize_or(DVec3::NEG_Z);
    let x = z.as_vec3().any_orthonormal_vector().as_dvec3();
    let x = (x - z * x.dot(z)).normalize();
    let y = z.cross(x);
    Transform::from_columns([x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, from.x, from.y, from.z, 1.0])
}

fn place(node: &mut Json, t: &Transform) {
    if *t != Transform::IDENTITY {
        node["matrix"] = json!(t.matrix.to_cols_array());
    }
}

/// glTF's normals have length one.
fn unit(n: [f32; 3]) -> [f32; 3] {
    let length = n.iter().map(|v| f64::from(*v).powi(2)).sum::<f64>().sqrt();
    if length > 0.0 { n.map(|v| (f64::from(v) / length) as f32) } else { [0.0, 0.0, 1.0] }
}

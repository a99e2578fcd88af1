//! Shapes with what is attached to them.

use super::{Directive, Writer};
use crate::{
    mesh::ply,
    write::{
        exchange::Source,
        solid::{self, Quadric},
    },
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Mesh, Node, NodeId, Shape, Value};

/// Meshes of up to so many vertices stand in the text.
const SMALL_MESH: usize = 32;

impl Writer<'_> {
    /// Writes the materials, textures and media of a shape where they are not yet.
    pub(super) fn attachments(&mut self, shape: &Shape) {
        if let Some(id) = shape.material {
            let (inner, mask) = self.unmasked(id);
            self.material(inner);
            self.declare(mask);
        }
        let node = self.x.node(shape.node);
        for name in ["alpha", "displacement"] {
            let source = self.x.source(node, name);
            self.declare(source);
        }
        for medium in [shape.interior, shape.exterior].into_iter().flatten() {
            self.medium(medium);
        }
    }

    fn declare(&mut self, source: Option<Source>) {
        if let Some(Source::Texture(id)) = source {
            let _ = self.texture(id, super::texture::Values::Float, [1.0; 3]);
        }
    }

    pub(super) fn shape(&mut self, shape: &Shape, in_object: bool) {
        let node = self.x.node(shape.node);
        self.line("AttributeBegin");
        self.depth += 1;
        let mut alpha = self.x.source(node, "alpha");
        if let Some(id) = shape.material {
            let (inner, mask) = self.unmasked(id);
            if mask.is_some() {
                if alpha.is_some() {
                    self.x.approximated(node, "of a mask and an alpha of the shape the mask counts");
                }
                alpha = mask;
            }
            let name = self.material(inner);
            self.put(&Directive::new("NamedMaterial", &[&name]));
        }
        if let Some(light) = shape.emission {
            if in_object {
                let light = self.x.node(light);
                self.x.dropped(light, "what is instanced cannot emit in pbrt; the emission is left out");
            } else {
                self.area_light(light);
            }
        }
        if shape.is_medium_boundary {
            let sides = [shape.interior, shape.exterior].map(|m| m.and_then(|m| self.medium(m)).unwrap_or_default());
            self.put(&Directive::new("MediumInterface", &[&sides[0], &sides[1]]));
        }
        if shape.reverse_orientation {
            self.line("ReverseOrientation");
        }
        self.geometry(shape, node, alpha.as_ref());
        self.depth -= 1;
        self.line("AttributeEnd");
    }

    fn geometry(&mut self, shape: &Shape, node: &Node, alpha: Option<&Source>) {
        let world = shape.world_from_object;
        match node.kind.as_str() {
            "mesh" | "loop_subdivision" => {
                let Some(mesh) = shape.mesh.and_then(|m| self.x.desc.meshes.get(m)) else { return };
                self.transform(&world);
                if node.kind == "loop_subdivision" {
                    let mut out = Directive::new("Shape", &["loopsubdiv"]);
                    out.integers("levels", [node.int("levels").unwrap_or(3)]);
                    self.inline(&mut out, mesh, mesh.triangles.as_flattened());
                    return self.finish(out, alpha);
                }
                if !mesh.attributes.is_empty() {
                    let names: Vec<&str> = mesh.attributes.iter().map(|a| a.name.as_str()).collect();
                    self.x.dropped(node, format!("attributes of a mesh are left out: {}", names.join(", ")));
                }
                let flat = node.bool("flat").unwrap_or(false);
                self.mesh(node, mesh, flat, alpha, format!("{:?} {flat}", shape.mesh));
            }
            "sphere" | "disk" | "cylinder" => self.quadric(shape, node, alpha),
            "cone" | "paraboloid" | "hyperboloid" => {
                self.x
                    .approximated(node, format!("'{}' is a shape of pbrt-v3, which pbrt-v4 does not read", node.kind));
                self.transform(&world);
                let mut out = Directive::new("Shape", &[&node.kind]);
                let numbers = [
                    ("radius", "radius"),
                    ("height", "height"),
                    ("z_min", "zmin"),
                    ("z_max", "zmax"),
                    ("phi_max", "phimax"),
                ];
                for (ours, theirs) in numbers {
                    if let Some(v) = node.float(ours) {
                        out.float(theirs, v);
                    }
                }
                for name in ["p1", "p2"] {
                    if let Some(Value::Vec3(p)) = node.get(name) {
                        out.floats("point3", name, *p);
                    }
                }
                self.finish(out, alpha);
            }
            "curve" => {
                self.transform(&world);
                let mut out = Directive::new("Shape", &["curve"]);
                if let Some(Value::Floats(points)) = node.get("points") {
                    out.floats("point3", "P", points.iter().copied());
                }
                out.integers("degree", [node.int("degree").unwrap_or(3)]);
                out.string("basis", node.string("basis").unwrap_or("bezier"));
                let kind = match node.string("type").unwrap_or("flat") {
                    "round" => {
                        self.x.approximated(node, "pbrt's round strands have normals that lean to the other side");
                        "cylinder"
                    }
                    kind => kind,
                };
                out.string("type", kind);
                out.float("width0", node.float("width0").unwrap_or(1.0));
                out.float("width1", node.float("width1").unwrap_or(1.0));
                if let Some(Value::Floats(normals)) = node.get("normals") {
                    out.floats("normal3", "N", normals.iter().copied());
                }
                if let Some(depth) = node.int("split_depth") {
                    out.integers("splitdepth", [depth]);
                }
                self.finish(out, alpha);
            }
            "bezier_patch" => {
                self.x.approximated(node, "Bézier patches become triangles");
                if let Some(mesh) = solid::bezier(node) {
                    self.transform(&world);
                    self.mesh(node, &mesh, false, alpha, format!("{node:?}"));
                }
            }
            "plane" => {
                self.x.approximated(node, "an infinite plane becomes a large square");
                if let Some(mesh) = solid::plane(node) {
                    self.transform(&world);
                    self.mesh(node, &mesh, false, alpha, format!("{node:?}"));
                }
            }
            "height_field" => match solid::height_field(node) {
                Some(mesh) => {
                    self.x.approximated(node, "a height field becomes triangles");
                    self.transform(&world);
                    self.mesh(node, &mesh, false, alpha, format!("{node:?}"));
                }
                None => {
                    self.x.dropped(node, "a height field by a picture or texture cannot be expressed and is left out")
                }
            },
            other => self.x.dropped(node, format!("shape '{other}' cannot be expressed and is left out")),
        }
    }

    fn finish(&mut self, mut out: Directive, alpha: Option<&Source>) {
        if let Some(alpha) = alpha {
            self.put_float(&mut out, "alpha", alpha);
        }
        self.put(&out);
    }

    fn mesh(&mut self, node: &Node, mesh: &Mesh, flat: bool, alpha: Option<&Source>, key: String) {
        let mut mesh = mesh.clone();
        mesh.attributes.clear();
        if flat {
            mesh.normals.clear();
        }
        let displaced = node.get("displacement").is_some();
        if !displaced && (mesh.positions.len() <= SMALL_MESH || !mesh.tangents.is_empty()) {
            if !mesh.triangles.is_empty() {
                let mut out = Directive::new("Shape", &["trianglemesh"]);
                self.inline(&mut out, &mesh, mesh.triangles.as_flattened());
                if !mesh.tangents.is_empty() {
                    out.singles("vector3", "S", mesh.tangents.as_flattened());
                }
                self.finish(out, alpha);
            }
            if !mesh.patches.is_empty() {
                let mut out = Directive::new("Shape", &["bilinearmesh"]);
                self.inline(&mut out, &mesh, mesh.patches.as_flattened());
                self.finish(out, alpha);
            }
            return;
        }
        let file = match self.meshes.get(&key) {
            Some(known) => known.clone(),
            None => {
                let name = self.x.beside.add("meshes", "mesh.ply", ply::encode(&mesh));
                self.meshes.insert(key, name.clone());
                name
            }
        };
        let mut out = Directive::new("Shape", &["plymesh"]);
        out.string("filename", &file);
        if let Some(displacement) = self.x.source(node, "displacement") {
            self.x.without(node, &["displacement_scale", "displacement_middle", "displacement_vector", "edge_pixels"]);
            self.put_float(&mut out, "displacement", &displacement);
            out.float("edgelength", node.float("edge_length").unwrap_or(1.0));
        }
        self.finish(out, alpha);
    }

    fn inline(&mut self, out: &mut Directive, mesh: &Mesh, indices: &[u32]) {
        out.integers("indices", indices.iter().map(|i| i64::from(*i)));
        out.singles("point3", "P", mesh.positions.as_flattened());
        if !mesh.normals.is_empty() {
            out.singles("normal3", "N", mesh.normals.as_flattened());
        }
        if !mesh.uvs.is_empty() {
            out.singles("point2", "uv", mesh.uvs.as_flattened());
        }
    }

    fn quadric(&mut self, shape: &Shape, node: &Node, alpha: Option<&Source>) {
        let Some((quadric, moved)) = Quadric::of(node) else { return };
        let mut world = shape.world_from_object * moved;
        let mut quadric = quadric;
        // pbrt turns the normals of mirrored shapes over: whole ones are mirrored back.
        if world.swaps_handedness() && self.x.desc.format != steradian_scene::Format::Pbrt && quadric.is_whole() {
            let mirror = match &mut quadric {
                Quadric::Sphere { .. } => DVec3::new(1.0, 1.0, -1.0),
                Quadric::Cylinder { z, .. } => {
                    *z = [-z[1], -z[0]];
                    DVec3::new(1.0, 1.0, -1.0)
                }
                Quadric::Disk { .. } => DVec3::new(1.0, -1.0, 1.0),
            };
            world = world * Transform::scale(mirror);
            if shape.material.is_some_and(|m| self.has_textures(m, 0)) {
                self.x.approximated(node, "texture coordinates of a mirrored shape run the other way");
            }
        }
        self.transform(&world);
        let kind = node.kind.as_str();
        let mut out = Directive::new("Shape", &[kind]);
        let phi = match quadric {
            Quadric::Sphere { radius, z, phi } => {
                out.float("radius", radius);
                if z != [-radius, radius] {
                    out.float("zmin", z[0]);
                    out.float("zmax", z[1]);
                }
                phi
            }
            Quadric::Cylinder { radius, z, phi } => {
                out.float("radius", radius);
                out.float("zmin", z[0]);
                out.float("zmax", z[1]);
                phi
            }
            Quadric::Disk { radius, inner, height, phi } => {
                out.float("radius", radius);
                out.float("height", height);
                if inner > 0.0 {
                    out.float("innerradius", inner);
                }
                phi
            }
        };
        if phi < 360.0 {
            out.float("phimax", phi);
        }
        self.finish(out, alpha);
    }

    /// True if a material looks up textures.
    fn has_textures(&self, id: NodeId, depth: usize) -> bool {
        let inner = |id: NodeId| {
            let node = self.x.node(id);
            match node.family {
                steradian_scene::Family::Texture => node.kind != "constant",
                steradian_scene::Family::Material if depth < 16 => self.has_textures(id, depth + 1),
                _ => false,
            }
        };
        self.x.node(id).params.iter().any(|p| match &p.value {
            Value::Node(id) => inner(*id),
            Value::Nodes(ids) => ids.iter().any(|id| inner(*id)),
            _ => false,
        })
    }
}

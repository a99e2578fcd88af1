//! From a description to a document and the files beside it.

use super::{
    VERSION, ply,
    read::{CONVENTIONS, FAMILIES},
    value,
};
use crate::companion_files::Beside;
use std::{
    collections::{HashMap, HashSet},
    fmt::Write,
    path::{Path, PathBuf},
};
use steradian_math::Transform;
use steradian_scene::{Domain, Format, Mesh, Movement, Node, NodeId, SceneDesc, Shape, Value};

/// Meshes of up to so many vertices stand in the text.
const SMALL_MESH: usize = 32;
/// Deepest nesting of nodes in place.
const DEEPEST: usize = 6;
/// Longest map on one line.
const LINE: usize = 100;

/// A scene as text, and what goes beside it.
#[derive(Debug)]
pub struct Written {
    /// The document.
    pub text: String,
    /// Meshes and pictures by their names relative to the document.
    pub files: Vec<(PathBuf, Vec<u8>)>,
}

/// Writes a description. `path` is where the document will be: files are named from there. What reading it
/// gives is the same
/// description, but for the numbers of nodes, the way in which paths are written, and places in files.
///
/// # Errors
/// A message, where something has no place in the notation: numbers that are NaN, paths that are not UTF-8.
pub fn write(desc: &SceneDesc, path: &Path) -> Result<Written, String> {
    let mut writer = Writer {
        desc,
        ids: HashMap::new(),
        inline: HashSet::new(),
        beside: Beside::new(desc, path),
        fault: None,
        text: String::new(),
    };
    writer.document();
    match writer.fault.or(writer.beside.fault.take()) {
        Some(fault) => Err(fault),
        None => Ok(Written { text: writer.text, files: writer.beside.take_files() }),
    }
}

/// The text of a single value; nodes by their names.
pub(super) fn value_text(ids: &[String], name: &str, value: &Value) -> String {
    let mut out = String::new();
    value::write(&mut out, name, value, &mut |out, id| reference(out, &ids[id.0 as usize]));
    out
}

fn reference(out: &mut String, id: &str) {
    out.push('@');
    value::string(out, id);
}

struct Writer<'a> {
    desc: &'a SceneDesc,
    /// Names of the nodes that are not in place.
    ids: HashMap<NodeId, String>,
    /// Nodes written where they are used.
    inline: HashSet<NodeId>,
    beside: Beside<'a>,
    fault: Option<String>,
    text: String,
}

impl Writer<'_> {
    fn document(&mut self) {
        let desc = self.desc;
        let _ = writeln!(self.text, "steradian: {VERSION}");
        if desc.format != Format::Native {
            let name = CONVENTIONS.iter().find(|c| c.1 == desc.format).map_or("steradian", |c| c.0);
            let _ = writeln!(self.text, "conventions: {name}");
        }
        let mut named = self.choose();
        named.retain(|id| !self.inline.contains(id));
        let ids = super::unique(named.iter().map(|id| desc.node(*id)).map(|n| (n.name.as_deref(), n.kind.as_str())));
        self.ids = named.iter().copied().zip(ids).collect();
        // Those that refer to nodes stand after them.
        let (late, early): (Vec<_>, Vec<_>) =
            [("film", desc.film), ("filter", desc.filter), ("sampler", desc.sampler), ("integrator", desc.integrator)]
                .into_iter()
                .filter_map(|(section, id)| Some((section, id?)))
                .partition(|(_, id)| parts(desc.node(*id)).next().is_some());
        self.singles(early);
        self.section("nodes", '{', named, |w, id| {
            let mut line = String::new();
            value::string(&mut line, &w.ids[&id]);
            line + ": " + &w.map(w.desc.node(id), &mut Vec::new(), 1)
        });
        self.singles(late);
        let meshes: Vec<usize> = (0..desc.meshes.len()).collect();
        self.section("meshes", '{', meshes, |w, i| format!("mesh{i}: {}", w.mesh(i)));
        self.section("cameras", '[', desc.cameras.clone(), |w, id| w.node(id, 1));
        self.section("lights", '[', desc.lights.clone(), |w, id| w.node(id, 1));
        self.section("shapes", '[', desc.shapes.iter().collect(), |w, shape| w.shape(shape, 1));
        let groups: Vec<usize> = (0..desc.groups.len()).collect();
        let names = super::unique(desc.groups.iter().map(|g| (Some(g.name.as_str()), "group")));
        self.section("groups", '{', groups, |w, i| {
            let mut out = String::new();
            value::string(&mut out, &names[i]);
            out.push_str(": [\n");
            for shape in &w.desc.groups[i].shapes {
                out += &format!("        {}\n", w.shape(shape, 2));
            }
            out + "    ]"
        });
        self.section("instances", '[', desc.instances.iter().collect(), |_, instance| {
            let mut out = String::from("{group: ");
            value::string(&mut out, &names[instance.group]);
            placement(&mut out, &instance.world_from_group);
            if let Some(Movement { end, times: [begin, finish] }) = &instance.movement {
                out.push_str(", to_world_end: ");
                value::matrix(&mut out, end);
                let _ = write!(out, ", motion_times: [{begin}, {finish}]");
            }
            out + "}"
        });
    }

    /// Sections of one node each.
    fn singles(&mut self, sections: Vec<(&str, NodeId)>) {
        for (section, id) in sections {
            let node = self.map(self.desc.node(id), &mut Vec::new(), 0);
            let _ = writeln!(self.text, "{section}: {node}");
        }
    }

    fn section<T>(&mut self, name: &str, open: char, entries: Vec<T>, mut write: impl FnMut(&mut Self, T) -> String) {
        if entries.is_empty() {
            return;
        }
        let _ = writeln!(self.text, "\n{name}: {open}");
        for entry in entries {
            let line = write(self, entry);
            let _ = writeln!(self.text, "    {line}");
        }
        self.text.push_str(if open == '{' { "}\n" } else { "]\n" });
    }

    /// Decides what is written in place, and in which order the rest comes: what a node refers to before it.
    fn choose(&mut self) -> Vec<NodeId> {
        let desc = self.desc;
        let mut uses = vec![0_u32; desc.nodes.len()];
        let single = [desc.film, desc.filter, desc.sampler, desc.integrator];
        let slots = |s: &Shape| [Some(s.node), s.material, s.emission, s.interior, s.exterior];
        let shapes = desc.shapes.iter().chain(desc.groups.iter().flat_map(|g| &g.shapes));
        let listed = desc.lights.iter().chain(&desc.cameras).copied();
        for id in desc.nodes.iter().flat_map(parts).chain(listed).chain(shapes.flat_map(slots).flatten()) {
            uses[id.0 as usize] += 1;
        }
        let mut order = Vec::with_capacity(desc.nodes.len());
        let mut depths = vec![0_usize; desc.nodes.len()];
        let mut seen = vec![false; desc.nodes.len()];
        for root in 0..desc.nodes.len() as u32 {
            let mut stack = vec![(NodeId(root), false)];
            while let Some((id, is_left)) = stack.pop() {
                let i = id.0 as usize;
                if is_left {
                    let inner = parts(&desc.nodes[i]).filter(|p| self.inline.contains(p));
                    depths[i] = 1 + inner.map(|p| depths[p.0 as usize]).max().unwrap_or(0);
                    if desc.nodes[i].name.is_none() && uses[i] == 1 && depths[i] <= DEEPEST {
                        self.inline.insert(id);
                    }
                    order.push(id);
                } else if !std::mem::replace(&mut seen[i], true) {
                    stack.push((id, true));
                    stack.extend(parts(&desc.nodes[i]).map(|p| (p, false)));
                }
            }
        }
        let alone: HashSet<NodeId> = single.into_iter().flatten().collect();
        order.retain(|id| !(alone.contains(id) && uses[id.0 as usize] == 0));
        order
    }

    /// A node in place or by its name.
    fn node(&mut self, id: NodeId, indent: usize) -> String {
        if self.inline.contains(&id) {
            return self.map(self.desc.node(id), &mut Vec::new(), indent);
        }
        let mut out = String::new();
        reference(&mut out, self.ids.get(&id).map_or("", String::as_str));
        out
    }

    /// A node with what else belongs into its map.
    fn map(&mut self, node: &Node, more: &mut Vec<String>, indent: usize) -> String {
        let family = FAMILIES.iter().find(|f| f.1 == node.family).map_or("shape", |f| f.0);
        let mut kind = String::new();
        value::string(&mut kind, &node.kind);
        let mut parts = vec![format!("{family}: {kind}")];
        for param in &node.params {
            let mut part = String::new();
            value::string(&mut part, &param.name);
            part.push_str(": ");
            match &param.value {
                Value::Path(path) => {
                    let path = self.beside.path(path);
                    part.push_str("{file: ");
                    value::quoted(&mut part, &path);
                    part.push('}');
                }
                other => value::write(&mut part, &param.name, other, &mut |out, id| {
                    let text = self.node(id, indent + 1);
                    out.push_str(&text);
                }),
            }
            if is_nan(&param.value) {
                self.fault = Some(format!("'{}' of {} '{}' is not a number", param.name, family, node.kind));
            }
            parts.push(part);
        }
        parts.append(more);
        laid_out(&parts, indent)
    }

    fn shape(&mut self, shape: &Shape, indent: usize) -> String {
        let mut slots = Vec::new();
        if let Some(mesh) = shape.mesh {
            slots.push(format!("mesh: mesh{mesh}"));
        }
        let mut to_world = String::new();
        placement(&mut to_world, &shape.world_from_object);
        slots.extend(to_world.strip_prefix(", ").map(str::to_owned));
        for (name, id) in [
            ("material", shape.material),
            ("emission", shape.emission),
            ("interior", shape.interior),
            ("exterior", shape.exterior),
        ] {
            if let Some(id) = id {
                slots.push(format!("{name}: {}", self.node(id, indent + 1)));
            }
        }
        if shape.is_medium_boundary != (shape.interior.is_some() || shape.exterior.is_some()) {
            slots.push(format!("boundary: {}", shape.is_medium_boundary));
        }
        if shape.reverse_orientation {
            slots.push("reversed: true".into());
        }
        if self.inline.contains(&shape.node) {
            return self.map(self.desc.node(shape.node), &mut slots, indent);
        }
        slots.insert(0, format!("node: {}", self.node(shape.node, indent)));
        laid_out(&slots, indent)
    }

    fn mesh(&mut self, i: usize) -> String {
        let mesh = &self.desc.meshes[i];
        if mesh.positions.len() > SMALL_MESH
            && let Some(bytes) = ply::exact(mesh)
        {
            let name = self.beside.add("meshes", "mesh.ply", bytes);
            let mut out = String::from("{file: ");
            value::quoted(&mut out, &name);
            return out + "}";
        }
        inline_mesh(mesh)
    }
}

/// The nodes that a node refers to.
fn parts(node: &Node) -> impl Iterator<Item = NodeId> {
    node.params.iter().flat_map(|p| match &p.value {
        Value::Node(id) => vec![*id],
        Value::Nodes(ids) => ids.clone(),
        _ => Vec::new(),
    })
}

fn is_nan(value: &Value) -> bool {
    use steradian_scene::SpectrumValue as S;
    match value {
        Value::Float(v) | Value::Spectrum(S::Constant(v) | S::Blackbody(v)) => v.is_nan(),
        Value::Vec3(v) | Value::Spectrum(S::Rgb(v, _)) => v.iter().any(|v| v.is_nan()),
        Value::Floats(v) => v.iter().any(|v| v.is_nan()),
        Value::Spectrum(S::Sampled { lambdas, values }) => lambdas.iter().chain(values).any(|v| v.is_nan()),
        Value::Transform(t) => t.matrix.is_nan(),
        _ => false,
    }
}

/// A map on one line, or on several where that would be long.
fn laid_out(parts: &[String], indent: usize) -> String {
    let length: usize = parts.iter().map(|p| p.len() + 2).sum();
    if length <= LINE && !parts.iter().any(|p| p.contains('\n')) {
        return format!("{{{}}}", parts.join(", "));
    }
    let space = "    ".repeat(indent + 1);
    format!("{{\n{space}{}\n{}}}", parts.join(&format!("\n{space}")), "    ".repeat(indent))
}

fn placement(out: &mut String, t: &Transform) {
    if *t != Transform::IDENTITY {
        out.push_str(", to_world: ");
        value::matrix(out, t);
    }
}

fn inline_mesh(mesh: &Mesh) -> String {
    let mut parts = Vec::new();
    let mut floats = |name: &str, values: &mut dyn Iterator<Item = f32>| {
        let mut values = values.peekable();
        if values.peek().is_some() {
            let mut part = format!("{name}: ");
            value::single_list(&mut part, values);
            parts.push(part);
        }
    };
    floats("positions", &mut mesh.positions.iter().flatten().copied());
    floats("normals", &mut mesh.normals.iter().flatten().copied());
    floats("uvs", &mut mesh.uvs.iter().flatten().copied());
    floats("tangents", &mut mesh.tangents.iter().flatten().copied());
    let mut ints = |name: &str, values: Vec<i64>| {
        if !values.is_empty() {
            let mut part = format!("{name}: ");
            value::int_list(&mut part, &values);
            parts.push(part);
        }
    };
    ints("triangles", mesh.triangles.iter().flatten().map(|i| i64::from(*i)).collect());
    ints("patches", mesh.patches.iter().flatten().map(|i| i64::from(*i)).collect());
    let attributes: Vec<String> = mesh
        .attributes
        .iter()
        .map(|a| {
            let mut out = String::new();
            value::string(&mut out, &a.name);
            let domain = if a.domain == Domain::Vertex { "vertex" } else { "face" };
            let _ = write!(out, ": {{{domain}: {}, data: ", a.channels);
            value::single_list(&mut out, a.data.iter().copied());
            out + "}"
        })
        .collect();
    if !attributes.is_empty() {
        parts.push(format!("attributes: {{{}}}", attributes.join(", ")));
    }
    laid_out(&parts, 1)
}

//! From a document to a description.

use super::{
    Given, VERSION,
    parse::{Item, Key, Kind},
    value::{self, Slip, VALUES},
};
use crate::{
    Limits, Options,
    files::{self, SearchPath},
    mesh::ply::{self, PlyFile, PlyOptions},
};
use std::{collections::HashMap, sync::Arc};
use steradian_math::Transform;
use steradian_scene::{
    Attribute, Diagnostics, Domain, Family, Format, Group, Instance, Mesh, Movement, Node, NodeId, SceneDesc, Shape,
    Span, Value, names::did_you_mean,
};

/// Families by the key that begins a node.
pub(super) const FAMILIES: [(&str, Family); 12] = [
    ("shape", Family::Shape),
    ("material", Family::Material),
    ("texture", Family::Texture),
    ("light", Family::Light),
    ("medium", Family::Medium),
    ("phase", Family::Phase),
    ("camera", Family::Camera),
    ("film", Family::Film),
    ("filter", Family::Filter),
    ("sampler", Family::Sampler),
    ("integrator", Family::Integrator),
    ("accelerator", Family::Accelerator),
];

/// Formats whose conventions a scene may keep.
pub(super) const CONVENTIONS: [(&str, Format); 5] = [
    ("steradian", Format::Native),
    ("pbrt", Format::Pbrt),
    ("mitsuba", Format::Mitsuba),
    ("model", Format::Model),
    ("gltf", Format::Gltf),
];

/// Sections of a document.
const SECTIONS: [&str; 17] = [
    "steradian",
    "conventions",
    "nodes",
    "textures",
    "materials",
    "media",
    "meshes",
    "shapes",
    "groups",
    "instances",
    "lights",
    "cameras",
    "camera",
    "film",
    "filter",
    "sampler",
    "integrator",
];

/// Attachments to the node of a shape.
const SLOTS: [&str; 9] =
    ["node", "mesh", "to_world", "material", "emission", "interior", "exterior", "boundary", "reversed"];

/// A description in the making.
pub(super) struct Reader<'a> {
    pub desc: SceneDesc,
    pub diagnostics: Diagnostics,
    pub search: SearchPath,
    pub options: &'a Options,
    nodes: HashMap<String, NodeId>,
    meshes: HashMap<String, usize>,
    groups: HashMap<String, usize>,
    /// Files that are in memory, by the names that the document has for them.
    files: HashMap<String, Vec<u8>>,
}

type Read<T> = Result<T, Slip>;

impl<'a> Reader<'a> {
    /// Reads into a description; the names in `nodes` are known already.
    pub fn new(desc: SceneDesc, nodes: HashMap<String, NodeId>, search: SearchPath, options: &'a Options) -> Self {
        Self {
            desc,
            diagnostics: Diagnostics::default(),
            search,
            options,
            nodes,
            meshes: HashMap::new(),
            groups: HashMap::new(),
            files: HashMap::new(),
        }
    }

    /// Adds what the document may name and is not in it.
    pub fn with(mut self, given: Given) -> Self {
        self.files = given.files;
        for (name, mesh) in given.meshes {
            match mesh.validate() {
                Ok(()) => drop(self.meshes.insert(name, self.desc.add_mesh(mesh))),
                Err(e) => self.diagnostics.error(&self.desc.sources, None, format!("the mesh '{name}' is faulty: {e}")),
            }
        }
        self
    }

    pub fn fault(&mut self, (message, span): Slip) {
        self.diagnostics.error(&self.desc.sources, Some(span), message);
    }

    fn told<T>(&mut self, result: Read<T>) -> Option<T> {
        result.map_err(|slip| self.fault(slip)).ok()
    }

    /// All sections in the order of the text; after a fault the next entry goes on.
    pub fn document(&mut self, sections: &[(Key, Item)]) {
        match sections.first() {
            Some((key, item)) if key.text == "steradian" => match item.kind {
                Kind::Int(VERSION) => {}
                _ => self.fault((format!("this is not version {VERSION}, the one that can be read"), item.span)),
            },
            Some((key, _)) => {
                self.fault((format!("a scene begins with 'steradian: {VERSION}', its version"), key.span));
            }
            None => self.diagnostics.error(&self.desc.sources, None, "the scene is empty"),
        }
        for (i, (key, item)) in sections.iter().enumerate() {
            if sections[..i].iter().any(|(earlier, _)| earlier.text == key.text) {
                self.fault((format!("there is a section '{}' already", key.text), key.span));
            }
            if self.diagnostics.is_full() {
                return;
            }
            self.section(key, item);
        }
    }

    fn section(&mut self, key: &Key, item: &Item) {
        match key.text.as_str() {
            "steradian" => {}
            "conventions" => {
                let found = value::text(item).and_then(|word| {
                    let known = CONVENTIONS.map(|c| c.0);
                    let hint = did_you_mean(word, known).unwrap_or_default();
                    let fault =
                        || (format!("no conventions '{word}'; known are {} {hint}", known.join(", ")), item.span);
                    CONVENTIONS.iter().find(|c| c.0 == word).ok_or_else(fault)
                });
                if let Some((_, format)) = self.told(found) {
                    self.desc.format = *format;
                }
            }
            "nodes" | "textures" | "materials" | "media" => self.each(item, |reader, name, item| {
                let name = name.ok_or_else(|| ("a map from names to nodes is expected here".into(), item.span))?;
                reader.named(name, item).map(drop)
            }),
            "lights" => self.each(item, |reader, name, item| {
                let id = reader.maybe_named(name, item, Family::Light)?;
                reader.desc.lights.push(id);
                Ok(())
            }),
            "cameras" => self.each(item, |reader, name, item| {
                let id = reader.maybe_named(name, item, Family::Camera)?;
                reader.desc.cameras.push(id);
                Ok(())
            }),
            "meshes" => self.each(item, |reader, name, item| {
                let name = name.ok_or_else(|| ("a map from names to meshes is expected here".into(), item.span))?;
                let mesh = reader.mesh(item)?;
                reader.meshes.insert(name.text.clone(), mesh);
                Ok(())
            }),
            "shapes" => self.each(item, |reader, name, item| {
                let shape = reader.named_shape(name, item)?;
                reader.desc.shapes.push(shape);
                Ok(())
            }),
            "groups" => self.each(item, |reader, name, item| {
                let group = reader.desc.groups.len();
                let text = name.map(|n| n.text.clone()).unwrap_or_default();
                reader.desc.groups.push(Group { name: super::name_of(&text).unwrap_or_default(), shapes: Vec::new() });
                reader.groups.insert(text, group);
                reader.each(item, |reader, name, item| {
                    let shape = reader.named_shape(name, item)?;
                    reader.desc.groups[group].shapes.push(shape);
                    Ok(())
                });
                Ok(())
            }),
            "instances" => self.each(item, |reader, _, item| reader.instance(item)),
            "camera" | "film" | "filter" | "sampler" | "integrator" => {
                let family = FAMILIES.iter().find(|f| f.0 == key.text).map_or(Family::Film, |f| f.1);
                let id = self.node_of(item, family);
                let Some(id) = self.told(id) else { return };
                match family {
                    Family::Camera => self.desc.cameras.push(id),
                    Family::Film => self.desc.film = Some(id),
                    Family::Filter => self.desc.filter = Some(id),
                    Family::Sampler => self.desc.sampler = Some(id),
                    _ => self.desc.integrator = Some(id),
                }
            }
            other => {
                let help = did_you_mean(other, SECTIONS);
                let message = format!("unknown section '{other}'");
                self.diagnostics.error_help(&self.desc.sources, Some(key.span), message, help);
            }
        }
    }

    /// Every entry of a list, or of a map with its names.
    fn each(&mut self, item: &Item, mut read: impl FnMut(&mut Self, Option<&Key>, &Item) -> Read<()>) {
        let entries: Vec<(Option<&Key>, &Item)> = match &item.kind {
            Kind::List(items) => items.iter().map(|item| (None, item)).collect(),
            Kind::Map(pairs) => pairs.iter().map(|(key, item)| (Some(key), item)).collect(),
            other => return self.fault((format!("a list or a map is expected here, not {}", other.noun()), item.span)),
        };
        for (key, item) in entries {
            if self.diagnostics.is_full() {
                return;
            }
            let result = read(self, key, item);
            self.told(result);
        }
    }

    fn named(&mut self, key: &Key, item: &Item) -> Read<NodeId> {
        if self.nodes.contains_key(&key.text) {
            return Err((format!("there is a node '{}' already", key.text), key.span));
        }
        let id = self.node(item)?;
        self.desc.node_mut(id).name = super::name_of(&key.text);
        self.nodes.insert(key.text.clone(), id);
        Ok(id)
    }

    fn maybe_named(&mut self, key: Option<&Key>, item: &Item, family: Family) -> Read<NodeId> {
        match key {
            Some(key) => {
                let id = self.named(key, item)?;
                self.of_family(id, family, item.span)
            }
            None => self.node_of(item, family),
        }
    }

    fn of_family(&self, id: NodeId, family: Family, span: Span) -> Read<NodeId> {
        match self.desc.node(id).family {
            found if found == family => Ok(id),
            found => Err((format!("a {} is expected here, not a {}", family.noun(), found.noun()), span)),
        }
    }

    /// A node of a family, in place or by its name.
    fn node_of(&mut self, item: &Item, family: Family) -> Read<NodeId> {
        let id = match &item.kind {
            Kind::Text(name) => self.reference(name, item.span)?,
            _ => self.node_or_reference(item)?,
        };
        self.of_family(id, family, item.span)
    }

    fn reference(&self, name: &str, span: Span) -> Read<NodeId> {
        self.nodes.get(name).copied().ok_or_else(|| {
            let hint = did_you_mean(name, self.nodes.keys().map(String::as_str));
            let hint = hint.map(|h| format!("; {h}")).unwrap_or_default();
            (format!("there is no node '{name}' above{hint}"), span)
        })
    }

    fn node_or_reference(&mut self, item: &Item) -> Read<NodeId> {
        if let Kind::Map(pairs) = &item.kind
            && let Some((key, first)) = pairs.first()
            && key.text == "ref"
        {
            return self.reference(value::text(first)?, first.span);
        }
        self.node(item)
    }

    /// A node in place: a map that begins with its family and kind.
    fn node(&mut self, item: &Item) -> Read<NodeId> {
        let pairs = match &item.kind {
            Kind::Map(pairs) if !pairs.is_empty() => pairs,
            other => {
                return Err((
                    format!("a node, {{FAMILY: KIND, …}}, is expected here, not {}", other.noun()),
                    item.span,
                ));
            }
        };
        let mut node = self.empty_node(&pairs[0])?;
        for (key, item) in &pairs[1..] {
            self.parameter(&mut node, key, item)?;
        }
        Ok(self.desc.add(node))
    }

    fn empty_node(&self, (key, kind): &(Key, Item)) -> Read<Node> {
        let known = FAMILIES.map(|f| f.0);
        let family = FAMILIES.iter().find(|f| f.0 == key.text).ok_or_else(|| {
            let hint = did_you_mean(&key.text, known).map(|h| format!("; {h}")).unwrap_or_default();
            let example = "such as {material: diffuse, …} or {light: area, …}";
            (format!("a node begins with its family and kind, {example}: '{}' is no family{hint}", key.text), key.span)
        })?;
        Ok(Node::new(family.1, value::text(kind)?, Some(kind.span)))
    }

    fn parameter(&mut self, node: &mut Node, key: &Key, item: &Item) -> Read<()> {
        if let Some(help) = self.options.kinds.unknown(node.family, &node.kind, &key.text) {
            let message = format!("{} '{}' has no parameter '{}'", node.family.noun(), node.kind, key.text);
            self.diagnostics.unused(&self.desc.sources, Some(key.span), message, help);
        }
        if node.param(&key.text).is_some() {
            return Err((format!("'{}' is set already", key.text), key.span));
        }
        let value = self.value_of(node.family, &node.kind, &key.text, item)?;
        node.set(key.text.clone(), value, Some(item.span));
        Ok(())
    }

    /// A value for a parameter of a kind: three numbers are a colour where it takes one.
    pub fn value_of(&mut self, family: Family, kind: &str, name: &str, item: &Item) -> Read<Value> {
        let parameter = || self.options.kinds.parameters(family, kind)?.find(|p| p.name == name);
        match &item.kind {
            Kind::List(items) if parameter().is_some_and(|p| p.takes_color(items.len())) => value::color(name, item),
            _ => self.value(name, item),
        }
    }

    /// A value of any kind.
    fn value(&mut self, name: &str, item: &Item) -> Read<Value> {
        let first = |item: &Item| match &item.kind {
            Kind::Map(pairs) => pairs.first().map(|(key, _)| key.text.clone()),
            _ => None,
        };
        let is_node = |word: &str| word == "ref" || FAMILIES.iter().any(|f| f.0 == word) || !VALUES.contains(&word);
        match &item.kind {
            Kind::Map(pairs) => match first(item) {
                Some(word) if word == "file" => {
                    let path = value::text(&pairs[0].1)?;
                    if let Some(bytes) = self.files.get(path) {
                        self.desc.embedded.insert(path.into(), bytes.as_slice().into());
                        return Ok(Value::Path(path.into()));
                    }
                    self.search.find(path).map(Value::Path).map_err(|e| (e.to_string(), pairs[0].1.span))
                }
                Some(word) if is_node(&word) => self.node_or_reference(item).map(Value::Node),
                _ => value::plain(name, item),
            },
            Kind::List(items) if items.first().and_then(first).is_some_and(|word| is_node(&word)) => {
                items.iter().map(|item| self.node_or_reference(item)).collect::<Read<Vec<_>>>().map(Value::Nodes)
            }
            _ => value::plain(name, item),
        }
    }

    /// A shape that may have a name, which its node then has.
    fn named_shape(&mut self, key: Option<&Key>, item: &Item) -> Read<Shape> {
        let Some(key) = key else { return self.shape(item) };
        if self.nodes.contains_key(&key.text) {
            return Err((format!("there is a node '{}' already", key.text), key.span));
        }
        let nodes = self.desc.nodes.len();
        let shape = self.shape(item)?;
        // One that stands in another place has its name there.
        if shape.node.0 as usize >= nodes {
            self.desc.node_mut(shape.node).name = super::name_of(&key.text);
            self.nodes.insert(key.text.clone(), shape.node);
        }
        Ok(shape)
    }

    fn shape(&mut self, item: &Item) -> Read<Shape> {
        let Kind::Map(pairs) = &item.kind else {
            return Err((
                format!("a shape, {{shape: KIND, …}}, is expected here, not {}", item.kind.noun()),
                item.span,
            ));
        };
        let Some(first) = pairs.first() else { return Err(("this shape is empty".into(), item.span)) };
        let mut own = match first.0.text.as_str() {
            "node" => None,
            _ => Some(self.empty_node(first)?),
        };
        let mut shape = Shape::new(NodeId(0));
        let mut boundary = None;
        for (key, item) in pairs.iter().skip(usize::from(own.is_some())) {
            match key.text.as_str() {
                "node" if own.is_none() => shape.node = self.node_of(item, Family::Shape)?,
                "mesh" => shape.mesh = Some(self.mesh_of(item)?),
                "to_world" => shape.world_from_object = value::transform(item)?,
                "material" => shape.material = Some(self.node_of(item, Family::Material)?),
                "emission" => shape.emission = Some(self.node_of(item, Family::Light)?),
                "interior" => shape.interior = self.medium(item)?,
                "exterior" => shape.exterior = self.medium(item)?,
                "boundary" => boundary = Some(boolean(item)?),
                "reversed" => shape.reverse_orientation = boolean(item)?,
                other => match &mut own {
                    Some(node) => self.parameter(node, key, item)?,
                    None => {
                        let hint = did_you_mean(other, SLOTS).unwrap_or_default();
                        return Err((format!("a shape has no '{other}' {hint}"), key.span));
                    }
                },
            }
        }
        shape.is_medium_boundary = boundary.unwrap_or(shape.interior.is_some() || shape.exterior.is_some());
        if let Some(node) = own {
            if node.family != Family::Shape {
                return Err((format!("a shape is expected here, not a {}", node.family.noun()), first.0.span));
            }
            shape.node = self.desc.add(node);
        }
        Ok(shape)
    }

    /// A medium, or `null` for none.
    fn medium(&mut self, item: &Item) -> Read<Option<NodeId>> {
        match item.kind {
            Kind::Null => Ok(None),
            _ => self.node_of(item, Family::Medium).map(Some),
        }
    }

    fn instance(&mut self, item: &Item) -> Read<()> {
        let Kind::Map(pairs) = &item.kind else {
            return Err((
                format!("{{group: NAME, to_world: …}} is expected here, not {}", item.kind.noun()),
                item.span,
            ));
        };
        let (mut group, mut world_from_group) = (None, Transform::IDENTITY);
        let (mut end, mut times) = (None, [0.0, 1.0]);
        for (key, item) in pairs {
            match key.text.as_str() {
                "group" => {
                    let name = value::text(item)?;
                    let hint = || did_you_mean(name, self.groups.keys().map(String::as_str)).unwrap_or_default();
                    let found = self.groups.get(name).copied();
                    group = Some(found.ok_or_else(|| {
                        (format!("there is no group '{name}' above {}", hint()).trim_end().to_owned(), item.span)
                    })?);
                }
                "to_world" => world_from_group = value::transform(item)?,
                "to_world_end" => end = Some(value::transform(item)?),
                "motion_times" => times = value::array(item)?,
                other => {
                    let known = "'group', 'to_world', 'to_world_end' and 'motion_times'";
                    return Err((format!("an instance has no '{other}', but {known}"), key.span));
                }
            }
        }
        let group = group.ok_or_else(|| ("this instance lacks its 'group'".to_owned(), item.span))?;
        if self.desc.instances.len() >= self.options.limits.instances {
            return Err((format!("there are more than {} instances", self.options.limits.instances), item.span));
        }
        self.desc.instances.push(Instance {
            movement: end.map(|end| Movement { end, times }),
            span: Some(item.span),
            ..Instance::new(group, world_from_group)
        });
        Ok(())
    }

    fn mesh_of(&mut self, item: &Item) -> Read<usize> {
        let Kind::Text(name) = &item.kind else { return self.mesh(item) };
        let hint = || did_you_mean(name, self.meshes.keys().map(String::as_str)).unwrap_or_default();
        self.meshes.get(name).copied().ok_or_else(|| {
            (format!("there is no mesh '{name}' above; a file is written {{file: \"name.ply\"}} {}", hint()), item.span)
        })
    }

    /// The mesh of a file, after saying what is wrong with it.
    fn mended(&mut self, file: PlyFile, span: Span) -> Mesh {
        if let Some(warning) = file.warning() {
            self.diagnostics.warn(&self.desc.sources, Some(span), warning);
        }
        file.mesh
    }

    fn mesh(&mut self, item: &Item) -> Read<usize> {
        let Kind::Map(pairs) = &item.kind else {
            return Err((format!("a mesh is expected here, not {}", item.kind.noun()), item.span));
        };
        let mesh = match pairs.first() {
            Some((key, file)) if key.text == "file" => {
                if let Some((key, _)) = pairs.get(1) {
                    return Err((format!("'{}' does not belong here", key.text), key.span));
                }
                let name = value::text(file)?;
                match self.files.get(name) {
                    Some(bytes) => {
                        let read = parse_ply(name.as_ref(), bytes).map_err(|e| (e, file.span))?;
                        self.mended(read, file.span)
                    }
                    None => {
                        let path = self.search.find(name).map_err(|e| (e.to_string(), file.span))?;
                        let read = read_ply(&path, &self.options.limits).map_err(|e| (e, file.span))?;
                        self.desc.sources.note(path);
                        self.mended(read, file.span)
                    }
                }
            }
            _ => inline_mesh(pairs)?,
        };
        mesh.validate().map_err(|e| (format!("this mesh is faulty: {e}"), item.span))?;
        Ok(self.desc.add_mesh(Arc::new(mesh)))
    }
}

fn boolean(item: &Item) -> Read<bool> {
    match item.kind {
        Kind::Bool(v) => Ok(v),
        _ => Err((format!("true or false is expected here, not {}", item.kind.noun()), item.span)),
    }
}

fn read_ply(path: &std::path::Path, limits: &Limits) -> Result<PlyFile, String> {
    parse_ply(path, &files::read(path, limits).map_err(|e| e.to_string())?)
}

fn parse_ply(path: &std::path::Path, bytes: &[u8]) -> Result<PlyFile, String> {
    let file = ply::read(bytes, &PlyOptions { keep_quads: true, ..PlyOptions::default() });
    file.map_err(|e| format!("cannot read the mesh '{}': {e}", path.display()))
}

/// Numbers `N` by `N`.
fn tuples<const N: usize>(item: &Item) -> Read<Vec<[f32; N]>> {
    let flat = value::numbers(item)?;
    if !flat.len().is_multiple_of(N) {
        return Err((format!("{} numbers are no multiple of {N}", flat.len()), item.span));
    }
    Ok(flat.chunks_exact(N).map(|c| std::array::from_fn(|i| c[i] as f32)).collect())
}

fn indices<const N: usize>(item: &Item) -> Read<Vec<[u32; N]>> {
    let Kind::List(items) = &item.kind else {
        return Err((format!("a list of indices is expected here, not {}", item.kind.noun()), item.span));
    };
    let one = |item: &Item| match item.kind {
        Kind::Int(v) => u32::try_from(v).map_err(|_| (format!("{v} is no index"), item.span)),
        _ => Err((format!("an index is expected here, not {}", item.kind.noun()), item.span)),
    };
    let flat: Vec<u32> = items.iter().map(one).collect::<Read<_>>()?;
    if !flat.len().is_multiple_of(N) {
        return Err((format!("{} indices are no multiple of {N}", flat.len()), item.span));
    }
    Ok(flat.chunks_exact(N).map(|c| std::array::from_fn(|i| c[i])).collect())
}

fn inline_mesh(pairs: &[(Key, Item)]) -> Read<Mesh> {
    const PARTS: [&str; 8] = ["file", "positions", "normals", "uvs", "tangents", "triangles", "patches", "attributes"];
    let mut mesh = Mesh::default();
    for (key, item) in pairs {
        match key.text.as_str() {
            "positions" => mesh.positions = tuples(item)?,
            "normals" => mesh.normals = tuples(item)?,
            "uvs" => mesh.uvs = tuples(item)?,
            "tangents" => mesh.tangents = tuples(item)?,
            "triangles" => mesh.triangles = indices(item)?.into(),
            "patches" => mesh.patches = indices(item)?,
            "attributes" => mesh.attributes = attributes(item)?,
            other => {
                let hint = did_you_mean(other, PARTS).unwrap_or_default();
                return Err((format!("a mesh has no '{other}'; known are {} {hint}", PARTS.join(", ")), key.span));
            }
        }
    }
    Ok(mesh)
}

/// `{name: {vertex: N, data: […]}}`: so many numbers for each vertex, or each `face`.
fn attributes(item: &Item) -> Read<Vec<Attribute>> {
    let wanted = || ("attributes are written {name: {vertex: N, data: […]}}, or 'face'".to_owned(), item.span);
    let Kind::Map(pairs) = &item.kind else { return Err(wanted()) };
    let one = |(key, item): &(Key, Item)| {
        let Kind::Map(parts) = &item.kind else { return Err(wanted()) };
        let [(domain, count), (data, values)] = parts.as_slice() else { return Err(wanted()) };
        let domain = match (domain.text.as_str(), data.text.as_str()) {
            ("vertex", "data") => Domain::Vertex,
            ("face", "data") => Domain::Face,
            _ => return Err(wanted()),
        };
        let Kind::Int(channels @ 1..=4) = count.kind else {
            return Err(("1 to 4 numbers for each are expected".into(), count.span));
        };
        let data = value::numbers(values)?.into_iter().map(|v| v as f32).collect();
        Ok(Attribute { name: key.text.clone(), domain, channels: channels as usize, data })
    };
    pairs.iter().map(one).collect()
}

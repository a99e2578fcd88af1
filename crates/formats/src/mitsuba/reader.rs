//! State shared by all translators: typed access to properties, messages, and a cache of translated objects.

use super::{
    graph::{Category, Graph, Object, ObjectId, Prop, Raw},
    meshes::MeshQueue,
    plugins,
    texture::{Role, rgb},
};
use crate::{Options, files::SearchPath};
use std::{
    collections::{HashMap, HashSet},
    path::PathBuf,
};
use steradian_scene::{Diagnostics, Family, Node, NodeId, SceneDesc, Sources, Span, Transform, Value, names};

/// Deepest nesting of objects in each other, references followed.
const NESTING: usize = 64;

/// Key of a translated object: the same object means different nodes in different places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Use {
    pub object: ObjectId,
    /// Role of a texture.
    pub role: Role,
    /// On a disk, whose texture coordinates Mitsuba lays out differently.
    pub disk: bool,
}

enum Translated {
    /// Being translated: meeting it again means that it contains itself.
    Open,
    Done(Option<NodeId>),
}

/// Translates a [`Graph`] to a [`SceneDesc`].
pub(super) struct Reader<'a> {
    pub graph: Graph,
    pub desc: SceneDesc,
    pub diagnostics: Diagnostics,
    pub search: SearchPath,
    pub options: &'a Options,
    pub meshes: MeshQueue,
    /// Index into [`SceneDesc::groups`] of each shape group.
    pub groups: HashMap<ObjectId, usize>,
    /// Merged shapes that were translated.
    pub merged: HashSet<ObjectId>,
    /// True while the shape being translated is a disk.
    pub on_disk: bool,
    /// The curves beyond the first of the shape being translated.
    pub more_curves: Vec<NodeId>,
    pub depth: usize,
    /// Messages about properties that are not followed, each of which is said once.
    pub said: HashSet<String>,
    translated: HashMap<Use, Translated>,
}

impl<'a> Reader<'a> {
    pub fn new(
        graph: Graph,
        sources: Sources,
        diagnostics: Diagnostics,
        search: SearchPath,
        options: &'a Options,
    ) -> Self {
        let desc = SceneDesc { format: steradian_scene::Format::Mitsuba, sources, ..SceneDesc::default() };
        Self {
            graph,
            desc,
            diagnostics,
            search,
            options,
            meshes: MeshQueue::default(),
            groups: HashMap::new(),
            merged: HashSet::new(),
            on_disk: false,
            more_curves: Vec::new(),
            depth: 0,
            said: HashSet::new(),
            translated: HashMap::new(),
        }
    }

    /// The place of a message. Finding its line means counting lines, which messages that are not kept are not worth.
    fn place(&self, span: Span) -> Option<Span> {
        (self.diagnostics.suppressed() == 0).then_some(span)
    }

    pub fn error(&mut self, span: Span, message: impl Into<String>) {
        let place = Some(span).filter(|_| !self.diagnostics.is_full());
        self.diagnostics.error(&self.desc.sources, place, message);
    }

    pub fn warn(&mut self, span: Span, message: impl Into<String>) {
        self.diagnostics.warn(&self.desc.sources, self.place(span), message);
    }

    pub fn note(&mut self, span: Span, message: impl Into<String>) {
        self.diagnostics.note(&self.desc.sources, self.place(span), message);
    }

    pub fn approximated(&mut self, span: Span, message: impl Into<String>) {
        self.diagnostics.approximated(&self.desc.sources, self.place(span), message);
    }

    pub fn dropped(&mut self, span: Span, message: impl Into<String>) {
        self.diagnostics.dropped(&self.desc.sources, self.place(span), message);
    }

    pub fn plugin(&self, object: ObjectId) -> &str {
        &self.graph.objects[object].plugin
    }

    pub fn span(&self, object: ObjectId) -> Span {
        self.graph.objects[object].span
    }

    /// An empty node for an object, with its place and its id as name.
    pub fn node(&self, family: Family, kind: &str, object: ObjectId) -> Node {
        let object = &self.graph.objects[object];
        Node { name: object.id.clone(), ..Node::new(family, kind, Some(object.span)) }
    }

    /// Refuses a plugin Mitsuba does not have, with the nearest name.
    pub fn unknown_plugin(&mut self, object: ObjectId) {
        let (category, plugin, span) = {
            let o = &mut self.graph.objects[object];
            o.visited = true;
            // Its properties would all be "unused".
            o.props.iter_mut().for_each(|p| p.used = true);
            (o.category, o.plugin.clone(), o.span)
        };
        // Where the type is missing, the parser has said so.
        if plugin.is_empty() {
            return;
        }
        let help = names::did_you_mean(&plugin, plugins::known(category).iter().copied());
        let message = format!("unknown {} '{plugin}'", category.noun());
        self.diagnostics.error_help(&self.desc.sources, Some(span), message, help);
    }

    /// Refuses plugins that Mitsuba does not have among the objects that nothing uses; the others are refused where
    /// they are used.
    pub fn report_unknown(&mut self) {
        for object in 1..self.graph.objects.len() {
            if self.diagnostics.is_full() {
                return;
            }
            if !self.graph.objects[object].visited && !self.is_known(object) {
                self.unknown_plugin(object);
            }
        }
    }

    /// True if Mitsuba (of any version) has this plugin.
    pub fn is_known(&self, object: ObjectId) -> bool {
        plugins::known(self.graph.objects[object].category).contains(&self.plugin(object))
    }

    fn wrong_type(&mut self, prop: &Prop, wanted: &str) {
        let message = format!("'{}' needs {wanted}, not {}", prop.name, prop.value.noun());
        self.error(prop.value_span, message);
    }

    pub fn float(&mut self, object: ObjectId, name: &'static str) -> Option<f64> {
        let prop = self.graph.take(object, name)?;
        match prop.value {
            Raw::Float(v) => Some(v),
            Raw::Int(v) => Some(v as f64),
            _ => {
                self.wrong_type(&prop, "a number");
                None
            }
        }
    }

    pub fn int(&mut self, object: ObjectId, name: &'static str) -> Option<i64> {
        let prop = self.graph.take(object, name)?;
        match prop.value {
            Raw::Int(v) => Some(v),
            Raw::Float(v) if v.fract() == 0.0 && v.abs() < 1e15 => Some(v as i64),
            _ => {
                self.wrong_type(&prop, "a whole number");
                None
            }
        }
    }

    pub fn bool(&mut self, object: ObjectId, name: &'static str) -> Option<bool> {
        let prop = self.graph.take(object, name)?;
        match prop.value {
            Raw::Bool(v) => Some(v),
            _ => {
                self.wrong_type(&prop, "a boolean");
                None
            }
        }
    }

    pub fn string(&mut self, object: ObjectId, name: &'static str) -> Option<String> {
        let prop = self.graph.take(object, name)?;
        match prop.value {
            Raw::String(v) => Some(v),
            _ => {
                self.wrong_type(&prop, "a string");
                None
            }
        }
    }

    /// One of a few words, in any case; the first is the default. Others are errors.
    pub fn choice(&mut self, object: ObjectId, name: &'static str, words: &[&'static str]) -> &'static str {
        let default = words.first().copied().unwrap_or_default();
        let Some(text) = self.string(object, name) else { return default };
        if let Some(word) = words.iter().find(|w| w.eq_ignore_ascii_case(&text)) {
            return word;
        }
        let span = self.value_span(object, name);
        let help = names::did_you_mean(&text, words.iter().copied());
        let message = format!("'{name}' is '{text}'; it can be {}", plugins::list(words));
        self.diagnostics.error_help(&self.desc.sources, Some(span), message, help);
        default
    }

    pub fn vec3(&mut self, object: ObjectId, name: &'static str) -> Option<[f64; 3]> {
        let prop = self.graph.take(object, name)?;
        match prop.value {
            Raw::Vec3(v) => Some(v),
            _ => {
                self.wrong_type(&prop, "a point or vector");
                None
            }
        }
    }

    /// An invertible transform, the identity where the file has none.
    pub fn transform(&mut self, object: ObjectId, name: &'static str) -> Transform {
        self.some_transform(object, name).unwrap_or_default()
    }

    /// An invertible transform, if the file has one.
    pub fn some_transform(&mut self, object: ObjectId, name: &'static str) -> Option<Transform> {
        let prop = self.graph.take(object, name)?;
        match prop.value {
            Raw::Transform(t) if t.affine().is_some() => Some(t),
            Raw::Transform(_) => {
                self.error(prop.value_span, format!("the transform '{name}' cannot be inverted"));
                None
            }
            _ => {
                self.wrong_type(&prop, "a transform");
                None
            }
        }
    }

    /// The file a property names, searched for.
    pub fn file(&mut self, object: ObjectId, name: &'static str) -> Option<PathBuf> {
        let text = self.string(object, name)?;
        self.find_file(&text, self.value_span(object, name))
    }

    /// The file that a required property names, searched for; an error where the property is absent.
    pub fn needed_file(&mut self, object: ObjectId, name: &'static str) -> Option<PathBuf> {
        if !self.graph.has(object, name) {
            let (noun, span) = (self.graph.objects[object].category.noun(), self.span(object));
            let message = format!("the {noun} '{}' needs '{name}'", self.plugin(object));
            self.error(span, message);
        }
        self.file(object, name)
    }

    pub fn find_file(&mut self, name: &str, span: Span) -> Option<PathBuf> {
        self.search.find(name).map_err(|e| self.error(span, e.to_string())).ok()
    }

    /// Source span of a property's value; of the object where it has no such property.
    pub fn value_span(&self, object: ObjectId, name: &str) -> Span {
        let o = &self.graph.objects[object];
        o.props.iter().find(|p| p.name == name).map_or(o.span, |p| p.value_span)
    }

    /// Marks properties as used of which another message speaks.
    pub fn ignore(&mut self, object: ObjectId, names: &[&'static str]) {
        for name in names {
            self.graph.take(object, name);
        }
    }

    /// Translates an object once per use. Objects that contain themselves, or nest too deep, are errors.
    pub fn once(
        &mut self,
        object: ObjectId,
        role: Role,
        make: impl FnOnce(&mut Self) -> Option<NodeId>,
    ) -> Option<NodeId> {
        let key = Use { object, role, disk: self.on_disk };
        match self.translated.get(&key) {
            Some(Translated::Done(node)) => return *node,
            Some(Translated::Open) => {
                let message = format!("the {} contains itself", self.graph.objects[object].category.noun());
                self.error(self.span(object), message);
                return None;
            }
            None => {}
        }
        if !self.enter(object) {
            return None;
        }
        self.translated.insert(key, Translated::Open);
        let node = make(self);
        self.translated.insert(key, Translated::Done(node));
        self.leave();
        node
    }

    /// Goes one level deeper into nested objects; `false` after an error when that is too deep.
    pub fn enter(&mut self, object: ObjectId) -> bool {
        if self.depth >= NESTING {
            self.error(self.span(object), format!("objects nest deeper than {NESTING} levels"));
            return false;
        }
        self.depth += 1;
        true
    }

    pub fn leave(&mut self) {
        self.depth -= 1;
    }

    /// A node of the file's own kind with all its parameters, for models that Steradian renders as the nearest one it
    /// has.
    pub fn verbatim(&mut self, object: ObjectId, family: Family) -> Option<NodeId> {
        let mut node = self.node(family, self.plugin(object), object);
        let o = &mut self.graph.objects[object];
        o.visited = true;
        o.props.iter_mut().for_each(|p| p.used = true);
        for prop in o.props.clone() {
            let value = match prop.value {
                Raw::Bool(v) => Value::Bool(v),
                Raw::Int(v) => Value::Int(v),
                Raw::Float(v) => Value::Float(v),
                Raw::String(v) if prop.name == "filename" => match self.find_file(&v, prop.value_span) {
                    Some(path) => Value::Path(path),
                    None => continue,
                },
                Raw::String(_) if prop.name == "int_ior" => Value::Float(self.ior(object, "int_ior", "bk7")),
                Raw::String(_) if prop.name == "ext_ior" => Value::Float(self.ior(object, "ext_ior", "air")),
                Raw::String(v) => Value::String(v),
                Raw::Vec3(v) => Value::Vec3(v),
                Raw::Rgb(v) => rgb(v),
                Raw::Spectrum(s) => Value::Spectrum(s),
                Raw::Transform(t) => Value::Transform(t),
                Raw::Object(child) => match self.any(child) {
                    Some(value) => value,
                    None => continue,
                },
                Raw::Ref(_) => continue,
            };
            let name = if prop.name.is_empty() { self.free_name(&node, &value) } else { prop.name };
            node.set(name, value, Some(prop.value_span));
        }
        Some(self.desc.add(node))
    }

    /// Name of an unnamed nested object: the noun of its family, numbered from the second on.
    fn free_name(&self, node: &Node, value: &Value) -> String {
        let noun = match value {
            Value::Node(n) if self.desc.node(*n).family == Family::Phase => "phase",
            Value::Node(n) => self.desc.node(*n).family.noun(),
            _ => "value",
        };
        let numbered = (2..).map(|i| format!("{noun}_{i}"));
        let mut names = std::iter::once(noun.to_owned()).chain(numbered);
        names.find(|n| node.get(n).is_none()).unwrap_or_default()
    }

    /// A nested object of any category that can be a parameter.
    fn any(&mut self, child: ObjectId) -> Option<Value> {
        match self.graph.objects[child].category {
            Category::Bsdf => self.material(child).map(Value::Node),
            Category::Texture => self.texture(child, Role::Unbounded),
            Category::Medium => self.medium(child).map(Value::Node),
            Category::Phase => self.phase(child).map(Value::Node),
            Category::Volume => self.volume(child, Role::Unbounded),
            category => {
                let span = self.span(child);
                self.dropped(span, format!("a {} cannot be a parameter here; it is left out", category.noun()));
                None
            }
        }
    }

    /// Reports the properties that no translator asked for, with the nearest name that one asked for. What recurs is
    /// said once.
    pub fn report_unused(&mut self) {
        let mut unused: Vec<(&Object, &Prop, usize)> = Vec::new();
        let mut known = HashMap::new();
        for object in self.graph.objects.iter().filter(|o| o.visited) {
            for prop in object.props.iter().filter(|p| !p.used) {
                let at = *known.entry((object.category, &object.plugin, &prop.name)).or_insert(unused.len());
                match unused.get_mut(at) {
                    Some((.., more)) => *more += 1,
                    None => unused.push((object, prop, 0)),
                }
            }
        }
        for (object, prop, more) in unused.into_iter().take(Diagnostics::MAX_OTHERS) {
            let what = match object.category {
                Category::Scene => "the scene".to_owned(),
                category => format!("the {} '{}'", category.noun(), object.plugin),
            };
            let named = self.graph.called(prop);
            let places = if more > 0 { format!(" (here and in {more} more places)") } else { String::new() };
            let help = names::did_you_mean(&prop.name, object.asked.iter().copied());
            let message = format!("{what} does not use {named}{places}");
            self.diagnostics.unused(&self.desc.sources, Some(prop.span), message, help);
        }
    }
}

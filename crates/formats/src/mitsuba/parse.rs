//! XML to [`Graph`]: files, elements, objects, references.

use super::{
    graph::{Category, Graph, Object, ObjectId, Prop, Raw},
    parameters::{Fault, Parameters},
    upgrade,
};
use crate::{
    Limits, Options,
    files::{self, Included, SearchPath},
    xml,
};
use roxmltree::Node;
use std::{
    borrow::Cow,
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_scene::{Diagnostics, FileId, Sources, Span, names};

/// Largest XML file, in bytes.
const XML_BYTES: u64 = 1 << 30;
/// Most ids that a misspelt one is compared with.
const COMPARED_IDS: usize = 20_000;
/// Objects with more properties than this have the names of them indexed.
const FEW_PROPERTIES: usize = 32;

/// An attribute after parameters were put in.
pub(super) struct Attr<'n> {
    pub name: &'n str,
    pub value: Cow<'n, str>,
    pub name_span: Span,
    pub value_span: Span,
}

/// The attributes of an element.
pub(super) struct Attributes<'n> {
    pub list: Vec<Attr<'n>>,
    /// One of them asks for a parameter without a value. It is reported and left out.
    pub broken: bool,
}

impl<'n> Attributes<'n> {
    /// The attribute of this name.
    pub fn get(&self, name: &str) -> Option<&Attr<'n>> {
        self.list.iter().find(|a| a.name == name)
    }

    /// The value of this name.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.get(name).map(|a| a.value.as_ref())
    }
}

/// The file that is being parsed.
pub(super) struct File {
    pub id: FileId,
    pub folder: PathBuf,
    /// Before version 2: other spellings and a few other elements.
    pub legacy: bool,
    /// Include depth below the scene file.
    pub depth: usize,
}

/// Parent of the objects of an included file.
pub(super) struct Host<'a> {
    pub parent: ObjectId,
    /// The name for what is not a whole scene.
    pub name: &'a str,
    /// Nesting of includes.
    pub depth: usize,
}

/// Reads a scene file and all it includes.
pub(super) struct Parser<'a> {
    pub graph: Graph,
    pub sources: Sources,
    pub diagnostics: Diagnostics,
    /// Search folders of files: `<path>` elements, latest first, then the scene's folder, then [`Options::search`].
    pub search: SearchPath,
    pub options: &'a Options,
    pub parameters: Parameters,
    /// Files included so far.
    pub includes: usize,
    /// The names that are set on objects with more than a few properties.
    names: HashMap<ObjectId, HashSet<String>>,
    pub included: Included,
}

impl<'a> Parser<'a> {
    /// A parser for a scene in this folder.
    pub fn new(folder: PathBuf, options: &'a Options) -> Self {
        Self {
            graph: Graph::default(),
            sources: Sources::default(),
            diagnostics: Diagnostics::default(),
            search: SearchPath::new(Some(&folder), options),
            options,
            parameters: Parameters::new(&options.defines),
            includes: 0,
            names: HashMap::new(),
            included: Included::default(),
        }
    }

    /// Reads the main file.
    pub fn main_file(&mut self, path: &Path) {
        match files::read(path, &self.xml_limits()) {
            Ok(bytes) => self.main_text(path, bytes),
            Err(e) => self.diagnostics.error(&self.sources, None, e.to_string()),
        }
    }

    /// Reads the main file's text.
    pub fn main_text(&mut self, path: &Path, text: Vec<u8>) {
        self.text(path, text.into(), None);
        for name in self.parameters.unused() {
            let message = format!("the scene has no parameter '{name}'");
            let help = names::did_you_mean(name, self.parameters.names().filter(|n| *n != name));
            self.diagnostics.unused(&self.sources, None, message, help);
        }
        upgrade::upgrade(&mut self.graph);
        self.resolve();
    }

    /// Limits for XML files, of which none is very large.
    pub fn xml_limits(&self) -> Limits {
        let limits = &self.options.limits;
        Limits { file_bytes: limits.file_bytes.min(XML_BYTES), ..limits.clone() }
    }

    pub fn error(&mut self, span: Span, message: impl Into<String>) {
        let place = Some(span).filter(|_| !self.diagnostics.is_full());
        self.diagnostics.error(&self.sources, place, message);
    }

    /// Parses one file.
    pub fn text(&mut self, path: &Path, bytes: Arc<[u8]>, host: Option<Host<'_>>) {
        let id = self.sources.add(path, bytes.clone());
        let checked = xml::decode(&bytes).and_then(|text| {
            xml::precheck(text, self.options.limits.nesting)?;
            xml::parse(text)
        });
        let document = match checked {
            Ok(document) => document,
            Err(fault) => return self.error(Span::new(id, fault.at.start, fault.at.end), fault.message),
        };
        let root = document.root_element();
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let mut file = File { id, folder, legacy: false, depth: host.as_ref().map_or(0, |h| h.depth) };
        let attributes = self.attributes(root, &file);
        file.legacy = self.is_legacy(root, &file, &attributes);
        match host {
            // The contents of an included scene go where the include stands.
            Some(host) if root.has_tag_name("scene") => self.subtree(root, host.parent, &file),
            Some(host) => {
                if let Some(object) = self.element(root, host.parent, &file, Some(host.name)) {
                    self.subtree(root, object, &file);
                }
            }
            None => {
                if !root.has_tag_name("scene") {
                    let message = format!("the outermost element is <{}> instead of <scene>", root.tag_name().name());
                    self.error(tag_span(root, &file), message);
                }
                let scene = self.add_object(Category::Scene, root, &attributes, &file);
                self.subtree(root, scene, &file);
            }
        }
    }

    /// True if a file is of a version before 2, by its root's `version`.
    fn is_legacy(&mut self, root: Node<'_, '_>, file: &File, attributes: &Attributes<'_>) -> bool {
        let Some(version) = attributes.get("version") else {
            let message = format!("the element <{}> needs the attribute 'version'", root.tag_name().name());
            let help = Some("for example version=\"3.0.0\"".to_owned());
            self.diagnostics.error_help(&self.sources, Some(tag_span(root, file)), message, help);
            return false;
        };
        let major = version.value.split('.').next().and_then(|major| major.trim().parse::<u32>().ok());
        if major.is_none() {
            self.error(version.value_span, format!("'{}' is not a version number", version.value));
        }
        major.is_some_and(|m| m < 2)
    }

    /// Parses what stands below an element in document order, with a stack of its own in place of recursion.
    fn subtree(&mut self, root: Node<'_, '_>, object: ObjectId, file: &File) {
        let mut stack: Vec<(Node<'_, '_>, ObjectId)> = root.children().rev().map(|c| (c, object)).collect();
        while let Some((node, parent)) = stack.pop() {
            if self.diagnostics.is_full() {
                return;
            }
            if node.is_element()
                && let Some(object) = self.element(node, parent, file, None)
            {
                stack.extend(node.children().rev().map(|c| (c, object)));
            }
        }
    }

    /// Parses one element. Gives the object it declares, if any; what stands below that is left to the caller.
    fn element(
        &mut self,
        node: Node<'_, '_>,
        parent: ObjectId,
        file: &File,
        included: Option<&str>,
    ) -> Option<ObjectId> {
        let tag = node.tag_name().name();
        let attributes = self.attributes(node, file);
        let is_plugin = tag == "spectrum" && attributes.get("type").is_some();
        let category = if is_plugin { Some(Category::Texture) } else { Category::from_tag(tag) };
        match category {
            Some(Category::Scene) => {
                self.error(tag_span(node, file), "a <scene> cannot stand inside another");
                return None;
            }
            Some(category) => {
                let known: &[&str] =
                    if included.is_some() { &["type", "id", "name", "version"] } else { &["type", "id", "name"] };
                self.check(node, file, &attributes, known, &["type"]);
                let object = self.add_object(category, node, &attributes, file);
                let name = included.filter(|n| !n.is_empty()).or(attributes.text("name")).unwrap_or_default();
                let span = self.graph.objects[object].span;
                self.set(
                    parent,
                    Prop { name: name.into(), value: Raw::Object(object), span, value_span: span, used: false },
                );
                return Some(object);
            }
            None if attributes.broken => {}
            None => match tag {
                "include" => self.include(node, parent, file, &attributes),
                "default" => self.default(node, file, &attributes),
                "path" => self.path(node, parent, file, &attributes),
                "alias" => self.alias(node, file, &attributes),
                _ => self.property(node, parent, file, &attributes),
            },
        }
        if tag != "transform"
            && let Some(child) = node.children().find(Node::is_element)
        {
            let message = format!("<{}> cannot stand inside <{tag}>", child.tag_name().name());
            self.error(tag_span(child, file), message);
        }
        None
    }

    /// Adds an object to the graph and its id to the index.
    fn add_object(
        &mut self,
        category: Category,
        node: Node<'_, '_>,
        attributes: &Attributes<'_>,
        file: &File,
    ) -> ObjectId {
        let object = self.graph.objects.len();
        let id = attributes.get("id");
        self.graph.objects.push(Object {
            category,
            plugin: attributes.text("type").unwrap_or_default().to_owned(),
            id: id.map(|a| a.value.to_string()),
            span: attributes.get("type").map_or_else(|| tag_span(node, file), |a| a.value_span),
            legacy: file.legacy,
            props: Vec::new(),
            visited: false,
            asked: Vec::new(),
        });
        if let Some(id) = id {
            self.register(&id.value, object, id.value_span);
        }
        object
    }

    /// Gives an object an id.
    pub fn register(&mut self, id: &str, object: ObjectId, span: Span) {
        let Some(&earlier) = self.graph.ids.get(id) else {
            self.graph.ids.insert(id.to_owned(), object);
            return;
        };
        let place = self.sources.locate(self.graph.objects[earlier].span);
        let help = place.map(|l| format!("the first is at {}:{}:{}", l.path, l.line, l.column));
        self.diagnostics.error_help(&self.sources, Some(span), format!("the id '{id}' is given twice"), help);
    }

    /// Sets a property of an object. Values may be set once; a nested object replaces an earlier one of the same name.
    pub fn set(&mut self, parent: ObjectId, prop: Prop) {
        let is_object = matches!(prop.value, Raw::Object(_) | Raw::Ref(_));
        // Names of what stands directly in the scene mean nothing.
        let named = !prop.name.is_empty() && self.graph.objects[parent].category != Category::Scene;
        if named && self.is_set(parent, &prop.name) {
            if !is_object {
                return self.error(prop.span, format!("'{}' is set twice", prop.name));
            }
            self.graph.objects[parent].props.retain(|p| p.name != prop.name);
            let message = format!("'{}' replaces an earlier property of this name", prop.name);
            let place = Some(prop.span).filter(|_| self.diagnostics.suppressed() == 0);
            self.diagnostics.warn(&self.sources, place, message);
        }
        self.graph.objects[parent].props.push(prop);
    }

    /// True if a property of that name is set already; marks it as set.
    fn is_set(&mut self, object: ObjectId, name: &str) -> bool {
        let props = &self.graph.objects[object].props;
        if props.len() <= FEW_PROPERTIES {
            return self.graph.has(object, name);
        }
        let index = || props.iter().map(|p| p.name.clone()).collect();
        !self.names.entry(object).or_insert_with(index).insert(name.to_owned())
    }

    /// Reports an id that nothing has.
    pub fn undefined(&mut self, id: &str, span: Span) {
        // Comparing with every id of a huge scene takes too long.
        let ids = Some(&self.graph.ids).filter(|ids| ids.len() <= COMPARED_IDS);
        let help = ids.and_then(|ids| names::did_you_mean(id, ids.keys().map(String::as_str)));
        self.diagnostics.error_help(&self.sources, Some(span), format!("nothing has the id '{id}'"), help);
    }

    /// Replaces references by the objects they name. Those that name nothing are reported and removed.
    fn resolve(&mut self) {
        let mut undefined = Vec::new();
        let Graph { objects, ids } = &mut self.graph;
        for prop in objects.iter_mut().flat_map(|o| &mut o.props) {
            if let Raw::Ref(id) = &prop.value {
                match ids.get(id) {
                    Some(&target) => prop.value = Raw::Object(target),
                    None => undefined.push((id.clone(), prop.value_span)),
                }
            }
        }
        for (id, span) in undefined {
            if self.diagnostics.is_full() {
                break;
            }
            self.undefined(&id, span);
        }
        for object in &mut self.graph.objects {
            object.props.retain(|p| !matches!(p.value, Raw::Ref(_)));
        }
    }

    /// Reports attributes that an element does not have and those it lacks; whether it lacks none.
    pub fn check(
        &mut self,
        node: Node<'_, '_>,
        file: &File,
        attributes: &Attributes<'_>,
        known: &[&str],
        needed: &[&str],
    ) -> bool {
        let tag = node.tag_name().name();
        for a in attributes.list.iter().filter(|a| !known.contains(&a.name)) {
            let help = names::did_you_mean(a.name, known.iter().copied());
            let message = format!("<{tag}> has no attribute '{}'", a.name);
            self.diagnostics.error_help(&self.sources, Some(a.name_span), message, help);
        }
        let lacking = needed.iter().find(|n| attributes.get(n).is_none()).filter(|_| !attributes.broken);
        if let Some(lacking) = lacking {
            self.error(tag_span(node, file), format!("<{tag}> needs the attribute '{lacking}'"));
        }
        lacking.is_none() && !attributes.broken
    }

    /// The attributes of an element with parameters put in.
    pub fn attributes<'n>(&mut self, node: Node<'n, '_>, file: &File) -> Attributes<'n> {
        let mut attributes = Attributes { list: Vec::new(), broken: false };
        for a in node.attributes() {
            let span = |range: std::ops::Range<usize>| Span::new(file.id, range.start, range.end);
            let (name_span, value_span) = (span(a.range_qname()), span(a.range_value()));
            let value = if a.value().contains('$') {
                match self.parameters.substitute(a.value()) {
                    Ok(value) => value.into(),
                    Err(fault) => {
                        self.report(fault, value_span);
                        attributes.broken = true;
                        continue;
                    }
                }
            } else {
                a.value().into()
            };
            attributes.list.push(Attr { name: a.name(), value, name_span, value_span });
        }
        attributes
    }

    fn report(&mut self, fault: Fault, span: Span) {
        match fault {
            Fault::TooLong => self.error(span, "the parameters make the attributes of this scene too long"),
            Fault::Undefined(name) => {
                let near = names::did_you_mean(&name, self.parameters.names());
                let define = || Some(format!("define it on the command line, or by <default name=\"{name}\" …/>"));
                let message = format!("the parameter '${name}' has no value");
                self.diagnostics.error_help(&self.sources, Some(span), message, near.or_else(define));
            }
        }
    }
}

/// Source span of an element's name.
pub(super) fn tag_span(node: Node<'_, '_>, file: &File) -> Span {
    let start = node.range().start + 1;
    Span::new(file.id, start, start + node.tag_name().name().len())
}

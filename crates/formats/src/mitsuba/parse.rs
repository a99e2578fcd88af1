//! XML to [`Graph`]: elements, parameters, includes, references.

use super::{
    graph::{Category, Graph, Object, ObjectId, Prop, Raw},
    transform, upgrade, values, xml,
};
use crate::{
    Options,
    files::{self, SearchPath},
};
use roxmltree::Node;
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_scene::{Diagnostics, FileId, Sources, Span, names};

/// Most bytes that parameters may put into attributes: a chain of defaults that double each other would have no bound.
const SUBSTITUTED_BYTES: usize = 64 << 20;
/// Largest XML file, in bytes.
const XML_BYTES: u64 = 1 << 30;

/// Elements that set a property or steer the parser, for "did you mean".
const TAGS: [&str; 29] = [
    "alias",
    "boolean",
    "bsdf",
    "default",
    "emitter",
    "film",
    "float",
    "include",
    "integer",
    "integrator",
    "medium",
    "path",
    "phase",
    "point",
    "ref",
    "rfilter",
    "rgb",
    "sampler",
    "scene",
    "sensor",
    "shape",
    "spectrum",
    "string",
    "texture",
    "transform",
    "vector",
    "volume",
    "blackbody",
    "srgb",
];

/// A `$name` of the file.
struct Parameter {
    name: String,
    value: String,
    used: bool,
}

/// An attribute after parameters were put in.
pub(super) struct Attr<'a> {
    pub name: &'a str,
    pub value: Cow<'a, str>,
    pub name_span: Span,
    pub value_span: Span,
}

/// The file that is being parsed.
#[derive(Clone)]
pub(super) struct File {
    pub id: FileId,
    folder: PathBuf,
    /// Before version 2: other spellings and a few other elements.
    pub legacy: bool,
    depth: usize,
}

/// Reads a scene file and all it includes.
pub(super) struct Parser<'a> {
    pub graph: Graph,
    pub sources: Sources,
    pub diagnostics: Diagnostics,
    /// Where files are searched: `<path>` elements, latest first, then the scene's folder, then [`Options::search`].
    pub search: SearchPath,
    options: &'a Options,
    parameters: Vec<Parameter>,
    files: usize,
    substituted: usize,
}

impl<'a> Parser<'a> {
    /// A parser for a scene in this folder.
    pub fn new(folder: PathBuf, options: &'a Options) -> Self {
        let mut folders = vec![folder];
        folders.extend(options.search.iter().cloned());
        let parameters = options.defines.iter().map(|(name, value)| Parameter {
            name: name.clone(),
            value: value.clone(),
            used: false,
        });
        let mut parser = Self {
            graph: Graph::default(),
            sources: Sources::default(),
            diagnostics: Diagnostics::default(),
            search: SearchPath { folders },
            options,
            parameters: parameters.collect(),
            files: 0,
            substituted: 0,
        };
        parser.sort_parameters();
        parser
    }

    /// Longer names first, so that `$resx` is not taken for `$res` with an x.
    fn sort_parameters(&mut self) {
        self.parameters.sort_by(|a, b| b.name.len().cmp(&a.name.len()).then_with(|| a.name.cmp(&b.name)));
    }

    /// Reads the main file.
    pub fn main_file(&mut self, path: &Path) {
        let limits =
            crate::Limits { file_bytes: self.options.limits.file_bytes.min(XML_BYTES), ..self.options.limits.clone() };
        match files::read(path, &limits) {
            Ok(bytes) => self.text(path, bytes, None),
            Err(e) => self.diagnostics.error(&self.sources, None, e.to_string()),
        }
        self.finish();
    }

    /// Reads the main file's text.
    pub fn main_text(&mut self, path: &Path, text: Vec<u8>) {
        self.text(path, text, None);
        self.finish();
    }

    fn finish(&mut self) {
        for p in self.parameters.iter().filter(|p| !p.used) {
            let message = format!("the scene has no parameter '{}'", p.name);
            self.diagnostics.unused(&self.sources, None, message, None);
        }
        upgrade::upgrade(&mut self.graph);
        self.resolve();
    }

    fn error(&mut self, span: Span, message: impl Into<String>) {
        self.diagnostics.error(&self.sources, Some(span), message);
    }

    /// Parses one file. `host` is what an include adds to: the object, the name it gives, and the nesting of includes.
    fn text(&mut self, path: &Path, bytes: Vec<u8>, host: Option<(ObjectId, &str, usize)>) {
        let bytes: Arc<[u8]> = bytes.into();
        let id = self.sources.add(path, bytes.clone());
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let checked = xml::decode(&bytes).and_then(|text| {
            xml::precheck(text, self.options.limits.nesting)?;
            xml::parse(text)
        });
        let document = match checked {
            Ok(document) => document,
            Err(fault) => return self.error(Span::new(id, fault.at.start, fault.at.end), fault.message),
        };
        let root = document.root_element();
        let mut file = File { id, folder, legacy: false, depth: host.map_or(0, |h| h.2) };
        let attributes = self.attributes(root, &file);
        match attributes.iter().find(|a| a.name == "version") {
            Some(version) => match version.value.split('.').next().map(str::parse::<u32>) {
                Some(Ok(major)) => file.legacy = major < 2,
                _ => self.error(version.value_span, format!("'{}' is not a version number", version.value)),
            },
            None => {
                let message = format!("the element <{}> needs the attribute 'version'", root.tag_name().name());
                self.diagnostics.error_help(
                    &self.sources,
                    Some(tag_span(root, &file)),
                    message,
                    Some("for example version=\"3.0.0\"".into()),
                );
            }
        }
        match host {
            None => {
                let category = Category::from_tag(root.tag_name().name());
                if category != Some(Category::Scene) {
                    let message = format!("the outermost element is <{}> instead of <scene>", root.tag_name().name());
                    self.error(tag_span(root, &file), message);
                }
                let scene = self.add_object(Category::Scene, root, &attributes, &file);
                self.subtree(root.children(), scene, &file);
            }
            // The contents of an included scene go where the include stands.
            Some((parent, ..)) if root.has_tag_name("scene") => self.subtree(root.children(), parent, &file),
            Some((parent, name, _)) => {
                let children = self.element(root, parent, &file, Some(name));
                if let Some(object) = children {
                    self.subtree(root.children(), object, &file);
                }
            }
        }
    }

    /// Parses elements and all below them in document order, with a stack of its own in place of recursion.
    fn subtree(&mut self, children: roxmltree::Children<'_, '_>, parent: ObjectId, file: &File) {
        let mut stack: Vec<(Node<'_, '_>, ObjectId)> = children.rev().map(|c| (c, parent)).collect();
        while let Some((node, parent)) = stack.pop() {
            if self.diagnostics.is_full() {
                return;
            }
            if let Some(object) = node.is_element().then(|| self.element(node, parent, file, None)).flatten() {
                stack.extend(node.children().rev().map(|c| (c, object)));
            }
        }
    }

    /// Parses one element; an object's children are left to the caller.
    fn element(
        &mut self,
        node: Node<'_, '_>,
        parent: ObjectId,
        file: &File,
        given_name: Option<&str>,
    ) -> Option<ObjectId> {
        let tag = node.tag_name().name();
        let attributes = self.attributes(node, file);
        let find = |name: &str| attributes.iter().find(|a| a.name == name);
        let typed = find("type").is_some();
        let category = if tag == "spectrum" && typed { Some(Category::Texture) } else { Category::from_tag(tag) };
        if let Some(category) = category {
            let mut known = vec!["type", "id", "name"];
            known.extend(matches!(given_name, Some(_)).then_some("version"));
            self.check(node, file, &attributes, &known, if category == Category::Scene { &[] } else { &["type"] });
            if category == Category::Scene {
                self.error(tag_span(node, file), "a <scene> cannot stand inside another");
                return None;
            }
            let object = self.add_object(category, node, &attributes, file);
            let name = given_name.filter(|n| !n.is_empty()).map(str::to_owned);
            let name = name.or_else(|| find("name").map(|a| a.value.to_string())).unwrap_or_default();
            let span = self.graph.objects[object].span;
            self.set(parent, Prop { name, value: Raw::Object(object), span, value_span: span, used: false });
            return Some(object);
        }
        match tag {
            "include" => self.include(node, parent, file, &attributes),
            "default" => self.default(node, file, &attributes),
            "path" => self.path(node, parent, file, &attributes),
            "alias" => self.alias(node, file, &attributes),
            _ => self.property(node, parent, file, &attributes),
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
    fn add_object(&mut self, category: Category, node: Node<'_, '_>, attributes: &[Attr<'_>], file: &File) -> ObjectId {
        let find = |name: &str| attributes.iter().find(|a| a.name == name);
        let index = self.graph.objects.len();
        let id = find("id").map(|a| a.value.to_string());
        self.graph.objects.push(Object {
            category,
            plugin: find("type").map(|a| a.value.to_string()).unwrap_or_default(),
            id: id.clone(),
            span: find("type").map_or_else(|| tag_span(node, file), |a| a.value_span),
            legacy: file.legacy,
            props: Vec::new(),
            visited: false,
            asked: Vec::new(),
        });
        if let (Some(id), Some(attribute)) = (id, find("id")) {
            self.register(id, index, attribute.value_span);
        }
        index
    }

    fn register(&mut self, id: String, object: ObjectId, span: Span) {
        if let Some(&earlier) = self.graph.ids.get(&id) {
            let place = self.sources.locate(self.graph.objects[earlier].span);
            let help = place.map(|l| format!("the first is at {}:{}:{}", l.path, l.line, l.column));
            self.diagnostics.error_help(&self.sources, Some(span), format!("the id '{id}' is given twice"), help);
        } else {
            self.graph.ids.insert(id, object);
        }
    }

    /// Sets a property of an object. Values may be set once; a nested object replaces an earlier one of the same name.
    fn set(&mut self, parent: ObjectId, prop: Prop) {
        let twice = !prop.name.is_empty() && self.graph.has(parent, &prop.name);
        if twice && !matches!(prop.value, Raw::Object(_) | Raw::Ref(_)) {
            return self.error(prop.span, format!("'{}' is set twice", prop.name));
        }
        let object = &mut self.graph.objects[parent];
        if twice && object.category != Category::Scene {
            object.props.retain(|p| p.name != prop.name);
            let message = format!("'{}' replaces an earlier object of this name", prop.name);
            self.diagnostics.warn(&self.sources, Some(prop.span), message);
        }
        self.graph.objects[parent].props.push(prop);
    }

    fn property(&mut self, node: Node<'_, '_>, parent: ObjectId, file: &File, attributes: &[Attr<'_>]) {
        let tag = node.tag_name().name();
        let Some(value) = self.value(tag, node, file, attributes) else { return };
        let find = |name: &str| attributes.iter().find(|a| a.name == name);
        let is_reference = matches!(value, Raw::Ref(_));
        let named = find("name").or_else(|| find("id"));
        let span = named.map_or_else(|| tag_span(node, file), |a| a.value_span);
        let stated = find("value").or_else(|| find("filename")).or_else(|| find("id"));
        let value_span = stated.map_or(span, |a| a.value_span);
        let name = find("name").map(|a| a.value.to_string()).unwrap_or_default();
        if name.is_empty() && !is_reference {
            return self.error(span, format!("<{tag}> needs a name"));
        }
        self.set(parent, Prop { name, value, span, value_span, used: false });
    }

    /// The value of a property element, or `None` after an error.
    fn value(&mut self, tag: &str, node: Node<'_, '_>, file: &File, attributes: &[Attr<'_>]) -> Option<Raw> {
        let find = |name: &str| attributes.iter().find(|a| a.name == name);
        let legacy = file.legacy;
        let simple = |text: &str| -> Result<Raw, String> {
            Ok(match tag {
                "float" => Raw::Float(values::number(text)?),
                "integer" => Raw::Int(values::integer(text)?),
                "boolean" => Raw::Bool(values::boolean(text)?),
                "rgb" => Raw::Rgb(values::rgb(text)?),
                "srgb" => Raw::Rgb(values::rgb(text)?.map(values::srgb_to_linear)),
                _ => Raw::String(text.to_owned()),
            })
        };
        let result = match tag {
            "float" | "integer" | "boolean" | "string" => {
                self.check(node, file, attributes, &["name", "value"], &["name", "value"])?;
                simple(&find("value")?.value)
            }
            "rgb" | "srgb" => {
                self.check(node, file, attributes, &["name", "value", "intent"], &["name", "value"])?;
                simple(&find("value")?.value)
            }
            "point" | "vector" => {
                let parts = if find("value").is_some() { &["name", "value"][..] } else { &["name", "x", "y", "z"][..] };
                self.check(node, file, attributes, parts, if legacy { &["name"] } else { parts })?;
                transform::vector(attributes, 0.0).map(Raw::Vec3)
            }
            "spectrum" => {
                self.check(node, file, attributes, &["name", "value", "filename", "intent"], &["name"])?;
                match (find("value"), find("filename")) {
                    (Some(value), None) => values::spectrum(&value.value, legacy).map(Raw::Spectrum),
                    (None, Some(name)) => self.spectrum_file(&name.value).map(Raw::Spectrum),
                    _ => Err("<spectrum> needs either 'value' or 'filename'".into()),
                }
            }
            "blackbody" if legacy => {
                self.check(node, file, attributes, &["name", "temperature", "scale"], &["name", "temperature"])?;
                let temperature = find("temperature")?.value.trim().trim_end_matches(['K', 'k']);
                let scale = find("scale").map_or(Ok(1.0), |a| values::number(&a.value));
                values::number(temperature)
                    .and_then(|t| values::blackbody(t, [360.0, 830.0], scale?))
                    .map(Raw::Spectrum)
            }
            "transform" => {
                self.check(node, file, attributes, &["name"], &["name"])?;
                return Some(Raw::Transform(self.transform(node, file)));
            }
            "ref" => {
                self.check(node, file, attributes, &["name", "id"], &["id"])?;
                Ok(Raw::Ref(find("id")?.value.to_string()))
            }
            _ => {
                let help =
                    names::did_you_mean(tag, TAGS.into_iter().filter(|t| legacy || !["blackbody", "srgb"].contains(t)));
                let operation = transform::OPERATIONS.contains(&tag);
                let message = if operation {
                    format!("<{tag}> belongs inside a <transform>")
                } else {
                    format!("unknown element <{tag}>")
                };
                self.diagnostics.error_help(
                    &self.sources,
                    Some(tag_span(node, file)),
                    message,
                    help.filter(|_| !operation),
                );
                return None;
            }
        };
        match result {
            Ok(value) => Some(value),
            Err(message) => {
                let at = ["value", "filename", "x", "y", "z", "temperature"].iter().find_map(|n| find(n));
                let span = at.map_or_else(|| tag_span(node, file), |a| a.value_span);
                let name = find("name").map(|a| a.value.to_string()).unwrap_or_default();
                self.error(span, format!("'{name}': {message}"));
                None
            }
        }
    }

    /// Composes the operations inside a `<transform>`: each is applied after those before it.
    fn transform(&mut self, node: Node<'_, '_>, file: &File) -> steradian_math::Transform {
        let mut composed = steradian_math::Transform::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            let attributes = self.attributes(child, file);
            match transform::operation(child.tag_name().name(), &attributes, file.legacy) {
                Ok(t) => composed = t * composed,
                Err((span, message)) => self.error(span.unwrap_or_else(|| tag_span(child, file)), message),
            }
        }
        if !composed.is_finite() {
            self.error(tag_span(node, file), "the transform overflows");
            return steradian_math::Transform::IDENTITY;
        }
        composed
    }

    fn spectrum_file(&mut self, name: &str) -> Result<steradian_scene::SpectrumValue, String> {
        let path = self.search.find(name).map_err(|e| e.to_string())?;
        let bytes = files::read(&path, &self.options.limits).map_err(|e| e.to_string())?;
        let text = String::from_utf8_lossy(&bytes);
        values::spectrum_file(&text).map_err(|e| format!("'{}', {e}", path.display()))
    }

    fn include(&mut self, node: Node<'_, '_>, parent: ObjectId, file: &File, attributes: &[Attr<'_>]) {
        if self.check(node, file, attributes, &["filename", "name"], &["filename"]).is_none() {
            return;
        }
        let Some(name) = attributes.iter().find(|a| a.name == "filename") else { return };
        let property = attributes.iter().find(|a| a.name == "name").map_or("", |a| &a.value);
        let limits = &self.options.limits;
        if file.depth + 1 >= limits.include_depth {
            let message = format!("files include each other more than {} deep", limits.include_depth);
            return self.error(name.value_span, message);
        }
        self.files += 1;
        if self.files > limits.includes {
            return self.error(name.value_span, format!("more than {} files are included", limits.includes));
        }
        // The including file's own folder comes first.
        let mut search = self.search.clone();
        search.folders.insert(0, file.folder.clone());
        let limits = crate::Limits { file_bytes: limits.file_bytes.min(XML_BYTES), ..limits.clone() };
        let read = search.find(&name.value).and_then(|path| files::read(&path, &limits).map(|bytes| (path, bytes)));
        match read {
            Ok((path, bytes)) => self.text(&path, bytes, Some((parent, property, file.depth + 1))),
            Err(e) => self.error(name.value_span, e.to_string()),
        }
    }

    fn default(&mut self, node: Node<'_, '_>, file: &File, attributes: &[Attr<'_>]) {
        if self.check(node, file, attributes, &["name", "value"], &["name", "value"]).is_none() {
            return;
        }
        let find = |name: &str| attributes.iter().find(|a| a.name == name);
        let (Some(name), Some(value)) = (find("name"), find("value")) else { return };
        if name.value.is_empty() {
            return self.error(name.value_span, "a parameter needs a name");
        }
        if !self.parameters.iter().any(|p| p.name == *name.value) {
            self.substituted += value.value.len();
            self.parameters.push(Parameter {
                name: name.value.to_string(),
                value: value.value.to_string(),
                used: true,
            });
            self.sort_parameters();
        }
    }

    fn path(&mut self, node: Node<'_, '_>, parent: ObjectId, file: &File, attributes: &[Attr<'_>]) {
        if self.check(node, file, attributes, &["value"], &["value"]).is_none() {
            return;
        }
        let Some(value) = attributes.iter().find(|a| a.name == "value") else { return };
        if parent != 0 {
            return self.error(tag_span(node, file), "<path> belongs directly inside <scene>");
        }
        let places = std::iter::once(&file.folder).chain(&self.search.folders).map(|f| f.join(value.value.as_ref()));
        match places.into_iter().find(|p| p.is_dir()) {
            Some(folder) => self.search.folders.insert(0, folder),
            None => self.error(value.value_span, format!("there is no folder '{}'", value.value)),
        }
    }

    fn alias(&mut self, node: Node<'_, '_>, file: &File, attributes: &[Attr<'_>]) {
        if self.check(node, file, attributes, &["id", "as"], &["id", "as"]).is_none() {
            return;
        }
        let find = |name: &str| attributes.iter().find(|a| a.name == name);
        let (Some(source), Some(target)) = (find("id"), find("as")) else { return };
        match self.graph.ids.get(source.value.as_ref()) {
            Some(&object) => self.register(target.value.to_string(), object, target.value_span),
            None => self.undefined(&source.value.to_string(), source.value_span),
        }
    }

    fn undefined(&mut self, id: &str, span: Span) {
        let help = names::did_you_mean(id, self.graph.ids.keys().map(String::as_str));
        self.diagnostics.error_help(&self.sources, Some(span), format!("nothing has the id '{id}'"), help);
    }

    /// Replaces references by the objects they name. Those that name nothing are reported and removed.
    fn resolve(&mut self) {
        for object in 0..self.graph.objects.len() {
            for i in 0..self.graph.objects[object].props.len() {
                let prop = &mut self.graph.objects[object].props[i];
                let Raw::Ref(id) = &prop.value else { continue };
                match self.graph.ids.get(id) {
                    Some(&target) => prop.value = Raw::Object(target),
                    None => {
                        let (id, span) = (id.clone(), prop.value_span);
                        self.undefined(&id, span);
                    }
                }
            }
            self.graph.objects[object].props.retain(|p| !matches!(p.value, Raw::Ref(_)));
        }
    }

    /// Reports attributes an element does not have and those it lacks; `None` when one is lacking.
    fn check(
        &mut self,
        node: Node<'_, '_>,
        file: &File,
        attributes: &[Attr<'_>],
        known: &[&str],
        needed: &[&str],
    ) -> Option<()> {
        let tag = node.tag_name().name();
        for a in attributes.iter().filter(|a| !known.contains(&a.name)) {
            let help = names::did_you_mean(a.name, known.iter().copied());
            let message = format!("<{tag}> has no attribute '{}'", a.name);
            self.diagnostics.error_help(&self.sources, Some(a.name_span), message, help);
        }
        let lacking = needed.iter().find(|n| !attributes.iter().any(|a| a.name == **n));
        if let Some(lacking) = lacking {
            self.error(tag_span(node, file), format!("<{tag}> needs the attribute '{lacking}'"));
        }
        lacking.is_none().then_some(())
    }

    /// The attributes of an element with parameters put in.
    fn attributes<'n>(&mut self, node: Node<'n, '_>, file: &File) -> Vec<Attr<'n>> {
        node.attributes()
            .map(|a| {
                let (name, value) = (a.range_qname(), a.range_value());
                let value_span = Span::new(file.id, value.start, value.end);
                let text = a.value();
                let value = if text.contains('$') { self.substitute(text, value_span).into() } else { text.into() };
                Attr { name: a.name(), value, name_span: Span::new(file.id, name.start, name.end), value_span }
            })
            .collect()
    }

    /// Puts the values of parameters where `$name` stands; `\$` is a dollar sign.
    fn substitute(&mut self, text: &str, span: Span) -> String {
        let mut out = String::new();
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let (before, after) = (&rest[..dollar], &rest[dollar + 1..]);
            if let Some(escaped) = before.strip_suffix('\\') {
                out.push_str(escaped);
                out.push('$');
                rest = after;
                continue;
            }
            out.push_str(before);
            if let Some(p) = self.parameters.iter_mut().find(|p| !p.name.is_empty() && after.starts_with(&p.name)) {
                p.used = true;
                rest = &after[p.name.len()..];
                self.substituted += p.value.len();
                if self.substituted > SUBSTITUTED_BYTES {
                    self.error(span, format!("parameters expand to more than {SUBSTITUTED_BYTES} bytes"));
                    return out;
                }
                out.push_str(&p.value);
            } else {
                let name: String = after.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
                let help = names::did_you_mean(&name, self.parameters.iter().map(|p| p.name.as_str()));
                let help =
                    help.or_else(|| Some(format!("give it a value with -D {name}=… or <default name=\"{name}\" …/>")));
                let message = format!("the parameter '${name}' has no value");
                self.diagnostics.error_help(&self.sources, Some(span), message, help);
                rest = &after[name.len()..];
            }
        }
        out.push_str(rest);
        out
    }
}

/// Where an element's name stands.
pub(super) fn tag_span(node: Node<'_, '_>, file: &File) -> Span {
    let start = node.range().start + 1;
    Span::new(file.id, start, start + node.tag_name().name().len())
}

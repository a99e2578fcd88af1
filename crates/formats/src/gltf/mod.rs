//! glTF 2.0 (Khronos Group, "glTF 2.0 Specification", ISO/IEC 12113:2022) in text (.gltf) and binary form (.glb).
//!
//! Conventions: glTF is right-handed with +y up, cameras and lights look along their −z; pixel rows of pictures go
//! down, as does v. Radiometry: candela, lux and emitted radiance are taken as they stand for W/sr, W/m² and W/(m² sr).
//!
//! What is drawn by a stated rule: points are spheres and lines are cylinders of a radius of 1/500 of the scene's
//! diagonal; back faces are drawn whether a material is double-sided or not; occlusion textures are ignored, and a note
//! says so, since light is traced; `BLEND` lets rays pass by chance.

mod accessor;
mod animation;
mod container;
mod draco;
mod extensions;
mod json;
mod lights;
mod locate;
mod material;
mod mesh;
mod meshopt;
mod nodes;
#[cfg(test)]
mod packed;
#[cfg(test)]
mod tests;
mod texture;
mod told;
mod validate;

use crate::{
    Import, Options,
    files::{self, SearchPath},
    mesh::model::stage,
};
use json::At;
pub(crate) use material::multiple_scattering_albedo;
use serde_json::Value;
use std::{collections::HashMap, path::Path, sync::Arc};
use steradian_math::{DMat4, DVec3};
use steradian_scene::{FileId, Format, Span};

/// Opens a .gltf or .glb file. What the file is decides, not what it is called.
///
/// `-D scene=N` chooses another scene than the default one, `-D variant=NAME` a variant of the materials,
/// `-D at=SECONDS` the moment of the animations (0), `-D shutter=SECONDS` how long after it the shutter closes, and
/// `-D animation=NAME` one of them (all).
pub fn import(path: &Path, options: &Options) -> Import {
    match files::read(path, &options.limits) {
        Ok(bytes) => import_bytes(path, bytes, options),
        Err(e) => {
            let mut import = Import::default();
            import.diagnostics.error(&import.desc.sources, None, e.to_string());
            import
        }
    }
}

/// The box of what is drawn, where the document has no camera of its own, and whatever there is to see.
pub fn framed_box(path: &Path, options: &Options) -> Option<[DVec3; 2]> {
    let bytes = files::read(path, &options.limits).ok()?;
    let (import, bounds) = read_document(path, bytes, options);
    let [low, high] = bounds?;
    (!import.diagnostics.has_errors() && low.is_finite() && high.is_finite()).then_some([low, high])
}

/// Reads a document in memory; the files that it names are beside `path`.
pub fn import_bytes(path: &Path, bytes: Vec<u8>, options: &Options) -> Import {
    read_document(path, bytes, options).0
}

/// A document, and the box of what is drawn where it has no camera.
fn read_document(path: &Path, bytes: Vec<u8>, options: &Options) -> (Import, Option<[DVec3; 2]>) {
    let mut import = Import::default();
    import.desc.format = Format::Gltf;
    import.desc.path = Some(path.into());
    let bytes: Arc<[u8]> = bytes.into();
    let parts = match container::split(&bytes) {
        Ok(parts) => parts,
        Err(why) => {
            import.diagnostics.error(&import.desc.sources, None, format!("cannot read '{}': {why}", path.display()));
            return (import, None);
        }
    };
    for fault in parts.faults {
        import.diagnostics.warn(&import.desc.sources, None, format!("'{}': {fault}", path.display()));
    }
    let text: Arc<[u8]> = bytes[parts.json.clone()].into();
    let source = import.desc.sources.add(path, text.clone());
    let search = SearchPath::new(path.parent(), options);
    let mut root: Value = match serde_json::from_slice(strip_mark(&text)) {
        Ok(root) => root,
        Err(e) => {
            let at = locate::line(&text, e.line(), e.column());
            let why = match path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) && parts.bin.is_none() {
                true if !bytes.starts_with(b"glTF") => {
                    "a .glb file begins with 'glTF', and this is not JSON either".into()
                }
                _ => format!("this is not JSON: {}", strip_place(&e.to_string())),
            };
            import.diagnostics.error(&import.desc.sources, Some(Span::new(source, at, at + 1)), why);
            return (import, None);
        }
    };
    let mut reader = Reader {
        import,
        path,
        options,
        search,
        text,
        source,
        buffers: Vec::new(),
        unpacked: HashMap::new(),
        decoded: HashMap::new(),
        decoded_bytes: 0,
        bin: parts.bin.map(|range| container::Bytes::new(bytes.clone(), range)),
        materials: HashMap::new(),
        meshes: HashMap::new(),
        uses_lights: false,
        is_framed: false,
        bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
        ends: HashMap::new(),
        moved: None,
        strokes: Vec::new(),
    };
    reader.read(&mut root);
    (reader.import, reader.is_framed.then_some(reader.bounds))
}

/// Without the byte order mark that some writers put first.
fn strip_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

/// A message of the JSON parser without its own line and column.
fn strip_place(message: &str) -> &str {
    message.find(" at line ").map_or(message, |k| &message[..k])
}

/// A file on its way into a description.
struct Reader<'a> {
    import: Import,
    path: &'a Path,
    options: &'a Options,
    search: SearchPath,
    text: Arc<[u8]>,
    source: FileId,
    buffers: Vec<Option<container::Bytes>>,
    /// Packed buffer views by number, as they were unpacked; `None` where they cannot be.
    unpacked: HashMap<usize, Option<container::Bytes>>,
    /// The binary chunk of a .glb.
    bin: Option<container::Bytes>,
    /// By accessor, the data of the primitive that is being read, where it is packed.
    decoded: HashMap<usize, accessor::Decoded>,
    /// Bytes of attributes that were unpacked for all primitives so far.
    decoded_bytes: u64,
    /// By index, and by what the primitive has to offer.
    materials: HashMap<material::Key, material::Look>,
    /// Mesh data by mesh and primitive, where it is the same for all nodes.
    meshes: HashMap<(usize, usize), Option<mesh::Data>>,
    uses_lights: bool,
    /// True if the document has no camera of its own: the default camera then frames `bounds`.
    is_framed: bool,
    /// World-space bounding box of all drawn vertices.
    bounds: [DVec3; 2],
    /// World transforms of nodes at shutter close, where `-D shutter` gives an exposure time.
    ends: HashMap<usize, DMat4>,
    /// Motion of the current node: the transform from its placement at shutter open to that at shutter close.
    moved: Option<DMat4>,
    /// Points and lines, until their radius is known.
    strokes: Vec<mesh::Strokes>,
}

impl Reader<'_> {
    fn read(&mut self, root: &mut Value) {
        self.check_version(&At::root(root));
        if self.import.diagnostics.has_errors() {
            return;
        }
        extensions::check(self, &At::root(root));
        let is_readable = !self.import.diagnostics.has_errors();
        if is_readable {
            self.load_buffers(&At::root(root));
        }
        let issues = self.issues(root);
        if is_readable {
            self.build(root);
        }
        self.report(issues);
    }

    fn build(&mut self, root: &mut Value) {
        if let Some(shutter) = animation::shutter(self, &At::root(root)) {
            let mut end = root.clone();
            animation::pose(self, &mut end, shutter);
            self.ends = self.places(&At::root(&end));
        }
        self.import.desc.animations = animation::list(self, &At::root(root));
        animation::pose(self, root, 0.0);
        let root = At::root(root);
        self.scene(&root);
        if self.import.diagnostics.has_errors() {
            return;
        }
        self.members_without_effect(&root);
        self.place_strokes();
        let Import { desc, diagnostics } = &mut self.import;
        if desc.shapes.is_empty() && desc.instances.is_empty() {
            diagnostics.warn(&desc.sources, None, format!("the scene of '{}' has no surfaces", self.path.display()));
            self.bounds = [DVec3::NEG_ONE, DVec3::ONE];
        }
        self.is_framed = desc.cameras.is_empty();
        // What Steradian wrote has all the light there was.
        let is_whole = root.get("asset").and_then(|a| a.get("generator")).is_some_and(|g| g.value == "Steradian");
        stage::complete(&mut self.import, self.options, self.bounds, self.uses_lights, !is_whole);
    }

    fn check_version(&mut self, root: &At<'_>) {
        let asset = root.get("asset");
        let version = asset.as_ref().and_then(|a| a.get("version")).and_then(|v| v.value.as_str().map(str::to_owned));
        match version {
            None => self.error(root, "this is not glTF: 'asset' with a 'version' is missing"),
            Some(v) if v.split('.').next() != Some("2") => {
                let at = asset.and_then(|a| a.get("version")).unwrap_or_else(|| root.clone());
                self.error(&at, format!("glTF version {v} is not read; 2.0 is"));
            }
            Some(_) => {}
        }
    }

    /// Source span of a value in the file.
    fn span(&self, at: &At<'_>) -> Option<Span> {
        self.span_of(&at.pointer)
    }

    fn span_of(&self, pointer: &str) -> Option<Span> {
        // Messages past the limit are not shown: to find their place takes reading the file.
        if self.import.diagnostics.iter().count() > 500 {
            return None;
        }
        let (start, end) = locate::value(&self.text, pointer)?;
        Some(Span::new(self.source, start, end))
    }

    fn error(&mut self, at: &At<'_>, message: impl Into<String>) {
        self.error_help(at, message, None);
    }

    fn error_help(&mut self, at: &At<'_>, message: impl Into<String>, help: Option<String>) {
        let (span, message) = (self.span(at), named(&at.pointer, message.into()));
        self.import.diagnostics.error_help(&self.import.desc.sources, span, message, help);
    }

    fn approximated(&mut self, at: &At<'_>, message: impl Into<String>) {
        let (span, message) = (self.span(at), named(&at.pointer, message.into()));
        self.import.diagnostics.approximated(&self.import.desc.sources, span, message);
    }

    /// Warns of a broken rule of the specification.
    fn broken_rule(&mut self, pointer: &str, message: String) {
        let (span, message) = (self.span_of(pointer), named(pointer, message));
        self.import.diagnostics.warn(&self.import.desc.sources, span, message);
    }

    fn dropped(&mut self, at: &At<'_>, message: impl Into<String>) {
        let (span, message) = (self.span(at), named(&at.pointer, message.into()));
        self.import.diagnostics.dropped(&self.import.desc.sources, span, message);
    }
}

/// A message with the JSON pointer of what it is about.
fn named(pointer: &str, message: String) -> String {
    if pointer.is_empty() { message } else { format!("{pointer}: {message}") }
}

//! Layers: what one file says about prims and their properties.

use super::{binary, mtlx, text, value::Value};
use std::collections::HashMap;
use steradian_scene::{FileId, Span};

/// Deepest nesting of prims, variants and dictionaries that is read.
pub(super) const MOST_NESTED: usize = 128;

/// Purpose of a prim's description.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Specifier {
    /// Defines a prim.
    Def,
    /// Adds to a prim that something else defines.
    #[default]
    Over,
    /// Describes what others inherit.
    Class,
}

/// Opinions of one layer about a prim, a variant or a property.
#[derive(Debug, Default)]
pub(super) struct Spec {
    pub specifier: Specifier,
    /// Metadata, and of properties `default`, `samples`, `connect` and `targets`.
    pub fields: HashMap<String, Value>,
    /// Names of child prims in order.
    pub children: Vec<String>,
    /// Names of properties.
    pub properties: Vec<String>,
    /// First and last byte in the text.
    pub at: Option<(usize, usize)>,
}

impl Spec {
    pub fn text(&self, field: &str) -> Option<&str> {
        self.fields.get(field)?.text()
    }
}

/// Fault of a layer's text or bytes.
#[derive(Debug)]
pub(super) struct Fault {
    /// The byte in a text.
    pub at: Option<usize>,
    pub message: String,
}

/// A file's specs by path; variants are written as in `/Prim{set=variant}child`, and properties as in `/Prim.name`.
#[derive(Debug, Default)]
pub(super) struct Layer {
    pub specs: HashMap<String, Spec>,
    /// The source, where it is text.
    pub source: Option<FileId>,
    /// Types of fields in a binary file that are not read.
    pub unknown_types: Vec<u8>,
}

impl Layer {
    /// Reads a file; its first bytes tell the encoding. `memory` bounds what a binary file may unpack to.
    pub fn read(bytes: &[u8], memory: u64) -> Result<Self, Fault> {
        if bytes.starts_with(binary::MAGIC) {
            return binary::read(bytes, memory).map_err(|message| Fault { at: None, message });
        }
        if bytes.trim_ascii_start().starts_with(b"<") { mtlx::read(bytes) } else { text::read(bytes) }
    }

    /// The layer's own metadata.
    pub fn head(&self) -> Option<&Spec> {
        self.specs.get("/")
    }

    /// Source span of a spec.
    pub fn span(&self, spec: &Spec) -> Option<Span> {
        let (start, end) = spec.at?;
        Some(Span::new(self.source?, start, end))
    }
}

/// The path of a child.
pub(super) fn join(path: &str, name: &str) -> String {
    match path {
        "/" => format!("/{name}"),
        _ if path.ends_with('}') => format!("{path}{name}"),
        _ => format!("{path}/{name}"),
    }
}

/// The path of a property, also of the layer itself.
pub(super) fn property(path: &str, name: &str) -> String {
    format!("{path}.{name}")
}

/// Splits the path of a property from that of its prim.
pub(super) fn split_property(path: &str) -> Option<(&str, &str)> {
    // Names of variants may hold dots.
    let from = path.rfind('}').map_or(0, |k| k + 1);
    let dot = from + path.get(from..)?.find('.')?;
    Some((path.get(..dot)?, path.get(dot + 1..)?))
}

/// True if a path is another one, or below it.
pub(super) fn is_below(path: &str, root: &str) -> bool {
    match path.strip_prefix(root) {
        Some(rest) => root == "/" || rest.is_empty() || rest.starts_with(['/', '.', '{']) || root.ends_with('}'),
        None => false,
    }
}

/// An absolute path of one that may be relative to a prim.
pub(super) fn absolute(path: &str, prim: &str) -> String {
    if path.is_empty() || path.starts_with('/') {
        return path.into();
    }
    let mut base = plain(prim);
    let mut rest = path;
    while let Some(up) = rest.strip_prefix("..") {
        base.truncate(base.rfind('/').unwrap_or(0));
        rest = up.trim_start_matches('/');
    }
    if rest.starts_with('.') { format!("{base}{rest}") } else { join(if base.is_empty() { "/" } else { &base }, rest) }
}

/// A path without selections of variants.
pub(super) fn plain(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    let mut rest = path;
    while let Some((before, after)) = rest.split_once('{') {
        out.push_str(before);
        rest = after.split_once('}').map_or("", |r| r.1);
        if !rest.is_empty() && !rest.starts_with(['{', '/', '.']) {
            out.push('/');
        }
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_join_and_part() {
        assert_eq!(join("/", "a"), "/a");
        assert_eq!(join("/a{v=x}", "b"), "/a{v=x}b");
        assert_eq!(plain("/a{v=x}b/c{w=1.5}"), "/a/b/c");
        assert_eq!(split_property("/a{v=1.5}b.xformOp:translate"), Some(("/a{v=1.5}b", "xformOp:translate")));
        assert_eq!(absolute("../m.outputs:rgb", "/a/b"), "/a/m.outputs:rgb");
        assert_eq!(absolute("c", "/a/b"), "/a/b/c");
        assert_eq!(absolute("../../x", "/a/b"), "/x");
        assert!(is_below("/a/b", "/a") && is_below("/a", "/a") && !is_below("/ab", "/a"));
    }
}

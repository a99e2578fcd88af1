//! Steradian's own language for scenes (`.steradian`): a description as text, whole and exact.
//! `docs/scene-format.md` describes it.
//!
//! The form is JSON made comfortable: everything that programs can write is a scene, and so are dictionaries
//! of Python; by hand comments,
//! bare words and names of other nodes (`@gold`) may be used. A node is a map that begins with its family and
//! kind, so that nothing
//! depends on where it stands; all else follows the vocabulary of the schema.

mod parse;
mod ply;
mod read;
#[cfg(test)]
mod tests;
mod value;
mod write;

pub use write::{Written, write};

use crate::{
    Import, Options,
    files::{self, SearchPath},
};
use std::{
    collections::{HashMap, HashSet},
    path::Path,
};
use steradian_scene::{Diagnostics, Mesh, Node, NodeId, SceneDesc, Value, names};

/// The version of the language.
pub const VERSION: i64 = 1;

/// Largest document. Meshes and pictures are in files of their own.
const MOST_BYTES: usize = 1 << 30;

/// Opens a file, plain or compressed by gzip.
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

/// Meshes and files in memory that a document in memory may name.
#[derive(Debug, Default)]
pub struct Given {
    /// Meshes by the names that shapes have for them.
    pub meshes: Vec<(String, Mesh)>,
    /// Files by the names in `{file: NAME}`: meshes as PLY, pictures.
    pub files: HashMap<String, Vec<u8>>,
}

/// Reads a document in memory; the files that it names are beside `path`.
pub fn import_bytes(path: &Path, bytes: Vec<u8>, options: &Options) -> Import {
    import_with(path, bytes, Given::default(), options)
}

/// Reads a document in memory with meshes and files that are in memory; others are beside `path`.
pub fn import_with(path: &Path, bytes: Vec<u8>, given: Given, options: &Options) -> Import {
    let mut desc = SceneDesc { path: Some(path.into()), ..SceneDesc::default() };
    let file = desc.sources.add(path, bytes);
    let text = desc.sources.get(file).map(|s| s.text.clone()).unwrap_or_default();
    let search = SearchPath::new(path.parent(), options);
    let mut reader = read::Reader::new(desc, HashMap::new(), search, options).with(given);
    if text.len() > MOST_BYTES {
        let why = format!("'{}' holds more than the {MOST_BYTES} bytes allowed; meshes may be files", path.display());
        reader.diagnostics.error(&reader.desc.sources, None, why);
        return Import { desc: reader.desc, diagnostics: reader.diagnostics };
    }
    match parse::document(&text, file) {
        Ok(sections) => reader.document(&sections),
        Err(fault) => reader.fault((fault.message, fault.span)),
    }
    Import { desc: reader.desc, diagnostics: reader.diagnostics }
}

/// Sets a parameter of a node to a value in the language; what it refers to are nodes by their [`ids`], or
/// nodes in place, which are added.
/// `null` takes the parameter away.
///
/// # Errors
/// The messages, with places in `text`.
pub fn set(
    desc: &mut SceneDesc,
    node: NodeId,
    parameter: &str,
    text: &str,
    options: &Options,
) -> Result<(), Diagnostics> {
    if let Some(what) = unknown(desc.node(node), parameter, options) {
        let mut diagnostics = Diagnostics::default();
        diagnostics.error_help(&desc.sources, None, what.0, what.1);
        return Err(diagnostics);
    }
    let known = ids(desc).into_iter().enumerate().map(|(i, id)| (id, NodeId(i as u32))).collect();
    let folder = desc.path.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    let search = SearchPath::new(Some(folder), options);
    let mut trial = SceneDesc { nodes: desc.nodes.clone(), path: desc.path.clone(), ..SceneDesc::default() };
    let file = trial.sources.add(format!("{}.{parameter}", name_in(desc, node)), text.as_bytes().to_vec());
    let (family, kind) = (desc.node(node).family, desc.node(node).kind.clone());
    let mut reader = read::Reader::new(trial, known, search, options);
    let value = match parse::value(text.as_bytes(), file) {
        Ok(parse::Item { kind: parse::Kind::Null, .. }) => Ok(None),
        Ok(item) => reader.value_of(family, &kind, parameter, &item).map(Some),
        Err(fault) => Err((fault.message, fault.span)),
    };
    match value {
        Ok(value) => {
            // Places in the text of the value mean nothing in the description.
            for node in &mut reader.desc.nodes[desc.nodes.len()..] {
                node.span = None;
                node.params.iter_mut().for_each(|p| p.span = None);
            }
            desc.nodes = reader.desc.nodes;
            match value {
                Some(value) => drop(desc.node_mut(node).set(parameter, value, None)),
                None => desc.node_mut(node).params.retain(|p| p.name != parameter),
            }
            Ok(())
        }
        Err(slip) => {
            reader.fault(slip);
            Err(reader.diagnostics)
        }
    }
}

/// Message for a parameter that a node does not have, and the nearest name that its kind has.
fn unknown(node: &Node, parameter: &str, options: &Options) -> Option<(String, Option<String>)> {
    let known: Vec<&str> = options.kinds.parameters(node.family, &node.kind)?.map(|p| p.name).collect();
    if known.contains(&parameter) || node.get(parameter).is_some() {
        return None;
    }
    let what = format!("{} '{}' has no parameter '{parameter}'", node.family.noun(), node.kind);
    let nearest = names::did_you_mean(parameter, known.iter().copied());
    Some((what, nearest.or_else(|| Some(format!("it has {}", known.join(", "))))))
}

/// A value in the language, nodes by the [`ids`] of their description.
pub fn value_text(ids: &[String], parameter: &str, value: &Value) -> String {
    write::value_text(ids, parameter, value)
}

fn name_in(desc: &SceneDesc, node: NodeId) -> String {
    ids(desc).swap_remove(node.0 as usize)
}

/// A name for each node that no other has: its own, or one with a `#` where it has none or shares it.
pub fn ids(desc: &SceneDesc) -> Vec<String> {
    unique(desc.nodes.iter().map(|n| (n.name.as_deref(), n.kind.as_str())))
}

/// A unique name for each pair of an optional name and a word that replaces it.
fn unique<'a>(names: impl Iterator<Item = (Option<&'a str>, &'a str)>) -> Vec<String> {
    let mut taken = HashSet::new();
    let one = |(i, (name, kind)): (usize, (Option<&str>, &str))| {
        let name = name.unwrap_or_default();
        // What follows the last '#' is not part of a name.
        let mut id = if name.is_empty() { format!("#{kind}{i}") } else { name.to_owned() };
        if name.contains('#') || !taken.insert(id.clone()) {
            id = format!("{name}#{i}");
            taken.insert(id.clone());
        }
        id
    };
    names.enumerate().map(one).collect()
}

/// The name that an id stands for.
fn name_of(id: &str) -> Option<String> {
    let name = id.rfind('#').map_or(id, |at| &id[..at]);
    (!name.is_empty()).then(|| name.to_owned())
}

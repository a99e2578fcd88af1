//! Holds documents against the rules of the glTF 2.0 specification: its schema, what its objects refer to, and the
//! data.
//!
//! A broken rule is a warning. What cannot be read is an error of the reader, and is not told twice.

mod animations;
mod attributes;
mod data;
mod document;
mod elements;
mod extensions;
mod graph;
mod images;
mod issues;
mod kinds;
mod layout;
mod meshes;
mod objects;
mod schema;
mod skinning;
#[cfg(test)]
mod tests;
mod uri;
mod usage;
mod walk;

use super::Reader;
use document::Document;
use elements::Data;
use issues::{Issues, shown};
use serde_json::Value;
use steradian_scene::{Fidelity, Severity};
use usage::{Use, Uses};

impl Reader<'_> {
    /// Broken rules in the document and in the data of its loaded buffers.
    pub(super) fn issues(&self, root: &Value) -> Issues {
        let mut issues = Issues::default();
        walk::check(root, &mut issues);
        let document = Document::new(root);
        objects::check(&document, &mut issues);
        layout::check(&document, &mut issues);
        let mut uses = Uses::default();
        meshes::check(&document, &mut uses, &mut issues);
        graph::check(&document, &mut uses, &mut issues);
        animations::check(&document, &mut uses, &mut issues);
        for (k, image) in document.list("images").iter().enumerate() {
            if let Some((view, _)) = document.item(image, "bufferView", "bufferViews") {
                uses.view(&document, view, Use::Image, &format!("/images/{k}/bufferView"), &mut issues);
            }
        }
        let mut data = Data::new(&self.buffers);
        data::check(&document, &mut data, &mut issues);
        skinning::check(&document, &mut data, &mut issues);
        images::check(&document, &data, &self.search, &mut issues);
        issues
    }

    /// Warns of broken rules whose places no message of the reader names.
    pub(super) fn report(&mut self, issues: Issues) {
        let told: Vec<String> = (self.import.diagnostics.iter())
            .filter(|d| d.severity == Severity::Error || d.fidelity == Some(Fidelity::Approximated))
            .map(|d| d.message.clone())
            .collect();
        for issue in issues.finish() {
            let start = format!("{}: ", issue.pointer);
            if issue.pointer.is_empty() || !told.iter().any(|message| message.starts_with(&start)) {
                self.broken_rule(&issue.pointer, issue.message);
            }
        }
    }
}

//! Elements that steer the parser: `<include>`, `<default>`, `<path>`, `<alias>`.

use super::{
    graph::ObjectId,
    parse::{Attributes, File, Host, Parser, tag_span},
};
use roxmltree::Node;

impl Parser<'_> {
    /// Parses another file in place of the element.
    pub fn include(&mut self, node: Node<'_, '_>, parent: ObjectId, file: &File, attributes: &Attributes<'_>) {
        if !self.check(node, file, attributes, &["filename", "name"], &["filename"]) {
            return;
        }
        let Some(filename) = attributes.get("filename") else { return };
        let limits = &self.options.limits;
        let depth = file.depth + 1;
        if depth >= limits.include_depth {
            let message = format!("files include each other more than {} deep", limits.include_depth);
            return self.error(filename.value_span, message);
        }
        self.includes += 1;
        if self.includes > limits.includes {
            return self.error(filename.value_span, format!("more than {} files are included", limits.includes));
        }
        // The including file's own folder comes first.
        let mut search = self.search.clone();
        search.folders.insert(0, file.folder.clone());
        let limits = self.xml_limits();
        let found = search.find(&filename.value);
        match found.and_then(|path| self.included.read(&path, &limits).map(|bytes| (path, bytes))) {
            Ok((path, bytes)) => {
                let name = attributes.text("name").unwrap_or_default();
                self.text(&path, bytes, Some(Host { parent, name, depth }));
            }
            Err(e) => self.error(filename.value_span, e.to_string()),
        }
    }

    /// Gives a parameter a value where it has none.
    pub fn default(&mut self, node: Node<'_, '_>, file: &File, attributes: &Attributes<'_>) {
        if !self.check(node, file, attributes, &["name", "value"], &["name", "value"]) {
            return;
        }
        let (Some(name), Some(value)) = (attributes.get("name"), attributes.text("value")) else { return };
        if name.value.is_empty() {
            return self.error(name.value_span, "a parameter needs a name");
        }
        self.parameters.default(&name.value, value);
    }

    /// Adds a folder to the search path.
    pub fn path(&mut self, node: Node<'_, '_>, parent: ObjectId, file: &File, attributes: &Attributes<'_>) {
        if !self.check(node, file, attributes, &["value"], &["value"]) {
            return;
        }
        let Some(value) = attributes.get("value") else { return };
        if parent != 0 {
            return self.error(tag_span(node, file), "<path> belongs directly inside <scene>");
        }
        let bases = std::iter::once(&file.folder).chain(&self.search.folders);
        match bases.map(|base| base.join(value.value.as_ref())).find(|p| p.is_dir()) {
            Some(folder) => self.search.folders.insert(0, folder),
            None => self.error(value.value_span, format!("there is no folder '{}'", value.value)),
        }
    }

    /// Gives an object a second id.
    pub fn alias(&mut self, node: Node<'_, '_>, file: &File, attributes: &Attributes<'_>) {
        if !self.check(node, file, attributes, &["id", "as"], &["id", "as"]) {
            return;
        }
        let (Some(source), Some(target)) = (attributes.get("id"), attributes.get("as")) else { return };
        match self.graph.ids.get(source.value.as_ref()) {
            Some(&object) => self.register(&target.value, object, target.value_span),
            None => self.undefined(&source.value, source.value_span),
        }
    }
}

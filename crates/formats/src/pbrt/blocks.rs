//! Blocks and objects.

use super::reader::{Block, Done, Reader};
use steradian_scene::Span;

impl Reader<'_> {
    pub(super) fn begin(&mut self, span: Span, is_object: bool) -> Done {
        let limit = self.scene.options.limits.nesting;
        if self.blocks.len() >= limit {
            if self.scene.report.first_time("nesting") {
                self.scene.report.error(span, format!("blocks are nested more than {limit} deep"));
            }
            // Nothing sensible can follow.
            self.frames.clear();
            return Ok(());
        }
        self.blocks.push(Block { is_object, span, saved: self.state.clone() });
        Ok(())
    }

    /// Closes the innermost block. Returns whether it was of the right kind.
    pub(super) fn end(&mut self, word: &str, span: Span, is_object: bool) -> bool {
        let floor = self.frames.iter().rev().find_map(|f| f.import.as_ref()).map_or(0, |i| i.blocks);
        match self.blocks.last() {
            Some(block) if self.blocks.len() > floor && block.is_object == is_object => {
                if let Some(block) = self.blocks.pop() {
                    self.state = block.saved;
                }
                true
            }
            Some(block) if self.blocks.len() > floor => {
                let open = if block.is_object { "ObjectBegin" } else { "AttributeBegin" };
                self.scene
                    .report
                    .error(span, format!("{word} closes nothing: the innermost block was opened by {open}"));
                false
            }
            _ => {
                self.scene.report.error(span, format!("{word} closes nothing: no block is open"));
                false
            }
        }
    }

    pub(super) fn object_begin(&mut self, span: Span) -> Done {
        let (name, name_span) = self.quoted()?;
        if self.object.is_some() {
            return self.refuse(span, "an object cannot be defined inside another");
        }
        self.begin(span, true)?;
        // A second definition is read over: its shapes belong nowhere.
        let imports = self.frames.iter().filter(|f| f.import.is_some()).count();
        let index = match self.scene.add_object(name, name_span) {
            Some(index) => index,
            None => self.scene.add_hidden_object(),
        };
        self.object = Some((index, imports));
        Ok(())
    }

    pub(super) fn object_end(&mut self, span: Span) {
        let imports = self.frames.iter().filter(|f| f.import.is_some()).count();
        match self.object {
            None => self.scene.report.error(span, "ObjectEnd closes nothing: no object is being defined"),
            Some((_, at)) if at != imports => {
                self.scene.report.error(span, "an object must be closed in the file that opened it");
            }
            Some(_) => {
                if self.end("ObjectEnd", span, true) {
                    self.object = None;
                }
            }
        }
    }

    pub(super) fn object_instance(&mut self, span: Span) -> Done {
        let name = self.name_ref()?;
        if self.object.is_some() {
            return self.refuse(span, "an object cannot contain an instance");
        }
        self.scene.add_instance(name, &self.state);
        Ok(())
    }
}

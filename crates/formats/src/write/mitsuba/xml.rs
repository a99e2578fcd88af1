//! Elements of an XML document.

use std::fmt::Write;

/// An element with attributes and children.
#[derive(Clone, Debug)]
pub(super) struct Element {
    tag: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    pub fn new(tag: &'static str) -> Self {
        Self { tag, attributes: Vec::new(), children: Vec::new() }
    }

    /// An object of a plugin.
    pub fn plugin(tag: &'static str, plugin: &str) -> Self {
        Self::new(tag).with("type", plugin)
    }

    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    /// The name under which its parent holds it.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        self.attributes.push(("name", name.into()));
        self
    }

    #[must_use]
    pub fn child(mut self, child: Self) -> Self {
        self.children.push(child);
        self
    }

    /// Replaces the element's name attribute.
    #[must_use]
    pub fn renamed(mut self, name: &str) -> Self {
        self.attributes.retain(|a| a.0 != "name");
        self.named(name)
    }

    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|a| a.0 == name).map(|a| a.1.as_str())
    }

    pub fn into_children(self) -> Vec<Self> {
        self.children
    }

    pub fn push(&mut self, child: Self) {
        self.children.push(child);
    }

    fn value(&mut self, tag: &'static str, name: &str, value: impl Into<String>) {
        self.push(Self::new(tag).named(name).with("value", value));
    }

    pub fn float(&mut self, name: &str, value: f64) {
        self.value("float", name, value.to_string());
    }

    pub fn integer(&mut self, name: &str, value: i64) {
        self.value("integer", name, value.to_string());
    }

    pub fn boolean(&mut self, name: &str, value: bool) {
        self.value("boolean", name, value.to_string());
    }

    pub fn string(&mut self, name: &str, value: &str) {
        self.value("string", name, value);
    }

    /// As text, indented.
    pub fn write(&self, out: &mut String, depth: usize) {
        let space = "    ".repeat(depth);
        let _ = write!(out, "{space}<{}", self.tag);
        for (name, value) in &self.attributes {
            let _ = write!(out, " {name}=\"{}\"", escaped(value));
        }
        if self.children.is_empty() {
            out.push_str("/>\n");
            return;
        }
        out.push_str(">\n");
        self.children.iter().for_each(|c| c.write(out, depth + 1));
        let _ = writeln!(out, "{space}</{}>", self.tag);
    }
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // `$name` is a parameter of the document.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

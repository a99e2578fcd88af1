//! Nodes with what they refer to, before they have places in a description.

use crate::{
    Family, NodeId, SceneDesc,
    node::{Node, Value},
};
use std::collections::HashMap;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    Value(Value),
    Node(Box<Draft>),
    Nodes(Vec<Draft>),
}

impl<V: Into<Value>> From<V> for Part {
    fn from(v: V) -> Self {
        Self::Value(v.into())
    }
}

/// A node under construction.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Draft {
    pub family: Family,
    pub kind: &'static str,
    pub name: Option<String>,
    pub parts: Vec<(&'static str, Part)>,
}

impl Draft {
    pub fn new(family: Family, kind: &'static str) -> Self {
        Self { family, kind, name: None, parts: Vec::new() }
    }

    #[must_use]
    pub fn with(mut self, name: &'static str, part: impl Into<Part>) -> Self {
        self.set(name, part);
        self
    }

    pub fn set(&mut self, name: &'static str, part: impl Into<Part>) {
        self.parts.retain(|p| p.0 != name);
        self.parts.push((name, part.into()));
    }
}

/// A description and the nodes that it has.
#[derive(Debug, Default)]
pub(super) struct Arena {
    pub desc: SceneDesc,
    known: HashMap<String, NodeId>,
}

impl Arena {
    /// Adds a node after what it refers to. One that is there already is not added again.
    pub fn add(&mut self, draft: &Draft) -> NodeId {
        // Cameras and lights are told apart even where they are alike.
        let shared = matches!(draft.family, Family::Material | Family::Texture);
        let key = format!("{draft:?}");
        if let Some(&known) = self.known.get(&key).filter(|_| shared) {
            return known;
        }
        let mut node = Node { name: draft.name.clone(), ..Node::new(draft.family, draft.kind, None) };
        for (name, part) in &draft.parts {
            let value = match part {
                Part::Value(value) => value.clone(),
                Part::Node(inner) => Value::Node(self.add(inner)),
                Part::Nodes(inner) => Value::Nodes(inner.iter().map(|d| self.add(d)).collect()),
            };
            node.set(*name, value, None);
        }
        let id = self.desc.add(node);
        self.known.insert(key, id);
        id
    }
}

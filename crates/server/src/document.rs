//! The scene under view: its description, what was edited, and what is compiled of it.

use crate::protocol::{NodeState, ParameterState};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian::{
    CompileOptions, Kept, Scene, Viewpoint,
    formats::{Options, native},
    recompile,
    scene::{Diagnostics, Node, NodeId, Param, SceneDesc, Value},
};

/// Most edits that can be taken back.
const MOST_EDITS: usize = 256;

/// Longest text of a value that pages are told.
const LONGEST: usize = 4096;

/// How a scene is opened.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// A file, or `builtin:NAME`.
    pub name: PathBuf,
    /// How it is read.
    pub reading: Options,
}

/// A scene that is looked at and edited.
#[derive(Debug)]
pub struct Document {
    /// Where it comes from.
    pub source: Source,
    /// As it is now, but for a camera that was moved.
    pub desc: SceneDesc,
    /// What was said of it when it was read and compiled.
    pub diagnostics: Diagnostics,
    undo: Vec<Change>,
    redo: Vec<Change>,
    /// Of the scene that is rendered, and of previews.
    kept: [Kept; 2],
}

/// What an edit changed: a node's parameters, and the nodes that came with them. Taken back, what it had put there.
#[derive(Debug)]
struct Change {
    node: NodeId,
    params: Vec<Param>,
    /// How many nodes there were before it, and those that came.
    count: usize,
    added: Vec<Node>,
}

/// Which of two scenes is compiled: they keep what they are made of apart, as they may compute colours differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be rendered.
    Render,
    /// For pictures at once.
    Preview,
}

impl Document {
    /// Reads a scene.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn open(source: Source) -> Result<Self, Diagnostics> {
        let loaded = steradian::load(&source.name, &source.reading);
        if loaded.diagnostics.has_errors() {
            return Err(loaded.diagnostics);
        }
        let (desc, diagnostics) = (loaded.desc, loaded.diagnostics);
        Ok(Self { source, desc, diagnostics, undo: Vec::new(), redo: Vec::new(), kept: Default::default() })
    }

    /// Compiles it, as seen from a place if one is given.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn compile(
        &mut self,
        purpose: Purpose,
        options: &CompileOptions,
        view: Option<&View>,
    ) -> Result<Arc<Scene>, Diagnostics> {
        let camera = self.desc.camera(options.camera.as_deref());
        // The description stays as its file has it; a camera that was moved is put back after compiling.
        let own = view.zip(camera).map(|(view, id)| {
            let own = self.desc.node(id).clone();
            view.place(&mut self.desc, id);
            (id, own)
        });
        let compiled = recompile(&self.desc, options, &mut self.kept[purpose as usize]);
        if let Some((id, own)) = own {
            *self.desc.node_mut(id) = own;
        }
        match compiled.scene {
            Some(scene) if !compiled.diagnostics.has_errors() => {
                self.diagnostics.extend(compiled.diagnostics);
                Ok(Arc::new(scene))
            }
            _ => Err(compiled.diagnostics),
        }
    }

    /// The scene as it is, with the camera where it was moved.
    pub fn seen_from(&self, camera: Option<&str>, view: Option<&View>) -> SceneDesc {
        let mut desc = self.desc.clone();
        if let Some((view, id)) = view.zip(self.desc.camera(camera)) {
            view.place(&mut desc, id);
        }
        desc
    }

    /// How many edits can be taken back, and done again.
    pub fn edits(&self) -> [usize; 2] {
        [self.undo.len(), self.redo.len()]
    }

    /// Whether it is other than its file.
    pub fn is_edited(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Sets a parameter of a node, or takes it away; the scene must compile still.
    ///
    /// # Errors
    /// What is wrong with it; nothing is changed then.
    pub fn edit(
        &mut self,
        [node, parameter]: [&str; 2],
        value: Option<&str>,
        within: &Path,
        options: &CompileOptions,
    ) -> Result<(), String> {
        let ids = native::ids(&self.desc);
        let Some(id) = ids.iter().position(|id| id == node).map(|k| NodeId(k as u32)) else {
            let hint = steradian::scene::names::did_you_mean(node, ids.iter().map(String::as_str));
            return Err(format!("there is no node '{node}'{}", hint.map(|h| format!("; {h}")).unwrap_or_default()));
        };
        let before = Change {
            node: id,
            params: self.desc.node(id).params.clone(),
            count: self.desc.nodes.len(),
            added: Vec::new(),
        };
        // What is typed into a page names no file elsewhere.
        let reading = Options { within: Some(within.into()), ..self.source.reading.clone() };
        native::set(&mut self.desc, id, parameter, value.unwrap_or("null"), &reading).map_err(|d| told(&d))?;
        self.undo.push(before);
        let fault = self.compile(Purpose::Render, options, None).err().map(|d| told(&d));
        if fault.is_some() {
            self.undo();
            self.redo.pop();
        } else {
            self.redo.clear();
        }
        if self.undo.len() > MOST_EDITS {
            self.undo.remove(0);
        }
        fault.map_or(Ok(()), Err)
    }

    /// Takes the last edit back; whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(mut change) = self.undo.pop() else { return false };
        std::mem::swap(&mut self.desc.node_mut(change.node).params, &mut change.params);
        change.added = self.desc.nodes.split_off(change.count);
        self.redo.push(change);
        true
    }

    /// Does it again; whether there was one.
    pub fn redo(&mut self) -> bool {
        let Some(mut change) = self.redo.pop() else { return false };
        self.desc.nodes.append(&mut change.added);
        std::mem::swap(&mut self.desc.node_mut(change.node).params, &mut change.params);
        self.undo.push(change);
        true
    }

    /// All nodes, with all that can be set of them.
    pub fn nodes(&self) -> Vec<NodeState> {
        let ids = native::ids(&self.desc);
        let node = |(node, id): (&Node, &String)| {
            let value = |name: &str| {
                let text = node.get(name).map(|v| native::value_text(&ids, name, v));
                text.map(|text| if text.len() <= LONGEST { text } else { "…".into() })
            };
            let known: Vec<_> = node.family.parameters(&node.kind).into_iter().flatten().collect();
            let described = known.iter().map(|p| ParameterState {
                name: p.name.into(),
                value: value(p.name),
                default: p.default,
                values: p.values(),
                unit: p.unit,
                range: Some([p.range.0, p.range.1].map(|v| Some(v).filter(|v| v.is_finite())))
                    .filter(|r| *r != [None; 2]),
                doc: p.meaning(),
                words: p.words().collect(),
            });
            NodeState {
                id: id.clone(),
                family: node.family.noun().split(' ').next().unwrap_or_default(),
                kind: node.kind.clone(),
                parameters: described.collect(),
            }
        };
        self.desc.nodes.iter().zip(&ids).map(node).collect()
    }
}

/// Where a camera was moved, and its field of view if that was changed, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The place.
    pub point: Viewpoint,
    /// The field of view.
    pub fov: Option<f64>,
}

impl View {
    fn place(&self, desc: &mut SceneDesc, camera: NodeId) {
        self.point.place(desc, camera);
        if let Some(fov) = self.fov {
            desc.node_mut(camera).set("fov", Value::Float(fov), None);
        }
    }
}

/// All that is wrong, a line each.
pub fn told(diagnostics: &Diagnostics) -> String {
    let errors = diagnostics.iter().filter(|d| d.severity == steradian::scene::Severity::Error);
    errors.map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

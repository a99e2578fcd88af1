//! The scene under view: its description, what was edited, and what is compiled of it.

use crate::{
    edits::{Change, Edit, PLACE, placements},
    look::View,
    names::{Names, labels},
    protocol::{NodeState, ParameterState},
};
use std::{
    collections::{BTreeMap, HashMap},
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian::{
    CompileOptions, Kept, Scene,
    formats::{Options, native},
    image::{Stamp, read_regular},
    recompile,
    scene::{Diagnostics, Node, SceneDesc, Transform, Value},
};

/// Most edits that can be taken back.
const MOST_EDITS: usize = 256;

/// Most files that are watched.
const MOST_FILES: usize = 1024;
/// Stamps of files, by which changes of them are noticed.
pub type Stamps = BTreeMap<PathBuf, Stamp>;
/// Bytes of environment maps in all edits.
const MOST_BYTES: usize = 1 << 30;
/// Most placements that are told beside those of nodes.
const MOST_PLACEMENTS: usize = 1000;
/// Longest text of a value that pages are told.
const LONGEST: usize = 4096;

/// Source of a scene, and options for opening it.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// A file, or `builtin:NAME`.
    pub name: PathBuf,
    /// Options of reading.
    pub reading: Options,
    /// The scene itself, where it is in memory.
    pub scene: Option<Arc<SceneDesc>>,
    /// Tells how many bytes of memory there are; scenes that need more are refused.
    pub memory: Option<fn() -> Option<u64>>,
}

/// A scene that is looked at and edited.
#[derive(Debug)]
pub struct Document {
    /// Source of the scene.
    pub source: Source,
    /// As it is now, but for a camera that was moved.
    pub desc: SceneDesc,
    /// Diagnostics of reading and compiling.
    pub diagnostics: Diagnostics,
    undo: Vec<Change>,
    redo: Vec<Change>,
    kept: Kept,
    names: Arc<Names>,
    /// Number of compilations.
    #[cfg(test)]
    pub compiled: usize,
}

impl Document {
    /// Reads a scene.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn open(source: Source) -> Result<Self, Diagnostics> {
        let (desc, diagnostics) = match &source.scene {
            Some(scene) => (SceneDesc::clone(scene), Diagnostics::default()),
            None => {
                let loaded = steradian::load(&source.name, &source.reading);
                (loaded.desc, loaded.diagnostics)
            }
        };
        if diagnostics.has_errors() {
            return Err(diagnostics);
        }
        let names = Arc::new(Names::new(&desc));
        Ok(Self {
            source,
            desc,
            diagnostics,
            undo: Vec::new(),
            redo: Vec::new(),
            kept: Default::default(),
            names,
            #[cfg(test)]
            compiled: 0,
        })
    }

    /// Compiles it, as seen from a place if one is given.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn compile(&mut self, options: &CompileOptions, view: Option<&View>) -> Result<Arc<Scene>, Diagnostics> {
        let camera = self.desc.camera(options.camera.as_deref());
        // The description stays as its file has it; a camera that was moved is put back after compiling.
        let own = view.zip(camera).map(|(view, id)| {
            let own = self.desc.node(id).clone();
            view.place(&mut self.desc, id);
            (id, own)
        });
        let options = CompileOptions { memory: self.source.memory.and_then(|there_is| there_is()), ..options.clone() };
        let compiled = recompile(&self.desc, &options, &mut self.kept);
        if let Some((id, own)) = own {
            *self.desc.node_mut(id) = own;
        }
        #[cfg(test)]
        {
            self.compiled += 1;
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

    /// Names of the nodes.
    pub fn names(&mut self) -> Arc<Names> {
        // Edits add nodes, and change no names.
        if self.names.count() != self.desc.nodes.len() {
            self.names = Arc::new(Names::new(&self.desc));
        }
        self.names.clone()
    }

    /// Numbers of edits that can be taken back, and done again.
    pub fn edits(&self) -> [usize; 2] {
        [self.undo.len(), self.redo.len()]
    }

    /// True if the scene differs from its file.
    pub fn is_edited(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Makes an edit that a check accepts; gives what the check made, as the compiled scene.
    ///
    /// # Errors
    /// What is wrong with it; nothing is changed then.
    pub fn edit<T>(&mut self, edit: Edit, check: impl FnOnce(&mut Self) -> Result<T, String>) -> Result<T, String> {
        let replaced = self.undo.last().is_some_and(|c| c.goes_on(&edit));
        if replaced {
            self.undo();
        }
        let done = self.carry_out(edit).and_then(|()| check(self).inspect_err(|_| self.take_back()));
        match done {
            Ok(_) => self.redo.clear(),
            Err(_) if replaced => drop(self.redo()),
            Err(_) => {}
        }
        if self.undo.len() > MOST_EDITS {
            self.undo.remove(0);
        }
        done
    }

    /// Changes the description.
    fn carry_out(&mut self, edit: Edit) -> Result<(), String> {
        let bytes: usize = self.undo.iter().map(|c| &c.edit).chain([&edit]).map(Edit::bytes).sum();
        if bytes > MOST_BYTES {
            return Err(format!("environment maps take more than {MOST_BYTES} bytes; undo those before"));
        }
        let reading = Options { within: Some(self.folder()), ..self.source.reading.clone() };
        self.undo.push(Change::make(&mut self.desc, edit, &reading)?);
        Ok(())
    }

    /// The scene as its files have it now, with all edits made again; those that cannot be made any more are told.
    ///
    /// # Errors
    /// All that is wrong with the files.
    pub fn reloaded(&self) -> Result<(Self, Vec<String>), Diagnostics> {
        self.read_again(self.source.clone())
    }

    /// The scene of a source like this one's, with all edits made again; those that cannot be made are told.
    ///
    /// # Errors
    /// All that is wrong with the files.
    pub fn read_again(&self, source: Source) -> Result<(Self, Vec<String>), Diagnostics> {
        let mut fresh = Self::open(source)?;
        let edits: Vec<Edit> = self.undo.iter().map(|c| c.edit.clone()).collect();
        let lost = edits.into_iter().filter_map(|edit| fresh.carry_out(edit).err()).collect();
        Ok((fresh, lost))
    }

    /// Puts another document in its place, which goes on with what compilations kept; gives this one.
    pub fn replace(&mut self, mut other: Self) -> Self {
        other.kept = std::mem::take(&mut self.kept);
        std::mem::replace(self, other)
    }

    /// All files that the scene is made of, and what tells that they are others than they were.
    pub fn stamps(&self) -> Stamps {
        let stamp = |path: &Path| (path.to_owned(), Stamp::of(path));
        self.desc.files().take(MOST_FILES).map(stamp).collect()
    }

    /// The folder of the scene's file; of built-in scenes the current one.
    pub fn folder(&self) -> PathBuf {
        let folder = self.desc.path.as_deref().and_then(Path::parent).filter(|f| !f.as_os_str().is_empty());
        folder.map_or_else(|| PathBuf::from("."), PathBuf::from)
    }

    /// The folder that what is saved goes into: the scene's, or for an upload, whose folder is temporary, the current
    /// one.
    pub fn saving_folder(&self) -> PathBuf {
        if self.uploads().is_some() { PathBuf::from(".") } else { self.folder() }
    }

    /// The temporary folder of an upload. Scenes of uploads alone are held within a folder.
    fn uploads(&self) -> Option<&Path> {
        self.source.reading.within.as_deref()
    }

    /// Puts the files of an upload into a description, so that they are written beside it.
    ///
    /// # Errors
    /// Where one cannot be read.
    pub fn take_uploads_along(&self, desc: &mut SceneDesc) -> Result<(), String> {
        let Some(folder) = self.uploads() else { return Ok(()) };
        let named = desc.nodes.iter().flat_map(|node| &node.params).filter_map(|param| match &param.value {
            Value::Path(path) if path.starts_with(folder) => Some(path.clone()),
            _ => None,
        });
        for path in named.collect::<Vec<_>>() {
            if !desc.embedded.contains_key(&path) && path.exists() {
                let bytes = read_regular(&path, u64::MAX).map_err(|e| format!("'{}': {e}", path.display()))?;
                desc.embedded.insert(path, bytes.into());
            }
        }
        Ok(())
    }

    /// Takes the last edit back; whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(mut change) = self.undo.pop() else { return false };
        change.undo(&mut self.desc);
        self.redo.push(change);
        true
    }

    /// Takes the last edit back as if it had never been.
    pub fn take_back(&mut self) {
        if self.undo() {
            self.redo.pop();
        }
    }

    /// Does it again; whether there was one.
    pub fn redo(&mut self) -> bool {
        let Some(mut change) = self.redo.pop() else { return false };
        change.redo(&mut self.desc);
        self.undo.push(change);
        true
    }

    /// All nodes, with all that can be set of them.
    pub fn nodes(&self) -> Vec<NodeState> {
        let ids = labels(&self.desc);
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
        let mut nodes: Vec<NodeState> = self.desc.nodes.iter().zip(&ids).map(node).collect();
        let known: HashMap<&String, usize> = ids.iter().zip(0..).collect();
        let mut further = 0;
        for placed in placements(&self.desc, &ids) {
            let place = place(&ids, placed.place);
            match known.get(&placed.id) {
                Some(k) => nodes[*k].parameters.push(place),
                None if further < MOST_PLACEMENTS => {
                    further += 1;
                    let (id, kind) = (placed.id, placed.kind);
                    nodes.push(NodeState { id, family: "placement", kind, parameters: vec![place] });
                }
                None => {}
            }
        }
        nodes
    }
}

/// Placement as a parameter.
fn place(ids: &[String], place: Transform) -> ParameterState {
    ParameterState {
        name: PLACE.into(),
        value: Some(native::value_text(ids, PLACE, &Value::Transform(place))),
        default: "identity",
        values: "transform".into(),
        unit: "",
        range: None,
        doc: "places it".into(),
        words: Vec::new(),
    }
}

//! The state of reading: files, blocks and the scene so far.

use super::{
    camera,
    dict::Dict,
    film,
    lexer::{Kind, Lexer},
    sampling,
    scene::Scene,
    state::State,
};
use crate::{
    Options,
    files::{Included, SearchPath},
};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_scene::{Span, Transform};

/// An open block.
pub(super) struct Block {
    pub is_object: bool,
    pub span: Span,
    pub saved: State,
}

/// A file being read.
pub(super) struct Frame {
    pub lexer: Lexer,
    pub path: PathBuf,
    /// For imports: what holds again when the file ends.
    pub import: Option<Import>,
}

/// State that an import must not change, restored at its end.
pub(super) struct Import {
    pub saved: State,
    pub blocks: usize,
}

/// A directive that sets something for the whole picture.
#[derive(Default)]
pub(super) struct Globals {
    pub camera: Option<(Dict, State)>,
    pub film: Option<Dict>,
    pub filter: Option<Dict>,
    pub sampler: Option<Dict>,
    pub integrator: Option<Dict>,
    pub accelerator: Option<Dict>,
    pub seed: Option<i64>,
}

/// Carries out the directives of a scene.
pub(super) struct Reader<'o> {
    pub scene: Scene<'o>,
    pub state: State,
    pub blocks: Vec<Block>,
    pub frames: Vec<Frame>,
    pub globals: Globals,
    pub coordinate_systems: HashMap<String, [Transform; 2]>,
    /// The object being defined, and how many imports were open when it began.
    pub object: Option<(usize, usize)>,
    pub in_world: bool,
    pub includes: usize,
    included: Included,
}

/// A fault that ends a directive; already reported.
pub(super) struct Given;

/// Result of carrying out a directive.
pub(super) type Done = Result<(), Given>;

impl<'o> Reader<'o> {
    pub fn new(options: &'o Options, search: SearchPath) -> Self {
        Self {
            scene: Scene::new(options, search),
            state: State::default(),
            blocks: Vec::new(),
            frames: Vec::new(),
            globals: Globals::default(),
            coordinate_systems: HashMap::new(),
            object: None,
            in_world: false,
            includes: 0,
            included: Included::default(),
        }
    }

    /// Reads a scene from its text and all files that it includes.
    pub fn read(&mut self, path: &Path, text: Vec<u8>) {
        self.open(path.into(), text.into(), None);
        while let Some(frame) = self.frames.last_mut() {
            if self.scene.report.is_full() {
                return;
            }
            match frame.lexer.next() {
                Err(fault) => self.fault(fault),
                Ok(t) if t.kind == Kind::End => self.close(),
                Ok(t) => {
                    if self.directive(t).is_err() {
                        self.resynchronise();
                    }
                }
            }
        }
        self.finish();
    }

    fn finish(&mut self) {
        if let Some(block) = self.blocks.last() {
            let what = if block.is_object { "object" } else { "attribute block" };
            self.scene
                .report
                .error(block.span, format!("this {what} is not closed (and {} more)", self.blocks.len() - 1));
        }
        if !self.in_world {
            self.scene.report.error_nowhere("the scene has no WorldBegin");
        }
        self.scene.finish();
        let Globals { camera, film, filter, sampler, integrator, accelerator, seed } =
            std::mem::take(&mut self.globals);
        let scene = &mut self.scene;
        // What the file leaves out is pbrt's default.
        let anywhere = Span::new(steradian_scene::FileId(0), 0, 0);
        let or = |dict: Option<Dict>, kind: &str| dict.unwrap_or_else(|| Dict::absent(kind, anywhere));
        let (dict, state) = camera.unwrap_or_else(|| (Dict::absent("perspective", anywhere), State::default()));
        let camera = camera::translate(scene, &dict, &state, film.as_ref());
        scene.settle_media();
        let shutter = |name| camera.and_then(|id| scene.desc.node(id).float(name));
        let exposure = shutter("shutter_close").unwrap_or(1.0) - shutter("shutter_open").unwrap_or(0.0);
        scene.desc.cameras.extend(camera);
        scene.desc.film = film::film(scene, &or(film, "rgb"), exposure);
        scene.desc.filter = film::filter(scene, &or(filter, "gaussian"));
        scene.desc.sampler = sampling::sampler(scene, &or(sampler, "zsobol"), seed);
        let integrator = or(integrator, "volpath");
        scene.desc.integrator = sampling::integrator(scene, &integrator);
        let is_path = scene.desc.integrator.is_some_and(|id| scene.desc.node(id).kind == "path");
        if is_path && scene.desc.shapes.iter().any(|s| s.is_medium_boundary) {
            let message = format!("integrator '{}' passes through media as through vacuum", integrator.kind);
            scene.report.note(integrator.span, message);
        }
        if let Some(dict) = accelerator {
            sampling::accelerator(scene, &dict);
        }
    }

    // --- files ---

    fn open(&mut self, path: PathBuf, text: Arc<[u8]>, import: Option<Import>) {
        let file = self.scene.report.sources.add(path.clone(), text.clone());
        if text.starts_with(&[0xff, 0xfe]) || text.starts_with(&[0xfe, 0xff]) {
            let span = Span::new(file, 0, 2);
            self.scene.report.error(span, "the file is UTF-16; scenes are read as UTF-8");
            return;
        }
        self.frames.push(Frame { lexer: Lexer::new(file, text), path, import });
    }

    /// Leaves a file that is read to its end.
    fn close(&mut self) {
        let Some(Frame { import: Some(import), .. }) = self.frames.pop() else { return };
        if self.blocks.len() > import.blocks
            && let Some(open) = self.blocks.last()
        {
            self.scene.report.error(open.span, "this block is not closed in the imported file");
            self.blocks.truncate(import.blocks);
        }
        self.state = import.saved;
    }

    /// `Include` and `Import`.
    pub(super) fn include(&mut self, is_import: bool) -> Done {
        let (name, span) = self.quoted()?;
        let limits = &self.scene.options.limits;
        if self.frames.len() > limits.include_depth {
            let message = format!("files are included more than {} deep", limits.include_depth);
            return self.refuse(span, message);
        }
        self.includes += 1;
        if self.includes > limits.includes {
            return self.refuse(span, format!("more than {} files are included", limits.includes));
        }
        let path = match self.scene.search.find(&name) {
            Ok(path) => path,
            Err(fault) => return self.refuse(span, fault.to_string()),
        };
        let real = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.into());
        let target = real(&path);
        if self.frames.iter().any(|f| real(&f.path) == target) {
            return self.refuse(span, format!("'{name}' includes itself"));
        }
        match self.included.read(&path, limits) {
            Ok(text) => {
                let import = is_import.then(|| Import { saved: self.state.clone(), blocks: self.blocks.len() });
                // Files that an included file names are looked for beside it too.
                if let Some(folder) = path.parent()
                    && !self.scene.search.folders.iter().any(|f| f == folder)
                {
                    self.scene.search.folders.push(folder.into());
                }
                self.open(path, text, import);
                Ok(())
            }
            Err(fault) => self.refuse(span, fault.to_string()),
        }
    }
}

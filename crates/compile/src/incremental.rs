//! State kept from one compilation for the next of the same scene: after an edit only changed parts are made anew.
//! Where only the camera or the size of the picture differs, everything else is kept, so that moves of the camera and
//! previews cost no compilation.

use super::{
    Compiled, Compiler, Options,
    assets::{Assets, Source},
    coats::Coats,
};
use std::{collections::HashMap, path::PathBuf, sync::Arc, time::Duration};
use steradian_accel::Accel;
use steradian_core::{
    camera::Camera,
    film::FilmSpec,
    scene::{Geometry, Scene, Shape},
};
use steradian_math::spectra::ColorMode;
use steradian_scene::{Diagnostics, Instance, Mesh, Node, NodeId, SceneDesc, Transform, Value};

/// Pictures and grids that were read, shapes that were placed, tables of coats, and the structure that rays go through,
/// each with what it was made from. What is made from it is bit for bit what is made without it.
#[derive(Debug, Default)]
pub struct Kept {
    /// The options that all of it depends on.
    options: String,
    pub(super) assets: Assets,
    pub(super) coats: ByMode<Coats>,
    pub(super) shapes: HashMap<NodeId, KeptShape>,
    pub(super) accel: Option<KeptAccel>,
    pub(super) scenes: ByMode<KeptScene>,
}

/// One of each colour mode.
#[derive(Debug)]
pub(super) struct ByMode<T>([Option<T>; 2]);

impl<T> Default for ByMode<T> {
    fn default() -> Self {
        Self([None, None])
    }
}

impl<T> ByMode<T> {
    /// Value of a mode.
    pub fn of(&mut self, mode: ColorMode) -> &mut Option<T> {
        let Self([rgb, spectral]) = self;
        match mode {
            ColorMode::Rgb => rgb,
            ColorMode::Spectral => spectral,
        }
    }
}

impl Kept {
    /// The scene of the last compilation as another camera sees it, where nothing else has changed.
    pub(super) fn for_another_view(&mut self, now: &Compiler<'_>) -> Option<Compiled> {
        self.scenes.of(now.mode).as_ref()?.for_another_view(now)
    }

    /// Forgets what was made for other options, and of files that have changed.
    pub(super) fn refresh(&mut self, desc: &SceneDesc, options: &Options) {
        let Options { accelerator, texture_limit, image_limits, registry, .. } = options;
        let own = registry.address();
        let now = format!("{accelerator:?} {texture_limit:?} {image_limits:?} {own}");
        if self.options != now {
            *self = Self { options: now, ..Self::default() };
        }
        self.assets.refresh(desc);
    }
}

/// Parameters of cameras that nothing else depends on.
const OF_CAMERAS: [&str; 6] = ["to_world", "to_world_end", "motion_times", "fov", "lens_radius", "focal_distance"];

/// A scene, and all that it was made from.
#[derive(Debug)]
pub(super) struct KeptScene {
    desc: SceneDesc,
    options: Options,
    files: Vec<(PathBuf, Source)>,
    scene: Scene,
    diagnostics: Diagnostics,
    /// Messages on film and camera, part of the diagnostics.
    of_view: Vec<String>,
    /// Files that the description does not name.
    further: Vec<PathBuf>,
}

impl KeptScene {
    /// Keeps what was compiled.
    pub fn new(compiler: &Compiler<'_>, scene: &Scene) -> Self {
        let desc = compiler.desc;
        let further = compiler.files.clone();
        let files = desc.files().chain(further.iter().map(PathBuf::as_path));
        Self {
            files: files.map(|path| (path.to_owned(), Source::of(desc, path))).collect(),
            desc: desc.clone(),
            options: compiler.options.clone(),
            scene: scene.clone(),
            diagnostics: compiler.diagnostics.clone(),
            of_view: view(compiler).1,
            further,
        }
    }

    /// The scene with film and camera as they are described now; `None` where more has changed.
    fn for_another_view(&self, now: &Compiler<'_>) -> Option<Compiled> {
        let Compiler { desc, options, .. } = *now;
        let Options { size, crop, memory, .. } = self.options;
        let is_same = Options { size, crop, memory, ..options.clone() } == self.options
            && self.is_same(desc, now.chosen_camera()?)
            && self.files.iter().all(|(path, source)| source.is_current(desc, path));
        if !is_same {
            return None;
        }
        let (seen, said) = view(now);
        let (film, camera) = seen?;
        let pixels = |film: &FilmSpec| u64::from(film.crop.width()) * u64::from(film.crop.height());
        let takes_more = options.memory.is_some() && pixels(&film) > pixels(self.scene.film());
        if takes_more || said != self.of_view {
            return None;
        }
        let scene = self.scene.clone().changed(|parts| {
            parts.camera = Camera { medium: parts.camera.medium, ..camera };
            parts.film = film;
        });
        let (diagnostics, files) = (self.diagnostics.clone(), self.further.clone());
        Some(Compiled { scene: Some(scene), diagnostics, build_time: Duration::ZERO, files })
    }

    /// True if a description differs at most in parameters of the camera alone.
    fn is_same(&self, desc: &SceneDesc, camera: NodeId) -> bool {
        let then = &self.desc;
        let index = camera.0 as usize;
        let nodes = (0..).zip(then.nodes.iter().zip(&desc.nodes));
        let rest = |node: &Node| {
            let mut node = node.clone();
            node.params.retain(|p| !OF_CAMERAS.contains(&p.name.as_str()));
            node
        };
        let parts = |d: &SceneDesc| (d.film, d.filter, d.sampler, d.integrator, d.format, d.path.clone());
        parts(then) == parts(desc)
            && then.nodes.len() == desc.nodes.len()
            && nodes.into_iter().all(|(k, (a, b))| if k == index { rest(a) == rest(b) } else { a == b })
            && then.meshes.len() == desc.meshes.len()
            && then.meshes.iter().zip(&desc.meshes).all(|(a, b)| Arc::ptr_eq(a, b))
            && (&then.shapes, &then.groups, &then.instances) == (&desc.shapes, &desc.groups, &desc.instances)
            && (&then.lights, &then.cameras) == (&desc.lights, &desc.cameras)
    }
}

/// Film and camera as they are described, and what there is to say about them.
fn view(Compiler { desc, mode, options, .. }: &Compiler<'_>) -> (Option<(FilmSpec, Camera)>, Vec<String>) {
    let mut compiler = Compiler::new(desc, *mode, options);
    let seen = compiler.view();
    (seen, compiler.diagnostics.iter().map(ToString::to_string).collect())
}

/// A shape's geometry.
#[derive(Debug)]
pub(super) struct KeptShape {
    pub from: Origin,
    pub parts: Vec<Shape>,
}

/// All that the geometry of a shape is made from.
#[derive(Debug)]
pub(super) struct Origin {
    node: Node,
    mesh: Option<Arc<Mesh>>,
    place: Transform,
    reverse: bool,
    emits: bool,
}

impl Origin {
    /// Origin of a shape; `None` where it depends on other nodes, files, or the camera's position.
    pub fn of(desc: &SceneDesc, shape: &steradian_scene::Shape, mode: ColorMode) -> Option<Self> {
        let node = desc.node(shape.node);
        let mesh = shape.mesh.and_then(|m| desc.meshes.get(m));
        let refers = node.params.iter().any(|p| matches!(p.value, Value::Node(_) | Value::Path(_)));
        // Attributes get spectra where textures show them.
        let shows = mode == ColorMode::Spectral && mesh.is_some_and(|m| !m.attributes.is_empty());
        (!refers && !shows && node.get("displacement").is_none()).then(|| Self {
            node: node.clone(),
            mesh: mesh.cloned(),
            place: shape.world_from_object,
            reverse: shape.reverse_orientation,
            emits: shape.emission.is_some(),
        })
    }
}

impl PartialEq for Origin {
    fn eq(&self, other: &Self) -> bool {
        let meshes = match (&self.mesh, &other.mesh) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        let own = |o: &Self| (o.place, o.reverse, o.emits);
        meshes && own(self) == own(other) && self.node == other.node
    }
}

/// The structure that rays go through, and what it was built over.
#[derive(Debug)]
pub(super) struct KeptAccel {
    over: Space,
    pub accel: Arc<Accel>,
}

/// Input of a structure.
#[derive(Clone, Debug)]
pub(super) struct Space {
    shapes: Vec<(Shape, bool)>,
    /// The first shape of each group.
    groups: Vec<u32>,
    instances: Vec<Instance>,
}

impl Space {
    /// Input of a structure over these geometries, groups and instances.
    pub fn new(geometries: &[Geometry], groups: impl Iterator<Item = u32>, instances: &[Instance]) -> Self {
        Self {
            shapes: geometries.iter().map(|g| (g.shape.clone(), g.is_masked() || g.is_interface)).collect(),
            groups: groups.collect(),
            instances: instances.to_vec(),
        }
    }

    /// True if a structure over the one is a structure over the other.
    fn is_same(&self, other: &Self) -> bool {
        // When things move depends on the camera's shutter.
        let is_still = self.instances.iter().all(|i| i.movement.is_none());
        is_still
            && self.shapes.len() == other.shapes.len()
            && self.shapes.iter().zip(&other.shapes).all(|(a, b)| a.1 == b.1 && a.0.is_same(&b.0))
            && self.groups == other.groups
            && self.instances == other.instances
    }
}

impl KeptAccel {
    /// Keeps a structure.
    pub fn new(over: Space, accel: Arc<Accel>) -> Self {
        Self { over, accel }
    }

    /// The structure, if it is one over this.
    pub fn over(&self, space: &Space) -> Option<Arc<Accel>> {
        self.over.is_same(space).then(|| self.accel.clone())
    }
}

//! From a description to a scene: every name is looked up, every number checked, every file loaded. Faults are reported
//! with their place in the file; a model that Steradian lacks is replaced by the nearest one it has, and reported too
//! (`nearest_material`).
//!
//! Ranges are those of the schema (`ranges`, `params`). Each image is loaded once, and images in parallel. Materials
//! and textures refer to earlier ones by index, so that their trees cannot be cyclic; trees of textures may be of any
//! depth, and are compiled with an explicit stack. Scenes far from the origin are compiled around another origin
//! (`recentre`). The hierarchy is built last.

mod assets;
mod bands;
mod bezier;
mod coats;
mod cube;
mod description_checks;
mod dispersion;
mod displacement;
mod distance_field;
mod emission;
mod fluorescent;
mod grating;
mod hair;
mod height_field;
mod implicit_surfaces;
mod incremental;
mod layered;
mod lights;
mod mapping;
mod materials;
mod measured;
mod media;
mod microfacets;
mod motion;
mod own;
mod parametric;
mod params;
mod patterns;
mod pbr;
mod plane;
mod polygon;
mod precision;
mod principled;
mod ranges;
mod realistic;
mod recentre;
mod registry;
mod schedule;
mod sensor;
mod shapes;
mod sky;
mod subsurface;
mod textures;
mod unknown_parameters;
mod view;
mod volume_files;

use assets::Assets;
use coats::Coats;
pub use incremental::Kept;
use incremental::{KeptAccel, KeptScene, KeptShape, Space};
pub use registry::{Make, OwnParameter, Registry, RegistryError, Values};
use schedule::Lamp;
use std::{
    collections::{BTreeMap, HashMap, HashSet},
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant},
};
use steradian_accel::{Accel, Accelerator, Object};
use steradian_core::{
    camera::Camera,
    film::FilmSpec,
    light::{Ambient, Emitter, Environment, Light, LightGroups, Lights, Schedule},
    material::Material,
    medium::Medium,
    scene::{Geometry, Parts, Placement, Scene},
};
use steradian_math::{DVec3, spectra::ColorMode};
use steradian_scene::{Diagnostics, Format, NodeId, SceneDesc, Span};
use steradian_texture::{FloatTexture, TextureId, Textures};

/// User options of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Colour mode; `None` follows the format: spectral for pbrt scenes and films with bands, RGB for others.
    pub mode: Option<ColorMode>,
    /// Frame size instead of the scene's.
    pub size: Option<(u32, u32)>,
    /// Pixels to render (x0, y0, x1, y1) instead of the scene's.
    pub crop: Option<[u32; 4]>,
    /// Camera by name or number instead of the first.
    pub camera: Option<String>,
    /// Models of the program's own.
    pub registry: Registry,
    /// The structure that rays go through. All give the same picture.
    pub accelerator: Accelerator,
    /// Samples per pixel instead of the scene's: the more there are, the closer they lie and the less textures are
    /// filtered.
    pub spp: Option<u32>,
    /// Bytes of textures that may be in memory at once; what is beyond waits in a temporary file. `None` for no limit.
    pub texture_limit: Option<usize>,
    /// Enables stochastic lookups of all pictures: one texel drawn at random, whose mean is the filter's value.
    pub stochastic_textures: bool,
    /// Noise of the film's sensor.
    pub sensor_noise: SensorNoise,
    /// Limits on images.
    pub image_limits: steradian_image::Limits,
    /// Bytes of memory that there are for pictures and film; scenes that need more are refused before anything is
    /// loaded. `None` for no limit.
    pub memory: Option<u64>,
}

/// Noise of sensors, whose films have a full well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorNoise {
    /// None: pictures have the noise of their samples alone.
    Off,
    /// Noise of one frame of a sequence, by its number; frames of different numbers have independent noise.
    OfFrame(u32),
}

impl Default for SensorNoise {
    fn default() -> Self {
        Self::OfFrame(0)
    }
}

/// Memory of a film while it is rendered, in bytes per pixel: the sums of a pixel, and a copy of them.
const BYTES_PER_PIXEL: u64 = 112;

/// Result of compiling.
#[derive(Debug)]
pub struct Compiled {
    /// The scene; `None` where there are errors.
    pub scene: Option<Scene>,
    /// Everything there is to say.
    pub diagnostics: Diagnostics,
    /// Time spent on the hierarchy.
    pub build_time: Duration,
    /// Files that were read besides those that the description names: the pictures of indices of measurements.
    pub files: Vec<PathBuf>,
}

/// A material that was compiled: its index, and the opacity a mask gave it.
#[derive(Clone, Copy, Debug)]
struct ResolvedMaterial {
    id: u32,
    alpha: Option<FloatTexture>,
}

struct Compiler<'a> {
    desc: &'a SceneDesc,
    /// The point of the file's world that is the origin of the description.
    origin: DVec3,
    mode: ColorMode,
    options: &'a Options,
    diagnostics: Diagnostics,
    textures: Textures,
    texture_ids: HashMap<NodeId, TextureId>,
    assets: Assets,
    /// Files that were read and that the description does not name.
    files: Vec<PathBuf>,
    materials: Vec<Material>,
    /// True if a normal map of a material so far is in the space of the object.
    has_object_normals: bool,
    material_names: Vec<String>,
    material_ids: HashMap<NodeId, ResolvedMaterial>,
    media: Vec<Medium>,
    medium_ids: HashMap<NodeId, Option<u32>>,
    /// Materials and textures that are being compiled: one that is met again contains itself.
    open: HashSet<NodeId>,
    coats: Coats,
    /// Position of the camera, and the size of a pixel at distance one.
    eye: Option<(steradian_math::Vec3, f32)>,
    /// True if the geometry of shapes depends on the camera's position.
    depends_on_camera: bool,
    emitters: Vec<Emitter>,
    lights: Vec<Light>,
    light_groups: LightGroups,
    /// Numbers of lights without a name.
    unnamed_lights: HashMap<NodeId, usize>,
    /// Lights that are no part of shapes, with their groups.
    grouped: Vec<(u32, u32)>,
    /// Ambient lights.
    ambient: Vec<Ambient>,
    /// Backdrop of camera rays, in place of environments.
    backdrop: Option<Box<Environment>>,
    /// Lights that do not always shine, those of areas by their emitters.
    schedules: Vec<(Lamp, Schedule)>,
    geometries: Vec<Geometry>,
    /// Shapes of an earlier compilation, and those of this one for the next, where these are asked for.
    kept_shapes: Option<[HashMap<NodeId, KeptShape>; 2]>,
    kept_accel: Option<KeptAccel>,
}

/// Compiles a description.
pub fn compile(desc: &SceneDesc, options: &Options) -> Compiled {
    compiled(desc, options, None)
}

/// Compiles a description that has changed since: what an earlier compilation made is used where it was made from the
/// same, and what this one makes is kept for the next.
pub fn recompile(desc: &SceneDesc, options: &Options, kept: &mut Kept) -> Compiled {
    compiled(desc, options, Some(kept))
}

fn compiled(desc: &SceneDesc, options: &Options, mut kept: Option<&mut Kept>) -> Compiled {
    // A film that is not there is told of later.
    let film = desc.film.and_then(|film| desc.nodes.get(film.0 as usize));
    let has_bands = film.is_some_and(|film| film.kind == "spectral");
    let mode = options.mode.unwrap_or(match desc.format {
        Format::Pbrt => ColorMode::Spectral,
        _ if has_bands => ColorMode::Spectral,
        _ => ColorMode::Rgb,
    });
    let carried = steradian_scene::carried(desc);
    let (desc, told) = carried.as_ref().map_or((desc, [].as_slice()), |(desc, told)| (desc, told.as_slice()));
    let recentred = recentre::recentred(desc);
    let (origin, desc) = recentred.as_ref().map_or((DVec3::ZERO, desc), |(origin, desc)| (*origin, desc));
    let mut c = Compiler { origin, ..Compiler::new(desc, mode, options) };
    told.iter().for_each(|(id, what)| c.approximated(c.node(*id).span, what.clone()));
    if let Some(kept) = kept.as_deref_mut() {
        kept.refresh(desc, options);
        if let Some(compiled) = kept.for_another_view(&c) {
            return compiled;
        }
        c.assets = std::mem::take(&mut kept.assets);
        c.coats = kept.coats.of(mode).take().unwrap_or_else(|| Coats::new(mode));
        c.kept_shapes = Some([std::mem::take(&mut kept.shapes), HashMap::new()]);
        c.kept_accel = kept.accel.take();
    }
    let (scene, build_time) = c.run();
    let scene = scene.filter(|_| !c.diagnostics.has_errors());
    if let Some(kept) = kept {
        *kept.scenes.of(mode) = scene.as_ref().filter(|_| !c.depends_on_camera).map(|scene| KeptScene::new(&c, scene));
        *kept.coats.of(mode) = Some(c.coats);
        (kept.assets, kept.accel) = (c.assets, c.kept_accel);
        kept.shapes = c.kept_shapes.map(|[_, now]| now).unwrap_or_default();
    }
    Compiled { scene, diagnostics: c.diagnostics, build_time, files: c.files }
}

impl<'a> Compiler<'a> {
    fn new(desc: &'a SceneDesc, mode: ColorMode, options: &'a Options) -> Self {
        Self {
            desc,
            origin: DVec3::ZERO,
            mode,
            options,
            diagnostics: Diagnostics::default(),
            textures: Textures::new(mode),
            texture_ids: HashMap::new(),
            assets: Assets::default(),
            files: Vec::new(),
            materials: vec![Material::default_diffuse()],
            has_object_normals: false,
            material_names: vec!["default".into()],
            material_ids: HashMap::new(),
            media: Vec::new(),
            medium_ids: HashMap::new(),
            open: HashSet::new(),
            coats: Coats::new(mode),
            eye: None,
            depends_on_camera: false,
            emitters: Vec::new(),
            lights: Vec::new(),
            light_groups: LightGroups::default(),
            unnamed_lights: HashMap::new(),
            grouped: Vec::new(),
            ambient: Vec::new(),
            backdrop: None,
            schedules: Vec::new(),
            geometries: Vec::new(),
            kept_shapes: None,
            kept_accel: None,
        }
    }
}

impl Compiler<'_> {
    /// Checks the description; whether it can be compiled.
    fn is_sound(&mut self) -> bool {
        self.check_names();
        self.check_soundness();
        !self.diagnostics.has_errors()
    }

    /// Checks the description, and compiles film and camera, whose medium is left to the caller.
    fn view(&mut self) -> Option<(FilmSpec, Camera)> {
        if !self.is_sound() {
            return None;
        }
        let (film, camera) = (self.film(), self.camera());
        film.zip(camera)
    }

    fn run(&mut self) -> (Option<Scene>, Duration) {
        if !self.is_sound() {
            return (None, Duration::ZERO);
        }
        let film = self.film();
        let pixels = film.as_ref().map_or(0, |f| u64::from(f.crop.width()) * u64::from(f.crop.height()));
        self.load_images(pixels.saturating_mul(BYTES_PER_PIXEL));
        if self.diagnostics.has_errors() {
            return (None, Duration::ZERO);
        }
        let camera = self.camera().map(|camera| Camera { medium: self.camera_medium(), ..camera });
        if let (Some(camera), Some(film)) = (&camera, &film) {
            let pixel = (camera.window[1] - camera.window[0]).abs() / film.width.max(1) as f32;
            self.eye = Some((camera.world_from_camera.point(steradian_math::Vec3::ZERO), pixel));
        }
        let (method, settings) = (self.method(), self.settings());
        let world = self.shapes(&self.desc.shapes, true);
        let mut groups = Vec::new();
        let of_world = std::mem::take(&mut self.lights);
        let mut of_groups = Vec::new();
        for (group, is_kept_square) in self.desc.groups.iter().zip(self.kept_square()) {
            let base = self.geometries.len() as u32;
            groups.push((base, self.shapes(&group.shapes, is_kept_square)));
            of_groups.push(std::mem::take(&mut self.lights));
        }
        self.lights = of_world;
        for &light in &self.desc.lights {
            self.light(light);
        }
        let instances = self.instances(&groups);
        let first_lights = self.place_lights(&groups, &of_groups, &instances);
        let (Some(camera), Some(film)) = (camera, film) else { return (None, Duration::ZERO) };
        if self.diagnostics.has_errors() {
            return (None, Duration::ZERO);
        }
        let start = Instant::now();
        let accel = self.kept_hierarchy(&world, &groups, &instances);
        let build_time = start.elapsed();
        let Some(accel) = accel else { return (None, build_time) };
        let placement = |(i, first_light): (&steradian_accel::Instance, u32)| {
            let (base, group) = &groups[i.object as usize];
            let (count, motion) = (group.len() as u32, i.motion.clone());
            Placement { world_from_group: i.world_from_object, motion, base: *base, count, first_light }
        };
        let placements: Vec<Placement> = instances.iter().zip(first_lights).map(placement).collect();
        let textures = std::mem::take(&mut self.textures);
        let mut lights = Lights::new(std::mem::take(&mut self.lights), std::mem::take(&mut self.emitters), self.mode);
        lights.timetable = self.timetable(&lights);
        lights.ambient = std::mem::take(&mut self.ambient);
        lights.backdrop = self.backdrop.take();
        let mut light_groups = std::mem::take(&mut self.light_groups);
        light_groups.assign(&lights, &self.grouped);
        let glows = self.media.iter().any(|m| m.glow.is_some());
        if lights.lights.is_empty() && lights.emitters.is_empty() && lights.ambient.is_empty() && !glows {
            self.diagnostics.warn(&self.desc.sources, None, "the scene has no lights: the picture will be black");
        }
        let spp = self.options.spp.unwrap_or(settings.spp);
        self.tell_coarse();
        let parts = Parts {
            mode: self.mode,
            texture_pages: self.assets.pages.clone(),
            object_names: self.object_names(),
            light_groups,
            geometries: std::mem::take(&mut self.geometries),
            accel,
            placements,
            world_count: world.len() as u32,
            materials: std::mem::take(&mut self.materials),
            material_names: std::mem::take(&mut self.material_names),
            textures,
            lights,
            media: std::mem::take(&mut self.media),
            camera,
            film,
            method,
            settings,
            origin: self.origin,
            spp,
        };
        (Some(fluorescent::set_illuminants(Scene::new(parts))), build_time)
    }

    /// Names of objects, those of the file, or their kind with a number.
    fn object_names(&self) -> BTreeMap<u32, String> {
        let mut names = BTreeMap::new();
        let mut unnamed: HashMap<&str, u32> = HashMap::new();
        for geometry in &self.geometries {
            names.entry(geometry.id).or_insert_with(|| {
                let node = self.desc.node(NodeId(geometry.id - 1));
                node.name.clone().unwrap_or_else(|| {
                    let count = unnamed.entry(&node.kind).or_default();
                    *count += 1;
                    format!("{}_{count}", node.kind)
                })
            });
        }
        names
    }

    /// Per group: true if all its placements keep right angles.
    fn kept_square(&self) -> Vec<bool> {
        let keeps = |t: &steradian_math::Transform| t.affine().is_some_and(|place| place.similarity().is_some());
        let mut all = vec![true; self.desc.groups.len()];
        for i in &self.desc.instances {
            if let Some(group) = all.get_mut(i.group) {
                *group &= keeps(&i.world_from_group) && i.movement.is_none_or(|m| keeps(&m.end));
            }
        }
        all
    }

    fn instances(&mut self, groups: &[(u32, shapes::Boxes)]) -> Vec<steradian_accel::Instance> {
        let mut out = Vec::with_capacity(self.desc.instances.len());
        for instance in &self.desc.instances {
            let Some(world_from_object) = instance.world_from_group.affine() else {
                self.error(instance.span, "this instance's transform is singular or not finite");
                continue;
            };
            if instance.group >= groups.len() {
                self.error(instance.span, "this instance refers to a group that does not exist");
                continue;
            }
            let motion = instance.movement.and_then(|m| self.motion(instance.world_from_group, m, instance.span));
            let world_from_object = motion.as_ref().and_then(|m| m.at(0.0)).unwrap_or(world_from_object);
            let motion = motion.filter(|m| !m.is_still()).map(Arc::new);
            out.push(steradian_accel::Instance { object: instance.group as u32, world_from_object, motion });
        }
        out
    }

    /// The structure of the earlier compilation, if nothing in it has moved, or a new one.
    fn kept_hierarchy(
        &mut self,
        world: &shapes::Boxes,
        groups: &[(u32, shapes::Boxes)],
        instances: &[steradian_accel::Instance],
    ) -> Option<Arc<Accel>> {
        if self.kept_shapes.is_none() {
            return self.hierarchy(world, groups, instances).map(Arc::new);
        }
        let space = Space::new(&self.geometries, groups.iter().map(|g| g.0), &self.desc.instances);
        let accel = match self.kept_accel.as_ref().and_then(|kept| kept.over(&space)) {
            Some(accel) => accel,
            None => Arc::new(self.hierarchy(world, groups, instances)?),
        };
        self.kept_accel = Some(KeptAccel::new(space, accel.clone()));
        Some(accel)
    }

    fn hierarchy(
        &mut self,
        world: &shapes::Boxes,
        groups: &[(u32, shapes::Boxes)],
        instances: &[steradian_accel::Instance],
    ) -> Option<Accel> {
        let objects: Result<Vec<_>, _> = groups
            .iter()
            .map(|(base, boxes)| {
                let geometries = shapes::accel_geometries(&self.geometries, *base as usize, boxes);
                Object::build(self.options.accelerator, &geometries)
            })
            .collect();
        let world = shapes::accel_geometries(&self.geometries, 0, world);
        let spaces: Vec<_> = objects.iter().flatten().map(|o| o.bounds()).collect();
        for (instance, described) in instances.iter().zip(&self.desc.instances) {
            let bounds = spaces.get(instance.object as usize).filter(|b| !b.is_empty());
            if bounds.is_some_and(|b| (0..8).any(|i| !instance.world_from_object.point(b.corner(i)).is_finite())) {
                self.diagnostics.error(
                    &self.desc.sources,
                    described.span,
                    "this instance reaches beyond the range of numbers",
                );
                return None;
            }
        }
        match objects.and_then(|objects| Accel::build(self.options.accelerator, &world, objects, instances)) {
            Ok(accel) => Some(accel),
            Err(e) => {
                drop(world);
                self.error(None, e.to_string());
                None
            }
        }
    }

    fn error(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.diagnostics.error(&self.desc.sources, span, message);
    }

    fn error_help(&mut self, span: Option<Span>, message: impl Into<String>, help: Option<String>) {
        self.diagnostics.error_help(&self.desc.sources, span, message, help);
    }

    fn approximated(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.diagnostics.approximated(&self.desc.sources, span, message);
    }
}

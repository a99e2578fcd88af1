//! Scenes: read, edited, rendered.

use crate::{
    SceneError,
    convert::to_python,
    faults::{Models, Watch, models},
    frames::Frames,
    guard,
    image::Image,
    material::Material,
    mesh,
    message::{Message, error},
    own,
    parameter::{self, Parameter},
    parts::Parts,
    render::{self, Request},
    settings::{self, Settings},
    view::View,
};
use pyo3::{
    exceptions::{PyIOError, PyKeyError, PyValueError},
    prelude::*,
    sync::MutexExt,
    types::{PyBytes, PyDict},
};
use std::{
    collections::{BTreeMap, HashMap},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use steradian::{
    ColorMode, CompileOptions, Kept,
    formats::{Options, mesh::model::leave_out_ground, native, write},
    scene::{Diagnostics, Family, Node, NodeId, SceneDesc, Value},
};
use steradian_server::SettingsChange;

/// Files by their names.
type Files = Vec<(PathBuf, Vec<u8>)>;

/// Number of compilations of a scene kept: that of renders, and that of rays and materials.
const WAYS: usize = 2;

/// A scene as it is rendered, and what it was asked for with.
#[derive(Clone)]
pub struct Ready {
    key: String,
    pub scene: Arc<steradian::Scene>,
    /// Names of its models.
    pub models: Models,
    /// All files that it is made of.
    pub files: Arc<[PathBuf]>,
}

/// A scene: nodes with parameters, which may be read and set, and rendered again without reading files of
/// scenes and meshes anew. Threads may share it: what one does with it another one waits for, but for rendering.
#[pyclass(frozen, module = "steradian")]
pub struct Scene {
    options: Options,
    /// Name by which it was loaded.
    source: Option<PathBuf>,
    state: Mutex<State>,
}

/// Mutable state of a scene.
struct State {
    desc: Arc<SceneDesc>,
    /// True if it was changed since it was read.
    is_edited: bool,
    diagnostics: Diagnostics,
    ready: Vec<Ready>,
    /// State kept from the last compilation, which an edit leaves as it is for the most part.
    kept: Kept,
}

impl Scene {
    fn new((desc, diagnostics): (SceneDesc, Diagnostics), options: Options, strict: bool) -> PyResult<Self> {
        if diagnostics.has_errors() {
            return Err(error(&diagnostics));
        }
        if strict && diagnostics.is_lossy() {
            let lost = diagnostics.iter().filter(|d| d.fidelity.is_some());
            return Err(SceneError::new_err(lost.map(ToString::to_string).collect::<Vec<_>>().join("\n")));
        }
        Ok(Self::of(Arc::new(desc), diagnostics, options))
    }

    fn of(desc: Arc<SceneDesc>, diagnostics: Diagnostics, options: Options) -> Self {
        let state = State { desc, is_edited: false, diagnostics, ready: Vec::new(), kept: Kept::default() };
        Self { options, source: None, state: Mutex::new(state) }
    }

    /// The state, for this thread alone; the interpreter goes on while another one has it. It is whole even if that one
    /// panicked.
    fn state(&self, py: Python<'_>) -> MutexGuard<'_, State> {
        self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// The scene as it is rendered, compiled anew only where something changed.
    pub fn ready(&self, py: Python<'_>, settings: &Settings) -> PyResult<Ready> {
        let mut state = self.state(py);
        let own = state.desc.clone();
        state.desc = self.seen(&own, settings)?;
        let way = format!("{:?} {}", settings.look, settings.quality.transparent);
        let ready = state.ready(py, &settings.options, &way);
        state.desc = own;
        ready
    }

    /// The description with the camera where it is rendered from; without the ground that a model was given where the
    /// background is left out, unless the user asked for that ground.
    fn seen(&self, desc: &Arc<SceneDesc>, settings: &Settings) -> PyResult<Arc<SceneDesc>> {
        let mut seen = match &settings.look {
            Some(look) => look.place(desc, settings.options.camera.as_deref(), &self.options)?,
            None => desc.clone(),
        };
        if settings.quality.transparent && !self.options.defines.contains_key("ground") {
            leave_out_ground(Arc::make_mut(&mut seen));
        }
        Ok(seen)
    }

    /// Hash of the description as it is rendered, and of the contents of the files that it names.
    fn print(&self, py: Python<'_>, settings: Option<&Settings>) -> PyResult<[u8; 32]> {
        let mut desc = self.state(py).desc.clone();
        if let Some(settings) = settings {
            desc = self.seen(&desc, settings)?;
        }
        py.detach(|| steradian::resume::fingerprint(&desc)).map_err(|e| PyIOError::new_err(e.to_string()))
    }

    /// The scene for rays and materials, which need no camera.
    pub fn queried(&self, py: Python<'_>, mode: Option<ColorMode>) -> PyResult<Ready> {
        let mut state = self.state(py);
        let options = CompileOptions { mode, ..own::compiling() };
        if !state.desc.cameras.is_empty() {
            return state.ready(py, &options, "");
        }
        let own = state.desc.clone();
        let desc = Arc::make_mut(&mut state.desc);
        let camera = desc.add(Node::new(Family::Camera, "perspective", None));
        desc.cameras.push(camera);
        let ready = state.ready(py, &options, "");
        // A render of it lacks a camera as before.
        state.desc = own;
        ready
    }

    /// The file of a scene that has animations and is as it was read.
    fn animated(&self, py: Python<'_>) -> PyResult<&Path> {
        let fault = |what: &str| Err(PyValueError::new_err(what.to_owned()));
        let is_gltf = |path: &&PathBuf| {
            path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf") || e.eq_ignore_ascii_case("glb"))
        };
        let Some(path) = self.source.as_ref().filter(is_gltf) else {
            return fault("frames are of scenes with animations, which are loaded from .gltf and .glb files");
        };
        if self.options.defines.contains_key("at") {
            return fault(
                "frames name the moments of all pictures; the scene was loaded with a moment of its own, at=",
            );
        }
        if self.state(py).is_edited {
            return fault("frames are read anew from the file, without the changes that were made to the scene since");
        }
        Ok(path)
    }

    /// Looks at a node.
    pub fn look<T>(
        &self,
        py: Python<'_>,
        node: &str,
        look: impl FnOnce(&SceneDesc, NodeId) -> PyResult<T>,
    ) -> PyResult<T> {
        let state = self.state(py);
        look(&state.desc, state.find(node)?)
    }

    /// Changes a node, or what belongs to it; the next render has it.
    pub fn edit(
        &self,
        py: Python<'_>,
        node: &str,
        edit: impl FnOnce(&mut SceneDesc, NodeId) -> PyResult<()>,
    ) -> PyResult<()> {
        let mut state = self.state(py);
        let id = state.find(node)?;
        state.is_edited = true;
        edit(Arc::make_mut(&mut state.desc), id)?;
        state.ready.clear();
        Ok(())
    }
}

impl State {
    fn find(&self, node: &str) -> PyResult<NodeId> {
        let ids = native::ids(&self.desc);
        let found = ids.iter().position(|id| id == node);
        found.map(|i| NodeId(i as u32)).ok_or_else(|| {
            let hint = steradian::scene::names::did_you_mean(node, ids.iter().map(String::as_str));
            let hint = hint.map(|h| format!("; {h}")).unwrap_or_default();
            PyKeyError::new_err(format!("there is no node '{node}'{hint}"))
        })
    }

    /// The scene as it is rendered from a place, which tells compilations apart.
    fn ready(&mut self, py: Python<'_>, options: &CompileOptions, place: &str) -> PyResult<Ready> {
        let key = format!("{options:?} {} {place}", self.desc.cameras.len());
        if let Some(at) = self.ready.iter().position(|r| r.key == key) {
            self.ready[..=at].rotate_right(1);
            return Ok(self.ready[0].clone());
        }
        self.ready.truncate(WAYS - 1);
        let Self { desc, kept, .. } = self;
        let models = models(desc);
        let faults = Watch::begin(&models);
        let compiled = py.detach(|| steradian::recompile(desc, options, kept));
        faults.fault()?;
        let Some(scene) = compiled.scene else { return Err(error(&compiled.diagnostics)) };
        // Those of a repeated compilation are kept once.
        self.diagnostics.extend(compiled.diagnostics);
        let files = desc.files().map(PathBuf::from).chain(compiled.files).collect();
        let ready = Ready { key, scene: Arc::new(scene), models, files };
        self.ready.insert(0, ready.clone());
        Ok(ready)
    }
}

#[pymethods]
impl Scene {
    /// Reads a file, or `builtin:NAME`.
    #[staticmethod]
    #[pyo3(signature = (path, *, defines = BTreeMap::new(), search = Vec::new(), strict = false))]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        defines: BTreeMap<String, String>,
        search: Vec<PathBuf>,
        strict: bool,
    ) -> PyResult<Self> {
        let options = Options { defines, search, ..own::reading() };
        let loaded = py.detach(|| steradian::load(&path, &options));
        Ok(Self { source: Some(path), ..Self::new((loaded.desc, loaded.diagnostics), options, strict)? })
    }

    /// Boxes that automatic cameras show at moments of an animation, seconds, all of them together, for
    /// [`Scene::moment`]; refuses scenes without animations.
    fn framing(&self, py: Python<'_>, moments: Vec<f64>) -> PyResult<Option<[[f64; 3]; 2]>> {
        let path = self.animated(py)?;
        let found = py.detach(|| steradian::load::framing(path, &self.options, &moments));
        Ok(found.map(|corners| corners.map(|corner| corner.to_array())))
    }

    /// The scene at a moment of its animation, seconds, read anew.
    #[pyo3(signature = (seconds, framing = None))]
    fn moment(&self, py: Python<'_>, seconds: f64, framing: Option<[[f64; 3]; 2]>) -> PyResult<Self> {
        let path = self.animated(py)?;
        let mut options = Options { framing: framing.map(|box_| box_.map(Into::into)), ..self.options.clone() };
        options.defines.insert("at".into(), seconds.to_string());
        let loaded = py.detach(|| steradian::load(path, &options));
        Self::new((loaded.desc, loaded.diagnostics), options, false)
    }

    /// Reads a document in Steradian's own language, with meshes and files that are in memory, by their names in it.
    #[staticmethod]
    #[pyo3(signature = (text, *, meshes = Vec::new(), files = HashMap::new(), path = "dictionary".into(),
        search = Vec::new(), strict = false))]
    fn describe(
        py: Python<'_>,
        text: String,
        meshes: Vec<(String, Bound<'_, PyDict>)>,
        files: HashMap<String, Vec<u8>>,
        path: PathBuf,
        search: Vec<PathBuf>,
        strict: bool,
    ) -> PyResult<Self> {
        let options = Options { search, ..own::reading() };
        let mesh = |(name, arrays): (String, Bound<'_, PyDict>)| Ok((name, mesh::from_arrays(&arrays)?));
        let meshes = meshes.into_iter().map(mesh).collect::<PyResult<_>>()?;
        let given = native::Given { meshes, files };
        let read = py.detach(|| native::import_with(&path, text.into_bytes(), given, &options));
        Self::new((read.desc, read.diagnostics), options, strict)
    }

    /// A scene of its own that is as this one.
    fn copy(&self, py: Python<'_>) -> Self {
        let state = self.state(py);
        let copy = Self::of(state.desc.clone(), state.diagnostics.clone(), self.options.clone());
        let state =
            State { is_edited: state.is_edited, ..copy.state.into_inner().unwrap_or_else(PoisonError::into_inner) };
        Self { source: self.source.clone(), state: Mutex::new(state), ..copy }
    }

    /// Path of the scene's file, and the folders that are searched for others.
    fn origin(&self, py: Python<'_>) -> (Option<PathBuf>, Vec<PathBuf>) {
        (self.state(py).desc.path.clone(), self.options.search.clone())
    }

    /// Reads a text in a format (`pbrt`, `xml`, `obj`, `ply`, `gltf`, `steradian`), by default what it looks like.
    #[staticmethod]
    #[pyo3(signature = (text, *, format = None, name = "text", search = Vec::new(), strict = false))]
    fn parse(
        py: Python<'_>,
        text: &str,
        format: Option<&str>,
        name: &str,
        search: Vec<PathBuf>,
        strict: bool,
    ) -> PyResult<Self> {
        let options = Options { search, ..own::reading() };
        let bytes = text.as_bytes().to_vec();
        let loaded = py.detach(|| steradian::load_bytes(name, bytes, format, &options));
        Self::new((loaded.desc, loaded.diagnostics), options, strict)
    }

    /// Everything that reading and compiling had to say so far.
    #[getter]
    fn messages(&self, py: Python<'_>) -> Vec<Message> {
        self.state(py).diagnostics.iter().map(Message::from).collect()
    }

    /// Families and kinds of all nodes by their names; a node without a name of its own has one that begins with '#'.
    #[getter]
    fn nodes(&self, py: Python<'_>) -> Vec<(String, (String, String))> {
        let desc = &self.state(py).desc;
        let ids = native::ids(desc);
        let family = |n: &Node| n.family.noun().split(' ').next().unwrap_or_default().to_owned();
        ids.into_iter().zip(&desc.nodes).map(|(id, n)| (id, (family(n), n.kind.clone()))).collect()
    }

    /// The names of the cameras.
    #[getter]
    fn cameras(&self, py: Python<'_>) -> Vec<String> {
        let desc = &self.state(py).desc;
        let ids = native::ids(desc);
        desc.cameras.iter().map(|id| ids[id.0 as usize].clone()).collect()
    }

    /// The names of the parameters that a node sets.
    fn parameters(&self, py: Python<'_>, node: &str) -> PyResult<Vec<String>> {
        let state = self.state(py);
        let id = state.find(node)?;
        Ok(state.desc.node(id).params.iter().map(|p| p.name.clone()).collect())
    }

    /// All that can be set of all nodes, family by family as the schema has it.
    fn params(&self, py: Python<'_>) -> PyResult<Vec<Parameter>> {
        let desc = &self.state(py).desc;
        let ids = native::ids(desc);
        let of = |(node, id): (&Node, &String)| parameter::all_of(py, &ids, node, id);
        let all = desc.nodes.iter().zip(&ids).map(of).collect::<PyResult<Vec<_>>>()?;
        Ok(all.into_iter().flatten().collect())
    }

    /// The value of a node's parameter; `None` where it is not set.
    fn get<'py>(&self, py: Python<'py>, node: &str, parameter: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let state = self.state(py);
        let id = state.find(node)?;
        let ids = native::ids(&state.desc);
        state.desc.node(id).get(parameter).map(|value| to_python(py, value, &ids)).transpose()
    }

    /// Sets a parameter to a value in Steradian's own language; `null` takes it away.
    fn set_text(&self, py: Python<'_>, node: &str, parameter: &str, value: &str) -> PyResult<()> {
        self.edit(py, node, |desc, id| {
            native::set(desc, id, parameter, value, &self.options).map_err(|diagnostics| error(&diagnostics))
        })
    }

    /// The scene in Steradian's own language, for a file at `path`; with what goes beside it by name.
    fn text(&self, py: Python<'_>, path: PathBuf) -> PyResult<(String, Files)> {
        let desc = self.state(py).desc.clone();
        let written = py.detach(|| native::write(&desc, &path)).map_err(PyValueError::new_err)?;
        Ok((written.text, written.files))
    }

    /// Writes the scene in the format of the extension, and what goes beside it, whole or not at all; gives what was
    /// approximated or left out.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn save(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<Vec<Message>> {
        let desc = self.state(py).desc.clone();
        let written = py.detach(|| write::write(&desc, &path)).map_err(PyValueError::new_err)?;
        if written.diagnostics.has_errors() {
            return Err(error(&written.diagnostics));
        }
        if !overwrite {
            guard::claim(&path, desc.files())?;
        }
        let write = || steradian::image::write_together(&path, &written.bytes, &written.files);
        py.detach(write).map_err(|e| PyIOError::new_err(e.to_string()))?;
        Ok(written.diagnostics.iter().map(Message::from).collect())
    }

    /// A material by its name, to be evaluated.
    #[pyo3(signature = (name, *, color = "auto"))]
    fn material(&self, py: Python<'_>, name: &str, color: &str) -> PyResult<Material> {
        let mode = settings::color(color)?;
        let Ready { scene, models, .. } = self.queried(py, mode)?;
        Material::named(scene, models, name)
    }

    /// Renders the scene. Ctrl-C ends it, and the picture of the samples that there are is returned.
    #[pyo3(signature = (settings, progress = None, *, resume = None, before = None))]
    fn render(
        &self,
        py: Python<'_>,
        settings: &Settings,
        progress: Option<Py<PyAny>>,
        resume: Option<PathBuf>,
        before: Option<&Frames>,
    ) -> PyResult<Image> {
        let resume = resume.map(|path| Ok::<_, PyErr>((path, self.print(py, Some(settings))?))).transpose()?;
        let Ready { scene, models, files, .. } = self.ready(py, settings)?;
        if let Some((path, _)) = &resume {
            let kept = [path.clone(), steradian::resume::before(path)];
            kept.iter().try_for_each(|path| guard::claim(path, files.iter().map(PathBuf::as_path)))?;
        }
        let progress = progress.as_ref();
        render::run(py, &Request { scene: &scene, files: &files, models: &models, settings, progress, resume, before })
    }

    /// A render in parts, of a scene with that fingerprint.
    fn parts(&self, py: Python<'_>, settings: &Settings, fingerprint: [u8; 32]) -> PyResult<Parts> {
        let Ready { scene, models, files, .. } = self.ready(py, settings)?;
        Parts::new(py, &scene, (&files, &models), settings, fingerprint)
    }

    /// Hash of the description, and of the contents of the files that it names.
    fn fingerprint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.print(py, None)?))
    }

    /// The description in bytes, as it is but for texts of files that were read, and the files that nodes name, by
    /// names that hold in any folder.
    fn packed<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyBytes>, Vec<PathBuf>)> {
        let mut desc = SceneDesc::clone(&self.state(py).desc);
        let SceneDesc { nodes, embedded, .. } = &mut desc;
        let mut files = Vec::new();
        for param in nodes.iter_mut().flat_map(|node| &mut node.params) {
            if let Value::Path(path) = &mut param.value
                && !path.as_os_str().is_empty()
                && !embedded.contains_key(path)
            {
                *path = std::path::absolute(&*path)?;
                files.push(path.clone());
            }
        }
        let bytes = py
            .detach(|| postcard::to_extend(&desc, Vec::new()))
            .map_err(|e| PyValueError::new_err(format!("the scene cannot be packed: {e}")))?;
        Ok((PyBytes::new(py, &bytes), files))
    }

    /// The scene that was [packed](Self::packed) by the same version.
    #[staticmethod]
    fn unpacked(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let desc = py
            .detach(|| postcard::from_bytes::<SceneDesc>(bytes))
            .map_err(|e| PyValueError::new_err(format!("the bytes are no scene that this version packed: {e}")))?;
        Ok(Self::of(Arc::new(desc), Diagnostics::default(), own::reading()))
    }

    /// Shows the scene, as it is now, in a page of a server on this machine.
    #[pyo3(signature = (*, integrator = None, spp = None, size = None, denoise = None, bind = "127.0.0.1".into(),
        port = 0))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn view(
        &self,
        py: Python<'_>,
        integrator: Option<String>,
        spp: Option<u32>,
        size: Option<(u32, u32)>,
        denoise: Option<&str>,
        bind: String,
        port: u16,
    ) -> PyResult<View> {
        let denoise = match denoise {
            Some("off") => Some(None),
            name => name.map(|name| crate::denoise::Denoiser::named(name).map(|d| Some(d.into()))).transpose()?,
        };
        let (width, height) = size.unzip();
        let spp = spp.map(Some);
        let settings = SettingsChange { integrator, spp, width, height, denoise, ..SettingsChange::default() };
        let desc = self.state(py).desc.clone();
        View::start(py, desc, self.options.clone(), (settings, bind, port))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let d = &self.state(py).desc;
        let (shapes, nodes, lights) = (d.shapes.len(), d.nodes.len(), d.lights.len());
        format!("<steradian.Scene: {nodes} nodes, {shapes} shapes, {} faces, {lights} lights>", d.face_count())
    }
}

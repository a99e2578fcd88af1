//! Opening a scene: reading, compiling, and telling what there is to tell.

use crate::{
    args::{Color, SceneOptions},
    diagnostics::{self, Counts},
    failure::Failure,
    memory,
    terminal::Terminal,
    values::{Rectangle, Size},
};
use std::{
    borrow::Cow,
    io::{self, Read},
    path::Path,
    sync::Arc,
    time::Duration,
};
use steradian::{
    Accelerator, ColorMode, CompileOptions, Inputs, Loaded, LoadedScene, Scene,
    formats::Options,
    math::DVec3,
    scene::{Diagnostic, Diagnostics, Family, Node, SceneDesc, Severity},
};

/// Most bytes that are read from standard input, of which nobody tells how much is to come.
const MOST_OF_STDIN: u64 = 1 << 30;

/// Name of standard input.
pub const STDIN: &str = "standard input";

/// Options of compiling from the command line, for a number of samples per pixel if it is known already.
pub fn compile_options(options: &SceneOptions, spp: Option<u32>) -> CompileOptions {
    CompileOptions {
        mode: match options.color {
            Color::Auto => None,
            Color::Rgb => Some(ColorMode::Rgb),
            Color::Spectral => Some(ColorMode::Spectral),
        },
        size: options.size.map(|Size(w, h)| (w, h)),
        crop: options.crop.map(|Rectangle(r)| r),
        camera: options.camera.clone(),
        accelerator: Accelerator::by_name(&options.accelerator).unwrap_or_default(),
        texture_limit: options.texture_limit,
        stochastic_textures: options.stochastic_textures,
        sensor_noise: options.sensor_noise,
        spp,
        memory: memory::available(),
        ..CompileOptions::default()
    }
}

/// Reads and compiles a scene, for a number of samples per pixel if it is known already.
pub fn open(name: &Path, options: &SceneOptions, spp: Option<u32>) -> LoadedScene {
    options.memory_limit.into_iter().for_each(memory::limit);
    opened(load(name, options.format.as_deref(), &reading(&options.define, options.framing)), options, spp)
}

/// Reads and compiles a scene whose camera shows nothing to anybody; it may have none.
pub fn open_unseen(name: &Path, options: &SceneOptions) -> LoadedScene {
    opened(load_unseen(name, options), options, None)
}

/// Reads a scene whose camera shows nothing to anybody, and gives it one if it has none.
pub fn load_unseen(name: &Path, options: &SceneOptions) -> Loaded {
    options.memory_limit.into_iter().for_each(memory::limit);
    let mut loaded = load(name, options.format.as_deref(), &reading(&options.define, options.framing));
    if loaded.desc.cameras.is_empty() && options.camera.is_none() {
        let camera = loaded.desc.add(Node::new(Family::Camera, "perspective", None));
        loaded.desc.cameras.push(camera);
    }
    loaded
}

/// Compiles a scene that was read.
pub fn opened(mut loaded: Loaded, options: &SceneOptions, spp: Option<u32>) -> LoadedScene {
    if let Some(view) = options.look_at
        && let Some(camera) = loaded.desc.camera(options.camera.as_deref())
        && !view.place(&mut loaded.desc, camera)
    {
        let message = "--look-at cannot move the camera, whose own transform is singular";
        loaded.diagnostics.error(&loaded.desc.sources, None, message);
    }
    loaded.compile(&compile_options(options, spp))
}

/// True for names of glTF files.
pub fn is_gltf(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf") || e.eq_ignore_ascii_case("glb"))
}

/// True for names of models, which have no camera of their own.
pub fn is_model(path: &Path) -> bool {
    let is = |known: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(known));
    ["obj", "ply", "stl", "bpt"].into_iter().any(is)
}

/// True for names of USD stages.
fn is_usd(path: &Path) -> bool {
    let is = |known: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(known));
    ["usd", "usda", "usdc", "usdz", "mtlx"].into_iter().any(is)
}

/// Definitions by which a model comes as its file has it: without a ground, its axes as they are.
pub fn bare(path: &Path) -> Vec<(String, String)> {
    let ground = (is_model(path) || is_gltf(path) || is_usd(path)).then_some(("ground", "false"));
    let up = is_model(path).then_some(("up", "y"));
    ground.into_iter().chain(up).map(|(name, value)| (name.into(), value.into())).collect()
}

/// Name of a scene in messages and files.
pub fn shown(name: &Path) -> Cow<'_, str> {
    if is_stdin(name) { STDIN.into() } else { name.to_string_lossy() }
}

/// True if a scene is read from standard input.
pub fn is_stdin(name: &Path) -> bool {
    name.as_os_str() == "-"
}

/// True for scenes that are files.
pub fn is_file(scene: &Path) -> bool {
    !scene.to_str().is_some_and(|name| name.starts_with("builtin:")) && !is_stdin(scene)
}

/// Options of reading scenes, with definitions of the user's, and the box that automatic cameras show.
pub fn reading(define: &[(String, String)], framing: Option<[DVec3; 2]>) -> Options {
    let mut reading = Options { defines: define.iter().cloned().collect(), framing, ..Options::default() };
    reading.limits.memory = Some(memory::available);
    reading
}

/// Reads a scene of a file, or of standard input in a format.
pub fn load(name: &Path, format: Option<&str>, reading: &Options) -> Loaded {
    if is_stdin(name) { from_stdin(format, reading) } else { steradian::load(name, reading) }
}

fn from_stdin(format: Option<&str>, reading: &Options) -> Loaded {
    let read = read_at_most(&mut io::stdin().lock(), MOST_OF_STDIN);
    let refused = |e: io::Error| {
        let mut diagnostics = Diagnostics::default();
        diagnostics.error(&Default::default(), None, format!("cannot read {STDIN}: {e}"));
        Loaded { desc: SceneDesc::default(), diagnostics, time: Duration::ZERO }
    };
    read.map_or_else(refused, |bytes| steradian::load_bytes(STDIN, bytes, format, reading))
}

/// Everything that comes, if it is not too much.
fn read_at_most(from: &mut impl Read, most: u64) -> io::Result<Vec<u8>> {
    let (mut bytes, mut piece) = (Vec::new(), vec![0; 1 << 20]);
    loop {
        let count = match from.read(&mut piece) {
            Ok(0) => return Ok(bytes),
            Ok(count) => count,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(e),
        };
        if (bytes.len() + count) as u64 > most {
            let what = format!("it holds more than {most} bytes, the most that is read from there; give a file");
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
        }
        bytes.try_reserve(count)?;
        bytes.extend_from_slice(&piece[..count]);
    }
}

/// Tells the messages and gives the scene, if it can be rendered.
///
/// # Errors
/// Errors among the messages, or losses with `--strict`.
pub fn ready(mut opened: LoadedScene, name: &Path, strict: bool, terminal: Terminal) -> Result<Ready, Failure> {
    if strict {
        opened.diagnostics = diagnostics::refuse_losses(&opened.diagnostics);
    }
    diagnostics::tell(&opened.diagnostics, terminal);
    let (counts, inputs) = (Counts::of(&opened.diagnostics), opened.inputs());
    match opened.scene {
        Some(scene) if !opened.diagnostics.has_errors() => {
            Ok(Ready { scene: Arc::new(scene), inputs, counts, load: opened.load, build: opened.build })
        }
        _ => {
            let is_located = |d: &Diagnostic| d.severity == Severity::Error && d.location.is_some();
            let name = shown(name);
            let message = match opened.diagnostics.error_count() {
                // A single error with its place has said everything.
                1 if opened.diagnostics.iter().any(is_located) => String::new(),
                1 => format!("'{name}' has 1 error"),
                n => format!("'{name}' has {n} errors"),
            };
            Err(Failure::bad_input(message))
        }
    }
}

/// A scene that can be rendered; its description is gone, to leave the memory to the render.
#[derive(Debug)]
pub struct Ready {
    /// The scene.
    pub scene: Arc<Scene>,
    /// All files that were read.
    pub inputs: Inputs,
    /// Number of messages of each kind.
    pub counts: Counts,
    /// Time of reading files.
    pub load: Duration,
    /// Time of building the hierarchy.
    pub build: Duration,
}

/// Lets everything that runs in parallel, loading too, run on so many threads (0: one per processor).
pub fn limit_threads(threads: u16) {
    // Fails only when a pool is there already, and nothing has started one before.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_without_end_is_refused() {
        let endless = read_at_most(&mut io::repeat(0), 5 << 20).unwrap_err();
        assert!(endless.to_string().starts_with("it holds more than 5242880 bytes"), "{endless}");
        assert_eq!(read_at_most(&mut &[7; 5][..], 5).unwrap(), [7; 5]);
    }
}

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
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};
use steradian::{
    Accelerator, ColorMode, CompileOptions, Inputs, Loaded, Scene,
    formats::Options,
    image::tone::Tone,
    math::DVec3,
    scene::{Diagnostic, Diagnostics, Family, Node, SceneDesc, Severity},
};

/// Most bytes that are read from standard input, of which nobody tells how much is to come.
const MOST_OF_STDIN: u64 = 1 << 30;

/// What standard input is called.
pub const STDIN: &str = "standard input";

/// A scene that was opened, with or without success.
#[derive(Debug)]
pub struct Opened {
    /// As it was read.
    pub desc: SceneDesc,
    /// As it is rendered; `None` where there are errors.
    pub scene: Option<Scene>,
    /// Everything there is to say.
    pub diagnostics: Diagnostics,
    /// Files that were read and that the description does not name.
    files: Vec<PathBuf>,
    /// Time of reading files.
    pub load: Duration,
    /// Time of making what is rendered, the hierarchy among it.
    pub build: Duration,
}

/// What the command line says about compiling, for a number of samples per pixel if it is known already.
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
        spp,
        memory: memory::available(),
        ..CompileOptions::default()
    }
}

/// Reads and compiles a scene, for a number of samples per pixel if it is known already.
pub fn open(name: &Path, options: &SceneOptions, spp: Option<u32>) -> Opened {
    opened(load(name, options.format.as_deref(), &reading(&options.define, options.framing)), options, spp)
}

/// Reads and compiles a scene whose camera shows nothing to anybody; it may have none.
pub fn open_unseen(name: &Path, options: &SceneOptions) -> Opened {
    let mut loaded = load(name, options.format.as_deref(), &reading(&options.define, options.framing));
    if loaded.desc.cameras.is_empty() && options.camera.is_none() {
        let camera = loaded.desc.add(Node::new(Family::Camera, "perspective", None));
        loaded.desc.cameras.push(camera);
    }
    opened(loaded, options, None)
}

fn opened(loaded: Loaded, options: &SceneOptions, spp: Option<u32>) -> Opened {
    let (mut desc, mut diagnostics) = (loaded.desc, loaded.diagnostics);
    if let Some(view) = options.look_at
        && let Some(camera) = desc.camera(options.camera.as_deref())
        && !view.place(&mut desc, camera)
    {
        diagnostics.error(&desc.sources, None, "--look-at cannot move the camera, whose own transform is singular");
    }
    let (files, load) = (Vec::new(), loaded.time);
    let mut opened = Opened { desc, scene: None, diagnostics, files, load, build: Duration::ZERO };
    if opened.diagnostics.has_errors() {
        return opened;
    }
    // Whatever compiling does besides the hierarchy is loading: images are read there.
    let start = std::time::Instant::now();
    let compiled = steradian::compile(&opened.desc, &compile_options(options, spp));
    opened.load += start.elapsed().saturating_sub(compiled.build_time);
    opened.build = compiled.build_time;
    opened.diagnostics.extend(compiled.diagnostics);
    opened.files = compiled.files;
    opened.scene = compiled.scene;
    opened
}

impl Opened {
    /// All files that were read.
    pub fn inputs(&self) -> Inputs {
        Inputs::of(self.desc.files().chain(self.files.iter().map(PathBuf::as_path)))
    }

    /// The tone curve that suits the scene.
    pub fn tone(&self) -> Tone {
        Tone::parse(steradian::load::suited_tone(self.desc.format)).unwrap_or_default()
    }
}

/// What a scene is called in messages and files.
pub fn shown(name: &Path) -> Cow<'_, str> {
    if is_stdin(name) { STDIN.into() } else { name.to_string_lossy() }
}

/// Whether a scene is read from standard input.
pub fn is_stdin(name: &Path) -> bool {
    name.as_os_str() == "-"
}

/// How scenes are read, with definitions of the user's, and the box that automatic cameras show.
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

impl Opened {
    /// Tells the messages and gives the scene, if it can be rendered.
    ///
    /// # Errors
    /// Where there are errors among the messages, or losses when these are refused.
    pub fn into_scene(mut self, name: &Path, strict: bool, terminal: Terminal) -> Result<Ready, Failure> {
        if strict {
            self.diagnostics = diagnostics::refuse_losses(&self.diagnostics);
        }
        diagnostics::tell(&self.diagnostics, terminal);
        let (counts, inputs) = (Counts::of(&self.diagnostics), self.inputs());
        match self.scene {
            Some(scene) if !self.diagnostics.has_errors() => {
                Ok(Ready { scene: Arc::new(scene), inputs, counts, load: self.load, build: self.build })
            }
            _ => {
                let is_located = |d: &Diagnostic| d.severity == Severity::Error && d.location.is_some();
                let name = shown(name);
                let message = match self.diagnostics.error_count() {
                    // A single error with its place has said everything.
                    1 if self.diagnostics.iter().any(is_located) => String::new(),
                    1 => format!("'{name}' has 1 error"),
                    n => format!("'{name}' has {n} errors"),
                };
                Err(Failure::bad_input(message))
            }
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
    /// How many messages of each kind there were.
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

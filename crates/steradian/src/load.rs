//! Opening scenes of any format.

use crate::{
    CompileOptions, Error, Inputs, Scene,
    archive::{self, UnpackedScene},
    compile, cornell,
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
    time::Instant,
};
pub use steradian_formats::readers::extensions;
use steradian_formats::{Import, Options, Reader};
use steradian_image::tone::Tone;
use steradian_math::DVec3;
use steradian_scene::{
    Diagnostic, Diagnostics, Format, SceneDesc, Severity, Unpacked,
    names::{did_you_mean, nearest},
};

/// A scene as it was read.
#[derive(Debug)]
pub struct Loaded {
    /// The description; complete where there are no errors.
    pub desc: SceneDesc,
    /// Diagnostics of the reader.
    pub diagnostics: Diagnostics,
    /// Time spent reading.
    pub time: Duration,
}

/// A scene that was read and compiled, with or without success.
#[derive(Debug)]
pub struct LoadedScene {
    /// The description as it was read.
    pub desc: SceneDesc,
    /// The scene as it is rendered; `None` where there are errors.
    pub scene: Option<Scene>,
    /// Messages of reader and compiler.
    pub diagnostics: Diagnostics,
    /// Files that were read and that the description does not name.
    pub files: Vec<PathBuf>,
    /// Time spent reading files, images among them.
    pub load: Duration,
    /// Time spent building the hierarchy.
    pub build: Duration,
}

impl Loaded {
    /// Compiles the scene, unless it has errors.
    pub fn compile(self, options: &CompileOptions) -> LoadedScene {
        let Self { desc, diagnostics, time } = self;
        let (files, load, build) = (Vec::new(), time, Duration::ZERO);
        let mut loaded = LoadedScene { desc, scene: None, diagnostics, files, load, build };
        if loaded.diagnostics.has_errors() {
            return loaded;
        }
        // All of compiling but the hierarchy is loading: images are read there.
        let start = Instant::now();
        let compiled = compile(&loaded.desc, options);
        loaded.load += start.elapsed().saturating_sub(compiled.build_time);
        loaded.build = compiled.build_time;
        loaded.diagnostics.extend(compiled.diagnostics);
        loaded.files = compiled.files;
        loaded.scene = compiled.scene.filter(|_| !loaded.diagnostics.has_errors());
        loaded
    }
}

impl LoadedScene {
    /// All files that were read.
    pub fn inputs(&self) -> Inputs {
        Inputs::of(self.desc.files().chain(self.files.iter().map(PathBuf::as_path)))
    }

    /// The tone curve that suits the scene.
    pub fn tone(&self) -> Tone {
        Tone::parse(suited_tone(self.desc.format)).unwrap_or_default()
    }
}

/// The tone curve that suits scenes of a format: models are lit so that no colour burns out with this one.
pub fn suited_tone(format: Format) -> &'static str {
    match format {
        Format::Model | Format::Gltf => "pbr-neutral",
        _ => "none",
    }
}

/// Reads a scene. `builtin:NAME` names one of the built-in scenes ([`cornell::BUILTIN`]); other names are files, told
/// apart by extension; of a zip archive ([`archive`]) its scene, or `ARCHIVE.zip/NAME`.
pub fn load(name: impl AsRef<Path>, options: &Options) -> Loaded {
    let start = Instant::now();
    let import = read(name.as_ref(), options);
    Loaded { desc: import.desc, diagnostics: import.diagnostics, time: start.elapsed() }
}

/// The box that a camera shows in all of some moments (seconds), for [`Options::framing`]; `None` where the scene has a
/// camera of its own, or cannot be read as of a moment.
pub fn framing(path: &Path, options: &Options, moments: &[f64]) -> Option<[DVec3; 2]> {
    let boxes = moments.iter().map(|seconds| {
        let mut options = options.clone();
        options.defines.insert("at".into(), seconds.to_string());
        steradian_formats::gltf::framed_box(path, &options)
    });
    boxes.reduce(|a, b| a.zip(b).map(|(a, b)| [a[0].min(b[0]), a[1].max(b[1])])).flatten()
}

/// Reads and compiles a scene as its file has it, and what there is to say of that: what is approximated, dropped, or
/// without effect.
///
/// # Errors
/// [`Error::Scene`] with all messages, where it has errors.
pub fn open(name: impl AsRef<Path>) -> Result<(Arc<Scene>, Diagnostics), Error> {
    let LoadedScene { scene, diagnostics, .. } = load(name, &Options::default()).compile(&CompileOptions::default());
    match scene {
        Some(scene) => Ok((Arc::new(scene), diagnostics)),
        None => Err(Error::Scene(diagnostics)),
    }
}

/// Reads a scene from memory, plain or gzip-compressed. Files that it names are looked for in the current folder;
/// `name` stands for it in messages. Its format is one of [`extensions`], by default what its beginning looks like.
pub fn load_bytes(name: &str, bytes: Vec<u8>, format: Option<&str>, options: &Options) -> Loaded {
    let start = Instant::now();
    let path = Path::new(name);
    let import = match steradian_formats::files::inflated(path, bytes, &options.limits) {
        Ok(bytes) => {
            let reader = match format {
                Some(format) => Reader::of_extension(&format.to_ascii_lowercase()),
                None => Some(Reader::of_bytes(&bytes)),
            };
            match reader {
                Some(reader) => {
                    with_definitions_told(reader.import_bytes(path, bytes, options), reader.definitions, options)
                }
                None => unknown(name),
            }
        }
        Err(e) => failed(e.to_string(), None),
    };
    Loaded { desc: import.desc, diagnostics: import.diagnostics, time: start.elapsed() }
}

fn read(path: &Path, options: &Options) -> Import {
    let name = path.to_string_lossy();
    if let Some(builtin) = name.strip_prefix("builtin:") {
        return match cornell::builtin(builtin) {
            Some(desc) => {
                with_definitions_told(Import { desc, diagnostics: Diagnostics::default() }, Some(&[]), options)
            }
            None => {
                let known = cornell::BUILTIN.iter().map(|b| b.0).collect::<Vec<_>>().join(", ");
                failed(format!("there is no built-in scene '{builtin}'"), Some(format!("built in are {known}")))
            }
        };
    }
    if let Some((archive, name)) = archive::split(path) {
        return match archive::unpack(archive, name) {
            Ok(UnpackedScene { folder, scene }) => {
                let mut import = read(&scene, options);
                import.desc.unpacked = Some(Unpacked(Arc::new(folder)));
                import
            }
            Err(why) => failed(format!("'{}' {why}", archive.display()), None),
        };
    }
    if !path.exists() {
        let help = near(path).map(|found| format!("did you mean '{}'?", found.display()));
        let help = help.unwrap_or_else(|| "a scene that is always there: builtin:cornell-box".into());
        return failed(format!("cannot find the scene '{name}'"), Some(help));
    }
    if path.is_dir() {
        return failed(format!("'{name}' is a folder; give the scene file in it"), None);
    }
    let lower = name.to_ascii_lowercase();
    let stem = lower.strip_suffix(".gz").unwrap_or(&lower);
    let format = Path::new(stem).extension().and_then(|e| e.to_str()).unwrap_or_default();
    match Reader::of_extension(format) {
        Some(reader) => with_definitions_told(reader.import(path, options), reader.definitions, options),
        None => unknown(&name),
    }
}

/// Most files of a folder that a name is compared with.
const COMPARED: usize = 4096;

/// The scene file of a folder whose name is nearest to that of one that is not there: the same name with an extension,
/// or one that is spelt almost alike.
fn near(path: &Path) -> Option<PathBuf> {
    let folder = path.parent()?;
    let looked_in = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let is_scene = |name: &String| {
        let extension = Path::new(name.strip_suffix(".gz").unwrap_or(name)).extension().and_then(|e| e.to_str());
        extension.is_some_and(|e| extensions().any(|known| known.0.eq_ignore_ascii_case(e)))
    };
    let entries = std::fs::read_dir(looked_in).ok()?.take(COMPARED).flatten();
    let mut names: Vec<String> = entries.filter_map(|e| e.file_name().into_string().ok()).filter(is_scene).collect();
    names.sort();
    let wanted = path.file_name()?.to_str()?;
    let found = nearest(wanted, names.iter().map(String::as_str))?;
    Some(folder.join(found))
}

/// Tells the definitions (`-D name=value`) that nothing uses. Mitsuba's reader, which alone knows the names that a file
/// asks for, does so itself.
fn with_definitions_told(mut import: Import, known: Option<&[&str]>, options: &Options) -> Import {
    let Some(known) = known else { return import };
    if import.diagnostics.has_errors() {
        return import;
    }
    for name in options.defines.keys() {
        let is_known = known.contains(&name.as_str());
        let (message, help) = match name.as_str() {
            "animation" if is_known && !options.defines.contains_key("at") => (
                "'animation' chooses what moves, and has no effect without a moment, -D at=SECONDS".to_owned(),
                Some("the scene stands as in the document".to_owned()),
            ),
            _ if is_known => continue,
            _ if known.is_empty() => (format!("nothing in this scene is set by -D, so '{name}' has no effect"), None),
            _ => {
                let list = known.join("', '");
                let hint = did_you_mean(name, known.iter().copied());
                (format!("-D sets nothing called '{name}' here"), hint.or(Some(format!("there are '{list}'"))))
            }
        };
        import.diagnostics.unused(&import.desc.sources, None, message, help);
    }
    import
}

fn unknown(name: &str) -> Import {
    let known = extensions().map(|e| format!(".{}", e.0)).collect::<Vec<_>>().join(", ");
    let extension = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let help = match steradian_image::FileKind::from_extension(Path::new(name)) {
        _ if matches!(extension.as_str(), "3mf" | "off" | "step" | "stp") => {
            format!("save it as .ply or .obj (MeshLab, Blender and CAD programs do); known are {known}")
        }
        _ if matches!(extension.as_str(), "fbx" | "blend" | "dae" | "abc") => {
            format!("save it as .glb, with its materials (Blender: File, Export, glTF 2.0); known are {known}")
        }
        Some(_) => "it is a picture, which `steradian info`, compare, convert and signal read".into(),
        None => format!("known are {known}"),
    };
    failed(format!("'{name}' is not a kind of scene that can be read"), Some(help))
}

fn failed(message: String, help: Option<String>) -> Import {
    let mut import = Import::default();
    import.diagnostics.push(Diagnostic { severity: Severity::Error, fidelity: None, message, location: None, help });
    import
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_scene::Fidelity;

    /// Definitions of a user that nothing uses are told, whatever the format.
    #[test]
    fn definitions_without_effect_are_told() {
        let xml = "<scene version='3.0.0'><sensor type='perspective'/></scene>";
        let gltf = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "animations": []}"#;
        let (obj, pbrt) = ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "Camera \"perspective\" WorldBegin");
        for (text, defined, about) in [
            (obj, "gruond", "did you mean 'ground'?"),
            (obj, "at", "'at'"),
            (gltf, "gruond", "did you mean 'ground'?"),
            (gltf, "foo", "'foo'"),
            (gltf, "animation", "-D at=SECONDS"),
            (pbrt, "ground", "'ground'"),
            (xml, "foo", "'foo'"),
            ("steradian: 1", "foo", "'foo'"),
        ] {
            let said = |defines: &[&str]| {
                let defines = defines.iter().map(|name| ((*name).to_owned(), "true".to_owned())).collect();
                let options = Options { defines, ..Options::default() };
                let loaded = load_bytes("text", text.as_bytes().to_vec(), None, &options);
                let unused = loaded.diagnostics.iter().filter(|d| d.fidelity == Some(Fidelity::Unused));
                unused.map(ToString::to_string).collect::<Vec<_>>().join("\n")
            };
            assert_eq!(said(&[]), "", "{text}");
            assert!(said(&[defined]).contains(about), "{text} -D {defined}: {}", said(&[defined]));
        }
        for (name, about) in [("part.STEP", "save it as .ply or .obj"), ("scene.fbx", "save it as .glb")] {
            assert!(unknown(name).diagnostics.iter().any(|d| d.to_string().contains(about)), "{name}");
        }
        let options = Options { defines: [("foo".into(), "1".into())].into(), ..Options::default() };
        assert_eq!(load("builtin:cornell-box", &options).diagnostics.iter().count(), 1);
    }
}

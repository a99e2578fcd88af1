//! The files a render is written to: which, whether they can be, and what they carry.

use crate::{failure::Failure, film};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use steradian::{
    Inputs, Scene,
    formats::write::Written,
    image::{self, FileKind, Image, Value, Window, WriteOptions},
    integrators::Doubt,
    scene::names,
};

/// Extensions of pictures that can be written.
const WRITTEN: &str = ".exr .png .hdr .pfm .ppm .jpg .dds .ktx2";

/// The kind of picture that a name's extension stands for.
///
/// # Errors
/// [`Failure`] for names that stand for nothing that can be written.
pub fn kind(path: &Path) -> Result<FileKind, Failure> {
    let refuse = |why: String| Failure::bad_input(format!("'{}' {why}; known are {WRITTEN}", path.display()));
    match FileKind::from_extension(path) {
        Some(FileKind::Tga | FileKind::Bmp | FileKind::WebP) => {
            Err(refuse("is of a kind that can be read, but not written".into()))
        }
        Some(kind) => Ok(kind),
        None if film::kind(path).is_some() => Err(refuse("is a film, which --frames and --turntable make".into())),
        None => {
            let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
            let known = WRITTEN.split(' ').map(|e| e.trim_start_matches('.'));
            let hint = names::did_you_mean(&extension, known).map(|h| format!(" ({h})")).unwrap_or_default();
            Err(refuse(format!("has no extension that names a kind of picture{hint}")))
        }
    }
}

/// The files that a render of `scene` is written to when none are given: in the current folder, named after the scene.
pub fn default_names(scene: &Path) -> Vec<PathBuf> {
    let file = match scene.to_str().and_then(|name| name.strip_prefix("builtin:")) {
        Some(builtin) => Path::new(builtin),
        None => Path::new(scene.file_name().filter(|name| *name != "-").unwrap_or("scene".as_ref())),
    };
    let is_packed = file.extension().is_some_and(|e| e == "gz");
    let file = Path::new(if is_packed { file.file_stem() } else { file.file_name() }.unwrap_or("scene".as_ref()));
    // What stands before the last dot is the stem, and may have dots of its own.
    let stem = file.file_stem().unwrap_or("scene".as_ref());
    let named = |extension: &str| {
        let mut name = stem.to_owned();
        name.push(extension);
        PathBuf::from(name)
    };
    vec![named(".exr"), named(".png")]
}

/// Default names that none of `inputs` has: `a.png` steps aside to `a.render.png`, and so do those beside it.
pub fn free_names(names: Vec<PathBuf>, inputs: &Inputs) -> Vec<PathBuf> {
    let mut free = names.clone();
    for attempt in 1.. {
        if !free.iter().any(|name| inputs.find(name).is_some()) {
            break;
        }
        let word = if attempt == 1 { "render".into() } else { format!("render{attempt}") };
        free = names.iter().map(|name| marked(name, &word)).collect();
    }
    free
}

/// The name that a picture has beside an older one, where it is not whole.
pub fn partial(path: &Path) -> PathBuf {
    marked(path, "partial")
}

/// A name with a word before its extension: `a.part.exr`.
fn marked(path: &Path, word: &str) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!(".{word}"));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// The guard of every command that writes files: refuses outputs that are files which are read, whatever they are
/// called, that are one file under two names, or that cannot be written. To be asked before anything takes long, and
/// again when all files that are read are known.
///
/// # Errors
/// [`Failure`] naming the first of them.
pub fn claim<'a>(outputs: impl IntoIterator<Item = &'a Path>, inputs: &Inputs) -> Result<(), Failure> {
    let mut claimed = Inputs::default();
    for output in outputs {
        if let Some(input) = inputs.find(output) {
            let (output, input) = (output.display(), input.display());
            return Err(Failure::bad_input(format!(
                "'{output}' is a file that is read here ('{input}') and would be overwritten; give another name"
            )));
        }
        // Devices and pipes take several outputs one after the other.
        let is_stream = std::fs::metadata(output).is_ok_and(|there| !there.is_file() && !there.is_dir());
        if let Some(other) = claimed.add(output).filter(|_| !is_stream) {
            let (output, other) = (output.display(), other.display());
            return Err(Failure::bad_input(format!(
                "'{output}' and '{other}' are one file, and one output would overwrite the other; give each its own name"
            )));
        }
        check_writable(output)?;
    }
    Ok(())
}

/// Writes a scene with the files beside it, where these are no outputs, nor these inputs.
///
/// # Errors
/// [`Failure`] naming the file.
pub fn save_scene<'a>(
    path: &Path,
    written: &Written,
    outputs: impl IntoIterator<Item = &'a Path>,
    mut inputs: Inputs,
) -> Result<(), Failure> {
    // Files beside the document are named by their content: to write them again changes nothing.
    let folder = path.parent().unwrap_or(Path::new(""));
    for (name, _) in &written.files {
        inputs.add(&folder.join(name));
    }
    claim(outputs, &inputs)?;
    image::write_together(path, &written.bytes, &written.files).map_err(|e| Failure::failed(e.to_string()))
}

/// Finds out now, not after hours, that a file cannot be written.
fn check_writable(path: &Path) -> Result<(), Failure> {
    let refuse = |why: &str| Err(Failure::failed(format!("cannot write '{}': {why}", path.display())));
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => refuse("it is a folder"),
        Ok(there) if there.is_file() && there.permissions().readonly() => refuse("it is read-only"),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound && !folder.exists() => {
            refuse(&format!("there is no folder '{}'", folder.display()))
        }
        _ => image::check_place(path).map_err(|e| Failure::failed(e.to_string())),
    }
}

/// Finds out now that a picture is too large for a format.
///
/// # Errors
/// [`Failure`] naming the file.
pub fn check_size(path: &Path, kind: FileKind, (width, height): (u32, u32)) -> Result<(), Failure> {
    if kind == FileKind::Jpeg && width.max(height) > 65535 {
        let why = format!(
            "cannot write '{}': a JPEG file holds at most 65535 pixels a side, not {width}x{height}",
            path.display()
        );
        return Err(Failure::bad_input(why));
    }
    Ok(())
}

/// Provenance of a picture, for its metadata.
#[derive(Debug)]
pub struct Provenance<'a> {
    /// Scene as named on the command line.
    pub scene: &'a str,
    /// Integrator by name.
    pub integrator: &'a str,
    /// Mean samples per pixel.
    pub spp: f64,
    /// The seed.
    pub seed: u64,
    /// Wall time of rendering, seconds.
    pub seconds: f64,
    /// Samples that were not finite.
    pub nonfinite: u64,
    /// `rgb` or `spectral`.
    pub color: &'a str,
    /// Estimated relative error.
    pub error: Option<f64>,
    /// Why that is not to be trusted.
    pub doubt: Option<Doubt>,
    /// True if parts of the picture that err more got more samples.
    pub adaptive: bool,
    /// True if photons told where light comes from behind mirrors and glass.
    pub caustics: bool,
    /// Number of paths that shared what they found.
    pub sharing: u32,
    /// Estimated relative errors of means over squares of pixels, by their edges.
    pub of_means: Option<&'a BTreeMap<u32, f64>>,
}

/// Writes into the picture how it was made and, where it is a part of its frame, which part.
pub fn label(picture: &mut Image, scene: &Scene, provenance: &Provenance<'_>) {
    let crop = scene.film().crop;
    let frame = (scene.film().width, scene.film().height);
    if (crop.width(), crop.height()) != frame {
        picture.offset = [crop.x0 as i32, crop.y0 as i32];
        picture.frame = Some(Window { min: [0, 0], max: [frame.0 as i32, frame.1 as i32] });
    }
    // No folder: a picture that is passed on does not tell where it was made.
    let file = Path::new(provenance.scene).file_name().map_or(provenance.scene.into(), |n| n.to_string_lossy());
    let integer = |v: u64| i32::try_from(v).map_or_else(|_| Value::Text(v.to_string()), Value::Int);
    let whole = provenance.spp.fract() == 0.0 && provenance.spp < f64::from(i32::MAX);
    let samples = if whole { Value::Int(provenance.spp as i32) } else { Value::Float(provenance.spp as f32) };
    let m = &mut picture.metadata;
    m.set_text("Software", concat!("Steradian ", env!("CARGO_PKG_VERSION")));
    m.set_text("steradian:scene", file);
    m.set_text("steradian:integrator", provenance.integrator);
    m.set_text("steradian:color", provenance.color);
    m.set("samplesPerPixel", samples);
    m.set_text("steradian:sampling", if provenance.adaptive { "adaptive" } else { "even" });
    m.set_text("steradian:caustics", if provenance.caustics { "photons" } else { "chance" });
    if let Some(error) = provenance.error {
        m.set("steradian:relative_error", Value::Float(error as f32));
    }
    if let Some(doubt) = provenance.doubt {
        m.set_text("steradian:unreliable", doubt.to_string());
    }
    m.set("steradian:sharing", integer(provenance.sharing.into()));
    // What a mean over n x n pixels errs, over what it would if pixels erred independently: the root of its variance is
    // that of the mean of the `variance` layer over n², times this.
    if let Some((errors, alone)) = provenance.of_means.and_then(|e| Some((e, e.get(&1).filter(|e| **e > 0.0)?))) {
        for (edge, error) in errors.iter().filter(|(edge, _)| **edge > 1) {
            let name = format!("steradian:error_scale_{edge}x{edge}");
            m.set(&name, Value::Float((error * f64::from(*edge) / alone) as f32));
        }
    }
    m.set("steradian:seed", integer(provenance.seed));
    m.set("renderTimeSeconds", Value::Float(provenance.seconds as f32));
    m.set("steradian:nonfinite_dropped", integer(provenance.nonfinite));
}

/// Writes all files, those after one that fails too; gives the names they have. A picture that is not whole, since some
/// pixels have no sample, leaves older files alone and is written beside them.
///
/// # Errors
/// [`Failure`] that lists the files that could not be written, and says where the picture was kept instead.
pub fn save(
    paths: &[PathBuf],
    picture: &Image,
    options: &WriteOptions,
    is_whole: bool,
) -> Result<Vec<PathBuf>, Failure> {
    let (mut written, mut faults) = (Vec::new(), Vec::new());
    for path in paths {
        let replaces = std::fs::metadata(path).is_ok_and(|there| there.is_file() && there.len() > 0);
        let path = if is_whole || !replaces { path.clone() } else { partial(path) };
        match image::write(&path, picture, options) {
            Ok(()) => written.push(path),
            Err(e) => faults.push(e.to_string()),
        }
    }
    if faults.is_empty() {
        return Ok(written);
    }
    // One file with all there is to it is enough to make the others from.
    let whole = written.iter().find(|path| FileKind::from_extension(path) == Some(FileKind::Exr));
    faults.push(match whole.cloned().or_else(|| rescue(picture, options)) {
        Some(kept) => {
            format!("the picture is kept in '{0}': 'steradian convert {0} OUT' goes on from it", kept.display())
        }
        None => "and the picture could not be kept among the temporary files either".into(),
    });
    Err(Failure::failed(faults.join("\n")))
}

/// A message about values that files of halves among `paths` do not keep.
pub fn clamped(paths: &[PathBuf], picture: &Image, options: &WriteOptions) -> Option<String> {
    let has_exr = paths.iter().any(|path| FileKind::from_extension(path) == Some(FileKind::Exr));
    let is_half = has_exr && options.exr_precision == image::Precision::Half;
    let count = if is_half { image::clamped_to_half(picture) } else { 0 };
    (count > 0).then(|| {
        format!("{count} values are beyond the range of halves and are clamped to 65504; --exr float keeps them")
    })
}

/// Writes a picture that has no other place among the temporary files.
fn rescue(picture: &Image, options: &WriteOptions) -> Option<PathBuf> {
    let file = tempfile::Builder::new().prefix("steradian-").suffix(".exr").tempfile().ok()?;
    image::write(file.path(), picture, options).ok()?;
    file.into_temp_path().keep().ok()
}

/// The paths in a list.
pub fn listed(paths: &[PathBuf]) -> String {
    paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_the_scene() {
        let of = |scene: &str| listed(&default_names(Path::new(scene)));
        assert_eq!(of("builtin:cornell-box"), "cornell-box.exr, cornell-box.png");
        assert_eq!(of("/a/b.c/scene-v4.pbrt.gz"), "scene-v4.exr, scene-v4.png");
        assert_eq!(of("x/room.night.xml"), "room.night.exr, room.night.png");
        assert_eq!(of(".."), "scene.exr, scene.png");
        assert_eq!(of("-"), "scene.exr, scene.png");
    }

    #[test]
    fn default_names_step_aside() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let names = vec![at("spot.exr"), at("spot.png")];
        let free = |inputs: &[&str]| {
            let inputs: Vec<PathBuf> = inputs.iter().map(|name| at(name)).collect();
            listed(&free_names(names.clone(), &Inputs::of(inputs.iter().map(PathBuf::as_path))))
        };
        let both = |word: &str| listed(&[at(&format!("spot{word}.exr")), at(&format!("spot{word}.png"))]);
        assert_eq!(free(&["spot.obj"]), both(""));
        assert_eq!(free(&["spot.png"]), both(".render"));
        assert_eq!(free(&["spot.png", "spot.render.exr"]), both(".render2"));
    }

    #[test]
    fn what_is_not_whole_goes_beside_older_files() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let picture = Image::from_rgb(1, 1, &[[0.5; 3]]).unwrap();
        let save = |is_whole| save(&[at("a.exr")], &picture, &WriteOptions::default(), is_whole).unwrap();
        assert_eq!(save(false), [at("a.exr")]);
        std::fs::write(at("a.exr"), b"older").unwrap();
        assert_eq!(save(false), [at("a.partial.exr")]);
        assert_eq!(std::fs::read(at("a.exr")).unwrap(), b"older");
        assert_eq!(save(true), [at("a.exr")]);
        assert_ne!(std::fs::read(at("a.exr")).unwrap(), b"older");
    }

    #[test]
    fn a_picture_that_cannot_be_written_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let picture = Image::from_rgb(1, 1, &[[0.5; 3]]).unwrap();
        let save = |names: &[&str]| {
            let paths: Vec<PathBuf> = names.iter().map(|name| at(name)).collect();
            save(&paths, &picture, &WriteOptions::default(), true).unwrap_err().message
        };
        assert!(save(&["no/a.png", "b.exr"]).contains("b.exr OUT"));
        let message = save(&["no/a.exr"]);
        let kept = PathBuf::from(message.split('\'').nth(1).unwrap());
        assert_eq!(
            image::read(&kept, &image::Limits::default()).unwrap().channel("R"),
            picture.channel("R"),
            "{message}"
        );
        std::fs::remove_file(kept).unwrap();
    }

    #[test]
    fn only_what_can_be_written_is_accepted() {
        for good in ["a.exr", "a.PNG", "a.jpeg", "a.ppm", "b/a.hdr", "a.pfm"] {
            assert!(kind(Path::new(good)).is_ok(), "{good}");
        }
        for bad in ["a", "a.tga", "a.bmp", "a.gif", ".exr", "a.exr/"] {
            let refused = kind(Path::new(bad));
            assert_eq!(refused.is_err(), bad != "a.exr/", "{bad}: {refused:?}");
        }
    }

    #[test]
    fn folders_must_exist() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_writable(&folder.path().join("a.exr")).is_ok());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
        assert!(check_writable(&folder.path().join("no/a.exr")).is_err());
        assert!(check_writable(folder.path()).is_err());
    }
}

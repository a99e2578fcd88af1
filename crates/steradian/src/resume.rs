//! Renders that are left and gone on with later: the state of a session in a file.
//!
//! A file has the program's version, a fingerprint of the scene, the settings on which the picture's bits depend, the
//! session, and the BLAKE3 hash of all that. Only a render that would have made the same picture goes on from it.
//! The state of a part of the work is one like others, with the pieces among its settings; parts are joined.

mod kept;

pub use kept::{before, source};

use crate::{CompileOptions, Render, Scene, Session, hashing::Hashing};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    fs::File,
    io::{self, BufReader, BufWriter, Cursor, ErrorKind, Read, Seek, Write},
    ops::Range,
    path::{Path, PathBuf},
};
use steradian_film::LayerInputs;
use steradian_image::open_regular;
use steradian_scene::{Node, SceneDesc, Value};

const MAGIC: &[u8; 16] = b"Steradian state6";
const VERSION: &str = env!("CARGO_PKG_VERSION");
const HASH: u64 = blake3::OUT_LEN as u64;
/// Longest text of the settings, bytes.
const LONGEST: u32 = 1 << 16;
/// The setting that [`samples`] tells.
const SAMPLES: &str = "samples per pixel";
/// The setting that tells which pieces of the work were computed ([`Session::pieces`]): `0..3 of 7`, or all of them.
const PIECES: &str = "pieces";
const ALL: &str = "all";
/// Settings of more bytes are not printed.
const READABLE: usize = 60;
/// Settings of more bytes, such as the curves of a film's bands, are kept as their BLAKE3 hash.
const BRIEF: usize = 2048;

/// Reason why a saved state cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// The system's answer.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Something else is in the file.
    #[error("is no saved state of a render")]
    NotAState,
    /// The file's contents are not those that were written.
    #[error("is damaged: its contents do not match their checksum")]
    Damaged,
    /// Another version wrote it.
    #[error("was saved by version {0}; this is {VERSION}")]
    OtherVersion(String),
    /// The scene has changed, or it is another one.
    #[error("belongs to another scene, or the scene's files have changed since")]
    OtherScene,
    /// The settings have changed.
    #[error("was saved with other settings: {0}")]
    OtherSettings(String),
    /// A part is to be joined that was left.
    #[error("is a part that is not finished")]
    Unfinished,
    /// A part is to be joined whose pieces are there.
    #[error("has pieces that were joined already: {} to {}", .0.start, .0.end - 1)]
    Joined(Range<u32>),
}

/// Description of a state file by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateFile {
    /// Version of the program that saved it: this one.
    pub version: String,
    /// The [`fingerprint`] of the scene, in hexadecimal digits.
    pub scene: String,
    /// Settings on which the picture's bits depend, by name.
    pub settings: BTreeMap<String, String>,
    /// The pieces of the work that were computed and the number of all; `None` for a render of all of them.
    pub pieces: Option<(Range<u32>, u32)>,
    /// True if the session was done.
    pub is_finished: bool,
}

/// Reads a state file's description of itself; its contents match their checksum then. No scene is loaded.
///
/// # Errors
/// Why the file is of no use.
pub fn state_file(path: &Path) -> Result<StateFile, StateError> {
    let saved = Saved::open(path)?;
    let pieces = saved.pieces()?;
    let Saved { scene, settings, is_finished, .. } = saved;
    let scene = digits(scene);
    Ok(StateFile { version: VERSION.into(), scene, settings, pieces, is_finished })
}

/// Everything that decides about the bits of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recipe {
    scene: [u8; blake3::OUT_LEN],
    settings: BTreeMap<String, String>,
}

/// The fingerprint of a description and of the contents of the files that it names, wherever they lie.
///
/// # Errors
/// Those of reading; files that are not there count as empty.
pub fn fingerprint(desc: &SceneDesc) -> io::Result<[u8; blake3::OUT_LEN]> {
    fingerprint_of(desc, (&desc.cameras, desc.film, desc.filter, desc.sampler, desc.integrator), |_| true)
}

/// The fingerprint of what is placed in a scene, of its lights, of `more`, and of those nodes that count.
pub(crate) fn fingerprint_of(
    desc: &SceneDesc,
    more: impl serde::Serialize,
    counts: impl Fn(&Node) -> bool,
) -> io::Result<[u8; blake3::OUT_LEN]> {
    let mut hasher = blake3::Hasher::new();
    // All but where it was read.
    let placed = (&desc.meshes, &desc.shapes, &desc.groups, &desc.instances);
    let nodes: Vec<Cow<'_, Node>> = desc.nodes.iter().filter(|node| counts(node)).map(without_folders).collect();
    let mut out = BufWriter::new(&mut hasher);
    serde_json::to_writer(&mut out, &(desc.format, &nodes, placed, &desc.lights, more))?;
    out.flush()?;
    drop(out);
    for param in desc.nodes.iter().filter(|node| counts(node)).flat_map(|node| &node.params) {
        let Value::Path(path) = &param.value else { continue };
        if let Ok((file, _)) = open_regular(path) {
            hasher.update_reader(file)?;
        }
        hasher.update(&[0]);
    }
    Ok(*hasher.finalize().as_bytes())
}

/// A node that names its files without their folders, in which they lie elsewhere on another machine.
fn without_folders(node: &Node) -> Cow<'_, Node> {
    let mut node = Cow::Borrowed(node);
    for at in 0..node.params.len() {
        if let Value::Path(path) = &node.params[at].value {
            let name = path.file_name().map(PathBuf::from).unwrap_or_default();
            node.to_mut().params[at].value = Value::Path(name);
        }
    }
    node
}

/// The samples per pixel of the plan by which a state was saved. A render that is to have more of them begins with this
/// number, and is [extended](Session::extend) when it has been restored.
///
/// # Errors
/// Why the file is of no use.
pub fn samples(path: &Path) -> Result<u32, StateError> {
    Saved::open(path)?
        .settings
        .get(SAMPLES)
        .and_then(|samples| samples.parse().ok())
        .filter(|samples| *samples > 0)
        .ok_or(StateError::Damaged)
}

/// A state whose contents match their checksum, in a file or in memory.
struct Saved<R> {
    /// Reader at the beginning of the session.
    from: R,
    scene: [u8; blake3::OUT_LEN],
    settings: BTreeMap<String, String>,
    /// True if the session was done.
    is_finished: bool,
    /// Offset of the checksum, bytes.
    end: u64,
}

impl Saved<BufReader<File>> {
    fn open(path: &Path) -> Result<Self, StateError> {
        let (file, length) = open_regular(path)?;
        Self::read(BufReader::new(file), length)
    }
}

impl<R: Read + Seek> Saved<R> {
    /// A state of so many bytes.
    fn read(mut from: R, length: u64) -> Result<Self, StateError> {
        let mut magic = [0; MAGIC.len()];
        if length < MAGIC.len() as u64 + HASH || from.read_exact(&mut magic).is_err() || magic != *MAGIC {
            return Err(StateError::NotAState);
        }
        let version = read_text(&mut from).ok_or(StateError::Damaged)?;
        if version != VERSION {
            return Err(StateError::OtherVersion(version.chars().filter(|c| !c.is_control()).take(READABLE).collect()));
        }
        let start = from.stream_position()?;
        let end = length - HASH;
        // The whole of it, before anything is believed.
        from.rewind()?;
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(from.by_ref().take(end))?;
        let mut hash = [0; blake3::OUT_LEN];
        from.read_exact(&mut hash)?;
        if hasher.finalize() != hash {
            return Err(StateError::Damaged);
        }
        from.seek(io::SeekFrom::Start(start))?;
        let mut scene = [0; blake3::OUT_LEN];
        from.read_exact(&mut scene)?;
        let settings = read_text(&mut from).ok_or(StateError::Damaged)?;
        let settings = serde_json::from_str(&settings).map_err(|_| StateError::Damaged)?;
        let mut flag = [0];
        from.read_exact(&mut flag)?;
        Ok(Self { from, scene, settings, is_finished: flag != [0], end })
    }

    /// The pieces that were computed and the number of all; `None` where these are all.
    fn pieces(&self) -> Result<Option<(Range<u32>, u32)>, StateError> {
        let text = self.settings.get(PIECES).ok_or(StateError::Damaged)?;
        if text == ALL {
            return Ok(None);
        }
        let numbers = text.split_once(" of ").and_then(|(range, of)| Some((range.split_once("..")?, of)));
        let number = |text: &str| text.parse::<u32>().map_err(|_| StateError::Damaged);
        let ((start, end), of) = numbers.ok_or(StateError::Damaged)?;
        let (start, end, of) = (number(start)?, number(end)?, number(of)?);
        if start < end && end <= of { Ok(Some((start..end, of))) } else { Err(StateError::Damaged) }
    }

    /// Refuses a state that a render of this recipe cannot have saved.
    fn check(&self, recipe: &Recipe) -> Result<(), StateError> {
        if let Some(difference) = recipe.difference(&self.settings) {
            return Err(StateError::OtherSettings(difference));
        }
        if self.scene == recipe.scene { Ok(()) } else { Err(StateError::OtherScene) }
    }

    /// Nothing may follow on what the session has read.
    fn at_end(&mut self) -> Result<(), StateError> {
        if self.from.stream_position()? == self.end { Ok(()) } else { Err(StateError::Damaged) }
    }
}

impl Recipe {
    /// Recipe of a scene with the [`fingerprint`] of its description, as it was compiled, rendered by a plan.
    pub fn new(scene: &Scene, fingerprint: [u8; blake3::OUT_LEN], options: &CompileOptions, render: &Render) -> Self {
        let (film, Render { name, method, plan, .. }) = (scene.film(), render);
        // Not threads, memory, or structures, which change no bit.
        let settings = [
            ("integrator", format!("{name} {method:?}")),
            ("sampler", format!("{:?}", plan.sampler.kind)),
            (SAMPLES, plan.sampler.spp.to_string()),
            ("seed", plan.sampler.seed.to_string()),
            ("layers", format!("{} {}", plan.has(LayerInputs::FIRST_HITS), plan.has(LayerInputs::SEEN_THROUGH))),
            ("mattes", plan.has(LayerInputs::MATTES).to_string()),
            ("bounces", plan.has(LayerInputs::BOUNCES).to_string()),
            ("light groups", plan.has(LayerInputs::LIGHT_GROUPS).to_string()),
            ("bands", plan.has(LayerInputs::BANDS).to_string()),
            ("halves", plan.has(LayerInputs::HALVES).to_string()),
            ("transparent background", plan.transparent.to_string()),
            ("adaptive", plan.adaptive.to_string()),
            ("error", format!("{:?}", plan.error)),
            ("size", format!("{} x {}", film.width, film.height)),
            ("film", format!("{film:?}")),
            ("camera", format!("{:?}", scene.camera())),
            ("colour", format!("{:?}", scene.mode())),
            ("stochastic textures", options.stochastic_textures.to_string()),
            (PIECES, ALL.into()),
        ];
        let brief = |value: String| match value.len() {
            ..=BRIEF => value,
            _ => blake3::hash(value.as_bytes()).to_string(),
        };
        Self { scene: fingerprint, settings: settings.map(|(name, value)| (name.to_owned(), brief(value))).into() }
    }

    /// The fingerprint of the scene, in hexadecimal digits.
    pub fn scene(&self) -> String {
        digits(self.scene)
    }

    /// Recipe of a session that is [restricted](Session::restrict) to some of so many pieces.
    #[must_use]
    pub fn of_pieces(mut self, pieces: &Range<u32>, of: u32) -> Self {
        let text = if *pieces == (0..of) { ALL.into() } else { format!("{}..{} of {of}", pieces.start, pieces.end) };
        self.settings.insert(PIECES.into(), text);
        self
    }

    /// Saves a session to a file, which appears whole or not at all.
    ///
    /// # Errors
    /// The path and the system's answer.
    pub fn save(&self, session: &mut dyn Session, path: &Path) -> Result<(), steradian_image::Error> {
        steradian_image::stream_whole(path, |out| self.write(session, out))
    }

    /// Writes what a [saved](Self::save) file has.
    ///
    /// # Errors
    /// Faults of the writer, and of sessions that miss pieces.
    pub fn write(&self, session: &mut dyn Session, out: &mut dyn Write) -> io::Result<()> {
        let mut out = BufWriter::new(Hashing::new(out));
        out.write_all(MAGIC)?;
        text(&mut out, VERSION)?;
        out.write_all(&self.scene)?;
        text(&mut out, &serde_json::to_string(&self.settings)?)?;
        out.write_all(&[session.is_done().into()])?;
        session.save(&mut out)?;
        let Hashing { inner, hasher } = out.into_inner().map_err(|failed| failed.into_error())?;
        inner.write_all(hasher.finalize().as_bytes())
    }

    /// Lets a new session go on from a file.
    ///
    /// # Errors
    /// Why it cannot; the session is of no use then.
    pub fn restore(&self, session: &mut dyn Session, path: &Path) -> Result<(), StateError> {
        let mut saved = Saved::open(path)?;
        saved.check(self)?;
        session.restore(&mut saved.from).map_err(|_| StateError::Damaged)?;
        saved.at_end()
    }

    /// Joins the part in a file to a new session of the whole, or to one that other parts were [joined](Session::join)
    /// to; the pieces that it has.
    ///
    /// # Errors
    /// Why it cannot; the session is of no use after [`StateError::Damaged`].
    pub fn join(&self, session: &mut dyn Session, path: &Path) -> Result<Range<u32>, StateError> {
        self.join_saved(session, Saved::open(path)?)
    }

    /// Joins a part that was [written](Self::write) into memory, as [`Self::join`].
    ///
    /// # Errors
    /// As of [`Self::join`].
    pub fn join_bytes(&self, session: &mut dyn Session, part: &[u8]) -> Result<Range<u32>, StateError> {
        self.join_saved(session, Saved::read(Cursor::new(part), part.len() as u64)?)
    }

    fn join_saved<R: Read + Seek>(
        &self,
        session: &mut dyn Session,
        mut saved: Saved<R>,
    ) -> Result<Range<u32>, StateError> {
        let here = session.pieces().map_err(|why| StateError::OtherSettings(format!("not in pieces: {why}")))?;
        let (pieces, of) = saved.pieces()?.unwrap_or((0..here, here));
        saved.check(&self.clone().of_pieces(&pieces, of))?;
        if of != here {
            return Err(StateError::Damaged);
        }
        if !saved.is_finished {
            return Err(StateError::Unfinished);
        }
        session.join(&mut saved.from, pieces.clone()).map_err(|e| match e.kind() {
            ErrorKind::AlreadyExists => StateError::Joined(pieces.clone()),
            _ => StateError::Damaged,
        })?;
        saved.at_end()?;
        Ok(pieces)
    }

    /// The first setting that is another one.
    fn difference(&self, theirs: &BTreeMap<String, String>) -> Option<String> {
        let (name, ours) = self.settings.iter().find(|(name, ours)| theirs.get(*name) != Some(ours))?;
        Some(match theirs.get(name) {
            Some(theirs) if theirs.len().max(ours.len()) <= READABLE => format!("{name} {theirs}, not {ours}"),
            _ => format!("another {name}"),
        })
    }
}

fn digits(fingerprint: [u8; blake3::OUT_LEN]) -> String {
    blake3::Hash::from(fingerprint).to_string()
}

/// A text with its length before it.
fn text(out: &mut dyn Write, text: &str) -> io::Result<()> {
    let length = u32::try_from(text.len()).ok().filter(|n| *n <= LONGEST).ok_or(ErrorKind::FileTooLarge)?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(text.as_bytes())
}

fn read_text(from: &mut impl Read) -> Option<String> {
    let mut length = [0; 4];
    from.read_exact(&mut length).ok()?;
    let length = u32::from_le_bytes(length);
    let mut bytes = vec![0; (length <= LONGEST).then_some(length as usize)?];
    from.read_exact(&mut bytes).ok()?;
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod pieces_tests;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plan;
    use crate::{Control, Quality, compile, cornell};
    use std::sync::Arc;

    fn scene(size: u32) -> (Arc<Scene>, [u8; blake3::OUT_LEN]) {
        let desc = cornell::luminous_ceiling();
        let options = CompileOptions { size: Some((size, size)), ..CompileOptions::default() };
        (Arc::new(compile(&desc, &options).scene.unwrap()), fingerprint(&desc).unwrap())
    }

    fn bits(session: &dyn Session) -> Vec<[[u64; 3]; 2]> {
        session.film().pixels.iter().map(|p| [p.sum, p.sum_squares].map(|v| v.map(f64::to_bits))).collect()
    }

    fn recipe(scene: &Scene, print: [u8; blake3::OUT_LEN], quality: &Quality) -> Recipe {
        Recipe::new(scene, print, &CompileOptions::default(), &quality.render(scene).unwrap())
    }

    /// Left at any number of samples, a render comes to the bits of one that was not: even, uneven, and up to an error.
    #[test]
    fn what_was_left_goes_on_with_the_same_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state");
        let (scene, print) = scene(24);
        let quality = Quality { spp: Some(40), threads: 1, ..Quality::default() };
        for quality in [
            quality.clone(),
            Quality { adaptive: true, integrator: Some("direct".into()), ..quality.clone() },
            Quality { error: Some(0.3), layers: vec![crate::Layer::ALL[0]], ..quality },
        ] {
            let render = quality.render(&scene).unwrap();
            let mut whole = render.session(&scene).unwrap();
            whole.step(40, &Control::default());
            for left_at in [1, 10, 17, 40] {
                let mut first = render.session(&scene).unwrap();
                first.step(left_at, &Control::default());
                let recipe = recipe(&scene, print, &quality);
                recipe.save(&mut *first, &path).unwrap();
                let plan = Plan { threads: 3, ..render.plan };
                let mut second = Render { plan, ..render.clone() }.session(&scene).unwrap();
                recipe.restore(&mut *second, &path).unwrap();
                assert_eq!((second.samples(), second.counters()), (first.samples(), first.counters()));
                second.step(40, &Control::default());
                assert!(second.is_done() && bits(&*second) == bits(&*whole), "left at {left_at}: {quality:?}");
                assert_eq!(second.counters(), whole.counters());
            }
        }
    }

    /// A finished render goes on with more samples: none of the first is lost, the mean and its stated error are right,
    /// and leaving it on the way changes no bit.
    #[test]
    fn a_finished_render_goes_on_with_more_samples() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state");
        let (scene, print) = scene(16);
        for (integrator, adaptive) in [("path", false), ("path:reuse=16", false), ("path", true), ("light", false)] {
            let quality =
                Quality { spp: Some(32), adaptive, integrator: Some(integrator.into()), ..Quality::default() };
            let render = quality.render(&scene).unwrap();
            let recipe = recipe(&scene, print, &quality);
            let mut first = render.session(&scene).unwrap();
            first.step(32, &Control::default());
            recipe.save(&mut *first, &path).unwrap();
            let restored = || {
                let mut session = render.session(&scene).unwrap();
                recipe.restore(&mut *session, &path).unwrap();
                session
            };
            let mut second = restored();
            assert!(second.is_done() && !second.extend(16) && second.is_done() && second.extend(96));
            assert!(!second.is_done() && bits(&*second) == bits(&*first));
            second.step(96, &Control::default());
            assert!(second.is_done() && second.samples() == 96, "{integrator}");
            let samples = |s: &dyn Session| s.film().pixels.iter().map(|p| u64::from(p.samples)).sum::<u64>();
            assert_eq!(samples(&*second), second.counters().samples);
            // The state of an extended render is one like any other.
            let mut third = restored();
            third.extend(96);
            third.step(20, &Control::default());
            recipe.save(&mut *third, &path).unwrap();
            let mut fourth = restored();
            assert!(!fourth.is_done() && fourth.extend(96));
            fourth.step(96, &Control::default());
            assert!(bits(&*fourth) == bits(&*second), "{integrator}");
            // Against a reference: the mean is right, and errs less than before.
            let many = Quality { spp: Some(4096), seed: Some(5), ..quality.clone() };
            let mut reference = many.render(&scene).unwrap().session(&scene).unwrap();
            reference.step(4096, &Control::default());
            let total = |s: &dyn Session| s.film().pixels.iter().map(|p| p.mean()[0]).sum::<f64>();
            let variance = |s: &dyn Session| s.film().pixels.iter().map(|p| p.variance_of_mean()[0]).sum::<f64>();
            let apart = total(&*second) - total(&*reference);
            // Paths that share err alike over a group of 16.
            let alike = if integrator.contains("reuse") { 16.0 } else { 1.0 };
            let error = (alike * (variance(&*second) + variance(&*reference))).sqrt();
            assert!(apart.abs() < 4.5 * error, "{integrator}: {apart} ± {error}");
            assert!(variance(&*second) < 0.6 * variance(&*first), "{integrator}: no sample was added");
        }
    }

    #[test]
    fn only_its_own_render_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state");
        let (scene, print) = scene(16);
        let quality = Quality { spp: Some(8), ..Quality::default() };
        let render = quality.render(&scene).unwrap();
        let mut session = render.session(&scene).unwrap();
        session.step(2, &Control::default());
        let own = recipe(&scene, print, &quality);
        own.save(&mut *session, &path).unwrap();
        let restore = |recipe: &Recipe| recipe.restore(&mut *render.session(&scene).unwrap(), &path);
        restore(&own).unwrap();
        let asked = |quality| restore(&recipe(&scene, print, &quality)).unwrap_err().to_string();
        assert_eq!(
            asked(Quality { spp: Some(16), ..quality.clone() }),
            "was saved with other settings: samples per pixel 8, not 16"
        );
        assert_eq!(samples(&path).unwrap(), 8);
        assert!(asked(Quality { seed: Some(3), ..quality.clone() }).contains("seed 0, not 3"));
        for other in ["direct", "volpath"] {
            let other = Quality { integrator: Some(other.into()), ..quality.clone() };
            assert!(asked(other).contains("another integrator"));
        }
        let mut other = print;
        other[5] ^= 1;
        assert!(matches!(restore(&recipe(&scene, other, &quality)), Err(StateError::OtherScene)));
        // Changed, cut, lengthened, empty, or something else.
        let bytes = std::fs::read(&path).unwrap();
        for at in (0..bytes.len()).step_by(101) {
            let mut changed = bytes.clone();
            changed[at] ^= 0x40;
            std::fs::write(&path, changed).unwrap();
            assert!(restore(&own).is_err(), "byte {at}");
            std::fs::write(&path, &bytes[..at]).unwrap();
            assert!(restore(&own).is_err(), "cut at {at}");
        }
        std::fs::write(&path, [&bytes[..], b"more"].concat()).unwrap();
        assert!(matches!(restore(&own), Err(StateError::Damaged)));
        std::fs::write(&path, b"P6 1 1 255 abc, and more than a hash of anything that follows").unwrap();
        assert!(matches!(restore(&own), Err(StateError::NotAState)));
    }

    /// A state tells lies, and its checksum is right: whatever one number says, it is refused, or the render goes on
    /// from it to a picture.
    #[test]
    fn forged_states_are_refused_or_rendered() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state");
        let (scene, print) = scene(16);
        let pixels = 16 * 16;
        let layers = ["albedo", "position", "cryptomatte"].map(|name| crate::Layer::named(name).unwrap());
        let plain = Quality { spp: Some(40), threads: 1, integrator: Some("direct".into()), ..Quality::default() };
        let paths = |integrator: &str| Quality { integrator: Some(integrator.into()), ..plain.clone() };
        for (quality, left_at) in [
            (Quality { layers: layers.to_vec(), ..plain.clone() }, 3),
            (Quality { adaptive: true, error: Some(0.01), ..paths("path") }, 2),
            (Quality { adaptive: true, ..paths("path") }, 20),
            (paths("path:reuse=4"), 3),
            (Quality { error: Some(0.01), ..paths("light") }, 3),
        ] {
            let render = quality.render(&scene).unwrap();
            let mut session = render.session(&scene).unwrap();
            session.step(left_at, &Control::default());
            let own = recipe(&scene, print, &quality);
            own.save(&mut *session, &path).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            let body = bytes.len() - HASH as usize;
            let mut state = Vec::new();
            session.save(&mut state).unwrap();
            let ends = [[0; 8], [0xff; 8]];
            let one = [1, 0, 0, 0, 0, 0, 0, 0];
            let single = [f32::NAN, f32::INFINITY, f32::MAX, 1e-45].map(|v| [v.to_le_bytes(), [0; 4]].concat());
            let double = [f64::NAN, f64::INFINITY, f64::MAX, 1.0].map(|v| v.to_le_bytes().to_vec());
            let values = ends.into_iter().chain([one]).map(|v| v.to_vec()).chain(single).chain(double);
            let values: Vec<Vec<u8>> = values.collect();
            let mut refused = 0;
            // All of what comes first, and every so many of the many pixels.
            for at in (0..state.len()).step_by(4).filter(|at| *at < 400 || at / 4 % 61 == 0) {
                for (value, width) in values.iter().flat_map(|v| [(v, 4), (v, 8)]) {
                    let width = width.min(state.len() - at);
                    let mut forged = bytes[..body].to_vec();
                    let field = body - state.len() + at;
                    forged[field..field + width].copy_from_slice(&value[..width]);
                    let hash = blake3::hash(&forged);
                    forged.extend(hash.as_bytes());
                    std::fs::write(&path, forged).unwrap();
                    let mut session = render.session(&scene).unwrap();
                    if own.restore(&mut *session, &path).is_err() {
                        refused += 1;
                        continue;
                    }
                    let before = session.counters().samples;
                    session.step(1, &Control::default());
                    let what = format!("{quality:?}: {value:?} at {at}");
                    assert!(session.counters().samples - before <= 64 * 2 * pixels, "{what}");
                    let film = session.film();
                    assert!(film.pixels.iter().flat_map(|p| p.mean()).all(f64::is_finite), "{what}");
                    let picture = crate::develop(&scene, &film, &quality.layers);
                    let is_finite = |v: &f32| v.is_finite();
                    assert!(picture.channels().iter().flat_map(|c| &c.data).all(is_finite), "{what}");
                }
            }
            assert!(refused > 0);
        }
    }

    #[test]
    fn fingerprints_are_of_contents() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("texture.png");
        let of = |desc: &SceneDesc| fingerprint(desc).unwrap();
        let mut desc = cornell::luminous_ceiling();
        assert_eq!(of(&desc), of(&cornell::luminous_ceiling()));
        assert_ne!(of(&desc), of(&cornell::point_light()));
        desc.path = Some(file.clone());
        assert_eq!(of(&desc), of(&cornell::luminous_ceiling()));
        desc.nodes[0].set("filename", Value::Path(file.clone()), None);
        let without = of(&desc);
        std::fs::write(&file, b"one").unwrap();
        let one = of(&desc);
        std::fs::write(&file, b"two").unwrap();
        assert!(one != without && one != of(&desc));
        // A copy elsewhere is the same.
        let (two, elsewhere) = (of(&desc), tempfile::tempdir().unwrap());
        let copy = elsewhere.path().join("texture.png");
        std::fs::copy(&file, &copy).unwrap();
        desc.nodes[0].set("filename", Value::Path(copy), None);
        assert!(two == of(&desc));
    }
}

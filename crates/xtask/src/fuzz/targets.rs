//! Targets: readers, each with sound seeds, and what it does with an input.

use super::{mutate::mutate, seeds};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, LazyLock, OnceLock},
};
use steradian::{
    Control, Quality, Render, Scene, archive,
    formats::{Options, native},
    image::{self, TemporaryFolder},
    load_bytes,
    math::{hash::HashRng, spectra},
    resume::{self, Recipe},
    scene::{NodeId, SceneDesc},
};

/// A reader.
pub struct Target {
    pub name: &'static str,
    make_seeds: fn() -> Vec<Vec<u8>>,
    seeds: OnceLock<Vec<Vec<u8>>>,
    /// Puts checksums right, at which damaged inputs would end else.
    mend: fn(&mut [u8]),
    /// Reads an input; true where it is accepted.
    pub run: fn(&[u8]) -> bool,
}

fn target(name: &'static str, make_seeds: fn() -> Vec<Vec<u8>>, run: fn(&[u8]) -> bool) -> Target {
    Target { name, make_seeds, seeds: OnceLock::new(), mend: |_| {}, run }
}

fn mended(target: Target, mend: fn(&mut [u8])) -> Target {
    Target { mend, ..target }
}

/// All targets.
pub static TARGETS: LazyLock<Vec<Target>> = LazyLock::new(|| {
    vec![
        target("pbrt", || seeds::scenes("pbrt"), |bytes| is_scene("pbrt", bytes)),
        target("mitsuba", || seeds::scenes("xml"), |bytes| is_scene("xml", bytes)),
        target("steradian", || seeds::scenes("steradian"), |bytes| is_scene("steradian", bytes)),
        target("gltf", || seeds::scenes("gltf"), |bytes| is_scene("gltf", bytes)),
        target("glb", seeds::glb, |bytes| is_scene("glb", bytes)),
        target("ply", seeds::ply, |bytes| is_scene("ply", bytes)),
        target("obj", seeds::obj, |bytes| is_scene("obj", bytes)),
        target("value", seeds::values, is_value),
        target("spectrum", seeds::spectra, |bytes| spectra::parse_spd(&String::from_utf8_lossy(bytes)).is_ok()),
        mended(target("png", seeds::png, is_picture), mend_png),
        target("exr", seeds::exr, is_picture),
        target("hdr", || seeds::pictures(image::FileKind::Hdr), is_picture),
        target("pfm", || seeds::pictures(image::FileKind::Pfm), is_picture),
        target("ppm", || seeds::pictures(image::FileKind::Pnm), is_picture),
        target("jpeg", || seeds::pictures(image::FileKind::Jpeg), is_picture),
        target("dds", || seeds::pictures(image::FileKind::Dds), is_picture),
        target("ktx2", || seeds::pictures(image::FileKind::Ktx2), is_picture),
        target("tga", seeds::tga, |bytes| is_picture_called(Some(Path::new("a.tga")), bytes)),
        target("bmp", seeds::bmp, is_picture),
        mended(target("state", || vec![kept(false)], is_state), mend_state),
        mended(target("part", || vec![kept(true)], is_part), mend_state),
        target("archive", seeds::archive, is_archive),
    ]
});

impl Target {
    /// Sound inputs.
    pub fn seeds(&self) -> &[Vec<u8>] {
        self.seeds.get_or_init(self.make_seeds)
    }

    /// The input of an execution.
    pub fn input(&self, number: u64) -> Vec<u8> {
        let name = self.name.bytes().fold(0, |hash: u64, byte| hash.wrapping_mul(257).wrapping_add(byte.into()));
        let mut bytes =
            mutate(self.seeds(), &mut HashRng::new(name.wrapping_add(number.wrapping_mul(0x9E37_79B9_7F4A_7C15))));
        (self.mend)(&mut bytes);
        bytes
    }

    /// Reads an input.
    pub fn execute(&self, input: &[u8]) {
        (self.run)(input);
    }
}

/// Reads a scene; of one that is sound, what is written in Steradian's own language must be sound, too.
fn is_scene(format: &str, bytes: &[u8]) -> bool {
    let options = Options { search: vec![seeds::folder()], ..Options::default() };
    let name = format!("scene.{format}");
    let loaded = load_bytes(&name, bytes.to_vec(), Some(format), &options);
    if loaded.diagnostics.has_errors() {
        return false;
    }
    if let Ok(written) = steradian::formats::write::write(&loaded.desc, Path::new("again.steradian"))
        && written.files.is_empty()
    {
        let again = load_bytes("again.steradian", written.bytes, Some("steradian"), &options);
        let errors = again.diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        assert!(!again.diagnostics.has_errors(), "a sound scene is written, but cannot be read again: {errors}");
    }
    true
}

/// Sets a parameter to a value in the scene language.
fn is_value(bytes: &[u8]) -> bool {
    static SCENE: LazyLock<SceneDesc> = LazyLock::new(steradian::cornell::luminous_ceiling);
    let text = String::from_utf8_lossy(bytes);
    let mut desc = SCENE.clone();
    let node = desc.nodes.iter().position(|node| node.get("reflectance").is_some());
    let node = NodeId(node.unwrap_or_else(|| unreachable!("walls reflect")) as u32);
    native::set(&mut desc, node, "reflectance", &text, &Options::default()).is_ok()
}

fn is_picture(bytes: &[u8]) -> bool {
    is_picture_called(None, bytes)
}

/// Reads a picture, of a kind that its bytes tell, or else its name.
fn is_picture_called(name: Option<&Path>, bytes: &[u8]) -> bool {
    image::read_bytes(bytes, name, &image::Limits::default()).is_ok()
}

/// Render whose states are read.
struct Kept {
    scene: Arc<Scene>,
    render: Render,
    recipe: Recipe,
}

static KEPT: LazyLock<Kept> = LazyLock::new(|| {
    let desc = steradian::cornell::luminous_ceiling();
    let options = steradian::CompileOptions { size: Some((40, 20)), ..Default::default() };
    let scene = Arc::new(steradian::compile(&desc, &options).scene.unwrap_or_else(|| unreachable!("it is built in")));
    let quality = Quality { spp: Some(2), threads: 1, integrator: Some("path".into()), ..Quality::default() };
    let render = quality.render(&scene).unwrap_or_else(|e| unreachable!("{e}"));
    let fingerprint = resume::fingerprint(&desc).unwrap_or_default();
    let recipe = Recipe::new(&scene, fingerprint, &options, &render);
    Kept { scene, render, recipe }
});

impl Kept {
    fn session(&self) -> Box<dyn steradian::Session> {
        self.render.session(&self.scene).unwrap_or_else(|e| unreachable!("{e}"))
    }
}

/// Bytes of the state of a finished render, or of its first piece.
fn kept(is_part: bool) -> Vec<u8> {
    with_file(&[], |path| {
        let mut session = KEPT.session();
        let mut recipe = KEPT.recipe.clone();
        if is_part && let Ok(all) = session.pieces() {
            session.restrict(0..1).unwrap_or_else(|e| unreachable!("{e}"));
            recipe = recipe.of_pieces(&(0..1), all);
        }
        session.step(2, &Control::default());
        recipe.save(&mut *session, path).unwrap_or_else(|e| unreachable!("{e}"));
        std::fs::read(path).unwrap_or_default()
    })
}

fn is_state(bytes: &[u8]) -> bool {
    with_file(bytes, |path| {
        let (_, _) = (resume::state_file(path), resume::samples(path));
        KEPT.recipe.restore(&mut *KEPT.session(), path).is_ok()
    })
}

fn is_part(bytes: &[u8]) -> bool {
    with_file(bytes, |path| KEPT.recipe.join(&mut *KEPT.session(), path).is_ok())
}

fn is_archive(bytes: &[u8]) -> bool {
    with_file(bytes, |path| archive::unpack(path, Path::new("")).is_ok())
}

/// Gives a file with these bytes to a function.
fn with_file<T>(bytes: &[u8], read: impl FnOnce(&Path) -> T) -> T {
    let folder = TemporaryFolder::new("steradian-fuzz-").unwrap_or_else(|e| panic!("no temporary folder: {e}"));
    let path: PathBuf = folder.path().join("input.zip");
    std::fs::write(&path, bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    read(&path)
}

/// The checksum at the end of a state.
fn mend_state(bytes: &mut [u8]) {
    if let Some(at) = bytes.len().checked_sub(blake3::OUT_LEN) {
        let hash = *blake3::hash(&bytes[..at]).as_bytes();
        bytes[at..].copy_from_slice(&hash);
    }
}

/// The checksums of the chunks of a PNG file, as far as these can be told.
fn mend_png(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_be_bytes) {
        let end = at + 8 + length as usize;
        if end + 4 > bytes.len() {
            break;
        }
        let sum = crc32(&bytes[at + 4..end]).to_be_bytes();
        bytes[end..end + 4].copy_from_slice(&sum);
        at = end + 4;
    }
}

/// The checksum of PNG and zip (ISO 3309).
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ (0xEDB8_8320 & 0u32.wrapping_sub(sum & 1)))
    })
}

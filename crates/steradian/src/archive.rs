//! Scenes in zip archives: one file for a scene and all files that it names.
//!
//! An archive has the files under their names relative to the folder that holds them all, and before them a list with
//! their BLAKE3 hashes and the name of the scene. Archives without such a list, as scenes are handed around in, are
//! read too, where it is clear which of their files is the scene.

use crate::hashing::Hashing;
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::{self, BufReader, Read, Write},
    path::{Component, Path, PathBuf},
};
use steradian_formats::Reader;
use tempfile::TempDir;
use zip::{CompressionMethod, ZipArchive, ZipWriter, result::ZipError, write::SimpleFileOptions};

/// Extension of archives.
pub const EXTENSION: &str = "zip";
/// Name of the list in an archive.
const LIST: &str = "steradian.json";
/// Longest list, bytes.
const LONGEST_LIST: u64 = 64 << 20;
/// Most files of an archive.
const MOST_FILES: usize = 1_000_000;
/// Most bytes that an archive may stand for, whatever its size, and per byte of it.
const MOST_BYTES: u64 = 256 << 30;
const MOST_PER_BYTE: u64 = 200;
/// Bytes of an archive that are not counted for that.
const SMALL: u64 = 1 << 16;
/// Most names in a message.
const SHOWN: usize = 8;

/// Failure to pack or unpack a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// The system's answer.
    #[error("cannot be read or written: {0}")]
    Io(#[from] io::Error),
    /// It is not written as archives are.
    #[error("is no zip archive that can be read: {0}")]
    Zip(#[from] ZipError),
    /// It stands for more than a scene ever has.
    #[error("is not unpacked: {0}")]
    TooMuch(String),
    /// A name in it leads out of it.
    #[error("has the name '{0}', which leads out of its folder")]
    Outside(String),
    /// A file is not the one that was packed.
    #[error("is damaged: '{0}' is not what was packed")]
    Damaged(String),
    /// None of its files is a scene.
    #[error("has no scene in it")]
    NoScene,
    /// Several of its files may be the scene.
    #[error("has several scenes; name one of them, as in {0}")]
    Several(String),
    /// The named file is not in it.
    #[error("has no file '{0}'")]
    Missing(String),
    /// Files to be packed that have no folder in common.
    #[error("cannot be written: the files of the scene lie on several drives")]
    NoFolder,
}

/// The list of an archive.
#[derive(Debug, Serialize, Deserialize)]
struct List {
    /// Version of the program that made it.
    steradian: String,
    /// Name of the scene.
    scene: String,
    /// Hashes of the files, in hexadecimal digits, by name.
    files: BTreeMap<String, String>,
}

/// Files of an archive that was made.
#[derive(Clone, Copy, Debug)]
pub struct Packed {
    /// Number of files.
    pub files: usize,
    /// Bytes of the files.
    pub bytes: u64,
}

/// An archive in a temporary folder, which goes away with it.
#[derive(Debug)]
pub struct UnpackedScene {
    /// The folder.
    pub folder: TempDir,
    /// The scene in it.
    pub scene: PathBuf,
}

/// Packs a scene with files that it names; files that are not there are left out. The archive appears whole or not at
/// all, and has the same bits for the same files.
///
/// # Errors
/// Faults of reading the files and of writing the archive.
pub fn pack<'a>(
    scene: &Path,
    files: impl IntoIterator<Item = &'a Path>,
    archive: &Path,
) -> Result<Packed, ArchiveError> {
    let scene = normal(scene)?;
    let mut all = BTreeSet::from([scene.clone()]);
    for file in files {
        let file = normal(file)?;
        if file.is_file() {
            all.insert(file);
        }
    }
    // Names relative to the deepest folder that holds all files.
    let mut root = scene.parent().map(Path::to_path_buf).unwrap_or_default();
    while !all.iter().all(|file| file.starts_with(&root)) {
        if !root.pop() {
            return Err(ArchiveError::NoFolder);
        }
    }
    let name_of = |file: &Path| {
        let parts = file.strip_prefix(&root).unwrap_or(file).components();
        parts.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect::<Vec<_>>().join("/")
    };
    let mut list = List { steradian: env!("CARGO_PKG_VERSION").into(), scene: name_of(&scene), files: BTreeMap::new() };
    let mut bytes = 0;
    for file in &all {
        let (mut hasher, opened) = (blake3::Hasher::new(), File::open(file)?);
        bytes += opened.metadata()?.len();
        hasher.update_reader(opened)?;
        list.files.insert(name_of(file), hasher.finalize().to_string());
    }
    let write = |out: &mut dyn Write| {
        let mut zip = ZipWriter::new_stream(out);
        // Times are left out, so that the same files make the same archive.
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated).large_file(true);
        zip.start_file(LIST, options)?;
        serde_json::to_writer_pretty(&mut zip, &list)?;
        for file in &all {
            zip.start_file(name_of(file), options)?;
            io::copy(&mut File::open(file)?, &mut zip)?;
        }
        zip.finish()?;
        Ok(())
    };
    steradian_image::stream_whole(archive, write).map_err(|e| io::Error::other(e.to_string()))?;
    Ok(Packed { files: all.len(), bytes })
}

/// A path from the root on, without `.` and `..`, of which links are kept.
fn normal(path: &Path) -> io::Result<PathBuf> {
    let mut normal = PathBuf::new();
    for part in std::path::absolute(path)?.components() {
        match part {
            Component::ParentDir => drop(normal.pop()),
            Component::CurDir => {}
            part => normal.push(part),
        }
    }
    Ok(normal)
}

/// The archive in which a path lies, and the name in it: `scenes.zip/room/scene.pbrt`, or an empty one for the archive
/// itself. `None` for paths that lie in none.
pub fn split(path: &Path) -> Option<(&Path, &Path)> {
    let is_archive =
        |path: &&Path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION)) && path.is_file();
    // Without a slash at the end, as of a folder.
    let path = path.components().as_path();
    let archive = path.ancestors().find(is_archive)?;
    Some((archive, path.strip_prefix(archive).unwrap_or(Path::new(""))))
}

/// Unpacks an archive into a temporary folder, and finds the scene in it: the file of a name, if that is not empty, or
/// the one that was packed, or the only one.
///
/// # Errors
/// Why that cannot be done; nothing is left of it then.
pub fn unpack(path: &Path, name: &Path) -> Result<UnpackedScene, ArchiveError> {
    unpack_at_most(path, name, MOST_BYTES)
}

/// [`unpack`], of archives that stand for no more than `most` bytes.
///
/// # Errors
/// As [`unpack`].
pub fn unpack_at_most(path: &Path, name: &Path, most: u64) -> Result<UnpackedScene, ArchiveError> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut zip = ZipArchive::new(BufReader::new(file))?;
    if zip.len() > MOST_FILES {
        return Err(ArchiveError::TooMuch(format!("it has {} files, more than {MOST_FILES}", zip.len())));
    }
    let list = read_list(&mut zip)?;
    let folder = tempfile::Builder::new().prefix("steradian-").tempdir()?;
    let allowed = MOST_BYTES.min(most).min(length.saturating_add(SMALL).saturating_mul(MOST_PER_BYTE));
    let (mut total, mut names) = (0_u64, Vec::new());
    for at in 0..zip.len() {
        let entry = zip.by_index(at)?;
        let name = entry.name()?.into_owned();
        if entry.is_dir() || entry.is_symlink() || name == LIST {
            continue;
        }
        let Some(inside) = entry.enclosed_name() else { return Err(ArchiveError::Outside(name)) };
        let to = folder.path().join(&inside);
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent)?;
        }
        // What comes counts, whatever the archive says of its length.
        let mut out = Hashing::new(File::create(&to)?);
        total += io::copy(&mut entry.take(allowed - total + 1), &mut out)?;
        if total > allowed {
            return Err(ArchiveError::TooMuch(format!("its {length} bytes stand for more than {allowed}")));
        }
        let name = inside.components().map(|c| c.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/");
        if let Some(list) = &list
            && list.files.get(&name).is_some_and(|hash| *hash != out.hasher.finalize().to_string())
        {
            return Err(ArchiveError::Damaged(name));
        }
        names.push(name);
    }
    let missing = |name: &String| !names.contains(name);
    if let Some(name) = list.iter().flat_map(|list| list.files.keys()).find(|name| missing(name)) {
        return Err(ArchiveError::Damaged(name.clone()));
    }
    let scene = if !name.as_os_str().is_empty() {
        name.to_string_lossy().replace('\\', "/")
    } else if let Some(list) = list {
        list.scene
    } else {
        the_scene(path, &names)?.to_owned()
    };
    if !names.contains(&scene) {
        return Err(ArchiveError::Missing(scene));
    }
    Ok(UnpackedScene { scene: folder.path().join(scene), folder })
}

fn read_list<R: Read + io::Seek>(zip: &mut ZipArchive<R>) -> Result<Option<List>, ArchiveError> {
    let mut text = Vec::new();
    match zip.by_name(LIST) {
        Ok(entry) => entry.take(LONGEST_LIST).read_to_end(&mut text)?,
        Err(ZipError::FileNotFound) => return Ok(None),
        Err(e) => return Err(e.into()),
    };
    serde_json::from_slice(&text).map(Some).map_err(|_| ArchiveError::Damaged(LIST.into()))
}

/// The scene among files: of those that lie least deep the only scene, or the only one called so, or the only model.
fn the_scene<'n>(archive: &Path, names: &'n [String]) -> Result<&'n str, ArchiveError> {
    let extension = |name: &str| Path::new(name.strip_suffix(".gz").unwrap_or(name)).extension().map(|e| e.to_owned());
    let known = |name: &str| {
        let extension = extension(name)?.to_str()?.to_ascii_lowercase();
        Reader::of_extension(&extension).map(|_| matches!(&*extension, "obj" | "ply"))
    };
    // System files of macOS are no scenes.
    let names = names.iter().map(String::as_str).filter(|name| !name.starts_with("__MACOSX/"));
    let found: Vec<(&str, bool)> = names.filter_map(|name| Some((name, known(name)?))).collect();
    let has_scenes = found.iter().any(|(_, is_model)| !is_model);
    let found: Vec<&str> = found.into_iter().filter(|f| f.1 != has_scenes).map(|f| f.0).collect();
    let depth = |name: &str| name.matches('/').count();
    let least = found.iter().map(|name| depth(name)).min().ok_or(ArchiveError::NoScene)?;
    let near: Vec<&str> = found.into_iter().filter(|name| depth(name) == least).collect();
    let stem = |name: &str| Path::new(name).file_name().is_some_and(|name| name.to_string_lossy().starts_with("scene"));
    let called: Vec<&str> = near.iter().copied().filter(|name| stem(name)).collect();
    match (&*near, &*called) {
        ([one], _) | (_, [one]) => Ok(one),
        _ => {
            let shown = near.iter().take(SHOWN).map(|name| format!("{}/{name}", archive.display()));
            let more = if near.len() > SHOWN { ", …" } else { "" };
            Err(ArchiveError::Several(shown.collect::<Vec<_>>().join(", ") + more))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zip_of(path: &Path, files: &[(&str, &[u8])]) {
        let mut zip = ZipWriter::new(File::create(path).unwrap());
        for (name, bytes) in files {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap();
    }

    /// Files come out as they went in, under names that fit each other, and the archive does not depend on where they
    /// lay.
    #[test]
    fn what_is_packed_is_unpacked() {
        let archives = [0, 1].map(|_| {
            let folder = tempfile::tempdir().unwrap();
            let at = |name: &str| folder.path().join(name);
            fs::create_dir_all(at("room/maps")).unwrap();
            fs::create_dir_all(at("shared")).unwrap();
            for (name, text) in [("room/scene.xml", "<scene/>"), ("room/maps/a.png", "a"), ("shared/b.png", "b")] {
                fs::write(at(name), text).unwrap();
            }
            let files = [at("room/maps/a.png"), at("room/../shared/b.png"), at("missing.png"), at("room")];
            let archive = at("out.zip");
            let packed = pack(&at("room/scene.xml"), files.iter().map(PathBuf::as_path), &archive).unwrap();
            assert_eq!((packed.files, packed.bytes), (3, 10));
            let out = unpack(&archive, Path::new("")).unwrap();
            assert!(out.scene.ends_with("room/scene.xml"));
            assert_eq!(fs::read(out.folder.path().join("shared/b.png")).unwrap(), b"b");
            let bytes = fs::read(&archive).unwrap();
            // A byte that changes is found out, wherever it is.
            for at in (0..bytes.len()).step_by(7) {
                let mut changed = bytes.clone();
                changed[at] ^= 0x20;
                fs::write(&archive, changed).unwrap();
                if let Ok(out) = unpack(&archive, Path::new("")) {
                    assert_eq!(fs::read(out.folder.path().join("room/maps/a.png")).unwrap(), b"a", "{at}");
                }
                fs::write(&archive, &bytes[..at]).unwrap();
                assert!(unpack(&archive, Path::new("")).is_err(), "{at}");
            }
            bytes
        });
        assert!(archives[0] == archives[1]);
    }

    /// The scene of an archive is told where it is clear; else the names are told.
    #[test]
    fn scenes_are_found_in_archives_of_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ZIP");
        let found = |files: &[&str], name: &str| {
            zip_of(&path, &files.iter().map(|name| (*name, &b"x"[..])).collect::<Vec<_>>());
            let inside = path.join(name);
            let (archive, name) = split(&inside).unwrap();
            unpack(archive, name)
                .map(|out| out.scene.strip_prefix(out.folder.path()).unwrap().to_string_lossy().into_owned())
                .map_err(|e| e.to_string())
        };
        assert_eq!(found(&["r/scene-v4.pbrt", "r/models/a.ply", "r/LICENSE"], "").unwrap(), "r/scene-v4.pbrt");
        assert_eq!(found(&["r/a.pbrt", "r/scene.pbrt", "__MACOSX/r/b.pbrt"], "").unwrap(), "r/scene.pbrt");
        assert_eq!(found(&["bunny.ply", "bunny.txt"], "").unwrap(), "bunny.ply");
        assert_eq!(found(&["a.pbrt", "b.pbrt"], "b.pbrt").unwrap(), "b.pbrt");
        assert!(found(&["a.pbrt", "b.pbrt"], "").unwrap_err().contains("a.ZIP/b.pbrt"));
        assert!(found(&["a.pbrt", "b.pbrt"], "c.pbrt").unwrap_err().contains("no file 'c.pbrt'"));
        assert!(found(&["a.txt"], "").unwrap_err().contains("no scene"));
        assert!(found(&["../a.pbrt"], "").unwrap_err().contains("leads out"));
        assert!(split(Path::new("no.zip")).is_none() && split(folder.path()).is_none());
    }

    /// An archive that stands for much more than it has is not unpacked.
    #[test]
    fn bombs_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bomb.zip");
        let mut zip = ZipWriter::new(File::create(&path).unwrap());
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        zip.start_file("scene.pbrt", options).unwrap();
        let zeros = vec![0; 1 << 20];
        (0..40).for_each(|_| zip.write_all(&zeros).unwrap());
        zip.finish().unwrap();
        let refused = unpack(&path, Path::new("")).unwrap_err().to_string();
        assert!(refused.contains("stand for more"), "{refused}");
    }
}

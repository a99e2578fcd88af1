//! Finished pictures on a list: files, those of folders, and dropped ones. They are read when they are looked at, and
//! the last few are kept.

use serde::Serialize;
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::SystemTime,
};
use steradian::image::{Error, FileKind, Image, Limits, TemporaryFolder, read};

/// Pixels of the largest picture.
const MOST_PIXELS: u64 = 1 << 25;
/// Pictures on the list.
const MOST_LISTED: usize = 4096;
/// Pictures that are kept in memory, and their bytes; the one that was asked for last is kept in any case.
const MOST_KEPT: usize = 4;
const MOST_BYTES_KEPT: usize = 2 << 30;
/// Bytes of all dropped files.
const MOST_DROPPED: u64 = 8 << 30;

/// Pictures on a list.
pub struct Gallery {
    listed: Mutex<Listed>,
}

struct Listed {
    /// Folders whose pictures are on the list.
    folders: Vec<PathBuf>,
    entries: Vec<Entry>,
    /// Pictures in memory, with the number and the version of their entry; the last one was asked for last.
    kept: Vec<(usize, u32, Arc<Image>)>,
    dropped: Vec<TemporaryFolder>,
    bytes_dropped: u64,
}

/// Time of the last change of a file, and its length.
type Stamp = (Option<SystemTime>, u64);

struct Entry {
    path: PathBuf,
    name: String,
    stamp: Option<Stamp>,
    version: u32,
    fault: Option<String>,
}

/// Picture of the list for pages.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Listing {
    /// Its number, which stays.
    pub id: usize,
    /// Its path, as it was given.
    pub name: String,
    /// Grows with each change of the file.
    pub version: u32,
    /// Reason why it cannot be shown; `None` where none is known.
    pub fault: Option<String>,
}

/// A picture that was read, and the version of its file.
pub struct Loaded {
    /// Its path, as it was given.
    pub name: String,
    /// Version of the file.
    pub version: u32,
    /// The picture.
    pub image: Arc<Image>,
}

impl Gallery {
    /// List of files and of the pictures in folders.
    ///
    /// # Errors
    /// No file that is there, or too many.
    pub fn new(files: Vec<PathBuf>) -> Result<Self, String> {
        let (folders, files): (Vec<_>, Vec<_>) = files.into_iter().partition(|path| path.is_dir());
        let named =
            |paths: &[PathBuf]| paths.iter().map(|p| format!("'{}'", p.display())).collect::<Vec<_>>().join(", ");
        let of = named(&[folders.as_slice(), &files].concat());
        let mut listed =
            Listed { folders, entries: Vec::new(), kept: Vec::new(), dropped: Vec::new(), bytes_dropped: 0 };
        for path in files {
            let name = path.to_string_lossy().into_owned();
            listed.add(path, name)?;
        }
        listed.look();
        if listed.entries.iter().all(|entry| entry.stamp.is_none()) {
            return Err(format!("there is no picture to show: {of}"));
        }
        Ok(Self { listed: Mutex::new(listed) })
    }

    /// All pictures, after a look at their files.
    pub fn list(&self) -> Vec<Listing> {
        let mut listed = self.listed();
        listed.look();
        let of =
            |(id, e): (usize, &Entry)| Listing { id, name: e.name.clone(), version: e.version, fault: e.fault.clone() };
        listed.entries.iter().enumerate().map(of).collect()
    }

    /// Takes the pictures among files that were dropped; their numbers.
    ///
    /// # Errors
    /// No picture among the files, or no room for them.
    pub fn take(&self, folder: TemporaryFolder, names: &[PathBuf]) -> Result<Vec<usize>, String> {
        let pictures: Vec<&PathBuf> = names.iter().filter(|name| FileKind::from_extension(name).is_some()).collect();
        if pictures.is_empty() {
            return Err("there is no picture among the files".into());
        }
        let bytes: u64 = names.iter().filter_map(|n| fs::metadata(folder.path().join(n)).ok()).map(|m| m.len()).sum();
        let mut listed = self.listed();
        if listed.bytes_dropped + bytes > MOST_DROPPED || listed.entries.len() + pictures.len() > MOST_LISTED {
            return Err(format!(
                "the list has no room for {} more pictures of {bytes} bytes: it holds {MOST_LISTED}, and of dropped \
                 ones {MOST_DROPPED} bytes",
                pictures.len()
            ));
        }
        let mut numbers = Vec::new();
        for name in pictures {
            numbers.push(listed.add(folder.path().join(name), name.to_string_lossy().into_owned())?);
        }
        listed.bytes_dropped += bytes;
        listed.dropped.push(folder);
        listed.look();
        Ok(numbers)
    }

    /// A picture of the list, from memory or from its file; `None` where there is no such number.
    ///
    /// # Errors
    /// Why it cannot be read, which the list tells, too.
    pub fn load(&self, id: usize) -> Option<Result<Loaded, String>> {
        let mut listed = self.listed();
        let entry = listed.entries.get(id)?;
        let (path, name, version) = (entry.path.clone(), entry.name.clone(), entry.version);
        if let Some(at) = listed.kept.iter().position(|k| (k.0, k.1) == (id, version)) {
            let kept = listed.kept.remove(at);
            let image = Arc::clone(&kept.2);
            listed.kept.push(kept);
            return Some(Ok(Loaded { name, version, image }));
        }
        // The list can be asked for while the file is read.
        drop(listed);
        let image = decode(&path);
        let mut listed = self.listed();
        if let Some(entry) = listed.entries.get_mut(id).filter(|e| e.version == version) {
            entry.fault = image.as_ref().err().cloned();
        }
        Some(image.map(|image| {
            let image = Arc::new(image);
            listed.keep(id, version, &image);
            Loaded { name, version, image }
        }))
    }

    fn listed(&self) -> MutexGuard<'_, Listed> {
        self.listed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Listed {
    /// Puts a file on the list, if it isn't there; its number.
    fn add(&mut self, path: PathBuf, name: String) -> Result<usize, String> {
        if let Some(id) = self.entries.iter().position(|entry| entry.path == path) {
            return Ok(id);
        }
        if self.entries.len() >= MOST_LISTED {
            return Err(format!("a list holds {MOST_LISTED} pictures at most"));
        }
        self.entries.push(Entry { path, name, stamp: None, version: 0, fault: Some(MISSING.into()) });
        Ok(self.entries.len() - 1)
    }

    /// Looks for new files in the folders, and for files that have changed.
    fn look(&mut self) {
        let mut found: Vec<PathBuf> = self.folders.iter().flat_map(|folder| pictures_in(folder)).collect();
        found.sort();
        for path in found {
            let name = path.to_string_lossy().into_owned();
            if self.add(path, name).is_err() {
                break;
            }
        }
        for entry in &mut self.entries {
            let stamp = fs::metadata(&entry.path).ok().filter(|m| m.is_file()).map(|m| (m.modified().ok(), m.len()));
            if stamp != entry.stamp {
                entry.stamp = stamp;
                entry.version += 1;
                entry.fault = stamp.is_none().then(|| MISSING.into());
            }
        }
        let entries = &self.entries;
        self.kept.retain(|(id, version, _)| entries.get(*id).is_some_and(|entry| entry.version == *version));
    }

    /// Keeps a picture, and forgets those that were asked for the longest time ago.
    fn keep(&mut self, id: usize, version: u32, image: &Arc<Image>) {
        self.kept.retain(|kept| kept.0 != id);
        self.kept.push((id, version, Arc::clone(image)));
        let bytes = |kept: &[(usize, u32, Arc<Image>)]| kept.iter().map(|k| bytes_of(&k.2)).sum::<usize>();
        while self.kept.len() > 1 && (self.kept.len() > MOST_KEPT || bytes(&self.kept) > MOST_BYTES_KEPT) {
            self.kept.remove(0);
        }
    }
}

const MISSING: &str = "there is no such file";

fn bytes_of(image: &Image) -> usize {
    image.channels().len() * image.pixel_count() * size_of::<f32>()
}

/// Files in a folder that are called as pictures.
fn pictures_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).filter(|p| FileKind::from_extension(p).is_some() && p.is_file()).collect()
}

/// Reads a picture that tiles can hold.
fn decode(path: &Path) -> Result<Image, String> {
    let limits = Limits { pixels: MOST_PIXELS, ..Limits::default() };
    let image = read(path, &limits).map_err(|e| match e {
        // The list names it.
        Error::File { error, .. } => error.to_string(),
        other => other.to_string(),
    })?;
    let longest = image.width().max(image.height());
    if longest > usize::from(u16::MAX) {
        return Err(format!("{longest} pixels are too many along an edge: {}", u16::MAX));
    }
    if image.channels().is_empty() {
        return Err("the picture has no channels".into());
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::image::{WriteOptions, write};

    fn picture(value: f32) -> Image {
        Image::from_rgb(2, 1, &[[value; 3]; 2]).unwrap()
    }

    #[test]
    fn the_last_few_pictures_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        for k in 0..MOST_KEPT + 2 {
            write(&folder.path().join(format!("{k}.exr")), &picture(k as f32), &WriteOptions::default()).unwrap();
        }
        let gallery = Gallery::new(vec![folder.path().into()]).unwrap();
        for id in 0..MOST_KEPT + 2 {
            let loaded = gallery.load(id).unwrap().unwrap();
            assert_eq!(loaded.image.channel("R").unwrap()[0], id as f32);
        }
        let kept = |gallery: &Gallery| gallery.listed().kept.iter().map(|k| k.0).collect::<Vec<_>>();
        assert_eq!(kept(&gallery), [2, 3, 4, 5]);
        gallery.load(3).unwrap().unwrap();
        gallery.load(0).unwrap().unwrap();
        assert_eq!(kept(&gallery), [4, 5, 3, 0]);
        // One that goes away is not kept.
        fs::remove_file(folder.path().join("5.exr")).unwrap();
        assert_eq!(gallery.list()[5].fault.as_deref(), Some(MISSING));
        assert_eq!(kept(&gallery), [4, 3, 0]);
        assert!(gallery.load(MOST_KEPT + 2).is_none());
    }

    #[test]
    fn without_a_picture_there_is_no_list() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("notes.txt"), "no picture").unwrap();
        let missing = folder.path().join("a.exr");
        for files in [vec![folder.path().to_owned()], vec![missing.clone()], Vec::new()] {
            assert!(Gallery::new(files.clone()).is_err_and(|why| why.contains("no picture to show")), "{files:?}");
        }
    }
}

//! Folders of exercises on the disk: written whole by [`start`], recognised by the file `exercise.txt`.

use crate::{Exercise, Fault, Language, find};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// The file that names exercise and language.
const LABEL: &str = "exercise.txt";
/// Most bytes that are read of it.
const LABEL_BYTES: u64 = 4096;

/// A folder with an exercise.
#[derive(Debug)]
pub(crate) struct Folder {
    pub path: PathBuf,
    pub exercise: &'static Exercise,
    pub language: Language,
}

/// Writes the folder of an exercise, with gaps or solved.
///
/// # Errors
/// [`Fault::Exists`] if there is something of this name, [`Fault::File`] if it cannot be written.
pub fn start(exercise: &Exercise, language: Language, folder: &Path, is_solved: bool) -> Result<(), Fault> {
    if fs::symlink_metadata(folder).is_ok() {
        return Err(Fault::Exists(folder.to_owned()));
    }
    let label = format!("exercise = {}\nlanguage = {}\n", exercise.name, language.name());
    let mut files = language.files(exercise, is_solved);
    files.push(("README.md", readme(exercise, language)));
    files.push((LABEL, label));
    for (name, text) in files {
        let path = folder.join(name);
        let place = path.parent().unwrap_or(folder);
        fs::create_dir_all(place)
            .and_then(|()| fs::write(&path, text))
            .map_err(|error| Fault::File { path: path.clone(), error })?;
    }
    Ok(())
}

/// The task, and how an answer is written and checked.
fn readme(exercise: &Exercise, language: Language) -> String {
    let how = match language {
        Language::Python => include_str!("../templates/python.md"),
        Language::Rust => include_str!("../templates/rust.md"),
    };
    let tolerance = format!(
        "Answers may differ from the right ones by {} of their value: {}.",
        crate::numbers::shown(exercise.tolerance.relative),
        exercise.tolerance.reason
    );
    format!("{}\n\n{}\n\n{tolerance}\n", exercise.texts.readme.trim_end(), how.trim_end())
}

impl Folder {
    /// Reads which exercise a folder holds.
    ///
    /// # Errors
    /// [`Fault::NoExercise`] if it holds none.
    pub fn open(path: &Path) -> Result<Self, Fault> {
        let bad = |reason: String| Fault::NoExercise { folder: path.to_owned(), reason };
        let label = path.join(LABEL);
        let size = fs::metadata(&label).map_err(|e| bad(format!("{LABEL}: {e}")))?;
        if !size.is_file() || size.len() > LABEL_BYTES {
            return Err(bad(format!("{LABEL} is not a small file")));
        }
        let text = fs::read_to_string(&label).map_err(|e| bad(format!("{LABEL}: {e}")))?;
        let value = |key: &str| {
            let found = text.lines().find_map(|l| l.split_once('=').filter(|(k, _)| k.trim() == key));
            found.map(|(_, v)| v.trim()).ok_or_else(|| bad(format!("{LABEL} has no line '{key} = …'")))
        };
        let exercise = find(value("exercise")?)?;
        let name = value("language")?;
        let language =
            Language::named(name).ok_or_else(|| bad(format!("{LABEL}: '{name}' is not a language (python, rust)")))?;
        Ok(Self { path: path.to_owned(), exercise, language })
    }
}

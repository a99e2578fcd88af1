//! Reasons for which there is no verdict.

use std::path::PathBuf;
use thiserror::Error;

/// A reason for which an exercise cannot be written or checked.
#[derive(Debug, Error)]
pub enum Fault {
    /// A name that no exercise has.
    #[error("there is no exercise '{name}'{hint}; `steradian exercise list` lists them")]
    Unknown {
        /// The name.
        name: String,
        /// The nearest name, as a part of a sentence, or nothing.
        hint: String,
    },
    /// A folder to be written that is there.
    #[error("{} exists, and nothing is overwritten: -o FOLDER names another", .0.display())]
    Exists(PathBuf),
    /// A folder without the file that names its exercise, or with one that makes no sense.
    #[error("{} is no folder of an exercise: {reason}; `steradian exercise start NAME` writes \
    one", .folder.display())]
    NoExercise {
        /// The folder.
        folder: PathBuf,
        /// The file that is missing or wrong.
        reason: String,
    },
    /// A file that cannot be read or written.
    #[error("{}: {error}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        error: std::io::Error,
    },
    /// An interpreter or compiler that cannot be started.
    #[error("cannot start {tool}: {error}; it is needed for exercises in {language}")]
    Tool {
        /// Name of its program.
        tool: &'static str,
        /// The system's reason.
        error: std::io::Error,
        /// Language of the exercise.
        language: &'static str,
    },
    /// The check was asked to stop.
    #[error("the check was stopped")]
    Stopped,
}

impl Fault {
    /// True if the user's words or files are at fault, false for the system.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::Unknown { .. } | Self::Exists(_) | Self::NoExercise { .. })
    }
}

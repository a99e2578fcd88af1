//! Positions in the files that were read.

use crate::lines::Lines;
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

/// Index of a file in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct FileId(pub u32);

/// A range of bytes in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Span {
    /// Which file.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// Bytes `start..end` of `file`; offsets past 4 GiB are held at the limit.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        let clip = |v: usize| u32::try_from(v).unwrap_or(u32::MAX);
        Self { file, start: clip(start), end: clip(end) }
    }

    /// From the start of this span to the end of a later one in the same file.
    pub fn to(self, end: Span) -> Self {
        Self { end: end.end.max(self.end), ..self }
    }
}

/// A place in a file, with the line it is on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Location {
    /// The file.
    pub path: String,
    /// From 1.
    pub line: u32,
    /// From 1, in characters.
    pub column: u32,
    /// The line, or the readable part of a long one.
    pub excerpt: String,
    /// Start of the caret in the excerpt, in characters.
    pub caret_start: u32,
    /// Number of characters it marks, at least one.
    pub caret_len: u32,
}

/// One file that was read, with its text for excerpts.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Source {
    /// Path as the user would recognise it.
    pub path: PathBuf,
    /// The file's bytes; empty for files shown without excerpts (binary ones).
    #[serde(skip)]
    pub text: Arc<[u8]>,
    /// Made when the first message about the file is placed.
    #[serde(skip)]
    lines: OnceLock<Lines>,
}

/// All files of a scene.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Sources {
    files: Vec<Source>,
    /// Files that were read and are never quoted.
    unquoted: BTreeSet<PathBuf>,
}

impl Sources {
    /// Registers a file and its text.
    pub fn add(&mut self, path: impl Into<PathBuf>, text: impl Into<Arc<[u8]>>) -> FileId {
        self.files.push(Source { path: path.into(), text: text.into(), lines: OnceLock::new() });
        FileId(self.files.len() as u32 - 1)
    }

    /// Notes a file that was read and that no message will quote.
    pub fn note(&mut self, path: impl Into<PathBuf>) {
        self.unquoted.insert(path.into());
    }

    /// The paths of all files that were read: those with an id in the order of it, then the others.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|file| file.path.as_path()).chain(self.unquoted.iter().map(PathBuf::as_path))
    }

    /// The file with this id.
    pub fn get(&self, id: FileId) -> Option<&Source> {
        self.files.get(id.0 as usize)
    }

    /// All files in the order they were first read.
    pub fn iter(&self) -> impl Iterator<Item = &Source> {
        self.files.iter()
    }

    /// Line, column (both from 1; columns count characters) and the text of the line, cut to a readable width around
    /// the span.
    pub fn locate(&self, span: Span) -> Option<Location> {
        const CONTEXT: usize = 60;
        let source = self.get(span.file)?;
        let text = &source.text;
        let lines = source.lines.get_or_init(|| Lines::new(text));
        let start = (span.start as usize).min(text.len());
        let (line, line_start) = lines.line(start);
        let line_end = lines.end(line, text);
        let end = (span.end as usize).clamp(start, line_end);
        // Long lines (a million vertices on one) are shown in part.
        let from = if start - line_start > 2 * CONTEXT { start - CONTEXT } else { line_start };
        let to = line_end.min(end.max(start) + CONTEXT).min(from + 4 * CONTEXT);
        let clean = |b: &[u8]| String::from_utf8_lossy(b).replace(['\t', '\r'], " ");
        let before = clean(&text[from..start]);
        let marked = clean(&text[start..end.min(to)]);
        Some(Location {
            path: source.path.display().to_string(),
            line: line as u32 + 1,
            column: lines.characters(text, line_start, start) + 1,
            excerpt: clean(&text[from..to]),
            caret_start: before.chars().count() as u32,
            caret_len: (marked.chars().count() as u32).max(1),
        })
    }
}

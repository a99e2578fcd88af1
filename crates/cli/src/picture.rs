//! `steradian info` of a picture: its size, what its channels hold, and what its file says of it.

use crate::{
    failure::{self, Failure, Outcome},
    terminal,
};
use serde::Serialize;
use std::{fmt::Write, fs::File, io::Read, path::Path};
use steradian::{
    image::{FileKind, Image, Limits, Value, read},
    load::extensions,
};

/// Bytes that tell what a file is.
const HEAD: u64 = 64;

#[derive(Serialize)]
struct Info {
    schema: u32,
    picture: String,
    format: String,
    width: usize,
    height: usize,
    channels: Vec<Channel>,
    metadata: Vec<(String, String)>,
}

/// Statistics of a channel; of its finite values.
#[derive(Serialize)]
struct Channel {
    name: String,
    least: Option<f32>,
    mean: Option<f64>,
    greatest: Option<f32>,
    /// Number of values that are infinite or no numbers.
    not_finite: usize,
}

impl Channel {
    fn of(name: &str, data: &[f32]) -> Self {
        let finite = || data.iter().copied().filter(|v| v.is_finite());
        let count = finite().count();
        Self {
            name: name.into(),
            least: finite().reduce(f32::min),
            mean: (count > 0).then(|| finite().map(f64::from).sum::<f64>() / count as f64),
            greatest: finite().reduce(f32::max),
            not_finite: data.len() - count,
        }
    }
}

/// The kind of a picture, by its extension or, where that is none of a scene's, by what the file begins with.
pub fn kind(path: &Path) -> Option<FileKind> {
    // Opening a pipe would wait for what comes.
    if !path.metadata().is_ok_and(|m| m.is_file()) {
        return None;
    }
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if extension == "gz" || extensions().any(|known| known.0 == extension) {
        return None;
    }
    let mut head = Vec::new();
    File::open(path).ok()?.take(HEAD).read_to_end(&mut head).ok()?;
    FileKind::from_content(&head).or_else(|| FileKind::from_extension(path))
}

/// Reads a picture and tells what is in it.
pub fn tell(path: &Path, kind: FileKind, json: bool) -> Outcome {
    let image = read(path, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()))?;
    let info = Info::of(path, kind, &image);
    if json {
        terminal::json(&info)?;
    } else {
        terminal::data(info.text().as_bytes())?;
    }
    Ok(failure::DONE)
}

impl Info {
    fn of(path: &Path, kind: FileKind, image: &Image) -> Self {
        let shown = |value: &Value| match value {
            Value::Text(text) => text.clone(),
            Value::Float(v) => v.to_string(),
            Value::Int(v) => v.to_string(),
            Value::Matrix(m) => m.map(|v| v.to_string()).join(" "),
        };
        Self {
            schema: 1,
            picture: path.display().to_string(),
            format: kind.to_string(),
            width: image.width(),
            height: image.height(),
            channels: image.channels().iter().map(|c| Channel::of(&c.name, &c.data)).collect(),
            metadata: image.metadata.entries.iter().map(|(name, value)| (name.clone(), shown(value))).collect(),
        }
    }

    fn text(&self) -> String {
        let mut out = format!("{}: {}, {} x {} pixels\n", self.picture, self.format, self.width, self.height);
        let names = self.channels.iter().map(|c| c.name.chars().count());
        let width = names.max().unwrap_or(0).max(7);
        let _ = writeln!(out, "{:width$}  {:>12} {:>12} {:>12}", "channel", "least", "mean", "greatest");
        let number = |v: Option<f64>| v.map_or("none".to_owned(), |v| format!("{v:.6}"));
        for c in &self.channels {
            let [least, mean, greatest] = [c.least.map(f64::from), c.mean, c.greatest.map(f64::from)].map(number);
            let bad = if c.not_finite > 0 { format!("  {} not finite", c.not_finite) } else { String::new() };
            let _ = writeln!(out, "{:width$}  {least:>12} {mean:>12} {greatest:>12}{bad}", c.name);
        }
        for (name, value) in &self.metadata {
            let _ = writeln!(out, "{name}: {value}");
        }
        out.push_str(
            "values are linear; `steradian compare` compares two pictures, `steradian convert` writes other formats\n",
        );
        out
    }
}

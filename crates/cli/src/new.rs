//! `steradian new`: packages to begin with.

use crate::{
    failure::{self, Failure, Outcome},
    terminal,
};
use clap::{Args, Subcommand};
use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};
use steradian::plugin::{Library, package};

/// Arguments of `new`.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Kind of package.
    #[command(subcommand)]
    pub kind: Kind,
}

/// Kinds of packages.
#[derive(Debug, Subcommand)]
pub enum Kind {
    /// Write a Rust package with a material of one's own, a test of its laws, a scene, and a program that renders it
    #[command(override_usage = "steradian new plugin NAME [OPTIONS]")]
    Plugin(PluginArgs),
}

/// Arguments of `new plugin`.
#[derive(Debug, Args)]
pub struct PluginArgs {
    /// Name of the package: letters, digits, - and _
    #[arg(value_name = "NAME", value_parser = name)]
    pub name: String,
    /// Folder to write, which must not be there [default: NAME]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Folder of the crate `steradian` of a checkout, or REPOSITORY#TAG; by default the published version
    #[arg(long, value_name = "LIBRARY")]
    pub library: Option<String>,
}

/// A name that cargo takes.
fn name(text: &str) -> Result<String, String> {
    let is_name = text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    match is_name {
        true if text == "steradian" || text == "test" => Err(format!("a package cannot be called '{text}'")),
        true => Ok(text.into()),
        false => Err("a package's name begins with a letter, and has letters, digits, - and _".into()),
    }
}

/// Place of the library.
fn library(given: Option<&str>) -> Result<Library, Failure> {
    let Some(text) = given else { return Ok(Library::Published) };
    let folder = Path::new(text);
    if folder.join("Cargo.toml").is_file() {
        let absolute = folder.canonicalize().map_err(|e| Failure::bad_input(format!("cannot find '{text}': {e}")))?;
        let path =
            absolute.to_str().ok_or_else(|| Failure::bad_input(format!("'{text}' is no text that cargo takes")))?;
        return Ok(Library::Folder(path.into()));
    }
    match text.rsplit_once('#') {
        Some((git, tag)) if !git.is_empty() && !tag.is_empty() => Ok(Library::Tag(git.into(), tag.into())),
        _ => Err(Failure::bad_input(format!(
            "'{text}' is neither the folder of a crate, which has a Cargo.toml, nor REPOSITORY#TAG"
        ))),
    }
}

/// Writes the package, into a folder that is not there yet.
pub fn run(args: &NewArgs) -> Outcome {
    let Kind::Plugin(args) = &args.kind;
    let library = library(args.library.as_deref())?;
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from(&args.name));
    let failed = |e: std::io::Error| Failure::failed(format!("cannot write '{}': {e}", folder.display()));
    fs::create_dir(&folder).map_err(|e| match e.kind() {
        ErrorKind::AlreadyExists => Failure::bad_input(format!("'{}' is there already", folder.display())),
        _ => failed(e),
    })?;
    let write = |(path, text): (&str, String)| {
        let path = folder.join(path);
        path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, text))
    };
    if let Err(e) = package(&args.name, &library).into_iter().try_for_each(write) {
        // A part of a package is of no use; what cannot be removed stays.
        let _ = fs::remove_dir_all(&folder);
        return Err(failed(e));
    }
    let next = format!("cd {} && cargo run --release -- scene.steradian picture.png", folder.display());
    terminal::data(format!("{next}\n").as_bytes())?;
    Ok(failure::DONE)
}

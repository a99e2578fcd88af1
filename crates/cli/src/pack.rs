//! `steradian pack`: a scene and all files that it names in one archive.

use crate::{
    failure::{self, Failure, Outcome},
    memory, open, output,
    terminal::{self, Terminal},
};
use clap::Args;
use serde::Serialize;
use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};
use steradian::{
    CompileOptions, Inputs, LoadedScene,
    archive::{self, EXTENSION, Packed},
    image::{self, TemporaryFolder},
    resume,
};

/// `steradian pack`.
#[derive(Args, Debug)]
#[command(after_help = "Every command that takes a scene takes the archive: steradian render SCENE.zip")]
pub struct PackArgs {
    /// Scene file
    pub scene: PathBuf,
    /// Archive to write
    #[arg(short, long, value_name = "OUT.zip")]
    pub output: PathBuf,
    /// Set what -D sets in render, where files depend on it. Repeatable
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = crate::values::definition)]
    pub define: Vec<(String, String)>,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Summary, as `--json` prints it.
#[derive(Serialize)]
struct Summary<'a> {
    schema: u32,
    archive: &'a Path,
    files: usize,
    bytes: u64,
    archive_bytes: u64,
}

/// Packs the scene, and reads it back to see that all of it is there.
pub fn run(args: &PackArgs, terminal: Terminal) -> Outcome {
    let (scene, archive) = (&*args.scene, &*args.output);
    if !archive.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION)) {
        let name = archive.display();
        return Err(Failure::bad_input(format!("'{name}' is not called .{EXTENSION}, by which archives are known")));
    }
    if !open::is_file(scene) || archive::split(scene).is_some() {
        return Err(Failure::bad_input(format!("'{}' is no scene file with files beside it", scene.display())));
    }
    let unreadable = |e| Failure::failed(format!("cannot read the scene's files again: {e}"));
    let (files, print) = {
        let loaded = load(scene, &args.define);
        let print = resume::fingerprint(&loaded.desc).map_err(unreadable)?;
        let named = loaded.desc.files().chain(loaded.files.iter().map(PathBuf::as_path));
        let files: Vec<PathBuf> = named.map(Path::to_path_buf).collect();
        open::ready(loaded, scene, false, terminal)?;
        (files, print)
    };
    let inputs = Inputs::of(files.iter().map(PathBuf::as_path).chain([scene]));
    output::claim([archive], &inputs)?;
    let failed = |why: archive::ArchiveError| Failure::failed(format!("'{}' {why}", archive.display()));
    // An older archive stays until the new one is known to be good.
    let folder = TemporaryFolder::new("steradian-")
        .map_err(|e| Failure::failed(format!("there is no temporary folder: {e}")))?;
    let packed = folder.path().join("scene.zip");
    let Packed { files, bytes } = archive::pack(scene, files.iter().map(PathBuf::as_path), &packed).map_err(failed)?;
    // Files that the scene names by where they lie, from the root on, are not found in another place.
    let unpacked = archive::unpack(&packed, Path::new("")).map_err(failed)?;
    let again = load(&unpacked.scene, &args.define);
    if again.diagnostics.has_errors() || resume::fingerprint(&again.desc).map_err(unreadable)? != print {
        crate::diagnostics::tell(&again.diagnostics, terminal);
        let name = archive.display();
        let why = "not all files are found in it; does the scene name some by paths from the root on?";
        return Err(Failure::bad_input(format!("'{name}' was not kept: {why}")));
    }
    let copied = image::stream_whole(archive, |out| io::copy(&mut File::open(&packed)?, out).map(drop));
    copied.map_err(|e| Failure::failed(e.to_string()))?;
    let archive_bytes = fs::metadata(&packed).map_or(0, |m| m.len());
    let sizes = [bytes, archive_bytes].map(memory::readable);
    terminal.say(&format!("packed {files} files, {} in {}: {}", sizes[0], sizes[1], archive.display()));
    if args.json {
        terminal::json(&Summary { schema: 1, archive, files, bytes, archive_bytes })?;
    }
    Ok(failure::DONE)
}

fn load(scene: &Path, define: &[(String, String)]) -> LoadedScene {
    steradian::load(scene, &open::reading(define, None)).compile(&CompileOptions::default())
}

//! Disks that are full after any number of bytes, for which a limit on the size of files stands (RLIMIT_FSIZE: writes
//! take a part, then fail): a command says which file, ends with an error, and what was there stays as it was.

use crate::Place;
use std::{collections::BTreeMap, path::PathBuf, process::Command};

/// Runs a command where files may have so many blocks of 512 bytes; code and stderr.
fn limited(place: &Place, blocks: usize, line: &[&str]) -> (i32, String) {
    let program = place.command(&[]).get_program().to_owned();
    let script = format!("ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut shell = Command::new("sh");
    // What cannot be written anywhere is kept among the temporary files, which are full as well.
    let run = shell.args(["-c", &script]).arg(program).args(line).current_dir(&place.0).output().unwrap();
    (run.status.code().unwrap_or(-1), String::from_utf8(run.stderr).unwrap())
}

/// All files of the place.
fn files(place: &Place) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut all, mut folders) = (BTreeMap::new(), vec![place.0.path().to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path)
            } else {
                drop(all.insert(path.clone(), std::fs::read(path).unwrap()))
            }
        }
    }
    all
}

/// Each command with a limit of more and more blocks until it succeeds, beginning with the files that `prepare` makes.
fn sweep(prepare: impl Fn(&Place), line: &[&str], outputs: &[&str]) {
    let (mut blocks, mut failures) = (0, 0);
    loop {
        let place = Place::new();
        prepare(&place);
        for output in outputs {
            place.file(output, "what was there before");
        }
        let before = files(&place);
        let (code, said) = limited(&place, blocks, line);
        let after = files(&place);
        if code == 0 {
            assert!(outputs.iter().all(|output| after[&place.path(output)] != before[&place.path(output)]));
            break;
        }
        failures += 1;
        assert!([1, 75].contains(&code), "{line:?} with {blocks} blocks: {code}: {said}");
        assert!(said.contains("too large"), "{line:?} with {blocks} blocks: {said}");
        for (path, bytes) in &before {
            let now = after.get(path).unwrap_or_else(|| panic!("{line:?} with {blocks} blocks: {path:?} is lost"));
            // Outputs are whole: those that come before the one that has no room are new.
            let is_output = outputs.iter().any(|output| place.path(output) == *path);
            assert!(now == bytes || is_output && now.len() > bytes.len(), "{line:?} with {blocks} blocks: {path:?}");
        }
        let is_draft = |path: &&PathBuf| path.file_name().unwrap().to_string_lossy().starts_with(".steradian-");
        assert_eq!(after.keys().find(is_draft), None, "{line:?} with {blocks} blocks");
        blocks = if blocks == 0 { 1 } else { 2 * blocks };
        assert!(blocks < 1 << 20, "{line:?} never succeeds: {said}");
    }
    assert!(failures > 0, "{line:?} writes nothing");
}

const SMALL: [&str; 6] = ["--size", "40x33", "--spp", "2", "--compression", "none"];

#[test]
fn pictures_states_and_scenes_stay() {
    let render = [&["render", "builtin:cornell-box", "-o", "a.exr", "-o", "b.png"], &SMALL[..]].concat();
    sweep(|_| {}, &render, &["a.exr", "b.png"]);
    // A state that is there, whose render has samples to go.
    let resumed = [&["render", "builtin:cornell-box", "-o", "a.exr", "--resume", "state"], &SMALL[..]].concat();
    let prepare = |place: &Place| {
        let fewer =
            ["render", "builtin:cornell-box", "--size", "40x33", "--spp", "1", "-o", "a.exr", "--resume", "state"];
        place.succeed(&fewer);
    };
    sweep(prepare, &resumed, &["a.exr"]);
    sweep(|_| {}, &["convert", "builtin:cornell-box", "a.steradian"], &["a.steradian"]);
    let scene = |place: &Place| {
        place.file("a.steradian", &std::fs::read_to_string("../../scenes/shapes.steradian").unwrap());
    };
    sweep(scene, &["pack", "a.steradian", "-o", "a.zip"], &["a.zip"]);
}

#[test]
fn chunks_and_their_pictures_stay() {
    let planned = |place: &Place| {
        place.succeed(&["plan", "builtin:cornell-box", "--size", "40x33", "--spp", "2", "-o", "job", "--chunks", "2"]);
    };
    sweep(planned, &["chunk", "job", "0..1"], &[]);
    let computed = |place: &Place| {
        planned(place);
        place.succeed(&["chunk", "job", "0..1"]);
    };
    sweep(computed, &["merge", "job", "-o", "a.exr", "--quiet"], &["a.exr"]);
}

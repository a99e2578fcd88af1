//! `steradian render --frames A..B`: the pictures of an animation, one after the other.

use crate::{
    args::RenderArgs,
    failure::{self, Failure, Outcome},
    output, render,
    terminal::Terminal,
    values::Frames,
};
use std::path::{Path, PathBuf};

/// Digits of a frame's number.
const DIGITS: usize = 4;

/// Renders each frame as if its moment were given by `-D at=…`. Methods that go on from the frame before do so.
pub fn run(args: &RenderArgs, frames: Frames, terminal: Terminal) -> Outcome {
    let Some(scene) = args.scene.as_deref().filter(|scene| is_gltf(scene)) else {
        return Err(Failure::bad_input("--frames takes a scene with animations, which .gltf and .glb files have"));
    };
    if args.resume.is_some() {
        return Err(Failure::bad_input("--resume keeps one picture; it cannot go with --frames"));
    }
    if args.scene_options.define.iter().any(|(name, _)| name == "at") {
        return Err(Failure::bad_input("--frames names the moments of all frames; it cannot go with -D at=SECONDS"));
    }
    let outputs = if args.output.is_empty() { output::default_names(scene) } else { args.output.clone() };
    let mut history = None;
    for frame in frames.first..=frames.last {
        let mut one = args.clone();
        one.output = outputs.iter().map(|path| numbered(path, frame)).collect();
        let seconds = f64::from(frame) / args.fps;
        one.frame = frame;
        one.scene_options.define.push(("at".into(), seconds.to_string()));
        let code = render::run_after(&one, terminal, &mut history)?;
        if code != failure::DONE {
            return Ok(code);
        }
    }
    Ok(failure::DONE)
}

fn is_gltf(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf") || e.eq_ignore_ascii_case("glb"))
}

/// `walk.exr` becomes `walk.0012.exr`.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{frame:0DIGITS$}.{extension}"))
}

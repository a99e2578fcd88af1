//! `steradian render --frames A..B`: the pictures of an animation, one after the other.

use crate::{
    args::RenderArgs,
    failure::{self, Failure, Outcome},
    open, output, render,
    sequence_state::SequenceState,
    terminal::Terminal,
    values::Frames,
};
use std::path::{Path, PathBuf};
use steradian::{
    Layer,
    archive::{self, ArchiveError, UnpackedScene},
    math::DVec3,
};

/// Most moments by which automatic cameras are framed.
const MOST_FRAMED: u32 = 17;
/// Digits of a frame's number.
const DIGITS: usize = 4;

/// Renders each frame as if its moment were given by `-D at=…`. Methods and denoisers that go on from the frame before
/// do so.
pub fn run(args: &RenderArgs, frames: Frames, terminal: Terminal) -> Outcome {
    check(args)?;
    // An archive is unpacked once for all frames.
    let unpacked = args.scene.as_deref().map_or(Ok(None), unpacked)?;
    let named = RenderArgs { output: outputs(args), ..args.clone() };
    let args = &match &unpacked {
        Some(there) => RenderArgs { scene: Some(there.scene.clone()), ..named },
        None => named,
    };
    if args.temporal && args.aov.iter().any(|layers| layers.0.contains(&Layer::HALVES)) {
        terminal.warn("the error that remains is not estimated where frames are denoised with those before");
    }
    let mut before = SequenceState::default();
    let framing = framing(args, frames);
    for frame in frames.first..=frames.last {
        let code = render::run_after(&one(args, frame, framing), terminal, &mut before)?;
        if code != failure::DONE {
            return Ok(code);
        }
    }
    Ok(failure::DONE)
}

/// Refuses what no sequence can be rendered with.
pub fn check(args: &RenderArgs) -> Result<(), Failure> {
    let unpacked = args.scene.as_deref().map_or(Ok(None), unpacked)?;
    if !unpacked.as_ref().map(|there| &*there.scene).or(args.scene.as_deref()).is_some_and(open::is_gltf) {
        return Err(Failure::bad_input("--frames takes a scene with animations, which .gltf and .glb files have"));
    }
    if args.resume.is_some() {
        return Err(Failure::bad_input("--resume keeps one picture; it cannot go with --frames"));
    }
    if args.scene_options.define.iter().any(|(name, _)| name == "at") {
        return Err(Failure::bad_input("--frames names the moments of all frames; it cannot go with -D at=SECONDS"));
    }
    Ok(())
}

/// The render of a frame alone, with the [`framing`] of all of them.
pub fn one(args: &RenderArgs, frame: u32, framing: Option<[DVec3; 2]>) -> RenderArgs {
    let mut one = args.clone();
    one.output = outputs(args).iter().map(|path| numbered(path, frame)).collect();
    one.frame = frame;
    one.scene_options.framing = framing;
    one.scene_options.define.push(("at".into(), (f64::from(frame) / args.fps).to_string()));
    one
}

/// The pictures, by the names that they have without the frame's number.
fn outputs(args: &RenderArgs) -> Vec<PathBuf> {
    match (&*args.output, &args.scene) {
        ([], Some(scene)) => output::default_names(scene),
        (outputs, _) => outputs.to_vec(),
    }
}

/// The scene of an archive; `None` for one that is in none.
fn unpacked(scene: &Path) -> Result<Option<UnpackedScene>, Failure> {
    let Some((path, name)) = archive::split(scene) else { return Ok(None) };
    let failed = |why: ArchiveError| Failure::bad_input(format!("'{}' {why}", path.display()));
    archive::unpack(path, name).map(Some).map_err(failed)
}

/// The box that automatic cameras show, so that they stand still: of some frames, first and last among them.
pub fn framing(args: &RenderArgs, frames: Frames) -> Option<[DVec3; 2]> {
    let steps = (frames.last - frames.first).min(MOST_FRAMED - 1);
    let moment = |k: u32| {
        let share = f64::from(k) / f64::from(steps.max(1));
        (f64::from(frames.first) + share * f64::from(frames.last - frames.first)) / args.fps
    };
    let moments: Vec<f64> = (0..=steps).map(moment).collect();
    let scene = args.scene.as_deref()?;
    let unpacked = unpacked(scene).ok()?;
    let scene = unpacked.as_ref().map_or(scene, |there| &there.scene);
    steradian::load::framing(scene, &open::reading(&args.scene_options.define, None), &moments)
}

/// `walk.exr` becomes `walk.0012.exr`.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{frame:0DIGITS$}.{extension}"))
}

//! `steradian render --frames A..B`: the pictures of an animation, one after the other.

use crate::{
    args::RenderArgs,
    failure::{self, Failure, Outcome},
    film::Films,
    open, output, render,
    sequence_state::SequenceState,
    terminal::Terminal,
    values::Frames,
};
use std::path::{Path, PathBuf};
use steradian::{
    Inputs, Layer,
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
    // An archive is unpacked once for all frames.
    let unpacked = args.scene.as_deref().map_or(Ok(None), unpacked)?;
    let mut named = RenderArgs { output: outputs(args), ..args.clone() };
    let films = Films::among(&mut named.output)?;
    if let Some(films) = &films {
        output::claim(films.paths(), &Inputs::of(args.scene.as_deref()))?;
        named.output.push(films.picture());
    }
    let args = &match &unpacked {
        Some(there) => RenderArgs { scene: Some(there.scene.clone()), ..named },
        None => named,
    };
    check(args)?;
    if args.temporal && args.aov.iter().any(|layers| layers.0.contains(&Layer::HALVES)) {
        terminal.warn("the error that remains is not estimated where frames are denoised with those before");
    }
    let mut before = SequenceState::default();
    let framing = framing(args, frames);
    let mut pictures = Vec::new();
    for frame in frames.first..=frames.last {
        let (number, all) = (frame - frames.first + 1, frames.last - frames.first + 1);
        terminal.say(&format!("frame {number} of {all}"));
        let code = render::run_after(&one(args, frame, framing), terminal, &mut before)?;
        if code != failure::DONE {
            return Ok(code);
        }
        pictures.extend(films.as_ref().map(|films| numbered(&films.picture(), frame)));
    }
    if let Some(films) = films {
        films.make(&pictures, args.fps)?;
        let made: Vec<PathBuf> = films.paths().map(Path::to_path_buf).collect();
        terminal.say(&format!("wrote {}", output::listed(&made)));
    }
    Ok(failure::DONE)
}

/// The frames of a sequence that is asked for.
pub fn of(args: &RenderArgs) -> Option<Frames> {
    args.frames.or(args.turntable.map(|count| Frames { first: 0, last: count - 1 }))
}

/// Refuses what no sequence can be rendered with.
pub fn check(args: &RenderArgs) -> Result<(), Failure> {
    let unpacked = args.scene.as_deref().map_or(Ok(None), unpacked)?;
    if args.turntable.is_some() {
        let scene = unpacked.as_ref().map(|there| &*there.scene).or(args.scene.as_deref());
        if !scene.is_some_and(|scene| open::is_gltf(scene) || open::is_model(scene)) {
            return Err(Failure::bad_input(
                "--turntable takes a model or a glTF scene, whose camera is the program's own",
            ));
        }
        if args.scene_options.look_at.is_some() || args.scene_options.camera.is_some() {
            return Err(Failure::bad_input("--turntable places the camera; it cannot go with --look-at and --camera"));
        }
    } else if !unpacked.as_ref().map(|there| &*there.scene).or(args.scene.as_deref()).is_some_and(open::is_gltf) {
        return Err(Failure::bad_input("--frames takes a scene with animations, which .gltf and .glb files have"));
    }
    if args.resume.is_some() {
        return Err(Failure::bad_input("--resume keeps one picture; it cannot go with a sequence"));
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
    let define = &mut one.scene_options.define;
    match args.turntable {
        Some(count) => {
            // From the side that was asked for, or the front.
            let named = define.iter().rposition(|(name, _)| name == "azimuth").map(|at| define.remove(at).1);
            let first: f64 = named.and_then(|side| side.parse().ok()).unwrap_or(0.0);
            let side = (first + 360.0 * f64::from(frame) / f64::from(count)) % 360.0;
            define.push(("azimuth".into(), side.to_string()));
        }
        None => define.push(("at".into(), (f64::from(frame) / args.fps).to_string())),
    }
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
    if args.turntable.is_some() {
        return None;
    }
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

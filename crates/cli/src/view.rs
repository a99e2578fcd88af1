//! `steradian view`: a scene in the browser while it renders, or finished pictures.

use crate::{
    args::{Color, ViewArgs, ViewDenoiser},
    brightness::Exposure,
    diagnostics,
    failure::{DONE, Failure, Outcome},
    memory, open, picture, terminal,
    terminal::Terminal,
    values::Size,
};
use std::{path::PathBuf, process::Command, sync::Arc};
use steradian::{
    denoise,
    image::{FileKind, tone::Tone},
};
use steradian_server::{Denoiser, Error, Options, Pictures, SettingsChange, Source, StartExposure, View};

/// The built-in scene that is shown where none is named.
const DEFAULT: &str = "builtin:cornell-box";

/// Serves the page until it is stopped.
pub fn run(args: &ViewArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.threads);
    if let Some(Exposure::Stops(stops)) = args.exposure {
        Tone::default().with_exposure(stops).map_err(|e| Failure::bad_input(e.to_string()))?;
    }
    let view = match subject(&args.files)? {
        Subject::Scene(name) => scene(args, name, terminal)?,
        Subject::Pictures => pictures(args, terminal)?,
    };
    terminal::data(format!("{}\n", view.url()).as_bytes())?;
    terminal.say("the page is at this address; Ctrl-C ends it");
    if args.open && !opened(view.url()) {
        terminal.warn("no browser could be started: open the address by hand");
    }
    view.wait();
    Ok(DONE)
}

/// Subject of a view.
enum Subject {
    Scene(PathBuf),
    Pictures,
}

/// The subject that files name: one scene, or pictures and folders of them.
fn subject(files: &[PathBuf]) -> Result<Subject, Failure> {
    let is_picture = |path: &PathBuf| {
        // One that is missing is a picture by its name.
        path.is_dir() || picture::kind(path).is_some() || !path.exists() && FileKind::from_extension(path).is_some()
    };
    match (files.iter().find(|f| is_picture(f)), files.iter().find(|f| !is_picture(f))) {
        (Some(_), None) => Ok(Subject::Pictures),
        (Some(picture), Some(scene)) => Err(Failure::bad_input(format!(
            "'{}' is a scene and '{}' is none: a view shows one scene, or pictures and folders of them",
            scene.display(),
            picture.display()
        ))),
        (None, _) if files.len() > 1 => {
            Err(Failure::bad_input(format!("a view shows one scene, not {}: or pictures and folders", files.len())))
        }
        (None, scene) => Ok(Subject::Scene(scene.cloned().unwrap_or_else(|| PathBuf::from(DEFAULT)))),
    }
}

/// Serves finished pictures.
fn pictures(args: &ViewArgs, terminal: Terminal) -> Result<View, Failure> {
    let of_scenes = [
        ("--integrator", args.integrator.is_some()),
        ("--spp", args.spp.is_some()),
        ("--size", args.size.is_some()),
        ("--camera", args.camera.is_some()),
        ("--look-at", args.look_at.is_some()),
        ("--color", args.color != Color::Auto),
        ("--sampler", args.sampler.is_some()),
        ("--seed", args.seed.is_some()),
        ("--max-depth", args.max_depth.is_some()),
        ("--denoise", args.denoise.is_some()),
        ("-D", !args.define.is_empty()),
        ("--oidn", args.oidn.is_some()),
    ];
    if let Some((option, _)) = of_scenes.iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::bad_input(format!("{option} is for scenes; pictures are shown as they are")));
    }
    let options = Pictures {
        files: args.files.clone(),
        tone: args.tonemap.clone(),
        exposure: args.exposure.map(start),
        bind: args.bind.clone(),
        port: args.port,
        log: Arc::new(move |line| terminal.say(line)),
    };
    View::pictures(&options).map_err(|e| match e {
        Error::Pictures(why) => Failure::bad_input(why),
        other => Failure::failed(other.to_string()),
    })
}

fn start(exposure: Exposure) -> StartExposure {
    match exposure {
        Exposure::Auto => StartExposure::Auto,
        Exposure::Stops(stops) => StartExposure::Stops(stops),
    }
}

/// Serves a scene.
fn scene(args: &ViewArgs, name: PathBuf, terminal: Terminal) -> Result<View, Failure> {
    if open::is_stdin(&name) {
        return Err(Failure::bad_input("a scene that is looked at is a file, not standard input"));
    }
    let library = denoise::oidn_library(args.oidn.as_deref());
    if args.oidn.is_some() {
        library.as_ref().map_err(|why| Failure::bad_input(why.clone()))?;
    }
    let size = args.size.map(|Size(w, h)| (w, h));
    let options = Options {
        source: Source {
            name: name.clone(),
            reading: open::reading(&args.define, None),
            scene: None,
            memory: Some(memory::available),
        },
        settings: SettingsChange {
            integrator: args.integrator.clone(),
            spp: args.spp.map(Some),
            width: size.map(|s| s.0),
            height: size.map(|s| s.1),
            sampler: args.sampler.clone().map(Some),
            color: match args.color {
                Color::Auto => None,
                Color::Rgb => Some("rgb".into()),
                Color::Spectral => Some("spectral".into()),
            },
            seed: args.seed.map(Some),
            max_depth: args.max_depth.map(|d| Some(u32::try_from(d).unwrap_or(u32::MAX))),
            denoise: args.denoise.flatten().map(|denoiser| match denoiser {
                ViewDenoiser::Off => None,
                ViewDenoiser::Nlm => Some(Denoiser::Nlm),
                ViewDenoiser::Atrous => Some(Denoiser::Atrous),
                ViewDenoiser::Oidn => Some(Denoiser::Oidn),
            }),
            ..SettingsChange::default()
        },
        camera: args.camera.clone(),
        look_at: args.look_at,
        tone: args.tonemap.clone(),
        exposure: args.exposure.map(start),
        bind: args.bind.clone(),
        port: args.port,
        oidn: library,
        log: Arc::new(move |line| terminal.say(line)),
    };
    View::start(&options).map_err(|e| match e {
        Error::Scene(messages) => {
            diagnostics::tell(&messages, terminal);
            Failure::bad_input(format!("'{}' cannot be shown", name.display()))
        }
        other => Failure::failed(other.to_string()),
    })
}

/// Opens an address in a browser; true if the system does.
fn opened(url: &str) -> bool {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    Command::new(program).arg(url).spawn().is_ok()
}

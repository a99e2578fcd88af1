//! `steradian view`: a scene in the browser while it renders.

use crate::{
    args::{Color, ViewArgs, ViewDenoiser},
    brightness::Exposure,
    diagnostics,
    failure::{DONE, Failure, Outcome},
    memory, open, terminal,
    terminal::Terminal,
    values::Size,
};
use std::{path::PathBuf, process::Command, sync::Arc};
use steradian::{denoise, image::tone::Tone};
use steradian_server::{Denoiser, Error, Options, SettingsChange, Source, StartExposure, View};

/// The built-in scene that is shown where none is named.
const DEFAULT: &str = "builtin:cornell-box";

/// Serves the page until it is stopped.
pub fn run(args: &ViewArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.threads);
    let name = args.scene.clone().unwrap_or_else(|| PathBuf::from(DEFAULT));
    if open::is_stdin(&name) {
        return Err(Failure::bad_input("a scene that is looked at is a file, not standard input"));
    }
    let library = denoise::oidn_library(args.oidn.as_deref());
    if args.oidn.is_some() {
        library.as_ref().map_err(|why| Failure::bad_input(why.clone()))?;
    }
    if let Some(Exposure::Stops(stops)) = args.exposure {
        Tone::default().with_exposure(stops).map_err(|e| Failure::bad_input(e.to_string()))?;
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
        exposure: args.exposure.map(|exposure| match exposure {
            Exposure::Auto => StartExposure::Auto,
            Exposure::Stops(stops) => StartExposure::Stops(stops),
        }),
        bind: args.bind.clone(),
        port: args.port,
        oidn: library,
        log: Arc::new(move |line| terminal.say(line)),
    };
    let view = View::start(&options).map_err(|e| match e {
        Error::Scene(messages) => {
            diagnostics::tell(&messages, terminal);
            Failure::bad_input(format!("'{}' cannot be shown", name.display()))
        }
        other => Failure::failed(other.to_string()),
    })?;
    terminal::data(format!("{}\n", view.url()).as_bytes())?;
    terminal.say("the page is at this address; Ctrl-C ends it");
    if args.open && !opened(view.url()) {
        terminal.warn("no browser could be started: open the address by hand");
    }
    view.wait();
    Ok(DONE)
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

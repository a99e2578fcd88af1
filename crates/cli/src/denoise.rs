//! `steradian denoise`: a picture without its noise.

use crate::{
    args::DenoiseArgs,
    failure::{self, Failure, Outcome},
    open, output,
    terminal::Terminal,
};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};
use steradian::{
    Inputs,
    denoise::{self, GUIDES},
    image::{self, FileKind, Limits, WriteOptions},
};

/// Reads, filters, tells by what, writes.
pub fn run(args: &DenoiseArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.threads);
    args.output.iter().try_for_each(|path| output::kind(path).map(|_| ()))?;
    let inputs = Inputs::of(std::iter::once(&args.input).chain(&args.half).map(PathBuf::as_path));
    output::claim(args.output.iter().map(PathBuf::as_path), &inputs)?;
    let premultiplied = matches!(FileKind::from_extension(&args.input), Some(FileKind::Exr));
    let options = args.files.write_options().map_err(Failure::bad_input)?;
    let options = WriteOptions { premultiplied, ..options };
    let read = |path: &Path| image::read(path, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()));
    let (noisy, half) = (read(&args.input)?, args.half.as_deref().map(read).transpose()?);
    let start = Instant::now();
    let denoised = denoise::picture(&noisy, half.as_ref(), args.strength);
    let denoised = denoised.map_err(|e| Failure::bad_input(format!("'{}': {e}", args.input.display())))?;
    tell(&denoised, terminal);
    terminal.say(&format!("denoised in {:.2} s", start.elapsed().as_secs_f64()));
    let written = output::save(&args.output, &denoised.picture, &options, true)?;
    terminal.say(&format!("wrote {}", output::listed(&written)));
    Ok(failure::DONE)
}

/// Says which layers guided, and how those come that were missing.
pub fn tell(denoised: &denoise::Outcome, terminal: Terminal) {
    let listed = |layers: &[steradian::Layer]| layers.iter().map(|l| l.name()).collect::<Vec<_>>().join(", ");
    if denoised.used.is_empty() {
        terminal.say("guided by colour alone");
    } else {
        terminal.say(&format!("guided by the layers {}", listed(&denoised.used)));
    }
    if !denoised.missing.is_empty() {
        let all = GUIDES.map(|l| l.name()).join(",");
        terminal.warn(&format!(
            "the layers {} are missing, which would guide better: steradian render SCENE --aov {all} writes them",
            listed(&denoised.missing)
        ));
    }
    if denoised.not_finite > 0 {
        terminal.warn(&format!("{} pixels were not finite, and are filled from their neighbours", denoised.not_finite));
    }
    if let Some(error) = denoised.error {
        terminal.say(&format!("estimated relative error of what remains: {:.2} %", 100.0 * error));
    }
}

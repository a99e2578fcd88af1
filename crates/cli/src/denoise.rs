//! `steradian denoise`: a picture without its noise.

use crate::{
    args::{DenoiseArgs, Denoiser},
    brightness,
    failure::{self, Failure, Outcome},
    open, output,
    terminal::Terminal,
};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};
use steradian::{
    Inputs, Layer,
    denoise::{self, GUIDES, OIDN_GUIDES, Oidn},
    image::{self, FileKind, Image, Limits, WriteOptions, tone::Tone},
};

/// Denoiser with its settings.
#[derive(Debug)]
pub enum Filter {
    /// The built-in filter, of a strength.
    NonLocalMeans(f32),
    /// The built-in filter for previews.
    Atrous,
    /// Open Image Denoise.
    Oidn(Oidn),
}

impl Filter {
    /// A denoiser; Open Image Denoise from a library, or where that is found.
    pub fn new(name: Denoiser, library: Option<&Path>, strength: f32, threads: u16) -> Result<Self, Failure> {
        match name {
            Denoiser::Atrous => Ok(Self::Atrous),
            Denoiser::Nlm => Ok(Self::NonLocalMeans(strength)),
            Denoiser::Oidn => {
                let path = denoise::oidn_library(library).map_err(Failure::bad_input)?;
                let failed = |e| {
                    let path = path.display();
                    Failure::bad_input(format!("'{path}': {e}; the denoiser nlm is built in"))
                };
                Ok(Self::Oidn(Oidn::load(&path, usize::from(threads)).map_err(failed)?))
            }
        }
    }

    /// The layers that guide it.
    fn guides(&self) -> &'static [Layer] {
        guides(matches!(self, Self::Oidn(_)))
    }

    /// A picture without its noise, and what to say of it.
    pub fn picture(&self, noisy: &Image, half: Option<&Image>) -> Result<denoise::Outcome, steradian::Error> {
        match self {
            Self::NonLocalMeans(strength) => denoise::picture(noisy, half, *strength),
            Self::Atrous => denoise::quick(noisy),
            Self::Oidn(oidn) => denoise::by_oidn(noisy, oidn),
        }
    }

    /// Says by what, and how long it took.
    pub fn tell(&self, seconds: f64, terminal: Terminal) {
        let by = match self {
            Self::NonLocalMeans(_) | Self::Atrous => String::new(),
            Self::Oidn(oidn) => {
                let [major, minor] = oidn.version();
                format!(" by Open Image Denoise {major}.{minor}")
            }
        };
        terminal.say(&format!("denoised{by} in {seconds:.2} s"));
    }
}

/// The denoiser of a name. Without one it is Open Image Denoise where a library is named, or one is found and it can do
/// what is asked for: it works neither on sequences nor with halves.
pub fn chosen(name: Option<Denoiser>, library: Option<&Path>, is_plain: bool) -> Denoiser {
    let has_oidn = || library.is_some() || is_plain && denoise::oidn_library(None).is_ok();
    name.unwrap_or_else(|| if has_oidn() { Denoiser::Oidn } else { Denoiser::Nlm })
}

/// The layers that guide the built-in filters, or Open Image Denoise.
pub fn guides(is_oidn: bool) -> &'static [Layer] {
    if is_oidn { &OIDN_GUIDES } else { &GUIDES }
}

/// Reads, filters, tells by what, writes.
pub fn run(args: &DenoiseArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.threads);
    args.output.iter().try_for_each(|path| output::kind(path).map(|_| ()))?;
    let inputs = Inputs::of(std::iter::once(&args.input).chain(&args.half).map(PathBuf::as_path));
    output::claim(args.output.iter().map(PathBuf::as_path), &inputs)?;
    let premultiplied = matches!(FileKind::from_extension(&args.input), Some(FileKind::Exr));
    let options = args.files.write_options_or(Tone::default()).map_err(Failure::bad_input)?;
    let mut options = WriteOptions { premultiplied, ..options };
    let read = |path: &Path| image::read(path, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()));
    let (noisy, half) = (read(&args.input)?, args.half.as_deref().map(read).transpose()?);
    let has_halves = noisy.layer_rgb(Layer::HALVES.prefix()).is_some();
    let is_plain = half.is_none() && args.strength.is_none() && !has_halves;
    let name = chosen(args.with, args.oidn.as_deref(), is_plain);
    if args.oidn.is_some() && name != Denoiser::Oidn {
        terminal.warn("--oidn has no effect: --with names another denoiser");
    }
    let filter = Filter::new(name, args.oidn.as_deref(), args.strength.unwrap_or(1.0), args.threads)?;
    if !matches!(filter, Filter::NonLocalMeans(_)) && (args.half.is_some() || args.strength.is_some()) {
        return Err(Failure::bad_input("--half and --strength are of the denoiser nlm"));
    }
    let start = Instant::now();
    let denoised = filter.picture(&noisy, half.as_ref());
    let denoised = denoised.map_err(|e| Failure::bad_input(format!("'{}': {e}", args.input.display())))?;
    tell(&denoised, filter.guides(), terminal);
    filter.tell(start.elapsed().as_secs_f64(), terminal);
    let exposure = brightness::automatic(&denoised.picture, &args.output, args.files.exposure, false);
    brightness::expose(&mut options, exposure, Some(terminal));
    let written = output::save(&args.output, &denoised.picture, &options, true)?;
    terminal.say(&format!("wrote {}", output::listed(&written)));
    Ok(failure::DONE)
}

/// Says which layers guided, and how those come that were missing.
fn tell(denoised: &denoise::Outcome, guides: &[Layer], terminal: Terminal) {
    let listed = |layers: &[Layer]| layers.iter().map(|l| l.name()).collect::<Vec<_>>().join(", ");
    if denoised.used.is_empty() {
        terminal.say("guided by colour alone");
    } else {
        terminal.say(&format!("guided by the layers {}", listed(&denoised.used)));
    }
    if !denoised.missing.is_empty() {
        let all = guides.iter().map(|l| l.name()).collect::<Vec<_>>().join(",");
        terminal.warn(&format!(
            "the layers {} are missing, which would guide better: steradian render SCENE --aov {all} writes them",
            listed(&denoised.missing)
        ));
    }
    if denoised.not_finite > 0 {
        terminal.warn(&format!("{} pixels were not finite, and are filled from their neighbours", denoised.not_finite));
    }
    tell_error(denoised.error, terminal);
}

/// Says how much error remains, where that is known: what halves have in common, such as lost detail, is not in it.
pub fn tell_error(error: Option<f64>, terminal: Terminal) {
    if let Some(error) = error {
        let percent = 100.0 * error;
        terminal.say(&format!(
            "estimated relative error of what remains: at least {percent:.2} % (noise; lost detail is not seen)"
        ));
    }
}

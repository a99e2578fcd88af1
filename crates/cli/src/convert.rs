//! `steradian convert`: a picture in another format; scenes are converted in `convert_scene`.

use crate::{
    args::ConvertArgs,
    convert_scene,
    failure::{self, Failure, Outcome},
    output,
    terminal::Terminal,
};
use steradian::{
    Inputs, Layer,
    image::{self, FileKind, Image, Limits, WriteOptions},
    scene::names::did_you_mean,
};

/// Reads, maps, writes.
pub fn run(args: &ConvertArgs, terminal: Terminal) -> Outcome {
    if convert_scene::is_scene(&args.input) || convert_scene::is_scene(&args.output) {
        return convert_scene::run(args, terminal);
    }
    if args.check || args.strict || args.report.is_some() || !args.define.is_empty() || args.format.is_some() {
        return Err(Failure::bad_input(
            "--check, --strict, --report, -D and --format are for scenes; 'steradian compare' compares pictures",
        ));
    }
    output::kind(&args.output)?;
    output::claim([args.output.as_path()], &Inputs::of([args.input.as_path()]))?;
    let mut options = args.files.write_options().map_err(Failure::bad_input)?;
    // Colours of a legend are no radiance.
    options.ppm_radiance &= args.false_color.is_none();
    let premultiplied = matches!(FileKind::from_extension(&args.input), Some(FileKind::Exr));
    let options = WriteOptions { premultiplied, ..options };
    let picture = image::read(&args.input, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()))?;
    let mut picture = match &args.layer {
        Some(name) => layer(&picture, name)?,
        None => picture,
    };
    if let Some(sensor) = &args.sensor {
        picture.require_rgb().map_err(|e| Failure::bad_input(e.to_string()))?;
        let origin = picture.offset;
        sensor.expose(&mut picture, origin);
    }
    if let Some(false_color) = &args.false_color {
        let (shown, not_finite) = false_color.picture(&picture).map_err(|e| Failure::bad_input(e.to_string()))?;
        if not_finite > 0 {
            terminal.warn(&format!("{not_finite} pixels are not finite and magenta"));
        }
        picture = shown;
    }
    image::write(&args.output, &picture, &options).map_err(|e| Failure::failed(e.to_string()))?;
    Ok(failure::DONE)
}

/// A layer by the program's name for it or by that of its channels.
fn layer(picture: &Image, name: &str) -> Result<Image, Failure> {
    let known = Layer::named(name).map(Layer::prefix);
    known.and_then(|prefix| picture.layer(prefix)).or_else(|| picture.layer(name)).ok_or_else(|| {
        let names: Vec<&str> = picture.channels().iter().map(|c| c.name.split('.').next().unwrap_or(&c.name)).collect();
        let hint = did_you_mean(name, names.iter().copied()).map(|h| format!("; {h}")).unwrap_or_default();
        Failure::bad_input(format!("there is no layer '{name}'{hint} (channels: {})", picture.channel_names()))
    })
}

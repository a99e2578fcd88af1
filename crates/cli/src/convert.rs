//! `steradian convert`: a picture in another format; scenes are converted in `convert_scene`.

use crate::{
    args::ConvertArgs,
    brightness, convert_scene,
    failure::{self, Failure, Outcome},
    output,
    terminal::Terminal,
};
use steradian::{
    Inputs, Layer,
    image::{self, FileKind, Image, Limits, WriteOptions, tone::Tone},
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
    let kind = output::kind(&args.output)?;
    output::claim([args.output.as_path()], &Inputs::of([args.input.as_path()]))?;
    let mut options = args.files.write_options_or(Tone::default()).map_err(Failure::bad_input)?;
    // Colours of a legend are no radiance.
    options.ppm_radiance &= args.false_color.is_none();
    let premultiplied = matches!(FileKind::from_extension(&args.input), Some(FileKind::Exr));
    let mut options = WriteOptions { premultiplied, ..options };
    let picture = image::read(&args.input, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()))?;
    let mut doubts = picture.metadata.notes.clone();
    let is_data = args.false_color.is_none() && is_data(&picture, args.layer.as_deref());
    let mut picture = match &args.layer {
        Some(name) => layer(&picture, name)?,
        None => {
            // OpenEXR keeps all layers.
            doubts.extend(picture.colour_note().filter(|_| kind != FileKind::Exr || args.false_color.is_some()));
            picture
        }
    };
    doubts.extend(not_finite(&picture));
    for doubt in doubts {
        terminal.warn(&doubt);
    }
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
    let is_asked = args.files.exposure.is_some() || args.files.tonemap.is_some();
    if kind.is_display() && is_data && !is_asked {
        scale(&mut picture).iter().for_each(|note| terminal.say(note));
    }
    let exposure = brightness::automatic(&picture, std::slice::from_ref(&args.output), args.files.exposure, false);
    brightness::expose(&mut options, exposure, Some(terminal));
    image::write(&args.output, &picture, &options).map_err(|e| Failure::failed(e.to_string()))?;
    let cut = match kind {
        FileKind::Exr => output::clamped(std::slice::from_ref(&args.output), &picture, &options),
        _ if kind.is_display() && is_data && is_asked => beyond_display(&picture),
        _ => None,
    };
    if let Some(cut) = cut {
        terminal.warn(&cut);
    }
    Ok(failure::DONE)
}

/// A message about values that are infinite or no numbers; they are kept.
fn not_finite(picture: &Image) -> Option<String> {
    let count = |wanted: fn(f32) -> bool, channels: fn(&str) -> bool| -> usize {
        let channels = picture.channels().iter().filter(|c| channels(&c.name));
        channels.map(|c| c.data.iter().filter(|v| wanted(**v)).count()).sum()
    };
    // The depth of the background is infinite.
    let (nan, infinite) = (count(f32::is_nan, |_| true), count(f32::is_infinite, |name| !is_depth(name)));
    (nan + infinite > 0).then(|| {
        format!("{nan} values of this picture are NaN and {infinite} infinite; they are kept where the format has them")
    })
}

fn is_depth(channel: &str) -> bool {
    matches!(channel.split('.').next_back(), Some("Z" | "depth")) || channel.starts_with("depth.")
}

/// True if the output is numbers, such as depths and normals, and no colours.
fn is_data(whole: &Image, layer: Option<&str>) -> bool {
    match layer {
        Some(name) => {
            let prefix: &str = match Layer::named(name) {
                Some(known) => known.prefix(),
                None => name,
            };
            whole.channel(prefix).is_some() || whole.channel(&format!("{prefix}.R")).is_none()
        }
        None => whole.channels().len() == 1 && whole.colour_note().is_some(),
    }
}

/// The least and the greatest of a picture's numbers.
fn range(picture: &Image) -> Option<[f32; 2]> {
    let colours = picture.channels().iter().filter(|c| c.name != "A");
    let values = || colours.clone().flat_map(|c| &c.data).copied().filter(|v| v.is_finite());
    values().reduce(f32::min).zip(values().reduce(f32::max)).map(|(least, greatest)| [least, greatest])
}

/// Brings numbers that a display does not show into its range, and tells so: directions from -1 to 1 as usual, others
/// between their least and their greatest. What is infinite becomes white or black.
fn scale(picture: &mut Image) -> Option<String> {
    let [least, greatest] = range(picture).filter(|[least, greatest]| *least < 0.0 || *greatest > 1.0)?;
    let is_direction = (-1.0..0.0).contains(&least) && greatest <= 1.0;
    let [from, to] = if is_direction { [-1.0, 1.0] } else { [least, greatest] };
    let width = f64::from(to) - f64::from(from);
    let part = |v: f32| match (f64::from(v) - f64::from(from)) / width {
        _ if v.is_infinite() => f32::from(v > 0.0),
        part if part.is_finite() => part as f32,
        _ => 0.0,
    };
    let names: Vec<String> = picture.channels().iter().map(|c| c.name.clone()).filter(|name| name != "A").collect();
    for name in names {
        picture.channel_mut(&name).into_iter().flatten().for_each(|v| *v = part(*v));
    }
    Some(format!("values from {from} to {to} are shown from black to white (--exposure 0 leaves them as they are)"))
}

/// A message about numbers outside of what a display shows.
fn beyond_display(picture: &Image) -> Option<String> {
    let [least, greatest] = range(picture)?;
    (least < 0.0 || greatest > 1.0).then(|| {
        format!(
            "the values go from {least} to {greatest}, and this format shows 0 to 1 of them; \
             --false-color shows all, .exr and .pfm keep them"
        )
    })
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

//! `steradian compare`: how far pictures are apart.

mod maps;
mod page;
mod pair;

use self::pair::Pair;
use crate::{
    args::CompareArgs,
    csv,
    failure::{self, Failure, Outcome},
    output,
    terminal::{self, Terminal},
};
use serde::Serialize;
use std::path::{Path, PathBuf};
use steradian::{
    Inputs,
    compare::{Noise, Reference},
    image::{self, FileKind, Image, Limits, WriteOptions, metrics},
};

#[derive(Debug, Serialize)]
struct Answer<'a> {
    schema: u32,
    pairs: &'a [Pair],
}

/// Compares, prints, judges.
pub fn run(args: &CompareArgs, terminal: Terminal) -> Outcome {
    let read = |path: &Path| {
        let picture = image::read(path, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()))?;
        for note in picture.metadata.notes.iter().cloned().chain(picture.colour_note()) {
            terminal.warn(&format!("'{}': {note}", path.display()));
        }
        Ok::<_, Failure>(picture)
    };
    let variance = args.variance.as_deref().map(read).transpose()?;
    let tests: Vec<&Path> = match (&args.b, args.reference.is_empty()) {
        (Some(b), false) => vec![&args.a, b],
        _ => vec![&args.a],
    };
    let references: Vec<&Path> = match &args.b {
        Some(b) if args.reference.is_empty() => vec![b],
        _ => args.reference.iter().map(PathBuf::as_path).collect(),
    };
    if let Some(output) = &args.output {
        if references.len() * tests.len() != 1 {
            return Err(Failure::bad_input("a picture of the differences (-o) is of one pair of pictures"));
        }
        output::kind(output)?;
    }
    let inputs = Inputs::of(tests.iter().chain(&references).copied().chain(args.variance.as_deref()));
    let outputs = [&args.output, &args.csv, &args.html];
    output::claim(outputs.into_iter().flatten().map(PathBuf::as_path), &inputs)?;
    let (mut pairs, mut sections) = (Vec::new(), Vec::new());
    for reference_path in references {
        let reference = read(reference_path)?;
        for path in &tests {
            let picture = read(path)?;
            let fitted = fitted((path, &picture), (reference_path, &reference), terminal)?;
            let (of_picture, of_reference) = ((*path, &picture), (reference_path, &fitted));
            let noise = match &variance {
                Some(variance) => {
                    Ok(Some(Noise::given(of_picture, variance, args.samples).map_err(Failure::bad_input)?))
                }
                None => Noise::by_layers(of_picture, of_reference),
            };
            let pair = Pair::of(of_picture, of_reference, &noise)?;
            if let Some(output) = &args.output {
                draw_difference(output, &picture, &fitted.image)?;
            }
            if args.html.is_some() {
                let section = page::section(&pair, &picture, &fitted.image, noise.ok().flatten().as_ref());
                sections.push(section.map_err(|e| Failure::failed(e.to_string()))?);
            }
            pairs.push(pair);
        }
    }
    let write = |path: &Path, text: String| {
        image::write_whole(path, text.as_bytes()).map_err(|e| Failure::failed(e.to_string()))
    };
    args.csv.as_ref().map_or(Ok(()), |path| write(path, table(&pairs)))?;
    args.html.as_ref().map_or(Ok(()), |path| write(path, page::page(&pairs, &sections)))?;
    if args.json {
        terminal::json(&Answer { schema: 1, pairs: &pairs })?;
    } else {
        terminal::data(pairs.iter().map(Pair::text).collect::<Vec<_>>().join("\n").as_bytes())?;
    }
    judge(&pairs, args)
}

/// The reference at the size of a picture; tells where it had another one.
fn fitted<'a>(
    (path, picture): (&Path, &Image),
    (reference_path, reference): (&Path, &'a Image),
    terminal: Terminal,
) -> Result<Reference<'a>, Failure> {
    let (path, reference_path) = (path.display(), reference_path.display());
    let fitted = Reference::of(picture, reference)
        .map_err(|e| Failure::bad_input(format!("{path} and {reference_path}: {e}")))?;
    if let Some([w, h]) = fitted.resampled_from {
        let (width, height) = (picture.width(), picture.height());
        terminal.say(&format!(
            "note: '{reference_path}' has {w}x{h} pixels and is resampled by area to the {width}x{height} of '{path}'"
        ));
    }
    Ok(fitted)
}

/// A table of all pairs.
fn table(pairs: &[Pair]) -> String {
    let heads = pair::columns().map(str::to_owned).collect();
    csv::table(std::iter::once(heads).chain(pairs.iter().map(|pair| pair.cells(|number| number.to_string()))))
}

/// Writes the differences: as numbers where the format holds them, else as colours.
fn draw_difference(output: &Path, picture: &Image, reference: &Image) -> Result<(), Failure> {
    let difference = match FileKind::from_extension(output) {
        Some(FileKind::Exr | FileKind::Hdr | FileKind::Pfm) => metrics::absolute_difference(picture, reference),
        _ => metrics::flip_picture(picture, reference),
    };
    let difference = difference.map_err(|e| Failure::bad_input(e.to_string()))?;
    image::write(output, &difference, &WriteOptions::default()).map_err(|e| Failure::failed(e.to_string()))
}

/// The exit code that the thresholds ask for.
fn judge(pairs: &[Pair], args: &CompareArgs) -> Outcome {
    let mut faults = Vec::new();
    for pair in pairs {
        for threshold in &args.fail_above {
            let Some(value) = pair.metric(threshold.metric) else {
                let why = pair.no_z_test.as_ref().map(|why| format!(" ({why})")).unwrap_or_default();
                let what =
                    "z_rejected needs a z-test: render both with --aov variance, or give --variance and --samples";
                return Err(Failure::bad_input(format!("{what}{why}")));
            };
            if value.is_nan() || value > threshold.limit {
                let (name, limit) = (threshold.metric, threshold.limit);
                faults.push(format!("{name} of '{}' is {value}, above {limit}", pair.picture.display()));
            }
        }
    }
    if faults.is_empty() {
        return Ok(failure::DONE);
    }
    Err(Failure { code: failure::DIFFERENT, message: faults.join("\n") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terminal::Talk;
    use crate::values::METRICS;
    use steradian::image::Value;

    fn picture(value: f32, variance: Option<f32>) -> Image {
        let mut image = Image::from_rgb(8, 8, &[[value; 3]; 64]).unwrap();
        if let Some(v) = variance {
            image.push_layer("variance", ["R", "G", "B"], &[[v; 3]; 64]).unwrap();
            image.metadata.set("samplesPerPixel", Value::Int(16));
        }
        image
    }

    fn compared((name, picture): (&str, &Image), (other, reference): (&str, &Image)) -> Result<Pair, Failure> {
        let (a, b) = ((Path::new(name), picture), Path::new(other));
        let reference = fitted(a, (b, reference), Terminal::new(Talk { quiet: true, ..Talk::default() }))?;
        Pair::of(a, (b, &reference), &Noise::by_layers(a, (b, &reference)))
    }

    #[test]
    fn variance_layers_decide_by_themselves() {
        // A deviation of one tenth, with standard deviations of the mean of a tenth and of a thousandth.
        let test = |variance, of_reference| {
            let (a, b) = (picture(0.6, variance), picture(0.5, of_reference));
            let pair = compared(("a.exr", &a), ("b.exr", &b)).unwrap();
            pair.no_z_test.map_or(Ok(pair.z_test.map(|z| z.passes)), Err)
        };
        assert_eq!(test(Some(0.01), Some(0.0)), Ok(Some(true)));
        assert_eq!(test(Some(1e-6), Some(0.0)), Ok(Some(false)));
        assert_eq!(test(Some(1e-6), Some(0.01)), Ok(Some(true)));
        assert_eq!(test(None, None), Ok(None));
        // Of a picture without variances nothing is known: neither side counts as exact.
        assert!(test(Some(1e-6), None).unwrap_err().contains("'b.exr'"));
        assert!(test(None, Some(1e-6)).unwrap_err().contains("'a.exr'"));
    }

    #[test]
    fn every_metric_has_a_value() {
        let (a, b) = (picture(0.6, Some(0.01)), picture(0.5, Some(0.0)));
        let pair = compared(("a", &a), ("b", &b)).unwrap();
        assert!(METRICS.iter().all(|m| pair.metric(m).is_some_and(f64::is_finite)));
        assert!((pair.metric("mean_ratio_error").unwrap() - 0.2).abs() < 1e-6);
        assert!((pair.metric("rmse").unwrap() - 0.1).abs() < 1e-6);
        assert_eq!(pair.metric("z_rejected"), Some(0.0));
    }

    #[test]
    fn references_of_another_size_are_resampled_and_of_another_shape_refused() {
        let of_size = |w: usize, h: usize| Image::from_rgb(w, h, &vec![[0.5; 3]; w * h]).unwrap();
        let pair = compared(("a", &picture(0.5, None)), ("b", &of_size(20, 20))).unwrap();
        assert_eq!((pair.resampled_from, pair.metric("max_abs")), (Some([20, 20]), Some(0.0)));
        let refused = compared(("a", &picture(0.5, None)), ("b", &of_size(20, 17))).unwrap_err();
        assert!(refused.code == failure::BAD_INPUT && refused.message.contains("20x17"), "{}", refused.message);
        assert_eq!(compared(("a", &of_size(3, 3)), ("b", &of_size(3, 3))).unwrap().resampled_from, None);
    }

    #[test]
    fn names_are_quoted_in_tables() {
        let pair = compared(("a,\"b\".exr", &picture(0.6, None)), ("b.exr", &picture(0.5, None))).unwrap();
        let csv = table(&[pair]);
        let lines: Vec<&str> = csv.lines().collect();
        assert!(lines[0].starts_with("picture,reference,width,height,resampled_from,mse,"), "{csv}");
        assert!(lines[1].starts_with("\"a,\"\"b\"\".exr\",b.exr,8,8,,0.0") && lines[1].ends_with(','), "{csv}");
        assert_eq!(lines.len(), 2);
    }
}

//! `steradian compare`: how far pictures are apart.

use crate::{
    args::CompareArgs,
    failure::{self, Failure, Outcome},
    output,
    terminal::{self, Terminal},
};
use serde::Serialize;
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};
use steradian::{
    Inputs,
    image::{
        self, FileKind, Image, Limits, Value, WriteOptions,
        metrics::{self, Comparison, DeltaE, ZTest},
    },
};

/// The figures of one picture against another.
#[derive(Debug, Serialize)]
struct Pair {
    picture: PathBuf,
    reference: PathBuf,
    width: usize,
    height: usize,
    mse: f64,
    rmse: f64,
    relmse: f64,
    psnr: f64,
    flip: f64,
    delta_e_76: f64,
    delta_e_94: f64,
    delta_e_2000: f64,
    delta_e_max: f64,
    max_abs: f64,
    mean: [f64; 3],
    reference_mean: [f64; 3],
    ratio: [f64; 3],
    nonfinite: usize,
    z_test: Option<Z>,
    /// Why there is no z-test, where one of the pictures tells its variance.
    no_z_test: Option<String>,
}

/// The z-test, with what it was made from.
#[derive(Debug, Serialize)]
struct Z {
    samples: f64,
    accepted: f64,
    level: f64,
    min_p: f64,
    passes: bool,
}

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
        let inputs = Inputs::of(tests.iter().chain(&references).copied().chain(args.variance.as_deref()));
        output::claim([output.as_path()], &inputs)?;
    }
    let mut pairs = Vec::new();
    for reference_path in references {
        let reference = read(reference_path)?;
        for path in &tests {
            let picture = read(path)?;
            let pair = compare((path, &picture), (reference_path, &reference), variance.as_ref(), args.samples);
            pairs.push(pair?);
            if let Some(output) = &args.output {
                draw_difference(output, &picture, &reference)?;
            }
        }
    }
    if args.json {
        terminal::json(&Answer { schema: 1, pairs: &pairs })?;
    } else {
        terminal::data(pairs.iter().map(Pair::text).collect::<Vec<_>>().join("\n").as_bytes())?;
    }
    judge(&pairs, args)
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

fn compare(
    (path, picture): (&Path, &Image),
    (reference_path, reference): (&Path, &Image),
    variance: Option<&Image>,
    samples: Option<f64>,
) -> Result<Pair, Failure> {
    let about =
        |e: image::Error| Failure::bad_input(format!("{} and {}: {e}", path.display(), reference_path.display()));
    let Comparison { mse, rmse, rel_mse, psnr, max_abs, mean, reference_mean, ratio, non_finite } =
        metrics::compare(picture, reference).map_err(about)?;
    let flip = metrics::flip(picture, reference, metrics::DEFAULT_PIXELS_PER_DEGREE).map_err(about)?;
    let DeltaE { cie76, cie94, ciede2000, max_ciede2000 } = metrics::delta_e(picture, reference).map_err(about)?;
    let mut no_z_test = None;
    let z_test = match variance {
        Some(variance) => {
            let samples = samples.or_else(|| samples_per_pixel(picture)).ok_or_else(|| {
                let what = "does not say how many samples it has; give --samples for the z-test";
                Failure::bad_input(format!("'{}' {what}", path.display()))
            })?;
            Some(Z::of(samples, metrics::z_test(picture, reference, variance, samples).map_err(about)?))
        }
        None => match own_z_test((path, picture), (reference_path, reference)) {
            Ok(test) => test.transpose().map_err(about)?,
            Err(why) => {
                no_z_test = Some(why);
                None
            }
        },
    };
    Ok(Pair {
        picture: path.into(),
        reference: reference_path.into(),
        width: picture.width(),
        height: picture.height(),
        mse,
        rmse,
        relmse: rel_mse,
        psnr,
        flip,
        delta_e_76: cie76,
        delta_e_94: cie94,
        delta_e_2000: ciede2000,
        delta_e_max: max_ciede2000,
        max_abs,
        mean,
        reference_mean,
        ratio,
        nonfinite: non_finite,
        z_test,
        no_z_test,
    })
}

/// The z-test by the variance layers of the pictures themselves; `Ok(None)` where neither has them.
///
/// # Errors
/// Which picture lacks what the test needs, where the other one has it: to take a picture of unknown noise for an exact
/// one would find differences where there are none.
fn own_z_test(
    (path, picture): (&Path, &Image),
    (reference_path, reference): (&Path, &Image),
) -> Result<Option<image::Result<Z>>, String> {
    let lacks = |path: &Path, what: &str| format!("'{}' has no {what}", path.display());
    let (own, other) = match (picture.layer_rgb("variance"), reference.layer_rgb("variance")) {
        (Some(own), Some(other)) => (own, other),
        (None, None) => return Ok(None),
        (None, _) => return Err(lacks(path, "layer 'variance'")),
        (_, None) => return Err(lacks(reference_path, "layer 'variance'")),
    };
    let samples = samples_per_pixel(picture).ok_or_else(|| lacks(path, "number of samples ('samplesPerPixel')"))?;
    // The layers hold variances of means; the test wants that of one sample. Variances of independent pictures add up.
    let one_sample = |i: usize| {
        let (a, b) = (own.at(i), other.at(i));
        std::array::from_fn(|c| (f64::from(a[c]) + f64::from(b[c])) * samples)
    };
    Ok(Some(metrics::z_test_with(picture, reference, one_sample, samples).map(|t| Z::of(samples, t))))
}

/// Samples per pixel, as the picture's metadata say.
fn samples_per_pixel(picture: &Image) -> Option<f64> {
    match picture.metadata.get("samplesPerPixel")? {
        Value::Int(n) => Some(f64::from(*n)),
        Value::Float(n) => Some(f64::from(*n)),
        Value::Text(n) => n.parse().ok(),
        Value::Matrix(_) => None,
    }
    .filter(|n| *n > 0.0)
}

impl Z {
    fn of(samples: f64, ZTest { accepted, level, min_p, passes }: ZTest) -> Self {
        Self { samples, accepted, level, min_p, passes }
    }
}

impl Pair {
    /// A metric by its name in [`METRICS`](crate::values::METRICS); `None` for the z-test where there was none.
    fn metric(&self, name: &str) -> Option<f64> {
        Some(match name {
            "mse" => self.mse,
            "rmse" => self.rmse,
            "relmse" => self.relmse,
            "psnr" => self.psnr,
            "flip" => self.flip,
            "delta_e_76" => self.delta_e_76,
            "delta_e_94" => self.delta_e_94,
            "delta_e_2000" => self.delta_e_2000,
            "delta_e_max" => self.delta_e_max,
            "max_abs" => self.max_abs,
            "mean_ratio_error" => self.mean_ratio_error(),
            _ => 1.0 - self.z_test.as_ref()?.accepted,
        })
    }

    /// Largest |mean / reference mean − 1|; equal means agree, black ones too.
    fn mean_ratio_error(&self) -> f64 {
        let error = |c: usize| if self.mean[c] == self.reference_mean[c] { 0.0 } else { (self.ratio[c] - 1.0).abs() };
        (0..3).map(error).fold(0.0, |a, b| if b.is_nan() { b } else { a.max(b) })
    }

    fn text(&self) -> String {
        let three = |v: [f64; 3]| v.map(|x| format!("{x:<12.6}")).join(" ");
        let mut out = String::new();
        let _ = writeln!(
            out,
            "{} against {}, {} x {}",
            self.picture.display(),
            self.reference.display(),
            self.width,
            self.height
        );
        let _ = writeln!(out, "  MSE       {:.6e}", self.mse);
        let _ = writeln!(out, "  RMSE      {:.6e}", self.rmse);
        let _ = writeln!(out, "  relMSE    {:.6e}", self.relmse);
        let _ = writeln!(out, "  PSNR      {:.2} dB of the display values", self.psnr);
        let _ = writeln!(out, "  FLIP      {:.6}", self.flip);
        let [e76, e94, e00, most] = [self.delta_e_76, self.delta_e_94, self.delta_e_2000, self.delta_e_max];
        let _ = writeln!(out, "  ΔE        {e76:.4} (1976), {e94:.4} (94), {e00:.4} (2000, at most {most:.4})");
        let _ = writeln!(out, "  max |Δ|   {:.6e}", self.max_abs);
        let _ = writeln!(out, "  means     {}", three(self.mean).trim_end());
        let _ = writeln!(out, "  reference {}", three(self.reference_mean).trim_end());
        let _ = writeln!(out, "  ratios    {}", three(self.ratio).trim_end());
        if self.nonfinite > 0 {
            let _ = writeln!(out, "  not finite: {} components, left out of all numbers", self.nonfinite);
        }
        if let Some(z) = &self.z_test {
            let verdict = if z.passes { "passes" } else { "fails" };
            let share = 100.0 * z.accepted;
            let _ = writeln!(
                out,
                "  z-test    {share:.4} % accepted, least p {:.3e}, at {} spp: {verdict}",
                z.min_p, z.samples
            );
        }
        if let Some(why) = &self.no_z_test {
            let _ = writeln!(out, "  z-test    none: {why}");
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::METRICS;

    fn picture(value: f32, variance: Option<f32>) -> Image {
        let mut image = Image::from_rgb(8, 8, &[[value; 3]; 64]).unwrap();
        if let Some(v) = variance {
            image.push_layer("variance", ["R", "G", "B"], &[[v; 3]; 64]).unwrap();
            image.metadata.set("samplesPerPixel", Value::Int(16));
        }
        image
    }

    #[test]
    fn variance_layers_decide_by_themselves() {
        // A deviation of one tenth, with standard deviations of the mean of a tenth and of a thousandth.
        let test = |variance, of_reference| {
            let (a, b) = (picture(0.6, variance), picture(0.5, of_reference));
            own_z_test((Path::new("a.exr"), &a), (Path::new("b.exr"), &b)).map(|z| z.map(|z| z.unwrap().passes))
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
        let pair = compare((Path::new("a"), &a), (Path::new("b"), &b), None, None).unwrap();
        assert!(METRICS.iter().all(|m| pair.metric(m).is_some_and(f64::is_finite)));
        assert!((pair.metric("mean_ratio_error").unwrap() - 0.2).abs() < 1e-6);
        assert!((pair.metric("rmse").unwrap() - 0.1).abs() < 1e-6);
        assert_eq!(pair.metric("z_rejected"), Some(0.0));
    }

    #[test]
    fn sizes_must_agree() {
        let small = Image::from_rgb(1, 1, &[[0.0; 3]]).unwrap();
        let refused = compare((Path::new("a"), &picture(0.1, Some(1.0))), (Path::new("b"), &small), None, None);
        assert_eq!(refused.unwrap_err().code, failure::BAD_INPUT);
    }
}

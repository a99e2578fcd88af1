//! `steradian signal`: a picture's spectrum, and what sampling it would do.

use crate::{
    args::SignalArgs,
    failure::{self, Failure, Outcome},
    output,
    terminal::{self, Terminal},
};
use serde::Serialize;
use std::path::PathBuf;
use steradian::{
    Inputs,
    image::{
        self, Limits, WriteOptions,
        signal::{Dft, Peak, Prefilter, panels, peaks, spectrum_svg},
        write_whole,
    },
};

/// Most pixels of a picture: its transform takes 32 bytes for each.
const MOST_PIXELS: u64 = 1 << 25;

#[derive(Serialize)]
struct Wave {
    frequency: [f64; 2],
    amplitude: f64,
    alias: [f64; 2],
    aliased: bool,
}

#[derive(Serialize)]
struct Spectrum {
    width: usize,
    height: usize,
    step: usize,
    half_rate: f64,
    waves: Vec<Wave>,
}

/// Reads, transforms, tells, draws.
pub fn run(args: &SignalArgs, terminal: Terminal) -> Outcome {
    output::claim(args.output.iter().map(PathBuf::as_path), &Inputs::of([args.input.as_path()]))?;
    let limits = Limits { pixels: MOST_PIXELS, ..Limits::default() };
    let picture = image::read(&args.input, &limits).map_err(|e| Failure::bad_input(e.to_string()))?;
    let (width, height, step) = (picture.width(), picture.height(), args.step as usize);
    if step > width.max(height) {
        return Err(Failure::bad_input(format!("--step {step} is more than the picture's {width} x {height} pixels")));
    }
    let rgb = picture.to_rgb().map_err(|e| Failure::bad_input(e.to_string()))?;
    // Luminance of Rec.709.
    let plane: Vec<f32> = rgb.iter().map(|c| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]).collect();
    let dft = Dft::new(&plane, width, height).map_err(|e| Failure::bad_input(e.to_string()))?;
    let found = peaks(&dft, step, args.waves as usize);
    let filter = Prefilter::ALL.iter().find(|f| f.0 == args.prefilter).map_or(Prefilter::None, |f| f.1);
    for output in &args.output {
        let is_svg = output.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
        let written = if is_svg {
            write_whole(output, spectrum_svg(&dft, &found, step, filter).as_bytes())
        } else {
            panels(&plane, width, height, step, filter).and_then(|p| image::write(output, &p, &WriteOptions::default()))
        };
        written.map_err(|e| Failure::failed(e.to_string()))?;
    }
    if args.json {
        let wave =
            |p: &Peak| Wave { frequency: p.frequency, amplitude: p.amplitude, alias: p.alias, aliased: p.is_aliased };
        let half_rate = 0.5 / step as f64;
        terminal::json(&Spectrum { width, height, step, half_rate, waves: found.iter().map(wave).collect() })?;
    } else {
        terminal.say(&table(&found, step));
    }
    Ok(failure::DONE)
}

fn table(found: &[Peak], step: usize) -> String {
    let mut text = format!(
        "sampled at every {step}. pixel, frequencies (cycles per pixel) below {:.4} stay\n  across    down  amplitude  appears at",
        0.5 / step as f64
    );
    for p in found {
        let [x, y] = p.frequency;
        let what = if p.is_aliased { format!("{:8.4} {:8.4}", p.alias[0], p.alias[1]) } else { "the same".into() };
        text.push_str(&format!("\n{x:8.4} {y:8.4} {:9.5}  {what}", p.amplitude));
    }
    text
}

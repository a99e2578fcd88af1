//! `steradian meter`: radiance, irradiance, and their photometric counterparts at a point of a scene.

use crate::{
    args::SceneOptions,
    failure::{self, Failure, Outcome},
    open,
    terminal::{self, Terminal},
    values,
};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};
use steradian::{
    ColorMode, Scene,
    integrators::Depth,
    math::Vec3,
    meter::{self, Estimate, Reading, Receiver, Settings},
};

/// `steradian meter`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Without --normal and --direction the scalar irradiance is measured, of light from all sides; \
                  with --flux what leaves the ball: of a lamp within, all its light. ± is half the width of the \
                  95 % confidence interval. Units: a radiance of RGB 1 is D65 of 72983 cd/m² (docs/photometry.md).")]
pub struct MeterArgs {
    /// Scene file, - for standard input, or builtin:NAME
    pub scene: PathBuf,
    /// The point, in the world
    #[arg(long, value_name = "X,Y,Z", value_parser = values::point, allow_hyphen_values = true)]
    pub at: [f64; 3],
    /// Irradiance and illuminance of a plane, on the side of this normal
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    #[arg(conflicts_with = "direction")]
    pub normal: Option<[f32; 3]>,
    /// Radiance and luminance that arrive from this direction, which points away from the meter
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    pub direction: Option<[f32; 3]>,
    /// Flux, in W and lm, instead: onto a disc of this radius on the side of the normal; without one, out of a ball
    #[arg(long, value_name = "RADIUS", value_parser = values::radius, conflicts_with = "direction")]
    #[arg(allow_hyphen_values = true)]
    pub flux: Option<f32>,
    /// Samples; 1k is 1000
    #[arg(long, value_name = "N", default_value = "64k", value_parser = values::spp, allow_hyphen_values = true)]
    pub spp: u32,
    /// Go on until half the width of the confidence interval is this part of the photometric value (0.01, or 1%), or
    /// 67108864 samples are taken
    #[arg(long, value_name = "E", value_parser = values::error)]
    pub error: Option<f64>,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Maximum number of scattering events of a path, -1 for no limit; light straight from lights has none
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(i64).range(-1..=i64::from(u32::MAX)))]
    pub max_depth: Option<i64>,
    /// Path tracing, without or with participating media; default: with them where there are any
    #[arg(long, value_enum)]
    pub integrator: Option<Integrator>,
    /// Print one line of JSON
    #[arg(long)]
    pub json: bool,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
}

/// Integrator of the meter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// On surfaces.
    Path,
    /// Through participating media as well.
    Volpath,
}

#[derive(Debug, Serialize)]
struct Answer<'a> {
    schema: u32,
    scene: &'a Path,
    at: [f64; 3],
    normal: Option<[f32; 3]>,
    direction: Option<[f32; 3]>,
    /// Radius of the disc or ball.
    radius: Option<f32>,
    color: &'static str,
    /// `radiance`, `irradiance`, `scalar irradiance` or `flux`.
    quantity: &'static str,
    /// Linear Rec.709.
    rgb: [Interval; 3],
    rgb_unit: &'static str,
    /// From 360 to 830 nm; null in RGB mode.
    radiant: Option<Interval>,
    radiant_unit: &'static str,
    luminous: Interval,
    luminous_unit: &'static str,
    samples: u32,
    nonfinite: u64,
}

/// A value and half the width of its confidence interval of 95 %.
#[derive(Clone, Copy, Debug, Serialize)]
struct Interval {
    value: f64,
    plus_minus: f64,
}

impl From<Estimate> for Interval {
    fn from(e: Estimate) -> Self {
        Self { value: e.value, plus_minus: e.plus_minus }
    }
}

/// Opens the scene and reads the meter.
pub fn run(args: &MeterArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.scene_options.threads);
    let opened = open::open_unseen(&args.scene, &args.scene_options);
    let scene = open::ready(opened, &args.scene, args.scene_options.strict, terminal)?.scene;
    let unit = |v: [f32; 3]| Vec3::from(v).normalize();
    let at = scene.from_file(args.at.into());
    let receiver = match (args.normal, args.direction, args.flux) {
        (Some(n), _, Some(r)) => Receiver::Disc(at, unit(n), r),
        (Some(n), _, None) => Receiver::Plane(at, unit(n)),
        (None, Some(d), _) => Receiver::Radiance(at, unit(d)),
        (None, None, Some(r)) => Receiver::Ball(at, r),
        (None, None, None) => Receiver::Sphere(at),
    };
    let reading = meter::read(&scene, &receiver, &settings(args, &scene, terminal));
    if reading.nonfinite > 0 {
        terminal.warn(&format!("{} samples were not finite and count as black", reading.nonfinite));
    }
    let answer = answer(args, &scene, &reading);
    match args.json {
        true => terminal::json(&answer)?,
        false => terminal::data(answer.text().as_bytes())?,
    }
    let is_reached = |e: f64| reading.luminous.plus_minus <= e * reading.luminous.value.abs();
    match args.error {
        Some(e) if !is_reached(e) => {
            Err(Failure::failed(format!("the error {e} is not reached with {} samples", reading.samples)))
        }
        _ => Ok(failure::DONE),
    }
}

fn settings(args: &MeterArgs, scene: &Scene, terminal: Terminal) -> Settings {
    if args.integrator == Some(Integrator::Path) && scene.has_media() {
        terminal.warn("'path' leaves participating media out; 'volpath' has them");
    }
    let asked = scene.settings();
    let max = match args.max_depth {
        Some(depth) => u32::try_from(depth).unwrap_or(u32::MAX),
        None => asked.max_depth,
    };
    Settings {
        samples: args.spp,
        error: args.error,
        seed: args.seed,
        media: args.integrator.map_or(scene.has_media(), |i| i == Integrator::Volpath),
        depth: Depth { max, roulette_after: asked.rr_depth, hide_emitters: false },
    }
}

fn answer<'a>(args: &'a MeterArgs, scene: &Scene, r: &Reading) -> Answer<'a> {
    Answer {
        schema: 1,
        scene: &args.scene,
        at: args.at,
        normal: args.normal,
        direction: args.direction,
        radius: args.flux,
        color: if scene.mode() == ColorMode::Spectral { "spectral" } else { "rgb" },
        quantity: match (args.normal, args.direction, args.flux) {
            (.., Some(_)) => "flux",
            (Some(_), ..) => "irradiance",
            (None, Some(_), _) => "radiance",
            (None, None, _) => "scalar irradiance",
        },
        rgb: r.rgb.map(Interval::from),
        rgb_unit: r.quantity.spectral_unit(),
        radiant: r.radiant.map(Interval::from),
        radiant_unit: r.quantity.unit(),
        luminous: r.luminous.into(),
        luminous_unit: r.quantity.photometric_unit(),
        samples: r.samples,
        nonfinite: r.nonfinite,
    }
}

impl Answer<'_> {
    fn text(&self) -> String {
        let shown = |i: &Interval| format!("{} ± {}", significant(i.value, 6), significant(i.plus_minus, 2));
        let mut out = String::new();
        for (channel, i) in ["red", "green", "blue"].iter().zip(&self.rgb) {
            let _ = writeln!(out, "{:<26}{} {}", format!("{}, {channel}", self.quantity), shown(i), self.rgb_unit);
        }
        if let Some(i) = &self.radiant {
            let _ = writeln!(out, "{:<26}{} {}", self.quantity, shown(i), self.radiant_unit);
        }
        let luminous = match self.quantity {
            "radiance" => "luminance",
            "irradiance" => "illuminance",
            "flux" => "luminous flux",
            _ => "scalar illuminance",
        };
        let _ = writeln!(out, "{luminous:<26}{} {}", shown(&self.luminous), self.luminous_unit);
        let _ = writeln!(out, "{:<26}{}", "samples", self.samples);
        out
    }
}

/// A number with so many significant digits.
fn significant(v: f64, digits: i32) -> String {
    if v == 0.0 || !v.is_finite() {
        return v.to_string();
    }
    let exponent = v.abs().log10().floor() as i32;
    if !(-5..9).contains(&exponent) {
        return format!("{v:.*e}", (digits - 1) as usize);
    }
    format!("{v:.*}", (digits - 1 - exponent).max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_digits() {
        let cases = [(2.570_796, 6, "2.57080"), (114_643.3, 6, "114643"), (0.000_123_45, 2, "0.00012"), (0.0, 2, "0")];
        for (v, digits, text) in cases {
            assert_eq!(significant(v, digits), text);
        }
        assert_eq!(significant(1.5e-9, 2), "1.5e-9");
    }
}

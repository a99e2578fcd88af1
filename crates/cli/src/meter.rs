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
    io::Read,
    path::{Path, PathBuf},
};
use steradian::{
    ColorMode, Scene,
    image::open_regular,
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
    #[arg(required_unless_present = "points", conflicts_with = "points")]
    pub at: Option<[f64; 3]>,
    /// Many points instead, each a row of a table with columns x, y, z, and where they differ nx, ny, nz of the normal,
    /// or dx, dy, dz of the direction; without a line of names the columns are x, y, z, or these and those of the
    /// normal. The answer is a table, with --json a line of JSON for each
    #[arg(long, value_name = "FILE.csv")]
    pub points: Option<PathBuf>,
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
    let places = match (&args.points, args.at) {
        (Some(path), _) => {
            let refuse = |why: String| Failure::bad_input(format!("'{}' {why}", path.display()));
            let (mut table, mut text) =
                (open_regular(path).map_err(|e| refuse(format!("cannot be read: {e}")))?, String::new());
            if table.1 > LONGEST {
                return Err(refuse(format!("has {} bytes, more than {LONGEST}", table.1)));
            }
            table.0.read_to_string(&mut text).map_err(|e| refuse(format!("cannot be read: {e}")))?;
            places(args, &text).map_err(refuse)?
        }
        (None, at) => vec![Place { at: at.unwrap_or_default(), normal: args.normal, direction: args.direction }],
    };
    // A meter reads the light of the file, not what makes a picture of it.
    let mut options = args.scene_options.clone();
    if open::is_gltf(&args.scene) && !options.define.iter().any(|(name, _)| name == "sky") {
        options.define.push(("sky".into(), "none".into()));
        terminal.say("only the lights of the glTF file are measured; -D sky=NAME adds a sky");
    }
    let opened = open::open_unseen(&args.scene, &options);
    let scene = open::ready(opened, &args.scene, args.scene_options.strict, terminal)?.scene;
    let settings = settings(args, &scene, terminal);
    let (mut unreached, mut taken) = (0, 0);
    for (row, place) in places.iter().enumerate() {
        let reading = meter::read(&scene, &place.receiver(&scene, args.flux), &settings);
        if reading.nonfinite > 0 {
            terminal.warn(&format!("{} samples were not finite and count as black", reading.nonfinite));
        }
        let answer = answer(args, place, &scene, &reading);
        match (args.json, &args.points) {
            (true, _) => terminal::json(&answer)?,
            (false, None) => terminal::data(answer.text().as_bytes())?,
            (false, Some(_)) => terminal::data(answer.row(row == 0).as_bytes())?,
        }
        taken = reading.samples;
        let is_reached = |e: f64| reading.luminous.plus_minus <= e * reading.luminous.value.abs();
        unreached += u32::from(args.error.is_some_and(|e| !is_reached(e)));
    }
    match args.error.filter(|_| unreached > 0) {
        Some(e) if args.points.is_some() => {
            Err(Failure::failed(format!("the error {e} is not reached at {unreached} of {} points", places.len())))
        }
        Some(e) => Err(Failure::failed(format!("the error {e} is not reached with {taken} samples"))),
        None => Ok(failure::DONE),
    }
}

/// Place and aim of the meter.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    at: [f64; 3],
    normal: Option<[f32; 3]>,
    direction: Option<[f32; 3]>,
}

impl Place {
    fn receiver(&self, scene: &Scene, flux: Option<f32>) -> Receiver {
        let unit = |v: [f32; 3]| Vec3::from(v).normalize();
        let at = scene.from_file(self.at.into());
        match (self.normal, self.direction, flux) {
            (Some(n), _, Some(r)) => Receiver::Disc(at, unit(n), r),
            (Some(n), _, None) => Receiver::Plane(at, unit(n)),
            (None, Some(d), _) => Receiver::Radiance(at, unit(d)),
            (None, None, Some(r)) => Receiver::Ball(at, r),
            (None, None, None) => Receiver::Sphere(at),
        }
    }
}

/// Columns of a table of places, in the order of coordinates.
const COLUMNS: [[&str; 3]; 3] = [["x", "y", "z"], ["nx", "ny", "nz"], ["dx", "dy", "dz"]];
/// Longest table, bytes.
const LONGEST: u64 = 1 << 30;

/// Reads places from a table: fields with commas, semicolons or tabs between them, lines that begin with # aside.
/// Places without an aim of their own have that of the command line.
fn places(args: &MeterArgs, table: &str) -> Result<Vec<Place>, String> {
    let separator = [';', '\t', ','].into_iter().find(|c| table.contains(*c)).unwrap_or(',');
    let lines = table.lines().enumerate().map(|(number, line)| (number + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let fields = |line: &str| line.split(separator).map(|f| f.trim().trim_matches('"').to_owned()).collect::<Vec<_>>();
    let Some((first, line)) = lines.peek().copied() else { return Err("has no points".into()) };
    // Names of the columns, or what their number says.
    let names: Vec<String> = match fields(line) {
        names if names.iter().any(|name| name.parse::<f64>().is_err()) => {
            lines.next();
            names.iter().map(|name| name.to_lowercase()).collect()
        }
        numbers if numbers.len() == 3 || numbers.len() == 6 => {
            COLUMNS.iter().flatten().take(numbers.len()).map(|name| (*name).to_owned()).collect()
        }
        numbers => {
            let count = numbers.len();
            return Err(format!("line {first}: {count} columns without names; 3 are a point, 6 a point and a normal"));
        }
    };
    if let Some(unknown) = names.iter().find(|name| !COLUMNS.iter().flatten().any(|known| known == name)) {
        return Err(format!("line {first}: unknown column '{unknown}'; known are x y z, nx ny nz, dx dy dz"));
    }
    let of = |columns: [&str; 3]| columns.map(|column| names.iter().position(|name| name == column));
    let [at, normal, direction] = COLUMNS.map(of);
    let ([Some(_), Some(_), Some(_)], false) = (at, normal[0].is_some() && direction[0].is_some()) else {
        return Err(format!("line {first}: a table has columns x, y, z, and a normal or a direction, but not both"));
    };
    let mut places = Vec::new();
    for (number, line) in lines {
        let values: Vec<f64> = fields(line)
            .iter()
            .map(|field| field.parse().ok().filter(|v: &f64| v.is_finite() && v.abs() <= f64::from(f32::MAX)))
            .collect::<Option<_>>()
            .filter(|values: &Vec<f64>| values.len() == names.len())
            .ok_or_else(|| format!("line {number}: {} finite numbers are expected in '{line}'", names.len()))?;
        let vector = |columns: [Option<usize>; 3]| match columns {
            [Some(x), Some(y), Some(z)] => Some([values[x], values[y], values[z]]),
            _ => None,
        };
        let aim = |columns| match vector(columns).map(|v| v.map(|v| v as f32)) {
            Some([0.0, 0.0, 0.0]) => Err(format!("line {number}: a direction of length zero")),
            aim => Ok(aim),
        };
        let (normal, direction) = (aim(normal)?, aim(direction)?);
        let is_aimed = normal.is_some() || direction.is_some();
        places.push(Place {
            at: vector(at).unwrap_or_default(),
            normal: normal.or(args.normal.filter(|_| !is_aimed)),
            direction: direction.or(args.direction.filter(|_| !is_aimed)),
        });
    }
    if places.is_empty() { Err("has no points".into()) } else { Ok(places) }
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

fn answer<'a>(args: &'a MeterArgs, place: &Place, scene: &Scene, r: &Reading) -> Answer<'a> {
    Answer {
        schema: 1,
        scene: &args.scene,
        at: place.at,
        normal: place.normal,
        direction: place.direction,
        radius: args.flux,
        color: if scene.mode() == ColorMode::Spectral { "spectral" } else { "rgb" },
        quantity: match (place.normal, place.direction, args.flux) {
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
    /// A row of a table, after one of names where it is the first.
    fn row(&self, is_first: bool) -> String {
        let mut out = String::new();
        if is_first {
            let radiant = self.radiant.map_or("", |_| "radiant,radiant_error,");
            let _ = writeln!(out, "x,y,z,red,green,blue,{radiant}luminous,luminous_error");
        }
        let [x, y, z] = self.at;
        let [red, green, blue] = self.rgb.map(|i| i.value);
        let _ = write!(out, "{x},{y},{z},{red},{green},{blue}");
        for i in self.radiant.iter().chain([&self.luminous]) {
            let _ = write!(out, ",{},{}", i.value, i.plus_minus);
        }
        out.push('\n');
        out
    }

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
    use crate::command::{Cli, Command};
    use clap::Parser;

    #[test]
    fn tables_are_read_by_the_names_of_their_columns() {
        let cli = Cli::parse_from(["steradian", "meter", "a.xml", "--points", "a.csv", "--normal", "0,0,1"]);
        let Command::Meter(args) = cli.command else { panic!("a meter was asked for") };
        let read = |table: &str| places(&args, table);
        let plain = Place { at: [1.0, 2.0, -3.5], normal: Some([0.0, 0.0, 1.0]), direction: None };
        assert_eq!(read("1,2,-3.5\n").unwrap(), [plain]);
        assert_eq!(read("# points\n\nZ; x ;\"Y\"\n-3.5;1;2\n").unwrap(), [plain]);
        let own = Place { normal: Some([0.0, 1.0, 0.0]), ..plain };
        assert_eq!(read("1\t2\t-3.5\t0\t1\t0").unwrap(), [own]);
        let aimed = Place { normal: None, direction: Some([1.0, 0.0, 0.0]), ..plain };
        assert_eq!(read("x,y,z,dx,dy,dz\n1,2,-3.5,1,0,0\r\n").unwrap(), [aimed]);
        for (bad, why) in [
            ("", "no points"),
            ("x,y,z\n", "no points"),
            ("1,2\n", "line 1: 2 columns"),
            ("x,y,w\n1,2,3\n", "unknown column 'w'"),
            ("x,y,nx\n1,2,3\n", "columns x, y, z"),
            ("1,2,3\n1,nan,3\n", "line 2"),
            ("1,2,3\n1,2\n", "line 2"),
            ("1,2,3,0,0,0\n", "length zero"),
        ] {
            assert!(read(bad).unwrap_err().contains(why), "{bad:?}: {:?}", read(bad));
        }
    }

    #[test]
    fn numbers_have_their_digits() {
        let cases = [(2.570_796, 6, "2.57080"), (114_643.3, 6, "114643"), (0.000_123_45, 2, "0.00012"), (0.0, 2, "0")];
        for (v, digits, text) in cases {
            assert_eq!(significant(v, digits), text);
        }
        assert_eq!(significant(1.5e-9, 2), "1.5e-9");
    }
}

//! The values of options: sizes, rectangles, durations, names.

use std::{ops::RangeInclusive, str::FromStr, time::Duration};
pub use steradian::quality::MAX_SPP;
use steradian::{
    Layer, MethodRequest, Viewpoint,
    auto::AUTO,
    image::{FalseColor, Sensor, tone::Tone},
    math::DVec3,
    scene::{Family, names},
    schema::Type,
};

/// A frame, `WxH`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub u32, pub u32);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X', '×']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
        match sides {
            Some((w, h)) if w > 0 && h > 0 => Ok(Self(w, h)),
            Some(_) => Err("a picture has at least one pixel in each direction".into()),
            None => Err("write it as WIDTHxHEIGHT, such as 1280x720".into()),
        }
    }
}

/// A rectangle of pixels, `X0,Y0,X1,Y1`, half open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rectangle(pub [u32; 4]);

impl FromStr for Rectangle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Self([x0, y0, x1, y1])),
            Ok([_, _, _, _]) => Err("the rectangle is empty: X0 < X1 and Y0 < Y1 are needed".into()),
            _ => Err("write it as X0,Y0,X1,Y1 in pixels from the top left".into()),
        }
    }
}

const ABOVE_ZERO: &str = "a time above zero is needed, such as 10s or 2m";

/// A time such as `90`, `10s`, `2m`, `1h30m`, `250ms`.
pub fn duration(text: &str) -> Result<Duration, String> {
    let d = time(text)?;
    if d.is_zero() { Err(ABOVE_ZERO.into()) } else { Ok(d) }
}

/// A duration that may be zero.
pub fn time(text: &str) -> Result<Duration, String> {
    if text.trim().is_empty() {
        return Err(ABOVE_ZERO.into());
    }
    let fault = || "write it as 10s, 2m, 1h30m or 250ms".to_owned();
    let mut seconds = 0.0;
    let mut rest = text.trim();
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let number: f64 = rest[..digits].parse().map_err(|_| fault())?;
        rest = &rest[digits..];
        let letters = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
        let unit = match &rest[..letters] {
            "h" => 3600.0,
            "m" | "min" => 60.0,
            "s" | "" => 1.0,
            "ms" => 1e-3,
            _ => return Err(fault()),
        };
        rest = &rest[letters..];
        seconds += number * unit;
    }
    Duration::try_from_secs_f64(seconds).map_err(|_| ABOVE_ZERO.into())
}

/// An amount of memory such as `512MiB`, `2G`, `1500000`: binary units with `KiB` or `K`, decimal ones with `KB`. At
/// least a mebibyte.
pub fn bytes(text: &str) -> Result<usize, String> {
    let text = text.trim();
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let unit = match text[digits..].trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kib" => 1024.0,
        "m" | "mib" => 1024.0 * 1024.0,
        "g" | "gib" => 1024.0 * 1024.0 * 1024.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        _ => return Err("write it as 512MiB, 2GiB or a number of bytes".into()),
    };
    match text[..digits].parse::<f64>() {
        Ok(n) if n * unit >= 1024.0 * 1024.0 => Ok((n * unit) as usize),
        Ok(_) => Err("at least 1MiB is needed".into()),
        Err(_) => Err("write it as 512MiB, 2GiB or a number of bytes".into()),
    }
}

/// A relative error such as `0.05` or `5%`.
pub fn error(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let value = match text.strip_suffix('%') {
        Some(percent) => percent.trim_end().parse::<f64>().map(|v| v * 0.01),
        None => text.parse(),
    };
    value
        .ok()
        .filter(|v| *v > 0.0 && v.is_finite())
        .ok_or_else(|| "a number above zero is needed, such as 0.05 or 5%".into())
}

/// `NAME=VALUE`.
pub fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.into(), value.into())),
        _ => Err("write it as NAME=VALUE, such as eta=1.5".into()),
    }
}

fn numbers<T: FromStr + Copy + Into<f64>, const N: usize>(text: &str) -> Option<[T; N]> {
    let list: Result<Vec<T>, _> = text.split(',').map(|t| t.trim().parse()).collect();
    list.ok()?.try_into().ok().filter(|v: &[T; N]| v.iter().all(|v| (*v).into().is_finite()))
}

/// Two numbers.
pub fn pair(text: &str) -> Result<[f32; 2], String> {
    numbers(text).ok_or_else(|| "write it as U,V, such as 0.5,0.25".into())
}

/// A point.
pub fn point(text: &str) -> Result<[f64; 3], String> {
    numbers(text).ok_or_else(|| "write it as X,Y,Z, such as 0,1.5,-2".into())
}

/// A direction, of any length but zero.
pub fn direction(text: &str) -> Result<[f32; 3], String> {
    let is_direction = |v: &[f32; 3]| v.iter().any(|c| c.abs() > 1e-15) && v.iter().all(|c| c.abs() < 1e15);
    numbers(text)
        .filter(is_direction)
        .ok_or_else(|| "a direction X,Y,Z is needed, such as 0,1,0, not of length zero".into())
}

/// A length above zero.
pub fn radius(text: &str) -> Result<f32, String> {
    let of = |v: &f32| *v >= 1e-15 && *v <= 1e15;
    text.trim().parse().ok().filter(of).ok_or_else(|| "a length above zero is needed, such as 0.5".into())
}

/// Four wavelengths.
pub fn wavelengths(text: &str) -> Result<[f32; 4], String> {
    let visible = |v: &[f32; 4]| v.iter().all(|l| (360.0..=830.0).contains(l));
    numbers(text)
        .filter(visible)
        .ok_or_else(|| "four wavelengths from 360 to 830 nm are needed, such as 450,550,600,650".into())
}

/// Eye, target and up of a camera.
pub fn viewpoint(text: &str) -> Result<Viewpoint, String> {
    let numbers = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<Vec<f64>>>();
    let Some(Ok::<[f64; 9], _>([ex, ey, ez, tx, ty, tz, ux, uy, uz])) = numbers.map(TryInto::try_into) else {
        return Err("nine numbers are needed: eye, target, and the direction upwards, such as 0,1,5,0,0,0,0,1,0".into());
    };
    let [eye, target, up] = [[ex, ey, ez], [tx, ty, tz], [ux, uy, uz]].map(DVec3::from_array);
    let view = Viewpoint { eye, target, up };
    let is_sound = view.is_sound();
    is_sound.then_some(view).ok_or_else(|| "the eye must be apart from the target, and up not along the view".into())
}

/// A roughness α of a surface that is looked at facet by facet.
pub fn roughness(text: &str) -> Result<f32, String> {
    let possible = |v: &f32| *v > 0.0 && *v <= 2.0;
    text.parse().ok().filter(possible).ok_or_else(|| "a roughness above 0 and up to 2 is needed, such as 0.3".into())
}

/// An integrator with its options, checked before a long load.
pub fn integrator(text: &str) -> Result<String, String> {
    MethodRequest::parse(text).map(|_| text.to_owned()).map_err(|e| e.to_string())
}

/// An integrator, or [`AUTO`].
pub fn integrator_or_auto(text: &str) -> Result<String, String> {
    if text == AUTO { Ok(text.to_owned()) } else { integrator(text) }
}

/// Samples per pixel: a whole number from 1 to [`MAX_SPP`], perhaps with a `k` for thousands.
pub fn spp(text: &str) -> Result<u32, String> {
    samples(text, 1)
}

/// Samples per pixel that have a variance, so at least two.
pub fn spp_with_variance(text: &str) -> Result<u32, String> {
    samples(text, 2)
}

fn samples(text: &str, least: u32) -> Result<u32, String> {
    let (digits, factor) = match text.strip_suffix(['k', 'K']) {
        Some(digits) => (digits, 1000),
        None => (text, 1),
    };
    let value = digits.parse::<u32>().ok().and_then(|n| n.checked_mul(factor));
    value
        .filter(|n| (least..=MAX_SPP).contains(n))
        .ok_or_else(|| format!("a number of samples is a whole number from {least} to {MAX_SPP}, or 4k for 4000"))
}

/// A tone curve with its parameters.
pub fn tone(text: &str) -> Result<Tone, String> {
    Tone::parse(text).map_err(|e| e.to_string())
}

/// A tone curve as it was written.
pub fn tone_text(text: &str) -> Result<String, String> {
    tone(text).map(|_| text.to_owned())
}

/// Parses a mapping of luminance to false colours.
pub fn false_color(text: &str) -> Result<FalseColor, String> {
    FalseColor::parse(text).map_err(|e| e.to_string())
}

/// The sensor of a film, by the film's parameters: `full_well=50000,iso=1600`.
pub fn sensor(text: &str) -> Result<Sensor, String> {
    const KNOWN: [&str; 7] = ["full_well", "read_noise", "dark_current", "bits", "noise_seed", "iso", "exposure_time"];
    let film = Family::Film.model("rgb").ok_or("there is no film")?;
    let mut sensor = Sensor::default();
    for setting in text.split(',').filter(|s| !s.is_empty()) {
        let (name, value) = definition(setting)?;
        let name = known_name(&name, "parameter of a sensor", KNOWN.into_iter())?;
        let parameter = film.parameter(name).ok_or("there is no such parameter of films")?;
        let is_whole = parameter.kind == Type::Integer;
        let (low, high) = parameter.range;
        let number = value
            .parse::<f64>()
            .ok()
            .filter(|v| v.is_finite() && (low..=high).contains(v) && (!is_whole || v.fract() == 0.0));
        let number = number.ok_or_else(|| format!("'{name}' is '{value}'; it must be a {}", parameter.values()))?;
        match name {
            "full_well" => sensor.full_well = number,
            "read_noise" => sensor.read_noise = number,
            "dark_current" => sensor.dark_current = number,
            "bits" => sensor.bits = number as u32,
            "noise_seed" => sensor.seed = number as i64 as u64,
            "iso" => sensor.iso = number,
            _ => sensor.exposure_time = number,
        }
    }
    if sensor.full_well > 0.0 { Ok(sensor) } else { Err("'full_well' is needed, such as full_well=50000".into()) }
}

/// Layers by name, `all` for every one but the light of groups of lights and halves of samples, which change how paths
/// are made, those of what mirrors and smooth glass show, and motion, which takes a frame before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layers(pub Vec<Layer>);

impl FromStr for Layers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut layers = Vec::new();
        let known = Layer::ALL.iter().map(|l| l.name()).chain(["all"]);
        for name in text.split(',').map(str::trim).filter(|n| !n.is_empty()) {
            match known_name(name, "layer", known.clone())? {
                "all" => layers.extend(Layer::ALL.iter().copied().filter(|l| l.is_in_all())),
                name => layers.extend(Layer::named(name)),
            }
        }
        Ok(Self(layers))
    }
}

/// Metrics that `--fail-above` knows. `z_rejected` is the share of components that the z-test rejects.
/// `ssim_error` is 1 − SSIM. ΔE are means over pixels but for `delta_e_max`, the largest ΔE00.
pub const METRICS: &[&str] = &[
    "mse",
    "rmse",
    "relmse",
    "mape",
    "smape",
    "psnr",
    "ssim",
    "ssim_error",
    "flip",
    "delta_e_76",
    "delta_e_94",
    "delta_e_2000",
    "delta_e_max",
    "max_abs",
    "mean_ratio_error",
    "z_rejected",
];

/// A threshold, `METRIC=VALUE`.
#[derive(Clone, Debug, PartialEq)]
pub struct Threshold {
    /// The metric's name.
    pub metric: &'static str,
    /// Largest value allowed.
    pub limit: f64,
}

impl FromStr for Threshold {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("write it as METRIC=VALUE, such as relmse=0.01")?;
        let metric = known_name(name, "metric", METRICS.iter().copied())?;
        match value.parse::<f64>() {
            Ok(limit) if !limit.is_nan() => Ok(Self { metric, limit }),
            _ => Err(format!("'{value}' is not a number")),
        }
    }
}

/// `name` if it is one of the known, else a message with the nearest and all of them.
pub fn known_name<'a>(name: &str, what: &str, known: impl Iterator<Item = &'a str> + Clone) -> Result<&'a str, String> {
    known.clone().find(|k| *k == name).ok_or_else(|| {
        let hint = names::did_you_mean(name, known.clone()).map(|h| format!("; {h}")).unwrap_or_default();
        format!("there is no {what} '{name}'{hint} (known: {})", known.collect::<Vec<_>>().join(", "))
    })
}

/// Frames of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// The first one.
    pub first: u32,
    /// The last one.
    pub last: u32,
}

/// `A..B`, both included.
pub fn frames(text: &str) -> Result<Frames, String> {
    let pair = text.split_once("..").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match pair {
        Some((first, last)) if first <= last => Ok(Frames { first, last }),
        _ => Err("frames are written A..B, such as 0..47, the first one no later than the last".into()),
    }
}

/// Chunks of a job.
#[derive(Clone, Debug)]
pub enum Chunks {
    /// From one to another, both included.
    Range(RangeInclusive<u32>),
    /// Chunks whose numbers come from standard input.
    FromInput,
}

/// `K`, or `A..B`, both included, or `-`.
pub fn chunks(text: &str) -> Result<Chunks, String> {
    if text == "-" {
        return Ok(Chunks::FromInput);
    }
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    match (first.parse(), last.parse()) {
        (Ok(first), Ok(last)) if first <= last => Ok(Chunks::Range(first..=last)),
        _ => Err("chunks are written K, or A..B such as 0..9, the first one no later than the last".into()),
    }
}

/// Frames per second.
pub fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (0.001..=100_000.0).contains(&rate) => Ok(rate),
        _ => Err("frames per second are a number from 0.001 to 100000".into()),
    }
}

/// Strength of denoising.
pub fn strength(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(strength) if (0.01..=100.0).contains(&strength) => Ok(strength),
        _ => Err("a strength is a number from 0.01 to 100".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_rectangles() {
        assert_eq!("1280x720".parse(), Ok(Size(1280, 720)));
        for bad in ["0x5", "5x0", "5", "x", "-1x5", "5x5x5", "99999999999x1", ""] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
        assert_eq!("1,2,3,4".parse(), Ok(Rectangle([1, 2, 3, 4])));
        for bad in ["1,2,1,4", "3,2,1,4", "1,2,3", "1,2,3,4,5", "a,b,c,d", "0.5,0,1,1", ""] {
            assert!(bad.parse::<Rectangle>().is_err(), "{bad}");
        }
    }

    #[test]
    fn durations() {
        for (text, seconds) in
            [("90", 90.0), ("10s", 10.0), ("2m", 120.0), ("1h30m", 5400.0), ("250ms", 0.25), ("1.5s", 1.5)]
        {
            assert_eq!(duration(text).map(|d| d.as_secs_f64()), Ok(seconds), "{text}");
        }
        for bad in ["", "0", "-1s", "s", "10q", "1e400", "1.2.3s", "inf", "10 days"] {
            assert!(duration(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn names_and_suggestions() {
        assert!(integrator("path:max_depth=3").is_ok());
        assert!(integrator("raster:shadows=map,pcf=3").is_ok());
        assert!(integrator("raster:shadows=magic").is_err_and(|e| e.contains("'shadows' takes ray, none")));
        assert!(integrator("rastre").is_err_and(|e| e.contains("did you mean 'raster'?")));
        assert!(integrator("pahts").is_err_and(|e| e.contains("did you mean 'path'?")));
        assert_eq!("normal,depth".parse(), Ok(Layers(vec![Layer::NORMAL, Layer::DEPTH])));
        let all: Layers = "all".parse().unwrap();
        assert!(all.0.len() + 6 == Layer::ALL.len() && !all.0.contains(&Layer::LIGHT_GROUPS));
        assert!("normals".parse::<Layers>().is_err_and(|e| e.contains("did you mean 'normal'?")));
        assert_eq!("motion".parse(), Ok(Layers(vec![Layer::MOTION])));
        assert_eq!("relmse=0.1".parse(), Ok(Threshold { metric: "relmse", limit: 0.1 }));
        assert!("relmse=x".parse::<Threshold>().is_err() && "relms=1".parse::<Threshold>().is_err());
        assert!(definition("=x").is_err() && definition("x").is_err());
        assert_eq!(definition("a=b=c"), Ok(("a".into(), "b=c".into())));
    }
}

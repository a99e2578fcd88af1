//! Pictures that a display shows as white or black, and the exposure that would show them.

use crate::terminal::Terminal;
use std::{path::PathBuf, str::FromStr};
use steradian::image::{FileKind, Image, WriteOptions};

/// Exposure of files for displays, as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// By the picture.
    Auto,
    /// In stops.
    Stops(f32),
}

impl FromStr for Exposure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            stops => stops.parse().map(Self::Stops).map_err(|_| "a number of stops is needed, or auto".into()),
        }
    }
}

/// Luminance of mid-grey, and of what is bright but not white.
const GREY: f32 = 0.18;
const BRIGHT: f32 = 0.8;
/// Value below which a display shows black, if nearly all of a picture lies there.
const DARK: f32 = 0.02;

/// Exposure in stops that a picture is written with, and why: of `auto`, and of models and glTF scenes where they would
/// be white or black. Zero for one that has it, or where no file is for displays.
pub fn automatic(picture: &Image, outputs: &[PathBuf], asked: Option<Exposure>, is_model: bool) -> (f32, &'static str) {
    let is_shown = outputs.iter().any(|path| FileKind::from_extension(path).is_some_and(FileKind::is_display));
    match asked {
        Some(Exposure::Auto) if is_shown => (average(picture), "what is lit is grey on average"),
        None if is_shown && is_model => needed(picture).map_or((0.0, ""), |(why, stops)| (stops, why)),
        _ => (0.0, ""),
    }
}

/// Gives a picture an exposure, and says so where there is a terminal.
pub fn expose(options: &mut WriteOptions, (stops, why): (f32, &str), terminal: Option<Terminal>) {
    if stops == 0.0 {
        return;
    }
    if let Ok(tone) = options.tone.clone().with_exposure(stops) {
        options.tone = tone;
        let line = format!("exposed by {stops:+} stops: {why} (--exposure 0 leaves it as it is)");
        terminal.iter().for_each(|terminal| terminal.say(&line));
    }
}

/// Stops, to a tenth, by which the geometric mean of what is lit becomes mid-grey, but no more than one tenth of it
/// white.
fn average(picture: &Image) -> f32 {
    let lit = lit(picture);
    let Some(high) = lit.get(lit.len() * 9 / 10) else { return 0.0 };
    let mean = lit.iter().map(|y| f64::from(*y).log2()).sum::<f64>() / lit.len() as f64;
    let stops = (GREY.log2() - mean as f32).min(-high.log2());
    (10.0 * stops).round().clamp(-640.0, 640.0) / 10.0
}

/// True for a picture without any light.
pub fn is_black(picture: &Image) -> bool {
    lit(picture).is_empty()
}

/// Luminances of the pixels that are not black, from the lowest on.
fn lit(picture: &Image) -> Vec<f32> {
    let Some(rgb) = picture.rgb() else { return Vec::new() };
    let luminance = |k: usize| {
        let [r, g, b] = rgb.at(k);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let mut lit: Vec<f32> = (0..picture.pixel_count()).map(luminance).filter(|y| *y > 0.0 && y.is_finite()).collect();
    lit.sort_unstable_by(f32::total_cmp);
    lit
}

/// Hint about the brightness of a picture that no exposure was asked for, where a file for displays is among the
/// outputs.
pub fn hint(picture: &Image, outputs: &[PathBuf], exposure: Option<Exposure>) -> Option<String> {
    let file = outputs.iter().find(|path| FileKind::from_extension(path).is_some_and(FileKind::is_display))?;
    if exposure.is_some() {
        return None;
    }
    let (what, stops) = needed(picture)?;
    Some(format!("{what} in {}: --exposure {stops} would show more", file.display()))
}

/// Complaint about a picture that is white or black as it is shown, and the exposure in stops that mends it.
pub fn needed(picture: &Image) -> Option<(&'static str, f32)> {
    let lit = lit(picture);
    if lit.is_empty() {
        return None;
    }
    let quantile = |share: f32| lit[((lit.len() - 1) as f32 * share) as usize];
    let stops = |from: f32, to: f32| (to / from).log2().round().clamp(-64.0, 64.0);
    if quantile(0.4) > 1.0 {
        Some(("most of what is lit is white", stops(quantile(0.5), GREY)))
    } else if quantile(0.98) < DARK {
        Some(("nearly all is dark", stops(quantile(0.98), BRIGHT)))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_and_dark_pictures_are_told_with_the_exposure_that_mends_them() {
        let hint_of = |value: f32, file: &str, exposure| {
            let pixels: Vec<[f32; 3]> = (0..100).map(|k| if k < 50 { [0.0; 3] } else { [value; 3] }).collect();
            hint(&Image::from_rgb(10, 10, &pixels).unwrap(), &[file.into()], exposure)
        };
        // 0.18·2⁴ is four stops above grey.
        assert_eq!(
            hint_of(2.88, "a.png", None).unwrap(),
            "most of what is lit is white in a.png: --exposure -4 would show more"
        );
        assert_eq!(
            hint_of(0.0125, "a.jpg", None).unwrap(),
            "nearly all is dark in a.jpg: --exposure 6 would show more"
        );
        assert_eq!(hint_of(0.5, "a.png", None), None);
        assert_eq!(hint_of(2.88, "a.exr", None), None);
        assert_eq!(hint_of(2.88, "a.png", Some(Exposure::Stops(0.0))), None);
        assert_eq!(hint_of(0.0, "a.png", None), None);
    }

    #[test]
    fn exposures_are_found() {
        let stops = |low: f32, high: f32, asked, is_model, file: &str| {
            let pixels: Vec<[f32; 3]> = (0..100).map(|k| if k % 2 == 0 { [low; 3] } else { [high; 3] }).collect();
            automatic(&Image::from_rgb(10, 10, &pixels).unwrap(), &[file.into()], asked, is_model).0
        };
        let auto = Some(Exposure::Auto);
        assert_eq!(stops(0.09, 0.36, auto, false, "a.png"), 0.0);
        assert_eq!(stops(0.36, 1.44, auto, false, "a.png"), -2.0);
        // The bright half stays below white.
        assert_eq!(stops(0.0001, 0.5, auto, false, "a.png"), 1.0);
        // Where none is asked for, only models that are white or black.
        assert_eq!(stops(2.88, 2.88, None, true, "a.png"), -4.0);
        assert_eq!(stops(0.3, 0.4, None, true, "a.png"), 0.0);
        for (asked, is_model, file) in
            [(None, false, "a.png"), (Some(Exposure::Stops(1.0)), true, "a.png"), (auto, true, "a.exr")]
        {
            assert_eq!(stops(2.88, 2.88, asked, is_model, file), 0.0);
        }
        assert_eq!("auto".parse(), Ok(Exposure::Auto));
        assert_eq!("-1.5".parse(), Ok(Exposure::Stops(-1.5)));
        assert!("bright".parse::<Exposure>().is_err());
    }
}

//! Pictures that a display shows as white or black, and the exposure that would show them.

use std::path::PathBuf;
use steradian::image::{FileKind, Image};

/// Luminance of mid-grey, and of what is bright but not white.
const GREY: f32 = 0.18;
const BRIGHT: f32 = 0.8;
/// Value below which a display shows black, if nearly all of a picture lies there.
const DARK: f32 = 0.02;

/// Hint about the brightness of a picture that no exposure was asked for, where a file for displays is among the
/// outputs.
pub fn hint(picture: &Image, outputs: &[PathBuf], exposure: Option<f32>) -> Option<String> {
    let file = outputs.iter().find(|path| FileKind::from_extension(path).is_some_and(FileKind::is_display))?;
    if exposure.is_some() {
        return None;
    }
    let (what, stops) = needed(picture)?;
    Some(format!("{what} in {}: --exposure {stops} would show more", file.display()))
}

/// Complaint about a picture that is white or black as it is shown, and the exposure in stops that mends it.
pub fn needed(picture: &Image) -> Option<(&'static str, f32)> {
    let rgb = picture.rgb()?;
    let luminance = |k: usize| {
        let [r, g, b] = rgb.at(k);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let mut lit: Vec<f32> = (0..picture.pixel_count()).map(luminance).filter(|y| *y > 0.0 && y.is_finite()).collect();
    if lit.is_empty() {
        return None;
    }
    lit.sort_unstable_by(f32::total_cmp);
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
        assert_eq!(hint_of(2.88, "a.png", Some(0.0)), None);
        assert_eq!(hint_of(0.0, "a.png", None), None);
    }
}

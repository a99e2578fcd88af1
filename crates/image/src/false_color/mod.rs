//! False colour: the luminance of pixels as colours whose lightness is even, with a bar that says what they stand for.
//!
//! A pixel's luminance is that of its linear Rec.709 times the luminance of white, `CIE_Y_INTEGRAL · 683 lm/W` cd/m²
//! for scenes in W/(m² sr nm). It becomes `t` in [0, 1] between two ends, by its logarithm or in proportion, and `t` a
//! colour of viridis.

mod font;
mod legend;
mod map;

use crate::{Error, Image, Result, encoding::srgb_decode};
use steradian_math::spectra::{CIE_Y_INTEGRAL, photometry::LUMINOUS_EFFICACY};

/// Pixels that are not finite, in sRGB: a colour that the map does not come near.
const NOT_FINITE: [u8; 3] = [255, 0, 255];

/// An end of the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// A luminance.
    At(f64),
    /// Percentile: the part of the pixels, of those above zero if the scale is logarithmic, that is not above the end.
    Part(f64),
}

/// Settings of a false-colour picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FalseColor {
    is_linear: bool,
    ends: [End; 2],
    /// Luminance of white; `None` for what the picture says of itself.
    white: Option<f64>,
    unit: &'static str,
}

/// A scale whose ends are known.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    is_linear: bool,
    ends: [f64; 2],
}

impl Scale {
    /// Position of a luminance between the ends, clamped to them.
    fn place(&self, luminance: f64) -> f64 {
        let [low, high] = self.ends;
        let t = match self.is_linear {
            true => (luminance - low) / (high - low),
            false => (luminance / low).max(f64::MIN_POSITIVE).ln() / (high / low).ln(),
        };
        t.clamp(0.0, 1.0)
    }
}

impl FalseColor {
    /// Parses settings `scale=log|linear`, `min` and `max` as a luminance or a percentile of the pixels (`99.9%`),
    /// `white` (the luminance of a value of 1) and `unit=cd/m²|lx`. Absent: `log`, 1 % and 99.9 %, and cd/m².
    ///
    /// # Errors
    /// [`Error::Invalid`] for unknown names and values that cannot be.
    pub fn parse(text: &str) -> Result<Self> {
        let mut found =
            Self { is_linear: false, ends: [End::Part(0.01), End::Part(0.999)], white: None, unit: "cd/m²" };
        for setting in text.split(',').filter(|s| !s.is_empty()) {
            let (name, value) = setting.split_once('=').unwrap_or((setting, ""));
            let bad = |expected: &str| Err(Error::Invalid(format!("'{name}' is '{value}'; it must be {expected}")));
            match (name, value) {
                ("scale", "log") => found.is_linear = false,
                ("scale", "linear") => found.is_linear = true,
                ("scale", _) => return bad("log or linear"),
                ("unit", "lx") => found.unit = "lx",
                ("unit", "cd/m²" | "cd/m2") => found.unit = "cd/m²",
                ("unit", _) => return bad("cd/m² or lx"),
                ("min" | "max", _) => match end(value) {
                    Some(end) => found.ends[usize::from(name == "max")] = end,
                    None => return bad("a luminance of at least 0, or a percentile from 0% to 100%"),
                },
                ("white", _) => match value.parse().ok().filter(|v: &f64| *v > 0.0 && *v < 1e30) {
                    Some(white) => found.white = Some(white),
                    None => return bad("a luminance above 0"),
                },
                _ => {
                    let known = "scale, min, max, white, unit";
                    return Err(Error::Invalid(format!("false colour has no '{name}'; it has {known}")));
                }
            }
        }
        match found.ends {
            [End::At(low), End::At(high)] if low >= high => Err(Error::Invalid("'min' must be below 'max'".into())),
            [End::At(0.0), _] | [_, End::At(0.0)] if !found.is_linear => {
                Err(Error::Invalid("a logarithmic scale does not have 0; scale=linear does".into()))
            }
            _ => Ok(found),
        }
    }

    /// The picture with a legend at its right, to be shown as it is (linear values of colours that sRGB encodes), and
    /// how many pixels are not finite; they are magenta.
    ///
    /// # Errors
    /// [`Error::MissingChannels`], [`Error::Invalid`] where a given end is beyond all of the other's percentile.
    pub fn picture(&self, image: &Image) -> Result<(Image, usize)> {
        let planes = image.require_rgb()?;
        let white = self.white.unwrap_or_else(|| white_luminance(image));
        let luminance = |i: usize| {
            let [r, g, b] = planes.at(i).map(f64::from);
            (0.2126 * r + 0.7152 * g + 0.0722 * b) * white
        };
        let all: Vec<f64> = (0..image.pixel_count()).map(luminance).collect();
        let scale = self.scale(&all)?;
        let colour = |l: &f64| if l.is_finite() { map::color(scale.place(*l)) } else { NOT_FINITE };
        let colours: Vec<[u8; 3]> = all.iter().map(colour).collect();
        let (width, pixels) = legend::beside(&colours, [image.width(), image.height()], &scale, self.unit);
        let linear: Vec<[f32; 3]> = pixels.iter().map(|p| p.map(|v| srgb_decode(f32::from(v) / 255.0))).collect();
        let not_finite = all.iter().filter(|l| !l.is_finite()).count();
        Ok((Image::from_rgb(width, pixels.len() / width, &linear)?, not_finite))
    }

    /// The scale of a picture of these luminances.
    fn scale(&self, all: &[f64]) -> Result<Scale> {
        let counts = |l: &f64| l.is_finite() && (self.is_linear || *l > 0.0);
        let mut sorted: Vec<f64> = all.iter().copied().filter(counts).collect();
        sorted.sort_by(f64::total_cmp);
        let found = self.ends.map(|end| match end {
            End::At(luminance) => luminance,
            End::Part(part) => {
                let last = sorted.len().saturating_sub(1);
                sorted.get((part * last as f64).round() as usize).copied().unwrap_or(1.0)
            }
        });
        let [low, high] = found;
        // An even picture has no percentiles that differ.
        let ends = match self.ends {
            _ if low < high && (self.is_linear || (high / low).is_finite()) => found,
            [End::At(_), End::At(_)] => found,
            [End::At(_), _] if high < low => return Err(Error::Invalid(format!("no pixel is above min={low}"))),
            [_, End::At(_)] if high < low => return Err(Error::Invalid(format!("no pixel is below max={high}"))),
            [_, End::At(_)] => [high / 10.0, high],
            _ => [low, if low > 0.0 { low * 10.0 } else { low + 1.0 }],
        };
        Ok(Scale { is_linear: self.is_linear, ends })
    }
}

/// An end as it is written.
fn end(text: &str) -> Option<End> {
    let number = |text: &str| text.parse::<f64>().ok().filter(|v| v.is_finite() && *v >= 0.0);
    match text.strip_suffix('%') {
        Some(percent) => number(percent).filter(|v| *v <= 100.0).map(|v| End::Part(0.01 * v)),
        None => number(text).filter(|v| *v < 1e30 && (*v == 0.0 || *v > 1e-30)).map(End::At),
    }
}

/// The luminance of white that a picture names, or that of D65 of the same luminance as 1 W/(m² sr nm), cd/m².
fn white_luminance(image: &Image) -> f64 {
    match image.metadata.get("whiteLuminance") {
        Some(crate::Value::Float(v)) if *v > 0.0 && v.is_finite() => f64::from(*v),
        _ => CIE_Y_INTEGRAL * LUMINOUS_EFFICACY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoding::{quantize8, srgb_encode};

    /// A picture of luminances in cd/m², in one row.
    fn row(luminances: &[f64]) -> Image {
        let values: Vec<[f32; 3]> = luminances.iter().map(|l| [(l / 72_983.26) as f32; 3]).collect();
        Image::from_rgb(values.len(), 1, &values).unwrap()
    }

    fn shown(settings: &str, image: &Image) -> Vec<[u8; 3]> {
        let (picture, _) = FalseColor::parse(settings).unwrap().picture(image).unwrap();
        let rgb = picture.rgb().unwrap();
        (0..picture.pixel_count()).map(|i| rgb.at(i).map(|v| quantize8(srgb_encode(v)))).collect()
    }

    /// Colours are the same but for the rounding of a pixel to `f32`.
    fn assert_near(found: &[[u8; 3]], places: &[f64]) {
        for (found, place) in found.iter().zip(places) {
            let expected = map::color(*place);
            let off = found.iter().zip(expected).map(|(f, e)| f.abs_diff(e)).max();
            assert!(off <= Some(1), "{place}: {found:?} {expected:?}");
        }
    }

    /// Decades are evenly apart by the logarithm, and the middle of a linear scale is its mean.
    #[test]
    fn a_luminance_has_its_colour() {
        let decades = row(&[1.0, 10.0, 100.0, 1000.0, 10_000.0, 0.0, -5.0, 1e6]);
        assert_near(&shown("min=1,max=10000", &decades), &[0.0, 0.25, 0.5, 0.75, 1.0, 0.0, 0.0, 1.0]);
        let linear = row(&[0.0, 50.0, 100.0, 25.0]);
        assert_near(&shown("scale=linear,min=0,max=100", &linear), &[0.0, 0.5, 1.0, 0.25]);
        // The ends are the first and the last of a hundred pixels, less one at each.
        let ramp: Vec<f64> = (0..101).map(f64::from).collect();
        let part = shown("scale=linear,min=1%,max=99%", &row(&ramp));
        assert_near(&[part[1], part[50], part[99]], &[0.0, 0.5, 1.0]);
    }

    #[test]
    fn the_luminance_of_white_comes_from_the_picture_or_the_user() {
        let mut image = row(&[72_983.26, 7298.326]);
        image.metadata.set("whiteLuminance", crate::Value::Float(100.0));
        assert_eq!(shown("min=10,max=100", &image)[..2], [1.0, 0.0].map(map::color));
        assert_eq!(shown("min=10,max=100,white=10", &image)[..2], [0.0, 0.0].map(map::color));
    }

    #[test]
    fn what_is_not_finite_is_magenta_and_counted() {
        let mut image = row(&[1.0, 2.0, 3.0, 4.0]);
        for (plane, at, value) in [("R", 1, f32::NAN), ("G", 2, f32::INFINITY), ("B", 3, f32::NEG_INFINITY)] {
            image.channel_mut(plane).unwrap()[at] = value;
        }
        assert_eq!(FalseColor::parse("").unwrap().picture(&image).unwrap().1, 3);
        assert_eq!(shown("min=1,max=10", &image)[..4], [map::color(0.0), NOT_FINITE, NOT_FINITE, NOT_FINITE]);
        // Nothing, one value and black still have a scale.
        for odd in [row(&[f64::NAN]), row(&[5.0; 3]), row(&[0.0; 3]), row(&[1e-40, 1e30]), row(&[-3.0])] {
            for settings in ["", "scale=linear", "min=5", "max=5", "min=0%,max=0%"] {
                if let Ok((picture, _)) = FalseColor::parse(settings).unwrap().picture(&odd) {
                    assert!(picture.channels().iter().all(|c| c.data.iter().all(|v| (0.0..=1.0).contains(v))));
                }
            }
        }
    }

    #[test]
    fn settings_are_checked() {
        for (bad, about) in [
            ("scale=cubic", "log or linear"),
            ("min=-1", "at least 0"),
            ("max=101%", "percentile"),
            ("min=NaN", "luminance"),
            ("min=5,max=5", "below"),
            ("min=0", "logarithmic"),
            ("white=0", "above 0"),
            ("unit=nit", "cd/m² or lx"),
            ("bar=2", "it has scale"),
            ("min", "''"),
        ] {
            let refused = FalseColor::parse(bad).unwrap_err().to_string();
            assert!(refused.contains(about), "{bad}: {refused}");
        }
    }
}

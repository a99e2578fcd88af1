//! Tone curves: from linear Rec.709 radiance to display values.
//!
//! Every curve takes non-negative linear values (after exposure) and gives display values in [0, 1], ready to be
//! rounded to 8 or 16 bits. The perceptual curves end in the sRGB encoding; the curves of the path tracing lab
//! (`clamp`, `equalize` and those with `gamma`) encode as their name says and with nothing else. [`Curve::encoding`]
//! tells which.

mod agx;
mod filmic;
mod lab;
mod neutral;

use crate::{Error, Result, RgbPlanes};
use rayon::prelude::*;

/// Largest value a curve sees; keeps squares finite.
const CEILING: f32 = 1e9;

/// Most parameters of a curve.
const MAX_PARAMETERS: usize = 2;

/// A tone curve in the registry.
#[derive(Debug)]
pub struct Curve {
    /// Name on the command line.
    pub name: &'static str,
    /// Description in one line, with its source.
    pub doc: &'static str,
    /// Encoding of its result for the display, in words.
    pub encoding: &'static str,
    /// Its parameters, two at most.
    pub parameters: &'static [Parameter],
    map: fn([f32; 3], &Settings) -> [f32; 3],
}

/// A number that changes a tone curve.
#[derive(Debug)]
pub struct Parameter {
    /// Name on the command line.
    pub name: &'static str,
    /// Description of its effect, with unit and range.
    pub doc: &'static str,
    /// Value when not given.
    pub default: f32,
    /// Smallest and largest accepted value.
    pub range: [f32; 2],
}

/// Arguments of a curve's function besides the colour.
struct Settings {
    /// Values of the curve's parameters, in their order.
    values: [f32; MAX_PARAMETERS],
    /// The picture's largest finite component after exposure, above zero.
    maximum: f32,
}

/// All curves, in the order they are listed to people.
pub static CURVES: &[Curve] = &[
    filmic::NONE,
    lab::CLAMP,
    lab::EQUALIZE,
    lab::GAMMA,
    lab::CLAMP_GAMMA,
    lab::EQUALIZE_GAMMA,
    filmic::REINHARD,
    filmic::ACES_FIT,
    agx::AGX,
    neutral::PBR_NEUTRAL,
    filmic::HABLE,
];

/// The curve with this name.
///
/// # Errors
/// [`Error::UnknownTone`] with the nearest known name.
pub fn by_name(name: &str) -> Result<&'static Curve> {
    CURVES.iter().find(|curve| curve.name == name).ok_or_else(|| {
        let known: Vec<&str> = CURVES.iter().map(|curve| curve.name).collect();
        Error::UnknownTone { name: name.to_owned(), suggestion: nearest(name, known.iter().copied()), known }
    })
}

/// The candidate with the fewest edits, when these are at most a third of the letters (or it continues the name).
fn nearest(name: &str, candidates: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let name = name.to_ascii_lowercase().replace('_', "-");
    let short: String = name.chars().take(64).collect();
    candidates
        .map(|c| (if !short.is_empty() && c.starts_with(&short) { 1 } else { edits(&short, c) }, c))
        .filter(|&(distance, c)| distance * 3 <= c.len().max(3))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, c)| c)
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &to) in b.iter().enumerate() {
            let substitute = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = substitute.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// A curve with its parameters and an exposure.
#[derive(Clone, Debug)]
pub struct Tone {
    curve: &'static Curve,
    values: [f32; MAX_PARAMETERS],
    exposure: f32,
}

impl Default for Tone {
    /// `none`: sRGB encoding with clamping.
    fn default() -> Self {
        Self::of(&CURVES[0])
    }
}

impl PartialEq for Tone {
    fn eq(&self, other: &Self) -> bool {
        (self.curve.name, self.values, self.exposure) == (other.curve.name, other.values, other.exposure)
    }
}

impl Tone {
    /// A curve with its default parameters and no change of exposure.
    pub fn of(curve: &'static Curve) -> Self {
        let mut values = [0.0; MAX_PARAMETERS];
        values.iter_mut().zip(curve.parameters).for_each(|(value, parameter)| *value = parameter.default);
        Self { curve, values, exposure: 0.0 }
    }

    /// Parses `name` or `name:key=value,key=value`, e.g. `reinhard:white=4` or `gamma:gamma=2.4,exposure=1`.
    ///
    /// # Errors
    /// [`Error::UnknownTone`], [`Error::ToneParameter`].
    pub fn parse(text: &str) -> Result<Self> {
        let (name, settings) = text.split_once(':').unwrap_or((text, ""));
        let mut tone = Self::of(by_name(name)?);
        for setting in settings.split(',').filter(|s| !s.is_empty()) {
            let bad = |message| Error::ToneParameter { curve: tone.curve.name, message };
            let (key, value) =
                setting.split_once('=').ok_or_else(|| bad(format!("`{setting}` is not `name=value`")))?;
            let value = value.parse().map_err(|_| bad(format!("`{value}` is not a number")))?;
            tone.set(key, value)?;
        }
        Ok(tone)
    }

    /// Sets a parameter, or `exposure`.
    ///
    /// # Errors
    /// [`Error::ToneParameter`] for an unknown name (the known ones are listed) or a value out of range.
    pub fn set(&mut self, name: &str, value: f32) -> Result<()> {
        let bad = |message| Error::ToneParameter { curve: self.curve.name, message };
        let out_of = |[low, high]: [f32; 2]| bad(format!("`{name}` is {value}, not in {low} to {high}"));
        if name == "exposure" {
            if !(-64.0..=64.0).contains(&value) {
                return Err(out_of([-64.0, 64.0]));
            }
            self.exposure = value;
            return Ok(());
        }
        let Some(index) = self.curve.parameters.iter().position(|p| p.name == name) else {
            let known: Vec<_> = self.curve.parameters.iter().map(|p| p.name).chain(["exposure"]).collect();
            return Err(bad(format!("no parameter `{name}` (known: {})", known.join(", "))));
        };
        let range = self.curve.parameters[index].range;
        if !(range[0]..=range[1]).contains(&value) {
            return Err(out_of(range));
        }
        self.values[index] = value;
        Ok(())
    }

    /// Sets the exposure in EV (powers of two), −64 to 64.
    ///
    /// # Errors
    /// [`Error::ToneParameter`] when out of range.
    pub fn with_exposure(mut self, ev: f32) -> Result<Self> {
        self.set("exposure", ev)?;
        Ok(self)
    }

    /// The curve.
    pub fn curve(&self) -> &'static Curve {
        self.curve
    }

    /// The exposure in EV.
    pub fn exposure(&self) -> f32 {
        self.exposure
    }

    /// Maps single colours of a picture whose largest component is `maximum` (used by the equalising curves only).
    pub fn mapper(&self, maximum: f32) -> impl Fn([f32; 3]) -> [f32; 3] + Sync + '_ {
        let scale = self.exposure.exp2();
        let maximum = sanitized(maximum * scale).max(f32::MIN_POSITIVE);
        let settings = Settings { values: self.values, maximum };
        move |rgb| {
            let exposed = rgb.map(|v| sanitized(v * scale));
            (self.curve.map)(exposed, &settings).map(|v| v.clamp(0.0, 1.0))
        }
    }

    /// The largest finite component of a picture, or zero: what [`Self::mapper`] wants to know.
    pub(crate) fn maximum(planes: RgbPlanes<'_>) -> f32 {
        let largest = |plane: &[f32]| plane.par_iter().copied().filter(|v| v.is_finite()).reduce(|| 0.0, f32::max);
        largest(planes.r).max(largest(planes.g)).max(largest(planes.b))
    }
}

fn sanitized(v: f32) -> f32 {
    if v > 0.0 { v.min(CEILING) } else { 0.0 }
}

/// Relative luminance of linear Rec.709 (ITU-R BT.709-6).
fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Image;

    #[test]
    fn every_curve_is_monotone_on_greys_and_stays_in_range() {
        for curve in CURVES {
            let tone = Tone::of(curve);
            let map = tone.mapper(100.0);
            let mut last = 0.0;
            for step in 0..=4000 {
                let x = (step as f32 / 4000.0 * 24.0 - 14.0).exp2();
                let [r, g, b] = map([x; 3]);
                assert!((r - g).abs() < 2e-3 && (g - b).abs() < 2e-3, "{} tints grey {x}: {r} {g} {b}", curve.name);
                assert!(g >= last - 1e-6 && g <= 1.0, "{} is not monotone at {x}: {last} then {g}", curve.name);
                last = g;
            }
            assert!(last > 0.9, "{} never reaches white: {last}", curve.name);
            assert!(map([0.0; 3]).iter().all(|&v| v < 1e-3), "{} lifts black", curve.name);
        }
    }

    #[test]
    fn every_curve_survives_strange_colours() {
        for curve in CURVES {
            let tone = Tone::of(curve).with_exposure(64.0).unwrap();
            let map = tone.mapper(f32::INFINITY);
            for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, f32::MAX, f32::MIN_POSITIVE, 0.0] {
                for rgb in [[odd; 3], [odd, 0.0, 0.0], [0.0, odd, 1.0], [1.0, 1.0, odd]] {
                    let out = map(rgb);
                    assert!(out.iter().all(|v| (0.0..=1.0).contains(v)), "{}: {rgb:?} gives {out:?}", curve.name);
                }
            }
        }
    }

    #[test]
    fn exposure_is_in_stops() {
        let tone = Tone::default();
        let brighter = tone.clone().with_exposure(2.0).unwrap();
        assert_eq!(tone.mapper(1.0)([0.4; 3]), brighter.mapper(1.0)([0.1; 3]));
    }

    #[test]
    fn names_are_found_or_suggested() {
        for curve in CURVES {
            assert_eq!(by_name(curve.name).unwrap().name, curve.name);
            assert!(curve.parameters.len() <= MAX_PARAMETERS);
            for p in curve.parameters {
                assert!((p.range[0]..=p.range[1]).contains(&p.default));
            }
        }
        let suggestion = |name: &str| match by_name(name) {
            Err(Error::UnknownTone { suggestion, .. }) => suggestion,
            other => panic!("{other:?}"),
        };
        assert_eq!(suggestion("Reinhardt"), Some("reinhard"));
        assert_eq!(suggestion("equalise"), Some("equalize"));
        assert_eq!(suggestion("aces"), Some("aces-fit"));
        assert_eq!(suggestion("clamp_gamma"), Some("clamp-gamma"));
        assert_eq!(suggestion("photographic"), None);
        assert_eq!(suggestion(""), None);
    }

    #[test]
    fn parameters_are_parsed_and_checked() {
        let tone = Tone::parse("gamma:gamma=1,exposure=-1").unwrap();
        assert_eq!(tone.mapper(1.0)([1.0, 0.5, 0.0]), [0.5, 0.25, 0.0]);
        for bad in ["gamma:gamma=0", "gamma:gamma=x", "gamma:white=1", "gamma:gamma", "none:exposure=NaN", "gama"] {
            assert!(Tone::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn pictures_are_mapped_by_the_largest_finite_component() {
        let image = Image::from_rgb(2, 1, &[[4.0, 2.0, f32::NAN], [1.0, f32::INFINITY, 0.0]]).unwrap();
        let planes = image.rgb().unwrap();
        let tone = Tone::parse("equalize").unwrap();
        let map = tone.mapper(Tone::maximum(planes));
        assert_eq!([map(planes.at(0)), map(planes.at(1))], [[1.0, 0.5, 0.0], [0.25, 1.0, 0.0]]);
    }
}

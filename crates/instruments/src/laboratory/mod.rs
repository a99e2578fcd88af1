//! Parts of every experiment: parameters, numbers, charts and pictures.
//!
//! An [`Experiment`] has a name, parameters with ranges and units, and a function that computes a [`Report`].

mod chart;
mod color;
mod draw;
mod values;

pub use chart::{Axis, Backdrop, Chart, Label, Marker, Series};
pub use color::{monochromatic, rgb_from_xyz_in_gamut, spectrum_rgb};
pub use values::{Kind, Parameter, Values};

use rayon::prelude::*;
use serde::Serialize;
use steradian_image::Image;
use thiserror::Error;

/// Errors that keep an experiment from being carried out.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter that the experiment does not have.
    #[error("'{experiment}' has no parameter '{name}'{hint}")]
    UnknownParameter {
        /// The experiment.
        experiment: &'static str,
        /// The name given.
        name: String,
        /// "; did you mean …", or the parameters that there are.
        hint: String,
    },
    /// A value that is not what the parameter takes.
    #[error("parameter '{name}': {why}")]
    BadValue {
        /// The parameter.
        name: &'static str,
        /// Description of the fault, and of the expected values.
        why: String,
    },
    /// Values that are possible each but not together.
    #[error("{0}")]
    Impossible(String),
    /// A picture that cannot be worked on.
    #[error(transparent)]
    Image(#[from] steradian_image::Error),
}

/// A measured or computed number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// Its value.
    #[serde(serialize_with = "number_or_word")]
    pub value: f64,
    /// Its unit; empty for pure numbers.
    pub unit: &'static str,
}

/// JSON has no infinite numbers: they are written as the words `"infinity"` and `"-infinity"`.
fn number_or_word<S: serde::Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    match *value {
        f64::INFINITY => to.serialize_str("infinity"),
        f64::NEG_INFINITY => to.serialize_str("-infinity"),
        v => to.serialize_f64(v),
    }
}

/// Finding in words: the kind of something, or the reason why a number is missing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fact {
    /// Its subject.
    pub name: &'static str,
    /// The finding.
    pub text: String,
}

/// Result of an experiment.
#[derive(Debug, Default)]
pub struct Report {
    /// Findings in words.
    pub facts: Vec<Fact>,
    /// Numbers.
    pub quantities: Vec<Quantity>,
    /// Curves.
    pub chart: Option<Chart>,
    /// A picture in linear Rec.709.
    pub picture: Option<Image>,
}

impl Report {
    /// Adds what is said in words.
    pub fn fact(&mut self, name: &'static str, text: impl Into<String>) {
        self.facts.push(Fact { name, text: text.into() });
    }

    /// Adds a number.
    pub fn quantity(&mut self, name: impl Into<String>, value: f64, unit: &'static str) {
        self.quantities.push(Quantity { name: name.into(), value, unit });
    }

    /// The value of the number called `name`; NaN where there is none.
    pub fn value(&self, name: &str) -> f64 {
        self.quantities.iter().find(|q| q.name == name).map_or(f64::NAN, |q| q.value)
    }
}

/// A picture to work on: linear Rec.709, by rows from the top.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// The pixels.
    pub rgb: Vec<[f32; 3]>,
}

impl Picture {
    /// A picture whose pixel `(x, y)` is `color(x, y)`.
    pub fn from_fn(width: usize, height: usize, color: impl Fn(usize, usize) -> [f32; 3] + Sync) -> Self {
        let rgb = (0..width * height).into_par_iter().map(|i| color(i % width, i / width)).collect();
        Self { width, height, rgb }
    }

    /// A copy with each pixel replaced by a function of it.
    pub fn map(&self, mut f: impl FnMut([f32; 3]) -> [f32; 3]) -> Self {
        Self { rgb: self.rgb.iter().map(|c| f(*c)).collect(), ..*self }
    }

    /// As an image with channels `R`, `G` and `B`.
    ///
    /// # Errors
    /// Where the number of pixels is not width × height.
    pub fn to_image(&self) -> Result<Image, Error> {
        Ok(Image::from_rgb(self.width, self.height, &self.rgb)?)
    }
}

/// Function that carries out an experiment.
#[derive(Clone, Copy, Debug)]
pub enum Run {
    /// From parameters alone.
    Alone(fn(&Values) -> Result<Report, Error>),
    /// On a picture.
    OnPicture(fn(&Values, &Picture) -> Result<Report, Error>),
}

/// An experiment.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Its name on the command line.
    pub name: &'static str,
    /// Description in a sentence.
    pub doc: &'static str,
    /// Source of its equations.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// The computation.
    pub run: Run,
}

impl Experiment {
    /// Resolves `given` names and values against the parameters, and runs the experiment; `picture` is what it works
    /// on, where it works on one.
    ///
    /// # Errors
    /// [`enum@Error`] for unknown parameters, values out of range, a missing picture, and what the experiment itself
    /// refuses.
    pub fn run(&self, given: &[(String, String)], picture: Option<&Picture>) -> Result<Report, Error> {
        let values = Values::resolve(self, given)?;
        match (self.run, picture) {
            (Run::Alone(run), None) => run(&values),
            (Run::OnPicture(run), Some(picture)) => run(&values, picture),
            (Run::Alone(_), Some(_)) => Err(Error::Impossible(format!("'{}' takes no picture", self.name))),
            (Run::OnPicture(_), None) => Err(Error::Impossible(format!("'{}' needs a picture to work on", self.name))),
        }
    }

    /// True if it works on a picture.
    pub fn needs_picture(&self) -> bool {
        matches!(self.run, Run::OnPicture(_))
    }
}

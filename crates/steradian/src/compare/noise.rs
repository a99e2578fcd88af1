//! Noise of a picture and its reference, which the z-test goes by.

use super::Reference;
use std::path::Path;
use steradian_image::{Image, RgbPlanes, Value};

/// Variances of the difference of two pictures.
#[derive(Debug)]
pub struct Noise<'a> {
    samples: f64,
    source: Source<'a>,
}

#[derive(Debug)]
enum Source<'a> {
    /// Variances of one sample of the picture; the reference is exact.
    Given(RgbPlanes<'a>),
    /// Variances of the means of both pictures.
    Layers([RgbPlanes<'a>; 2]),
}

impl<'a> Noise<'a> {
    /// Noise by a picture of the variance of one sample.
    ///
    /// # Errors
    /// An unknown number of samples, and sizes that differ.
    pub fn given((path, picture): (&Path, &Image), variance: &'a Image, samples: Option<f64>) -> Result<Self, String> {
        let refused = |what: String| format!("'{}' {what}", path.display());
        let samples = samples
            .or_else(|| samples_per_pixel(picture))
            .ok_or_else(|| refused("does not say how many samples it has; give --samples for the z-test".into()))?;
        let [own, other] = [picture, variance].map(|image| [image.width(), image.height()]);
        if own != other {
            let what = format!("has {}x{} pixels, and --variance {}x{}", own[0], own[1], other[0], other[1]);
            return Err(refused(what));
        }
        let planes = variance.require_rgb().map_err(|e| format!("--variance: {e}"))?;
        Ok(Self { samples, source: Source::Given(planes) })
    }

    /// Noise by the variance layers of the pictures themselves; `Ok(None)` where neither has them.
    ///
    /// # Errors
    /// Which picture lacks what the test needs, where the other one has it: to take a picture of unknown noise for an
    /// exact one would find differences where there are none.
    pub fn by_layers(
        (path, picture): (&Path, &'a Image),
        (reference_path, reference): (&Path, &'a Reference),
    ) -> Result<Option<Self>, String> {
        let lacks = |path: &Path, what: &str| format!("'{}' has no {what}", path.display());
        let layers = match (picture.layer_rgb("variance"), reference.image.layer_rgb("variance")) {
            (Some(own), Some(other)) => [own, other],
            (None, None) => return Ok(None),
            (None, _) => return Err(lacks(path, "layer 'variance'")),
            (_, None) => return Err(lacks(reference_path, "layer 'variance'")),
        };
        let samples = samples_per_pixel(picture).ok_or_else(|| lacks(path, "number of samples ('samplesPerPixel')"))?;
        Ok(Some(Self { samples, source: Source::Layers(layers) }))
    }

    /// Samples per pixel of the picture.
    pub fn samples(&self) -> f64 {
        self.samples
    }

    /// Variance of one sample. The layers hold variances of means; variances of independent pictures add up.
    pub fn of_one_sample(&self, i: usize) -> [f64; 3] {
        match self.source {
            Source::Given(variance) => variance.at(i).map(f64::from),
            Source::Layers([own, other]) => {
                let (a, b) = (own.at(i), other.at(i));
                std::array::from_fn(|c| (f64::from(a[c]) + f64::from(b[c])) * self.samples)
            }
        }
    }
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

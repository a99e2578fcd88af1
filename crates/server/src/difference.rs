//! Maps of how far the picture that is shown is from the reference.

use crate::{
    app::{App, Refused},
    kept::AboutReference,
    reference::{LAYER, binary, broken_off, pieces, unfit},
    tile::{self, Plane},
};
use axum::{
    extract::{Query, State},
    http::StatusCode,
    response::Response,
};
use serde::{Deserialize, Serialize};
use steradian::image::{
    Error, Image, WriteOptions, display8,
    encoding::srgb8_decode,
    metrics::{self, DEFAULT_PIXELS_PER_DEGREE},
    tone::Tone,
};

/// Metric of the difference of pixels.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub enum Metric {
    /// FLIP, of what is displayed where a tone curve is given; 0 to 1.
    Flip,
    /// (x − r)² / (r² + 0.01), the mean of the components: its mean is the relMSE.
    Relative,
    /// |x − r| of each component.
    Absolute,
}

/// Which map of differences.
#[derive(Deserialize)]
pub struct Asked {
    metric: Metric,
    tone: Option<String>,
    exposure: Option<f32>,
}

/// Header of a map of differences: its subject and its figures; those that are not finite are `null`.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Figures {
    metric: Metric,
    generation: u32,
    crop: [u32; 4],
    samples: f64,
    /// Mean of the map's values.
    mean: Option<f64>,
    /// Value that 95 % of them do not exceed.
    quantile95: Option<f64>,
    relmse: Option<f64>,
    /// Decibels, of display values without a tone curve.
    psnr: Option<f64>,
}

/// The map of how far the picture that is shown is from the reference: its figures and its tiles.
pub async fn difference(
    State(app): State<App>,
    Query(Asked { metric, tone, exposure }): Query<Asked>,
) -> Result<Response, Refused> {
    let bad = |e: Error| Refused(StatusCode::BAD_REQUEST, e.to_string());
    let tone = tone_of(tone.as_deref(), exposure).map_err(bad)?;
    let reference = app.reference.get();
    let reference = reference.ok_or_else(|| Refused(StatusCode::NOT_FOUND, "there is no reference".into()))?;
    let conflict = |why: String| Refused(StatusCode::CONFLICT, why);
    let shown = app.viewer.shown().ok_or_else(|| conflict("there is no picture yet".into()))?;
    let of = |what: &AboutReference| {
        format!(
            "{}x{} pixels{}",
            what.width,
            what.height,
            what.crop.map_or_else(String::new, |[x, y, ..]| format!(" from {x}, {y}"))
        )
    };
    let crop = shown.film.crop;
    let about =
        AboutReference { name: String::new(), width: crop.width(), height: crop.height(), crop: Some(shown.crop) };
    let is_other_part = reference.about.crop.is_some_and(|crop| crop != shown.crop);
    if (about.width, about.height) != (reference.about.width, reference.about.height) || is_other_part {
        return Err(conflict(format!("the picture has {}, the reference {}", of(&about), of(&reference.about))));
    }
    let draw = move || {
        let subject = Subject { generation: shown.generation, crop: shown.crop, samples: shown.samples };
        drawn(&subject, metric, &shown.picture(&[]), &reference.image, tone)
    };
    let drawn: Result<_, Error> = app.reference.work(draw).await.map_err(broken_off)?;
    Ok(binary(drawn.map_err(|e| unfit(e.to_string()))?))
}

/// Tone curve of what is displayed; `None` where neither a curve nor an exposure is given.
///
/// # Errors
/// Unknown curves, and exposures out of range.
pub fn tone_of(tone: Option<&str>, exposure: Option<f32>) -> Result<Option<Tone>, Error> {
    let tone = tone.map(Tone::parse).transpose()?;
    match (tone, exposure) {
        (None, None) => Ok(None),
        (tone, ev) => tone.unwrap_or_default().with_exposure(ev.unwrap_or(0.0)).map(Some),
    }
}

/// Subject of a map: the picture's number, its part of the full picture, and its samples.
pub struct Subject {
    /// Number of the picture.
    pub generation: u32,
    /// Pixels x0, y0, x1, y1.
    pub crop: [u32; 4],
    /// Samples per pixel.
    pub samples: f64,
}

/// The map of how far a picture is from another one: its figures and its tiles.
///
/// # Errors
/// Two pictures that cannot be compared.
pub fn drawn(
    subject: &Subject,
    metric: Metric,
    image: &Image,
    reference: &Image,
    tone: Option<Tone>,
) -> Result<Vec<u8>, Error> {
    let all = metrics::compare(image, reference)?;
    let (components, values) = map(metric, image, reference, tone)?;
    let finite = |v: f64| v.is_finite().then_some(v);
    let [mean, quantile95] = statistics(&values);
    let figures = Figures {
        metric,
        generation: subject.generation,
        crop: subject.crop,
        samples: subject.samples,
        mean,
        quantile95,
        relmse: finite(all.rel_mse),
        psnr: finite(all.psnr),
    };
    let size = [image.width() as u32, image.height() as u32];
    let plane = Plane { layer: LAYER, components, size, values: &values };
    Ok(pieces(&figures, &tile::tiles(subject.generation, &plane)))
}

/// The components of a map's pixel, and its values.
fn map(metric: Metric, image: &Image, reference: &Image, tone: Option<Tone>) -> Result<(u16, Vec<f32>), Error> {
    match metric {
        Metric::Flip => {
            let Some(tone) = tone else {
                return Ok((1, metrics::flip_map(image, reference, DEFAULT_PIXELS_PER_DEGREE)?));
            };
            let options = WriteOptions { tone, ..WriteOptions::default() };
            let seen = |image: &Image| {
                let linear: Vec<f32> = display8(image, &options)?.into_iter().map(srgb8_decode).collect();
                Image::from_rgb(image.width(), image.height(), linear.as_chunks().0)
            };
            Ok((1, metrics::flip_map(&seen(image)?, &seen(reference)?, DEFAULT_PIXELS_PER_DEGREE)?))
        }
        Metric::Absolute => Ok((3, metrics::absolute_difference(image, reference)?.to_rgb()?.into_flattened())),
        Metric::Relative => {
            let (a, b) = (image.require_rgb()?, reference.require_rgb()?);
            let error = |x: f32, r: f32| (x - r) * (x - r) / (r * r + 0.01);
            let pixel = |i: usize| a.at(i).into_iter().zip(b.at(i)).map(|(x, r)| error(x, r)).sum::<f32>() / 3.0;
            Ok((1, (0..image.pixel_count()).map(pixel).collect()))
        }
    }
}

/// Mean and 95 % quantile of the values that are finite.
fn statistics(values: &[f32]) -> [Option<f64>; 2] {
    let mut values: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let count = values.len();
    if count == 0 {
        return [None; 2];
    }
    let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / count as f64;
    let rank = (count * 95).div_ceil(100) - 1;
    let (_, quantile, _) = values.select_nth_unstable_by(rank, f32::total_cmp);
    [Some(mean), Some(f64::from(*quantile))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_of_what_is_finite() {
        let mut values: Vec<f32> = (1..=100).rev().map(|v| v as f32).collect();
        values.extend([f32::NAN, f32::INFINITY]);
        assert_eq!(statistics(&values), [Some(50.5), Some(95.0)]);
        assert_eq!(statistics(&[f32::NAN]), [None, None]);
        assert_eq!(statistics(&[3.0]), [Some(3.0), Some(3.0)]);
    }
}

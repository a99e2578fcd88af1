//! The reference: a picture that is kept, or comes as a file, to hold the one that is shown against it.

use crate::{
    look::MOST_PIXELS,
    routes::{App, Refused},
    tile::{self, Plane},
};
use axum::{
    extract::{Multipart, Query, State, multipart::MultipartRejection},
    http::{StatusCode, header},
    response::{IntoResponse, Json, Response},
};
use serde::{Deserialize, Serialize};
use std::{
    io::Write,
    path::Path,
    sync::{Arc, Mutex, PoisonError},
};
use steradian::image::{
    Error, Image, Limits, WriteOptions, display8,
    encoding::srgb8_decode,
    metrics::{self, DEFAULT_PIXELS_PER_DEGREE},
    read,
    tone::Tone,
};

/// Bytes of a file.
pub const MOST_BYTES: usize = 512 << 20;
/// The layer of the reference's tiles and of maps.
const LAYER: u16 = u16::MAX;
/// Letters of a name.
const LONGEST_NAME: usize = 120;

/// The reference, if there is one.
#[derive(Default)]
pub struct Keeper {
    kept: Mutex<Option<Arc<Reference>>>,
    /// One file is decoded, or one map made, at a time.
    turn: Arc<tokio::sync::Mutex<()>>,
}

struct Reference {
    about: About,
    image: Image,
}

/// What pages know of it.
#[derive(Clone, Serialize)]
struct About {
    name: String,
    width: u32,
    height: u32,
    /// The part of the full picture that it shows, x0, y0, x1, y1; `None` of files.
    crop: Option<[u32; 4]>,
}

impl Reference {
    /// Of a picture that tiles can hold, with colours.
    fn new(name: String, crop: Option<[u32; 4]>, image: Image) -> Result<Self, String> {
        image.require_rgb().map_err(|e| e.to_string())?;
        let side =
            |n: usize| u16::try_from(n).map_err(|_| format!("{n} pixels are too many along an edge: {}", u16::MAX));
        let [width, height] = [side(image.width())?, side(image.height())?].map(u32::from);
        Ok(Self { about: About { name, width, height, crop }, image })
    }
}

impl Keeper {
    fn get(&self) -> Option<Arc<Reference>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, reference: Option<Reference>) {
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = reference.map(Arc::new);
    }

    /// Works beside the server, one at a time.
    async fn work<T: Send + 'static>(&self, work: impl FnOnce() -> T + Send + 'static) -> Result<T, Refused> {
        let turn = Arc::clone(&self.turn).lock_owned().await;
        let work = move || {
            // Held to the end, also where nobody waits any longer.
            let _turn = turn;
            work()
        };
        let failed = |e: tokio::task::JoinError| Refused(StatusCode::INTERNAL_SERVER_ERROR, e.to_string());
        tokio::task::spawn_blocking(work).await.map_err(failed)
    }
}

/// Where a reference comes from.
#[derive(Deserialize)]
pub struct Origin {
    from: Option<String>,
}

/// Keeps the picture that is shown (`?from=current`), or the one of a file, form field `file`.
pub async fn keep(
    State(app): State<App>,
    Query(Origin { from }): Query<Origin>,
    form: Result<Multipart, MultipartRejection>,
) -> Result<Response, Refused> {
    let reference = match from.as_deref() {
        Some("current") => current(&app).await,
        Some(other) => Err(Refused(StatusCode::BAD_REQUEST, format!("'from' is 'current', not '{other}'"))),
        None => match form {
            Ok(form) => file(&app, form).await,
            Err(why) => Err(Refused(why.status(), why.body_text())),
        },
    };
    let reference = reference.inspect_err(|why| (app.log)(&format!("refused a reference: {}", why.1)))?;
    let about = Json(reference.about.clone());
    app.reference.set(Some(reference));
    Ok(about.into_response())
}

async fn current(app: &App) -> Result<Reference, Refused> {
    let not_yet = |why: &str| Refused(StatusCode::CONFLICT, why.into());
    let shown = app.viewer.shown().ok_or_else(|| not_yet("there is no picture yet"))?;
    if shown.kind == "preview" {
        return Err(not_yet("only a preview is shown; the picture can be kept once its render has begun"));
    }
    let keep = move || {
        let name = format!("kept at {} spp", (10.0 * shown.samples).round() / 10.0);
        Reference::new(name, Some(shown.crop), shown.picture(&[]))
    };
    app.reference.work(keep).await?.map_err(unfit)
}

async fn file(app: &App, mut form: Multipart) -> Result<Reference, Refused> {
    let broken = |e: axum::extract::multipart::MultipartError| Refused(e.status(), e.body_text());
    let failed =
        |e: std::io::Error| Refused(StatusCode::INTERNAL_SERVER_ERROR, format!("the file cannot be kept: {e}"));
    let field = form.next_field().await.map_err(broken)?.filter(|field| field.name() == Some("file"));
    let mut field =
        field.ok_or_else(|| Refused(StatusCode::BAD_REQUEST, "a picture comes as the form field 'file'".into()))?;
    let name: String =
        field.file_name().unwrap_or("picture").chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
    // Of some formats only the extension tells.
    let extension =
        Path::new(&name).extension().and_then(|e| e.to_str()).filter(|e| e.chars().all(char::is_alphanumeric));
    let suffix = extension.map(|e| format!(".{e}")).unwrap_or_default();
    let mut kept = tempfile::Builder::new().prefix("steradian-view-").suffix(&suffix).tempfile().map_err(failed)?;
    while let Some(bytes) = field.chunk().await.map_err(broken)? {
        kept.write_all(&bytes).map_err(failed)?;
    }
    let decode = move || {
        let limits = Limits { pixels: MOST_PIXELS, ..Limits::default() };
        let image = read(kept.path(), &limits).map_err(|e| match e {
            // The path is none that people know.
            Error::File { error, .. } => format!("{name}: {error}"),
            other => format!("{name}: {other}"),
        })?;
        Reference::new(name, None, image)
    };
    app.reference.work(decode).await?.map_err(unfit)
}

fn unfit(why: String) -> Refused {
    Refused(StatusCode::UNPROCESSABLE_ENTITY, why)
}

/// Forgets the reference.
pub async fn forget(State(app): State<App>) -> StatusCode {
    app.reference.set(None);
    StatusCode::NO_CONTENT
}

/// The reference: what is known of it and its tiles; nothing where there is none.
pub async fn get(State(app): State<App>) -> Result<Response, Refused> {
    let Some(reference) = app.reference.get() else { return Ok(StatusCode::NO_CONTENT.into_response()) };
    let encode = move || {
        let colours = reference.image.to_rgb().map_err(|e| e.to_string())?;
        let plane = Plane {
            layer: LAYER,
            components: 3,
            size: [reference.about.width, reference.about.height],
            values: colours.as_flattened(),
        };
        Ok(pieces(&reference.about, &tile::tiles(0, &plane)))
    };
    Ok(binary(app.reference.work(encode).await?.map_err(unfit)?))
}

/// JSON and tiles, each after its length in bytes (`u32`, little-endian).
fn pieces(head: &impl Serialize, tiles: &[Vec<u8>]) -> Vec<u8> {
    let head = serde_json::to_vec(head).unwrap_or_default();
    let pieces = std::iter::once(&head).chain(tiles);
    pieces.flat_map(|piece| [&(piece.len() as u32).to_le_bytes(), piece.as_slice()].concat()).collect()
}

fn binary(bytes: Vec<u8>) -> Response {
    ([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response()
}

/// How far pixels are apart.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
enum Metric {
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

/// What a map is of, and its figures; those that are not finite are `null`.
#[derive(Serialize)]
struct Figures {
    metric: Metric,
    generation: u32,
    crop: [u32; 4],
    samples: f64,
    /// Of the map's values.
    mean: Option<f64>,
    /// What 95 % of them do not exceed.
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
    let tone = tone.as_deref().map(Tone::parse).transpose().map_err(bad)?;
    let tone = match (tone, exposure) {
        (None, None) => None,
        (tone, ev) => Some(tone.unwrap_or_default().with_exposure(ev.unwrap_or(0.0)).map_err(bad)?),
    };
    let reference = app.reference.get();
    let reference = reference.ok_or_else(|| Refused(StatusCode::NOT_FOUND, "there is no reference".into()))?;
    let conflict = |why: String| Refused(StatusCode::CONFLICT, why);
    let shown = app.viewer.shown().ok_or_else(|| conflict("there is no picture yet".into()))?;
    let of = |what: &About| {
        format!(
            "{}x{} pixels{}",
            what.width,
            what.height,
            what.crop.map_or_else(String::new, |[x, y, ..]| format!(" from {x}, {y}"))
        )
    };
    let crop = shown.film.crop;
    let about = About { name: String::new(), width: crop.width(), height: crop.height(), crop: Some(shown.crop) };
    let is_other_part = reference.about.crop.is_some_and(|crop| crop != shown.crop);
    if (about.width, about.height) != (reference.about.width, reference.about.height) || is_other_part {
        return Err(conflict(format!("the picture has {}, the reference {}", of(&about), of(&reference.about))));
    }
    let draw = move || {
        let image = shown.picture(&[]);
        let all = metrics::compare(&image, &reference.image)?;
        let (components, values) = map(metric, &image, &reference.image, tone)?;
        let finite = |v: f64| v.is_finite().then_some(v);
        let [mean, quantile95] = statistics(&values);
        let figures = Figures {
            metric,
            generation: shown.generation,
            crop: shown.crop,
            samples: shown.samples,
            mean,
            quantile95,
            relmse: finite(all.rel_mse),
            psnr: finite(all.psnr),
        };
        let plane = Plane { layer: LAYER, components, size: [about.width, about.height], values: &values };
        Ok(pieces(&figures, &tile::tiles(shown.generation, &plane)))
    };
    let drawn: Result<_, Error> = app.reference.work(draw).await?;
    Ok(binary(drawn.map_err(|e| unfit(e.to_string()))?))
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

//! Requests of the page for finished pictures.

use crate::{
    access::Access,
    app::Refused,
    difference::{Metric, Subject, drawn, tone_of},
    gallery::{Gallery, Listing, Loaded},
    log::Log,
    look::StartExposure,
    page,
    protocol::{Exposure, ToneChoice},
    reference::{LAYER, binary, broken_off, pieces, unfit},
    requests::{Sample, in_order},
    routes::guarded,
    state::{tones, with_exposure},
    tile::{self, Plane},
    turn::Turn,
    upload,
};
use axum::{
    Router,
    extract::{DefaultBodyLimit, Multipart, Path, Query, State},
    http::StatusCode,
    response::{IntoResponse, Json, Response},
    routing::{get, post},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use steradian::{
    Layer,
    image::{Image, TemporaryFolder},
};

/// Name of the layer of a picture's colours.
const PICTURE: &str = "picture";

/// Display of the first picture.
#[derive(Clone, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct FirstLook {
    /// Tone curves that can be chosen.
    tones: &'static [ToneChoice],
    /// Tone curve to begin with, with its exposure.
    tone: String,
    /// Exposure to begin with.
    exposure: Exposure,
}

impl FirstLook {
    /// With a tone curve and an exposure, where they were asked for.
    pub fn new(tone: Option<&str>, exposure: Option<StartExposure>) -> Self {
        let by = if exposure == Some(StartExposure::Auto) { Exposure::Auto } else { Exposure::Given };
        Self { tones: tones(), tone: with_exposure(tone.unwrap_or("none"), exposure), exposure: by }
    }
}

/// Shared state of the requests.
#[derive(Clone)]
struct Shelf {
    gallery: Arc<Gallery>,
    look: Arc<FirstLook>,
    log: Arc<Log>,
    /// One file is decoded, or one map made, at a time.
    turn: Turn,
}

/// All that there is to pictures.
pub fn router(gallery: Gallery, look: FirstLook, access: Arc<Access>, log: Arc<Log>) -> Router {
    let shelf =
        Shelf { gallery: Arc::new(gallery), look: Arc::new(look), log: Arc::clone(&log), turn: Turn::default() };
    let api = Router::new()
        .route("/look", get(|State(shelf): State<Shelf>| async move { Json(FirstLook::clone(&shelf.look)) }))
        .route("/pictures", get(list))
        .route("/picture", get(picture))
        .route("/pixel", get(pixel))
        .route("/difference", get(difference))
        .route("/open", post(open).layer(DefaultBodyLimit::max(upload::MOST_BYTES)))
        .fallback(|| async { Refused(StatusCode::NOT_FOUND, "there is no such request".into()) });
    let inside = Router::new()
        .nest("/api", api)
        .route("/", get(|| async { page::file("pictures.html") }))
        .route("/{*file}", get(|Path(file): Path<String>| async move { page::file(&file) }))
        .with_state(shelf);
    guarded(inside, access, log)
}

/// The list, after a look at the files.
async fn list(State(shelf): State<Shelf>) -> Result<Json<Vec<Listing>>, Refused> {
    let look = move || shelf.gallery.list();
    let list = tokio::task::spawn_blocking(look).await.map_err(std::io::Error::other).map_err(broken_off)?;
    Ok(Json(list))
}

/// A picture of the list.
fn load(gallery: &Gallery, id: usize) -> Result<Loaded, Refused> {
    let loaded = gallery.load(id).ok_or_else(|| Refused(StatusCode::NOT_FOUND, format!("there is no picture {id}")))?;
    loaded.map_err(unfit)
}

/// A layer of a picture.
#[derive(Deserialize)]
struct Asked {
    id: usize,
    layer: Option<String>,
}

/// A layer or a channel.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LayerChoice {
    /// Its name in the file.
    name: String,
    /// Description.
    doc: String,
}

/// Description of a picture for pages; its tiles follow.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct AboutPicture {
    id: usize,
    /// Path.
    name: String,
    /// Version of its file.
    version: u32,
    /// Pixels.
    width: u32,
    /// Pixels.
    height: u32,
    /// The layer that comes.
    layer: String,
    /// Layers and channels that can be asked for.
    layers: Vec<LayerChoice>,
    /// Notes about reading the file.
    notes: Vec<String>,
}

/// A layer of a picture: what is known of it and its tiles.
async fn picture(State(shelf): State<Shelf>, Query(asked): Query<Asked>) -> Result<Response, Refused> {
    let layer = asked.layer.unwrap_or_else(|| PICTURE.into());
    let encode = move || {
        let Loaded { name, version, image } = load(&shelf.gallery, asked.id)?;
        let (components, values) = plane(&image, &layer).ok_or_else(|| lacks(&name, &image, &layer))?;
        let [width, height] = [image.width(), image.height()].map(|n| n as u32);
        let plane = Plane { layer: LAYER, components, size: [width, height], values: &values };
        let (layers, notes) = (layers(&image), image.metadata.notes.clone());
        let about = AboutPicture { id: asked.id, name, version, width, height, layer, layers, notes };
        Ok(pieces(&about, &tile::tiles(version, &plane)))
    };
    Ok(binary(shelf.turn.work(encode).await.map_err(broken_off)??))
}

fn lacks(name: &str, image: &Image, layer: &str) -> Refused {
    let why =
        format!("'{name}' has no layer '{layer}' of at most four channels; its channels: {}", image.channel_names());
    Refused(StatusCode::NOT_FOUND, why)
}

/// Layer that a channel belongs to.
fn layer_of(channel: &str) -> Option<&str> {
    channel.rsplit_once('.').map(|(layer, _)| layer)
}

/// Layers that a picture has beside its colours, then its channels.
fn layers(image: &Image) -> Vec<LayerChoice> {
    let mut found: Vec<LayerChoice> = Vec::new();
    for layer in image.channels().iter().filter_map(|c| layer_of(&c.name)) {
        let prefix = format!("{layer}.");
        let channels: Vec<&str> = image.channels().iter().map(|c| c.name.as_str()).collect();
        let channels: Vec<&str> = channels.into_iter().filter(|name| name.starts_with(&prefix)).collect();
        if channels.len() <= 4 && found.iter().all(|l| l.name != layer) {
            let known = Layer::ALL.iter().find(|l| l.prefix() == layer && l.name() != layer);
            let known = known.map(|l| format!("{}: ", l.name())).unwrap_or_default();
            found.push(LayerChoice { name: layer.into(), doc: format!("{known}{}", channels.join(", ")) });
        }
    }
    let channel = |name: &str| LayerChoice { name: name.into(), doc: "a channel".into() };
    found.extend(image.channels().iter().map(|c| channel(&c.name)).filter(|_| image.channels().len() > 1));
    found
}

/// The values of a layer, pixel by pixel, one or three of them; named as `steradian convert --layer` takes them.
fn plane(image: &Image, layer: &str) -> Option<(u16, Vec<f32>)> {
    let grey = |data: &[f32]| Some((1, data.to_vec()));
    if layer == PICTURE {
        return match image.rgb() {
            Some(colour) if std::ptr::eq(colour.r, colour.g) => grey(colour.r),
            Some(_) => Some((3, image.to_rgb().ok()?.into_flattened())),
            None => grey(&image.channels().first()?.data),
        };
    }
    if let Some(data) = image.channel(layer) {
        return grey(data);
    }
    let known = Layer::named(layer).and_then(|known| image.layer(known.prefix()));
    let picture = known.or_else(|| image.layer(layer))?;
    match picture.channel("Y") {
        Some(data) => grey(data),
        None => Some((3, picture.to_rgb().ok()?.into_flattened())),
    }
}

/// A pixel of a picture.
#[derive(Deserialize)]
struct Place {
    id: usize,
    x: u32,
    y: u32,
}

/// Values of all channels of a pixel, as exact as the file has them.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct PicturePixel<'a> {
    x: u32,
    y: u32,
    #[serde(serialize_with = "in_order")]
    #[cfg_attr(test, ts(as = "std::collections::BTreeMap<String, Sample>"))]
    channels: Vec<(&'a str, Sample)>,
}

/// The values of a pixel: red before blue, and layers together.
async fn pixel(State(shelf): State<Shelf>, Query(Place { id, x, y }): Query<Place>) -> Result<Response, Refused> {
    let look = move || {
        let Loaded { name, image, .. } = load(&shelf.gallery, id)?;
        let [column, row] = [x as usize, y as usize];
        if column >= image.width() || row >= image.height() {
            return Err(Refused(StatusCode::NOT_FOUND, format!("there is no pixel {x}, {y} in '{name}'")));
        }
        let at = row * image.width() + column;
        let value = |c: &'_ steradian::image::Channel| c.data.get(at).map(|v| Sample::from(*v));
        let mut channels: Vec<_> = image.channels().iter().filter_map(|c| Some((c.name.as_str(), value(c)?))).collect();
        let rank = |name: &str| "RXUYGVBZA".find(name.rsplit('.').next().unwrap_or(name)).unwrap_or(usize::MAX);
        channels.sort_by_key(|(name, _)| (layer_of(name).unwrap_or_default().to_owned(), rank(name)));
        serde_json::to_vec(&PicturePixel { x, y, channels }).map_err(|e| unfit(e.to_string()))
    };
    let told = shelf.turn.work(look).await.map_err(broken_off)??;
    Ok(([(axum::http::header::CONTENT_TYPE, "application/json")], told).into_response())
}

/// Which map of differences.
#[derive(Deserialize)]
struct AskedDifference {
    a: usize,
    b: usize,
    layer: Option<String>,
    metric: Metric,
    tone: Option<String>,
    exposure: Option<f32>,
}

/// A layer as colours.
fn colours(loaded: &Loaded, layer: &str) -> Result<Image, Refused> {
    let Loaded { name, image, .. } = loaded;
    let (components, values) = plane(image, layer).ok_or_else(|| lacks(name, image, layer))?;
    let pixels: Vec<[f32; 3]> = match components {
        1 => values.into_iter().map(|v| [v; 3]).collect(),
        _ => values.as_chunks().0.to_vec(),
    };
    Image::from_rgb(image.width(), image.height(), &pixels).map_err(|e| unfit(e.to_string()))
}

/// The map of how far a picture is from another one of the list: its figures and its tiles.
async fn difference(State(shelf): State<Shelf>, Query(asked): Query<AskedDifference>) -> Result<Response, Refused> {
    let tone = tone_of(asked.tone.as_deref(), asked.exposure);
    let tone = tone.map_err(|e| Refused(StatusCode::BAD_REQUEST, e.to_string()))?;
    let draw = move || {
        let [a, b] = [load(&shelf.gallery, asked.a)?, load(&shelf.gallery, asked.b)?];
        let size = |of: &Loaded| format!("'{}' has {} x {} pixels", of.name, of.image.width(), of.image.height());
        let extent = |of: &Loaded| [of.image.width(), of.image.height()];
        if extent(&a) != extent(&b) {
            return Err(Refused(StatusCode::CONFLICT, format!("{}, {}: no difference", size(&a), size(&b))));
        }
        let layer = asked.layer.as_deref().unwrap_or(PICTURE);
        let [width, height] = extent(&a).map(|n| n as u32);
        let subject = Subject { generation: a.version, crop: [0, 0, width, height], samples: 0.0 };
        let [image, reference] = [colours(&a, layer)?, colours(&b, layer)?];
        drawn(&subject, asked.metric, &image, &reference, tone).map_err(|e| unfit(e.to_string()))
    };
    Ok(binary(shelf.turn.work(draw).await.map_err(broken_off)??))
}

/// Pictures that were dropped on the page.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Added {
    /// Numbers of those that are on the list now.
    added: Vec<usize>,
}

/// Puts the pictures among the files that come, form fields `file` with their names, on the list.
async fn open(State(shelf): State<Shelf>, form: Multipart) -> Result<Json<Added>, Refused> {
    let failed =
        |e: std::io::Error| Refused(StatusCode::INTERNAL_SERVER_ERROR, format!("the files cannot be kept: {e}"));
    let refused = |why: &Refused| shelf.log.refused(&format!("refused an upload: {}", why.1));
    let folder = TemporaryFolder::new("steradian-view-").map_err(failed)?;
    let names = upload::receive(form, &folder).await.inspect_err(refused)?;
    let added = shelf.gallery.take(folder, &names).map_err(unfit).inspect_err(refused)?;
    Ok(Json(Added { added }))
}

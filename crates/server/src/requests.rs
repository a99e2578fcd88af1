//! Questions about the view.

use crate::{
    app::{App, Refused},
    document::Document,
    frame::LAYERS,
    look::Look,
    protocol::FrameKind,
    viewer::Task,
};
use axum::{
    extract::{Query, State},
    http::{StatusCode, header},
    response::{IntoResponse, Json, Response},
};
use serde::{Deserialize, Serialize, Serializer};
use steradian::{develop, film::FirstHit};
use tokio::sync::oneshot;

/// State for pages, once the first one is told.
pub async fn state(State(app): State<App>) -> Result<Response, Refused> {
    let mut states = app.viewer.states.clone();
    let state = states.wait_for(|state| !state.is_empty()).await.map(|state| state.to_string());
    let state = state.map_err(|_| Refused(StatusCode::SERVICE_UNAVAILABLE, "the view has ended".into()))?;
    Ok(([(header::CONTENT_TYPE, "application/json")], state).into_response())
}

/// All nodes with what can be set of them.
pub async fn nodes(State(app): State<App>) -> Result<Response, Refused> {
    Ok(Json(ask(&app, |document, _| document.nodes()).await?).into_response())
}

/// Asks the thread that has the scene.
pub async fn ask<T: Send + 'static>(
    app: &App,
    question: impl FnOnce(&Document, &Look) -> T + Send + 'static,
) -> Result<T, Refused> {
    let (tell, told) = oneshot::channel();
    app.viewer.send(Task::Ask(Box::new(move |document, look| drop(tell.send(question(document, look))))));
    told.await.map_err(|_| Refused(StatusCode::SERVICE_UNAVAILABLE, "the view has ended".into()))
}

/// A place in the picture.
#[derive(Deserialize)]
pub struct Place {
    x: u32,
    y: u32,
}

/// Value of a channel.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(untagged)]
pub enum Sample {
    /// A finite value.
    Number(f32),
    /// `NaN`, `inf` or `-inf`, which JSON has no numbers for.
    Text(String),
}

impl From<f32> for Sample {
    fn from(value: f32) -> Self {
        if value.is_finite() { Self::Number(value) } else { Self::Text(value.to_string()) }
    }
}

/// Data of a pixel.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Pixel<'a> {
    x: u32,
    y: u32,
    generation: u32,
    kind: FrameKind,
    samples: u32,
    error: Option<f64>,
    object: Option<&'a str>,
    material: Option<&'a str>,
    light: Option<&'a str>,
    /// True if it is known which surface is there, if any.
    #[serde(rename = "hasSurface")]
    has_surface: bool,
    #[serde(serialize_with = "in_order")]
    #[cfg_attr(test, ts(as = "std::collections::BTreeMap<String, Sample>"))]
    channels: Vec<(&'a str, Sample)>,
}

/// An object with its members as they come: red before blue.
pub fn in_order<S: Serializer>(members: &[(&str, Sample)], to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(members.iter().map(|(name, value)| (name, value)))
}

/// The values of a pixel, as exact as they are.
pub async fn pixel(State(app): State<App>, Query(Place { x, y }): Query<Place>) -> Result<Response, Refused> {
    let none = || Refused(StatusCode::NOT_FOUND, format!("there is no pixel {x}, {y} in the picture"));
    let shown = app.viewer.shown().ok_or_else(none)?;
    let film = shown.pixel(x, y).ok_or_else(none)?;
    let hit = film.layers.features.first().map(|f| FirstHit { shape: f.sum.shape, material: f.sum.material, ..f.sum });
    let image = develop(&shown.scene, &film, &LAYERS);
    // Without its noise, where the picture is shown so; the values with noise are the layer `raw`.
    let clean = shown.denoised.as_ref().zip(shown.place(x, y)).map(|(clean, [.., k])| (clean, k as usize));
    let clean_of = |name: &str| clean.and_then(|(clean, k)| clean.channel(name)?.get(k).copied());
    let own = image.channels().iter().map(|c| (c.name.as_str(), clean_of(&c.name).unwrap_or(c.data[0])));
    let added = clean.iter().flat_map(|(clean, k)| clean.channels().iter().map(|c| (c.name.as_str(), c.data[*k])));
    let added = added.filter(|(name, _)| image.channel(name).is_none());
    let channels = own.chain(added).map(|(name, value)| (name, value.into())).collect();
    let subject = app.viewer.subject();
    let named = hit.map(|h| subject.names.of(h.shape)).unwrap_or_default();
    // Of shapes that are given none.
    let default = hit.and_then(|h| shown.scene.material_names().get(h.material.checked_sub(1)? as usize));
    let material = named.material.or(default.map(String::as_str));
    // As the estimate of a picture's error, of a single pixel.
    let (mean, variance) = (film.pixels[0].mean(), film.pixels[0].variance_of_mean());
    let error = (film.pixels[0].samples > 1)
        .then(|| (0..3).map(|c| variance[c] / (mean[c] * mean[c] + 0.01)).sum::<f64>() / 3.0)
        .map(f64::sqrt);
    let (generation, kind, samples) = (shown.generation, shown.kind, film.pixels[0].samples);
    let (object, light, has_surface) = (named.object, named.light, hit.is_some());
    let told = Pixel { x, y, generation, kind, samples, error, object, material, light, has_surface, channels };
    Ok(Json(told).into_response())
}

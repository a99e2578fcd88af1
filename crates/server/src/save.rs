//! Pictures and scenes as files: to be downloaded, or put into the scene's folder; those of uploads into the current
//! one, with what the scene is made of.

use crate::{
    app::{App, Refused},
    requests::ask,
};
use axum::{
    extract::{Json, Path, Query, State},
    http::{StatusCode, header},
    response::{IntoResponse, Response},
};
use serde::Deserialize;
use std::{
    path::PathBuf,
    sync::{Mutex, PoisonError},
};
use steradian::{
    Layer,
    formats::native,
    image::{FileKind, WriteOptions, encode, tone::Tone, write_together},
};

/// Conversion of values to colours of a display.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Display {
    tone: Option<String>,
    exposure: Option<f32>,
    /// Layers of an EXR file, separated by commas.
    layers: String,
}

/// Request to save a picture or the scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Save {
    name: String,
    tone: Option<String>,
    exposure: Option<f32>,
    #[serde(default)]
    layers: String,
}

/// Bytes of the longest name of a file.
pub const LONGEST_NAME: usize = 255;

/// True if a name shows as it is: without control characters, and without those that turn the direction of text and let
/// a name end in what is not its extension.
pub fn is_printable(name: &str) -> bool {
    let turns =
        |c: char| matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    // Separators of lines and paragraphs end lines as well.
    !name.chars().any(|c| c.is_control() || turns(c) || matches!(c, '\u{2028}' | '\u{2029}'))
}

impl Display {
    fn options(&self) -> Result<WriteOptions, Refused> {
        let bad = |e: steradian::image::Error| Refused(StatusCode::BAD_REQUEST, e.to_string());
        let tone = self.tone.as_deref().map(Tone::parse).transpose().map_err(bad)?.unwrap_or_default();
        let tone = tone.with_exposure(self.exposure.unwrap_or(0.0)).map_err(bad)?;
        Ok(WriteOptions { tone, ..WriteOptions::default() })
    }

    fn layers(&self) -> Result<Vec<Layer>, Refused> {
        let names = self.layers.split(',').filter(|n| !n.is_empty());
        let named = |name| match name == Layer::LIGHT_GROUPS.name() {
            true => Ok(Layer::LIGHT_GROUPS),
            false => crate::frame::layer(name).map_err(|why| Refused(StatusCode::BAD_REQUEST, why)),
        };
        names.map(named).collect()
    }
}

/// The picture as a file: `picture.EXTENSION`.
pub async fn picture(
    State(app): State<App>,
    Path(name): Path<String>,
    Query(display): Query<Display>,
) -> Result<Response, Refused> {
    let none = || Refused(StatusCode::NOT_FOUND, "there is no such request".into());
    let extension = name.strip_prefix("picture.").ok_or_else(none)?;
    if !extension.bytes().all(|b| b.is_ascii_alphanumeric()) {
        return Err(Refused(StatusCode::BAD_REQUEST, "a picture's extension has letters and digits alone".into()));
    }
    let kind = PathBuf::from(&name);
    let bytes = encoded(&app, &kind, display).await?;
    let disposition = format!("attachment; filename=\"{name}\"");
    let kind =
        [(header::CONTENT_TYPE, "application/octet-stream".to_owned()), (header::CONTENT_DISPOSITION, disposition)];
    Ok((kind, bytes).into_response())
}

/// The picture as the bytes of a file of this name.
async fn encoded(app: &App, name: &std::path::Path, display: Display) -> Result<Vec<u8>, Refused> {
    let kind = FileKind::from_extension(name)
        .ok_or_else(|| Refused(StatusCode::BAD_REQUEST, "pictures are .exr, .png, .jpg, .hdr, .pfm or .ppm".into()))?;
    let (options, layers) = (display.options()?, display.layers()?);
    let shown = app.viewer.shown();
    let shown = shown.ok_or_else(|| Refused(StatusCode::CONFLICT, "there is no picture yet".into()))?;
    let encode = move || encode(kind, &shown.picture(&layers), &options);
    let encoded = tokio::task::spawn_blocking(encode).await;
    let failed = |e: String| Refused(StatusCode::INTERNAL_SERVER_ERROR, e);
    encoded.map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))
}

/// The scene as it is, as a document with what belongs beside it.
type Written = (String, Vec<(PathBuf, Vec<u8>)>, PathBuf);

async fn document(app: &App, name: Option<String>) -> Result<Written, Refused> {
    let written = ask(app, move |document, look| {
        let mut desc = document.seen_from(look.camera.as_deref(), look.view.as_ref());
        let (folder, name) = match name {
            Some(name) => {
                document.take_uploads_along(&mut desc)?;
                (document.saving_folder(), name)
            }
            // Text alone, for the folder that its files are in.
            None => (document.folder(), crate::state::saved_name(document)),
        };
        native::write(&desc, &folder.join(name)).map(|w| (w.text, w.files, folder))
    });
    written.await?.map_err(|why| Refused(StatusCode::UNPROCESSABLE_ENTITY, why))
}

/// The scene as text.
pub async fn scene(State(app): State<App>) -> Result<Response, Refused> {
    let (text, _, _) = document(&app, None).await?;
    let kind = [
        (header::CONTENT_TYPE, "text/plain; charset=utf-8"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"scene.steradian\""),
    ];
    Ok((kind, text).into_response())
}

/// Puts the picture or the scene into the scene's folder, of uploads into the current one, under a name that is free.
pub async fn save(State(app): State<App>, Json(save): Json<Save>) -> Result<Response, Refused> {
    let Save { name, tone, exposure, layers } = save;
    let display = Display { tone, exposure, layers };
    let bad = |why: &str| Refused(StatusCode::BAD_REQUEST, why.into());
    let is_plain = !name.is_empty()
        && name.len() <= 200
        && !name.starts_with('.')
        && !name.contains(['/', '\\', ':'])
        && is_printable(&name);
    if !is_plain {
        app.log.refused("refused to save: a name that is more than a file name");
        return Err(bad(
            "a name is that of a file in the scene's folder: no folders, not hidden, no control characters",
        ));
    }
    let is_scene = name.ends_with(".steradian");
    let (bytes, files, folder) = match is_scene {
        true => {
            let (text, files, folder) = document(&app, Some(name.clone())).await?;
            (text.into_bytes(), files, folder)
        }
        false => {
            let bytes = encoded(&app, name.as_ref(), display).await?;
            (bytes, Vec::new(), ask(&app, |document, _| document.saving_folder()).await?)
        }
    };
    let path = folder.join(&name);
    let failed = |e: String| Refused(StatusCode::INTERNAL_SERVER_ERROR, e);
    let saved = path.clone();
    let write = move || {
        // One at a time, so that none takes the name of another.
        static SAVING: Mutex<()> = Mutex::new(());
        let _alone = SAVING.lock().unwrap_or_else(PoisonError::into_inner);
        if path.symlink_metadata().is_ok() {
            return Err(Refused(StatusCode::CONFLICT, format!("'{name}' is there already, and is kept as it is")));
        }
        write_together(&path, &bytes, &files).map_err(|e| failed(e.to_string()))
    };
    tokio::task::spawn_blocking(write).await.map_err(|e| failed(e.to_string()))??;
    app.log.done(&format!("saved {}", saved.display()));
    Ok(Json(serde_json::json!({ "saved": saved })).into_response())
}

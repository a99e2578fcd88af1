//! The reference: a picture that is kept, or comes as a file, to hold the one that is shown against it.

use crate::{
    app::{App, Refused},
    kept::Reference,
    look::MOST_PIXELS,
    protocol::{FrameKind, ServerMessage},
    tile::{self, Plane},
};
use axum::{
    extract::{Multipart, Query, State, multipart::MultipartRejection},
    http::{StatusCode, header},
    response::{IntoResponse, Json, Response},
};
use serde::{Deserialize, Serialize};
use std::{io::Write, path::Path};
use steradian::image::{Error, Limits, read};

/// Bytes of a file.
pub const MOST_BYTES: usize = 512 << 20;
/// The layer of the reference's tiles and of maps.
pub const LAYER: u16 = u16::MAX;
/// Letters of a name.
const LONGEST_NAME: usize = 120;

/// Source of a reference.
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
    let reference = reference.inspect_err(|why| app.log.refused(&format!("refused a reference: {}", why.1)))?;
    let about = Json(reference.about.clone());
    set(&app, Some(reference));
    Ok(about.into_response())
}

/// Takes another one, or none, and tells all pages.
fn set(app: &App, reference: Option<Reference>) {
    app.reference.set(reference);
    // Nobody may be there.
    let _ = app.viewer.messages.send(ServerMessage::Reference.text());
}

async fn current(app: &App) -> Result<Reference, Refused> {
    let not_yet = |why: &str| Refused(StatusCode::CONFLICT, why.into());
    let shown = app.viewer.shown().ok_or_else(|| not_yet("there is no picture yet"))?;
    if shown.kind == FrameKind::Preview {
        return Err(not_yet("only a preview is shown; the picture can be kept once its render has begun"));
    }
    let keep = move || {
        let name = format!("kept at {} spp", (10.0 * shown.samples).round() / 10.0);
        Reference::new(name, Some(shown.crop), shown.picture(&[]))
    };
    app.reference.work(keep).await.map_err(broken_off)?.map_err(unfit)
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
    app.reference.work(decode).await.map_err(broken_off)?.map_err(unfit)
}

/// Refuses a picture.
pub fn unfit(why: String) -> Refused {
    Refused(StatusCode::UNPROCESSABLE_ENTITY, why)
}

/// Forgets the reference.
pub async fn forget(State(app): State<App>) -> StatusCode {
    set(&app, None);
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
    Ok(binary(app.reference.work(encode).await.map_err(broken_off)?.map_err(unfit)?))
}

/// Tells that work was broken off.
pub fn broken_off(why: std::io::Error) -> Refused {
    Refused(StatusCode::INTERNAL_SERVER_ERROR, why.to_string())
}

/// JSON and tiles, each after its length in bytes (`u32`, little-endian).
pub fn pieces(head: &impl Serialize, tiles: &[Vec<u8>]) -> Vec<u8> {
    let head = serde_json::to_vec(head).unwrap_or_default();
    let pieces = std::iter::once(&head).chain(tiles);
    pieces.flat_map(|piece| [&(piece.len() as u32).to_le_bytes(), piece.as_slice()].concat()).collect()
}

/// Bytes as an answer.
pub fn binary(bytes: Vec<u8>) -> Response {
    ([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response()
}

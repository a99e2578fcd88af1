//! The page: files that are part of the program, built from `web/`.

use axum::{
    http::{StatusCode, header},
    response::{IntoResponse, Response},
};

#[derive(rust_embed::Embed)]
#[folder = "page/"]
struct Files;

/// A file of the page, by its path.
pub fn file(path: &str) -> Response {
    let name = if path.is_empty() { "index.html" } else { path };
    let Some(file) = Files::get(name) else {
        return (StatusCode::NOT_FOUND, format!("there is no '{name}' here")).into_response();
    };
    let kind = match name.rsplit_once('.').map(|n| n.1) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("json") => "application/json",
        Some("woff2") => "font/woff2",
        _ => "application/octet-stream",
    };
    ([(header::CONTENT_TYPE, kind)], file.data.into_owned()).into_response()
}

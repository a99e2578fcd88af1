//! Routes: handlers of paths, and the checks before them.

use crate::{
    access::Access,
    app::{App, Refused},
    difference,
    log::Log,
    outline, page, path, reference, requests, save, socket, upload,
};
use axum::{
    Router,
    extract::{DefaultBodyLimit, Path, Request, State},
    http::{HeaderValue, StatusCode, Uri, header},
    middleware::{self, Next},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use std::sync::Arc;

/// Bytes of a request, but for uploads.
const MOST_BYTES: usize = 64 << 10;

/// Content security policy: the page loads from and connects to its own server alone, and any site that knows its
/// address may show it, as notebooks do.
const POLICY: &str = "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; object-src 'none'";

/// All that there is to a scene.
pub fn router(app: App) -> Router {
    let api = Router::new()
        .route("/state", get(requests::state))
        .route("/nodes", get(requests::nodes))
        .route("/pixel", get(requests::pixel))
        .route("/outline", get(outline::outline))
        .route("/path", get(path::path))
        .route("/scene.steradian", get(save::scene))
        .route("/{picture}", get(save::picture))
        .route("/save", post(save::save))
        .route("/socket", get(socket::open))
        .layer(DefaultBodyLimit::max(MOST_BYTES))
        .route(
            "/reference",
            get(reference::get)
                .post(reference::keep)
                .delete(reference::forget)
                .layer(DefaultBodyLimit::max(reference::MOST_BYTES)),
        )
        .route("/difference", get(difference::difference))
        .route("/open", post(upload::open).layer(DefaultBodyLimit::max(upload::MOST_BYTES)))
        .fallback(|| async { Refused(StatusCode::NOT_FOUND, "there is no such request".into()) });
    let inside = Router::new()
        .nest("/api", api)
        .route("/", get(|| async { page::file("") }))
        .route("/{*file}", get(|Path(file): Path<String>| async move { page::file(&file) }))
        .with_state(app.clone());
    guarded(inside, app.access, app.log)
}

/// Lets those through to a page and its requests who may ask.
pub fn guarded(inside: Router, access: Arc<Access>, log: Arc<Log>) -> Router {
    // What is routed there has lost its token here.
    Router::new().fallback_service(inside).layer(middleware::from_fn_with_state((access, log), admit))
}

/// Passes on what may be answered, without the token in its path, and tells browsers what the page may do.
async fn admit(State((access, log)): State<(Arc<Access>, Arc<Log>)>, mut request: Request, next: Next) -> Response {
    let mut response = match inner_address(&access, &request) {
        Ok(Some(address)) => {
            *request.uri_mut() = address;
            next.run(request).await
        }
        Ok(None) => {
            // Relative addresses need the folder.
            let folder = format!("/{}/", access.token());
            (StatusCode::PERMANENT_REDIRECT, [(header::LOCATION, folder)]).into_response()
        }
        Err(why) => {
            log.refused(&format!("refused {} {}: {}", request.method(), shortened(request.uri().path()), why.1));
            why.into_response()
        }
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Address without the token, where the request may be answered; `None` where it is the token alone.
fn inner_address(access: &Access, request: &Request) -> Result<Option<Uri>, Refused> {
    let header = |name| request.headers().get(name).and_then(|v: &HeaderValue| v.to_str().ok());
    // Of two names only one can have been looked at.
    let is_one = request.headers().get_all(header::HOST).iter().count() == 1;
    let host = header(header::HOST).filter(|_| is_one);
    // An origin that is no text, and one of several, is no page's of this server.
    let mut origins = request.headers().get_all(header::ORIGIN).iter();
    let origin = match (origins.next(), origins.next()) {
        (None, _) => None,
        (Some(origin), None) => Some(origin.to_str().unwrap_or_default()),
        (Some(_), Some(_)) => Some(""),
    };
    let rest = access.admit(request.uri().path(), host, origin);
    let rest = rest.map_err(|why| Refused(StatusCode::FORBIDDEN, why.to_string()))?;
    if rest.is_empty() {
        return Ok(None);
    }
    let query = request.uri().query().map(|q| format!("?{q}")).unwrap_or_default();
    let address = format!("{rest}{query}").parse();
    address.map(Some).map_err(|_| Refused(StatusCode::BAD_REQUEST, "the address cannot be read".into()))
}

/// The beginning of a path, for the log, without what a terminal would take for commands.
fn shortened(path: &str) -> String {
    path.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect()
}

//! Shared state of all requests, and their refusal.

use crate::{access::Access, kept::Keeper, log::Log, uploaded::Upload, viewer};
use axum::{
    http::StatusCode,
    response::{IntoResponse, Json, Response},
};
use std::sync::{Arc, Mutex, atomic::AtomicUsize};

/// Shared state of all requests.
#[derive(Clone)]
pub struct App {
    /// Who may ask.
    pub access: Arc<Access>,
    /// The thread that renders.
    pub viewer: viewer::Handle,
    /// Told of what is refused, and saved.
    pub log: Arc<Log>,
    /// Sockets that are open.
    pub sockets: Arc<AtomicUsize>,
    /// The last upload, which the scene may be made of.
    pub upload: Arc<Mutex<Option<Upload>>>,
    /// Reference of the picture.
    pub reference: Arc<Keeper>,
}

impl App {
    /// For a viewer.
    pub fn new(access: Access, viewer: viewer::Handle, log: Arc<dyn Fn(&str) + Send + Sync>) -> Self {
        let (access, log) = (Arc::new(access), Arc::new(Log::new(log)));
        Self { access, viewer, log, sockets: Arc::default(), upload: Arc::default(), reference: Arc::default() }
    }
}

/// Why a request is not carried out.
pub struct Refused(pub StatusCode, pub String);

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        (self.0, Json(serde_json::json!({ "error": self.1 }))).into_response()
    }
}

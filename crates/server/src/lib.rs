//! Steradian's live view: a scene that is rendered while a web page looks at it.
//!
//! A thread renders (`viewer`), and shows what there is as `frame`s, encoded once for all pages. A server on this
//! machine hands them to pages over sockets (`socket`), takes requests, and answers who may ask (`access`). The
//! page is part of the program (`page`).
//!
//! ```no_run
//! let view = steradian_server::View::start(&steradian_server::Options::of("scene.pbrt"))?;
//! println!("{}", view.url());
//! view.wait();
//! # Ok::<(), steradian_server::Error>(())
//! ```

mod access;
mod app;
mod changes;
mod connections;
#[cfg(test)]
mod declarations;
mod denoiser;
mod difference;
mod document;
mod edits;
mod frame;
mod gallery;
mod groups;
mod job;
mod kept;
mod log;
mod look;
mod names;
mod outline;
mod page;
mod path;
mod pictures;
mod preview;
mod protocol;
mod reference;
mod requests;
mod routes;
mod save;
mod socket;
mod state;
mod surroundings;
mod tile;
mod turn;
mod upload;
mod uploaded;
mod viewer;

pub use document::Source;
pub use look::StartExposure;
pub use protocol::{Denoiser, SettingsChange};

use access::Access;
use axum::Router;
use std::{
    net::{SocketAddr, TcpListener, ToSocketAddrs},
    path::PathBuf,
    sync::Arc,
    thread::{self, JoinHandle},
};
use steradian::Viewpoint;
use tokio::sync::Notify;

/// Message to pages where no path of Open Image Denoise was given.
const NO_OIDN: &str = "Open Image Denoise is not known here; `steradian view --oidn PATH` names it";

/// Options of a view: the scene, and the server's address.
pub struct Options {
    /// The scene.
    pub source: Source,
    /// First settings of the render.
    pub settings: SettingsChange,
    /// Camera, by name or by number from 0; `None` for the first.
    pub camera: Option<String>,
    /// Viewpoint of the camera, in place of its own.
    pub look_at: Option<Viewpoint>,
    /// Tone curve to begin with, `NAME[:key=value,…]`; `None` for the one that suits the scene.
    pub tone: Option<String>,
    /// Exposure to begin with; `None` for that of the command line: by the picture for models and glTF scenes that
    /// would be white or black.
    pub exposure: Option<StartExposure>,
    /// Address or name of this machine that the server listens at; `127.0.0.1` reaches no other machine.
    pub bind: String,
    /// Port; 0 for a free one.
    pub port: u16,
    /// The file of Open Image Denoise's library, absolute, whose code runs as a part of the program where pages choose
    /// it; or why there is none, and what brings it.
    pub oidn: Result<PathBuf, String>,
    /// Told of requests that are refused, and why.
    pub log: Arc<dyn Fn(&str) + Send + Sync>,
}

impl Options {
    /// A file or `builtin:NAME`, on this machine alone.
    pub fn of(name: impl Into<PathBuf>) -> Self {
        Self {
            source: Source { name: name.into(), ..Source::default() },
            settings: SettingsChange::default(),
            camera: None,
            look_at: None,
            tone: None,
            exposure: None,
            bind: "127.0.0.1".into(),
            port: 0,
            oidn: Err(NO_OIDN.into()),
            log: Arc::new(|_| {}),
        }
    }
}

/// Options of a view of finished pictures.
pub struct Pictures {
    /// Files of pictures, and folders of them.
    pub files: Vec<PathBuf>,
    /// Tone curve to begin with, `NAME[:key=value,…]`; `None` for plain sRGB.
    pub tone: Option<String>,
    /// Exposure to begin with.
    pub exposure: Option<StartExposure>,
    /// Address or name of this machine that the server listens at; `127.0.0.1` reaches no other machine.
    pub bind: String,
    /// Port; 0 for a free one.
    pub port: u16,
    /// Told of requests that are refused, and why.
    pub log: Arc<dyn Fn(&str) + Send + Sync>,
}

/// Why there is no view.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// All that is wrong with the scene.
    #[error("{}", protocol::told(.0))]
    Scene(steradian::scene::Diagnostics),
    /// No picture is there.
    #[error("{0}")]
    Pictures(String),
    /// The address cannot be had.
    #[error("cannot listen at {at}: {cause}")]
    Address {
        /// Address and port.
        at: String,
        /// Error of the system.
        cause: std::io::Error,
    },
}

/// A view that runs; it ends when this goes away.
pub struct View {
    url: String,
    stop: Arc<Notify>,
    server: Option<JoinHandle<()>>,
}

impl View {
    /// Opens the scene and starts the server.
    ///
    /// # Errors
    /// [`Error`].
    pub fn start(options: &Options) -> Result<Self, Error> {
        let look = look::Look {
            settings: options.settings.clone(),
            camera: options.camera.clone(),
            view: options.look_at.map(|point| look::View { point, fov: None }),
            tone: options.tone.clone(),
            exposure: options.exposure,
            ..Default::default()
        };
        Self::serve(&options.bind, options.port, |access| {
            let viewer = viewer::start(options.source.clone(), look, options.oidn.clone()).map_err(Error::Scene)?;
            Ok(routes::router(app::App::new(access, viewer, Arc::clone(&options.log))))
        })
    }

    /// Starts the server for finished pictures, which are read when they are looked at.
    ///
    /// # Errors
    /// [`Error::Address`], and [`Error::Pictures`] where none of the files is there.
    pub fn pictures(options: &Pictures) -> Result<Self, Error> {
        let gallery = gallery::Gallery::new(options.files.clone()).map_err(Error::Pictures)?;
        let look = pictures::FirstLook::new(options.tone.as_deref(), options.exposure);
        Self::serve(&options.bind, options.port, |access| {
            Ok(pictures::router(gallery, look, Arc::new(access), Arc::new(log::Log::new(Arc::clone(&options.log)))))
        })
    }

    fn serve(bind: &str, port: u16, router: impl FnOnce(Access) -> Result<Router, Error>) -> Result<Self, Error> {
        let at = format!("{bind}:{port}");
        let refused = |cause| Error::Address { at: at.clone(), cause };
        let bare = bind.trim_matches(['[', ']']);
        let address = (bare, port).to_socket_addrs().map_err(refused)?.next();
        let address = address.ok_or_else(|| refused(std::io::ErrorKind::AddrNotAvailable.into()))?;
        let listener = TcpListener::bind(address).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let name = bare.parse::<std::net::IpAddr>().is_err().then(|| bind.to_owned());
        let access = Access::new(address, name).map_err(refused)?;
        let url = format!("http://{}/{}/", shown(address), access.token());
        let stop = Arc::new(Notify::new());
        let (router, stopped) = (router(access)?, Arc::clone(&stop));
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(refused)?;
        let serve = move || {
            runtime.block_on(async {
                let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
                tokio::select! {
                    () = connections::serve(listener, router, Default::default()) => {}
                    () = stopped.notified() => {}
                }
            });
            // What a page waits for is not waited for.
            runtime.shutdown_background();
        };
        let server = thread::Builder::new().name("server".into()).spawn(serve).map_err(refused)?;
        Ok(Self { url, stop, server: Some(server) })
    }

    /// The address of the page, token included.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Waits until the server ends.
    pub fn wait(mut self) {
        if let Some(server) = self.server.take() {
            let _ = server.join();
        }
    }
}

impl Drop for View {
    fn drop(&mut self) {
        self.stop.notify_one();
        if let Some(server) = self.server.take() {
            let _ = server.join();
        }
    }
}

/// An address as browsers of this machine take it.
fn shown(address: SocketAddr) -> SocketAddr {
    match address {
        SocketAddr::V4(a) if a.ip().is_unspecified() => ([127, 0, 0, 1], a.port()).into(),
        SocketAddr::V6(a) if a.ip().is_unspecified() => (std::net::Ipv6Addr::LOCALHOST, a.port()).into(),
        other => other,
    }
}

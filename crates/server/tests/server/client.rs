//! A browser's part: requests as they go over the wire, and sockets.

use serde_json::{Value, json};
use std::{
    io::{Read, Write},
    net::TcpStream,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};
use steradian_server::{Options, SettingsChange, View};
use tungstenite::{Message, WebSocket, client::IntoClientRequest};

/// Longest wait for anything before a test fails, on machines that are busy, too.
const PATIENCE: Duration = Duration::from_secs(120);

/// A view, and what it logged.
pub struct Server {
    pub view: View,
    pub log: Arc<Mutex<Vec<String>>>,
}

/// An answer: status, headers and body.
pub struct Answer {
    pub status: u16,
    pub headers: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.text()))
    }
}

impl Server {
    /// A view of a scene, with small pictures of few samples.
    pub fn of(scene: impl AsRef<Path>) -> Self {
        let Options { oidn, .. } = Options::of("");
        Self::with(scene, oidn)
    }

    /// With the library of Open Image Denoise, or without.
    pub fn with(scene: impl AsRef<Path>, oidn: Result<PathBuf, String>) -> Self {
        let log: Arc<Mutex<Vec<String>>> = Arc::default();
        let told = Arc::clone(&log);
        let settings = SettingsChange {
            spp: Some(Some(4)),
            width: Some(24),
            height: Some(16),
            denoise: Some(None),
            ..SettingsChange::default()
        };
        let log_line = move |line: &str| told.lock().unwrap().push(line.to_owned());
        let options = Options { settings, oidn, log: Arc::new(log_line), ..Options::of(scene.as_ref()) };
        Self { view: View::start(&options).unwrap(), log }
    }

    /// `127.0.0.1:PORT`.
    pub fn host(&self) -> &str {
        self.view.url().split('/').nth(2).unwrap()
    }

    /// The path of the page.
    pub fn base(&self) -> String {
        format!("/{}/", self.view.url().split('/').nth(3).unwrap())
    }

    /// Sends bytes and reads all that comes back.
    pub fn raw(&self, bytes: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(self.host()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        // The server may have answered, and gone, before all is sent.
        let _ = stream.write_all(bytes);
        let mut all = Vec::new();
        let _ = stream.read_to_end(&mut all);
        let end = all.windows(4).position(|w| w == b"\r\n\r\n").unwrap_or(all.len());
        let headers = String::from_utf8_lossy(&all[..end]).to_ascii_lowercase();
        let status = headers.split(' ').nth(1).and_then(|s| s.parse().ok()).unwrap_or(0);
        Answer { status, headers, body: all.get(end + 4..).unwrap_or_default().to_vec() }
    }

    /// A request with headers of its own.
    pub fn ask(&self, method: &str, path: &str, headers: &str, body: &[u8]) -> Answer {
        let length = body.len();
        let head =
            format!("{method} {path} HTTP/1.1\r\n{headers}Connection: close\r\nContent-Length: {length}\r\n\r\n");
        self.raw(&[head.as_bytes(), body].concat())
    }

    /// As the page asks.
    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", &(self.base() + path), &format!("Host: {}\r\n", self.host()), b"")
    }

    /// As the page sends JSON.
    pub fn post(&self, path: &str, body: &Value) -> Answer {
        let headers = format!("Host: {}\r\nContent-Type: application/json\r\n", self.host());
        self.ask("POST", &(self.base() + path), &headers, body.to_string().as_bytes())
    }

    /// As the page sends files.
    pub fn upload(&self, files: &[(&str, &[u8])]) -> Answer {
        self.send_files("api/open", files)
    }

    /// A request of the page.
    pub fn send_files(&self, path: &str, files: &[(&str, &[u8])]) -> Answer {
        let mut body = Vec::new();
        for (name, bytes) in files {
            let head = format!("--edge\r\nContent-Disposition: form-data; name=\"file\"; filename=\"{name}\"\r\n\r\n");
            body.extend([head.as_bytes(), bytes, b"\r\n"].concat());
        }
        body.extend(b"--edge--\r\n");
        let headers = format!("Host: {}\r\nContent-Type: multipart/form-data; boundary=edge\r\n", self.host());
        self.ask("POST", &(self.base() + path), &headers, &body)
    }

    /// True if something was logged.
    pub fn logged(&self, what: &str) -> bool {
        self.log.lock().unwrap().iter().any(|line| line.contains(what))
    }

    /// A page's connection.
    pub fn page(&self) -> Page {
        self.try_page().unwrap()
    }

    /// A connection, where there is room for it.
    pub fn try_page(&self) -> Option<Page> {
        let url = format!("ws://{}{}api/socket", self.host(), self.base());
        let mut request = url.into_client_request().unwrap();
        request.headers_mut().insert("Origin", format!("http://{}", self.host()).parse().unwrap());
        let stream = TcpStream::connect(self.host()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = tungstenite::client(request, stream).ok()?;
        Some(Page { socket, tiles: Vec::new(), state: Value::Null })
    }
}

/// A page that is connected.
pub struct Page {
    pub socket: WebSocket<TcpStream>,
    /// Tiles since the last frame.
    pub tiles: Vec<Vec<u8>>,
    /// The last state.
    pub state: Value,
}

impl Page {
    pub fn send(&mut self, request: Value) {
        self.socket.send(Message::text(request.to_string())).unwrap();
    }

    /// The next text; tiles are kept aside.
    pub fn next(&mut self) -> Value {
        loop {
            match self.socket.read().unwrap() {
                Message::Binary(tile) => self.tiles.push(tile.to_vec()),
                Message::Text(text) => {
                    let value: Value = serde_json::from_str(&text).unwrap();
                    if value["type"] == "state" {
                        self.state = value.clone();
                    }
                    return value;
                }
                _ => {}
            }
        }
    }

    /// The next text of which something holds, with the tiles that came just before it.
    pub fn until(&mut self, what: &str, holds: impl Fn(&Value) -> bool) -> (Value, Vec<Vec<u8>>) {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            let text = self.next();
            let tiles = std::mem::take(&mut self.tiles);
            if holds(&text) {
                return (text, tiles);
            }
        }
        panic!("{what} does not come");
    }

    /// The last frame of the state that comes after a request.
    pub fn finished(&mut self, request: Value) -> Value {
        if self.state.is_null() {
            self.until("the state", |v| v["type"] == "state");
        }
        let before = self.state["generation"].as_u64();
        self.send(request);
        self.until("a new state", |v| v["type"] == "state" && v["generation"].as_u64() > before);
        let generation = self.state["generation"].clone();
        self.until("the end", |v| v["generation"] == generation && v["kind"] == "render" && v["done"] == true).0
    }

    /// Message of the server to a request that is wrong.
    pub fn refusal(&mut self, request: Value) -> String {
        self.send(request);
        self.until("a refusal", |v| v["type"] == "message").0["text"].as_str().unwrap().to_owned()
    }
}

/// Place for a camera in the Cornell box.
pub fn camera(x: f64) -> Value {
    json!({"type": "camera", "eye": [x, 0.0, -3.0], "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0]})
}

/// The picture that the server gives as a file.
pub fn served(server: &Server) -> steradian::image::Image {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    std::fs::write(&path, server.get("api/picture.exr").body).unwrap();
    steradian::image::read(&path, &Default::default()).unwrap()
}

/// JSON and values of an answer, whose tiles are rows from the top.
pub fn taken(answer: &Answer) -> (Value, Vec<f32>) {
    assert_eq!(answer.status, 200, "{}", answer.text());
    let (mut pieces, mut rest) = (Vec::new(), &answer.body[..]);
    while let Some((length, after)) = rest.split_first_chunk() {
        let (piece, after) = after.split_at(u32::from_le_bytes(*length) as usize);
        pieces.push(piece);
        rest = after;
    }
    assert!(rest.is_empty());
    let tiles = &pieces[1..];
    assert!(tiles.iter().all(|t| t[..4] == *b"STRT" && t[8..10] == [255, 255]));
    let values = tiles.iter().flat_map(|t| t[24..].chunks(2)).map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32());
    (serde_json::from_slice(pieces[0]).unwrap(), values.collect())
}

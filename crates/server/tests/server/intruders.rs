//! Refusals: those who do not know the token, names and pages of others, paths elsewhere, bad frames, too much.

use crate::client::{Server, camera};
use serde_json::json;
use std::{io::Write, net::TcpStream};
use tungstenite::{Message, client::IntoClientRequest};

const BOX: &str = "builtin:cornell-box";

/// Nothing is told to those who do not know the token, under any path; nor under names or from pages of others.
#[test]
fn strangers_are_refused() {
    let server = Server::of(BOX);
    let (host, base) = (server.host().to_owned(), server.base());
    let own = format!("Host: {host}\r\n");
    assert_eq!(server.ask("GET", &base, &own, b"").status, 200);
    let wrong = format!("/{}/", "0".repeat(48));
    for path in ["/", "/api/state", "/index.html", &wrong, &format!("{wrong}api/state"), &base[..base.len() - 2]] {
        let answer = server.ask("GET", path, &own, b"");
        assert_eq!(answer.status, 403, "{path}");
        assert!(answer.text().contains("token"), "{}", answer.text());
    }
    let port = host.rsplit(':').next().unwrap();
    let rebound = format!("Host: evil.example:{port}\r\n");
    let twice = format!("Host: {host}\r\nHost: evil.example\r\n");
    for headers in [&*rebound, "Host: 127.0.0.1:1\r\n", "", &*twice] {
        let answer = server.ask("GET", &format!("{base}api/state"), headers, b"");
        assert!([400, 403].contains(&answer.status), "{headers}: {}", answer.status);
        assert!(!answer.text().contains("generation"));
    }
    // One origin alone, in text.
    let of_page = format!("{own}Origin: http://{host}\r\n");
    assert_eq!(server.ask("GET", &format!("{base}api/state"), &of_page, b"").status, 200);
    for further in ["Origin: http://evil.example\r\n", "Origin: \u{e9}\r\n", &of_page[own.len()..]] {
        assert_eq!(server.ask("GET", &format!("{base}api/state"), &(of_page.clone() + further), b"").status, 403);
    }
    let no_text = format!("{own}Origin: http://{host}\u{e9}\r\n");
    assert_eq!(server.ask("GET", &format!("{base}api/state"), &no_text, b"").status, 403);
    let elsewhere = format!("{own}Origin: http://evil.example\r\n");
    for (method, path) in [("GET", "api/state"), ("POST", "api/save"), ("GET", "api/picture.png"), ("POST", "api/open")]
    {
        let answer = server.ask(method, &format!("{base}{path}"), &elsewhere, b"{}");
        assert_eq!(answer.status, 403, "{path}");
        assert!(answer.text().contains("another site"));
    }
    assert!(server.logged("token") && server.logged("another site") && server.logged("Host header"));
    // A socket of another page.
    let mut request = format!("ws://{host}{base}api/socket").into_client_request().unwrap();
    request.headers_mut().insert("Origin", "http://evil.example".parse().unwrap());
    assert!(tungstenite::client(request, TcpStream::connect(&host).unwrap()).is_err());
}

/// Browsers are told to load nothing from elsewhere, to guess no types, to keep and pass on nothing.
#[test]
fn pages_are_held_to_themselves() {
    let server = Server::of(BOX);
    let answer = server.get("");
    for header in [
        "content-security-policy: default-src 'self'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cache-control: no-store",
        "content-type: text/html",
    ] {
        assert!(answer.headers.contains(header), "{header} is not in {}", answer.headers);
    }
    assert!(!answer.headers.contains("set-cookie") && !answer.headers.contains("access-control"));
    let bare = server.ask("GET", server.base().trim_end_matches('/'), &format!("Host: {}\r\n", server.host()), b"");
    assert_eq!(bare.status, 308);
    assert!(bare.headers.contains(&format!("location: {}", server.base())));
}

/// Paths lead to no file that is not part of the page, and names of files to no other folder.
#[test]
fn paths_lead_nowhere_else() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy("../../scenes/shapes.steradian", folder.path().join("scene.steradian")).unwrap();
    let server = Server::of(folder.path().join("scene.steradian"));
    server.page().until("a picture", |v| v["type"] == "frame");
    for path in [
        "../../etc/passwd",
        "..%2f..%2fetc%2fpasswd",
        "%2e%2e/Cargo.toml",
        "assets/../../Cargo.toml",
        "//etc/passwd",
        "api/../../x",
    ] {
        let answer = server.get(path);
        assert!([400, 403, 404].contains(&answer.status), "{path}: {}", answer.status);
        assert!(!answer.text().contains("[package]") && !answer.text().contains("root:"));
    }
    let save = |name: &str| server.post("api/save", &json!({ "name": name }));
    for name in ["../x.exr", "/tmp/x.exr", "a/b.exr", "..", ".hidden.exr", "", "a\\b.exr", "a\0b.exr", "x.txt", "x"] {
        assert_eq!(save(name).status, 400, "{name:?}");
    }
    // What is there stays, links among it.
    let before = std::fs::read(folder.path().join("scene.steradian")).unwrap();
    assert_eq!(save("scene.steradian").status, 409);
    assert_eq!(std::fs::read(folder.path().join("scene.steradian")).unwrap(), before);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/nowhere/x.png", folder.path().join("link.png")).unwrap();
        assert_eq!(save("link.png").status, 409);
    }
    // Names that show other than they are, fields that nothing reads.
    for name in ["a\u{202e}gnp.exr", "a\u{2066}b.png", "a\nb.png", "a\u{2028}b.png", "a\u{200f}.png"] {
        assert_eq!(save(name).status, 400, "{name:?}");
    }
    for field in ["names", "layer", "path"] {
        let answer = server.post("api/save", &json!({"name": "new.png", field: "x"}));
        assert!([400, 422].contains(&answer.status) && answer.text().contains(field), "{}", answer.text());
    }
    for picture in ["picture.exr%00.png", "picture.exr%0a.png", "picture.e%22xr", "picture.tar.png"] {
        assert_eq!(server.get(&format!("api/{picture}")).status, 400, "{picture}");
    }
    assert_eq!(save("new.png").status, 200);
    assert_eq!(save("new.png").status, 409);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), if cfg!(unix) { 3 } else { 2 });
}

/// Bytes that are no requests, frames that are too large or no texts, and bodies without end: the one who sends them is
/// told or cut off, and others notice nothing.
#[test]
fn what_is_too_much_or_nonsense_is_cut_off() {
    let server = Server::of(BOX);
    let mut witness = server.page();
    witness.until("a picture", |v| v["type"] == "frame");
    assert_eq!(server.raw(b"\x16\x03\x01\x02\0nonsense\r\n\r\n").status, 400);
    assert_eq!(server.post("api/save", &json!({ "name": "x".repeat(100_000) })).status, 413);
    let headers = format!("Host: {}\r\nX: {}\r\n", server.host(), "y".repeat(1 << 20));
    assert!([0, 400, 431].contains(&server.ask("GET", &server.base(), &headers, b"").status));
    // Texts that are no requests, and one that is none at all.
    let mut page = server.page();
    for text in ["", "{", "[1,2", r#"{"type":"quit"}"#, r#"{"type":"camera","eye":[1],"target":[0,0,0],"up":[0,1,0]}"#]
    {
        page.socket.send(Message::text(text)).unwrap();
        let (said, _) = page.until("an answer", |v| v["type"] == "message");
        assert!(said["text"].as_str().unwrap().starts_with("the request cannot be read"), "{said}");
    }
    page.socket.send(Message::binary(vec![1, 2, 3])).unwrap();
    page.until("an answer", |v| v["type"] == "message");
    // A message beyond the limit ends the connection.
    let _ = page.socket.send(Message::text("x".repeat(200_000)));
    while page.socket.read().is_ok() {}
    // A frame that lies about its length, without a mask.
    let mut page = server.page();
    let _ = page.socket.get_mut().write_all(&[0x81, 127, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1, 2, 3]);
    while page.socket.read().is_ok() {}
    assert!(server.logged("a page's connection ended"));
    // The witness is served as before.
    witness.finished(camera(0.5));
}

/// Edits name no file outside the scene's folder.
#[test]
fn edits_read_nothing_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    std::fs::copy("../../scenes/shapes.steradian", inner.join("scene.steradian")).unwrap();
    let picture = steradian::image::Image::from_rgb(1, 1, &[[0.5; 3]]).unwrap();
    for place in [folder.path().join("outside.png"), inner.join("inside.png")] {
        steradian::image::write(&place, &picture, &Default::default()).unwrap();
    }
    let server = Server::of(inner.join("scene.steradian"));
    let nodes = server.get("api/nodes").json();
    let diffuse =
        nodes.as_array().unwrap().iter().find(|n| n["family"] == "material" && n["kind"] == "diffuse").unwrap();
    let mut page = server.page();
    page.until("a state", |v| v["type"] == "state");
    let edit = |file: String| {
        let value = format!("{{texture: bitmap, file: {{file: \"{file}\"}}}}");
        json!({"type": "edit", "node": diffuse["id"], "parameter": "reflectance", "value": value})
    };
    let absolute = folder.path().join("outside.png").display().to_string();
    for file in ["../outside.png".to_owned(), absolute, "/etc/passwd".into()] {
        let said = page.refusal(edit(file));
        assert!(said.contains("is outside the scene's folder"), "{said}");
    }
    page.finished(edit("inside.png".into()));
}

//! `steradian view`: the address that it prints serves the page until it is stopped.

use crate::Place;
use std::{
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    process::{Child, Command, Stdio},
};

/// A program that is ended with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Answer of the server under a path.
fn get(host: &str, path: &str) -> String {
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// Answer of the server to a body that is sent.
#[cfg(unix)]
fn post(host: &str, path: &str, kind: &str, body: &[u8]) -> String {
    let mut stream = TcpStream::connect(host).unwrap();
    let length = body.len();
    write!(stream, "POST {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Type: {kind}\r\n").unwrap();
    write!(stream, "Content-Length: {length}\r\n\r\n").unwrap();
    stream.write_all(body).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// A saved upload stays, with the files that it is made of, and is that which was shown; the upload itself goes,
/// whatever ends the program.
#[cfg(unix)]
#[test]
fn what_was_saved_of_an_upload_stays_and_the_upload_goes() {
    let picture = steradian::image::Image::from_rgb(1, 1, &[[0.5; 3]]).unwrap();
    let picture = steradian::image::encode(steradian::image::FileKind::Png, &picture, &Default::default()).unwrap();
    let scene = b"Camera \"perspective\" WorldBegin LightSource \"infinite\"\nTexture \"t\" \"spectrum\" \"imagemap\" \
                  \"string filename\" \"maps/p.png\"\n\
                  Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"";
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let place = Place::new();
        std::fs::create_dir(place.path("temporary")).unwrap();
        let mut command = place.command(&["view", "--size", "8x8", "--spp", "1"]);
        command.env("TMPDIR", place.path("temporary")).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut program = Running(command.spawn().unwrap());
        let mut address = String::new();
        BufReader::new(program.0.stdout.take().unwrap()).read_line(&mut address).unwrap();
        let (host, base) = address.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
        let mut form = Vec::new();
        for (name, bytes) in [("s/a.pbrt", &scene[..]), ("s/maps/p.png", &picture)] {
            let head = format!("--edge\r\nContent-Disposition: form-data; name=\"file\"; filename=\"{name}\"\r\n\r\n");
            form.extend([head.as_bytes(), bytes, b"\r\n"].concat());
        }
        form.extend(b"--edge--\r\n");
        let opened = post(host, &format!("/{base}api/open"), "multipart/form-data; boundary=edge", &form);
        assert!(opened.starts_with("HTTP/1.1 200"), "{opened}");
        assert_eq!(std::fs::read_dir(place.path("temporary")).unwrap().count(), 1);
        let saved = post(host, &format!("/{base}api/save"), "application/json", br#"{"name": "b.steradian"}"#);
        assert!(saved.starts_with("HTTP/1.1 200"), "{saved}");
        let signalled = Command::new("kill").args([signal, &program.0.id().to_string()]).status();
        assert!(signalled.unwrap().success());
        assert_eq!(program.0.wait().unwrap().code(), Some(code));
        assert_eq!(std::fs::read_dir(place.path("temporary")).unwrap().count(), 0, "{signal}");
        place.succeed(&["render", "b.steradian", "--strict", "--size", "8x8", "--spp", "1", "-o", "b.exr"]);
    }
}

#[cfg(unix)]
#[test]
fn a_page_is_served_until_it_is_stopped() {
    let program = Command::new(env!("CARGO_BIN_EXE_steradian"))
        .args(["view", "--size", "16x16", "--spp", "1"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut program = Running(program.unwrap());
    let mut address = String::new();
    BufReader::new(program.0.stdout.take().unwrap()).read_line(&mut address).unwrap();
    let rest = address.trim().strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{address}"));
    let (port, path) = rest.split_once('/').unwrap();
    let host = format!("127.0.0.1:{port}");
    let page = get(&host, &format!("/{path}"));
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("<title>"), "{page}");
    assert!(get(&host, &format!("/{path}assets/app.js")).starts_with("HTTP/1.1 200"));
    assert!(get(&host, &format!("/{path}assets/view.js")).starts_with("HTTP/1.1 200"));
    assert!(get(&host, "/").starts_with("HTTP/1.1 403"));
    let signalled = Command::new("kill").args(["-INT", &program.0.id().to_string()]).status();
    assert!(signalled.unwrap().success());
    assert_eq!(program.0.wait().unwrap().code(), Some(130));
    assert!(TcpStream::connect(&host).is_err());
}

#[test]
fn what_cannot_be_looked_at_is_told() {
    let place = Place::new();
    place.refuse(2, &["view", "nowhere.pbrt"], &["cannot find the scene 'nowhere.pbrt'"]);
    place.refuse(2, &["view", "-"], &["standard input"]);
    place.refuse(2, &["view", "--size", "5000x5000"], &["5000 x 5000 pixels are not shown", "--size"]);
    let film =
        "Film \"rgb\" \"integer xresolution\" 100000 \"integer yresolution\" 2 Camera \"perspective\" WorldBegin";
    place.file("wide.pbrt", film);
    place.refuse(2, &["view", "wide.pbrt"], &["100000 x 2 pixels are not shown", "--size"]);
    let picture = steradian::image::Image::from_rgb(1, 1, &[[0.5; 3]]).unwrap();
    steradian::image::write(&place.path("a.exr"), &picture, &Default::default()).unwrap();
    std::fs::create_dir(place.path("empty")).unwrap();
    place.refuse(2, &["view", "a.exr", "wide.pbrt"], &["'wide.pbrt' is a scene and 'a.exr' is none"]);
    place.refuse(2, &["view", "wide.pbrt", "wide.pbrt"], &["a view shows one scene, not 2"]);
    place.refuse(2, &["view", "a.exr", "--spp", "4"], &["--spp is for scenes"]);
    place.refuse(2, &["view", "missing.exr", "empty"], &["no picture to show", "'missing.exr'", "'empty'"]);
    place.refuse(1, &["view", "--bind", "203.0.113.1"], &["cannot listen at 203.0.113.1:0"]);
    place.refuse(2, &["render", "--look-at", "0,0,0,0,0,0,0,1,0", "-o", "n.png"], &["apart from the target"]);
    place.refuse(2, &["render", "--look-at", "0,0,0", "-o", "n.png"], &["nine numbers"]);
}

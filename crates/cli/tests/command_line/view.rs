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

/// What is answered under a path of the server.
fn get(host: &str, path: &str) -> String {
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
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
    place.refuse(1, &["view", "--bind", "203.0.113.1"], &["cannot listen at 203.0.113.1:0"]);
    place.refuse(2, &["render", "--look-at", "0,0,0,0,0,0,0,1,0", "-o", "n.png"], &["apart from the target"]);
    place.refuse(2, &["render", "--look-at", "0,0,0", "-o", "n.png"], &["nine numbers"]);
}

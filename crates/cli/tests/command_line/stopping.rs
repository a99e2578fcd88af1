//! Stopping a render keeps its work.

use crate::Place;
use std::{
    io::{BufRead, BufReader, Read},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

/// Starts a render that takes hours and waits until it has begun.
fn start(place: &Place) -> (Child, BufReader<std::process::ChildStderr>) {
    let arguments = ["render", "--size", "64x64", "--spp", "10000000", "--json", "-o", "kept.exr"];
    let mut child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    stderr.read_line(&mut line).unwrap();
    assert!(line.starts_with("rendering "), "{line}");
    std::thread::sleep(Duration::from_millis(400));
    (child, stderr)
}

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// The exit code, within seconds.
fn code(child: &mut Child) -> Option<i32> {
    let since = Instant::now();
    while since.elapsed() < Duration::from_secs(30) {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    None
}

#[test]
fn a_signal_stops_and_saves() {
    for (signal, expected, name) in [("-INT", 130, "SIGINT"), ("-TERM", 143, "SIGTERM")] {
        let place = Place::new();
        let (mut child, mut stderr) = start(&place);
        send(signal, &child);
        assert_eq!(code(&mut child), Some(expected), "{signal}");
        let (mut said, mut told) = (String::new(), String::new());
        stderr.read_to_string(&mut said).unwrap();
        child.stdout.take().unwrap().read_to_string(&mut told).unwrap();
        assert!(said.contains(name) && said.contains("saved"), "{said}");
        let json: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!(json["stopped"], name);
        assert!(json["spp"].as_f64().unwrap() >= 1.0, "{json}");
        let picture = place.picture("kept.exr");
        assert!(picture.channel("G").unwrap().iter().all(|v| v.is_finite()));
        assert!(picture.channel("G").unwrap().iter().any(|v| *v > 0.0));
    }
}

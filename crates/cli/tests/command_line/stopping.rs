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

/// A render that is stopped by time again and again ends with the bits of one that is not; another one is refused, and the file kept.
#[test]
fn a_render_goes_on_where_it_was_left() {
    let place = Place::new();
    let render = |out: &str, more: &[&str]| -> Vec<String> {
        let fixed = ["render", "--size", "48x48", "--spp", "96", "--adaptive", "--aov", "normal", "--json", "-o", out];
        fixed.iter().chain(more).map(|&a| a.to_owned()).collect()
    };
    let run = |arguments: &[String]| place.succeed(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    run(&render("whole.exr", &[]));
    let (mut runs, mut samples) = (0, 0.0);
    loop {
        let threads = if runs % 2 == 0 { "1" } else { "2" };
        let json = run(&render("parts.exr", &["--resume", "state", "--time", "150ms", "--threads", threads])).json();
        let now = json["spp"].as_f64().unwrap();
        assert!(now > samples || json["stopped"].is_null(), "{json}");
        (runs, samples) = (runs + 1, now);
        if json["stopped"].is_null() {
            break;
        }
    }
    assert!(runs > 1, "the first run did it all");
    for channel in ["R", "G", "B", "N.X"] {
        let [whole, parts] =
            ["whole.exr", "parts.exr"].map(|name| place.picture(name).channel(channel).unwrap().to_vec());
        assert!(whole == parts, "{channel}");
    }
    let state = std::fs::read(place.path("state")).unwrap();
    place.refuse(2, &["render", "--size", "48x48", "--spp", "7", "--resume", "state"], &["state", "other settings"]);
    place.refuse(2, &["render", "--size", "48x48", "--resume", "whole.exr"], &["whole.exr", "no saved state"]);
    assert!(std::fs::read(place.path("state")).unwrap() == state);
}

//! Stopping a render keeps its work.

use crate::Place;
use std::{
    io::{BufRead, BufReader, Read, Write},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

/// Starts a render and waits until it has begun.
fn start(place: &Place, more: &[&str]) -> (Child, BufReader<std::process::ChildStderr>) {
    let arguments = [&["render", "--spp", "10000000", "--json", "-o", "kept.exr"], more].concat();
    let mut child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    stderr.read_line(&mut line).unwrap();
    assert!(line.starts_with("rendering "), "{line}");
    (child, stderr)
}

/// Waits for a line that says that each pixel has samples.
fn sampled(stderr: &mut impl BufRead) {
    let mut line = String::new();
    while stderr.read_line(&mut line).unwrap() > 0 {
        let spp = line.split(" · ").nth(1).and_then(|part| part.split('/').next()?.parse::<u32>().ok());
        if spp.is_some_and(|spp| spp >= 1) {
            return;
        }
        line.clear();
    }
    panic!("the render ended");
}

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// The exit code; `None` for a process that does not end at all.
fn code(child: &mut Child) -> Option<i32> {
    let since = Instant::now();
    while since.elapsed() < Duration::from_secs(300) {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    None
}

/// A pipe that nobody reads holds no command that is to end.
#[test]
fn a_pipe_without_a_reader_ends_by_a_signal() {
    for (signal, expected) in [("-INT", 130), ("-TERM", 143)] {
        let place = Place::new();
        assert!(Command::new("mkfifo").arg(place.path("pipe.exr")).status().unwrap().success());
        let (mut child, mut stderr) = start(&place, &["--size", "16x16", "-o", "pipe.exr"]);
        sampled(&mut stderr);
        send(signal, &child);
        assert_eq!(code(&mut child), Some(expected), "{signal}");
    }
}

#[test]
fn a_signal_stops_and_saves() {
    for (signal, expected, name) in [("-INT", 130, "SIGINT"), ("-TERM", 143, "SIGTERM")] {
        let place = Place::new();
        let (mut child, mut stderr) = start(&place, &["--size", "64x64"]);
        sampled(&mut stderr);
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

/// A picture of which there is hardly anything yet does not take the place of an older one.
#[test]
fn a_picture_that_is_not_whole_leaves_the_older_one() {
    let place = Place::new();
    place.file("kept.exr", "the older one");
    // Long enough for the signal to come before each of the pixels has a sample.
    let (mut child, mut stderr) = start(&place, &["--size", "1600x1600", "--threads", "1", "--compression", "none"]);
    send("-INT", &child);
    assert_eq!(code(&mut child), Some(130));
    let (mut said, mut told) = (String::new(), String::new());
    stderr.read_to_string(&mut said).unwrap();
    child.stdout.take().unwrap().read_to_string(&mut told).unwrap();
    assert_eq!(std::fs::read(place.path("kept.exr")).unwrap(), b"the older one");
    if told.is_empty() {
        // The signal came while it was tried which paths pay.
        assert!(said.contains("before the first sample") && !place.path("kept.partial.exr").exists(), "{said}");
        return;
    }
    let json: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert!(json["empty_pixels"].as_u64().unwrap() > 0, "{json}");
    assert_eq!(json["outputs"], serde_json::json!(["kept.partial.exr"]));
    assert!(said.contains("kept.exr stays") && said.contains("wrote kept.partial.exr"), "{said}");
    assert_eq!(place.picture("kept.partial.exr").width(), 1600);
}

/// Files that the system does not let grow are a message, not the end of the process.
#[test]
fn a_limit_on_the_size_of_files_is_told() {
    let place = Place::new();
    let program = place.command(&[]).get_program().to_owned();
    let mut shell = Command::new("sh");
    let line = "ulimit -f 1; exec \"$0\" render --size 64x64 --spp 1 --compression none -o a.exr";
    let run = shell.args(["-c", line]).arg(program).current_dir(&place.0).output().unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("a.exr") && said.contains("too large") && said.contains("could not be kept"), "{said}");
    assert_eq!(std::fs::read_dir(&place.0).unwrap().count(), 0);
}

/// A render that is stopped by time again and again ends with the bits of one that is not; another one is refused, and
/// the file kept.
#[test]
fn a_render_goes_on_where_it_was_left() {
    let place = Place::new();
    let render = |out: &str, more: &[&str]| -> Vec<String> {
        let fixed = ["render", "--size", "48x48", "--spp", "96", "--adaptive", "--aov", "normal", "--json", "-o", out];
        fixed.iter().chain(more).map(|&a| a.to_owned()).collect()
    };
    let run = |arguments: &[String]| place.succeed(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    run(&render("whole.exr", &[]));
    let (mut runs, mut samples, mut time) = (0, 0.0, 150);
    loop {
        let (threads, limit) = (if runs % 2 == 0 { "1" } else { "2" }, format!("{time}ms"));
        let json = run(&render("parts.exr", &["--resume", "state", "--time", &limit, "--threads", threads])).json();
        let now = json["spp"].as_f64().unwrap();
        assert!(now >= samples, "{json}");
        // On a busy machine a time may be too short for a pass.
        time = if now > samples { time } else { 2 * time };
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

/// A state file becomes a picture by `--time 0`, and a finished render continues with more samples.
#[test]
fn a_finished_render_continues_and_its_state_becomes_a_picture() {
    let place = Place::new();
    let render = |more: &[&str]| {
        place.succeed(&[&["render", "--size", "24x24", "--json", "--resume", "state"], more].concat()).json()
    };
    let nothing = ["render", "--size", "24x24", "--resume", "state", "--time", "0"];
    place.refuse(2, &nothing, &["--time 0 takes no samples", "--resume"]);
    place.refuse(2, &["render", "--time", "0s"], &["--time 0 takes no samples"]);
    render(&["--spp", "8", "-o", "few.exr"]);
    let picture = render(&["--time", "0", "-o", "again.exr"]);
    assert!(picture["spp"] == 8.0 && picture["stopped"].is_null(), "{picture}");
    assert!(place.picture("few.exr").channel("G") == place.picture("again.exr").channel("G"));
    assert_eq!(render(&["--spp", "24", "-o", "more.exr"])["spp"], 24.0);
    assert_eq!(render(&["--time", "0", "-o", "again.exr"])["spp"], 24.0);
    assert!(place.picture("more.exr").channel("G") == place.picture("again.exr").channel("G"));
    assert!(place.picture("more.exr").channel("G") != place.picture("few.exr").channel("G"));
    let fewer = ["render", "--size", "24x24", "--resume", "state", "--spp", "16", "-o", "fewer.exr"];
    place.refuse(2, &fewer, &["more than 16 samples"]);
}

/// `--watch` and SIGUSR1 write the picture while the render goes on.
#[test]
fn pictures_are_written_on_the_way() {
    for more in [&["--size", "32x32"][..], &["--size", "32x32", "--watch", "100ms"]] {
        let place = Place::new();
        let (mut child, mut stderr) = start(&place, more);
        sampled(&mut stderr);
        if more.len() == 2 {
            send("-USR1", &child);
        }
        let mut line = String::new();
        while !line.contains("wrote kept.exr on the way") {
            line.clear();
            assert!(stderr.read_line(&mut line).unwrap() > 0, "the render ended");
        }
        assert_eq!(place.picture("kept.exr").width(), 32);
        assert_eq!(child.try_wait().unwrap(), None, "it goes on");
        send("-INT", &child);
        // What is told must be read, so that the program is not held up.
        let mut rest = String::new();
        stderr.read_to_string(&mut rest).unwrap();
        assert_eq!(code(&mut child), Some(130), "{rest}");
    }
}

/// A command that reads a scene from standard input, with so much of it written that the command must be reading.
fn reading(place: &Place, arguments: &[&str], scene: &str) -> (Child, std::process::ChildStdin) {
    let mut command = place.command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(scene.as_bytes()).unwrap();
    // More than a pipe holds: the last of it can be written only when the first was read.
    stdin.write_all("# and nothing more\n".repeat(1 << 16).as_bytes()).unwrap();
    (child, stdin)
}

const SCENE: &str = "Film \"rgb\" \"integer xresolution\" [8] \"integer yresolution\" [8]\nCamera \"perspective\"\nWorldBegin\n\
    LightSource \"infinite\"\nTranslate 0 0 3 Shape \"sphere\"\n";

/// Commands that read a scene from standard input.
const READERS: [&[&str]; 6] = [
    &["render", "-", "--spp", "1", "-q", "-o", "a.exr"],
    &["render", "-", "--integrator", "raster", "-o", "a.exr"],
    &["info", "-"],
    &["verify", "-", "-i", "direct", "--spp", "2"],
    &["convert", "-", "a.xml", "--check"],
    &["bench", "accel", "-", "--structures", "bvh", "--each", "1ms", "--rays", "64"],
];

#[test]
fn a_signal_ends_every_command_with_a_message() {
    for arguments in READERS {
        for (signal, expected, name) in [("-INT", 130, "SIGINT"), ("-TERM", 143, "SIGTERM")] {
            let place = Place::new();
            let (mut child, _stdin) = reading(&place, arguments, SCENE);
            send(signal, &child);
            assert_eq!(code(&mut child), Some(expected), "{arguments:?} {signal}");
            let mut said = String::new();
            child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
            assert!(said.contains(&format!("stopped by {name}")), "{arguments:?}: {said}");
            assert_eq!(std::fs::read_dir(&place.0).unwrap().count(), 0, "{arguments:?}");
        }
    }
}

/// Who asks for the picture while there is none yet does not end the render, nor any other command.
#[test]
fn a_wish_for_a_picture_ends_nothing() {
    for arguments in READERS {
        let place = Place::new();
        let (child, stdin) = reading(&place, arguments, SCENE);
        send("-USR1", &child);
        drop(stdin);
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        // What `verify` finds of so few samples is not the question.
        assert!(matches!(output.status.code(), Some(0 | 4 | 5)), "{arguments:?}: {:?} {said}", output.status);
    }
}

/// A damaged state is no loss of the whole: the one before it is taken, and comes to the same bits.
#[test]
fn a_damaged_state_falls_back_to_the_one_before() {
    let place = Place::new();
    let common = ["render", "--size", "24x24", "--resume", "state", "-o"];
    let render = |out: &str, spp: &str| place.succeed(&[&common[..], &[out, "--spp", spp]].concat());
    render("a.exr", "4");
    render("b.exr", "8");
    for bad in [&b"damaged"[..], b""] {
        std::fs::write(place.path("state"), bad).unwrap();
        let again = render("again.exr", "8");
        assert!(again.stderr.contains("state is damaged; the state before it is taken"), "{}", again.stderr);
        assert!(place.picture("again.exr").channels() == place.picture("b.exr").channels());
        render("more.exr", "8");
    }
    // Without a sound state before it, it is refused, and without its file the render begins anew.
    std::fs::write(place.path("state"), b"damaged").unwrap();
    std::fs::write(place.path("state.before"), b"damaged").unwrap();
    place.refuse(2, &[&common[..], &["no.exr"]].concat(), &["no saved state"]);
    std::fs::remove_file(place.path("state")).unwrap();
    render("anew.exr", "4");
    assert!(place.picture("anew.exr").channels() == place.picture("a.exr").channels());
}

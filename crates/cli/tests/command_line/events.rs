//! `--progress json`: every line of stderr is an event.

use crate::Place;
use serde_json::Value;

/// The events of a command, which ends with a code.
fn events(place: &Place, code: i32, line: &[&str]) -> Vec<Value> {
    let run = place.run(&[line, &["--progress", "json"]].concat());
    assert_eq!(run.code, code, "{line:?}: {}", run.stderr);
    let all: Vec<Value> =
        run.stderr.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect();
    let end = all.last().expect("it ends");
    assert_eq!((&end["event"], &end["code"]), (&"end".into(), &code.into()));
    all
}

fn of<'a>(events: &'a [Value], kind: &str) -> Vec<&'a Value> {
    events.iter().filter(|event| event["event"] == kind).collect()
}

#[test]
fn renders_and_chunks_tell_events() {
    let place = Place::new();
    let small = ["builtin:cornell-box", "--size", "40x36", "--spp", "4"];
    let told = events(&place, 0, &[&["render", "-o", "a.exr"], &small[..]].concat());
    let progress = of(&told, "progress");
    assert!(!progress.is_empty());
    for event in progress {
        assert_eq!((&event["unit"], &event["of"]), (&"samples".into(), &(40 * 36 * 4).into()));
        let fraction = event["fraction"].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&fraction) && event["seconds"].as_f64().unwrap() >= 0.0, "{event}");
    }
    assert!(of(&told, "message").iter().any(|event| event["text"].as_str().unwrap().contains("wrote a.exr")));
    let farmed = [&["farm", "-o", "job", "--chunks", "3", "--picture", "b.exr"], &small[..]].concat();
    let told = events(&place, 0, &farmed);
    assert!(of(&told, "progress").iter().any(|event| event["unit"] == "chunks" && event["of"] == 3));
    // The form is no part of the job.
    assert!(!std::fs::read_to_string(place.path("job/job.json")).unwrap().contains("progress"));
    events(&place, 0, &["chunk", "job", "1"]);
    events(&place, 0, &["merge", "job", "-o", "c.exr"]);
    let quiet = events(&place, 0, &["merge", "job", "-o", "c.exr", "--quiet"]);
    assert_eq!(quiet.len(), 1);
}

#[test]
fn faults_are_events_with_their_place() {
    let place = Place::new();
    place.file("a.pbrt", "WorldBegin\nShape \"sphre\"\n");
    let told = events(&place, 2, &["render", "a.pbrt", "-o", "a.exr"]);
    let diagnostics = of(&told, "diagnostic");
    let fault = diagnostics.iter().find(|d| d["severity"] == "error").expect("an error");
    assert_eq!((&fault["location"]["line"], &fault["location"]["column"]), (&2.into(), &7.into()), "{fault}");
    assert!(fault["help"].as_str().unwrap().contains("sphere"));
    place.succeed(&["plan", "builtin:cornell-box", "--size", "16x16", "--spp", "1", "-o", "job", "--chunks", "1"]);
    let told = events(&place, 75, &["merge", "job"]);
    assert!(of(&told, "error")[0]["message"].as_str().unwrap().contains("missing"));
}

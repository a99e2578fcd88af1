//! `steradian exercise`: lists, writes, checks. What answers are told is tested in `steradian-exercises`.

use crate::Place;
use std::{
    process::{Command, Stdio},
    time::Duration,
};

fn has_python() -> bool {
    let is_there = Command::new("python3").arg("--version").output().is_ok_and(|o| o.status.success());
    if !is_there {
        println!("SKIPPED: python3 is not installed");
    }
    is_there
}

#[test]
fn exercises_are_listed() {
    let place = Place::new();
    let text = place.succeed(&["exercise", "list"]).stdout;
    let rows = place.succeed(&["exercise", "list", "--json"]).json();
    assert_eq!(rows.as_array().unwrap().len(), text.lines().count());
    assert!(text.contains("fresnel") && rows[0]["name"].is_string() && rows[0]["chapter"].is_u64());
}

#[test]
fn folders_are_written_once_and_recognised() {
    let place = Place::new();
    place.refuse(2, &["exercise", "start", "fresnl"], &["no exercise 'fresnl'", "did you mean 'fresnel'?"]);
    place.refuse(2, &["exercise", "start", "fresnel", "--language", "cobol"], &["python, rust"]);
    place.refuse(2, &["exercise", "start"], &["example: steradian exercise"]);
    place.succeed(&["exercise", "start", "fresnel"]);
    place.refuse(2, &["exercise", "start", "fresnel"], &["fresnel exists", "nothing is overwritten"]);
    place.refuse(2, &["exercise", "check"], &["no folder of an exercise", "exercise.txt"]);
    place.refuse(2, &["exercise", "check", "nowhere"], &["nowhere is no folder of an exercise"]);
    place.file("fresnel/exercise.txt", "exercise = fresnel\nlanguage = cobol\n");
    place.refuse(2, &["exercise", "check", "fresnel"], &["'cobol' is not a language"]);
    place.file("fresnel/exercise.txt", "exercise = fresnet\nlanguage = python\n");
    place.refuse(2, &["exercise", "check", "fresnel"], &["did you mean 'fresnel'?"]);
    place.file("fresnel/exercise.txt", "fresnel\n");
    place.refuse(2, &["exercise", "check", "fresnel"], &["has no line 'exercise = …'"]);
    place.succeed(&["exercise", "start", "diffuse", "--language", "rust", "-o", "mine/matt"]);
    let told = place.succeed(&["exercise", "start", "fresnel", "-o", "of mine/ü"]).stdout;
    assert!(told.contains("`steradian exercise check 'of mine/ü'`"), "{told}");
    for file in ["README.md", "Cargo.toml", "src/main.rs", "src/answer.rs", "exercise.txt"] {
        assert!(place.path("mine/matt").join(file).is_file(), "{file}");
    }
}

#[test]
fn a_missing_interpreter_is_told() {
    let place = Place::new();
    place.succeed(&["exercise", "start", "fresnel"]);
    let output = place.command(&["exercise", "check", "fresnel"]).env("PATH", place.path("none")).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("cannot start python") && message.contains("exercises in python"), "{message}");
}

#[test]
fn verdicts_are_exit_codes() {
    if !has_python() {
        return;
    }
    let place = Place::new();
    place.succeed(&["exercise", "start", "fresnel"]);
    let run = place.run(&["exercise", "check", "fresnel", "--json"]);
    assert_eq!(run.code, 4, "{}", run.stderr);
    let report = run.json();
    assert!(report["passed"] == false && report["functions"][0]["verdict"] == "not written", "{report}");
    place.succeed(&["exercise", "start", "fresnel", "--solution", "-o", "solved"]);
    let run = place.succeed(&["exercise", "check", "solved"]);
    assert!(run.stdout.ends_with("fresnel: passed\n"), "{}", run.stdout);
    assert!(place.succeed(&["exercise", "check", "solved", "--json"]).json()["passed"] == true);
    place.file("solved/answer.py", "def reflectance(c, eta):\n    while True:\n        pass\n");
    let run = place.run(&["exercise", "check", "solved", "--timeout", "1"]);
    assert!(run.code == 4 && run.stdout.contains("no answer within 1 s"), "{}", run.stdout);
}

/// A signal ends the check, and the program that it runs.
#[cfg(unix)]
#[test]
fn a_signal_leaves_no_program() {
    if !has_python() {
        return;
    }
    for (signal, code, name) in [("-INT", 130, "SIGINT"), ("-TERM", 143, "SIGTERM")] {
        let place = Place::new();
        place.succeed(&["exercise", "start", "fresnel", "-o", "my task"]);
        let answer =
            "import os\nopen('new', 'w').write(str(os.getpid()))\nos.rename('new', 'number')\nwhile True: pass\n";
        place.file("my task/answer.py", answer);
        let mut command = place.command(&["exercise", "check", "my task", "--timeout", "86400"]);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let number = place.path("my task/number");
        while !number.exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        let number = std::fs::read_to_string(number).unwrap();
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{signal}");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(told.contains(&format!("stopped by {name}")), "{told}");
        // It was waited for, so that its number is nobody's.
        assert!(!Command::new("kill").args(["-0", &number]).output().unwrap().status.success(), "{number} is left");
    }
}

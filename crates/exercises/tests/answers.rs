//! Solutions pass, and each wrong answer gets its own hint, by running Python and Cargo.

#![expect(clippy::print_stdout, reason = "tests say what they skip")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
    time::Duration,
};
use steradian_exercises::{EXERCISES, Exercise, Language, Report, check, find, start};

/// Long enough for a busy machine: no verdict depends on it.
const PATIENCE: Duration = Duration::from_secs(600);
/// Programs that run at a time.
const AT_A_TIME: usize = 4;

/// True if a tool is there; told if it is not.
fn has(tool: &str) -> bool {
    let is_there = Command::new(tool).arg("--version").output().is_ok_and(|o| o.status.success());
    if !is_there {
        println!("SKIPPED: {tool} is not installed");
    }
    is_there
}

/// A wrong answer: replacements on the solution, and the key of the mistake.
struct Wrong {
    key: String,
    language: Language,
    replacements: Vec<(String, String)>,
}

fn source(exercise: &Exercise, file: &str) -> String {
    let path = Path::new("exercises").join(exercise.name).join(file);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Blocks of `wrong.txt`: a key, perhaps `rust`, then `- old` and `+ new` in turns; further `+` lines are lines of new.
fn wrong(exercise: &Exercise) -> Vec<Wrong> {
    let text = source(exercise, "wrong.txt");
    let blocks = text.split("\n\n").filter(|b| !b.trim().is_empty());
    blocks
        .map(|block| {
            let mut lines = block.trim().lines();
            let head = lines.next().unwrap();
            let (key, language) = head.split_once(' ').map_or((head, Language::Python), |(k, _)| (k, Language::Rust));
            let mut replacements: Vec<(String, String)> = Vec::new();
            for line in lines {
                if let Some(old) = line.strip_prefix("- ") {
                    replacements.push((old.to_owned(), String::new()));
                } else {
                    let new = &mut replacements.last_mut().unwrap().1;
                    *new += if new.is_empty() { "" } else { "\n" };
                    *new += line.strip_prefix("+ ").unwrap();
                }
            }
            Wrong { key: key.to_owned(), language, replacements }
        })
        .collect()
}

/// Runs jobs a few at a time.
fn all<T: Sync>(jobs: &[T], run: impl Fn(&T) + Sync) {
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    run(job);
                }
            });
        }
    });
}

fn answer(folder: &Path, language: Language) -> PathBuf {
    folder.join(if language == Language::Python { "answer.py" } else { "src/answer.rs" })
}

/// The verdict on the solution of an exercise, changed.
fn verdict(exercise: &Exercise, language: Language, change: impl FnOnce(String) -> String) -> Report {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("answer");
    start(exercise, language, &folder, true).unwrap();
    let file = answer(&folder, language);
    let text = change(fs::read_to_string(&file).unwrap());
    fs::write(&file, text).unwrap();
    check(&folder, PATIENCE).unwrap()
}

fn replaced(text: String, w: &Wrong) -> String {
    w.replacements.iter().fold(text, |text, (old, new)| {
        assert!(text.contains(old.as_str()), "{}: '{old}' is not in the solution", w.key);
        text.replace(old.as_str(), new)
    })
}

/// Keys of mistakes that a report names.
fn keys(report: &Report) -> Vec<&str> {
    report.functions.iter().filter_map(|f| f.mistake).chain(report.laws.iter().filter_map(|l| l.mistake)).collect()
}

fn tests_of(language: Language) {
    all(EXERCISES, |exercise| {
        let report = verdict(exercise, language, |text| text);
        assert!(report.passed, "{report}");
    });
    let wrong: Vec<(&Exercise, Wrong)> = EXERCISES
        .iter()
        .flat_map(|e| wrong(e).into_iter().map(|w| (*e, w)))
        .filter(|(_, w)| w.language == language)
        .collect();
    all(&wrong, |(exercise, w)| {
        let report = verdict(exercise, language, |text| replaced(text, w));
        assert!(!report.passed, "{} {}", exercise.name, w.key);
        // What calls a wrong function may be wrong as well.
        assert_eq!(keys(&report).first(), Some(&w.key.as_str()), "{}\n{report}", exercise.name);
    });
}

#[test]
fn python_solutions_pass_and_wrong_answers_get_their_hints() {
    if has("python3") {
        for exercise in EXERCISES {
            assert!(wrong(exercise).len() >= 4, "{}", exercise.name);
        }
        tests_of(Language::Python);
    }
}

#[test]
fn rust_solutions_pass_and_wrong_answers_get_their_hints() {
    if has("cargo") {
        tests_of(Language::Rust);
    }
}

/// The verdict on `fresnel` with another answer.
fn told(language: Language, text: &str) -> String {
    let report = verdict(find("fresnel").unwrap(), language, |_| text.to_owned());
    assert!(!report.passed);
    report.to_string()
}

fn says(report: &str, words: &[&str]) {
    for word in words {
        assert!(report.contains(word), "'{word}' is not in:\n{report}");
    }
}

#[test]
fn broken_python_is_told_in_words() {
    if !has("python3") {
        return;
    }
    let python = |text: &str| told(Language::Python, text);
    let of = |body: &str| python(&format!("def reflectance(cos_i, eta):\n    {body}\n"));
    says(&of("raise NotImplementedError"), &["not written", "answer.py"]);
    says(&python("def reflectance(cos_i, eta)\n    return 1\n"), &["answer.py cannot be loaded", "SyntaxError"]);
    says(&of("return undefined"), &["error", "cos_i = 0.5, eta = 1.5", "NameError", "line 2"]);
    says(&of("return 1 / 0"), &["ZeroDivisionError"]);
    says(&of("pass"), &["return"]);
    says(&of("return float('nan')"), &["NaN", "cos_i = 0.5"]);
    says(&of("return 1, 2"), &["2 numbers", "1 are asked for: F"]);
    says(&of("import os; os._exit(3)"), &["ended early", "exit status: 3", "cos_i = 0.5, eta = 1.5"]);
    says(&of("raise SystemExit"), &["SystemExit"]);
    says(&of("return reflectance(cos_i, eta)"), &["RecursionError"]);
    says(&of("print('here'); return 1"), &["the program printed", "here", "wrong at"]);
    says(&of("print('x' * 1000000); return 1"), &["the program printed", "wrong at"]);
    says(&of("import protocol; return 1"), &["reflectance"]);
    let flood = "import os\n    while True: os.write(1, b'x' * 65536)";
    says(&of(flood), &["without end"]);
    says(&of("import os; os.write(1, b'debug 1\\n'); return 1"), &["no answer", "debug 1"]);
    says(&python("def other():\n    pass\n"), &["no function reflectance"]);
    says(&python("import sys\nsys.stdin.read()\ndef reflectance(c, e):\n    return 3 * c\n"), &["wrong at"]);
}

/// Wrong answers that are no known mistake are told by their factor, or by where they are right.
#[test]
fn unknown_mistakes_are_described() {
    if !has("python3") {
        return;
    }
    let changed = |name: &str, old: &str, new: &str| {
        verdict(find(name).unwrap(), Language::Python, |text| text.replace(old, new)).to_string()
    };
    says(&changed("diffuse", "albedo / math.pi", "3 * albedo / math.pi"), &["All values are 3 times the right ones"]);
    says(&changed("diffuse", "albedo / math.pi", "albedo"), &["∫ cosθ dω is not 1", "you gave 0.5, right is 0.159155"]);
    let depth = "far * (distance - near)";
    let near = changed("perspective-interpolation", depth, &format!("(1 if distance < 4 else 2) * {depth}"));
    says(&near, &["It is right where distance is at most 3, and wrong from 5 on."]);
}

#[test]
fn a_loop_without_end_is_ended() {
    if !has("python3") {
        return;
    }
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("f");
    start(find("fresnel").unwrap(), Language::Python, &folder, false).unwrap();
    fs::write(folder.join("answer.py"), "def reflectance(c, e):\n    while True: pass\n").unwrap();
    let report = check(&folder, Duration::from_secs(2)).unwrap();
    assert!(!report.passed);
    says(&report.to_string(), &["no answer within 2 s", "not asked"]);
}

#[test]
fn broken_rust_is_told_in_words() {
    if !has("cargo") {
        return;
    }
    let of = |body: &str| told(Language::Rust, &format!("pub fn reflectance(c: f64, e: f64) -> f64 {{ {body} }}\n"));
    says(&of("todo!()"), &["not written", "src/answer.rs"]);
    says(&of("let x = ;"), &["does not compile", "expected expression"]);
    says(&of("let v = vec![c]; v[(1.0 + e) as usize]"), &["error", "cos_i = 0.5", "index out of bounds"]);
    says(&of("println!(\"debug {c}\"); e"), &["no answer", "debug 0.5", "eprintln!"]);
    says(&of("eprintln!(\"debug {c}\"); e"), &["the program printed", "debug 0.5", "wrong at"]);
    says(&of("std::process::exit((7.0 + c) as i32 - e as i32 + 1)"), &["ended early", "exit status: 7"]);
}

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
use steradian_exercises::{EXERCISES, Exercise, Fault, Language, Report, check, find, start};

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
    check(&folder, PATIENCE, &|| false).unwrap()
}

fn replaced(text: String, w: &Wrong) -> String {
    w.replacements.iter().fold(text, |text, (old, new)| {
        assert!(text.contains(old.as_str()), "{}: '{old}' is not in the solution", w.key);
        text.replace(old.as_str(), new)
    })
}

/// Asserts that a report names a mistake.
fn names(exercise: &Exercise, key: &str, report: &Report) {
    assert!(!report.passed, "{} {key}", exercise.name);
    let of_functions = report.functions.iter().filter_map(|f| f.mistake);
    let keys: Vec<&str> = of_functions.chain(report.laws.iter().filter_map(|l| l.mistake)).collect();
    // Functions that call a wrong one may be wrong as well.
    assert_eq!(keys.first(), Some(&key), "{}\n{report}", exercise.name);
}

/// Several answers in Rust as one, which is built once: the file `variant` in the folder says which one answers.
fn variants(answers: &[String]) -> String {
    let modules = answers.iter().enumerate().map(|(i, text)| format!("#[allow(dead_code)]\nmod v{i} {{\n{text}}}\n"));
    let signatures = answers[0].split("pub fn ").skip(1).filter_map(|text| text.split_once(" {\n"));
    let functions = signatures.map(|(signature, _)| {
        let (name, rest) = signature.split_once('(').unwrap();
        let parameters = rest.split_once(')').unwrap().0.split(',');
        let arguments: Vec<&str> = parameters.filter_map(|p| Some(p.split_once(':')?.0.trim())).collect();
        let arguments = arguments.join(", ");
        let arms = (0..answers.len()).map(|i| format!("{i} => v{i}::{name}({arguments}),\n"));
        format!(
            "pub fn {signature} {{ match variant() {{\n{}i => panic!(\"{{i}}\"),\n}} }}\n",
            arms.collect::<String>()
        )
    });
    let variant = "fn variant() -> usize {
    static VARIANT: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    *VARIANT.get_or_init(|| std::fs::read_to_string(\"variant\").unwrap().parse().unwrap())
}
";
    modules.chain(functions).chain([variant.to_owned()]).collect()
}

/// The verdicts on several answers in Rust.
fn verdicts(exercise: &Exercise, answers: &[String]) -> Vec<Report> {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("answer");
    start(exercise, Language::Rust, &folder, true).unwrap();
    fs::write(answer(&folder, Language::Rust), variants(answers)).unwrap();
    let of = |i: usize| {
        fs::write(folder.join("variant"), i.to_string()).unwrap();
        check(&folder, PATIENCE, &|| false).unwrap()
    };
    (0..answers.len()).map(of).collect()
}

#[test]
fn python_solutions_pass_and_wrong_answers_get_their_hints() {
    if has("python3") {
        all(EXERCISES, |exercise| {
            let report = verdict(exercise, Language::Python, |text| text);
            assert!(report.passed, "{report}");
            assert!(wrong(exercise).len() >= 4, "{}", exercise.name);
            for w in wrong(exercise).iter().filter(|w| w.language == Language::Python) {
                names(exercise, &w.key, &verdict(exercise, Language::Python, |text| replaced(text, w)));
            }
        });
    }
}

#[test]
fn rust_solutions_pass_and_wrong_answers_get_their_hints() {
    if has("cargo") {
        all(EXERCISES, |exercise| {
            let wrong: Vec<Wrong> = wrong(exercise).into_iter().filter(|w| w.language == Language::Rust).collect();
            let solution = source(exercise, "solution.rs");
            let mut answers = vec![solution.clone()];
            answers.extend(wrong.iter().map(|w| replaced(solution.clone(), w)));
            let reports = verdicts(exercise, &answers);
            assert!(reports[0].passed, "{}", reports[0]);
            wrong.iter().zip(&reports[1..]).for_each(|(w, report)| names(exercise, &w.key, report));
        });
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
    says(&of("return '0.5'"), &["text, '0.5'", "numbers are asked for"]);
    says(&of("yield from iter(int, 1)"), &["more than 1000 numbers"]);
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
    let report = check(&folder, Duration::from_secs(2), &|| false).unwrap();
    assert!(!report.passed);
    says(&report.to_string(), &["no answer within 2 s", "not asked"]);
}

#[test]
fn broken_rust_is_told_in_words() {
    if !has("cargo") {
        return;
    }
    let of = |body: &str| format!("pub fn reflectance(c: f64, e: f64) -> f64 {{ {body} }}\n");
    says(&told(Language::Rust, &of("let x = ;")), &["does not compile", "expected expression"]);
    let cases: [(&str, &[&str]); 5] = [
        ("todo!()", &["not written", "src/answer.rs"]),
        ("let v = vec![c]; v[(1.0 + e) as usize]", &["error", "cos_i = 0.5", "index out of bounds"]),
        ("println!(\"debug {c}\"); e", &["no answer", "debug 0.5", "eprintln!"]),
        ("eprintln!(\"debug {c}\"); e", &["the program printed", "debug 0.5", "wrong at"]),
        ("std::process::exit((7.0 + c) as i32 - e as i32 + 1)", &["ended early", "exit status: 7"]),
    ];
    let answers = cases.map(|(body, _)| of(body).replace(" { ", " {\n").replace(" }\n", "\n}\n"));
    for ((_, words), report) in cases.iter().zip(verdicts(find("fresnel").unwrap(), &answers)) {
        assert!(!report.passed);
        says(&report.to_string(), words);
    }
}

/// A program's children end with it, and a check that is stopped leaves none.
#[cfg(unix)]
#[test]
fn no_process_is_left() {
    if !has("python3") {
        return;
    }
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("f");
    start(find("fresnel").unwrap(), Language::Python, &folder, true).unwrap();
    let file = folder.join("answer.py");
    let solution = fs::read_to_string(&file).unwrap();
    let child = "import os, sys, time
r, w = os.pipe()
if os.fork() == 0:
    open('child', 'w').write(str(os.getpid()))
    os.write(w, b'.')
    while True: time.sleep(1)
os.read(r, 1)
";
    fs::write(&file, format!("{child}{solution}")).unwrap();
    let report = check(&folder, PATIENCE, &|| false).unwrap();
    assert!(report.passed, "{report}");
    ended(&folder);
    fs::remove_file(folder.join("child")).unwrap();
    fs::write(&file, format!("{child}def reflectance(c, e):\n    while True: pass\n")).unwrap();
    let stopped = check(&folder, PATIENCE, &|| folder.join("child").exists());
    assert!(matches!(stopped, Err(Fault::Stopped)), "{stopped:?}");
    ended(&folder);
}

/// Waits for the end of the process whose number is in the file `child`.
fn ended(folder: &Path) {
    let mut text = String::new();
    while text.is_empty() {
        text = fs::read_to_string(folder.join("child")).unwrap();
    }
    let is_there = || {
        let state = Command::new("ps").args(["-o", "stat=", "-p", &text]).output().unwrap();
        let state = String::from_utf8_lossy(&state.stdout).into_owned();
        !state.trim().is_empty() && !state.starts_with('Z')
    };
    let since = std::time::Instant::now();
    while is_there() {
        assert!(since.elapsed() < PATIENCE, "process {text} is left");
        thread::sleep(Duration::from_millis(10));
    }
}

//! Jobs for engines, and the workers of this machine.

use crate::{Place, chunks::same};
use std::{
    path::Path,
    process::{Command, Stdio},
};

/// Options of a small render.
const SMALL: [&str; 7] = ["builtin:cornell-box", "--size", "24x20", "--spp", "2", "--chunks", "4"];
/// A folder whose name breaks careless quotes.
const ODD: &str = "a b'c\"d\\e$HOME$(id)`id`\n%{x}@JOB@#é";

/// Plans for an engine, in a folder of an odd name.
fn plan(place: &Place, engine: &str, more: &[&str]) -> serde_json::Value {
    let options = [&["farm", "--json", "-o", ODD, "--engine", engine], &SMALL[..], more].concat();
    place.succeed(&options).json()
}

/// Runs a program in a folder, with the one that is tested on its PATH; `None` where it is not there.
fn run(folder: &Path, words: &[&str]) -> Option<String> {
    let here = Path::new(env!("CARGO_BIN_EXE_steradian")).parent().unwrap();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths([here.to_owned()].into_iter().chain(std::env::split_paths(&path))).unwrap();
    let mut command = Command::new(words[0]);
    let Ok(output) = command.args(&words[1..]).current_dir(folder).env("PATH", path).stdin(Stdio::null()).output()
    else {
        println!("skipped: {} is not there", words[0]);
        return None;
    };
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}

/// Checks a file by a line of Python, which has its text as `text` and the folder's name as `folder`.
fn check(place: &Place, file: &str, code: &str) {
    let code =
        format!("import sys, json; folder = sys.argv[2]; text = open(sys.argv[1], encoding='utf-8').read()\n{code}");
    let folder = std::path::absolute(place.path(ODD)).unwrap();
    run(&folder, &["python3", "-c", &code, file, folder.to_str().unwrap()]);
}

/// Workers come to the bits of one run, and go on where others ended.
#[test]
fn workers_come_to_the_bits_of_one_run() {
    let place = Place::new();
    place.succeed(&[&["render", "-o", "one.exr"], &SMALL[..5]].concat());
    place.succeed(&[&["plan", "-o", "job"], &SMALL[..]].concat());
    place.succeed(&["chunk", "job", "1"]);
    let options = [&["farm", "-o", "job", "--workers", "2", "--picture", "merged.exr", "--json"], &SMALL[..]].concat();
    assert_eq!(place.succeed(&options).json()["outputs"][0], "merged.exr");
    same(&place.picture("merged.exr"), &place.picture("one.exr"));
    // A chunk that can never be computed ends the job.
    std::fs::remove_file(place.path("job/000002.part")).unwrap();
    std::fs::create_dir(place.path("job/000002.part")).unwrap();
    let run = place.run(&options);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("chunk 2"), "{}", run.stderr);
}

/// The scripts that computing machines run do it, whatever the folder is called.
#[cfg(unix)]
#[test]
fn scripts_compute_and_merge() {
    let place = Place::new();
    let told = plan(&place, "hyperqueue", &["--picture", "it's $(id).exr"]);
    assert_eq!(told["files"], serde_json::json!(["chunk.sh", "merge.sh", "hq_job.toml"]));
    let folder = place.path(ODD);
    for chunk in ["0..1", "2", "3"] {
        run(&folder, &["sh", "chunk.sh", chunk]);
    }
    run(&folder, &["sh", "merge.sh"]);
    place.succeed(&[&["render", "-o", "one.exr"], &SMALL[..5]].concat());
    same(&place.picture("it's $(id).exr"), &place.picture("one.exr"));
    check(
        &place,
        "hq_job.toml",
        "try:\n    import tomllib\nexcept ImportError:\n    sys.exit()\n\
        tasks = tomllib.loads(text)['task']\n\
        assert [task['id'] for task in tasks] == [0, 1, 2, 3, 4] and tasks[4]['deps'] == [0, 1, 2, 3]\n\
        assert tasks[3]['command'] == ['sh', folder + '/chunk.sh', '3']",
    );
}

/// Tasks of Slurm compute all chunks, here by stand-ins for its programs; one that is stopped is dealt out again.
#[cfg(unix)]
#[test]
fn slurm_gets_scripts() {
    let place = Place::new();
    plan(&place, "slurm", &["--workers", "3"]);
    let folder = place.path(ODD);
    for name in ["chunks.sbatch", "merge.sbatch", "submit.sh"] {
        run(&folder, &["bash", "-n", name]);
    }
    let script = std::fs::read_to_string(folder.join("chunks.sbatch")).unwrap();
    assert!(script.contains("#SBATCH --array=0-3%3\n"), "{script}");
    let with = |task: &str, run_step: &str| {
        let code = format!("srun() {{ {run_step}; }}; scontrol() {{ echo \"$@\"; }}; . ./chunks.sbatch");
        let mut command = Command::new("bash");
        command
            .args(["-c", &code])
            .current_dir(&folder)
            .env("SLURM_ARRAY_TASK_ID", task)
            .env("SLURM_ARRAY_JOB_ID", "7");
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let words = std::path::absolute(&folder).unwrap();
    let expected = format!("steradian\nchunk\n{}\n2..2\n--quiet\n", words.display());
    assert_eq!(with("2", r#"printf '%s\n' "$@""#), (Some(0), expected));
    assert_eq!(with("2", "return 75"), (Some(75), "requeue 7_2\n".into()));
    assert_eq!(with("2", "return 2"), (Some(2), String::new()));
}

/// Files of the other engines are in their languages.
#[test]
fn engines_get_what_they_read() {
    let place = Place::new();
    for (engine, file) in [("dask", "dask_job.py"), ("opencue", "opencue_job.py")] {
        plan(&place, engine, &[]);
        check(&place, file, "assert compile(text, 'job', 'exec')");
        check(
            &place,
            file,
            "import ast; nodes = [n for n in ast.parse(text).body if isinstance(n, ast.Assign)]\n\
            job = [n for n in nodes if n.targets[0].id == 'JOB']\n\
            assert ast.literal_eval(job[0].value) == folder",
        );
    }
    plan(&place, "flamenco", &[]);
    check(&place, "flamenco_job.json", "assert json.loads(text)['settings'] == {'job': folder, 'chunks': 4}");
    let author = "const fs = require('fs'), added = [];\n\
        const author = { Task: (name) => ({ name, needs: [], addCommand(c) { this.command = c; }, \
        addDependency(t) { this.needs.push(t); } }), Command: (name, words) => [words.exe, ...words.args] };\n\
        const settings = JSON.parse(fs.readFileSync('flamenco_job.json')).settings;\n\
        const job = { settings, addTask: (t) => added.push(t) };\n\
        eval(fs.readFileSync('steradian.js') + '; compileJob(job)');\n\
        console.log(added.length, added[4].needs.length, added[3].command[2]);";
    let compiled = run(&place.path(ODD), &["node", "-e", author]);
    assert!(compiled.is_none_or(|said| said == "5 4 3\n"));
    plan(&place, "kubernetes", &["--workers", "2", "--image", "a: \"b\"", "--picture", "it's.exr"]);
    check(
        &place,
        "kubernetes.yaml",
        "try:\n    import yaml\nexcept ImportError:\n    sys.exit()\n\
        chunks, merge = [job['spec'] for job in yaml.safe_load_all(text)]\n\
        assert (chunks['completions'], chunks['parallelism']) == (4, 2)\n\
        of = lambda job: job['template']['spec']['containers'][0]\n\
        assert of(chunks)['image'] == 'a: \"b\"'\n\
        assert of(chunks)['command'] == ['steradian', 'chunk', '/job', '$(JOB_COMPLETION_INDEX)', '--quiet']\n\
        assert \"'/job/it'\\\\''s.exr'\" in of(merge)['command'][2], of(merge)",
    );
}

/// Containers have the folder of the job alone, so the scene lies in it.
#[test]
fn containers_carry_the_scene() {
    let place = Place::new();
    place.file(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    );
    let options = ["a.ply", "--size", "16x16", "--spp", "1", "--chunks", "1"];
    place.succeed(&[&["farm", "-o", "job", "--engine", "kubernetes"], &options[..]].concat());
    let text = std::fs::read_to_string(place.path("job/kubernetes.yaml")).unwrap();
    assert_eq!(text.matches("/job/scene.zip").count(), 2, "{text}");
    std::fs::remove_file(place.path("a.ply")).unwrap();
    place.succeed(&["chunk", "job", "0", "--scene", "job/scene.zip"]);
    place.succeed(&["merge", "job", "--scene", "job/scene.zip", "-o", "out.png"]);
}

/// Bad command lines are refused before anything is written.
#[test]
fn farms_are_refused() {
    let place = Place::new();
    let refuse = |more: &[&str], about: &[&str]| {
        place.refuse(2, &[&["farm", "-o", "job"], &SMALL[..], more].concat(), about);
    };
    refuse(&["--engine", "slrum"], &["slurm"]);
    refuse(&["--workers", "0"], &["1..=65536"]);
    refuse(&["--picture", "a.txt"], &["a.txt"]);
    refuse(&["--engine", "flamenco", "--submit"], &["by hand"]);
    let output = place
        .command(&[&["farm", "-o", "job", "--engine", "slurm", "--submit"], &SMALL[..]].concat())
        .env("PATH", "")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("'sbatch', which is not on PATH"));
    assert!(!place.path("job").exists());
    refuse(&["--time", "1s"], &["cannot be planned"]);
}

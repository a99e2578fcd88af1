//! The program as a user meets it: command lines in, files, text and exit codes out.

// Tests say on stdout what they skip.
#![expect(clippy::print_stdout, reason = "output of the program or test")]

mod baking;
mod benches;
mod chunks;
mod denoising;
mod events;
mod exchange;
mod exercises;
mod experiments;
mod farm;
#[cfg(unix)]
mod full_disks;
#[cfg(unix)]
mod kills;
mod layers;
mod lightmaps;
mod lists;
mod lit_scenes;
mod materials;
mod meters;
mod names;
mod outputs;
mod packages;
mod pictures;
mod render;
mod scenes;
mod sensors;
#[cfg(unix)]
mod stopping;
mod streams;
mod unwrapping;
mod verifying;
mod view;

use std::{
    path::PathBuf,
    process::{Command, Output, Stdio},
};
use steradian::image::{Image, Limits, read};
use tempfile::TempDir;

/// The program in a folder of its own.
struct Place(TempDir);

/// Result of a command.
struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    fn file(&self, name: &str, text: &str) -> &Self {
        std::fs::write(self.path(name), text).unwrap();
        self
    }

    fn picture(&self, name: &str) -> Image {
        read(&self.path(name), &Limits::default()).unwrap()
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_steradian"));
        command.args(arguments).current_dir(&self.0).env("NO_COLOR", "1").stdin(Stdio::null());
        command
    }

    fn run(&self, arguments: &[&str]) -> Run {
        let Output { status, stdout, stderr } = self.command(arguments).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).expect("the program writes UTF-8");
        Run { code: status.code().unwrap_or(-1), stdout: text(stdout), stderr: text(stderr) }
    }

    /// Runs a command that must succeed.
    fn succeed(&self, arguments: &[&str]) -> Run {
        let run = self.run(arguments);
        assert_eq!(run.code, 0, "{arguments:?}: {}", run.stderr);
        run
    }

    /// Runs a command that must end with a code and talk of something.
    fn refuse(&self, code: i32, arguments: &[&str], about: &[&str]) {
        let run = self.run(arguments);
        assert_eq!(run.code, code, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
        for word in about {
            assert!(run.stderr.contains(word), "{arguments:?} does not mention '{word}': {}", run.stderr);
        }
    }
}

impl Run {
    /// The one line of JSON on stdout.
    fn json(&self) -> serde_json::Value {
        assert_eq!(self.stdout.lines().count(), 1, "{}", self.stdout);
        serde_json::from_str(&self.stdout).unwrap()
    }
}

/// A file of the assets, where these are.
fn asset(name: &str) -> Option<PathBuf> {
    steradian_testkit::asset(name)
}

//! Finds out of which commit the program is made, for `--version`.
#![allow(clippy::print_stdout, reason = "this is how build scripts speak to cargo")]

use std::{path::Path, process::Command};

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|o| o.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

fn main() {
    // Only of its own repository: an archive may lie in another one.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let is_own = root.join(".git").exists();
    let commit = git(&["rev-parse", "--short=10", "HEAD"]).filter(|_| is_own);
    println!("cargo::rustc-env=STERADIAN_COMMIT={}", commit.map(|c| format!(" ({c})")).unwrap_or_default());
    println!("cargo::rerun-if-changed=build.rs");
    if is_own && let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
}

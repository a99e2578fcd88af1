//! Standard output that cannot be written: closed (`>&-`), or full.

use super::*;

/// Command lines that print data.
const PRINTING: [&[&str]; 12] = [
    &["list"],
    &["list", "integrators", "--json"],
    &["info", "builtin:cornell-box-area"],
    &["meter", "builtin:cornell-box-area", "--at", "0,0,0", "--spp", "16"],
    &["material", "diffuse"],
    &["man"],
    &["completions", "bash"],
    &["render", "builtin:cornell-box-area", "-o", "a.exr", "--size", "8x8", "--spp", "1", "--json"],
    &["--help"],
    &["--version"],
    &["help", "render"],
    &["optics", "rainbow", "--help"],
];

fn run_to(place: &Place, arguments: &[&str], redirection: &str) -> (i32, String) {
    let mut command = Command::new("sh");
    let script = format!("exec \"$0\" \"$@\" {redirection}");
    command.arg("-c").arg(script).arg(env!("CARGO_BIN_EXE_steradian")).args(arguments);
    let output = command.current_dir(&place.0).env("NO_COLOR", "1").stdin(Stdio::null()).output().unwrap();
    (output.status.code().unwrap_or(-1), String::from_utf8(output.stderr).unwrap())
}

/// Data that is lost is an error; where it goes to a device that takes everything, that is what was asked for.
#[cfg(target_os = "linux")]
#[test]
fn data_that_nobody_gets_is_an_error() {
    let place = Place::new();
    for arguments in PRINTING {
        for redirection in [">&-", ">/dev/full"] {
            let (code, said) = run_to(&place, arguments, redirection);
            assert_eq!(code, 1, "{arguments:?} {redirection}: {said}");
            assert!(said.contains("cannot write to standard output"), "{arguments:?} {redirection}: {said}");
        }
        for redirection in [">/dev/null", "1<>/dev/null"] {
            let (code, said) = run_to(&place, arguments, redirection);
            assert_eq!(code, 0, "{arguments:?} {redirection}: {said}");
        }
    }
}

/// A picture that is written to a file needs no standard output.
#[cfg(unix)]
#[test]
fn what_prints_nothing_needs_no_standard_output() {
    let place = Place::new();
    let render = ["render", "builtin:cornell-box-area", "-o", "a.exr", "--size", "8x8", "--spp", "1"];
    assert_eq!(run_to(&place, &render, ">&-").0, 0);
    assert_eq!(place.picture("a.exr").width(), 8);
}

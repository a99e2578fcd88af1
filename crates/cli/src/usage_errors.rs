//! Hints on command lines that do not hang together, besides those of the parser of command lines.

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use std::path::Path;

/// A command that runs as it stands for each that needs words.
const EXAMPLES: [(&str, &str); 15] = [
    ("verify", "verify builtin:cornell-box --spp 16 --size 32x32"),
    ("plan", "plan builtin:cornell-box --chunks 8 -o job"),
    ("chunk", "chunk job 0"),
    ("merge", "merge job -o PICTURE.exr"),
    ("farm", "farm builtin:cornell-box --engine local --chunks 8 -o job"),
    ("pack", "pack SCENE.pbrt -o SCENE.zip"),
    ("info", "info builtin:cornell-box"),
    ("material", "material plastic -p alpha_u=0.2"),
    ("meter", "meter builtin:cornell-box --at 0,0,0"),
    ("compare", "compare A.exr B.exr"),
    ("convert", "convert PICTURE.exr PICTURE.png"),
    ("denoise", "denoise PICTURE.exr -o CLEAN.png"),
    ("unwrap", "unwrap MESH.ply -o ATLAS.ply"),
    ("bench", "bench --help"),
    ("signal", "signal PICTURE.png -o spectrum.svg"),
];

/// More than the error itself says: what to do with a file that stands where a command belongs, and an example of a
/// command that lacks something.
pub fn advice(error: &Error) -> Option<String> {
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return None };
            let path = Path::new(word);
            let is_file = word.starts_with("builtin:") || path.extension().is_some() || path.exists();
            is_file.then(|| format!("example: steradian render {word}, or steradian info {word}"))
        }
        ErrorKind::MissingRequiredArgument => {
            let command = std::env::args().nth(1)?;
            let example = EXAMPLES.iter().find(|e| e.0 == command)?;
            Some(format!("example: steradian {}", example.1))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Cli;
    use clap::{CommandFactory, Parser};

    /// Every command that refuses to run without words has an example, and its words are accepted.
    #[test]
    fn every_command_that_needs_words_has_an_example() {
        for command in Cli::command().get_subcommands().map(|c| c.get_name().to_owned()) {
            let bare = Cli::try_parse_from(["steradian", &command]).err().map(|e| e.kind());
            let example = EXAMPLES.iter().find(|e| e.0 == command);
            let needs = bare == Some(ErrorKind::MissingRequiredArgument) && command != "completions";
            assert!(!needs || example.is_some(), "{command}");
            if let Some((_, words)) = example {
                let kind =
                    Cli::try_parse_from(["steradian"].into_iter().chain(words.split(' '))).err().map(|e| e.kind());
                assert!(kind.is_none_or(|k| k == ErrorKind::DisplayHelp), "{words}: {kind:?}");
            }
        }
    }
}

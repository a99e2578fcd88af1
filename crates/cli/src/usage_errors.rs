//! Hints on command lines that do not hang together, besides those of the parser of command lines.

use crate::command::Cli;
use clap::{
    CommandFactory,
    error::{ContextKind, ContextValue, Error, ErrorKind},
};
use std::path::Path;

/// A command that runs as it stands for each that needs words.
const EXAMPLES: [(&str, &str); 17] = [
    ("verify", "verify builtin:cornell-box --spp 16 --size 32x32"),
    ("plan", "plan builtin:cornell-box --chunks 8 -o job"),
    ("chunk", "chunk job 0"),
    ("merge", "merge job -o PICTURE.exr"),
    ("farm", "farm builtin:cornell-box --engine local --chunks 8 -o job"),
    ("pack", "pack SCENE.pbrt -o SCENE.zip"),
    ("new", "new plugin my-velvet"),
    ("info", "info builtin:cornell-box"),
    ("material", "material plastic -p alpha_u=0.2"),
    ("meter", "meter builtin:cornell-box --at 0,0,0"),
    ("compare", "compare A.exr B.exr"),
    ("convert", "convert PICTURE.exr PICTURE.png"),
    ("denoise", "denoise PICTURE.exr -o CLEAN.png"),
    ("unwrap", "unwrap MESH.ply -o ATLAS.ply"),
    ("bench", "bench --help"),
    ("signal", "signal PICTURE.png -o spectrum.svg"),
    ("exercise", "exercise start fresnel"),
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
        ErrorKind::UnknownArgument => after_equals(std::env::args().skip(1)).or_else(|| {
            let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else { return None };
            elsewhere(option, &std::env::args().nth(1)?)
        }),
        _ => None,
    }
}

/// Advice on an option whose value was given as a word of its own, where it stands after an equals sign.
fn after_equals(words: impl Iterator<Item = String>) -> Option<String> {
    let words: Vec<String> = words.collect();
    let program = Cli::command();
    let command = program.find_subcommand(words.first()?)?;
    let option = |word: &str| {
        let name = word.strip_prefix("--")?;
        command.get_arguments().find(|arg| arg.get_long() == Some(name) && arg.is_require_equals_set())
    };
    let (word, value) = words.iter().zip(&words[1..]).find(|(word, next)| {
        // Only a word that the option takes, not the file that follows.
        let takes = option(word).map(|arg| arg.get_possible_values());
        takes.is_some_and(|values| {
            values.iter().any(|value| value.matches(next, false)) || values.is_empty() && next.contains('=')
        })
    })?;
    Some(format!("the value of {word} stands after an equals sign: {word}={value}"))
}

/// The commands that have an option which this one lacks.
fn elsewhere(option: &str, command: &str) -> Option<String> {
    let name = option.strip_prefix("--")?.split('=').next()?;
    let program = Cli::command();
    let has = |command: &&clap::Command| command.get_arguments().any(|arg| arg.get_long() == Some(name));
    let others: Vec<&str> = program.get_subcommands().filter(has).map(|c| c.get_name()).collect();
    let is_command = program.find_subcommand(command).is_some();
    (is_command && !others.is_empty())
        .then(|| format!("--{name} is an option of {}, not of {command}", others.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

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

    #[test]
    fn values_and_options_are_put_right() {
        let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>().into_iter();
        let advice = after_equals(words("render --denoise nlm a.pbrt")).unwrap();
        assert!(advice.ends_with("--denoise=nlm"), "{advice}");
        let advice = after_equals(words("convert a.exr b.png --false-color scale=log")).unwrap();
        assert!(advice.ends_with("--false-color=scale=log"), "{advice}");
        assert_eq!(after_equals(words("render --denoise a.pbrt")), None);
        assert_eq!(after_equals(words("render")), None);
        let advice = elsewhere("--exposure", "view").unwrap();
        assert!(advice.contains("render") && advice.ends_with("not of view"), "{advice}");
        assert_eq!(elsewhere("--nothing", "view"), None);
    }
}

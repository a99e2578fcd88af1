//! Talk on stderr and data on stdout, both safe against readers that go away.

use crate::closed;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::io::{ErrorKind, IsTerminal, Result, Write, stderr, stdout};
use steradian::scene::Diagnostic;

/// Messages and progress that a command is asked for.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Talk {
    /// Print errors only
    #[arg(short, long)]
    pub quiet: bool,
    /// Form of messages and progress on stderr: text, or json, one JSON object a line (docs/farm.md)
    #[arg(long, value_enum, default_value_t, value_name = "FORM", hide_possible_values = true)]
    pub progress: Form,
}

/// Form of messages on stderr.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// Lines and bars for people.
    #[default]
    Text,
    /// One JSON object a line.
    Json,
}

/// An event, as a line of JSON.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(tag = "event", rename_all = "lowercase")]
pub enum Event<'a> {
    /// A line of talk.
    Message {
        /// Its text.
        text: &'a str,
    },
    /// A message of a reader or of the compiler.
    Diagnostic(&'a Diagnostic),
    /// A warning.
    Warning {
        /// Its text.
        message: &'a str,
    },
    /// An error, after which the command ends.
    Error {
        /// Its text.
        message: &'a str,
    },
    /// State of work on its way.
    Progress {
        /// Samples, chunks or the like that are done, and all of them.
        done: u64,
        /// All of them.
        of: u64,
        /// `samples` or `chunks`.
        unit: &'a str,
        /// Part that is done, 0 to 1, by these or by time.
        fraction: f64,
        /// Seconds so far.
        seconds: f64,
        /// Seconds that are left at the pace so far.
        left: Option<f64>,
    },
    /// The command has ended.
    End {
        /// Exit code.
        code: u8,
    },
}

/// Style of messages on stderr.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    /// Say nothing but errors.
    pub quiet: bool,
    /// Form of the messages.
    form: Form,
    /// True if escape sequences for colour are understood and wanted.
    colored: bool,
}

/// Meaning of a word; decides its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tint {
    /// Errors.
    Error,
    /// Warnings and losses.
    Warning,
    /// Notes, places, help.
    Note,
    /// Messages.
    Bold,
}

impl Terminal {
    /// Colours on a terminal that knows them, unless `NO_COLOR` is set; always with `CLICOLOR_FORCE`.
    pub fn new(Talk { quiet, progress: form }: Talk) -> Self {
        let set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|v| v == "dumb");
        let forced = set("CLICOLOR_FORCE") && std::env::var_os("CLICOLOR_FORCE").is_some_and(|v| v != "0");
        let colored = form == Form::Text && !set("NO_COLOR") && (forced || (stderr().is_terminal() && !dumb));
        Self { quiet, form, colored }
    }

    /// A word in the colour of what it stands for.
    pub fn paint(self, tint: Tint, text: &str) -> String {
        let code = match tint {
            Tint::Error => "1;31",
            Tint::Warning => "1;33",
            Tint::Note => "1;34",
            Tint::Bold => "1",
        };
        if self.colored { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }

    /// A line of talk, unless quiet.
    pub fn say(self, line: &str) {
        if !self.quiet {
            self.insist(line);
        }
    }

    /// A line that is said even when quiet.
    pub fn insist(self, text: &str) {
        self.tell(&Event::Message { text }, || text.to_owned());
    }

    /// A warning, unless quiet.
    pub fn warn(self, message: &str) {
        if !self.quiet {
            self.tell(&Event::Warning { message }, || format!("{}: {message}", self.paint(Tint::Warning, "warning")));
        }
    }

    /// An error.
    pub fn error(self, message: &str) {
        self.tell(&Event::Error { message }, || format!("{}: {message}", self.paint(Tint::Error, "error")));
    }

    /// True if events are told as JSON.
    pub fn tells_events(self) -> bool {
        self.form == Form::Json
    }

    /// An event that is for programs alone.
    pub fn event(self, event: &Event<'_>) {
        if self.tells_events() {
            self.tell(event, String::new);
        }
    }

    /// An event, or its text for people. There is nobody to tell when stderr is closed.
    pub fn tell(self, event: &Event<'_>, text: impl FnOnce() -> String) {
        let line = match self.form {
            Form::Text => text(),
            Form::Json => serde_json::to_string(event).unwrap_or_default(),
        };
        let _ = writeln!(stderr().lock(), "{line}");
    }
}

/// Writes data to stdout. A reader that has seen enough (`| head`) is no failure.
///
/// # Errors
/// Whatever else keeps stdout from being written, such as a full disk, or that it is closed.
pub fn data(bytes: &[u8]) -> Result<()> {
    written(|| stdout().lock().write_all(bytes))
}

/// Writes to stdout by a function of another's.
///
/// # Errors
/// As [`data`].
pub fn written(write: impl FnOnce() -> Result<()>) -> Result<()> {
    closed::check()?;
    match write().and_then(|()| stdout().flush()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Writes one JSON object on a line of its own.
///
/// # Errors
/// As [`data`].
pub fn json(value: &impl Serialize) -> Result<()> {
    let mut text = serde_json::to_vec(value)?;
    text.push(b'\n');
    data(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paint_only_where_it_is_understood() {
        let plain = Terminal { quiet: false, form: Form::Text, colored: false };
        assert_eq!(plain.paint(Tint::Error, "error"), "error");
        let colored = Terminal { quiet: false, form: Form::Text, colored: true };
        assert_eq!(colored.paint(Tint::Error, "error"), "\x1b[1;31merror\x1b[0m");
    }
}

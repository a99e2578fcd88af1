//! Talk on stderr and data on stdout, both safe against readers that go away.

use crate::closed;
use std::io::{ErrorKind, IsTerminal, Result, Write, stderr, stdout};

/// Style of messages on stderr.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    /// Say nothing but errors.
    pub quiet: bool,
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
    pub fn new(quiet: bool) -> Self {
        let set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|v| v == "dumb");
        let forced = set("CLICOLOR_FORCE") && std::env::var_os("CLICOLOR_FORCE").is_some_and(|v| v != "0");
        let colored = !set("NO_COLOR") && (forced || (stderr().is_terminal() && !dumb));
        Self { quiet, colored }
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

    /// A line that is said even when quiet. There is nobody to tell when stderr is closed.
    pub fn insist(self, line: &str) {
        let _ = writeln!(stderr().lock(), "{line}");
    }

    /// A warning, unless quiet.
    pub fn warn(self, message: &str) {
        self.say(&format!("{}: {message}", self.paint(Tint::Warning, "warning")));
    }

    /// An error.
    pub fn error(self, message: &str) {
        self.insist(&format!("{}: {message}", self.paint(Tint::Error, "error")));
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
pub fn json(value: &impl serde::Serialize) -> Result<()> {
    let mut text = serde_json::to_vec(value)?;
    text.push(b'\n');
    data(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paint_only_where_it_is_understood() {
        let plain = Terminal { quiet: false, colored: false };
        assert_eq!(plain.paint(Tint::Error, "error"), "error");
        let colored = Terminal { quiet: false, colored: true };
        assert_eq!(colored.paint(Tint::Error, "error"), "\x1b[1;31merror\x1b[0m");
    }
}

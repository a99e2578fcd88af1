//! Messages of a reader about a file, located and with excerpts.

pub use crate::source::Location;

use crate::source::{Sources, Span};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Something the user may like to know.
    Note,
    /// The picture may differ from what the file means.
    Warning,
    /// The scene cannot be rendered.
    Error,
}

/// Fidelity of a translation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Fidelity {
    /// The nearest thing Steradian has stands in for it.
    Approximated,
    /// It was left out.
    Dropped,
    /// Nothing read it (a misspelt or pointless parameter).
    Unused,
}

/// One message.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Diagnostic {
    /// Severity of the message.
    pub severity: Severity,
    /// Set where something was translated with a loss.
    pub fidelity: Option<Fidelity>,
    /// Description of the fault, in one sentence without a full stop.
    pub message: String,
    /// Position in a file.
    pub location: Option<Location>,
    /// Suggested remedy.
    pub help: Option<String>,
}

impl Diagnostic {
    /// `error`, `warning`, `note`, or what was lost: `approximated`, `dropped`, `unused`.
    pub fn kind(&self) -> &'static str {
        match (self.severity, self.fidelity) {
            (Severity::Error, _) => "error",
            (_, Some(Fidelity::Approximated)) => "approximated",
            (_, Some(Fidelity::Dropped)) => "dropped",
            (_, Some(Fidelity::Unused)) => "unused",
            (Severity::Warning, None) => "warning",
            (Severity::Note, None) => "note",
        }
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind(), self.message)?;
        if let Some(l) = &self.location {
            let number = l.line.to_string();
            let gap = " ".repeat(number.len());
            write!(f, "\n{gap}--> {}:{}:{}", l.path, l.line, l.column)?;
            if !l.excerpt.is_empty() {
                let (space, caret) = (" ".repeat(l.caret_start as usize), "^".repeat(l.caret_len.min(200) as usize));
                write!(f, "\n{gap} |\n{number} | {}\n{gap} | {space}{caret}", l.excerpt.trim_end())?;
            }
        }
        if let Some(help) = &self.help {
            write!(f, "\n  = help: {help}")?;
        }
        Ok(())
    }
}

/// The messages of one load, in the order they arose. Errors are kept up to [`Diagnostics::MAX_ERRORS`], other messages
/// up to [`Diagnostics::MAX_OTHERS`]; what is over is counted.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
    /// Errors among the items.
    kept_errors: usize,
    errors: usize,
    suppressed: usize,
}

impl Diagnostics {
    /// Errors kept; a reader should stop once [`Diagnostics::is_full`].
    pub const MAX_ERRORS: usize = 100;
    /// Warnings and notes kept.
    pub const MAX_OTHERS: usize = 400;

    /// Adds a message. One that was added before is not kept twice.
    pub fn push(&mut self, d: Diagnostic) {
        if !self.count(d.severity) || self.items.contains(&d) {
            return;
        }
        self.kept_errors += usize::from(d.severity == Severity::Error);
        self.items.push(d);
    }

    /// Counts a message that arose; says whether there is room to keep it.
    fn count(&mut self, severity: Severity) -> bool {
        let room = self.has_room(severity);
        self.errors += usize::from(severity == Severity::Error);
        self.suppressed += usize::from(!room);
        room
    }

    /// True if a message would be kept.
    fn has_room(&self, severity: Severity) -> bool {
        match severity {
            Severity::Error => self.kept_errors < Self::MAX_ERRORS,
            Severity::Warning | Severity::Note => self.items.len() - self.kept_errors < Self::MAX_OTHERS,
        }
    }

    fn add(
        &mut self,
        severity: Severity,
        fidelity: Option<Fidelity>,
        sources: &Sources,
        span: Option<Span>,
        message: impl Into<String>,
        help: Option<String>,
    ) {
        // Messages past the limit need no place and no text.
        if !self.has_room(severity) {
            self.count(severity);
            return;
        }
        let location = span.and_then(|s| sources.locate(s));
        self.push(Diagnostic { severity, fidelity, message: message.into(), location, help });
    }

    /// Adds an error.
    pub fn error(&mut self, sources: &Sources, span: Option<Span>, message: impl Into<String>) {
        self.add(Severity::Error, None, sources, span, message, None);
    }

    /// Adds an error with advice.
    pub fn error_help(
        &mut self,
        sources: &Sources,
        span: Option<Span>,
        message: impl Into<String>,
        help: Option<String>,
    ) {
        self.add(Severity::Error, None, sources, span, message, help);
    }

    /// Adds a warning.
    pub fn warn(&mut self, sources: &Sources, span: Option<Span>, message: impl Into<String>) {
        self.add(Severity::Warning, None, sources, span, message, None);
    }

    /// Adds a note.
    pub fn note(&mut self, sources: &Sources, span: Option<Span>, message: impl Into<String>) {
        self.add(Severity::Note, None, sources, span, message, None);
    }

    /// Reports that something is rendered as the nearest thing there is.
    pub fn approximated(&mut self, sources: &Sources, span: Option<Span>, message: impl Into<String>) {
        self.add(Severity::Warning, Some(Fidelity::Approximated), sources, span, message, None);
    }

    /// Reports that something is rendered as the nearest thing there is, with advice.
    pub fn approximated_help(
        &mut self,
        sources: &Sources,
        span: Option<Span>,
        message: impl Into<String>,
        help: Option<String>,
    ) {
        self.add(Severity::Warning, Some(Fidelity::Approximated), sources, span, message, help);
    }

    /// Reports that something is left out.
    pub fn dropped(&mut self, sources: &Sources, span: Option<Span>, message: impl Into<String>) {
        self.add(Severity::Warning, Some(Fidelity::Dropped), sources, span, message, None);
    }

    /// Reports a parameter that nothing reads, with the nearest known name.
    pub fn unused(&mut self, sources: &Sources, span: Option<Span>, message: impl Into<String>, help: Option<String>) {
        self.add(Severity::Warning, Some(Fidelity::Unused), sources, span, message, help);
    }

    /// True if there is any error.
    pub fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// Number of errors that arose, kept or not.
    pub fn error_count(&self) -> usize {
        self.errors
    }

    /// True if no more errors are kept.
    pub fn is_full(&self) -> bool {
        self.errors >= Self::MAX_ERRORS
    }

    /// Messages that were not kept.
    pub fn suppressed(&self) -> usize {
        self.suppressed
    }

    /// The messages.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.items.iter()
    }

    /// True if there is no message.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// True if something was approximated or dropped (`--strict` refuses such scenes).
    pub fn is_lossy(&self) -> bool {
        self.items.iter().any(|d| matches!(d.fidelity, Some(Fidelity::Approximated | Fidelity::Dropped)))
    }

    /// Appends the messages of another load.
    pub fn extend(&mut self, other: Self) {
        self.suppressed += other.suppressed;
        self.errors += other.errors - other.kept_errors;
        for d in other.items {
            self.push(d);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn message_shows_line_and_caret() {
        let mut sources = Sources::default();
        let file = sources.add("a.pbrt", b"Film \"rgb\"\nMaterial \"difuse\"\n".to_vec());
        let mut ds = Diagnostics::default();
        let help = Some("did you mean 'diffuse'?".into());
        ds.error_help(&sources, Some(Span::new(file, 20, 28)), "unknown material 'difuse'", help);
        let text = ds.iter().next().unwrap().to_string();
        assert_eq!(
            text,
            "error: unknown material 'difuse'\n --> a.pbrt:2:10\n  |\n2 | Material \"difuse\"\n  |          ^^^^^^^^\n  = help: did you mean 'diffuse'?"
        );
    }

    #[test]
    fn errors_are_capped_but_counted() {
        let mut ds = Diagnostics::default();
        for i in 0..250 {
            ds.error(&Sources::default(), None, format!("fault {i}"));
        }
        assert_eq!((ds.iter().count(), ds.error_count(), ds.suppressed()), (100, 250, 150));
    }
    #[test]
    fn other_messages_are_capped_after_many_errors() {
        let mut ds = Diagnostics::default();
        for i in 0..5000 {
            ds.error(&Sources::default(), None, format!("fault {i}"));
            ds.warn(&Sources::default(), None, format!("doubt {i}"));
        }
        assert_eq!(ds.iter().count(), Diagnostics::MAX_ERRORS + Diagnostics::MAX_OTHERS);
        assert_eq!((ds.error_count(), ds.suppressed()), (5000, 10_000 - 500));
        let mut joined = Diagnostics::default();
        joined.extend(ds);
        assert_eq!((joined.error_count(), joined.suppressed()), (5000, 10_000 - 500));
    }

    /// A flood of messages about one huge line takes no scan of the file for each, which would not come to an end.
    #[test]
    fn messages_are_placed_without_scanning_the_file() {
        let mut sources = Sources::default();
        let file = sources.add("huge.pbrt", vec![b'1'; 64 << 20]);
        let mut ds = Diagnostics::default();
        for i in 0..1_000_000 {
            ds.warn(&sources, Some(Span::new(file, (64 << 20) - i - 1, 64 << 20)), "doubt");
        }
        assert_eq!(ds.iter().next().unwrap().location.as_ref().unwrap().column, 64 << 20);
    }
}

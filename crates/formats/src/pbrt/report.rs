//! Diagnostics with the sources they point into, bounded in time as well as in number.

use std::collections::HashSet;
use steradian_scene::{Diagnostic, Diagnostics, Severity, Sources, Span, names};

/// Collects messages while a scene is read.
///
/// Finding the line of a span costs a pass over the file, so messages over the caps of [`Diagnostics`] are counted but
/// not located: a million faults in a large file must not take a million passes.
#[derive(Debug, Default)]
pub(super) struct Report {
    pub sources: Sources,
    pub diagnostics: Diagnostics,
    others: usize,
    said: HashSet<String>,
}

impl Report {
    /// True if reading should stop.
    pub fn is_full(&self) -> bool {
        self.diagnostics.is_full()
    }

    pub fn error(&mut self, span: Span, message: impl Into<String>) {
        self.error_help(span, message, None);
    }

    pub fn error_help(&mut self, span: Span, message: impl Into<String>, help: Option<String>) {
        if self.is_full() {
            self.count(Severity::Error, message.into());
        } else {
            self.diagnostics.error_help(&self.sources, Some(span), message, help);
        }
    }

    /// An error about the scene as a whole.
    pub fn error_nowhere(&mut self, message: impl Into<String>) {
        self.diagnostics.error(&self.sources, None, message);
    }

    pub fn warn(&mut self, span: Span, message: impl Into<String>) {
        match self.others_fit() {
            true => self.diagnostics.warn(&self.sources, Some(span), message),
            false => self.count(Severity::Warning, message.into()),
        }
    }

    pub fn note(&mut self, span: Span, message: impl Into<String>) {
        match self.others_fit() {
            true => self.diagnostics.note(&self.sources, Some(span), message),
            false => self.count(Severity::Note, message.into()),
        }
    }

    /// Notes a parameter that is understood but not followed, once for all places where the same message holds.
    pub fn no_effect(&mut self, span: Span, what: &str, why: &str) {
        let message = format!("{what} has no effect: {why}");
        if self.first_time(&message) {
            self.note(span, message);
        }
    }

    /// The help is looked for only where the message is kept.
    pub fn unused(&mut self, span: Span, message: String, help: impl FnOnce() -> Option<String>) {
        match self.others_fit() {
            true => self.diagnostics.unused(&self.sources, Some(span), message, help()),
            false => self.count(Severity::Warning, message),
        }
    }

    /// Reports a stand-in, once for all places where the same message holds.
    pub fn approximated(&mut self, span: Span, message: impl Into<String>) {
        let message = message.into();
        if self.first_time(&message) {
            self.diagnostics.approximated(&self.sources, Some(span), message);
        }
    }

    /// Reports something left out, once for all places where the same message holds.
    pub fn dropped(&mut self, span: Span, message: impl Into<String>) {
        let message = message.into();
        if self.first_time(&message) {
            self.diagnostics.dropped(&self.sources, Some(span), message);
        }
    }

    /// True the first time that this message is given; for messages that would otherwise repeat all over a file.
    pub fn first_time(&mut self, message: &str) -> bool {
        self.said.len() < Diagnostics::MAX_OTHERS && self.said.insert(message.to_string())
    }

    /// `did you mean 'x'?` over names that the file defines, of which only so many are compared, and only for errors
    /// that are kept.
    pub fn did_you_mean<'a>(&self, name: &str, defined: impl IntoIterator<Item = &'a str>) -> Option<String> {
        if self.is_full() { None } else { names::did_you_mean(name, defined.into_iter().take(1000)) }
    }

    fn others_fit(&mut self) -> bool {
        self.others += 1;
        self.others <= Diagnostics::MAX_OTHERS
    }

    fn count(&mut self, severity: Severity, message: String) {
        self.diagnostics.push(Diagnostic { severity, fidelity: None, message, location: None, help: None });
    }
}

//! Messages of readers and compiler, told on stderr and counted.

use crate::terminal::{Event, Terminal, Tint};
use serde::Serialize;
use std::collections::HashMap;
use steradian::scene::{Diagnostic, Diagnostics, Fidelity, Severity};

/// Number of messages of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// The scene cannot be rendered.
    pub errors: usize,
    /// The nearest thing stands in.
    pub approximated: usize,
    /// Left out.
    pub dropped: usize,
    /// Read by nothing.
    pub unused: usize,
    /// Other warnings.
    pub warnings: usize,
    /// Notes.
    pub notes: usize,
    /// Messages beyond those that are kept.
    pub suppressed: usize,
}

impl Counts {
    /// Counts messages.
    pub fn of(diagnostics: &Diagnostics) -> Self {
        let mut counts = Self { suppressed: diagnostics.suppressed(), ..Self::default() };
        for d in diagnostics.iter() {
            *match (d.severity, d.fidelity) {
                (Severity::Error, _) => &mut counts.errors,
                (_, Some(Fidelity::Approximated)) => &mut counts.approximated,
                (_, Some(Fidelity::Dropped)) => &mut counts.dropped,
                (_, Some(Fidelity::Unused)) => &mut counts.unused,
                (Severity::Warning, None) => &mut counts.warnings,
                (Severity::Note, None) => &mut counts.notes,
            } += 1;
        }
        counts
    }
}

/// True if `--strict` refuses the loss that this message is about.
fn is_lossy(d: &Diagnostic) -> bool {
    d.fidelity.is_some()
}

/// Turns what was approximated, dropped or not used into errors.
pub fn refuse_losses(diagnostics: &Diagnostics) -> Diagnostics {
    let mut refused = Diagnostics::default();
    for d in diagnostics.iter() {
        let mut d = d.clone();
        if is_lossy(&d) && d.severity != Severity::Error {
            let how = match d.fidelity {
                Some(Fidelity::Unused) => "unused",
                Some(Fidelity::Dropped) => "dropped",
                _ => "approximated",
            };
            d.message = format!("{} ({how}, which --strict refuses)", d.message);
            d.severity = Severity::Error;
        }
        refused.push(d);
    }
    refused
}

/// Most errors that are told of those that differ in nothing but their place. Of other messages one is told, and how
/// many there are.
const ERRORS: usize = 5;

/// Tells the messages; only errors when the terminal is quiet.
pub fn tell(diagnostics: &Diagnostics, terminal: Terminal) {
    let alike = |d: &'_ Diagnostic| (d.severity == Severity::Error, d.message.clone());
    let mut counts: HashMap<(bool, String), usize> = HashMap::new();
    diagnostics.iter().for_each(|d| *counts.entry(alike(d)).or_default() += 1);
    let mut told: HashMap<(bool, String), usize> = HashMap::new();
    for d in diagnostics.iter() {
        let is_error = d.severity == Severity::Error;
        let most = if is_error { ERRORS } else { 1 };
        let times = told.entry(alike(d)).or_default();
        *times += 1;
        if *times > most {
            continue;
        }
        let mut text = painted(d, terminal);
        let more = counts[&alike(d)].saturating_sub(most);
        if *times == most && more > 0 {
            let places = if more == 1 { "place" } else { "places" };
            text += &format!("\n  = and at {more} more {places} (`steradian info --json` has them all)");
        }
        if is_error || !terminal.quiet {
            terminal.tell(&Event::Diagnostic(d), || text);
        }
    }
    if diagnostics.suppressed() > 0 {
        terminal.say(&format!("… and {} further messages that were not kept", diagnostics.suppressed()));
    }
}

/// A message with its kind, its place and its carets in colour.
fn painted(d: &Diagnostic, terminal: Terminal) -> String {
    let tint = match d.severity {
        Severity::Error => Tint::Error,
        Severity::Warning => Tint::Warning,
        Severity::Note => Tint::Note,
    };
    let text = d.to_string();
    let lines: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(i, line)| match (i, line.split_once(": "), line.rsplit_once("| ")) {
            (0, Some((kind, message)), _) => {
                format!("{}: {}", terminal.paint(tint, kind), terminal.paint(Tint::Bold, message))
            }
            (_, _, Some((bar, marks))) if !marks.trim().is_empty() && marks.trim().chars().all(|c| c == '^') => {
                format!("{bar}| {}", terminal.paint(tint, marks))
            }
            _ => line.to_owned(),
        })
        .collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::scene::Sources;

    fn mixed() -> Diagnostics {
        let sources = Sources::default();
        let mut d = Diagnostics::default();
        d.error(&sources, None, "e");
        d.approximated(&sources, None, "a");
        d.dropped(&sources, None, "d");
        d.unused(&sources, None, "u", None);
        d.warn(&sources, None, "w");
        d.note(&sources, None, "n");
        d
    }

    #[test]
    fn every_kind_is_counted() {
        let one_each =
            Counts { errors: 1, approximated: 1, dropped: 1, unused: 1, warnings: 1, notes: 1, suppressed: 0 };
        assert_eq!(Counts::of(&mixed()), one_each);
    }

    #[test]
    fn strict_makes_losses_errors() {
        let strict = refuse_losses(&mixed());
        let counts = Counts::of(&strict);
        assert_eq!((counts.errors, counts.approximated, counts.dropped, counts.unused), (4, 0, 0, 0));
        assert!(strict.iter().any(|d| d.message == "a (approximated, which --strict refuses)"));
        assert!(strict.iter().any(|d| d.message == "u (unused, which --strict refuses)"));
    }
}

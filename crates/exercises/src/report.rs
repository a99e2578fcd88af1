//! The verdict on an answer, for people and for programs.

use crate::program::shortened;
use serde::Serialize;
use std::fmt;

/// Lines of a program's own output that are shown.
const PRINTED: usize = 12;

/// The verdict on a folder.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Version of this form.
    pub schema: u32,
    /// Name of the exercise.
    pub exercise: &'static str,
    /// `python` or `rust`.
    pub language: &'static str,
    /// True if all functions are right and all laws hold.
    pub passed: bool,
    /// Reason for which the program could not be asked, or not to the end.
    pub fault: Option<String>,
    /// A verdict for each function.
    pub functions: Vec<OfFunction>,
    /// A verdict for each law; none where a function that it is about is wrong.
    pub laws: Vec<OfLaw>,
    /// Beginning of what the program printed for its author.
    pub printed: String,
}

/// The verdict on a function.
#[derive(Debug, Serialize)]
pub struct OfFunction {
    /// Its name.
    pub function: &'static str,
    /// `right`, `answered` (the laws judge), `wrong`, `not written`, `error` or `not asked`.
    pub verdict: &'static str,
    /// Points at which it was asked, and at which it is right.
    pub points: usize,
    /// Points at which it is right.
    pub right: usize,
    /// Key of the mistake that explains the values.
    pub mistake: Option<&'static str>,
    /// Words on it.
    pub text: String,
}

/// The verdict on a law.
#[derive(Debug, Serialize)]
pub struct OfLaw {
    /// The law.
    pub law: &'static str,
    /// True if it holds.
    pub holds: bool,
    /// Key of the mistake that breaks it.
    pub mistake: Option<&'static str>,
    /// Measured values, or what is wrong.
    pub text: String,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(fault) = &self.fault {
            writeln!(f, "{fault}")?;
        }
        for of in &self.functions {
            match of.verdict {
                "right" => writeln!(f, "{}: right at all {} points", of.function, of.points)?,
                "answered" => writeln!(f, "{}: many answers are right; the laws judge", of.function)?,
                "wrong" => writeln!(f, "{}: wrong at {} of {} points", of.function, of.points - of.right, of.points)?,
                verdict => writeln!(f, "{}: {verdict}", of.function)?,
            }
            indented(f, &of.text)?;
        }
        for of in &self.laws {
            writeln!(f, "{}: {}", of.law, if of.holds { "holds" } else { "BROKEN" })?;
            indented(f, &of.text)?;
        }
        if !self.printed.is_empty() {
            writeln!(f, "the program printed:")?;
            indented(f, &shortened(&self.printed, PRINTED))?;
        }
        write!(f, "{}: {}", self.exercise, if self.passed { "passed" } else { "not passed yet" })
    }
}

fn indented(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    text.lines().try_for_each(|line| writeln!(f, "    {line}"))
}

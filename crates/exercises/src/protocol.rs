//! The line protocol between the checker and a learner's program.
//!
//! ```text
//! question   NAME number number …
//! reply      ok number number …      the answer
//!            todo                    the gap is not filled
//!            error TEXT              the function failed; \n and \\ are escaped
//!            broken TEXT             the file cannot be loaded; the last line
//! ```

use crate::exercise::{Exercise, Function, shape};

/// A function at a point.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    pub function: &'static Function,
    pub inputs: Vec<f64>,
}

/// A line of the program's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Reply {
    Numbers(Vec<f64>),
    NotWritten,
    Error(String),
    Broken(String),
}

impl Question {
    /// The line that asks it.
    pub fn line(&self) -> String {
        let numbers = self.inputs.iter().map(|x| format!(" {x:?}"));
        format!("{}{}\n", self.function.name, numbers.collect::<String>())
    }
}

impl Reply {
    /// The reply in a line; `None` if the line is none.
    pub fn parse(line: &str) -> Option<Self> {
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        match word {
            "ok" => rest.split_whitespace().map(|x| x.parse().ok()).collect::<Option<_>>().map(Self::Numbers),
            "todo" => Some(Self::NotWritten),
            "error" => Some(Self::Error(unescaped(rest))),
            "broken" => Some(Self::Broken(unescaped(rest))),
            _ => None,
        }
    }
}

fn unescaped(text: &str) -> String {
    let mut out = String::new();
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        match letter {
            '\\' if letters.next() == Some('n') => out.push('\n'),
            other => out.push(other),
        }
    }
    out
}

/// The file that answers in Python.
pub(crate) fn python(exercise: &Exercise) -> String {
    let shapes = exercise.functions.iter().map(|f| {
        let counts: Vec<String> = f.inputs.iter().map(|i| shape(i).1.to_string()).collect();
        format!("    \"{}\": [{}],\n", f.name, counts.join(", "))
    });
    include_str!("../templates/protocol.py").replace("    # SHAPES\n", &shapes.collect::<String>())
}

/// The file that answers in Rust.
pub(crate) fn rust(exercise: &Exercise) -> String {
    let calls = exercise.functions.iter().map(|f| {
        let mut first = 0;
        let arguments = f.inputs.iter().map(|input| {
            let count = shape(input).1;
            let numbers: Vec<String> = (first..first + count).map(|i| format!("a[{i}]")).collect();
            first += count;
            if count == 1 { numbers.concat() } else { format!("[{}]", numbers.join(", ")) }
        });
        let arguments = arguments.collect::<Vec<_>>().join(", ");
        format!("        \"{}\" => answer::{}({arguments}).numbers(),\n", f.name, f.name)
    });
    include_str!("../templates/main.rs").replace("        // CALLS\n", &calls.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_replies_or_not() {
        assert_eq!(Reply::parse("ok 1 -2.5e3 inf"), Some(Reply::Numbers(vec![1.0, -2500.0, f64::INFINITY])));
        assert_eq!(Reply::parse("todo"), Some(Reply::NotWritten));
        assert_eq!(Reply::parse(r"error a\nb \\n"), Some(Reply::Error("a\nb \\n".into())));
        for line in ["", "0.5", "ok one", "debug: 3"] {
            assert_eq!(Reply::parse(line), None, "{line}");
        }
    }
}

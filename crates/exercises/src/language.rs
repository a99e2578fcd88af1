//! Languages of exercises: their files, and gaps cut out of solutions.

use crate::{exercise::Exercise, protocol};

/// A language in which exercises are done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// Python 3 without packages.
    Python,
    /// Rust without crates.
    Rust,
}

impl Language {
    /// All languages.
    pub const ALL: [Self; 2] = [Self::Python, Self::Rust];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Python => "python",
            Self::Rust => "rust",
        }
    }

    /// The language of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|l| l.name() == name)
    }

    /// The file that the learner fills.
    pub(crate) fn answer(self) -> &'static str {
        match self {
            Self::Python => "answer.py",
            Self::Rust => "src/answer.rs",
        }
    }

    /// Files of an exercise besides its README: paths in the folder, and texts.
    pub(crate) fn files(self, exercise: &Exercise, is_solved: bool) -> Vec<(&'static str, String)> {
        let answer = |text: &str| if is_solved { solved(text) } else { self.gapped(text) };
        match self {
            Self::Python => {
                vec![("answer.py", answer(exercise.texts.python)), ("protocol.py", protocol::python(exercise))]
            }
            Self::Rust => vec![
                ("src/answer.rs", answer(exercise.texts.rust)),
                ("src/main.rs", protocol::rust(exercise)),
                ("Cargo.toml", include_str!("../templates/Cargo.toml.txt").replace("NAME", exercise.name)),
            ],
        }
    }

    /// A solution with gaps in place of the lines between `gap` and `end`.
    fn gapped(self, solution: &str) -> String {
        let (comment, gap) = match self {
            Self::Python => ("#", "raise NotImplementedError"),
            Self::Rust => ("//", "todo!()"),
        };
        let mut out = String::new();
        let mut is_in = false;
        for line in solution.lines() {
            let (text, indent) = (line.trim_start(), line.len() - line.trim_start().len());
            if text == format!("{comment} gap") {
                is_in = true;
                out += &format!("{}{comment} Your code.\n{}{gap}\n", " ".repeat(indent), " ".repeat(indent));
            } else if text == format!("{comment} end") {
                is_in = false;
            } else if !is_in {
                out += &format!("{line}\n");
            }
        }
        out
    }
}

/// A solution without the marks of its gaps.
pub(crate) fn solved(solution: &str) -> String {
    let is_mark = |line: &&str| matches!(line.trim(), "# gap" | "# end" | "// gap" | "// end");
    solution.lines().filter(|line| !is_mark(line)).map(|line| format!("{line}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_cut_out_of_solutions() {
        let solution = "def f(x):\n    \"\"\"Twice.\"\"\"\n    # gap\n    return 2 * x\n    # end\n";
        assert_eq!(
            Language::Python.gapped(solution),
            "def f(x):\n    \"\"\"Twice.\"\"\"\n    # Your code.\n    raise NotImplementedError\n"
        );
        assert_eq!(solved(solution), "def f(x):\n    \"\"\"Twice.\"\"\"\n    return 2 * x\n");
    }

    /// Each function has a gap of its own in both languages.
    #[test]
    fn every_function_has_a_gap() {
        for exercise in crate::EXERCISES {
            for (language, text, gap) in [
                (Language::Python, exercise.texts.python, "raise NotImplementedError"),
                (Language::Rust, exercise.texts.rust, "todo!()"),
            ] {
                let gaps = language.gapped(text).matches(gap).count();
                assert_eq!(gaps, exercise.functions.len(), "{} {}", exercise.name, language.name());
            }
        }
    }
}

//! An exercise as data.

/// Numbers in, numbers out.
pub(crate) type Values = fn(&[f64]) -> Vec<f64>;

/// An exercise: functions to write, and all that is needed to judge them.
#[derive(Debug)]
pub struct Exercise {
    /// Name on the command line.
    pub name: &'static str,
    /// Chapter of the course.
    pub chapter: u8,
    /// Title in a few words.
    pub title: &'static str,
    pub(crate) functions: &'static [Function],
    pub(crate) tolerance: Tolerance,
    pub(crate) mistakes: &'static [Mistake],
    pub(crate) laws: &'static [Law],
    pub(crate) texts: Texts,
}

/// Texts of an exercise; the gaps are cut out of the solutions.
#[derive(Debug)]
pub(crate) struct Texts {
    pub readme: &'static str,
    pub python: &'static str,
    pub rust: &'static str,
}

/// Texts of the exercise in the folder of this name.
macro_rules! texts {
    ($name:literal) => {
        $crate::exercise::Texts {
            readme: include_str!(concat!("../../exercises/", $name, "/README.md")),
            python: include_str!(concat!("../../exercises/", $name, "/solution.py")),
            rust: include_str!(concat!("../../exercises/", $name, "/solution.rs")),
        }
    };
}
pub(crate) use texts;

/// A function that the learner writes.
#[derive(Debug)]
pub(crate) struct Function {
    pub name: &'static str,
    /// Names of inputs; `wo[3]` is a vector of three numbers.
    pub inputs: &'static [&'static str],
    /// Names of the numbers that it gives.
    pub outputs: &'static [&'static str],
    /// The right values; none where many answers are right and the laws judge.
    pub reference: Option<Values>,
    /// Inputs at which it is asked, telling ones first.
    pub points: fn() -> Vec<Vec<f64>>,
}

/// Name and count of numbers of an input.
pub(crate) fn shape(input: &'static str) -> (&'static str, usize) {
    let split = input.strip_suffix(']').and_then(|text| text.split_once('['));
    split.and_then(|(name, count)| Some((name, count.parse().ok()?))).unwrap_or((input, 1))
}

/// Allowed difference from the reference: `relative · max(|right|, floor)`.
#[derive(Debug)]
pub(crate) struct Tolerance {
    pub relative: f64,
    pub floor: f64,
    /// Reason for its size, as the learner is told.
    pub reason: &'static str,
}

impl Tolerance {
    /// References in single precision, answers in double.
    pub const SINGLE: Self = Self {
        relative: 1e-3,
        floor: 1e-3,
        reason: "references are in single precision, and lose up to four digits where nearly equal numbers are \
        subtracted",
    };
    /// All in double precision.
    pub const DOUBLE: Self =
        Self { relative: 1e-6, floor: 1e-3, reason: "rounding in double precision, with a margin" };

    /// True if a number passes for the right one.
    pub fn holds(&self, given: f64, right: f64) -> bool {
        given == right || (given - right).abs() <= self.relative * right.abs().max(self.floor)
    }

    /// True if all numbers pass.
    pub fn all_hold(&self, given: &[f64], right: &[f64]) -> bool {
        given.len() == right.len() && given.iter().zip(right).all(|(g, r)| self.holds(*g, *r))
    }
}

/// A mistake that people make, with a hint that does not give the answer away.
#[derive(Debug)]
pub(crate) struct Mistake {
    /// Its name in reports for programs.
    pub key: &'static str,
    pub function: &'static str,
    pub hint: &'static str,
    pub wrong: Wrong,
}

impl Mistake {
    /// A mistake in the values of a function.
    pub const fn values(function: &'static str, key: &'static str, hint: &'static str, wrong: Values) -> Self {
        Self { key, function, hint, wrong: Wrong::Values(wrong) }
    }

    /// A mistake that shows in the mean of a function alone.
    pub const fn mean(function: &'static str, key: &'static str, hint: &'static str, wrong: f64) -> Self {
        Self { key, function, hint, wrong: Wrong::Mean(wrong) }
    }

    /// A mistake in the directions that a function draws.
    pub const fn density(function: &'static str, key: &'static str, hint: &'static str, wrong: Density) -> Self {
        Self { key, function, hint, wrong: Wrong::Density(wrong) }
    }
}

/// The consequence of a mistake.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Wrong {
    /// The values that the wrong function gives.
    Values(Values),
    /// The density (sr⁻¹) of the directions that a wrong sampler draws, by the arguments of the density.
    Density(Density),
    /// The mean that a wrong function of random numbers has, for the questions of its law.
    Mean(f64),
}

/// A density of directions `(x, y, z)` (sr⁻¹).
pub(crate) type Density = fn([f64; 3]) -> f64;

/// A law of one or more functions.
#[derive(Debug)]
pub(crate) struct Law {
    pub name: &'static str,
    /// Functions that it is about; it is judged if none of them is known to be wrong.
    pub functions: &'static [&'static str],
    pub questions: fn() -> Vec<Asked>,
    pub judge: fn(&Exercise, &[Vec<f64>]) -> Finding,
}

/// A function's name and inputs.
pub(crate) type Asked = (&'static str, Vec<f64>);

/// A law's verdict.
#[derive(Debug)]
pub(crate) struct Finding {
    pub holds: bool,
    /// The measured values, or what is wrong.
    pub text: String,
    /// Key of the mistake that explains it.
    pub mistake: Option<&'static str>,
}

impl Exercise {
    /// The function of this name.
    pub(crate) fn function(&self, name: &str) -> Option<&'static Function> {
        self.functions.iter().find(|f| f.name == name)
    }
}

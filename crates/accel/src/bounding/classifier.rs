//! Classes of geometric tests, measured: a test's answers against the truth.

/// Kinds of tests. A test is *positive* where it says that something may be there: is hit, is visible, overlaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Always right.
    Exact,
    /// Misses nothing, and says yes too often: what bounding volumes are.
    Conservative,
    /// Never says yes where there is nothing, and misses some.
    Aggressive,
    /// Errs on both sides.
    Approximate,
}

/// Counts of a test's right and wrong answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answers {
    /// It said yes, and so it is.
    pub true_positives: u64,
    /// It said no, and so it is.
    pub true_negatives: u64,
    /// It said yes where there is nothing.
    pub false_positives: u64,
    /// It said no where there is something.
    pub false_negatives: u64,
}

impl Answers {
    /// Adds an answer.
    pub fn add(&mut self, answer: bool, truth: bool) {
        *match (answer, truth) {
            (true, true) => &mut self.true_positives,
            (false, false) => &mut self.true_negatives,
            (true, false) => &mut self.false_positives,
            (false, true) => &mut self.false_negatives,
        } += 1;
    }

    /// Class of the test, by the answers so far.
    pub fn class(&self) -> Class {
        match (self.false_positives, self.false_negatives) {
            (0, 0) => Class::Exact,
            (_, 0) => Class::Conservative,
            (0, _) => Class::Aggressive,
            _ => Class::Approximate,
        }
    }

    /// The share of false answers among those where nothing is there, and among those where something is.
    pub fn error_rates(&self) -> [f64; 2] {
        let share = |wrong: u64, right: u64| if wrong == 0 { 0.0 } else { wrong as f64 / (wrong + right) as f64 };
        [share(self.false_positives, self.true_negatives), share(self.false_negatives, self.true_positives)]
    }
}

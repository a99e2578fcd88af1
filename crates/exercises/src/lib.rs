//! Exercises in rendering that are checked by running the learner's program.
//!
//! An [`Exercise`] names functions to write, a reference for each, the points at which it is asked, and mistakes that
//! people make, each as a wrong function with a hint. [`start`] writes a folder with gaps to fill, [`check`] builds
//! and asks the program in it and gives a [`Report`]:
//!
//! ```text
//! folder → program → process (questions in, replies out) → verdict (reference, mistakes) → laws → Report
//! ```

mod diagnosis;
mod exercise;
mod fault;
mod folder;
mod language;
mod laws;
mod numbers;
mod points;
mod process;
mod program;
mod protocol;
mod report;
mod tasks;
mod verdict;

pub use exercise::Exercise;
pub use fault::Fault;
pub use folder::start;
pub use language::Language;
pub use report::Report;
pub use tasks::{EXERCISES, find};
pub use verdict::check;

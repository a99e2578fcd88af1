//! Hostile input through the whole program: load, compile, render. Every case must end within bounds of time and memory, either with
//! errors that say what is wrong, or with a finite picture. Nothing may panic, abort, hang, or let a NaN reach a pixel.
//!
//! Tables of cases run in child processes of this test ([`bounded`]), so that a crash or a hang is one fault of one case, and time and
//! memory can be measured for each.
#![allow(clippy::print_stdout, reason = "tests say what they skipped and measured")]

mod bombs;
mod bounded;
mod case;
mod images;
mod meshes;
mod mitsuba;
mod models;
mod mutants;
mod pbrt;
mod pipeline;
mod vocabulary;

use case::Case;

/// A list of cases by name.
type Table = (&'static str, fn() -> Vec<Case>);

/// All tables that run in child processes.
const TABLES: &[Table] = &[
    ("pbrt-syntax", pbrt::syntax),
    ("pbrt-numbers", pbrt::numbers),
    ("pbrt-models", models::pbrt),
    ("mitsuba-syntax", mitsuba::syntax),
    ("mitsuba-numbers", mitsuba::numbers),
    ("mitsuba-models", models::mitsuba),
    ("meshes", meshes::table),
    ("images", images::table),
    ("bombs", bombs::table),
];

macro_rules! bounded_tables {
    ($($test:ident: $name:literal),* $(,)?) => {$(
        #[test]
        fn $test() {
            bounded::check($name);
        }
    )*

        #[test]
        fn every_table_is_tested() {
            let tested = [$($name),*];
            assert_eq!(TABLES.iter().map(|t| t.0).collect::<Vec<_>>(), tested);
        }
    };
}

bounded_tables! {
    pbrt_syntax: "pbrt-syntax",
    pbrt_numbers: "pbrt-numbers",
    pbrt_models: "pbrt-models",
    mitsuba_syntax: "mitsuba-syntax",
    mitsuba_numbers: "mitsuba-numbers",
    mitsuba_models: "mitsuba-models",
    mesh_files: "meshes",
    image_files: "images",
    bombs_and_floods: "bombs",
}

#[test]
#[ignore = "the child process of the tables above"]
fn child() {
    bounded::child();
}

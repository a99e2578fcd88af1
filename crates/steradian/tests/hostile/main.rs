//! Hostile input through the whole program: load, compile, render. Every case must end within bounds of time and
//! memory, either with errors that say what is wrong, or with a finite picture. Nothing may panic, abort, hang, or let
//! a NaN reach a pixel.
//!
//! Tables of cases run in child processes of this test ([`bounded`]), so that a crash or a hang is one fault of one
//! case, and time and memory can be measured for each.
#![expect(clippy::print_stdout, reason = "tests say what they skipped and measured")]

mod bombs;
mod bounded;
mod case;
mod endless;
mod exchange;
mod images;
mod meshes;
mod mitsuba;
mod models;
mod mutants;
mod pbrt;
mod pipeline;
mod vocabulary;

use case::Case;

/// A list of cases by name, made one after the other.
type Table = (&'static str, fn() -> Box<dyn Iterator<Item = Case>>);

/// All tables that run in child processes.
const TABLES: &[Table] = &[
    ("pbrt-syntax", || Box::new(pbrt::syntax().into_iter())),
    ("pbrt-numbers", || Box::new(pbrt::numbers().into_iter())),
    ("pbrt-models", || Box::new(models::pbrt().into_iter())),
    ("mitsuba-syntax", || Box::new(mitsuba::syntax().into_iter())),
    ("mitsuba-numbers", || Box::new(mitsuba::numbers().into_iter())),
    ("mitsuba-models", || Box::new(models::mitsuba().into_iter())),
    ("gltf", || Box::new(exchange::gltf())),
    ("usd", || Box::new(exchange::usd())),
    ("own language", || Box::new(exchange::own())),
    ("meshes", || Box::new(meshes::table().into_iter())),
    ("images", || Box::new(images::table().into_iter())),
    ("endless", || Box::new(endless::table().into_iter())),
    ("bombs", || Box::new(bombs::table().into_iter())),
    ("mutants", || Box::new(mutants::table())),
    ("vocabulary, odd", || Box::new(vocabulary::table().step_by(2))),
    ("vocabulary, even", || Box::new(vocabulary::table().skip(1).step_by(2))),
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
    gltf_documents: "gltf",
    usd_stages: "usd",
    scenes_in_our_own_language: "own language",
    mesh_files: "meshes",
    image_files: "images",
    light_that_is_never_lost: "endless",
    bombs_and_floods: "bombs",
    damaged_assets: "mutants",
    parameters_of_the_vocabulary: "vocabulary, odd",
    more_parameters_of_the_vocabulary: "vocabulary, even",
}

#[test]
fn mutants_that_are_left_out_are_named() {
    // Those that are not there are named, or refused where they must be.
    let (found, mutants) = (mutants::found(), mutants::table().count());
    assert_eq!(mutants > 0, found > 0, "{mutants} mutants of {found} files");
}

#[test]
#[ignore = "the child process of the tables above"]
fn child() {
    bounded::child();
}

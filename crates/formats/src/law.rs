//! The law that every parameter that readers know is followed or told: a value other than the default changes the
//! scene, or a message names it.

use crate::{Import, native};
use std::{borrow::Borrow, cell::RefCell, collections::BTreeSet, path::Path};
use steradian_scene::Severity;

/// A parameter that a reader asked for: of what, its name, and the types that it may have, where the reader says them.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Asked {
    pub of: String,
    pub name: &'static str,
    pub types: Vec<&'static str>,
}

thread_local! {
    static ASKED: RefCell<BTreeSet<Asked>> = RefCell::default();
}

/// Remembers a parameter that a reader asks for on this thread.
pub(crate) fn note(of: String, name: &'static str, types: Vec<&'static str>) {
    ASKED.with_borrow_mut(|asked| asked.insert(Asked { of, name, types }));
}

/// The parameters that readers asked for on this thread since this was last called.
pub(crate) fn asked() -> BTreeSet<Asked> {
    ASKED.take()
}

/// The outcome of reading a scene.
pub(crate) struct Reading {
    scene: String,
    messages: Vec<String>,
    pub is_refused: bool,
}

impl Reading {
    pub fn of(import: &Import) -> Self {
        // Places in files are not part of what is written.
        let written = native::write(&import.desc, Path::new("scene.steradian"));
        Self {
            scene: format!("{written:?}"),
            messages: import.diagnostics.iter().map(|d| format!("{}: {}", d.kind(), d.message)).collect(),
            is_refused: import.diagnostics.iter().any(|d| d.severity == Severity::Error),
        }
    }

    pub fn messages(&self) -> String {
        self.messages.join("\n")
    }
}

/// The outcome of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// All values are errors.
    Refused,
    /// No value that is read changes anything, nor does a message name it.
    Silent,
    Told,
    Followed,
}

/// The outcome of values beside a scene without the parameter.
pub(crate) fn outcome(name: &str, without: &Reading, with: impl IntoIterator<Item = impl Borrow<Reading>>) -> Outcome {
    let mut best = None;
    for reading in with {
        let reading = reading.borrow();
        let of = if reading.is_refused {
            None
        } else if reading.scene != without.scene {
            Some(Outcome::Followed)
        } else if reading.messages.iter().any(|m| m.contains(name) && !without.messages.contains(m)) {
            Some(Outcome::Told)
        } else {
            Some(Outcome::Silent)
        };
        best = best.max(of);
        if best == Some(Outcome::Followed) {
            break;
        }
    }
    best.unwrap_or(Outcome::Refused)
}

/// Most values of another parameter that are tried beside one.
const COMPANY: usize = 4;

/// The outcome of each parameter, given with its values: alone, else beside a value of another that makes it count.
pub(crate) fn outcomes<V: Clone>(parameters: &[(String, Vec<V>)], read: impl Fn(&[V]) -> Reading) -> Vec<Outcome> {
    let plain = read(&[]);
    let alone: Vec<Vec<(&V, Reading)>> = parameters
        .iter()
        .map(|(_, values)| {
            values.iter().map(|v| (v, read(std::slice::from_ref(v)))).filter(|(_, r)| !r.is_refused).collect()
        })
        .collect();
    let company: Vec<Vec<(&V, &Reading)>> = alone
        .iter()
        .map(|own| own.iter().filter(|(_, r)| r.scene != plain.scene).take(COMPANY).map(|(v, r)| (*v, r)).collect())
        .collect();
    let of = |index: usize| {
        let (name, values) = &parameters[index];
        let mut best = outcome(name, &plain, alone[index].iter().map(|(_, r)| r));
        for (v, without) in company.iter().enumerate().filter(|(other, _)| *other != index).flat_map(|(_, c)| c) {
            if best >= Outcome::Told {
                break;
            }
            let beside: Vec<Reading> = values.iter().map(|own| read(&[(*v).clone(), own.clone()])).collect();
            best = best.max(outcome(name, without, &beside));
        }
        best
    };
    (0..parameters.len()).map(of).collect()
}

/// Fails where parameters are silent, or where so few were tried that the law holds nothing.
#[expect(clippy::print_stdout, reason = "says the counts")]
pub(crate) fn judge(outcomes: &[(String, Outcome)], least: usize) {
    let of = |wanted: Outcome| outcomes.iter().filter(move |(_, o)| *o == wanted).map(|(name, _)| name.as_str());
    let [silent, refused, told, followed] =
        [Outcome::Silent, Outcome::Refused, Outcome::Told, Outcome::Followed].map(|o| of(o).collect::<Vec<_>>());
    let counts =
        format!("{} followed, {} told, {} refused, {} silent", followed.len(), told.len(), refused.len(), silent.len());
    println!("{counts}");
    assert!(silent.is_empty(), "{counts}; silent:\n{}\nrefused:\n{}", silent.join("\n"), refused.join("\n"));
    assert!(outcomes.len() >= least, "{counts}");
}

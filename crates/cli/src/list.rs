//! `steradian list`: everything that has a name.

use crate::{
    args::ListArgs,
    failure::{self, Failure, Outcome},
    terminal,
    values::known_name,
};
use serde::Serialize;
use std::fmt::Write;

/// One thing.
#[derive(Debug, Serialize)]
struct Entry {
    name: &'static str,
    description: &'static str,
}

/// Things of a kind.
#[derive(Debug, Serialize)]
struct Family {
    family: &'static str,
    entries: Vec<Entry>,
}

#[derive(Debug, Serialize)]
struct Listing<'a> {
    schema: u32,
    families: &'a [Family],
}

/// The registry, the built-in scenes, and the formats that are read.
fn families() -> Vec<Family> {
    let mut all = steradian::registry();
    all.push(("scenes", steradian::cornell::BUILTIN.to_vec()));
    all.push(("formats", steradian::load::EXTENSIONS.to_vec()));
    let entry = |(name, description)| Entry { name, description };
    all.into_iter().map(|(family, e)| Family { family, entries: e.into_iter().map(entry).collect() }).collect()
}

/// Prints one family or all.
pub fn run(args: &ListArgs) -> Outcome {
    let mut families = families();
    if let Some(wanted) = &args.family {
        let known = families.iter().map(|f| f.family);
        // The singular will do: `integrator`, `sampler`, also `medium`.
        let plural = known.clone().find(|k| k.strip_suffix('s') == Some(wanted)).unwrap_or(match wanted.as_str() {
            "medium" => "media",
            other => other,
        });
        let family = known_name(plural, "family", known).map_err(Failure::bad_input)?.to_owned();
        families.retain(|f| f.family == family);
    }
    if args.json {
        terminal::json(&Listing { schema: 1, families: &families })?;
    } else {
        terminal::data(text(&families).as_bytes())?;
    }
    Ok(failure::DONE)
}

fn text(families: &[Family]) -> String {
    let mut out = String::new();
    for (i, family) in families.iter().enumerate() {
        let width = family.entries.iter().map(|e| e.name.len()).max().unwrap_or(0);
        let _ = writeln!(out, "{}{}", if i > 0 { "\n" } else { "" }, family.family);
        for e in &family.entries {
            let _ = writeln!(out, "  {:width$}  {}", e.name, e.description);
        }
    }
    out
}

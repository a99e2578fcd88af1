//! `steradian list`: everything that has a name.

use crate::{
    args::ListArgs,
    failure::{self, Failure, Outcome},
    terminal,
};
use serde::Serialize;
use std::fmt::Write;
use steradian::{
    engine::Support,
    scene::{Family, names},
    schema::{self, FAMILIES, Parameter},
    support::{self, Answer},
};

/// One thing.
#[derive(Debug, Serialize)]
struct Entry {
    name: &'static str,
    description: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<Vec<Described>>,
}

/// A parameter.
#[derive(Debug, Serialize)]
struct Described {
    name: &'static str,
    values: String,
    unit: &'static str,
    range: [Option<f64>; 2],
    default: &'static str,
    description: String,
}

impl Described {
    fn new(p: &Parameter) -> Self {
        let bound = |v: f64| Some(v).filter(|v| v.is_finite());
        Self {
            name: p.name,
            values: p.values(),
            unit: p.unit,
            range: [bound(p.range.0), bound(p.range.1)],
            default: p.default,
            description: p.meaning(),
        }
    }
}

impl Entry {
    fn new(family: &str, name: &'static str, description: &'static str) -> Self {
        let family_of = FAMILIES.into_iter().find(|f| f.plural() == family);
        let model = family_of.and_then(|f| f.models().iter().find(|m| m.kind == name));
        let group = family_of.and_then(|f| f.groups().into_iter().find(|g| g.name == name));
        Self {
            name,
            description,
            source: model.map(|m| m.source).or(group.map(|g| g.source)),
            parameters: model
                .map(|m| m.parameters)
                .or(group.map(|g| g.parameters))
                .map(|p| p.iter().map(Described::new).collect()),
        }
    }
}

/// Things of a kind.
#[derive(Debug, Serialize)]
struct Listed {
    family: &'static str,
    entries: Vec<Entry>,
}

#[derive(Debug, Serialize)]
struct Listing<'a> {
    schema: u32,
    families: &'a [Listed],
}

/// The registry, the built-in scenes, and the formats that are read.
fn families() -> Vec<Listed> {
    let mut all = steradian::registry();
    all.push(("scenes", steradian::cornell::BUILTIN.to_vec()));
    all.push(("formats", steradian::load::extensions().collect()));
    all.into_iter()
        .map(|(family, entries)| Listed {
            family,
            entries: entries.into_iter().map(|(name, doc)| Entry::new(family, name, doc)).collect(),
        })
        .collect()
}

/// Prints one family or all.
pub fn run(args: &ListArgs) -> Outcome {
    if args.family.as_deref() == Some("limits") {
        return limits(args);
    }
    let mut families = families();
    if let Some(wanted) = &args.family {
        let known = families.iter().map(|f| f.family);
        // The singular will do: `integrator`, `sampler`, also `medium`.
        let plural = known.clone().find(|k| k.strip_suffix('s') == Some(wanted)).unwrap_or(match wanted.as_str() {
            "medium" => "media",
            other => other,
        });
        if known.clone().any(|k| k == plural) {
            families.retain(|f| f.family == plural);
        } else if families.iter().flat_map(|f| &f.entries).any(|e| e.name == wanted) {
            // A thing itself, wherever it is.
            families.iter_mut().for_each(|f| f.entries.retain(|e| e.name == wanted));
            families.retain(|f| !f.entries.is_empty());
        } else {
            return Err(Failure::bad_input(unknown(wanted, &families)));
        }
    }
    if args.markdown {
        let described = || FAMILIES.into_iter().filter(|f| !f.models().is_empty());
        let wanted = described().find(|f| matches!(&*families, [one] if one.family == f.plural()));
        let Some(family) = wanted else {
            let known = described().map(Family::plural).collect::<Vec<_>>().join(", ");
            let what = format!(
                "--markdown writes the page of one family ({known}), as in steradian list materials --markdown"
            );
            return Err(Failure::bad_input(what));
        };
        terminal::data(schema::page(family).as_bytes())?;
    } else if args.json {
        terminal::json(&Listing { schema: 1, families: &families })?;
    } else {
        terminal::data(text(&families, args.family.is_some()).as_bytes())?;
    }
    Ok(failure::DONE)
}

/// Features that not every integrator renders, and the answers of integrators to them.
fn limits(args: &ListArgs) -> Outcome {
    let failed = |e: steradian::Error| Failure::failed(e.to_string());
    if args.json {
        let answers = support::answers().map_err(failed)?;
        let of = |a: &Answer| {
            let [support, reason] = match a.support {
                Support::Exact => ["exact", ""],
                Support::Approximates(how) => ["approximates", how],
                Support::LeavesOut(why) => ["leaves out", why],
                Support::Refuses(why) => ["refuses", why],
            };
            serde_json::json!({
                "feature": a.feature.name(), "integrator": a.method, "support": support, "reason": reason
            })
        };
        terminal::json(&serde_json::json!({ "schema": 1, "limits": answers.iter().map(of).collect::<Vec<_>>() }))?;
    } else {
        terminal::data(support::page().map_err(failed)?.as_bytes())?;
    }
    Ok(failure::DONE)
}

/// Why a name is not listed: with the nearest family, or the nearest thing and where it is.
fn unknown(wanted: &str, families: &[Listed]) -> String {
    let known = families.iter().map(|f| f.family);
    let things = families.iter().flat_map(|f| f.entries.iter().map(|e| e.name));
    let near = names::did_you_mean(wanted, known.clone().chain(things)).map(|h| format!("; {h}")).unwrap_or_default();
    let known = known.collect::<Vec<_>>().join(", ");
    format!("there is no family '{wanted}', and nothing of that name{near} (families: {known})")
}

/// A line for each thing; with `details` also what is known of its parameters.
fn text(families: &[Listed], details: bool) -> String {
    let mut out = String::new();
    for (i, family) in families.iter().enumerate() {
        let width = family.entries.iter().map(|e| e.name.len()).max().unwrap_or(0);
        let _ = writeln!(out, "{}{}", if i > 0 { "\n" } else { "" }, family.family);
        for e in &family.entries {
            let _ = writeln!(out, "  {:width$}  {}", e.name, e.description);
            if details {
                describe(&mut out, e);
            }
        }
    }
    out
}

fn describe(out: &mut String, e: &Entry) {
    let parameters = e.parameters.as_deref().unwrap_or(&[]);
    let width = parameters.iter().map(|p| p.name.len()).max().unwrap_or(0);
    for p in parameters {
        let _ = writeln!(out, "      {:width$}  {} ({}; default {})", p.name, p.description, p.values, p.default);
    }
    if let Some(source) = e.source.filter(|s| !s.is_empty()) {
        let _ = writeln!(out, "      source: {source}");
    }
}

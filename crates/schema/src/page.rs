//! The tables as pages of documentation.

use crate::{Family, Model, Parameter};
use std::fmt::Write;

/// A page that describes the models of a family, in Markdown.
pub fn page(family: Family) -> String {
    let (title, list) = (capital(family.plural()), family.plural());
    let mut out = format!(
        "# {title}\n\nEvery kind of {} in Steradian's vocabulary, to which the readers of other formats translate. \
         This page is written by\n`steradian list {list} --markdown`. Values outside their range are reported, and \
         refused or held at its end.\n",
        family.noun()
    );
    if family == Family::Shape {
        out += "\nSome are in `scenes/shapes.steradian`: cone, paraboloid, hyperboloid and quadric, two of implicit, \
         polygon, bezier_patch.\n\n![shapes](shapes.jpg)\n";
    }
    for model in family.models() {
        let Model { kind, doc, parameters, source, .. } = model;
        section(&mut out, kind, doc, source, parameters);
        let shared = model.groups.iter().filter(|g| family.common().is_none_or(|c| !std::ptr::eq(**g, c)));
        let shared: Vec<_> = shared.map(|g| format!("[{0}](#{0})", g.name)).collect();
        if !shared.is_empty() {
            let _ = writeln!(out, "\nAlso: {}.", shared.join(", "));
        }
    }
    for group in family.groups() {
        section(&mut out, group.name, group.doc, group.source, group.parameters);
    }
    out
}

fn section(out: &mut String, name: &str, doc: &str, source: &str, parameters: &[Parameter]) {
    let _ = write!(out, "\n## `{name}`\n\n{}.\n", capital(doc));
    if !source.is_empty() {
        let _ = write!(out, "\nSource: {source}.\n");
    }
    if parameters.is_empty() {
        return;
    }
    *out += "\n| parameter | values | default | meaning |\n|---|---|---|---|\n";
    for p in parameters {
        let _ = writeln!(out, "| `{}` | {} | {} | {} |", p.name, p.values(), p.default, p.meaning());
    }
}

fn capital(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map(|c| c.to_uppercase().chain(rest).collect()).unwrap_or_default()
}

//! The table of which call is legal in which stage, made from the contexts, is the one that is written down.

use std::collections::BTreeSet;

const STAGES: [(&str, &str); 6] = [
    ("RayGenerationContext", "ray generation"),
    ("IntersectionContext", "intersection"),
    ("AnyHitContext", "any hit"),
    ("ClosestHitContext", "closest hit"),
    ("MissContext", "miss"),
    ("CallableContext", "callable"),
];

/// Pairs of context and method: from the lines `may!(what: contexts)`, whose macro says which methods they get, and
/// from the blocks `impl<I: Interface> Context<'_, I>`.
fn methods(source: &str) -> BTreeSet<(String, String)> {
    let mut found = BTreeSet::new();
    let (mut of, mut rule, mut all) = (String::new(), String::new(), false);
    let mut rules = Vec::new();
    for line in source.lines().map(str::trim) {
        if let Some((what, contexts)) = line.strip_prefix("may!(").and_then(|rest| rest.split_once(": ")) {
            let contexts = contexts.trim_end_matches(");").split(' ');
            for context in contexts {
                let methods = rules.iter().filter(|(rule, _)| rule == what).map(|(_, method): &(_, String)| method);
                found.extend(methods.map(|method| (context.to_owned(), method.clone())));
            }
        } else if let Some((what, _)) = line.strip_prefix('(').and_then(|rest| rest.split_once(": $($name")) {
            what.clone_into(&mut rule);
        } else if line.starts_with("macro_rules! contexts") {
            all = true;
        } else if line.starts_with("macro_rules! may") {
            all = false;
        } else if let Some(rest) = line.strip_prefix("impl") {
            let name = rest.split_once("> ").map_or("", |(_, rest)| rest);
            name.split('<').next().unwrap_or("").clone_into(&mut of);
        } else if let Some(rest) = line.strip_prefix("pub fn ") {
            let method = rest.split('(').next().unwrap_or("").to_owned();
            match of.as_str() {
                "$name" if all => found.extend(STAGES.map(|(context, _)| (context.to_owned(), method.clone()))),
                "$name" => rules.push((rule.clone(), method)),
                context => {
                    found.insert((context.to_owned(), method));
                }
            }
        }
    }
    found.retain(|(context, _)| STAGES.iter().any(|(name, _)| name == context));
    found
}

#[test]
fn the_table_of_legal_calls_is_that_of_the_code() {
    let found = methods(include_str!("../../src/context.rs"));
    let order = ["trace", "call", "report_hit", "accept_hit", "ignore_hit", "accept_hit_and_end_search"];
    let order = order.into_iter().chain(["launch", "local", "ray", "primitive", "hit_kind"]).collect::<Vec<_>>();
    for (_, method) in &found {
        assert!(order.contains(&method.as_str()), "{method} is not in the table");
    }
    let mut rows = vec![format!("| |{}", STAGES.map(|(_, stage)| format!(" {stage} |")).concat())];
    rows.push(format!("|{}", "---|".repeat(7)));
    for method in order {
        let mark = |context: &str| if found.contains(&(context.into(), method.into())) { " * |" } else { " |" };
        rows.push(format!("| `{method}` |{}", STAGES.map(|(context, _)| mark(context)).concat()));
    }
    let table = rows.join("\n");
    let docs = include_str!("../../../../docs/ray-tracing.md");
    assert!(docs.contains(&table), "docs/ray-tracing.md should have\n{table}");
    let commented = rows.join("\n//! ");
    assert!(include_str!("../../src/lib.rs").contains(&commented), "lib.rs should have\n//! {commented}");
}

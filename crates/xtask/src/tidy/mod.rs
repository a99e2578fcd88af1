//! `cargo xtask tidy`: how tidy the code is, in numbers that may only fall. Ceilings are in `tidy.json`; more than a
//! ceiling is an error, less is a reason to lower it (`--update`).

mod circles;
mod packages;
mod syntax;

use circles::circles;
use proc_macro2::{TokenStream, TokenTree};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    error::Error,
    fs,
    path::{Path, PathBuf},
};
use syn::{spanned::Spanned, visit::Visit};
use syntax::{is_test_item, used_paths};

/// Arguments that are too many, lines of a function, columns of a line, and lines of a crate that are still allowed.
const ARGUMENTS: usize = 8;
const FUNCTION: usize = 100;
const COLUMNS: usize = 120;
const CRATE: usize = 20_000;

/// Arguments of `tidy`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Write the counts as the new ceilings
    #[arg(long)]
    update: bool,
    /// List what is counted under these names
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    list: Vec<String>,
}

/// Findings under each name.
type Found = BTreeMap<&'static str, Vec<String>>;

/// Ceilings, public items that stay though only tests use them, and files that may use the system, with reasons.
#[derive(Debug, Default, Deserialize, Serialize)]
struct Baseline {
    ceilings: BTreeMap<String, usize>,
    public_items_that_stay: BTreeMap<String, String>,
    files_that_use_the_system: BTreeMap<String, String>,
}

/// Crates that face the user, who may be asked and told by way of the system.
const FACING: [&str; 6] = ["steradian", "cli", "python", "server", "xtask", "testkit"];

/// A source file.
struct Source {
    /// From the repository's root.
    path: PathBuf,
    krate: String,
    /// Names of the modules it is in, from the crate's root.
    modules: Vec<String>,
    text: String,
    parsed: syn::File,
    /// True if it is no test, example or benchmark.
    is_shipped: bool,
    /// True if it is an example, which uses what users use.
    is_example: bool,
}

/// Counts and compares.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let (found, mut baseline) = (counted()?, baseline()?);
    for (name, items) in &found {
        let ceiling = baseline.ceilings.get(*name).map_or("none".into(), usize::to_string);
        println!("{name}: {} (ceiling {ceiling})", items.len());
        if arguments.list.iter().any(|l| l == name) {
            items.iter().for_each(|item| println!("    {item}"));
        }
    }
    if arguments.update {
        baseline.ceilings = found.iter().map(|(name, items)| ((*name).to_owned(), items.len())).collect();
        return Ok(fs::write(path_of_baseline(), serde_json::to_string_pretty(&baseline)? + "\n")?);
    }
    match beyond(&found, &baseline) {
        complaints if complaints.is_empty() => Ok(()),
        complaints => Err(complaints.join("\n").into()),
    }
}

/// Findings beyond their ceilings.
fn beyond(found: &Found, baseline: &Baseline) -> Vec<String> {
    let ceiling = |name: &str| baseline.ceilings.get(name).copied().unwrap_or(0);
    let more = found.iter().filter(|(name, items)| items.len() > ceiling(name));
    more.map(|(name, items)| {
        format!("{name}: {} where {} are allowed:\n  {}", items.len(), ceiling(name), items.join("\n  "))
    })
    .collect()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn path_of_baseline() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tidy.json")
}

fn baseline() -> Result<Baseline, Box<dyn Error>> {
    Ok(serde_json::from_slice(&fs::read(path_of_baseline())?)?)
}

fn counted() -> Result<Found, Box<dyn Error>> {
    let sources = sources()?;
    let mut found = Found::new();
    for source in &sources {
        of_lines(source, &mut found);
        let mut functions = Functions { source, found: &mut found };
        functions.visit_file(&source.parsed);
    }
    found.insert("modules in circles", in_circles(&sources));
    found.insert("crates over 20000 lines", large(&sources));
    found.insert("unused dependencies", unused_dependencies(&sources)?);
    found.insert("faults of packages", packages::faults(&sources)?);
    let baseline = baseline()?;
    found.insert("public items used by tests alone", unused_items(&sources, &baseline));
    found.insert("uses of files, clock, environment or processes", uses_of_system(&sources, &baseline));
    for name in [
        "long lines",
        "functions of 8 arguments",
        "functions over 100 lines",
        "comments that begin 'The same'",
        "doc comments that begin with a clause",
    ] {
        found.entry(name).or_default();
    }
    Ok(found)
}

/// All Rust files of the crates.
fn sources() -> Result<Vec<Source>, Box<dyn Error>> {
    let mut sources = Vec::new();
    let mut folders = vec![root().join("crates")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                sources.push(Source::read(&path)?);
            }
        }
    }
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(sources)
}

impl Source {
    fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let text = fs::read_to_string(path)?;
        let parsed = syn::parse_file(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        let path = path.strip_prefix(root())?.to_owned();
        let parts: Vec<String> = path.with_extension("").iter().map(|p| p.to_string_lossy().into_owned()).collect();
        // crates/NAME/src/MODULE/…
        let (krate, folder) = (parts[1].clone(), parts[2].as_str());
        let is_test = |name: &String| name == "tests" || name.ends_with("_tests") || name.starts_with("test_");
        let is_shipped = folder == "src" && !parts[3..].iter().any(is_test) && krate != "testkit";
        let modules = parts[3..].iter().filter(|p| !["mod", "lib", "main"].contains(&p.as_str())).cloned().collect();
        let is_example = folder == "examples";
        Ok(Self { path, krate, modules, text, parsed, is_shipped, is_example })
    }
}

/// First words of doc comments that describe an item by a relative clause, and so lack its noun.
const CLAUSES: [&str; 7] = ["What", "Whether", "How", "Where", "Of", "That", "Those"];

/// The text of a doc comment's line.
fn doc(line: &str) -> Option<&str> {
    let line = line.trim_start();
    line.strip_prefix("///").or(line.strip_prefix("//!"))
}

/// Lines of a text that are not comments alone.
fn code_lines<'t>(lines: impl Iterator<Item = &'t str>) -> usize {
    lines.filter(|line| !line.trim_start().starts_with("//")).count()
}

/// Lines that are too long, comments that say what they are by what they are not, and doc comments without a noun.
fn of_lines(source: &Source, found: &mut Found) {
    let mut is_within = false;
    for (number, line) in (1..).zip(source.text.lines()) {
        let place = || format!("{}:{number}", source.path.display());
        if line.chars().count() > COLUMNS {
            found.entry("long lines").or_default().push(place());
        }
        if doc(line).is_some_and(|c| c.starts_with(" The same")) {
            found.entry("comments that begin 'The same'").or_default().push(place());
        }
        let first = doc(line).filter(|_| !is_within).and_then(|c| c.split_whitespace().next());
        if first.is_some_and(|word| CLAUSES.contains(&word)) {
            found.entry("doc comments that begin with a clause").or_default().push(place());
        }
        is_within = doc(line).is_some();
    }
}

/// Functions with many arguments or lines.
struct Functions<'a> {
    source: &'a Source,
    found: &'a mut Found,
}

impl Functions<'_> {
    fn add(&mut self, attributes: &[syn::Attribute], signature: &syn::Signature, body: Option<&syn::Block>) {
        let line = signature.ident.span().start().line;
        let place = || format!("{}:{line} {}", self.source.path.display(), signature.ident);
        // Python gives these by their names.
        let is_python = attributes.iter().any(|attribute| attribute.path().is_ident("pyo3"));
        if signature.inputs.len() >= ARGUMENTS && !is_python {
            self.found.entry("functions of 8 arguments").or_default().push(place());
        }
        // Comments tell the algorithm, and do not count.
        let end = body.map_or(line, |body| body.span().end().line);
        let lines = code_lines(self.source.text.lines().skip(line - 1).take(end - line + 1));
        if lines > FUNCTION {
            self.found.entry("functions over 100 lines").or_default().push(format!("{}, {lines} lines", place()));
        }
    }
}

impl<'ast> Visit<'ast> for Functions<'_> {
    fn visit_item_fn(&mut self, f: &'ast syn::ItemFn) {
        self.add(&f.attrs, &f.sig, Some(&f.block));
        syn::visit::visit_item_fn(self, f);
    }

    fn visit_impl_item_fn(&mut self, f: &'ast syn::ImplItemFn) {
        self.add(&f.attrs, &f.sig, Some(&f.block));
        syn::visit::visit_impl_item_fn(self, f);
    }

    fn visit_trait_item_fn(&mut self, f: &'ast syn::TraitItemFn) {
        self.add(&f.attrs, &f.sig, f.default.as_ref());
        syn::visit::visit_trait_item_fn(self, f);
    }
}

/// Modules of the crates that depend on each other.
fn in_circles(sources: &[Source]) -> Vec<String> {
    let mut crates: BTreeMap<&str, Vec<(&[String], &syn::File)>> = BTreeMap::new();
    for source in sources.iter().filter(|s| s.is_shipped) {
        crates.entry(&source.krate).or_default().push((&source.modules, &source.parsed));
    }
    let named = |krate, modules: Vec<String>| modules.into_iter().map(move |module| format!("{krate}: {module}"));
    crates.into_iter().flat_map(|(krate, files)| named(krate, circles(&files))).collect()
}

/// Uses of files, the clock, the environment or processes in a crate below the façade, outside the files that are there
/// for it: its results then depend on more than its inputs.
fn uses_of_system(sources: &[Source], baseline: &Baseline) -> Vec<String> {
    let mut used = Vec::new();
    for source in sources.iter().filter(|s| s.is_shipped && !FACING.contains(&s.krate.as_str())) {
        let path = source.path.display().to_string();
        if !baseline.files_that_use_the_system.contains_key(&path) {
            System { path: &path, used: &mut used }.visit_file(&source.parsed);
        }
    }
    used
}

/// Names of the system's modules, types and of methods of paths, in what is not a test.
struct System<'a> {
    path: &'a str,
    used: &'a mut Vec<String>,
}

impl System<'_> {
    fn add(&mut self, names: &[String]) {
        let is_clock = || names.iter().any(|n| n == "Instant" || n == "SystemTime");
        let of_std = names.first().is_some_and(|n| n == "std");
        let module = names.get(1).map(String::as_str);
        if of_std && (matches!(module, Some("fs" | "env" | "process")) || module == Some("time") && is_clock()) {
            self.used.push(format!("{}: {}", self.path, names.join("::")));
        }
    }
}

impl<'ast> Visit<'ast> for System<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !is_test_item(item) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        used_paths(&item.tree, &mut |names, _| self.add(names));
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        self.add(&names);
        syn::visit::visit_path(self, path);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let name = call.method.to_string();
        let of_paths = ["canonicalize", "exists", "is_dir", "is_file", "read_dir", "symlink_metadata", "try_exists"];
        if call.args.is_empty() && of_paths.contains(&name.as_str()) {
            self.used.push(format!("{}: .{name}()", self.path));
        }
        syn::visit::visit_expr_method_call(self, call);
    }
}

/// Crates with more lines of code than are good for one.
fn large(sources: &[Source]) -> Vec<String> {
    let mut lines: BTreeMap<&str, usize> = BTreeMap::new();
    for source in sources.iter().filter(|s| s.is_shipped) {
        *lines.entry(&source.krate).or_default() += code_lines(source.text.lines());
    }
    lines.into_iter().filter(|(_, n)| *n > CRATE).map(|(krate, n)| format!("{krate}: {n} lines")).collect()
}

/// Dependencies that no file of their crate names.
fn unused_dependencies(sources: &[Source]) -> Result<Vec<String>, Box<dyn Error>> {
    let mut unused = Vec::new();
    let mut names: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    for source in sources {
        let names = names.entry(&source.krate).or_default();
        collect(quote::ToTokens::to_token_stream(&source.parsed), &mut |name| _ = names.insert(name));
    }
    for entry in fs::read_dir(root().join("crates"))? {
        let folder = entry?.path();
        let krate = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let manifest = fs::read_to_string(folder.join("Cargo.toml"))?;
        let mut is_in = false;
        for line in manifest.lines() {
            if line.starts_with('[') {
                is_in = line.ends_with("dependencies]");
            }
            let name = line.split(['.', ' ', '=']).next().unwrap_or_default();
            if !is_in || name.is_empty() || line.starts_with(['[', '#']) {
                continue;
            }
            let is_named = names.get(&*krate).is_some_and(|names| names.contains(&name.replace('-', "_")));
            if !is_named {
                unused.push(format!("{krate}: {name}"));
            }
        }
    }
    unused.sort();
    Ok(unused)
}

/// Gives the names in tokens, those in macros too.
fn collect(tokens: TokenStream, into: &mut impl FnMut(String)) {
    for token in tokens {
        match token {
            TokenTree::Ident(ident) => into(ident.to_string()),
            TokenTree::Group(group) => collect(group.stream(), into),
            _ => {}
        }
    }
}

/// Public items whose names come up nowhere else in what is shipped.
fn unused_items(sources: &[Source], baseline: &Baseline) -> Vec<String> {
    let mut counts: HashMap<String, usize> = HashMap::new();
    let mut items = Vec::new();
    for source in sources.iter().filter(|s| s.is_shipped || s.is_example) {
        let kept: Vec<&syn::Item> = source.parsed.items.iter().filter(|item| !is_test_item(item)).collect();
        for item in &kept {
            collect(quote::ToTokens::to_token_stream(item), &mut |name| *counts.entry(name).or_default() += 1);
        }
        if source.is_shipped {
            let mut public = Public { source, items: &mut items };
            kept.into_iter().for_each(|item| public.visit_item(item));
        }
    }
    let is_unused = |(name, _): &(String, String)| counts.get(name) == Some(&1);
    let stays = |(_, place): &(String, String)| baseline.public_items_that_stay.contains_key(place);
    items.into_iter().filter(|item| is_unused(item) && !stays(item)).map(|(_, place)| place).collect()
}

/// Public items of a file: their names, and those with their crates.
struct Public<'a> {
    source: &'a Source,
    items: &'a mut Vec<(String, String)>,
}

impl Public<'_> {
    fn add(&mut self, visibility: &syn::Visibility, ident: &syn::Ident) {
        if matches!(visibility, syn::Visibility::Public(_)) {
            let modules = self.source.modules.join("::");
            self.items.push((ident.to_string(), format!("{}::{modules}::{ident}", self.source.krate)));
        }
    }
}

impl<'ast> Visit<'ast> for Public<'_> {
    fn visit_item_fn(&mut self, f: &'ast syn::ItemFn) {
        self.add(&f.vis, &f.sig.ident);
    }

    fn visit_impl_item_fn(&mut self, f: &'ast syn::ImplItemFn) {
        self.add(&f.vis, &f.sig.ident);
    }

    fn visit_item_struct(&mut self, s: &'ast syn::ItemStruct) {
        self.add(&s.vis, &s.ident);
    }

    fn visit_item_enum(&mut self, e: &'ast syn::ItemEnum) {
        self.add(&e.vis, &e.ident);
    }

    fn visit_item_const(&mut self, c: &'ast syn::ItemConst) {
        self.add(&c.vis, &c.ident);
    }

    fn visit_item_trait(&mut self, t: &'ast syn::ItemTrait) {
        self.add(&t.vis, &t.ident);
    }

    fn visit_item_type(&mut self, t: &'ast syn::ItemType) {
        self.add(&t.vis, &t.ident);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(path: &str, text: &str) -> Source {
        let parts: Vec<&str> = path.split('/').collect();
        let modules = parts[1..].iter().map(|p| p.trim_end_matches(".rs").to_owned()).filter(|m| m != "mod").collect();
        let parsed = syn::parse_file(text).unwrap();
        let krate = parts[0].to_owned();
        Source { path: path.into(), krate, modules, text: text.to_owned(), parsed, is_shipped: true, is_example: false }
    }

    #[test]
    fn no_count_is_beyond_its_ceiling() {
        let complaints = beyond(&counted().unwrap(), &baseline().unwrap());
        assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    }

    #[test]
    fn uses_of_the_system_are_found() {
        let text = "use std::{fs, path::Path, time::{Duration, Instant}};
            fn f(p: &Path) -> bool { std::env::var(NAME).is_ok() && p.exists() }
            #[cfg(test)] mod tests { use std::process; }";
        let sources = [source("k/a.rs", text), source("k/b.rs", text), source("cli/a.rs", text)];
        let of_b = ("k/b.rs".to_owned(), "it reads".to_owned());
        let baseline = Baseline { files_that_use_the_system: [of_b].into(), ..Baseline::default() };
        let used =
            ["std::fs", "std::time::Instant", "std::env::var", ".exists()"].map(|name| format!("k/a.rs: {name}"));
        assert_eq!(uses_of_system(&sources, &baseline), used);
    }

    #[test]
    fn what_is_counted_is_found() {
        let arguments: String = (0..8).map(|k| format!("a{k}: u8,")).collect();
        let (body, comments) = ("\n".repeat(120), "// Comment.\n".repeat(120));
        let text = format!(
            "/// The same.\nfn f({arguments}) {{{body}}}\n// {}\n/// What is counted.\n/// Whether or not.\n\
             fn g() {{\n{comments}}}\n",
            "x".repeat(130)
        );
        let source = source("k/a.rs", &text);
        let mut found = Found::new();
        of_lines(&source, &mut found);
        Functions { source: &source, found: &mut found }.visit_file(&source.parsed);
        let counts: Vec<usize> = found.values().map(Vec::len).collect();
        assert_eq!((found.len(), counts), (5, vec![1; 5]), "{found:?}");
    }

    #[test]
    fn items_that_tests_alone_use_are_found() {
        let sources = [
            source("k/a.rs", "pub fn used() {} pub fn unused() {} pub(crate) fn own() {}"),
            source("k/b.rs", "fn f() { used() } #[cfg(test)] mod tests { fn g() { unused() } }"),
        ];
        assert_eq!(unused_items(&sources, &Baseline::default()), ["k::a::unused"]);
    }
}

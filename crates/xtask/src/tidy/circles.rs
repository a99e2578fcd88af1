//! Circles: modules right under a crate's root that depend on each other, directly or by others.
//!
//! A name that a module re-exports belongs to the module that it comes from: `crate::Error` is an arrow to `error` where
//! the root has `pub use error::Error`. A re-export is no arrow of the root, and tests have none.

use super::syntax::{is_test_item, used_paths};
use proc_macro2::TokenStream;
use std::collections::{BTreeMap, BTreeSet};
use syn::{Token, parse::Parser, punctuated::Punctuated, visit::Visit};

/// Names from the crate's root on.
type Path = Vec<String>;

/// Name of the root among its modules.
const ROOT: &str = "lib";

/// The modules of a crate that are in circles, from the paths of its modules and their files.
pub fn circles(files: &[(&[String], &syn::File)]) -> Vec<String> {
    let names = Names::of(files);
    let mut arrows: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, file) in files {
        if !names.tests.iter().any(|tests| module.starts_with(tests)) {
            Arrows { names: &names, own: module.to_vec(), arrows: &mut arrows }.visit_file(file);
        }
    }
    arrows.keys().filter(|module| reaches(&arrows, module, module)).cloned().collect()
}

/// True if arrows lead from a module to another.
fn reaches(arrows: &BTreeMap<String, BTreeSet<String>>, from: &str, to: &str) -> bool {
    let (mut seen, mut work) = (BTreeSet::new(), vec![from]);
    while let Some(module) = work.pop() {
        for next in arrows.get(module).into_iter().flatten() {
            if next == to {
                return true;
            }
            if seen.insert(next) {
                work.push(next);
            }
        }
    }
    false
}

/// Meaning of the names in a crate's modules.
#[derive(Default)]
struct Names {
    modules: BTreeSet<Path>,
    /// Modules for tests alone.
    tests: BTreeSet<Path>,
    /// Names that a `use` brings into a module, each with what it names; nothing where that is of another crate.
    used: BTreeMap<Path, Option<Path>>,
}

impl Names {
    fn of(files: &[(&[String], &syn::File)]) -> Self {
        let mut names = Self { modules: files.iter().map(|(module, _)| module.to_vec()).collect(), ..Self::default() };
        let items = || files.iter().flat_map(|(module, file)| file.items.iter().map(move |item| (module, item)));
        for (module, item) in items() {
            if let syn::Item::Mod(m) = item {
                let kind = if is_test_item(item) { &mut names.tests } else { &mut names.modules };
                kind.insert(below(module, &m.ident.to_string()));
            }
        }
        for (module, item) in items().filter(|(_, item)| !is_test_item(item)) {
            if let syn::Item::Use(u) = item {
                used_paths(&u.tree, &mut |path, here| {
                    if let Some(here) = here {
                        names.used.insert(below(module, &here), names.path_from_root(module, path));
                    }
                });
            }
        }
        names
    }

    /// A path in a module as from the crate's root; nothing if it begins with another crate or a name of the module.
    fn path_from_root(&self, module: &[String], path: &[String]) -> Option<Path> {
        let ups = path.iter().take_while(|name| *name == "super").count();
        let (base, rest) = match path.first()?.as_str() {
            "crate" => (&[][..], &path[1..]),
            "self" => (module, &path[1..]),
            "super" => (&module[..module.len().checked_sub(ups)?], &path[ups..]),
            first if self.modules.contains(&below(module, first)) => (module, path),
            _ => return None,
        };
        Some([base, rest].concat())
    }

    /// The module right under the root where that is which a path names; nothing if that is of another crate.
    fn home(&self, mut path: Path) -> Option<String> {
        // Each round follows one re-export; two that name each other do not compile. A function may be called as its
        // module is, whose name it is to be then.
        let is_module = |path: &[String]| self.modules.contains(path);
        let is_used = |path: &[String]| !is_module(path) && self.used.contains_key(path);
        while let Some(length) = (1..=path.len()).find(|&n| is_used(&path[..n])) {
            path = [self.used[&path[..length]].as_ref()?, &path[length..]].concat();
        }
        Some(if path.get(..1).is_some_and(is_module) { path.swap_remove(0) } else { ROOT.to_owned() })
    }
}

fn below(module: &[String], name: &str) -> Path {
    [module, &[name.to_owned()]].concat()
}

/// Draws the arrows of a file.
struct Arrows<'a> {
    names: &'a Names,
    /// The module that is visited.
    own: Path,
    arrows: &'a mut BTreeMap<String, BTreeSet<String>>,
}

impl Arrows<'_> {
    fn add(&mut self, path: &[String]) {
        let from = self.own.first().map_or(ROOT, String::as_str);
        let target = self.names.path_from_root(&self.own, path).and_then(|path| self.names.home(path));
        if let Some(to) = target.filter(|to| to != from) {
            self.arrows.entry(from.to_owned()).or_default().insert(to);
        }
    }

    /// Arguments of a macro or an attribute, where they are expressions.
    fn add_arguments(&mut self, tokens: &TokenStream) {
        let arguments = Punctuated::<syn::Expr, Token![,]>::parse_terminated.parse2(tokens.clone());
        arguments.iter().flatten().for_each(|argument| self.visit_expr(argument));
    }
}

impl<'ast> Visit<'ast> for Arrows<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !is_test_item(item) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        self.own.push(module.ident.to_string());
        syn::visit::visit_item_mod(self, module);
        self.own.pop();
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let is_of_root = self.own.is_empty() && !matches!(item.vis, syn::Visibility::Inherited);
        if !is_of_root {
            used_paths(&item.tree, &mut |path, _| self.add(path));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Path = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if names.len() > 1 {
            self.add(&names);
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.visit_path(&call.path);
        self.add_arguments(&call.tokens);
    }

    fn visit_meta_list(&mut self, attribute: &'ast syn::MetaList) {
        self.add_arguments(&attribute.tokens);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Circles of modules with these texts; `""` is the root.
    fn circles_of(texts: &[(&str, &str)]) -> Vec<String> {
        let parsed = texts.iter().map(|(module, text)| {
            let module: Path = module.split('/').filter(|name| !name.is_empty()).map(str::to_owned).collect();
            (module, syn::parse_file(text).unwrap())
        });
        let parsed: Vec<(Path, syn::File)> = parsed.collect();
        let files: Vec<(&[String], &syn::File)> = parsed.iter().map(|(module, file)| (&module[..], file)).collect();
        circles(&files)
    }

    #[test]
    fn modules_that_name_each_other_are_found() {
        let texts = [
            ("a", "use crate::b::X;"),
            ("b", "fn f() { assert!(crate::c::g()); }"),
            ("b/inner", "use super::super::c; mod innermost { use super::super::super::c; }"),
            ("c", "#[error(fmt = crate::a::f)] struct Y;"),
            ("d", "use crate::{a, b}; #[cfg(test)] mod tests { use crate::e; } #[cfg(test)] mod checks;"),
            ("d/checks", "use crate::e;"),
            ("e", "use crate::d;"),
        ];
        assert_eq!(circles_of(&texts), ["a", "b", "c"]);
    }

    #[test]
    fn a_name_that_is_re_exported_belongs_to_its_module() {
        let texts = [
            ("", "mod error; mod read; mod write; pub use error::Error; pub use read::{Kind as FileKind, read};"),
            ("error", "use crate::FileKind;"),
            ("read", "use crate::{Error, write::Format}; pub fn read() {}"),
            ("write", "fn f() -> crate::Error {}"),
            // `format` re-exports what is of `write`, and so has nothing of its own that `user` needs.
            ("format", "mod inner; pub use super::write::Format; use crate::user;"),
            ("format/inner", "use super::Format;"),
            ("user", "use crate::format::Format; use crate::Other;"),
        ];
        assert_eq!(circles_of(&texts), ["error", "read", "write"]);
    }

    #[test]
    fn what_the_root_defines_is_of_the_root() {
        let user = ("a", "use crate::{Options, spectra};");
        assert_eq!(circles_of(&[("", "use a::f; pub use math::spectra; pub struct Options;"), user]), ["a", "lib"]);
        assert!(circles_of(&[("", "pub use a::f; pub use math::spectra; pub struct Options;"), user]).is_empty());
    }
}

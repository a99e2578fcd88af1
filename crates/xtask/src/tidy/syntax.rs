//! Reading Rust: the paths that a `use` names, and what is there for tests alone.

/// The paths that a `use` names, each from its first name on, with the name that it gets here; of a glob that of the
/// module.
pub fn used_paths(tree: &syn::UseTree, path: &mut impl FnMut(&[String], Option<String>)) {
    walk(&mut Vec::new(), tree, path);
}

fn walk(before: &mut Vec<String>, tree: &syn::UseTree, path: &mut impl FnMut(&[String], Option<String>)) {
    let mut leaf = |ident: &syn::Ident, here: &syn::Ident| {
        if ident == "self" {
            return path(before, before.last().cloned());
        }
        before.push(ident.to_string());
        path(before, Some(here.to_string()));
        before.pop();
    };
    match tree {
        syn::UseTree::Name(n) => leaf(&n.ident, &n.ident),
        syn::UseTree::Rename(r) => leaf(&r.ident, &r.rename),
        syn::UseTree::Glob(_) => path(before, None),
        syn::UseTree::Group(g) => g.items.iter().for_each(|tree| walk(before, tree, path)),
        syn::UseTree::Path(p) => {
            before.push(p.ident.to_string());
            walk(before, &p.tree, path);
            before.pop();
        }
    }
}

/// True if an item is compiled for tests alone.
pub fn is_test_item(item: &syn::Item) -> bool {
    let attributes = match item {
        syn::Item::Mod(m) => &m.attrs,
        syn::Item::Fn(f) => &f.attrs,
        syn::Item::Use(u) => &u.attrs,
        syn::Item::Impl(i) => &i.attrs,
        _ => return false,
    };
    attributes
        .iter()
        .any(|a| a.path().is_ident("cfg") && a.meta.require_list().is_ok_and(|l| l.tokens.to_string().contains("test")))
}

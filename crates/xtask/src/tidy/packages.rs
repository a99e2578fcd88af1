//! Faults that keep a crate from being published, or its package from being built without the repository around it.

use super::{Source, root};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use serde::Deserialize;
use std::{
    error::Error,
    fs,
    path::{Component, Path, PathBuf},
    process::Command,
};

/// A crate as `cargo metadata` tells of it.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Package {
    name: String,
    manifest_path: PathBuf,
    /// Registries, none of them for a crate that is not published; all where there is no list.
    publish: Option<Vec<String>>,
    description: Option<String>,
    license: Option<String>,
    readme: Option<String>,
    rust_version: Option<String>,
    keywords: Vec<String>,
    categories: Vec<String>,
    dependencies: Vec<Dependency>,
}

#[derive(Debug, Default, Deserialize)]
struct Dependency {
    name: String,
    /// Versions, `*` where the manifest has none.
    req: String,
    /// `dev`, `build` or none.
    kind: Option<String>,
    path: Option<PathBuf>,
}

#[derive(Deserialize)]
struct Workspace {
    packages: Vec<Package>,
}

impl Package {
    fn is_published(&self) -> bool {
        self.publish.as_ref().is_none_or(|registries| !registries.is_empty())
    }

    /// Faults of the manifest, with the names of the crates that are not published.
    fn faults(&self, unpublished: &[&str]) -> Vec<String> {
        let texts = [
            ("description", &self.description),
            ("license", &self.license),
            ("readme", &self.readme),
            ("rust-version", &self.rust_version),
        ];
        let missing = texts.into_iter().filter(|(_, text)| text.is_none()).map(|(key, _)| key);
        let lists = [("keywords", &self.keywords), ("categories", &self.categories)];
        let empty = lists.into_iter().filter(|(_, list)| list.is_empty()).map(|(key, _)| key);
        let mut faults: Vec<String> = missing.chain(empty).map(|key| format!("{}: no {key}", self.name)).collect();
        for needed in self.dependencies.iter().filter(|d| d.path.is_some()) {
            // Packages do without the test dependencies that have no version.
            let is_kept = needed.kind.as_deref() != Some("dev") || needed.req != "*";
            if is_kept && unpublished.contains(&needed.name.as_str()) {
                faults.push(format!("{}: needs {}, which is not published", self.name, needed.name));
            } else if is_kept && needed.req == "*" {
                faults.push(format!("{}: {} has no version", self.name, needed.name));
            }
        }
        faults
    }
}

/// Faults of the crates that are published.
pub(super) fn faults(sources: &[Source]) -> Result<Vec<String>, Box<dyn Error>> {
    let root = root();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let told = Command::new(cargo)
        .args(["metadata", "--no-deps", "--offline", "--format-version=1", "--manifest-path"])
        .arg(root.join("Cargo.toml"))
        .output()?;
    if !told.status.success() {
        return Err(format!("cargo metadata: {}", String::from_utf8_lossy(&told.stderr)).into());
    }
    let Workspace { packages } = serde_json::from_slice(&told.stdout)?;
    let (published, others): (Vec<_>, Vec<_>) = packages.iter().partition(|p| p.is_published());
    let unpublished: Vec<&str> = others.iter().map(|p| &*p.name).collect();
    let mut faults: Vec<String> = published.iter().flat_map(|p| p.faults(&unpublished)).collect();
    for package in published {
        let folder = package.manifest_path.parent().unwrap_or(Path::new(""));
        for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
            if fs::read(folder.join(licence)).ok() != Some(fs::read(root.join(licence))?) {
                faults.push(format!("{}: no {licence}, or another than the repository's", package.name));
            }
        }
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        faults.extend(sources.iter().filter(|s| s.krate == name).flat_map(outside));
    }
    Ok(faults)
}

/// Files outside its crate's folder that a source file takes in. Integration tests are in no package.
fn outside(source: &Source) -> Vec<String> {
    let own = Path::new("crates").join(&source.krate);
    if source.path.starts_with(own.join("tests")) {
        return Vec::new();
    }
    let mut named = Vec::new();
    collect(quote::ToTokens::to_token_stream(&source.parsed), &mut named);
    let folder = source.path.parent().unwrap_or(Path::new(""));
    named.retain(|file| {
        let file = resolved(&folder.join(file));
        !file.starts_with(&own) || file.starts_with(own.join("tests"))
    });
    named.iter().map(|file| format!("{}: {file} is outside the package", source.path.display())).collect()
}

/// A path without `..`, as far as it has parents.
fn resolved(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => _ = out.pop(),
            part => out.push(part),
        }
    }
    out
}

/// Files of `include_str!("…")` and its like, and of `#[path = "…"]`.
fn collect(tokens: TokenStream, named: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    for (k, token) in tokens.iter().enumerate() {
        let TokenTree::Group(group) = token else { continue };
        let word = |back: usize| k.checked_sub(back).map(|at| tokens[at].to_string()).unwrap_or_default();
        let is_included = word(1) == "!" && ["include", "include_str", "include_bytes"].contains(&&*word(2));
        let is_attribute = group.delimiter() == Delimiter::Bracket && (word(1) == "#" || word(2) == "#");
        let mut inner = group.stream().into_iter();
        if is_included || is_attribute && inner.next().is_some_and(|key| key.to_string() == "path") {
            named.extend(inner.filter_map(|token| match token {
                TokenTree::Literal(text) => Some(text.to_string().trim_matches('"').to_owned()),
                _ => None,
            }));
        }
        collect(group.stream(), named);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(path: &str, text: &str) -> Source {
        let parsed = syn::parse_file(text).unwrap();
        let (krate, text) = ("k".to_owned(), text.to_owned());
        Source { path: path.into(), krate, modules: Vec::new(), text, parsed, is_shipped: true, is_example: false }
    }

    #[test]
    fn files_outside_the_package_are_found() {
        let text = "#![doc = include_str!(\"../README.md\")]
            #[path = \"../examples/a.rs\"] mod a;
            #[path = \"../../other/src/b.rs\"] mod b;
            #[path = \"../tests/f.rs\"] mod f;
            const C: &[u8] = include_bytes!(\"c.bin\");
            fn f() { let all = vec![include_str!(\"../../../docs/d.md\")]; let path = \"../../../e\"; }";
        let found = outside(&source("crates/k/src/lib.rs", text));
        let expected = ["../../other/src/b.rs", "../tests/f.rs", "../../../docs/d.md"];
        assert_eq!(found, expected.map(|file| format!("crates/k/src/lib.rs: {file} is outside the package")));
        assert!(outside(&source("crates/k/tests/t.rs", text)).is_empty());
    }

    #[test]
    fn faults_of_manifests_are_found() {
        let dependency = |name: &str, req: &str, kind: Option<&str>| Dependency {
            name: name.into(),
            req: req.into(),
            kind: kind.map(Into::into),
            path: Some("crates".into()),
        };
        let some = |text: &str| Some(text.to_owned());
        let mut package = Package {
            name: "k".into(),
            description: some("a"),
            license: some("MIT"),
            readme: some("README.md"),
            rust_version: some("1.95"),
            keywords: vec!["a".into()],
            categories: vec!["graphics".into()],
            dependencies: vec![dependency("a", "^0.1.0", None), dependency("kit", "*", Some("dev"))],
            ..Package::default()
        };
        assert_eq!(package.faults(&["kit"]), [""; 0]);
        package.readme = None;
        package.keywords.clear();
        package.dependencies.extend([dependency("b", "*", None), dependency("kit", "^0.1.0", Some("dev"))]);
        let expected = ["no readme", "no keywords", "b has no version", "needs kit, which is not published"];
        assert_eq!(package.faults(&["kit"]), expected.map(|fault| format!("k: {fault}")));
        assert!(package.is_published());
        assert!(!Package { publish: Some(Vec::new()), ..package }.is_published());
    }
}

//! A package with models of one's own, to begin with.

/// Files of the package by their paths; `NAME` and `LIBRARY` are replaced.
const FILES: [(&str, &str); 5] = [
    ("Cargo.toml", MANIFEST),
    ("README.md", include_str!("../examples/plugin/README.md")),
    ("scene.steradian", include_str!("../examples/plugin/scene.steradian")),
    ("src/main.rs", include_str!("../examples/plugin/main.rs")),
    ("src/velvet.rs", include_str!("../examples/plugin/velvet.rs")),
];

const MANIFEST: &str = r#"[package]
name = "NAME"
version = "0.1.0"
edition = "2024"

[dependencies]
steradian = LIBRARY

# Rendering without optimisation takes minutes instead of seconds.
[profile.dev]
opt-level = 3

[workspace]
"#;

/// Place of the library that a package depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Library {
    /// The registry of packages, in this version.
    Published,
    /// A folder: the crate `steradian` of a checkout.
    Folder(String),
    /// A repository and the name of a tag.
    Tag(String, String),
}

impl Library {
    fn toml(&self) -> String {
        let quoted = |text: &str| format!("{text:?}");
        match self {
            Self::Published => quoted(env!("CARGO_PKG_VERSION")),
            Self::Folder(path) => format!("{{ path = {} }}", quoted(path)),
            Self::Tag(git, tag) => format!("{{ git = {}, tag = {} }}", quoted(git), quoted(tag)),
        }
    }
}

/// Paths and contents of a package of a name. The name is one that cargo takes.
pub fn package(name: &str, library: &Library) -> Vec<(&'static str, String)> {
    let filled = |text: &str| text.replace("LIBRARY", &library.toml()).replace("NAME", name);
    FILES.iter().map(|(path, text)| (*path, filled(text))).collect()
}

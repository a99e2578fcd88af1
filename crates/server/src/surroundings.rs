//! Surroundings of models and glTF scenes that pages choose: definitions of the file's reader (`-D NAME=VALUE`).

use crate::{
    document::Document,
    protocol::{AnimationState, Surroundings},
};
use steradian::scene::Format;

/// Skies that need no file.
const SKIES: [&str; 7] = ["studio", "overcast", "dim", "outdoor", "clear", "atmosphere", "none"];
/// Backgrounds besides colours.
const BACKGROUNDS: [&str; 2] = ["sky", "gradient"];
/// Finishes of models.
const FINISHES: [&str; 9] = ["clay", "plastic", "gloss", "glass", "chrome", "silver", "gold", "copper", "rubber"];
/// Definitions of models, and of glTF scenes.
const OF_MODELS: [&str; 9] = ["sky", "sun", "turn", "strength", "ground", "background", "material", "up", "front"];
const OF_GLTF: [&str; 8] = ["sky", "sun", "turn", "strength", "ground", "background", "animation", "at"];

/// Names of the definitions that pages may change.
fn names(document: &Document) -> &'static [&'static str] {
    match document.desc.format {
        _ if document.source.scene.is_some() => &[],
        Format::Model => &OF_MODELS,
        Format::Gltf => &OF_GLTF,
        _ => &[],
    }
}

/// Choices for pages; `None` of scenes that describe all of it themselves.
pub fn of(document: &Document) -> Option<Surroundings> {
    let names = names(document);
    if names.is_empty() {
        return None;
    }
    let animations = document.desc.animations.iter().map(|a| AnimationState { name: a.name.clone(), times: a.times });
    Some(Surroundings {
        defines: document.source.reading.defines.clone(),
        skies: &SKIES,
        backgrounds: &BACKGROUNDS,
        finishes: if names.contains(&"material") { &FINISHES } else { &[] },
        animations: animations.collect(),
    })
}

/// Refuses definitions that are not for pages: unknown ones, and skies that are files.
///
/// # Errors
/// Which there are.
pub fn check(document: &Document, name: &str, value: Option<&str>) -> Result<(), String> {
    let names = names(document);
    if !names.contains(&name) {
        let known = if names.is_empty() { "nothing".into() } else { names.join(", ") };
        return Err(format!("'{name}' cannot be defined here; what can is {known}"));
    }
    match value.filter(|word| name == "sky" && !SKIES.contains(word)) {
        Some(word) => Err(format!(
            "there is no sky '{word}'; a picture is dropped on the page, or named at the start (-D sky=FILE)"
        )),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{document::Source, protocol::told};

    /// All words that pages choose from are read.
    #[test]
    fn surroundings_are_those_of_the_reader() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n").unwrap();
        let document = Document::open(Source { name: path.clone(), ..Source::default() }).unwrap();
        let words = SKIES.map(|w| ("sky", w)).into_iter().chain(BACKGROUNDS.map(|w| ("background", w)));
        let rest = [
            ("turn", "90"),
            ("strength", "2"),
            ("ground", "false"),
            ("ground", "shadow"),
            ("up", "z"),
            ("front", "-z"),
        ];
        for (name, word) in words.chain(FINISHES.map(|w| ("material", w))).chain(rest) {
            check(&document, name, Some(word)).unwrap();
            let mut source = Source { name: path.clone(), ..Source::default() };
            source.reading.defines.insert(name.into(), word.into());
            let read = Document::open(source).unwrap_or_else(|d| panic!("{name}={word}: {}", told(&d)));
            let plain = steradian::load(&path, &Default::default()).desc;
            let is_usual =
                [("sky", "studio"), ("background", "sky"), ("up", "y"), ("front", "z")].contains(&(name, word));
            let text = |desc| serde_json::to_string(desc).unwrap();
            assert_eq!(text(&read.desc) == text(&plain), is_usual, "{name}={word}");
        }
        for (name, word) in [("sky", "/etc/passwd"), ("at", "1"), ("scene", "1")] {
            assert!(check(&document, name, Some(word)).is_err());
        }
    }
}

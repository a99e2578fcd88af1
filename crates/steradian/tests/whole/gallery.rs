//! The page of the gallery says what is there: every material, pictures that exist, and command lines that compile.

use std::{collections::HashSet, path::Path};
use steradian::{CompileOptions, compile, math::spectra::ColorMode, schema::material::MATERIALS, specimen};

/// The words of a line of a shell in which nothing but single quotes is special.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quoted) = (Vec::new(), String::new(), false);
    for c in line.trim().chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(std::mem::take(&mut word)),
            c => word.push(c),
        }
    }
    words.push(word);
    words
}

#[test]
fn the_gallery_is_whole() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let page = std::fs::read_to_string(root.join("docs/gallery.md")).expect("the page is there");
    let (mut kinds, mut pictures) = (HashSet::new(), HashSet::new());
    for line in page.lines().filter(|l| l.starts_with("    steradian material")) {
        let words = words(line);
        let after = |flag: &str| words.iter().position(|w| w == flag).map(|i| words[i + 1].clone());
        let params: Vec<(String, String)> = words
            .windows(2)
            .filter(|w| w[0] == "-p")
            .map(|w| w[1].split_once('=').expect("NAME=VALUE"))
            // Files are named from the root, where the tests do not run.
            .map(|(a, b)| (a.to_owned(), if a == "file" { root.join(b).display().to_string() } else { b.to_owned() }))
            .collect();
        let desc = specimen::describe(&words[2], &params).unwrap_or_else(|e| panic!("{line}: {e}"));
        // A few tables of coats cost seconds; the rest is compiled.
        if !["coated_diffuse", "plastic"].contains(&words[2].as_str()) {
            let mode = (after("--color").as_deref() == Some("spectral")).then_some(ColorMode::Spectral);
            let options = CompileOptions { size: Some((8, 8)), mode, ..CompileOptions::default() };
            let compiled = compile(&desc, &options);
            assert!(
                compiled.scene.is_some() && compiled.diagnostics.iter().next().is_none(),
                "{line}: {:?}",
                compiled.diagnostics
            );
        }
        kinds.insert(words[2].clone());
        if let Some(picture) = after("--picture") {
            assert!(pictures.insert(picture.clone()), "{picture} is there twice");
            assert!(page.contains(&format!("]({})", picture.trim_start_matches("docs/"))), "{picture} is not shown");
        }
    }
    for m in MATERIALS.iter().filter(|m| m.kind != "interface") {
        assert!(kinds.contains(m.kind), "'{}' has no picture", m.kind);
    }
    let files = pictures.iter().map(|p| std::fs::metadata(root.join(p)).unwrap_or_else(|e| panic!("{p}: {e}")).len());
    let all: u64 = files.sum();
    assert!(all < 4 << 20, "the pictures have {all} bytes");
}

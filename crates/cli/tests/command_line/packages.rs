//! `steradian new`: packages to begin with.

use crate::Place;
use std::{path::Path, process::Command};

/// The package's name as cargo reads it, and the table of the library.
fn read(manifest: &Path) -> String {
    let read = Command::new(env!("CARGO")).args(["read-manifest", "--manifest-path"]).arg(manifest).output();
    let read = read.expect("cargo");
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    String::from_utf8(read.stdout).expect("JSON")
}

/// The text of its sources is compiled and its laws are tested by the library's tests (`examples/plugin`).
#[test]
fn packages_are_written_and_cargo_reads_them() {
    let place = Place::new();
    let library = concat!(env!("CARGO_MANIFEST_DIR"), "/../steradian");
    let said = place.succeed(&["new", "plugin", "my-velvet", "--library", library]).stdout;
    assert_eq!(said, "cd my-velvet && cargo run --release -- scene.steradian picture.png\n");
    let manifest = read(&place.path("my-velvet/Cargo.toml"));
    assert!(manifest.contains("\"name\":\"my-velvet\"") && manifest.contains("\"path\":\""), "{manifest}");
    for file in ["README.md", "scene.steradian", "src/main.rs", "src/velvet.rs"] {
        let text = std::fs::read_to_string(place.path("my-velvet").join(file)).expect(file);
        assert!(text.contains("velvet") && !text.contains("NAME") && !text.contains("LIBRARY"), "{file}: {text}");
    }
    // What is there stays.
    place.refuse(2, &["new", "plugin", "my-velvet"], &["'my-velvet' is there already"]);
    place.succeed(&["new", "plugin", "other", "-o", "elsewhere"]);
    assert!(read(&place.path("elsewhere/Cargo.toml")).contains("\"name\":\"other\""));
    place.succeed(&["new", "plugin", "tagged", "--library", "https://example.org/steradian#v0.1.0"]);
    assert!(read(&place.path("tagged/Cargo.toml")).contains("tag=v0.1.0"));
    place.refuse(2, &["new", "plugin", "two words"], &["begins with a letter"]);
    place.refuse(2, &["new", "plugin", "steradian"], &["cannot be called 'steradian'"]);
    place.refuse(
        2,
        &["new", "plugin", "a", "--library", "nowhere"],
        &["neither the folder of a crate", "REPOSITORY#TAG"],
    );
    place.refuse(1, &["new", "plugin", "a", "-o", "not/there"], &["cannot write 'not/there'"]);
    place.refuse(2, &["new", "plugn", "a"], &["plugin"]);
    assert!(!place.path("a").exists());
}

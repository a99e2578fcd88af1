//! `steradian list`, help, version, completions.

use crate::Place;

#[test]
fn every_family_is_listed() {
    let place = Place::new();
    let all = place.succeed(&["list"]).stdout;
    for part in [
        "integrators",
        "  path ",
        "materials",
        "  diffuse ",
        "sensors",
        "tones",
        "  agx ",
        "layers",
        "scenes",
        "  cornell-box-area",
        "formats",
    ] {
        assert!(all.contains(part), "{part}");
    }
    let one = place.succeed(&["list", "samplers"]).stdout;
    assert!(one.contains("sobol") && !one.contains("diffuse"));
    assert_eq!(one, place.succeed(&["list", "sampler"]).stdout, "the singular will do");
    assert!(place.succeed(&["list", "medium"]).stdout.starts_with("media"));
    place.refuse(2, &["list", "integraters"], &["did you mean 'integrators'?"]);
    let metal = place.succeed(&["list", "conductor"]).stdout;
    assert!(
        metal.starts_with("materials\n  conductor") && metal.contains("alpha_u") && !metal.contains("plastic"),
        "{metal}"
    );
    place.refuse(2, &["list", "plastc"], &["did you mean 'plastic'?", "families: integrators"]);
    let materials = place.succeed(&["list", "materials"]).stdout;
    for part in ["  conductor", "alpha_u", "in [0, 16]", "default", "source: ", "in [0, 1]", "nm;"] {
        assert!(materials.contains(part), "{part}");
    }
    assert!(place.succeed(&["list", "materials", "--markdown"]).stdout.starts_with("# Materials"));
    assert!(place.succeed(&["list", "lights", "--markdown"]).stdout.starts_with("# Lights"));
    place.refuse(2, &["list", "tones", "--markdown"], &["list materials --markdown"]);
    let json = place.succeed(&["list", "materials", "--json"]).json();
    assert_eq!(json["families"][0]["entries"][0]["parameters"][0]["range"][1], 1.0);
    let json = place.succeed(&["list", "integrators", "--json"]).json();
    assert_eq!(json["families"][0]["entries"][0]["name"], "path");
    assert!(!json["families"][0]["entries"][0]["description"].as_str().unwrap().is_empty());
}

#[test]
fn help_version_and_completions() {
    let place = Place::new();
    let version = place.succeed(&["--version"]).stdout;
    let commit = version.trim_end().strip_prefix(concat!("steradian ", env!("CARGO_PKG_VERSION")));
    let is_hash = |c: &str| c.strip_prefix(" (").and_then(|c| c.strip_suffix(')')).is_some_and(|c| c.len() >= 7);
    assert!(commit.is_some_and(|c| c.is_empty() || is_hash(c)), "{version}");
    for command in ["render", "info", "list", "material", "compare", "convert", "bench", "completions"] {
        assert!(place.succeed(&[command, "--help"]).stdout.contains("Usage: steradian"), "{command}");
    }
    assert!(place.succeed(&["completions", "bash"]).stdout.contains("_steradian()"));
    assert!(place.succeed(&["man"]).stdout.contains("steradian\\-render"));
    assert!(place.succeed(&["man", "render"]).stdout.contains("\\-\\-spp"));
    place.refuse(2, &["man", "rendr"], &["did you mean 'render'?"]);
    place.refuse(2, &["rendr"], &["'render'"]);
    place.refuse(2, &[], &["Usage"]);
    // What is not there is not shown.
    let help = place.succeed(&["render", "--help"]).stdout;
    assert!(!help.contains("--nthreads") && !help.contains("--sample-range"));
}

//! `steradian optics`, `vision`, `estimate` and `geometry`.

use super::Place;
use std::path::Path;

/// Every command of the page runs as it is printed there, and writes its file.
#[test]
fn the_commands_of_the_page_run() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let place = Place::new();
    std::fs::create_dir(place.path("docs")).unwrap();
    std::fs::copy(docs.join("showcase.png"), place.path("docs/showcase.png")).unwrap();
    let page = std::fs::read_to_string(docs.join("experiments.md")).unwrap();
    let commands: Vec<_> = page.lines().filter_map(|l| l.strip_prefix("    steradian ")).collect();
    assert!(commands.len() > 30);
    for command in commands {
        let words: Vec<_> = command.split('#').next().unwrap_or_default().split_whitespace().collect();
        let run = place.run(&words);
        assert_eq!(run.code, 0, "{command}: {}", run.stderr);
        assert!(!run.stdout.is_empty(), "{command}");
        if let Some(output) = words.iter().position(|w| *w == "-o").map(|k| words[k + 1]) {
            assert!(place.path(output).exists(), "{command}");
            assert!(docs.join("experiments").join(output).exists(), "{output} is not in docs/experiments");
        }
    }
}

#[test]
fn numbers_tables_and_json() {
    let place = Place::new();
    let run = place.run(&["optics", "prism", "--json", "--table", "prism.txt"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let abbe = answer["quantities"].as_array().unwrap().iter().find(|q| q["name"] == "Abbe number").unwrap();
    assert!((abbe["value"].as_f64().unwrap() - 64.17).abs() < 0.01);
    assert_eq!(answer["chart"]["series"].as_array().unwrap().len(), 3);
    assert!(std::fs::read_to_string(place.path("prism.txt")).unwrap().starts_with("series\t"));
    // JSON has no infinite numbers: a lens focused far away is sharp to infinity, which is a word.
    let run = place.run(&["optics", "lens", "--json", "-p", "focus=1e6"]);
    let answer: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let far = answer["quantities"].as_array().unwrap().iter().find(|q| q["name"] == "sharp to").unwrap();
    assert_eq!(far["value"], "infinity");
    let run = place.run(&["geometry", "conic", "--json"]);
    let answer: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(answer["facts"][0]["text"], "ellipse");
    let run = place.run(&["optics", "aperture", "--explain"]);
    assert!(run.stdout.contains("diameter") && run.stdout.contains("mm"), "{}", run.stdout);
}

#[test]
fn what_is_wrong_is_told_before_anything_is_written() {
    let place = Place::new();
    for (words, what) in [
        (&["geometry", "plane", "-p", "from=normal", "qy=0"][..], "name no ordinary plane"),
        (&["optics", "slit"][..], "did you mean 'slits'"),
        (&["optics", "slits", "-p", "widht=3"], "did you mean 'width'"),
        (&["optics", "slits", "-p", "wavelength=-1"], "is not a number from"),
        (&["optics", "lens", "-o", "lens.png"], "has no picture"),
        (&["vision", "night", "-o", "a.svg"], "needs a picture"),
        (&["optics", "slits", "-o", "no/such/folder.svg"], "there is no folder"),
        (&["optics", "slits", "-o", "slits.gif"], "slits.gif"),
        (&["vision", "cones", "missing.png"], "missing.png"),
    ] {
        let run = place.run(words);
        assert_ne!(run.code, 0, "{words:?}");
        assert!(run.stderr.contains(what), "{words:?}: {}", run.stderr);
        assert_eq!(std::fs::read_dir(place.path("")).unwrap().count(), 0, "{words:?}");
    }
}

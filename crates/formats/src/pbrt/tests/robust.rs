//! Nothing in a file may break, hang or exhaust the reader.

use super::{
    published::{SCENES, path},
    *,
};
use std::time::{Duration, Instant};
use steradian_math::hash::HashRng;

/// Loads within a time that is far above what it takes, and far below a hang.
fn quickly(text: impl Into<Vec<u8>>) -> Import {
    let start = Instant::now();
    let import = import_text("s", text, Path::new("."), &Options::default());
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    import
}

#[test]
fn deep_nesting_is_refused() {
    let import = quickly("WorldBegin\n".to_string() + &"AttributeBegin\n".repeat(1_000_000));
    assert!(errors(&import)[0].message.contains("nested more than 10000 deep"));
    let import =
        quickly("WorldBegin\n".to_string() + &"AttributeBegin\n".repeat(9_000) + &"AttributeEnd\n".repeat(9_000));
    assert!(import.diagnostics.is_empty());
    let import = quickly("WorldBegin\n".to_string() + &"[".repeat(1_000_000));
    assert!(import.diagnostics.has_errors());
}

#[test]
fn floods_of_faults_end() {
    for flood in [
        "Bogus ",
        "AttributeEnd\n",
        "Shape \"x\"\n",
        "1 ",
        "\"",
        "] [",
        "Shape \"sphere\" \"float x\" 1\n",
        "NamedMaterial \"a\" Shape \"sphere\"\n",
    ] {
        let import = quickly("WorldBegin\n".to_string() + &flood.repeat(200_000));
        assert!(import.diagnostics.iter().count() <= Diagnostics::MAX_ERRORS + Diagnostics::MAX_OTHERS, "{flood}");
        assert!(!import.diagnostics.is_empty(), "{flood}");
    }
}

#[test]
fn nearest_names_are_not_looked_for_without_end() {
    let defined: String =
        (0..50_000).map(|i| format!("MakeNamedMaterial \"m{i}\" \"string type\" \"diffuse\"\n")).collect();
    let used: String = (0..5_000).map(|i| format!("NamedMaterial \"x{i}\" Shape \"sphere\"\n")).collect();
    let import = quickly(format!("WorldBegin\n{defined}{used}"));
    assert_eq!(import.diagnostics.error_count(), 5_000);
}

#[test]
fn floods_of_valid_directives_end() {
    for (flood, shapes) in [
        ("Shape \"sphere\"\n", 100_000),
        ("AttributeBegin Translate 1 0 0 Material \"diffuse\" Shape \"sphere\" AttributeEnd\n", 100_000),
        ("Attribute \"shape\" \"float radius\" 1\n", 0),
        ("ReverseOrientation ", 0),
        ("# comment\n", 0),
    ] {
        let import = quickly("WorldBegin\n".to_string() + &flood.repeat(100_000));
        assert_eq!(import.desc.shapes.len(), shapes, "{flood}");
    }
    let textures: String =
        (0..50_000).map(|i| format!("Texture \"t{i}\" \"float\" \"scale\" \"texture tex\" \"t{}\"\n", i - 1)).collect();
    let import = quickly("WorldBegin\nTexture \"t-1\" \"float\" \"constant\"\n".to_string() + &textures);
    assert!(!import.diagnostics.has_errors());
}

#[test]
fn huge_counts_need_the_bytes() {
    for text in [
        "WorldBegin Shape \"loopsubdiv\" \"integer levels\" 2147483647 \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 2]",
        "WorldBegin Shape \"curve\" \"integer splitdepth\" 2147483647 \"point3 P\" [0 0 0 1 0 0 1 1 0 2 2 2]",
        "Film \"rgb\" \"integer xresolution\" 2147483647 \"integer yresolution\" 2147483647 WorldBegin",
        "Sampler \"stratified\" \"integer xsamples\" 2147483647 \"integer ysamples\" 2147483647 WorldBegin",
    ] {
        quickly(text);
    }
}

#[test]
fn mutants_of_scenes_never_break_the_reader() {
    let seeds: Vec<(std::path::PathBuf, Vec<u8>)> =
        SCENES.iter().filter_map(|n| path(n)).map(|p| (p.clone(), std::fs::read(p).unwrap())).collect();
    if seeds.is_empty() {
        return;
    }
    let mut rng = HashRng::new(7);
    let mut below = move |n: usize| (rng.next_u64() % n.max(1) as u64) as usize;
    let words: [&[u8]; 14] = [
        b"[",
        b"]",
        b"\"",
        b"#",
        b"\\",
        b"-",
        b"1e99",
        b"Include \"scene-v4.pbrt\" ",
        b"AttributeBegin ",
        b"ObjectBegin \"o\" ",
        b"ObjectInstance \"o\" ",
        b"\"texture reflectance\" \"t\" ",
        b"Shape \"curve\" ",
        b"\xff",
    ];
    for i in 0..2000 {
        let (path, seed) = &seeds[i % seeds.len()];
        let mut text = seed.clone();
        for _ in 0..=below(6) {
            let at = below(text.len());
            match below(5) {
                0 => text[at] = below(256) as u8,
                1 => text.truncate(at),
                2 => _ = text.drain(at..(at + below(40)).min(text.len())),
                3 => {
                    let piece = text[at..(at + below(200)).min(text.len())].to_vec();
                    let to = below(text.len());
                    text.splice(to..to, piece);
                }
                _ => {
                    let word = words[below(words.len())];
                    text.splice(at..at, word.iter().copied());
                }
            }
        }
        // Meshes are read from where there are none, so that texts alone are tried.
        let folder = if i % 50 == 0 { path.parent().unwrap() } else { Path::new("nowhere") };
        let import = import_text("mutant", text, folder, &Options::default());
        for d in import.diagnostics.iter() {
            let _ = d.to_string();
        }
        for shape in &import.desc.shapes {
            assert!(shape.mesh.is_none_or(|m| m < import.desc.meshes.len()));
        }
    }
}

#[test]
#[ignore = "a measurement: cargo test --release -- --ignored throughput --nocapture"]
#[expect(clippy::print_stdout, reason = "the measurement")]
fn throughput() {
    let mut rng = HashRng::new(1);
    let count = 2_000_000;
    let mut text = String::from("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [");
    for i in 0..count * 3 {
        text.push_str(&format!("{:.6} ", rng.next_f32() * 100.0 - 50.0));
        if i % 9 == 8 {
            text.push('\n');
        }
    }
    text.push_str("] \"integer indices\" [");
    for i in 0..count {
        text.push_str(&format!("{} {} {} ", i, (i + 1) % count, (i + 2) % count));
    }
    text.push(']');
    let bytes = text.len();
    let start = Instant::now();
    let import = load(&text);
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(import.desc.face_count(), count as u64);
    println!("arrays: {:.0} MB in {seconds:.3} s: {:.0} MB/s", bytes as f64 / 1e6, bytes as f64 / 1e6 / seconds);
    let block = "AttributeBegin\n  Translate 1 2 3\n  NamedMaterial \"m\"\n  Shape \"sphere\" \"float radius\" [ 2 ]\nAttributeEnd\n";
    let text = "WorldBegin MakeNamedMaterial \"m\" \"string type\" \"diffuse\"\n".to_string() + &block.repeat(500_000);
    let start = Instant::now();
    let import = load(&text);
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(import.desc.shapes.len(), 500_000);
    println!("directives: {:.0} MB/s, {:.2} M shapes/s", text.len() as f64 / 1e6 / seconds, 0.5 / seconds);
}

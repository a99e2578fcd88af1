//! Faults are reported with their position, and nothing panics or hangs.

use super::*;
use std::time::{Duration, Instant};
use steradian_scene::Fidelity;

/// Text inside a scene, the column of the first error on line 1 (after `<scene version="3.0.0">`), and words of its
/// message.
const MALFORMED: [(&str, u32, &str); 56] = [
    ("<shap type=\"sphere\"/>", 2, "unknown element <shap>"),
    ("<shape type=\"spere\"/>", 14, "unknown shape 'spere'"),
    ("<shape/>", 2, "needs the attribute 'type'"),
    ("<shape type=\"sphere\" nme=\"x\"/>", 22, "no attribute 'nme'"),
    ("<shape type=\"ellipsoids\"/>", 14, "no shape 'ellipsoids'"),
    ("<shape type=\"sphere\"><float name=\"radius\" value=\"1,5\"/></shape>", 50, "'1,5' is not a number"),
    ("<shape type=\"sphere\"><float name=\"radius\" value=\"nan\"/></shape>", 50, "not a finite number"),
    ("<shape type=\"sphere\"><float name=\"radius\" value=\"-1\"/></shape>", 50, "above zero"),
    ("<shape type=\"sphere\"><float name=\"radius\"/></shape>", 23, "needs the attribute 'value'"),
    ("<shape type=\"sphere\"><string name=\"radius\" value=\"1\"/></shape>", 51, "needs a number, not a string"),
    ("<shape type=\"sphere\"><float name=\"\" value=\"1\"/></shape>", 35, "needs a name"),
    (
        "<shape type=\"sphere\"><float name=\"radius\" value=\"1\"/><float name=\"radius\" value=\"2\"/></shape>",
        67,
        "set twice",
    ),
    ("<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"2\"/></shape>", 23, "needs the attribute 'z'"),
    ("<shape type=\"sphere\"><point name=\"center\" value=\"1 2\"/></shape>", 50, "one or three numbers"),
    (
        "<shape type=\"sphere\"><float name=\"radius\" value=\"1\"><float name=\"a\" value=\"1\"/></float></shape>",
        54,
        "cannot stand inside",
    ),
    ("<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"yes\"/></shape>", 58, "neither 'true' nor 'false'"),
    ("<shape type=\"sphere\"><ref id=\"nobody\"/></shape>", 31, "nothing has the id 'nobody'"),
    ("<bsdf type=\"diffuse\" id=\"a\"/><bsdf type=\"diffuse\" id=\"a\"/>", 55, "given twice"),
    ("<alias id=\"x\" as=\"y\"/>", 12, "nothing has the id 'x'"),
    ("<translate x=\"1\"/>", 2, "belongs inside a <transform>"),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"0\"/></transform></shape>",
        61,
        "cannot be undone",
    ),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><scle value=\"0\"/></transform></shape>",
        48,
        "did you mean 'scale'",
    ),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><rotate angle=\"9\"/></transform></shape>",
        48,
        "axis of the rotation is zero",
    ),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><rotate x=\"1\"/></transform></shape>",
        48,
        "needs the attribute 'angle'",
    ),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 2\"/></transform></shape>",
        62,
        "9 or 16 numbers",
    ),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 0 0 0 0 0 0 0 1\"/></transform></shape>",
        62,
        "inverted",
    ),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0 1 0\" up=\"0 1 0\"/></transform></shape>",
        78,
        "parallel",
    ),
    (
        "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"1e300\"/><scale value=\"1e300\"/></transform></shape>",
        37,
        "cannot be inverted",
    ),
    ("<shape type=\"obj\"/>", 14, "needs 'filename'"),
    ("<shape type=\"obj\"><string name=\"filename\" value=\"no.obj\"/></shape>", 50, "cannot find 'no.obj' (searched"),
    ("<shape type=\"serialized\"><integer name=\"shape_index\" value=\"-1\"/></shape>", 61, "negative"),
    ("<shape type=\"instance\"/>", 14, "needs one shape group"),
    ("<shape type=\"instance\"><shape type=\"cube\"/></shape>", 14, "not a 'cube'"),
    ("<shape type=\"cube\"><emitter type=\"point\"/></shape>", 35, "belong on shapes"),
    ("<shape type=\"cube\"><bsdf type=\"twosided\"/></shape>", 32, "1 or 2 nested BSDFs, not 0"),
    (
        "<shape type=\"cube\"><bsdf type=\"blendbsdf\"><bsdf type=\"null\"/><bsdf type=\"null\"/></bsdf></shape>",
        32,
        "needs 'weight'",
    ),
    (
        "<bsdf type=\"mask\" id=\"m\"><ref id=\"m\"/></bsdf><shape type=\"cube\"><ref id=\"m\"/></shape>",
        13,
        "contains itself",
    ),
    (
        "<shape type=\"cube\"><bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"watr\"/></bsdf></shape>",
        74,
        "no index of refraction",
    ),
    (
        "<shape type=\"cube\"><bsdf type=\"conductor\"><string name=\"material\" value=\"Aug\"/></bsdf></shape>",
        74,
        "unknown conductor 'Aug'",
    ),
    (
        "<shape type=\"cube\"><bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"gxg\"/></bsdf></shape>",
        81,
        "'beckmann', 'ggx'",
    ),
    (
        "<shape type=\"cube\"><bsdf type=\"roughplastic\"><float name=\"alpha_u\" value=\"1\"/></bsdf></shape>",
        75,
        "needs 'alpha_v'",
    ),
    (
        "<shape type=\"cube\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1 2\"/></bsdf></shape>",
        72,
        "one or three numbers",
    ),
    (
        "<shape type=\"cube\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"500:1\"/></bsdf></shape>",
        77,
        "at least two",
    ),
    (
        "<shape type=\"cube\"><bsdf type=\"diffuse\"><ref name=\"reflectance\" id=\"b\"/></bsdf></shape><bsdf type=\"null\" id=\"b\"/>",
        69,
        "not an object",
    ),
    ("<sensor type=\"batch\"/>", 15, "no sensor 'batch'"),
    ("<sensor type=\"perspective\"><float name=\"fov\" value=\"180\"/></sensor>", 53, "between 0 and 180"),
    ("<sensor type=\"thinlens\"/>", 15, "needs 'aperture_radius'"),
    (
        "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"0\"/></film></sensor>",
        78,
        "must be positive",
    ),
    (
        "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"crop_width\" value=\"9999\"/></film></sensor>",
        83,
        "crop window",
    ),
    (
        "<sensor type=\"perspective\"><sampler type=\"independent\"><integer name=\"sample_count\" value=\"1.5\"/></sampler></sensor>",
        92,
        "whole number",
    ),
    ("<integrator type=\"path\"/><integrator type=\"path\"/>", 44, "one integrator"),
    ("<integrator type=\"pth\"/>", 19, "unknown integrator 'pth'"),
    ("<emitter type=\"directional\"><vector name=\"direction\" value=\"0\"/></emitter>", 61, "direction is zero"),
    ("<shape type=\"cube\"><path value=\".\"/></shape>", 21, "directly inside <scene>"),
    ("<path value=\"no/such/folder\"/>", 14, "no folder"),
    ("<include filename=\"no.xml\"/>", 20, "cannot find 'no.xml'"),
];

#[test]
fn malformed_scenes_are_located() {
    let before = "<scene version=\"3.0.0\">".len() as u32;
    for (text, column, words) in MALFORMED {
        let import = read(text);
        let first = import.diagnostics.iter().find(|d| d.severity == Severity::Error);
        let Some(first) = first else { panic!("no error in {text}") };
        let all = first.to_string();
        assert!(all.contains(words), "{text}\n{all}");
        let at = first.location.as_ref().map(|l| (l.line, l.column - before));
        assert_eq!(at, Some((1, column)), "{text}\n{all}");
        assert_eq!(import.diagnostics.error_count(), 1, "{text}\n{:?}", errors(&import));
    }
}

#[test]
fn faults_of_the_file_as_a_whole() {
    let first = |text: &str| {
        let import = import_text(text, Path::new("t.xml"), &Options::default());
        let error = import.diagnostics.iter().find(|d| d.severity == Severity::Error).cloned();
        let error = error.unwrap_or_else(|| panic!("no error in {text}"));
        (error.location.map(|l| (l.line, l.column)), error.message)
    };
    assert_eq!(first("<scene>\n</scene>").0, Some((1, 2)));
    assert_eq!(first("<scene version=\"three\"/>").0, Some((1, 17)));
    assert_eq!(first("<bsdf version=\"3.0.0\" type=\"diffuse\"/>").0, Some((1, 2)));
    assert_eq!(first("<scene version=\"3.0.0\">\n  <shape></shap>\n</scene>").0, Some((2, 3)));
    assert_eq!(first("<scene version=\"3.0.0\">\n <scene/></scene>").0, Some((2, 3)));
    assert!(first("").1.contains("not well-formed"));
    let (place, message) = first("<scene version=\"3.0.0\">\n<default name=\"a\" value=\"$b\"/></scene>");
    assert_eq!((place, message.as_str()), (Some((2, 26)), "the parameter '$b' has no value"));
    let missing = crate::mitsuba::import(Path::new("no/such/scene.xml"), &Options::default());
    assert!(missing.diagnostics.has_errors());
}

#[test]
fn parameters_without_values_are_reported_once() {
    let import = read(
        "<integrator type=\"$which\"/><sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"$w\"/></film></sensor>",
    );
    assert_eq!(import.diagnostics.error_count(), 2, "{:?}", errors(&import));
}

#[test]
fn models_taken_over_as_they_stand_know_their_parameters() {
    let ball = |bsdf: &str| read(&format!("<shape type=\"sphere\">{bsdf}</shape><sensor type=\"perspective\"/>"));
    for (model, wrong, right) in [
        ("principled", "rougness", "roughness"),
        ("principledthin", "dif_trans", "diff_trans"),
        ("cook_torrance", "couplin", "coupling"),
        ("minnaert", "reflectence", "reflectance"),
    ] {
        let import = ball(&format!("<bsdf type=\"{model}\"><float name=\"{wrong}\" value=\"0.1\"/></bsdf>"));
        let said: Vec<&Diagnostic> = import.diagnostics.iter().collect();
        assert_eq!(said.len(), 1, "{model}");
        assert_eq!(said[0].message, format!("the BSDF '{model}' does not use '{wrong}'"));
        assert_eq!(said[0].help.as_deref(), Some(format!("did you mean '{right}'?").as_str()));
    }
    let rates = "<bsdf type=\"principled\"><float name=\"clearcoat_sampling_rate\" value=\"2\"/></bsdf>";
    assert_eq!(ball(rates).diagnostics.iter().count(), 0);
    let missing = errors(&ball("<bsdf type=\"measured\"/>"));
    assert!(missing.len() == 1 && missing[0].starts_with("error: the BSDF 'measured' needs 'filename'"), "{missing:?}");
}

#[test]
fn unused_properties_name_their_neighbours() {
    let import =
        read("<shape type=\"sphere\"><float name=\"radios\" value=\"1\"/></shape><sensor type=\"perspective\"/>");
    let unused: Vec<&Diagnostic> = import.diagnostics.iter().filter(|d| d.fidelity == Some(Fidelity::Unused)).collect();
    assert_eq!(unused.len(), 1);
    assert_eq!(unused[0].message, "the shape 'sphere' does not use 'radios'");
    assert_eq!(unused[0].help.as_deref(), Some("did you mean 'radius'?"));
    assert!(!import.diagnostics.has_errors());
    let many = "<shape type=\"sphere\"><float name=\"radios\" value=\"1\"/></shape>".repeat(30_000);
    let start = Instant::now();
    let import = read(&format!("{many}<sensor type=\"perspective\"/>"));
    assert_eq!(import.diagnostics.iter().count(), 1);
    assert!(import.diagnostics.iter().next().unwrap().message.ends_with("(here and in 29999 more places)"));
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

#[test]
fn deep_and_swelling_files_are_refused_quickly() {
    let start = Instant::now();
    let deep = format!("<scene version=\"3.0.0\">{}", "<bsdf type=\"twosided\">".repeat(200_000));
    let import = import_text(&deep, Path::new("deep.xml"), &Options::default());
    assert!(errors(&import)[0].contains("deeper than 10000"));
    // Within the limit of the XML, but too deep for a material.
    let nested =
        |n: usize| format!("{}<bsdf type=\"diffuse\"/>{}", "<bsdf type=\"twosided\">".repeat(n), "</bsdf>".repeat(n));
    let import = read(&format!("<shape type=\"sphere\">{}</shape>", nested(5000)));
    assert_eq!(import.diagnostics.error_count(), 1);
    assert!(errors(&import)[0].contains("nest deeper than 64"));
    let bomb = "<!DOCTYPE x [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;\">]><scene version=\"3.0.0\">&b;</scene>";
    assert!(errors(&import_text(bomb, Path::new("bomb.xml"), &Options::default()))[0].contains("document type"));
    // References that double at every step, through materials and through merged shapes.
    let mut blend = "<bsdf id=\"b0\" type=\"diffuse\"/>".to_owned();
    let mut merge = "<shape id=\"m0\" type=\"sphere\"/>".to_owned();
    for i in 1..60 {
        let j = i - 1;
        blend += &format!(
            "<bsdf id=\"b{i}\" type=\"blendbsdf\"><float name=\"weight\" value=\".5\"/><ref id=\"b{j}\"/><ref id=\"b{j}\"/></bsdf>"
        );
        merge += &format!("<shape id=\"m{i}\" type=\"merge\"><ref id=\"m{j}\"/><ref id=\"m{j}\"/></shape>");
    }
    good(&format!("{blend}<shape type=\"sphere\"><ref id=\"b59\"/></shape>"));
    assert!(read(&merge).diagnostics.has_errors());
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

#[test]
fn errors_stop_when_there_are_enough() {
    let references = (0..50_000)
        .map(|i| format!("<bsdf id=\"b{i}\" type=\"diffuse\"/><shape type=\"cube\"><ref id=\"x{i}\"/></shape>"));
    let start = Instant::now();
    assert!(read(&references.collect::<String>()).diagnostics.is_full());
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    let import = read(&"<shape type=\"banana\"/>".repeat(100_000));
    assert!(import.diagnostics.is_full() && import.diagnostics.iter().count() < 1000);
}

/// Changed, cut and shuffled scenes give messages, never a panic.
#[test]
fn mutants_never_panic() {
    let seeds: Vec<Vec<u8>> = MALFORMED
        .iter()
        .map(|(t, ..)| format!("<scene version=\"3.0.0\">{t}</scene>").into_bytes())
        .chain([include_bytes!("mutated.xml").to_vec()])
        .collect();
    let pieces: [&[u8]; 14] = [
        b"<",
        b">",
        b"\"",
        b"/>",
        b"</scene>",
        b"$",
        b"<ref id=\"a\"/>",
        b"-1",
        b"1e308",
        b"value=\"\"",
        b"\xff",
        b"<!--",
        b"0.6.0",
        b"999999999999",
    ];
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as usize % n.max(1)
    };
    for round in 0..3000 {
        let mut text = seeds[round % seeds.len()].clone();
        for _ in 0..=random(4) {
            let (at, to) = (random(text.len()), random(text.len()));
            match random(5) {
                0 => text.truncate(at),
                1 => {
                    text.splice(at..at, pieces[random(pieces.len())].iter().copied());
                }
                2 => text[at] = random(256) as u8,
                3 => {
                    let cut: Vec<u8> = text[at.min(to)..at.max(to)].to_vec();
                    text.splice(at..at, cut);
                }
                _ => {
                    text.drain(at.min(to)..at.max(to));
                }
            }
            if text.is_empty() {
                text = b"<scene".to_vec();
            }
        }
        let import = crate::mitsuba::import_bytes(text, Path::new("m.xml"), &Options::default());
        assert!(import.diagnostics.iter().all(|d| !d.message.is_empty()));
    }
}

//! Properties that are not followed.

use super::*;

/// Messages, each with its kind.
fn said(inside: &str) -> Vec<String> {
    read(inside).diagnostics.iter().map(|d| format!("{}: {}", d.kind(), d.message)).collect()
}

const VIEW: &str = "<sensor type=\"perspective\"/>";

#[test]
fn properties_without_effect_on_the_picture_are_noted() {
    let weight = "<float name=\"sampling_weight\" value=\"2\"/>";
    for (inside, what) in [
        (format!("{VIEW}<emitter type=\"constant\">{weight}</emitter>"), "'sampling_weight' of the emitter 'constant'"),
        (
            format!("{VIEW}<integrator type=\"path\"><integer name=\"block_size\" value=\"8\"/></integrator>"),
            "'block_size' of the integrator 'path'",
        ),
        (
            "<sensor type=\"perspective\"><float name=\"focus_distance\" value=\"2\"/></sensor>".into(),
            "'focus_distance' of the sensor 'perspective'",
        ),
        (
            "<sensor type=\"perspective\"><film type=\"hdrfilm\">\
             <boolean name=\"banner\" value=\"true\"/></film></sensor>"
                .into(),
            "'banner' of the film 'hdrfilm'",
        ),
    ] {
        let said = said(&inside);
        let note = format!("note: {what} has no effect: ");
        assert!(said.iter().filter(|s| s.starts_with(&note)).count() == 1, "{inside}: {said:?}");
        assert!(said.iter().all(|s| s.starts_with("note: ")), "{inside}: {said:?}");
    }
    let twice = format!("<emitter type=\"constant\">{weight}</emitter>").repeat(2);
    assert_eq!(said(&format!("{VIEW}{twice}")).iter().filter(|s| s.contains("sampling_weight")).count(), 1);
}

#[test]
fn properties_that_change_the_picture_are_left_out_unless_they_have_their_defaults() {
    let film = |property: &str| {
        said(&format!("<sensor type=\"perspective\"><film type=\"ldrfilm\">{property}</film></sensor>"))
    };
    let normals = |value: &str| {
        said(&format!(
            "{VIEW}<integrator type=\"path\"><boolean name=\"strict_normals\" value=\"{value}\"/></integrator>"
        ))
    };
    for (said, is_told) in [
        (film("<float name=\"exposure\" value=\"2\"/>"), true),
        (film("<float name=\"exposure\" value=\"0\"/>"), false),
        (film("<string name=\"tonemap_method\" value=\"reinhard\"/>"), true),
        (film("<string name=\"tonemap_method\" value=\"gamma\"/>"), false),
        (film("<string name=\"pixel_format\" value=\"luminance\"/>"), true),
        (film("<string name=\"pixel_format\" value=\"rgb\"/>"), false),
        (normals("true"), true),
        (normals("false"), false),
    ] {
        assert_eq!(said.iter().any(|s| s.starts_with("dropped: ")), is_told, "{said:?}");
    }
}

/// The integrator inside has its own settings; those around it are told, and unknown names stay so.
#[test]
fn settings_around_a_wrapped_integrator_are_told() {
    let inner = "<integrator type=\"path\"><integer name=\"max_depth\" value=\"4\"/></integrator>";
    let around = |kind: &str, property: &str, inner: &str| {
        format!("{VIEW}<integrator type=\"{kind}\">{property}{inner}</integrator>")
    };
    let of = |inside: &str| {
        let desc = good(inside);
        desc.node(desc.integrator.unwrap()).int("max_depth")
    };
    for kind in ["aov", "moment", "stokes", "adaptive", "multichannel"] {
        let hidden = around(kind, "<boolean name=\"hide_emitters\" value=\"true\"/>", inner);
        let note = format!("note: 'hide_emitters' of the integrator '{kind}' has no effect: ");
        assert!(said(&hidden).iter().any(|s| s.starts_with(&note)), "{:?}", said(&hidden));
        assert_eq!(of(&hidden), Some(3));
        let deep = around(kind, "<integer name=\"max_depth\" value=\"9\"/>", inner);
        let unused = format!("unused: the integrator '{kind}' does not use 'max_depth'");
        assert!(said(&deep).contains(&unused), "{:?}", said(&deep));
        let two = said(&around(kind, "", &inner.repeat(2)));
        assert!(two.iter().any(|s| s.starts_with("dropped: the picture of a second")), "{two:?}");
    }
}

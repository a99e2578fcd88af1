//! Every texture of pbrt-v4 and of Mitsuba 3 and 0.6, with every parameter that their manuals have, as files: each is
//! read and compiled without a word, and what is no parameter is named.

use std::path::Path;
use steradian::{
    CompileOptions, compile,
    image::{Image, WriteOptions, write},
    load,
    scene::{Diagnostic, Diagnostics, Severity},
};

/// Messages about a scene on its way to the render, without the one that the sampler is ours.
fn said(folder: &Path, name: &str, text: &str) -> Vec<String> {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    let loaded = load(path, &Default::default());
    let messages = |d: &Diagnostics| {
        // What concerns speed and precision alone is noted.
        let is_note = |d: &Diagnostic| d.severity == Severity::Note && d.message.contains(" has no effect: ");
        let others = d.iter().filter(|d| !is_note(d)).map(|d| d.message.clone());
        others.filter(|m| !m.starts_with("sampler ")).collect::<Vec<_>>()
    };
    let mut all = messages(&loaded.diagnostics);
    if !loaded.diagnostics.has_errors() {
        let compiled = compile(&loaded.desc, &CompileOptions::default());
        all.extend(messages(&compiled.diagnostics));
        assert_eq!(compiled.scene.is_none(), compiled.diagnostics.has_errors());
    }
    all
}

/// A folder with a picture (`i.png`, `i.exr`) and a grid of eight numbers (`g.vol`).
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let pixels: Vec<[f32; 3]> = (0..64).map(|i| [i as f32 / 64.0, 0.5, 0.25]).collect();
    let image = Image::from_rgb(8, 8, &pixels).unwrap();
    for name in ["i.png", "i.exr"] {
        write(&folder.path().join(name), &image, &WriteOptions::default()).unwrap();
    }
    let mut grid = b"VOL\x03".to_vec();
    [1_i32, 2, 2, 2, 1].iter().for_each(|v| grid.extend(v.to_le_bytes()));
    let bounds = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0];
    bounds.into_iter().chain((0..8).map(|i| i as f32 / 8.0)).for_each(|v| grid.extend(v.to_le_bytes()));
    std::fs::write(folder.path().join("g.vol"), grid).unwrap();
    folder
}

/// pbrt-v4's 2-D mappings with all their parameters.
const MAPPINGS: [&str; 4] = [
    r#""string mapping" "uv" "float uscale" 2 "float vscale" 3 "float udelta" 0.25 "float vdelta" 0.5"#,
    r#""string mapping" "spherical""#,
    r#""string mapping" "cylindrical""#,
    r#""string mapping" "planar" "vector3 v1" [1 0 0] "vector3 v2" [0 0 1] "float udelta" 0.25 "float vdelta" 0.5"#,
];

#[test]
fn pbrt() {
    let folder = folder();
    // The classes of either type; `VALUE name VALUES` stands for a value of the texture's own type.
    let both = [
        ("constant", vec![r#"VALUE value VALUES"#.to_string()]),
        ("scale", vec![r#""texture tex" "one" "texture scale" "number""#.into(), r#"VALUE tex VALUES "float scale" 0.5"#.into()]),
        ("mix", vec![r#""texture tex1" "one" VALUE tex2 VALUES "texture amount" "number""#.into()]),
        ("directionmix", vec![r#""texture tex1" "one" VALUE tex2 VALUES "vector3 dir" [0 0 1]"#.into()]),
        ("bilerp", MAPPINGS.map(|m| format!("VALUE v00 VALUES VALUE v01 VALUES VALUE v10 VALUES VALUE v11 VALUES {m}")).to_vec()),
        ("dots", MAPPINGS.map(|m| format!("VALUE inside VALUES \"texture outside\" \"one\" {m}")).to_vec()),
        (
            "checkerboard",
            MAPPINGS
                .map(|m| format!("\"integer dimension\" 2 VALUE tex1 VALUES \"texture tex2\" \"one\" {m}"))
                .into_iter()
                .chain([r#""integer dimension" 3 VALUE tex1 VALUES VALUE tex2 VALUES"#.to_string()])
                .collect(),
        ),
        (
            "imagemap",
            ["point", "bilinear", "trilinear", "ewa", "EWA"]
                .iter()
                .zip(["repeat", "clamp", "black", "octahedralsphere", "repeat"])
                .zip(["sRGB", "linear", "gamma 2.2", "sRGB", "sRGB"])
                .zip(MAPPINGS.iter().cycle())
                .map(|(((filter, wrap), encoding), m)| {
                    format!(
                        r#""string filename" "i.png" "string filter" "{filter}" "string wrap" "{wrap}" "string encoding" "{encoding}"
                        "float maxanisotropy" 4 "float scale" 0.5 "bool invert" true {m}"#
                    )
                })
                .chain([r#""string filename" "i.exr""#.to_string()])
                .collect(),
        ),
    ];
    let noise = r#""integer octaves" 6 "float roughness" 0.4"#;
    let mut cases: Vec<(&str, &str, String)> = vec![
        ("float", "fbm", noise.into()),
        ("float", "wrinkled", noise.into()),
        ("float", "windy", String::new()),
        ("spectrum", "marble", format!(r#"{noise} "float scale" 2 "float variation" 0.3"#)),
    ];
    for (class, parameters) in &both {
        cases.extend(parameters.iter().flat_map(|p| [("float", *class, p.clone()), ("spectrum", *class, p.clone())]));
    }
    for (values, class, parameters) in cases {
        let mut text = String::new();
        let mut words = parameters.split(' ');
        while let Some(word) = words.next() {
            if word != "VALUE" {
                text += &format!("{word} ");
                continue;
            }
            let (name, value) = (words.next().unwrap(), if values == "float" { "0.5" } else { "[0.2 0.4 0.6]" });
            assert_eq!(words.next(), Some("VALUES"));
            text += &format!("\"{} {name}\" {value} ", if values == "float" { "float" } else { "rgb" });
        }
        let (one, material) = match values {
            "float" => ("\"float value\" 0.3", "Material \"conductor\" \"texture roughness\" \"t\""),
            _ => ("\"rgb value\" [0.3 0.2 0.1]", "Material \"diffuse\" \"texture reflectance\" \"t\""),
        };
        let scene = format!(
            "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n\
             Texture \"one\" \"{values}\" \"constant\" {one}\nTexture \"number\" \"float\" \"constant\" \"float value\" 0.3\n\
             Scale 2 2 2\nTexture \"t\" \"{values}\" \"{class}\" {text}\n{material}\nShape \"sphere\"\n"
        );
        assert_eq!(said(folder.path(), "s.pbrt", &scene), Vec::<String>::new(), "{scene}");
        // A parameter too many is named.
        let more =
            scene.replace(&format!("\"{class}\" {text}"), &format!("\"{class}\" {text}\"float frobnication\" 3"));
        let messages = said(folder.path(), "s.pbrt", &more);
        assert!(messages.iter().any(|m| m.contains("frobnication")), "{messages:?} {more}");
    }
    let ptex = "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nTexture \"t\" \"spectrum\" \"ptex\" \"string filename\" \"a.ptx\"\n";
    assert!(said(folder.path(), "p.pbrt", ptex).iter().any(|m| m.contains("Ptex")));
}

#[test]
fn mitsuba() {
    let folder = folder();
    let named = |kind: &str, name: &str, value: &str| format!("<{kind} name='{name}' value='{value}'/>");
    let to_uv = "<transform name='to_uv'><scale x='2' y='3'/><rotate z='1' angle='30'/></transform>";
    let bitmap = |inside: String| {
        format!("<texture type='bitmap' name='reflectance'>{}{inside}</texture>", named("string", "filename", "i.png"))
    };
    let mut cases = Vec::new();
    for (filter, wrap) in [("bilinear", "repeat"), ("nearest", "mirror"), ("bilinear", "clamp")] {
        cases.push((
            "3.0.0",
            bitmap(
                named("string", "filter_type", filter)
                    + &named("string", "wrap_mode", wrap)
                    + &named("boolean", "raw", "true")
                    + &named("string", "format", "fp16")
                    + &named("boolean", "accel", "false")
                    + to_uv,
            ),
        ));
    }
    cases.push((
        "3.0.0",
        format!(
            "<texture type='checkerboard' name='reflectance'><rgb name='color0' value='0.1 0.2 0.3'/>
             <texture type='bitmap' name='color1'><string name='filename' value='i.png'/></texture>{to_uv}</texture>"
        ),
    ));
    let volume = |inside: &str| format!("<texture type='volume' name='reflectance'>{inside}</texture>");
    cases.push((
        "3.0.0",
        volume("<volume type='constvolume' name='volume'><rgb name='value' value='0.1 0.2 0.3'/></volume>"),
    ));
    for (filter, wrap) in [("trilinear", "clamp"), ("nearest", "repeat"), ("trilinear", "mirror")] {
        cases.push((
            "3.0.0",
            volume(&format!(
                "<volume type='gridvolume' name='volume'>{}{}{}{}{}{}<transform name='to_world'><scale value='2'/></transform></volume>",
                named("string", "filename", "g.vol"),
                named("string", "filter_type", filter),
                named("string", "wrap_mode", wrap),
                named("boolean", "use_grid_bbox", "true"),
                named("boolean", "raw", "true"),
                named("boolean", "accel", "false"),
            )),
        ));
    }
    // Version 0.6.
    for (filter, u, v) in [("ewa", "repeat", "mirror"), ("trilinear", "clamp", "zero"), ("nearest", "one", "one")] {
        cases.push((
            "0.6.0",
            bitmap(
                named("string", "filterType", filter)
                    + &named("string", "wrapModeU", u)
                    + &named("string", "wrapModeV", v)
                    + &named("float", "maxAnisotropy", "10")
                    + &named("float", "gamma", "2.2")
                    + &named("boolean", "cache", "false")
                    + &named("string", "channel", "g")
                    + &["uoffset", "voffset", "uscale", "vscale"].map(|n| named("float", n, "0.5")).concat(),
            ),
        ));
    }
    cases.push(("0.6.0", bitmap(named("string", "wrapMode", "one"))));
    cases.push((
        "0.6.0",
        format!(
            "<texture type='checkerboard' name='reflectance'><spectrum name='color0' value='0.1'/><rgb name='color1' value='0.1 0.2 0.3'/>{}</texture>",
            ["uoffset", "voffset", "uscale", "vscale"].map(|n| named("float", n, "2")).concat()
        ),
    ));
    cases.push((
        "0.6.0",
        format!(
            "<texture type='scale' name='reflectance'>{}<float name='scale' value='0.5'/></texture>",
            bitmap(String::new())
        ),
    ));
    for (version, texture) in cases {
        let scene = format!(
            "<scene version='{version}'><sensor type='perspective'/><emitter type='constant'/><integrator type='path'/>
             <shape type='rectangle'><bsdf type='diffuse'>{texture}</bsdf></shape></scene>"
        );
        assert_eq!(said(folder.path(), "s.xml", &scene), Vec::<String>::new(), "{scene}");
        let at = scene.find("</texture></bsdf>").unwrap();
        let more = format!("{}{}{}", &scene[..at], named("float", "frobnication", "3"), &scene[at..]);
        let messages = said(folder.path(), "s.xml", &more);
        assert!(messages.iter().any(|m| m.contains("frobnication")), "{messages:?} {more}");
    }
    // Attributes need a mesh that has them.
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float r\nproperty float g\n\
               property float b\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
               0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n";
    std::fs::write(folder.path().join("m.ply"), ply).unwrap();
    let scene = "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/><integrator type='path'/>
         <shape type='ply'><string name='filename' value='m.ply'/><bsdf type='diffuse'><texture type='mesh_attribute' name='reflectance'>
         <string name='name' value='vertex_color'/><float name='scale' value='0.5'/></texture></bsdf></shape></scene>";
    assert_eq!(said(folder.path(), "m.xml", scene), Vec::<String>::new());
}

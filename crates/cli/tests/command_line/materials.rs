//! `steradian material`.

use crate::Place;

#[test]
fn a_material_is_measured() {
    let place = Place::new();
    let gold = ["material", "conductor", "-p", "eta=metal-Au-eta", "k=metal-Au-k", "alpha_u=0.2"];
    let with = |more: &[&'static str]| [&gold[..], more].concat();
    let json = place.succeed(&with(&["--albedo", "--gloss", "--fit", "--samples", "4096", "--json"])).json();
    let red = json["albedo"][0]["reflectance"][0].as_f64().unwrap();
    assert!((0.8..1.0).contains(&red), "gold is red: {json}");
    assert_eq!((json["gloss"][1]["theta"].as_f64(), json["fit"][4]["model"].as_str()), (Some(60.0), Some("ggx")));
    let text = place.succeed(&with(&["--albedo", "--gloss", "--samples", "4096"])).stdout;
    assert!(text.contains("gloss 60°") && text.contains("albedo (red, green, blue)"), "{text}");
    place.succeed(&with(&["--plot", "lobe.svg", "--picture", "ball.png", "--size", "16x16", "--spp", "1"]));
    assert!(place.path("lobe.svg").is_file() && place.path("ball.png").is_file());
}

/// Readings are told before the picture is made, so that nothing that goes wrong with it takes them along.
#[cfg(target_os = "linux")]
#[test]
fn readings_outlive_the_picture() {
    let place = Place::new();
    std::os::unix::fs::symlink("/dev/full", place.path("full.png")).unwrap();
    let asked = ["--plot", "lobe.svg", "--albedo", "--samples", "64", "--picture", "full.png", "--spp", "1"];
    let run = place.run(&[&["material", "conductor"], &asked[..]].concat());
    assert!(run.code == 1 && run.stderr.contains("full.png"), "{}", run.stderr);
    assert!(run.stdout.contains("albedo (red, green, blue)") && place.path("lobe.svg").is_file(), "{}", run.stdout);
}

/// A measured material can be measured again from its own table.
#[test]
fn a_table_is_a_material() {
    let place = Place::new();
    place.succeed(&["material", "diffuse", "-p", "reflectance=0.5", "--table", "matt.txt"]);
    let json = place.succeed(&["material", "measured", "-p", "file=matt.txt", "--albedo", "--json"]).json();
    let albedo = json["albedo"][2]["reflectance"][0].as_f64().unwrap();
    assert!((albedo - 0.5).abs() < 0.01, "{albedo}");
}

#[test]
fn pairs_of_directions_are_evaluated() {
    let place = Place::new();
    std::fs::write(
        place.path("pairs.json"),
        r#"[{"wo": [0,0,1], "wi": [0.6,0,0.8]}, {"wo": [0,0,1], "wi": [0,0,-1]}]"#,
    )
    .unwrap();
    let json =
        place.succeed(&["material", "diffuse", "-p", "reflectance=0.5", "--eval", "pairs.json", "--json"]).json();
    let value = json["eval"][0]["value"][1].as_f64().unwrap();
    assert!((value - 0.5 * 0.8 / std::f64::consts::PI).abs() < 1e-6, "{json}");
    assert!((json["eval"][0]["pdf"].as_f64().unwrap() - 0.8 / std::f64::consts::PI).abs() < 1e-6);
    assert_eq!(json["eval"][1]["value"][0], 0.0);
    // A material of a scene, at four wavelengths.
    let json = place
        .succeed(&["material", "builtin:cornell-box:red", "--eval", "pairs.json", "--color", "spectral", "--json"])
        .json();
    assert_eq!(json["wavelengths"][0], 450.0);
    assert!(json["eval"][0]["value"][3].as_f64() > json["eval"][0]["value"][0].as_f64(), "red at 650 nm: {json}");
}

#[test]
fn slips_are_named() {
    let place = Place::new();
    place.refuse(2, &["material", "conducter"], &["did you mean 'conductor'?"]);
    place.refuse(2, &["material", "diffuse", "-p", "reflectence=1"], &["did you mean 'reflectance'?"]);
    place.refuse(2, &["material", "builtin:cornell-box:rde"], &["no material 'rde'"]);
    place.refuse(2, &["material", "diffuse", "--eval", "none.json"], &["cannot read pairs"]);
    place.refuse(2, &["material", "diffuse", "--wavelengths", "1,2,3,4"], &["360 to 830"]);
    std::fs::write(place.path("long.json"), r#"[{"wo": [0,0,2], "wi": [0,0,1]}]"#).unwrap();
    place.refuse(2, &["material", "diffuse", "--eval", "long.json"], &["not of length one"]);
}

/// A random surface of mirrors loses next to nothing at the normal, and its table is a material that reflects as much.
#[test]
fn geometry_is_a_material() {
    let place = Place::new();
    let rough = ["material", "conductor", "--microsurface", "0.3", "--samples", "8192"];
    let json = place.succeed(&[&rough[..], &["--albedo", "--table", "rough.txt", "--json"]].concat()).json();
    let albedo = |k: usize| json["relief"][k]["albedo"].as_f64().unwrap();
    assert!(albedo(0) > 0.99 && albedo(8) > 0.99 && albedo(8) <= 1.0, "{json}");
    assert!(json["relief"][0]["single"].as_f64().unwrap() > 0.9, "{json}");
    let json = place.succeed(&["material", "measured", "-p", "file=rough.txt", "--albedo", "--json"]).json();
    let again = json["albedo"][2]["reflectance"][0].as_f64().unwrap();
    assert!((again - albedo(2)).abs() < 0.08, "{again} of the table, {} of the surface", albedo(2));
    // A flat square of a matt material is that material.
    let square = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n4 0 1 2 3\n";
    std::fs::write(place.path("square.ply"), square).unwrap();
    let flat = ["material", "diffuse", "-p", "reflectance=0.5", "--geometry", "square.ply", "--albedo"];
    let text = place.succeed(&[&flat[..], &["--samples", "1024"]].concat()).stdout;
    assert!(text.contains("  0.50000   0.50000"), "{text}");
    place.refuse(2, &["material", "diffuse", "--geometry", "none.ply", "--albedo"], &["none.ply"]);
    place.refuse(2, &["material", "diffuse", "--microsurface", "0", "--albedo"], &["roughness"]);
    place.refuse(2, &["material", "diffuse", "--microsurface", "0.2", "--gloss"], &["cannot be used with"]);
}

/// The albedo told of a fibre is that of a picture of it in even light, in the mean over its width.
#[test]
fn fibres_have_the_albedo_that_a_furnace_shows() {
    let place = Place::new();
    let line = ["material", "hair", "-p", "eumelanin=0.3", "--albedo", "--samples", "65536", "--json"];
    let json = place.succeed(&line).json();
    // A strip that faces the viewer, and goes beyond the view along the fibre alone.
    for (row, angle) in [(0, 0.0), (4, 60.0), (7, 85.0)] {
        let scene = format!(
            r#"LookAt 0 0 50  0 0 0  0 1 0  Camera "orthographic" "float screenwindow" [-1 1 -1 1]
            Film "rgb" "integer xresolution" 16 "integer yresolution" 16  PixelFilter "box"
            Integrator "path" "integer maxdepth" 3  WorldBegin  LightSource "infinite" "rgb L" [1 1 1]
            Material "hair" "float eumelanin" 0.3  Rotate {angle} 0 1 0
            Shape "trianglemesh" "point3 P" [-99 -1 0 99 -1 0 99 1 0 -99 1 0] "integer indices" [0 1 2 0 2 3]
              "point2 uv" [0 0 1 0 1 1 0 1]"#
        );
        place.file("furnace.pbrt", &scene);
        place.succeed(&["render", "furnace.pbrt", "-q", "--spp", "256", "--color", "rgb", "-o", "furnace.exr"]);
        let picture = place.picture("furnace.exr");
        for (k, name) in ["R", "G", "B"].into_iter().enumerate() {
            let values = picture.channel(name).unwrap();
            let shown = values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64;
            let part = |of: &str| json["albedo"][row][of][k].as_f64().unwrap();
            let told = part("reflectance") + part("transmittance");
            assert_eq!(json["albedo"][row]["theta"].as_f64(), Some(angle));
            assert!((told / shown - 1.0).abs() < 0.01, "{angle}° {name}: {told} told, {shown} shown");
        }
    }
}

/// Without a reading asked for, parameters and a summary are told; laws with p-values, of a scene's material too; of
/// fits the best is named.
#[test]
fn summaries_laws_and_best_fits() {
    let place = Place::new();
    let text = place.succeed(&["material", "phong", "-p", "exponent=12"]).stdout;
    let row = |name: &str| text.lines().find(|l| l.split_whitespace().next() == Some(name)).unwrap_or_default();
    assert!(row("exponent").contains(" 12 ") && row("exponent").contains(" set "), "{text}");
    assert!(row("form").contains("modified") && row("form").contains(" default "), "{text}");
    assert!(row("transmits").ends_with("no") && row("lobes").contains("glossy reflection"), "{text}");
    assert!(text.contains("conserves energy yes") && text.contains("reflectance"), "{text}");
    let json = place.succeed(&["material", "dielectric", "-p", "eta=1.5", "--json"]).json();
    assert_eq!((json["kind"].as_str(), json["summary"]["is_transmitting"].as_bool()), (Some("dielectric"), Some(true)));
    assert!((json["summary"]["white"][0]["reflectance"].as_f64().unwrap() - 0.04).abs() < 1e-4, "{json}");
    let eta = json["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "eta").unwrap();
    assert_eq!(
        (eta["value"].as_str(), eta["default"].as_str(), eta["range"][1].as_f64()),
        (Some("1.5"), Some("1.5"), Some(20.0))
    );
    let laws = ["--laws", "--samples", "4096"];
    let json = place.succeed(&[&["material", "builtin:cornell-box:red", "--json"][..], &laws].concat()).json();
    assert_eq!(json["laws"]["hold"], true, "{json}");
    assert!(json["laws"]["laws"].as_array().unwrap().iter().any(|l| l["p"].is_f64()));
    let text = place.succeed(&[&["material", "phong", "-p", "form=empirical"][..], &laws].concat()).stdout;
    assert!(text.contains("BROKEN") && text.contains("not all laws hold"), "{text}");
    let json = place.succeed(&["material", "ward", "-p", "form=duer", "alpha_u=0.3", "--fit", "--json"]).json();
    assert_eq!(json["best_fit"], "ward-duer", "{json}");
}

/// Kinds that need more tell their parameters and how they are given; a material of a scene tells what the scene sets;
/// everyday names and scenes without a name are answered with a command that works.
#[test]
fn a_newcomer_finds_a_material() {
    let place = Place::new();
    for kind in ["mix", "mask", "two_sided", "measured"] {
        let run = place.succeed(&["material", kind]);
        assert!(
            run.stdout.contains("needed") && run.stderr.contains(&format!("steradian material {kind} -p")),
            "{kind}"
        );
    }
    let text = place.succeed(&["material", "interface"]).stdout;
    assert!(text.contains("no scattering") && !text.contains("transmits"), "{text}");
    place.succeed(&["material", "mix", "-p", "materials=diffuse|conductor", "--samples", "64"]);
    let json = place.succeed(&["material", "builtin:cornell-box:red", "--samples", "64", "--json"]).json();
    assert_eq!((json["kind"].as_str(), json["parameters"][0]["is_default"].as_bool()), (Some("diffuse"), Some(false)));
    place.refuse(2, &["material", "builtin:cornell-box"], &["is a scene", "red", "material builtin:cornell-box:"]);
    for everyday in [
        "gold",
        "silver",
        "copper",
        "aluminium",
        "brass",
        "metal",
        "mirror",
        "glass",
        "water",
        "matte",
        "paint",
        "skin",
        "fabric",
    ] {
        let run = place.run(&["material", everyday]);
        let command =
            run.stderr.split("try: steradian ").nth(1).and_then(|t| t.split(" (known").next()).unwrap_or_default();
        assert!(run.code == 2 && !command.is_empty(), "{everyday}: {}", run.stderr);
        let words: Vec<_> = command.split(' ').chain(["--samples", "64"]).collect();
        place.succeed(&words);
    }
}

/// By its logarithm a plot shows what is weak beside a narrow lobe; a scale without a plot is refused.
#[test]
fn plots_have_a_logarithmic_radius() {
    let place = Place::new();
    let rough = ["material", "plastic", "-p", "alpha_u=0.2", "--plot"];
    place.succeed(&[&rough[..], &["a.svg"]].concat());
    place.succeed(&[&rough[..], &["b.svg", "--plot-scale", "log"]].concat());
    let [a, b] = ["a.svg", "b.svg"].map(|f| std::fs::read_to_string(place.path(f)).unwrap());
    assert!(!a.contains("logarithmic") && b.contains("logarithmic") && b.contains("plastic alpha_u=0.2"));
    place.refuse(2, &["material", "plastic", "--plot-scale", "log"], &["--plot"]);
}

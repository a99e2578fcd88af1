//! Scene files: good ones, bad ones, and ones of which something is lost.

use crate::{Place, asset};

const GOOD: &str = r#"
LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Sampler "independent" "integer pixelsamples" 2
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "string filename" "x.exr"
WorldBegin
LightSource "point" "rgb I" [9 9 9] "point3 from" [0 3 -3]
Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "sphere"
"#;

const MITSUBA: &str = r#"<scene version="3.0.0">
  <default name="spp" value="2"/>
  <integrator type="path"/>
  <sensor type="perspective">
    <transform name="to_world"><lookat origin="0,0,-4" target="0,0,0" up="0,1,0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film>
  </sensor>
  <emitter type="constant"/>
  <shape type="sphere"/>
</scene>
"#;

#[test]
fn a_scene_names_its_pictures() {
    let place = Place::new();
    place.file("ball.v2.pbrt", GOOD);
    let json = place.succeed(&["render", "ball.v2.pbrt", "--json"]).json();
    assert_eq!(json["outputs"], serde_json::json!(["ball.v2.exr", "ball.v2.png"]));
    assert_eq!((&json["spp"], &json["width"], &json["color"]), (&2.into(), &24.into(), &"spectral".into()));
    let picture = place.picture("ball.v2.exr");
    assert_eq!((picture.width(), picture.height()), (24, 16));
    assert!(picture.rgb().unwrap().at(8 * 24 + 12)[1] > 0.0, "the ball is lit");
    assert_eq!(picture.rgb().unwrap().at(0), [0.0; 3], "the corner is empty");
}

#[test]
fn parameters_of_mitsuba_scenes_are_set() {
    let place = Place::new();
    place.file("ball.xml", MITSUBA);
    let spp = |more: &[&str]| {
        place.succeed(&[&["render", "ball.xml", "--json", "-q"][..], more].concat()).json()["spp"].clone()
    };
    assert_eq!(spp(&[]), 2);
    assert_eq!(spp(&["-D", "spp=3"]), 3);
    assert_eq!(spp(&["-Dspp=4"]), 4);
    assert_eq!(spp(&["-Dspp=4", "--spp", "5"]), 5);
    place.refuse(2, &["render", "ball.xml", "-D", "spp"], &["NAME=VALUE"]);
    place.file("ball.pbrt", GOOD);
    assert!(place.succeed(&["render", "ball.pbrt", "-Da=1"]).stderr.contains("no effect"));
}

#[test]
fn errors_have_file_line_and_column_and_come_together() {
    let place = Place::new();
    let bad = GOOD.replace("Material \"diffuse\"", "Materiel \"diffuse\"").replace("\"sphere\"", "\"sphair\"");
    place.file("bad.pbrt", &bad);
    let about = ["bad.pbrt:8:1", "Materiel", "did you mean 'Material'?", "bad.pbrt:9:7", "sphair", "^^^^", "2 errors"];
    place.refuse(2, &["render", "bad.pbrt"], &about);
    place.refuse(2, &["render", "bad.pbrt", "--quiet"], &about);
    assert!(!place.path("bad.exr").exists());
}

#[test]
fn broken_files_are_refused() {
    let place = Place::new();
    place
        .file("empty.pbrt", "")
        .file("cut.xml", &MITSUBA[..200])
        .file("noise.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\n");
    place.file("zero.pbrt", &GOOD.replace("24", "0")).file("scene.blend", "x").file("scene.gltf", "{}");
    for (name, about) in [
        ("empty.pbrt", "empty.pbrt"),
        ("cut.xml", "cut.xml:"),
        ("noise.ply", "noise.ply"),
        ("zero.pbrt", "film is empty"),
        ("scene.blend", "known are"),
        ("scene.gltf", "not glTF"),
        (".", "folder"),
    ] {
        place.refuse(2, &["render", name], &[about]);
    }
}

#[test]
fn strict_refuses_losses() {
    let place = Place::new();
    place.file("lossy.pbrt", &GOOD.replace("WorldBegin", "Integrator \"randomwalk\" WorldBegin"));
    let run = place.succeed(&["render", "lossy.pbrt", "--json"]);
    assert!(run.stderr.contains("approximated: ") && run.stderr.contains("lossy.pbrt:6:"), "{}", run.stderr);
    assert_eq!(run.json()["diagnostics"]["approximated"], 1);
    let quiet = place.succeed(&["render", "lossy.pbrt", "--quiet"]);
    assert_eq!(quiet.stderr, "");
    place.refuse(
        2,
        &["render", "lossy.pbrt", "--strict"],
        &["error: ", "randomwalk", "--strict refuses", "lossy.pbrt:"],
    );
    place.file("good.pbrt", GOOD).succeed(&["render", "good.pbrt", "--strict"]);
}

#[test]
fn info_tells_what_is_in_a_scene() {
    let place = Place::new();
    let good = GOOD.replace("WorldBegin", "Integrator \"randomwalk\" WorldBegin");
    place.file("ball.pbrt", &good.replace("Shape \"sphere\"", "ObjectBegin \"o\"\nShape \"sphere\"\nObjectEnd\nObjectInstance \"o\"\nMaterial \"subsurface\"\nShape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [0 0 0 1 0 0 0 1 0]"));
    let json = place.succeed(&["info", "ball.pbrt", "--json"]).json();
    assert_eq!((&json["schema"], &json["format"]), (&1.into(), &"pbrt".into()));
    let counts = &json["counts"];
    assert_eq!((&counts["shapes"], &counts["instances"], &counts["triangles"]), (&2.into(), &1.into(), &1.into()));
    assert_eq!(counts["models"]["shape"], serde_json::json!({"mesh": 1, "sphere": 1}));
    assert_eq!((&counts["models"]["light"]["point"], &counts["lights"]), (&1.into(), &1.into()));
    assert_eq!((&json["film"]["width"], &json["settings"]["spp"]), (&24.into(), &2.into()));
    assert_eq!(json["diagnostics"]["approximated"], 1);
    let messages = json["messages"].as_array().unwrap();
    let about = messages.iter().find(|m| m["message"].as_str().unwrap().contains("randomwalk")).unwrap();
    assert_eq!((&about["location"]["line"], &about["fidelity"]), (&6.into(), &"approximated".into()));
    assert!(json["bounds"][1][0].as_f64().is_some_and(|x| (x - 1.0).abs() < 1e-3), "{}", json["bounds"]);
    assert!(json["memory"]["geometry_bytes"].as_u64().unwrap() > 0);
    let tables = json["memory"]["tables"].as_array().unwrap();
    let table = |name: &str| tables.iter().find(|t| t["name"] == name).unwrap();
    assert_eq!((&table("shapes")["count"], &table("instances")["count"]), (&2.into(), &1.into()));
    // A triangle has three vertices of twelve bytes.
    assert!(table("shapes")["bytes"].as_u64().unwrap() >= 36);
    let run = place.succeed(&["info", "ball.pbrt"]);
    for part in ["2 shapes: ", "pbrt-v4", "24 x 16", "1 of 1 groups", "perspective", "1 approximated"] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }
    assert!(run.stderr.contains("approximated: "));
    place.refuse(2, &["info", "nowhere.xml"], &["nowhere.xml"]);
}

#[test]
fn published_scenes_render() {
    let scenes = [
        "pbrt/cornell-box/scene-v4.pbrt",
        "pbrt/veach-mis/scene-v4.pbrt",
        "pbrt/volumetric-caustic/scene-v4.pbrt",
        "mitsuba/scenes/cbox/cbox.xml",
    ];
    let place = Place::new();
    for scene in scenes.into_iter().filter_map(asset) {
        let scene = scene.to_str().unwrap();
        let json = place.succeed(&["render", scene, "--size", "24x16", "--spp", "2", "--json", "-o", "x.exr"]).json();
        assert_eq!((&json["samples"], &json["nonfinite_dropped"]), (&(24 * 16 * 2).into(), &0.into()), "{scene}");
        let picture = place.picture("x.exr");
        assert!(picture.channel("G").unwrap().iter().any(|v| *v > 0.0), "{scene} is black");
    }
}

/// Definitions by -D that nothing uses are told, and refused with --strict, by all commands that take it.
#[test]
fn definitions_without_effect_are_told() {
    let place = Place::new();
    place.file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for command in [&["render", "m.obj"][..], &["convert", "m.obj", "m.steradian"], &["verify", "m.obj", "--spp", "2"]]
    {
        let strict = [command, &["-D", "gruond=false", "--strict"]].concat();
        place.refuse(2, &strict, &["did you mean 'ground'?", "--strict"]);
    }
    place.refuse(2, &["material", "diffuse", "-D", "foo=1", "--strict"], &["'foo' has no effect", "--strict"]);
    let run = place.succeed(&["info", "m.obj", "-D", "gruond=false"]);
    assert!(run.stderr.contains("unused: -D sets nothing called 'gruond' here"), "{}", run.stderr);
    assert_eq!(place.succeed(&["info", "m.obj", "-D", "ground=false"]).stderr, "");
}

/// Ambient occlusion of a pbrt scene is grey, as in pbrt, and its rays have the length that the file names.
#[test]
fn ambient_occlusion_is_rendered_as_such() {
    let place = Place::new();
    // A floor seen from above, before an endless wall 2 away. Directions of density cosθ/π are evenly spread over the
    // unit disk when they are projected onto the floor; rays of length d meet the wall where x > 2/d.
    let open = 0.5 + 0.02 * std::f64::consts::FRAC_2_PI;
    for (distance, open) in [("1", 1.0), ("100", open)] {
        place.file(
            "ao.pbrt",
            &format!(
                "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nSampler \"zsobol\" \"integer pixelsamples\" 256\n\
                 Integrator \"ambientocclusion\" \"float maxdistance\" {distance}\n\
                 LookAt 0 1 0  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 1\nWorldBegin\n\
                 Shape \"bilinearmesh\" \"point3 P\" [-9 0 -9 9 0 -9 -9 0 9 9 0 9]\n\
                 Shape \"bilinearmesh\" \"point3 P\" [2 0 -9999 2 0 9999 2 9999 -9999 2 9999 9999]\n"
            ),
        );
        place.succeed(&["render", "ao.pbrt", "-q", "-o", "ao.exr"]);
        let picture = place.picture("ao.exr");
        let mean = |name: &str| {
            let plane = picture.channel(name).unwrap();
            plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
        };
        // Four standard errors of 8 x 8 x 256 samples that are 0 or 1, by wavelengths whose colours vary as much again.
        // A flat spectrum would be 1.205 times as red.
        for name in ["R", "G", "B"] {
            assert!((mean(name) - open).abs() < 4.0 / 128.0, "{distance}: {name} {}", mean(name));
        }
    }
}

/// Light tracing renders what light paths can bring to the camera, and says that what smooth glass shows is missing.
#[test]
fn light_tracing_says_what_is_missing() {
    let place = Place::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/verify/caustic.pbrt");
    let run =
        place.succeed(&["render", scene, "--integrator", "light", "--size", "16x16", "--spp", "4", "-o", "l.exr"]);
    let what = "integrator 'light' leaves out what smooth surfaces show, such as ";
    assert!(run.stderr.contains(what) && run.stderr.contains("; 'bdpt' renders it"), "{}", run.stderr);
    assert!(place.picture("l.exr").channel("G").unwrap().iter().any(|v| *v > 0.0));
}

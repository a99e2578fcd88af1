//! `steradian render`.

use crate::Place;
use steradian::image::Value;

/// A render that takes a moment.
const SMALL: [&str; 5] = ["render", "--size", "32x32", "--spp", "4"];

fn small<'a>(more: &[&'a str]) -> Vec<&'a str> {
    SMALL.iter().chain(more).copied().collect()
}

#[test]
fn without_a_scene_the_cornell_box_appears() {
    let place = Place::new();
    let run = place.succeed(&SMALL);
    assert_eq!(run.stdout, "", "stdout is for data");
    assert!(run.stderr.contains("cornell-box.exr") && run.stderr.contains("cornell-box.png"), "{}", run.stderr);
    let (exr, png) = (place.picture("cornell-box.exr"), place.picture("cornell-box.png"));
    assert_eq!((exr.width(), exr.height(), png.width(), png.height()), (32, 32, 32, 32));
    // Red wall to the left, green one to the right, and light on both.
    let [left, right] = [exr.rgb().unwrap().at(16 * 32 + 2), exr.rgb().unwrap().at(16 * 32 + 29)];
    assert!(left[0] > 2.0 * left[1] && right[1] > 2.0 * right[0], "{left:?} {right:?}");
    let mut files: Vec<_> = std::fs::read_dir(&place.0).unwrap().map(|f| f.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["cornell-box.exr", "cornell-box.png"], "nothing else is left behind");
}

#[test]
fn json_tells_what_was_done() {
    let place = Place::new();
    let run = place.succeed(&small(&[
        "--json",
        "--seed",
        "7",
        "--threads",
        "2",
        "-o",
        "a.exr",
        "-o",
        "b.png",
        "--integrator",
        "direct",
    ]));
    let json = run.json();
    for key in ["load_seconds", "build_seconds", "render_seconds", "cpu_seconds"] {
        assert!(json[key].as_f64().is_some_and(|v| v >= 0.0), "{key}: {json}");
    }
    for (key, expected) in [("schema", 1), ("spp", 4), ("seed", 7), ("width", 32), ("height", 32), ("threads", 2)] {
        assert_eq!(json[key], expected, "{key}");
    }
    assert_eq!(json["samples"], 32 * 32 * 4);
    assert!(json["rays"].as_u64().unwrap() > 32 * 32 * 4);
    assert_eq!((&json["scene"], &json["integrator"]), (&"builtin:cornell-box".into(), &"direct".into()));
    assert_eq!(json["outputs"], serde_json::json!(["a.exr", "b.png"]));
    assert_eq!((&json["nonfinite_dropped"], &json["color"], &json["stopped"]), (&0.into(), &"rgb".into(), &().into()));
    assert_eq!(json["diagnostics"]["errors"], 0);
    if cfg!(target_os = "linux") {
        assert!(json["peak_rss_bytes"].as_u64().unwrap() > 1 << 20);
    }
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let place = Place::new();
    let render = |name: &str, threads: &str, more: &[&str]| {
        let arguments = [&["--threads", threads, "--aov", "all", "-q", "-o", name][..], more].concat();
        place.succeed(&small(&arguments));
        let bits = |v: &f32| v.to_bits();
        let image = place.picture(name);
        image
            .channels()
            .iter()
            .map(|c| (c.name.clone(), c.data.iter().map(bits).collect::<Vec<_>>()))
            .collect::<Vec<_>>()
    };
    for scene in ["builtin:cornell-box", "builtin:cornell-box-area"] {
        assert_eq!(render("one.exr", "1", &[scene]), render("three.exr", "3", &[scene]), "{scene}");
    }
    assert_ne!(render("a.exr", "1", &["--seed", "1"]), render("b.exr", "1", &["--seed", "2"]), "the seed matters");
}

#[test]
fn metadata_and_layers_are_in_the_file() {
    let place = Place::new();
    place.succeed(&small(&["-q", "-o", "a.exr", "-o", "a.png", "--aov", "depth,albedo,depth", "--seed", "3"]));
    let exr = place.picture("a.exr");
    let mut names: Vec<_> = exr.channels().iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["B", "G", "R", "Z", "albedo.B", "albedo.G", "albedo.R", "depth.Z"]);
    let get = |key: &str| exr.metadata.get(key).cloned();
    assert_eq!(get("Software"), Some(Value::Text(concat!("Steradian ", env!("CARGO_PKG_VERSION")).into())));
    assert_eq!(get("steradian:scene"), Some(Value::Text("builtin:cornell-box".into())));
    assert_eq!(get("steradian:integrator"), Some(Value::Text("path".into())));
    assert_eq!(get("steradian:color"), Some(Value::Text("rgb".into())));
    assert_eq!((get("samplesPerPixel"), get("steradian:seed")), (Some(Value::Int(4)), Some(Value::Int(3))));
    assert_eq!(get("steradian:nonfinite_dropped"), Some(Value::Int(0)));
    assert!(matches!(get("renderTimeSeconds"), Some(Value::Float(s)) if s > 0.0));
    assert!(place.picture("a.png").metadata.get("Software").is_some());
}

#[test]
fn a_crop_is_a_part_of_the_frame() {
    let place = Place::new();
    place.succeed(&small(&["-q", "-o", "whole.exr"]));
    place.succeed(&small(&["-q", "-o", "part.exr", "--crop", "8,4,24,20"]));
    let (whole, part) = (place.picture("whole.exr"), place.picture("part.exr"));
    assert_eq!((part.width(), part.height(), part.offset), (16, 16, [8, 4]));
    assert_eq!(part.frame.map(|f| f.max), Some([32, 32]));
    for (x, y) in [(0, 0), (15, 15), (7, 3)] {
        assert_eq!(part.rgb().unwrap().at(y * 16 + x), whole.rgb().unwrap().at((y + 4) * 32 + x + 8));
    }
}

#[test]
fn every_format_is_written() {
    let place = Place::new();
    let names = ["a.exr", "a.png", "a.hdr", "a.pfm", "a.ppm", "a.jpg"];
    let arguments: Vec<&str> = names.iter().flat_map(|n| ["-o", n]).collect();
    place.succeed(&small(&[&["-q", "--exr", "half", "--compression", "piz"][..], &arguments].concat()));
    let truth = place.picture("a.exr");
    for name in names {
        let image = place.picture(name);
        let (a, b) = (image.rgb().unwrap().at(500), truth.rgb().unwrap().at(500));
        // JPEG is the coarsest.
        assert!(a.iter().zip(b).all(|(a, b)| (a - b.min(1.0)).abs() < 0.1), "{name}: {a:?} {b:?}");
    }
}

#[test]
fn options_change_the_picture() {
    let place = Place::new();
    let mean = |more: &[&str]| {
        place.succeed(&small(&[&["-q", "-o", "x.exr"][..], more].concat()));
        let image = place.picture("x.exr");
        let g = image.channel("G").unwrap();
        g.iter().sum::<f32>() / g.len() as f32
    };
    let full = mean(&[]);
    let direct = mean(&["--max-depth", "1"]);
    assert!(direct < 0.95 * full, "indirect light is missing: {direct} {full}");
    assert_eq!(direct, mean(&["--integrator", "path:max_depth=1"]));
    let spectral = mean(&["--color", "spectral"]);
    assert!((spectral / full - 1.0).abs() < 0.1 && spectral != full, "{spectral} {full}");
    for sampler in ["independent", "stratified"] {
        let other = mean(&["--sampler", sampler]);
        assert!((other / full - 1.0).abs() < 0.05 && other != full, "{sampler}: {other} {full}");
    }
    let tone = |more: &[&str]| {
        place.succeed(&small(&[&["-q", "-o", "x.png"][..], more].concat()));
        place.picture("x.png").channel("G").unwrap().to_vec()
    };
    let (plain, bright, agx) = (tone(&[]), tone(&["--exposure", "1"]), tone(&["--tonemap", "agx"]));
    let ratio = bright[500] / plain[500];
    assert!((ratio - 2.0).abs() < 0.1, "{ratio}");
    assert!(agx.iter().zip(&plain).any(|(a, p)| (a - p).abs() > 0.05));
}

#[test]
fn time_ends_a_render() {
    let place = Place::new();
    let run = place.succeed(&["render", "--size", "64x64", "--time", "700ms", "--json", "-o", "t.exr"]);
    let json = run.json();
    assert_eq!(json["stopped"], "time");
    let (spp, seconds) = (json["spp"].as_f64().unwrap(), json["render_seconds"].as_f64().unwrap());
    // How much is done by then, and how late the machine notices, is not the program's.
    assert!(spp > 0.0 && seconds >= 0.5, "{spp} spp in {seconds} s");
    assert_eq!(json["samples"].as_f64().unwrap(), (spp * 64.0 * 64.0).round());
    // What ends first, ends it.
    let run = place.succeed(&small(&["--time", "10m", "--json", "-q", "-o", "t.exr"]));
    assert_eq!((&run.json()["spp"], &run.json()["stopped"]), (&4.into(), &().into()));
}

#[test]
fn an_error_ends_the_render() {
    let place = Place::new();
    // A ball before a sky without noise: uneven numbers of samples pay.
    place.file(
        "ball.xml",
        r#"<scene version="3.0.0"><integrator type="path"/>
        <sensor type="perspective"><float name="fov" value="40"/>
            <transform name="to_world"><lookat origin="0, 0, 10" target="0, 0, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="64"/><rfilter type="box"/></film>
        </sensor>
        <emitter type="constant"><rgb name="radiance" value="0.5"/></emitter>
        <shape type="sphere"><bsdf type="roughconductor"><float name="alpha" value="0.6"/></bsdf></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="0.3"/><translate x="6" y="6" z="6"/></transform>
            <emitter type="area"><rgb name="radiance" value="90"/></emitter></shape></scene>"#,
    );
    let run = place.succeed(&[
        "render",
        "ball.xml",
        "--error",
        "0.5%",
        "--adaptive",
        "--aov",
        "samples",
        "--json",
        "-o",
        "e.exr",
    ]);
    let json = run.json();
    assert_eq!((&json["stopped"], &json["adaptive"]), (&"error".into(), &true.into()));
    assert!(json["relative_error"].as_f64().is_some_and(|e| e > 0.0025 && e <= 0.005), "{json}");
    assert!(json["spp"].as_f64().is_some_and(|n| (20.0..2000.0).contains(&n)), "{json}");
    assert!(run.stderr.contains("relative error"), "{}", run.stderr);
    let picture = place.picture("e.exr");
    assert_eq!(picture.metadata.get("steradian:sampling"), Some(&Value::Text("adaptive".into())));
    assert!(matches!(picture.metadata.get("steradian:relative_error"), Some(Value::Float(e)) if *e <= 0.00501));
    let samples = picture.channel("samples.Y").unwrap();
    let (least, most) = samples.iter().fold((f32::MAX, 0.0_f32), |(a, b), n| (a.min(*n), b.max(*n)));
    assert!(least >= 4.0 && most > least, "{least} to {most}");
    // What ends first, ends it; and with one sample nothing is known of the error.
    let run = place.succeed(&small(&["--error", "0.001%", "--json", "-q", "-o", "t.exr"]));
    assert_eq!((&run.json()["spp"], &run.json()["stopped"]), (&4.into(), &().into()));
    let run = place.succeed(&["render", "--size", "8x8", "--spp", "1", "--json", "-q", "-o", "t.exr"]);
    assert_eq!((&run.json()["relative_error"], &run.json()["adaptive"]), (&().into(), &false.into()));
}

#[test]
fn quiet_says_nothing() {
    let run = Place::new().succeed(&small(&["--quiet"]));
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
}

#[test]
fn bad_command_lines_are_refused_before_rendering() {
    let place = Place::new();
    let refused: &[(&[&str], &[&str])] = &[
        (&["--integrator", "pahts"], &["pahts", "did you mean 'path'?"]),
        (&["--integrator", "path:depth=3"], &["depth=3", "max_depth"]),
        (&["--sampler", "sobl"], &["sobl", "'sobol'"]),
        (&["--size", "0x32"], &["0x32"]),
        (&["--size", "32"], &["WIDTHxHEIGHT"]),
        (&["--crop", "3,3,3,9"], &["empty"]),
        (&["--size", "32x32", "--crop", "90,90,99,99"], &["leaves nothing"]),
        (&["--camera", "front"], &["no camera 'front'"]),
        (&["--spp", "0"], &["--spp"]),
        (&["--time", "soon"], &["--time"]),
        (&["--error", "0"], &["--error", "above zero"]),
        (&["--aov", "normals"], &["did you mean 'normal'?"]),
        (&["--aov", "normal", "-o", "x.png"], &[".exr"]),
        (&["--tonemap", "agz"], &["agx"]),
        (&["--exposure", "1000"], &["exposure"]),
        (&["--sead", "1"], &["--seed"]),
        (&["-o", "x.gif"], &["x.gif", ".exr"]),
        (&["-o", "x"], &["extension"]),
        (&["-o", "x.tga"], &["not written"]),
        (&["--size", "1000000x1000000"], &["1000000"]),
        (&["builtin:cornel-box"], &["cornel-box", "cornell-box-area"]),
        (&["nowhere.pbrt"], &["nowhere.pbrt"]),
    ];
    for (arguments, about) in refused {
        place.refuse(2, &[&["render"][..], arguments].concat(), about);
    }
    assert_eq!(std::fs::read_dir(&place.0).unwrap().count(), 0, "nothing was written");
}

#[test]
fn outputs_that_cannot_be_written_fail() {
    let place = Place::new();
    std::fs::create_dir(place.path("folder.exr")).unwrap();
    place.refuse(1, &["render", "-o", "no/such/place.exr"], &["no/such/place.exr", "no folder"]);
    place.refuse(1, &["render", "-o", "folder.exr"], &["it is a folder"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let place = Place::new();
    // The device takes the picture of a format that is encoded in memory, and refuses to keep it.
    std::os::unix::fs::symlink("/dev/full", place.path("x.pfm")).unwrap();
    place.refuse(1, &small(&["-o", "x.pfm", "-q"]), &["x.pfm", "No space left"]);
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let place = Place::new();
    let mut child = place
        .command(&small(&["--json"]))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn every_structure_gives_the_same_bits() {
    let place = Place::new();
    place.succeed(&small(&["-q", "-o", "bvh.exr"]));
    for name in ["grid", "octree", "kdtree", "kdtree-ropes", "kdtree-median", "bsp", "none"] {
        place.succeed(&small(&["-q", "-o", "other.exr", "--accelerator", name]));
        place.succeed(&["compare", "bvh.exr", "other.exr", "--fail-above", "max_abs=0"]);
    }
    place.refuse(2, &small(&["--accelerator", "quadtree"]), &["quadtree", "octree"]);
}

#[test]
fn structures_are_compared() {
    let place = Place::new();
    let line = ["bench", "accel", "builtin:cornell-box", "--size", "24x24", "--each", "1ms"];
    let table = place.succeed(&line).stdout;
    for part in ["bvh", "grid", "octree", "kdtree", "bsp", "none", "primary", "Mrays/s"] {
        assert!(table.contains(part), "{part}: {table}");
    }
    let chosen = [&line[..], &["--json", "--structures", "none,kdtree"]].concat();
    let json = place.succeed(&chosen).json();
    let [none, kdtree] = [0, 1].map(|i| &json["structures"][i]);
    assert_eq!((&none["structure"], &kdtree["structure"]), (&"none".into(), &"kdtree".into()));
    let tests = |row: &serde_json::Value| row["kinds"][0]["tests_per_ray"].as_f64().unwrap();
    assert!(tests(none) > 2.0 * tests(kdtree), "{json}");
    assert!(kdtree["kinds"][2]["mrays_per_cpu_second"].as_f64().unwrap() > 0.0);
    assert_eq!((&kdtree["kinds"][1]["agrees"], &json["rays"][0][1]), (&true.into(), &(24 * 24).into()));
    place.refuse(2, &["bench", "accel", "builtin:cornell-box", "--structures", "kdtre"], &["did you mean 'kdtree'"]);
}

/// Textures that exceed their share of memory give the same bits as those that need not.
#[test]
fn texture_limit_changes_no_bit() {
    let place = Place::new();
    let noise = |i: u32| ((i.wrapping_mul(2_654_435_761) >> 16) % 256) as f32 / 255.0;
    let pixels: Vec<[f32; 3]> = (0..1024 * 700).map(|i| [noise(i), noise(i ^ 77), noise(i + 5)]).collect();
    let image = steradian::image::Image::from_rgb(1024, 700, &pixels).unwrap();
    steradian::image::write(&place.path("noise.png"), &image, &Default::default()).unwrap();
    let scene = |filter: &str| {
        format!(
            "LookAt 0 1 0  0 0.6 1  0 1 0\nCamera \"perspective\" \"float fov\" 60\nWorldBegin\n\
             LightSource \"infinite\" \"rgb L\" [1 1 1]\n\
             Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"noise.png\" \"string filter\" \"{filter}\"\n\
             Material \"diffuse\" \"texture reflectance\" \"t\"\n\
             Shape \"bilinearmesh\" \"point3 P\" [-9 0 0  9 0 0  -9 0 20  9 0 20] \"point2 uv\" [0 0 4 0 0 5 4 5]\n"
        )
    };
    for filter in ["bilinear", "trilinear", "ewa"] {
        place.file("s.pbrt", &scene(filter));
        let render = |out: &str, more: &[&str]| {
            let line = ["render", "s.pbrt", "--size", "48x32", "--spp", "2", "-q", "--strict", "-o", out];
            let run = place.run(&[&line[..], more].concat());
            assert_eq!(run.code, 0, "{}", run.stderr);
            place.picture(out).to_rgb().unwrap()
        };
        let whole = render("a.exr", &[]);
        assert_eq!(whole, render("b.exr", &["--texture-limit", "1MiB"]), "{filter}");
        assert_eq!(whole, render("c.exr", &["--texture-limit", "1MiB", "--threads", "3"]), "{filter}");
    }
    assert_eq!(place.run(&["render", "s.pbrt", "--texture-limit", "12"]).code, 2);
}

#[test]
fn the_graphics_pipeline_draws_at_once() {
    let place = Place::new();
    let run = place.succeed(&["render", "--size", "48x40", "--integrator", "raster", "--json", "-o", "a.exr"]);
    let json = run.json();
    assert_eq!((&json["integrator"], &json["spp"], &json["samples"]), (&"raster".into(), &1.into(), &(48 * 40).into()));
    let picture = place.picture("a.exr");
    let [left, right] = [picture.rgb().unwrap().at(20 * 48 + 3), picture.rgb().unwrap().at(20 * 48 + 44)];
    assert!(left[0] > 2.0 * left[1] && right[1] > 2.0 * right[0], "{left:?} {right:?}");
    // As with other integrators: layers, a limit of time, and what is kept.
    let common = ["render", "--size", "48x40", "--integrator", "raster", "-o", "b.exr"];
    place.succeed(&[&common[..], &["--aov", "depth,light_groups", "--spp", "4", "--resume", "state"]].concat());
    assert!(place.picture("b.exr").channel("Z").is_some());
    let run =
        place.succeed(&[&common[..], &["--spp", "8", "--resume", "state", "--aov", "depth,light_groups"]].concat());
    assert!(run.stderr.contains("going on from state at 4.0"), "{}", run.stderr);
    let run = place.succeed(&[&common[..], &["--time", "200ms", "--sampler", "sobol"]].concat());
    assert!(run.stderr.contains("--sampler has no effect"), "{}", run.stderr);
    place.refuse(2, &[&common[..], &["--adaptive"]].concat(), &["leave out --adaptive"]);
    place.refuse(2, &["render", "--integrator", "raster:shadows=x"], &["'shadows' takes ray, "]);
}

/// An estimate tells time and memory, and leaves no file; memory beyond a limit is refused before it is taken.
#[test]
fn time_and_memory_are_told_before() {
    let place = Place::new();
    let scene = ["render", "builtin:cornell-box", "--size", "24x24", "--spp", "4000k"];
    let told = place.succeed(&[&scene[..], &["--estimate", "--json"]].concat()).json();
    let number = |name: &str| told[name].as_f64().unwrap();
    let sampling = 24.0 * 24.0 * 4e6 / number("samples_per_second");
    assert!((number("sample_seconds") / sampling - 1.0).abs() < 1e-6 && number("seconds") >= number("sample_seconds"));
    assert!(number("trial_samples") >= 576.0 && number("film_bytes") > 0.0 && number("geometry_bytes") > 0.0);
    let text = place.succeed(&[&scene[..], &["--estimate"]].concat()).stdout;
    assert!(text.starts_with("time ") && text.contains("\nmemory "), "{text}");
    assert_eq!(std::fs::read_dir(place.path(".")).unwrap().count(), 0);
    let large = ["render", "builtin:cornell-box", "--size", "4000x3000", "--memory-limit", "64MiB"];
    place.refuse(2, &large, &["needs about", "of memory"]);
    assert_eq!(std::fs::read_dir(place.path(".")).unwrap().count(), 0);
}

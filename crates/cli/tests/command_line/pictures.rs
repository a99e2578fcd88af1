//! `steradian compare` and `steradian convert`.

use crate::Place;
use base64::{Engine, prelude::BASE64_STANDARD};
use steradian::image::{Image, WriteOptions, encoding::srgb_encode, write};

/// A place with a smooth picture, `a.exr`, one that is a tenth brighter, `b.exr`, and one of another size.
fn place() -> Place {
    let place = Place::new();
    let pixels = |gain: f32| -> Vec<[f32; 3]> {
        (0..256).map(|i| [(i % 16) as f32 / 32.0, (i / 16) as f32 / 32.0, 0.25].map(|v| v * gain + 0.1)).collect()
    };
    for (name, side, gain) in [("a.exr", 16, 1.0), ("b.exr", 16, 1.1), ("small.exr", 8, 1.0)] {
        let image = Image::from_rgb(side, side, &pixels(gain)[..side * side]).unwrap();
        write(&place.path(name), &image, &WriteOptions::default()).unwrap();
    }
    place
}

#[test]
fn a_round_trip_through_formats_keeps_the_picture() {
    let place = place();
    for name in ["c.pfm", "c.hdr", "c.png", "c.ppm", "c.jpg"] {
        place.succeed(&["convert", "a.exr", name]);
        place.succeed(&["convert", name, "back.exr"]);
        let pair = place.succeed(&["compare", "back.exr", "a.exr", "--json"]).json()["pairs"][0].clone();
        let mse = pair["mse"].as_f64().unwrap();
        // Floats exactly, RGBE to one part in 256, 8 bits to half a step, JPEG to a few.
        let limit = match name {
            "c.pfm" => 0.0,
            "c.jpg" => 1e-3,
            _ => 2e-5,
        };
        assert!(mse <= limit, "{name}: {mse}");
    }
    place.succeed(&["convert", "a.exr", "bright.png", "--exposure", "1"]);
    place.succeed(&["convert", "bright.png", "bright.exr"]);
    let ratio =
        place.succeed(&["compare", "bright.exr", "a.exr", "--json"]).json()["pairs"][0]["ratio"][2].as_f64().unwrap();
    assert!((ratio - 2.0).abs() < 0.02, "{ratio}");
}

#[test]
fn conversion_refuses_what_it_cannot_do() {
    let place = place();
    place.file("broken.png", "\u{89}PNG").file("s.pbrt", "");
    place.refuse(2, &["convert", "s.pbrt", "s.obj"], &["as .steradian"]);
    place.refuse(2, &["convert", "a.exr", "a.obj"], &["as .steradian"]);
    place.refuse(2, &["convert", "a.exr", "a.gif"], &["a.gif"]);
    place.refuse(2, &["convert", "none.exr", "a.png"], &["none.exr"]);
    place.refuse(2, &["convert", "broken.png", "a.exr"], &["broken.png"]);
    place.refuse(1, &["convert", "a.exr", "no/a.png"], &["no/a.png"]);
}

/// Losses and guesses of a conversion are told: values that are no numbers or too large, depths as grey, layers.
#[test]
fn conversion_tells_what_is_lost() {
    let place = place();
    let told = |arguments: &[&str], what: &str| {
        let said = place.succeed(arguments).stderr;
        assert!(said.contains(what), "{arguments:?}: {said}");
    };
    let colours = [[f32::NAN, 1e6, 0.5], [f32::INFINITY, 0.0, f32::NEG_INFINITY]];
    let mut image = Image::from_rgb(2, 1, &colours).unwrap();
    image.push("Z", vec![0.5, f32::INFINITY]).unwrap();
    write(&place.path("odd.exr"), &image, &WriteOptions::default()).unwrap();
    told(&["convert", "odd.exr", "same.exr"], "1 values of this picture are NaN and 2 infinite");
    told(&["convert", "odd.exr", "half.exr", "--exr", "half"], "1 values are beyond the range of halves");
    let kept = place.picture("same.exr");
    assert!(kept.rgb().unwrap().at(0)[0].is_nan() && kept.rgb().unwrap().at(1)[0] == f32::INFINITY);

    let mut layers = Image::new(2, 1);
    layers.push_layer("AO", ["R", "G", "B"], &[[0.5; 3]; 2]).unwrap();
    layers.push_layer("rgba", ["R", "G", "B"], &[[0.25; 3]; 2]).unwrap();
    layers.push("Z", vec![0.5, 8.5]).unwrap();
    layers.push_layer("N", ["X", "Y", "Z"], &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]).unwrap();
    write(&place.path("layers.exr"), &layers, &WriteOptions::default()).unwrap();
    told(&["convert", "layers.exr", "rgba.pfm"], "layer 'rgba' of this picture is its colour");
    let rgba = place.picture("rgba.pfm");
    assert_eq!(rgba.rgb().unwrap().at(0), [0.25; 3]);
    let depth = ["convert", "layers.exr", "depth.png", "--layer", "depth"];
    assert!(place.succeed(&depth).stderr.contains("values from 0.5 to 8.5 are shown from black to white"));
    let shown = place.picture("depth.png");
    assert_eq!([0, 1].map(|k| shown.channels()[0].data[k]), [0.0, 1.0]);
    told(&[&depth[..], &["--exposure", "0"]].concat(), "the values go from 0.5 to 8.5");
    let normals = ["convert", "layers.exr", "normal.png", "--layer", "normal"];
    assert!(place.succeed(&normals).stderr.contains("values from -1 to 1 are shown"));
    assert_eq!(place.picture("normal.png").channels()[0].data, [0.0, 1.0]);
    assert!(!place.succeed(&["convert", "layers.exr", "ao.png", "--layer", "AO"]).stderr.contains("warning"));
    let mut only = Image::new(2, 1);
    only.push("Z", vec![0.5, 8.5]).unwrap();
    write(&place.path("z.exr"), &only, &WriteOptions::default()).unwrap();
    told(&["convert", "z.exr", "z.png"], "only channel of this picture is a depth, 'Z'");
}

#[test]
fn comparison_has_the_known_figures() {
    let place = place();
    let json = place.succeed(&["compare", "b.exr", "a.exr", "--json"]).json();
    let pair = &json["pairs"][0];
    assert_eq!((&json["schema"], &pair["width"], &pair["nonfinite"]), (&1.into(), &16.into(), &0.into()));
    // The blue channel is 0.375 and 0.35.
    let ratio = pair["ratio"][2].as_f64().unwrap();
    assert!((ratio - 0.375 / 0.35).abs() < 1e-5, "{ratio}");
    assert!((pair["rmse"].as_f64().unwrap().powi(2) / pair["mse"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    let [mean, most] = ["delta_e_2000", "delta_e_max"].map(|name| pair[name].as_f64().unwrap());
    assert!(mean > 0.0 && mean <= most && most < 100.0, "{mean} {most}");
    assert!(pair["flip"].as_f64().unwrap() > 0.0 && pair["psnr"].as_f64().unwrap() > 20.0 && pair["z_test"].is_null());
    let same = place.succeed(&["compare", "a.exr", "a.exr"]);
    assert!(same.stdout.contains("MSE       0.0") && same.stdout.contains("inf dB"), "{}", same.stdout);
    let both = place.succeed(&["compare", "a.exr", "b.exr", "--reference", "a.exr", "--json"]).json();
    assert_eq!(both["pairs"].as_array().unwrap().len(), 2);
    assert_eq!(both["pairs"][0]["mse"], 0.0);
    assert_eq!(both["pairs"][1]["mse"], pair["mse"]);
}

#[test]
fn thresholds_decide_the_exit_code() {
    let place = place();
    place.succeed(&["compare", "b.exr", "a.exr", "--fail-above", "rmse=0.1", "--fail-above", "mean_ratio_error=0.2"]);
    let run = place.run(&["compare", "b.exr", "a.exr", "--fail-above", "rmse=0.001"]);
    assert!(run.code == 4 && run.stderr.contains("rmse") && run.stdout.contains("RMSE"), "{} {}", run.code, run.stderr);
    place.refuse(2, &["compare", "b.exr", "a.exr", "--fail-above", "rsme=1"], &["did you mean 'rmse'?"]);
    assert_eq!(place.run(&["compare", "b.exr", "a.exr", "--fail-above", "z_rejected=1"]).code, 2);
    let run = place.run(&["compare", "b.exr", "a.exr", "--fail-above", "ssim_error=0", "--fail-above", "mape=1"]);
    assert!(run.code == 4 && run.stderr.contains("ssim_error") && !run.stderr.contains("mape"), "{}", run.stderr);
    place.refuse(2, &["compare", "a.exr", "none.exr"], &["none.exr"]);
    place.refuse(2, &["compare", "a.exr"], &["<B>"]);
}

/// A reference of another size is resampled, and says so; one of another shape is refused.
#[test]
fn references_of_another_size_are_resampled() {
    let place = place();
    let flat = |name: &str, width: usize, height: usize| {
        let image = Image::from_rgb(width, height, &vec![[0.25, 0.5, 0.75]; width * height]).unwrap();
        write(&place.path(name), &image, &WriteOptions::default()).unwrap();
    };
    flat("large.exr", 24, 24);
    flat("small.exr", 16, 16);
    flat("wide.exr", 24, 20);
    let run = place.succeed(&["compare", "small.exr", "large.exr", "--json"]);
    let pair = &run.json()["pairs"][0];
    assert_eq!(pair["resampled_from"], serde_json::json!([24, 24]));
    assert_eq!((&pair["mse"], &pair["mape"], &pair["ssim"]), (&0.0.into(), &0.0.into(), &1.0.into()));
    for said in ["'large.exr'", "24x24", "16x16", "by area"] {
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    let same = place.succeed(&["compare", "b.exr", "a.exr", "--json"]);
    assert!(same.json()["pairs"][0]["resampled_from"].is_null() && !same.stderr.contains("resampled"));
    let page = ["--html", "report.html", "--csv", "table.csv"];
    place.refuse(2, &[&["compare", "small.exr", "wide.exr"], &page[..]].concat(), &["16x16", "24x20", "aspect ratio"]);
    assert!(!place.path("report.html").exists() && !place.path("table.csv").exists());
    place.refuse(2, &["compare", "a.exr", "a.exr", "--variance", "large.exr", "--samples", "4"], &["16x16", "24x24"]);
}

/// The page has each pair with its pictures and maps inside, and what it shows is right; the table has the figures of
/// the JSON.
#[test]
fn a_report_has_every_pair_with_pictures_maps_and_figures() {
    let place = place();
    let noisy = |name: &str, value: f32| {
        let mut image = Image::from_rgb(16, 16, &[[value; 3]; 256]).unwrap();
        image.push_layer("variance", ["R", "G", "B"], &[[1e-4; 3]; 256]).unwrap();
        image.metadata.set("samplesPerPixel", steradian::image::Value::Int(4));
        write(&place.path(name), &image, &WriteOptions::default()).unwrap();
    };
    // 0.1 lower is seven standard errors of a difference.
    noisy("<i>.exr", 0.002);
    noisy("dark.exr", 0.102);
    let pictures = ["compare", "<i>.exr", "b.exr", "-r", "dark.exr", "-r", "a.exr"];
    let run = place.succeed(&[&pictures[..], &["--html", "report.html", "--csv", "table.csv", "--json"]].concat());
    let json = run.json();
    let pairs = json["pairs"].as_array().unwrap();
    let csv = std::fs::read_to_string(place.path("table.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!((rows.len(), pairs.len()), (5, 4));
    for (row, pair) in rows[1..].iter().zip(pairs) {
        assert_eq!(
            (row.len(), row[0], row[1]),
            (rows[0].len(), pair["picture"].as_str().unwrap(), pair["reference"].as_str().unwrap())
        );
        for name in ["mse", "mape", "smape", "ssim", "flip"] {
            let column = rows[0].iter().position(|head| *head == name).unwrap();
            let (written, told) = (row[column].parse::<f64>().unwrap(), pair[name].as_f64().unwrap());
            // serde_json reads to the last bit but one.
            assert!((written - told).abs() <= 1e-14 * told.abs(), "{name}: {written} {told}");
        }
    }
    let page = std::fs::read_to_string(place.path("report.html")).unwrap();
    assert!(!page.contains("<i>") && !page.contains("http") && !page.contains("url("));
    assert_eq!(page.matches("src=").count(), page.matches("src=\"data:image/png;base64,").count());
    assert_eq!(page.matches("<tr>").count(), 5);
    for tag in
        ["html", "head", "body", "main", "section", "figure", "table", "tr", "td", "th", "div", "script", "p", "dl"]
    {
        let opened = page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
    let sections: Vec<&str> = page.split("<section ").skip(1).collect();
    let heads = [
        "&lt;i&gt;.exr against dark.exr",
        "b.exr against dark.exr",
        "&lt;i&gt;.exr against a.exr",
        "b.exr against a.exr",
    ];
    assert_eq!(sections.len(), heads.len());
    for (section, head) in sections.iter().zip(heads) {
        assert!(section.contains(&format!("<h2>{head}</h2>")) && section.contains("<input type=\"range\""), "{head}");
        assert_eq!(section.matches("<img ").count(), section.matches("\" alt=\"").count());
    }
    let inside = |section: &str| -> Vec<Image> {
        let data = section.split("base64,").skip(1).map(|rest| rest.split('"').next().unwrap());
        let image = |data: &str| {
            std::fs::write(place.path("i.png"), BASE64_STANDARD.decode(data).unwrap()).unwrap();
            place.picture("i.png")
        };
        data.map(image).collect()
    };
    let [picture, reference, _, _, z] = &inside(sections[0])[..] else { panic!("two pictures and three maps") };
    let middle = |image: &Image| image.rgb().unwrap().at(136);
    assert!(middle(picture)[1] < middle(reference)[1] && middle(z)[2] > 2.0 * middle(z)[0], "darker is blue");
    // The one that has no variances has no such map, and the page says why; nothing is said where none has.
    assert!(inside(sections[1]).len() == 4 && sections[1].contains("No map of standard errors"));
    assert!(inside(sections[3]).len() == 4 && !sections[3].contains("No map"));
}

/// A dark reference is shown at an exposure that makes it seen, and so is its picture.
#[test]
fn reports_show_dark_pictures() {
    let place = Place::new();
    let image = Image::from_rgb(4, 4, &[[0.0125; 3]; 16]).unwrap();
    write(&place.path("dark.exr"), &image, &WriteOptions::default()).unwrap();
    place.succeed(&["compare", "dark.exr", "dark.exr", "--html", "report.html"]);
    let page = std::fs::read_to_string(place.path("report.html")).unwrap();
    assert!(page.contains("exposure +6 stops"), "{page}");
}

#[test]
fn renders_are_tested_by_their_own_variance() {
    let place = Place::new();
    let render = |name: &str, seed: &str, more: &[&str]| {
        let arguments =
            ["render", "builtin:cornell-box-area", "--size", "32x32", "--spp", "64", "--sampler", "independent", "-q"];
        let output = ["--aov", "variance", "-o", name, "--seed", seed];
        place.succeed(&[&arguments[..], &output[..], more].concat());
    };
    render("a.exr", "1", &[]);
    render("b.exr", "2", &[]);
    render("short.exr", "3", &["--max-depth", "1"]);
    let z = |a: &str, b: &str| place.succeed(&["compare", a, b, "--json"]).json()["pairs"][0]["z_test"].clone();
    let fair = z("a.exr", "b.exr");
    assert_eq!((&fair["passes"], &fair["samples"]), (&true.into(), &64.0.into()));
    assert_eq!(z("short.exr", "a.exr")["passes"], false, "indirect light is missing");
    // The same test with the variance given: one whose noise is far above that of the render accepts even the wrong
    // one.
    let flat = Image::from_rgb(32, 32, &[[100.0; 3]; 1024]).unwrap();
    write(&place.path("var.exr"), &flat, &WriteOptions::default()).unwrap();
    let given =
        place.succeed(&["compare", "short.exr", "a.exr", "--variance", "var.exr", "--samples", "64", "--json"]).json();
    assert_eq!(given["pairs"][0]["z_test"]["passes"], true);
}

/// A picture goes into block-compressed files and back; waves of a striped one are told with their aliases.
#[test]
fn block_compression_and_spectra() {
    let place = Place::new();
    let stripes: Vec<[f32; 3]> =
        (0..64 * 16).map(|i| [0.5 + 0.25 * (std::f32::consts::TAU * 0.375 * (i % 64) as f32).cos(); 3]).collect();
    let image = Image::from_rgb(64, 16, &stripes).unwrap();
    write(&place.path("a.exr"), &image, &Default::default()).unwrap();
    for (block, file) in [
        ("bc7", "a.dds"),
        ("bc1", "b.ktx2"),
        ("bc2", "f.ktx2"),
        ("bc4", "c.dds"),
        ("bc5", "d.ktx2"),
        ("bc3", "e.dds"),
        ("bc6h", "g.dds"),
        ("bc6h", "h.ktx2"),
    ] {
        assert_eq!(place.run(&["convert", "a.exr", file, "--block", block]).code, 0, "{file}");
        assert_eq!(place.run(&["convert", file, "back.png"]).code, 0, "{file}");
        assert_eq!(place.picture("back.png").width(), 64);
    }
    assert_eq!(place.run(&["convert", "a.exr", "x.dds", "--block", "bc8"]).code, 2);

    let run = place.run(&["signal", "a.exr", "--step", "2", "-o", "s.png", "-o", "s.svg", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let told: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let wave = &told["waves"][0];
    assert!((wave["frequency"][0].as_f64().unwrap() - 0.375).abs() < 1e-9);
    assert!((wave["alias"][0].as_f64().unwrap() + 0.125).abs() < 1e-9);
    assert_eq!(wave["aliased"], true);
    assert!(std::fs::read_to_string(place.path("s.svg")).unwrap().starts_with("<svg"));
    assert_eq!(place.picture("s.png").width(), 5 * 64 + 4 * 4);
    assert_eq!(place.run(&["signal", "a.exr", "--step", "1000"]).code, 2);
    assert_eq!(place.run(&["signal", "none.exr"]).code, 2);
}

/// Memory that cannot be had is a message, not the end of the process.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_beyond_the_memory_is_refused() {
    let place = Place::new();
    let mut grey = Image::new(6000, 5000);
    grey.push("Y", vec![0.25; 30_000_000]).unwrap();
    write(&place.path("large.png"), &grey, &WriteOptions::default()).unwrap();
    drop(grey);
    let program = place.command(&[]).get_program().to_owned();
    let line = |limit: &str, what: &str| {
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", &format!("ulimit -v {limit}; exec \"$0\" {what}")]).arg(&program);
        let run = shell.current_dir(&place.0).env("RAYON_NUM_THREADS", "1").output().unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    };
    for what in ["convert large.png a.pfm", "compare large.png large.png"] {
        let (code, said) = line("400000", what);
        assert!(code == Some(2) && said.contains("no memory") && said.contains("large.png"), "{what}: {code:?} {said}");
    }
    let (code, said) = line("1500000", "convert large.png a.ppm");
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = line("1000000", "render --size 3000x3000 --spp 1 --threads 1 -o a.exr");
    assert!(code == Some(2) && said.contains("of memory"), "{code:?} {said}");
}

#[test]
fn false_colour_has_a_legend_and_the_luminance_of_the_render() {
    let place = place();
    place.file(
        "sky.steradian",
        "steradian: 1\ncamera: {camera: perspective}\nfilm: {film: rgb, width: 8, height: 8, iso: 50}\n\
         lights: {sky: {light: environment, radiance: 0.01}}\n",
    );
    place.succeed(&["render", "sky.steradian", "--spp", "1", "-q", "-o", "sky.exr"]);
    // A radiance of 0.01 has 729.83 cd/m²; without --exposure or --tonemap colours are written as they are.
    for (settings, color) in [("min=729,max=1e6", [68, 1, 84]), ("scale=linear,min=0,max=730", [253, 231, 37])] {
        place.succeed(&["convert", "sky.exr", "sky.png", &format!("--false-color={settings}")]);
        let picture = place.picture("sky.png");
        assert!(picture.width() > 8 && picture.height() >= 64);
        let at = picture.rgb().unwrap().at(0).map(|v| (srgb_encode(v) * 255.0).round() as i32);
        assert!(at.iter().zip(color).all(|(a, c): (&i32, i32)| (a - c).abs() <= 1), "{settings}: {at:?}");
    }
    place.succeed(&["convert", "a.exr", "a.ppm", "--false-colour"]);
    place.refuse(2, &["convert", "a.exr", "b.png", "--false-color=scale=cubic"], &["log or linear"]);
    place.refuse(2, &["convert", "a.exr", "b.png", "--false-color", "--exposure", "1"], &["--exposure"]);
    place.refuse(2, &["convert", "sky.steradian", "b.xml", "--false-color"], &["--false-color is for pictures"]);
}

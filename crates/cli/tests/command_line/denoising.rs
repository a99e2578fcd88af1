//! `steradian denoise`, and `steradian render --denoise`.

use crate::Place;
use steradian::image::{Image, Value, metrics::compare};

fn relative_error(picture: &Image, reference: &Image) -> f64 {
    compare(picture, reference).unwrap().rel_mse
}

const BOX: [&str; 5] = ["render", "--size", "40x40", "-q", "--spp"];

/// A render that is denoised is the noisy one, denoised; what was noisy stays as a layer. In so
/// small a picture most pixels lie near edges: the error falls 4.8 times, of 64×64 pixels 6.9, of 180×180 24.
#[test]
fn renders_are_denoised() {
    let place = Place::new();
    let guides = ["--integrator", "path:reuse=1", "--aov", "albedo,normal,depth,variance", "-o", "noisy.exr"];
    place.succeed(&[&BOX[..], &["4"], &guides].concat());
    place.succeed(&[&BOX[..], &["4", "--denoise=nlm", "-o", "whole.exr", "-o", "whole.png"]].concat());
    place.succeed(&[&BOX[..], &["1k", "--seed", "9", "-o", "reference.exr"]].concat());
    let said = place.succeed(&["denoise", "noisy.exr", "-o", "after.exr", "-o", "after.png", "--with", "nlm"]).stderr;
    assert!(said.contains("albedo, normal, depth, variance") && !said.contains("missing"), "{said}");
    let picture = |name: &str| place.picture(name);
    let (noisy, after, whole, reference) =
        (picture("noisy.exr"), picture("after.exr"), picture("whole.exr"), picture("reference.exr"));
    for channel in ["R", "G", "B"] {
        assert_eq!(after.channel(channel), whole.channel(channel), "{channel}");
        assert_eq!(after.channel(&format!("raw.{channel}")), noisy.channel(channel), "{channel}");
        let variance = after.channel(&format!("raw_variance.{channel}"));
        assert_eq!(variance, noisy.channel(&format!("variance.{channel}")), "{channel}");
    }
    assert!(after.channel("variance.R").is_none() && after.metadata.get("steradian:denoised").is_some());
    let [before, left] = [&noisy, &after].map(|picture| relative_error(picture, &reference));
    assert!(left < before / 3.5, "{before} to {left}");
    assert_eq!(picture("after.png").width(), 40);
    // Again, from what was noisy.
    place.succeed(&["denoise", "after.exr", "-o", "again.exr", "--threads", "1", "--with", "nlm"]);
    assert_eq!(picture("again.exr").channels(), after.channels());
    place.succeed(&["denoise", "noisy.exr", "-o", "strong.exr", "--strength", "3"]);
    assert_ne!(picture("strong.exr").channel("R"), after.channel("R"));
}

/// Halves of the samples guide each other, and tell the error that remains: to people, to programs, and in the file.
/// The error told leaves out what is lost of detail, so it is the lower one.
#[test]
fn halves_tell_what_remains() {
    let place = Place::new();
    let layers = ["--integrator", "path:reuse=1", "--aov", "albedo,normal,depth,variance,halves", "-o", "noisy.exr"];
    place.succeed(&[&BOX[..], &["16"], &layers].concat());
    place.succeed(&[&BOX[..], &["1k", "--seed", "9", "-o", "reference.exr"]].concat());
    let said = place.succeed(&["denoise", "noisy.exr", "-o", "after.exr", "--with", "nlm"]).stderr;
    assert!(said.contains("estimated relative error of what remains"), "{said}");
    let whole =
        place.succeed(&[&BOX[..], &["16", "--denoise", "--aov", "halves", "--json", "-o", "whole.exr"]].concat());
    let told = whole.json()["denoised_relative_error"].as_f64().unwrap();
    let [noisy, after, whole, reference] =
        ["noisy", "after", "whole", "reference"].map(|name| place.picture(&format!("{name}.exr")));
    for channel in ["R", "G", "B", "half_a.G", "half_b.G"] {
        assert_eq!(after.channel(channel), whole.channel(channel), "{channel}");
    }
    for picture in [&after, &whole] {
        let kept = picture.metadata.get("steradian:denoised_relative_error");
        assert!(matches!(kept, Some(Value::Float(e)) if (f64::from(*e) / told - 1.0).abs() < 1e-6), "{kept:?}");
    }
    let [before, error] = [&noisy, &after].map(|picture| relative_error(picture, &reference).sqrt());
    assert!(error < 0.7 * before && (0.5..1.2).contains(&(told / error)), "{told} for {error} of {before}");
    let plain = place.succeed(&[&BOX[..], &["4", "--denoise=nlm", "--json", "-o", "plain.exr"]].concat());
    assert!(plain.json()["denoised_relative_error"].is_null() && !plain.stderr.contains("what remains"));
}

/// The layer of halves is refused where there are none, and left out where a render ends before it has both.
#[test]
fn halves_are_refused_where_there_are_none() {
    let place = Place::new();
    let line = ["render", "--size", "8x8", "-q", "--aov", "halves", "-o", "n.exr", "--integrator"];
    for method in ["light", "vcm", "sppm", "raster", "radiosity", "transient"] {
        place.refuse(2, &[&line[..], &[method, "--spp", "4"]].concat(), &["'halves'", &format!("'{method}'")]);
    }
    place.refuse(2, &[&line[..], &["path", "--spp", "1"]].concat(), &["'halves'", "two or more"]);
    place.succeed(&[&line[..], &["bdpt", "--spp", "3", "--crop", "2,2,6,7"]].concat());
    assert!(place.picture("n.exr").channel("half_b.B").is_some());
}

/// The quick filter, by both ways to it, with any number of threads.
#[test]
fn renders_are_denoised_quickly() {
    let place = Place::new();
    place.succeed(&[&BOX[..], &["4", "--denoise=atrous", "-o", "whole.exr"]].concat());
    place.succeed(&[&BOX[..], &["4", "--denoise=nlm", "-o", "slow.exr"]].concat());
    place.succeed(&[&BOX[..], &["1k", "--seed", "9", "-o", "reference.exr"]].concat());
    let line = ["denoise", "slow.exr", "-o", "after.exr", "--with", "atrous", "--threads"];
    let [whole, slow, reference] = ["whole.exr", "slow.exr", "reference.exr"].map(|name| place.picture(name));
    for threads in ["1", "3"] {
        let said = place.succeed(&[&line[..], &[threads]].concat()).stderr;
        assert!(said.contains("albedo, normal, depth, variance") && !said.contains("missing"), "{said}");
        assert_eq!(place.picture("after.exr").channels(), whole.channels());
    }
    assert_ne!(whole.channel("G"), slow.channel("G"));
    let mut noisy = Image::new(whole.width(), whole.height());
    for channel in ["R", "G", "B"] {
        noisy.push(channel, whole.channel(&format!("raw.{channel}")).unwrap().to_vec()).unwrap();
    }
    let [before, left] = [&noisy, &whole].map(|picture| relative_error(picture, &reference));
    assert!(left < before / 3.0, "{before} to {left}");
    place.refuse(2, &["denoise", "slow.exr", "--half", "slow.exr", "-o", "n.exr", "--with", "atrous"], &["nlm"]);
    let said = place.succeed(&["denoise", "slow.exr", "-o", "n.exr", "--with", "atrous", "--oidn", "."]).stderr;
    assert!(said.contains("--oidn has no effect"), "{said}");
}

/// Colour alone is enough for some of it, and the program says what would do better.
#[test]
fn missing_layers_are_named() {
    let place = Place::new();
    for (seed, name) in [("1", "a.exr"), ("2", "b.exr"), ("3", "c.pfm")] {
        place.succeed(&[&BOX[..], &["4", "--integrator", "path:reuse=1", "--seed", seed, "-o", name]].concat());
    }
    place.succeed(&[&BOX[..], &["1k", "--seed", "9", "-o", "reference.exr"]].concat());
    let said = place.succeed(&["denoise", "c.pfm", "-o", "after.pfm", "--with", "nlm"]).stderr;
    for word in ["colour alone", "albedo, normal, depth, variance are missing", "--aov albedo,normal,depth,variance"] {
        assert!(said.contains(word), "{said}");
    }
    let reference = place.picture("reference.exr");
    let [before, left] = ["c.pfm", "after.pfm"].map(|name| relative_error(&place.picture(name), &reference));
    assert!(left < before / 3.0, "{before} to {left}");
    let said = place.succeed(&["denoise", "a.exr", "--half", "b.exr", "-o", "both.exr"]).stderr;
    assert!(said.contains("estimated relative error"), "{said}");
    let both = relative_error(&place.picture("both.exr"), &reference);
    assert!(both < before / 5.0, "{before} to {both}");
}

/// Open Image Denoise, where `STERADIAN_OIDN` names its library: by each way to name it, the same picture.
#[test]
fn open_image_denoise_is_loaded() {
    let Some(library) = std::env::var_os("STERADIAN_OIDN") else {
        println!("SKIPPED: STERADIAN_OIDN does not name the library of Open Image Denoise");
        return;
    };
    let library = library.to_str().unwrap();
    let place = Place::new();
    place.succeed(&[&BOX[..], &["4", "--denoise", "--oidn", library, "-o", "whole.exr"]].concat());
    place.succeed(&[&BOX[..], &["1k", "--seed", "9", "-o", "reference.exr"]].concat());
    let said = place.succeed(&["denoise", "whole.exr", "-o", "named.exr", "--with", "oidn", "--threads", "1"]).stderr;
    assert!(said.contains("denoise_albedo, denoise_normal\n") && said.contains("Open Image Denoise 2."), "{said}");
    place.succeed(&["denoise", "whole.exr", "-o", "built-in.exr", "--with", "nlm"]);
    let [whole, named, built_in, reference] =
        ["whole", "named", "built-in", "reference"].map(|n| place.picture(&format!("{n}.exr")));
    assert_eq!(whole.channels(), named.channels());
    assert_ne!(whole.channel("G"), built_in.channel("G"));
    let mut noisy = Image::new(whole.width(), whole.height());
    for channel in ["R", "G", "B"] {
        noisy.push(channel, whole.channel(&format!("raw.{channel}")).unwrap().to_vec()).unwrap();
    }
    let [before, left] = [&noisy, &whole].map(|picture| relative_error(picture, &reference));
    assert!(left < before / 5.0, "{before} to {left}");
}

#[test]
fn what_is_not_open_image_denoise_is_refused() {
    let place = Place::new();
    place.succeed(&["render", "--size", "8x8", "--spp", "1", "-q", "-o", "a.exr"]);
    place.file("text.so", "no library");
    std::fs::create_dir(place.path("empty")).unwrap();
    let line = ["denoise", "a.exr", "-o", "n.exr"];
    for (path, about) in [("none", "'none'"), ("text.so", "no library that"), ("empty", "pip install")] {
        place.refuse(2, &[&line[..], &["--oidn", path]].concat(), &[about]);
        place.refuse(2, &["render", "--size", "8x8", "--denoise", "--oidn", path, "-o", "n.exr"], &[about]);
    }
    let said = place.succeed(&[&line[..], &["--oidn", "empty", "--with", "nlm"]].concat()).stderr;
    assert!(said.contains("--oidn has no effect"), "{said}");
    place.refuse(2, &["render", "--oidn", "empty", "-o", "n.exr"], &["--denoise"]);
    place.refuse(2, &["view", "--oidn", "empty"], &["pip install"]);
    place.refuse(2, &[&line[..], &["--with", "bilateral"]].concat(), &["nlm, atrous, oidn"]);
}

#[test]
fn what_cannot_be_denoised_is_refused() {
    let place = Place::new();
    let methods = ["light", "vcm", "sppm", "photon", "pssmlt", "mmlt", "radiosity", "raster", "stokes", "transient"];
    for method in methods {
        let line = ["render", "--denoise", "--size", "8x8", "--spp", "1", "--integrator", method, "-o", "n.exr"];
        place.refuse(2, &line, &["--denoise", &format!("'{method}'")]);
    }
    place.succeed(&["render", "--size", "8x8", "--spp", "1", "-q", "-o", "a.exr"]);
    place.succeed(&["render", "--size", "9x8", "--spp", "1", "-q", "-o", "b.exr"]);
    place.refuse(2, &["denoise", "a.exr", "--half", "b.exr", "-o", "n.exr"], &["9×8", "8×8"]);
    place.refuse(2, &["denoise", "a.exr", "-o", "n.exr", "--strength", "0"], &["from 0.01 to 100"]);
    place.refuse(2, &["denoise", "a.exr"], &["--output"]);
    place.refuse(2, &["denoise", "none.exr", "-o", "n.exr"], &["none.exr"]);
}

/// With `--temporal`, frames of an animation are denoised with those before: the first as a picture of its own, the
/// next ones with samples of a seed of their own; what was noisy stays a layer. Each by itself where that is not asked
/// for.
#[test]
fn frames_are_denoised_with_those_before() {
    let place = Place::new();
    place.file("s.gltf", &crate::exchange::seen_slide());
    let size = ["--size", "40x30", "--spp", "4", "-q", "--denoise=nlm"];
    let frames = |more: &[&str]| {
        place.succeed(&[&["render", "s.gltf", "--frames", "2..4", "--fps", "8"][..], &size, more].concat());
    };
    frames(&["--temporal", "-o", "t.exr"]);
    frames(&["--temporal", "--threads", "1", "-o", "one.exr"]);
    frames(&["-o", "alone.exr"]);
    let single = |frame: u32, seed: u32| {
        let (at, seed) = (format!("at={}", f64::from(frame) / 8.0), seed.to_string());
        let command = ["render", "s.gltf", "-D", &at, "--seed", &seed, "-o", "single.exr"];
        place.succeed(&[&command[..], &size].concat());
        place.picture("single.exr")
    };
    let rgb = |picture: &Image, layer: &str| {
        ["R", "G", "B"].map(|c| picture.channel(&format!("{layer}{c}")).map(<[f32]>::to_vec))
    };
    for frame in 2..=4 {
        let of = |name: &str| place.picture(&format!("{name}.{frame:04}.exr"));
        let (together, alone) = (of("t"), of("alone"));
        assert!(rgb(&together, "") == rgb(&of("one"), ""), "{frame}: as on one thread");
        assert!(rgb(&alone, "") == rgb(&single(frame, 0), ""), "{frame}: by itself");
        let seeded = single(frame, frame - 2);
        assert!(rgb(&together, "raw.") == rgb(&seeded, "raw."), "{frame}: samples of the frame");
        assert_eq!(rgb(&together, "") == rgb(&seeded, ""), frame == 2, "{frame}");
        assert!(together.channel("motion.X").is_some() && alone.channel("motion.X").is_none());
    }
    for (more, why) in [
        (&["--denoise"][..], "--frames"),
        (&["--frames", "0..1"], "--denoise"),
        (&["--frames", "0..1", "--denoise=atrous"], "nlm"),
    ] {
        place.refuse(2, &[&["render", "s.gltf", "--temporal"][..], more].concat(), &[why]);
    }
}

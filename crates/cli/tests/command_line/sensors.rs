//! Sensors: colours and noise by a film's parameters, and noise by `convert --sensor`.

use crate::Place;

const SCENE: &str = "steradian: 1\n\
    camera: {camera: perspective, to_world: {look_at: [0, 0, 0], from: [0, 0, 4], up: [0, 1, 0]}}\n\
    film: {film: rgb, width: 16, height: 16, iso: 400, exposure_time: 0.5 SENSOR}\n\
    lights: {sky: {light: environment, radiance: {rgb: [0.12, 0.14, 0.2]}}}\n\
    shapes: [{shape: sphere, center: [0, 0, 0], radius: 1}]\n";

fn scene(sensor: &str) -> String {
    SCENE.replace(" SENSOR", sensor)
}

/// Noise is equal by the render and by `convert`; layers, and what a render is kept in, stay clean.
#[test]
fn a_film_with_a_full_well_has_the_noise_of_convert() {
    const RENDER: [&str; 6] = ["--spp", "4", "--aov", "variance,normal,light_groups,samples", "-q", "-o"];
    let place = Place::new();
    place
        .file("clean.steradian", &scene(""))
        .file("noisy.steradian", &scene(", full_well: 900, read_noise: 4, dark_current: 8, bits: 10, noise_seed: 3"));
    let render = |scene: &str, out: &str, more: &[&str]| {
        place.succeed(&[&["render", scene][..], &RENDER, &[out], more].concat());
        place.picture(out)
    };
    let clean = render("clean.steradian", "clean.exr", &[]);
    let noisy = render("noisy.steradian", "noisy.exr", &["--threads", "1", "--resume", "kept"]);
    for channel in clean.channels() {
        let is_light = ["R", "G", "B"].contains(&&*channel.name);
        assert_eq!(noisy.channel(&channel.name) != Some(&channel.data), is_light, "{}", channel.name);
    }
    let sensor = "full_well=900,read_noise=4,dark_current=8,bits=10,noise_seed=3,iso=400,exposure_time=0.5";
    place.succeed(&["convert", "clean.exr", "later.exr", "--sensor", sensor]);
    assert_eq!(place.picture("later.exr").rgb().unwrap().r, noisy.rgb().unwrap().r);
    // What was kept is clean: its picture has the noise once.
    let again = render("noisy.steradian", "again.exr", &["--threads", "2", "--resume", "kept"]);
    assert_eq!(again.rgb().unwrap().g, noisy.rgb().unwrap().g);
    let crop = render("noisy.steradian", "crop.exr", &["--crop", "5,6,11,14"]);
    let (crop, noisy) = (crop.rgb().unwrap(), noisy.rgb().unwrap());
    assert!((0..48).all(|i| crop.at(i) == noisy.at((6 + i / 6) * 16 + 5 + i % 6)));
}

#[test]
fn bad_sensors_are_refused_with_their_place() {
    let place = Place::new();
    for (sensor, about) in [
        (", full_well: -1", "'full_well' of film 'rgb' is -1; it must be above 0"),
        (", full_well: 900, read_noise: -2", "'read_noise' of film 'rgb' is -2"),
        (", full_well: 900, dark_current: 1e12", "'dark_current'"),
        (", full_well: 900, bits: 0", "'bits' of film 'rgb' is 0; it must be in [1, 24]"),
        (", full_well: deep", "full_well"),
    ] {
        place.file("bad.steradian", &scene(sensor));
        place.refuse(2, &["render", "bad.steradian", "--spp", "1", "-o", "a.png"], &[about, "bad.steradian:3"]);
    }
    place.file("idle.steradian", &scene(", bits: 8"));
    let idle = place.succeed(&["render", "idle.steradian", "--spp", "1", "-o", "a.exr"]);
    assert!(idle.stderr.contains("'bits' of the film has no effect without 'full_well'"), "{}", idle.stderr);
    place.file("full.steradian", &scene(", full_well: 900"));
    for (out, about) in [("a.xml", "'full_well'"), ("a.pbrt", "'full_well'"), ("a.glb", "'full_well'")] {
        let lost = place.succeed(&["convert", "full.steradian", out]);
        assert!(lost.stderr.contains(about), "{out}: {}", lost.stderr);
    }
    for (sensor, about) in [
        ("iso=100", "'full_well' is needed"),
        ("full_well=0", "number, above 0"),
        ("full_well=9,bits=2.5", "whole number, in [1, 24]"),
        ("full_well=9,gain=2", "there is no parameter of a sensor 'gain'"),
        ("full_well", "NAME=VALUE"),
    ] {
        place.refuse(2, &["convert", "a.exr", "b.exr", "--sensor", sensor], &[about]);
    }
    place.refuse(2, &["convert", "full.steradian", "b.pbrt", "--sensor", "full_well=9"], &["--sensor is for pictures"]);
}

/// A pbrt film's camera and white balance: light of 2856 K is orange to the observer, nearly white where the balance is
/// for it, and to a camera what pbrt-v4's definition and tables make of it in numpy. In RGB mode the observer stands
/// in, and a message says so.
#[test]
fn films_see_by_the_sensor_that_pbrt_names() {
    let place = Place::new();
    let scene = |film: &str| {
        format!(
            "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 \
             {film}\nCamera \"perspective\"\nWorldBegin\n\
             LightSource \"infinite\" \"blackbody L\" 2856 \"float scale\" 1\n"
        )
    };
    let seen = |film: &str, more: &[&str]| {
        place.file("seen.pbrt", &scene(film));
        let args = [&["render", "seen.pbrt", "--spp", "64", "-q", "-o", "seen.exr"], more].concat();
        let said = place.succeed(&args).stderr;
        let picture = place.picture("seen.exr");
        let rgb = picture.rgb().unwrap();
        let mean = |of: &[f32]| of.iter().sum::<f32>() / 64.0;
        ([mean(rgb.r), mean(rgb.g), mean(rgb.b)], said)
    };
    let near = |found: [f32; 3], expected: [f32; 3]| {
        let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.015 * b);
        assert!(close, "{found:?}, not {expected:?}");
    };
    let (plain, said) = seen("", &[]);
    assert!(plain[0] > 1.5 * plain[1] && plain[1] > 2.0 * plain[2] && said.is_empty(), "{plain:?} {said}");
    let (balanced, _) = seen("\"float whitebalance\" 2856", &[]);
    near(balanced, [balanced[1]; 3]);
    let (camera, said) = seen("\"string sensor\" \"nikon_d850\" \"float whitebalance\" 2856", &["--strict"]);
    near(camera, [0.9739, 1.0055, 0.9631]);
    assert!(said.is_empty(), "{said}");
    let (camera, _) = seen("\"string sensor\" \"nikon_d850\"", &[]);
    near(camera, [1.8722, 0.8434, 0.2719]);
    let refused = ["the sensor 'nikon_d850' needs spectra", "seen.pbrt:1"];
    place.refuse(2, &["render", "seen.pbrt", "--color", "rgb", "--strict", "-o", "a.png"], &refused);

    place.file("seen.pbrt", &scene("\"string sensor\" \"nikon_d950\""));
    let refused = ["unknown sensor 'nikon_d950'", "did you mean 'nikon_d850'?", "seen.pbrt:1"];
    place.refuse(2, &["render", "seen.pbrt", "-o", "a.png"], &refused);
    for kelvin in ["-5", "26000"] {
        place.file("seen.pbrt", &scene(&format!("\"float whitebalance\" {kelvin}")));
        place.refuse(
            2,
            &["render", "seen.pbrt", "-o", "a.png"],
            &["a white balance for", kelvin, "25000 K", "seen.pbrt:1:81"],
        );
    }
}

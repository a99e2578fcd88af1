//! Noise of sensors: by a film's parameters, and by `convert --sensor`.

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

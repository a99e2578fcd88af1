//! Renders and chunks that are killed (SIGKILL) at any moment, and gone on with, come to the bits of one run.

use crate::{Place, chunks::same};
use std::{
    process::Stdio,
    time::{Duration, Instant},
};

/// Scenes of the project and integrators, with layers.
const RENDERS: [&[&str]; 8] = [
    &["diffuse.pbrt", "--integrator", "path", "--aov", "all,halves"],
    &["fog.pbrt", "--integrator", "volpath"],
    &["glass.pbrt", "--integrator", "bdpt", "--aov", "variance"],
    &["caustic.pbrt", "--integrator", "sppm"],
    &["caustic.pbrt", "--integrator", "light"],
    &["mirror.pbrt", "--integrator", "pssmlt"],
    &["lens.pbrt", "--integrator", "direct", "--color", "spectral", "--aov", "light_groups"],
    &["textured.pbrt", "--integrator", "vcm"],
];
/// Kills, unless `STERADIAN_KILLS` gives another number of them.
const KILLS: u32 = 10;

/// Numbers that look random (Knuth's MMIX generator), as parts of one.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }
}

/// Runs a command again and again, and kills it each time at a moment within the time that it takes in full, until it
/// was killed so often; then to its end.
fn killed(place: &Place, line: &[&str], kills: u32, whole: Duration, random: &mut Random) {
    // One that ends before it is killed has less to do the next time.
    let (mut done, mut tries) = (0, 0);
    while done < kills && tries < 4 * kills {
        let mut child = place.command(line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(whole.mul_f64(random.next()));
        child.kill().unwrap();
        done += u32::from(child.wait().unwrap().code().is_none());
        tries += 1;
    }
    place.succeed(line);
}

#[test]
fn kills_at_any_moment_change_no_bit() {
    let kills = std::env::var("STERADIAN_KILLS").map_or(KILLS, |n| n.parse().expect("a number of kills"));
    let scenes = std::path::absolute("../../scenes/verify").unwrap();
    let mut random = Random(kills.into());
    for (number, render) in RENDERS.iter().enumerate() {
        // Each render has its share of the kills.
        let share = (kills + 7 - number as u32) / 8;
        let place = Place::new();
        let scene = scenes.join(render[0]);
        let options =
            [&[scene.to_str().unwrap(), "--size", "40x33", "--spp", "12", "--threads", "2"], &render[1..]].concat();
        let start = Instant::now();
        place.succeed(&[&["render", "-o", "one.exr"], &*options].concat());
        let whole = start.elapsed();
        let resumed = [&["render", "-o", "parts.exr", "--resume", "state"], &*options].concat();
        // Where there is time for a sample, a little of it is there first, and a state before that.
        for time in ["1ms", "2ms"] {
            place.run(&[&*resumed, &["--time", time]].concat());
        }
        killed(&place, &resumed, share.div_ceil(2), whole, &mut random);
        same(&place.picture("parts.exr"), &place.picture("one.exr"));
        let planned: Vec<&str> = options.iter().copied().filter(|word| !["--threads", "2"].contains(word)).collect();
        place.succeed(&[&["plan", "-o", "job", "--chunks", "3"], &*planned].concat());
        killed(&place, &["chunk", "job", "0..2", "--threads", "2"], share / 2, whole, &mut random);
        place.succeed(&["merge", "job", "-o", "merged.exr"]);
        same(&place.picture("merged.exr"), &place.picture("one.exr"));
        // What was killed left nothing that stays.
        let stray = std::fs::read_dir(place.path("job"))
            .unwrap()
            .flatten()
            .filter(|e| e.file_name().to_string_lossy().starts_with(".steradian-"));
        assert_eq!(stray.count(), 0, "{render:?}");
    }
}

/// A process that was killed between two names of its state leaves files that are one; the next one mends that.
#[test]
fn names_of_one_state_are_told_apart() {
    let render = |out: &'static str, spp: &'static str| {
        ["render", "builtin:cornell-box", "--size", "40x33", "--spp", spp, "-o", out]
    };
    for links in [&["state.before"][..], &["state.draft"], &["state.before", "state.draft"]] {
        let place = Place::new();
        for spp in ["3", "5", "8"] {
            place.succeed(&[&render("one.exr", spp)[..], &["--resume", "other"]].concat());
        }
        place.succeed(&[&render("parts.exr", "3")[..], &["--resume", "state"]].concat());
        for link in links {
            std::fs::hard_link(place.path("state"), place.path(link)).unwrap();
        }
        for spp in ["5", "8"] {
            place.succeed(&[&render("parts.exr", spp)[..], &["--resume", "state"]].concat());
        }
        same(&place.picture("parts.exr"), &place.picture("one.exr"));
        assert!(!place.path("state.draft").exists());
        assert_ne!(std::fs::read(place.path("state")).unwrap(), std::fs::read(place.path("state.before")).unwrap());
    }
}

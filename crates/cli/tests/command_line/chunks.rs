//! Renders in chunks, merged pictures, and packed scenes.

use crate::Place;
use std::{
    io::{BufRead, BufReader, Write},
    process::Stdio,
};
use steradian::image::Image;

/// Options of a small render.
const SMALL: [&str; 5] = ["builtin:cornell-box", "--size", "40x36", "--spp", "6"];

pub fn same(a: &Image, b: &Image) {
    assert_eq!((a.width(), a.height(), a.offset, a.frame), (b.width(), b.height(), b.offset, b.frame));
    assert_eq!(a.channel_names(), b.channel_names());
    for (a, b) in a.channels().iter().zip(b.channels()) {
        assert!(a.data.iter().zip(&b.data).all(|(a, b)| a.to_bits() == b.to_bits()), "{}", a.name);
    }
}

/// However a render is cut, and whichever way it is computed, its chunks come to the bits of one run.
#[test]
fn chunks_come_to_the_bits_of_one_run() {
    for more in [
        &["--aov", "all,halves,light_groups"][..],
        &["--integrator", "bdpt", "--aov", "variance"],
        &["--integrator", "light", "--crop", "3,5,30,20"],
        &["--integrator", "sppm"],
        &["--color", "spectral", "--seed", "4", "--denoise"],
    ] {
        let place = Place::new();
        let options = [&SMALL[..], more].concat();
        place.succeed(&[&["render", "-o", "one.exr", "-o", "one.png"], &*options].concat());
        for chunks in ["1", "3"] {
            let job = format!("job{chunks}");
            let planned = place.succeed(&[&["plan", "--json", "-o", &job, "--chunks", chunks], &*options].concat());
            assert_eq!(planned.json()["chunks"].to_string(), chunks);
            // In any order, by any number of threads.
            let last = (chunks.parse::<u32>().unwrap() - 1).to_string();
            place.succeed(&["chunk", &job, &last, "--threads", "1"]);
            place.succeed(&["chunk", &job, &format!("0..{last}")]);
            place.succeed(&["merge", &job, "-o", "merged.exr", "-o", "merged.png"]);
            same(&place.picture("merged.exr"), &place.picture("one.exr"));
            same(&place.picture("merged.png"), &place.picture("one.png"));
        }
    }
}

/// A worker computes the chunks whose numbers it is given, and answers each before it asks for the next.
#[test]
fn a_worker_answers_one_by_one() {
    let place = Place::new();
    place.succeed(&[&["plan", "-o", "job", "--chunks", "4"], &SMALL[..]].concat());
    let mut worker = place.command(&["chunk", "job", "-", "--quiet"]);
    let mut worker = worker.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let (mut to, from) = (worker.stdin.take().unwrap(), BufReader::new(worker.stdout.take().unwrap()));
    let mut answers = from.lines();
    for chunk in [2, 0, 2, 3, 1] {
        writeln!(to, "{chunk}").unwrap();
        assert_eq!(answers.next().unwrap().unwrap(), format!("{{\"chunk\":{chunk},\"code\":0}}"));
    }
    drop(to);
    assert!(worker.wait().unwrap().success());
    place.succeed(&["merge", "job", "-o", "merged.exr"]);
    place.succeed(&[&["render", "-o", "one.exr"], &SMALL[..]].concat());
    same(&place.picture("merged.exr"), &place.picture("one.exr"));
    for (said, about) in [("seven\n", "'seven'"), ("9\n", "no chunk 9")] {
        let mut command = place.command(&["chunk", "job", "-"]);
        let mut worker = command.stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        worker.stdin.take().unwrap().write_all(said.as_bytes()).unwrap();
        let output = worker.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(about));
    }
}

/// Frames of an animation are cut like one long picture.
#[test]
fn frames_are_planned_together() {
    let place = Place::new();
    let scene = std::path::absolute("../../scenes/windmill.gltf").unwrap();
    let options = [scene.to_str().unwrap(), "--size", "33x20", "--spp", "2", "--frames", "2..4"];
    place.succeed(&[&["render", "-o", "one.exr"], &options[..]].concat());
    place.succeed(&[&["plan", "-o", "job", "--chunks", "4"], &options[..]].concat());
    place.succeed(&["chunk", "job", "0..3"]);
    place.succeed(&["merge", "job", "-o", "merged.exr"]);
    // Of an archive, too.
    place.succeed(&["pack", scene.to_str().unwrap(), "-o", "windmill.zip"]);
    let packed = [&["windmill.zip"], &options[1..]].concat();
    place.succeed(&[&["render", "-o", "packed.exr"], &*packed].concat());
    place.succeed(&[&["plan", "-o", "job2", "--chunks", "2"], &*packed].concat());
    place.succeed(&["chunk", "job2", "0..1"]);
    place.succeed(&["merge", "job2", "-o", "both.exr"]);
    for frame in 2..=4 {
        let name = |stem: &str| format!("{stem}.{frame:04}.exr");
        for other in ["merged", "packed", "both"] {
            same(&place.picture(&name(other)), &place.picture(&name("one")));
        }
    }
}

/// A chunk that is there is not computed again, a damaged one is, and what is missing, unfinished or foreign is told.
#[test]
fn chunks_are_told_apart() {
    let place = Place::new();
    let plan = |job: &str, more: &[&str]| {
        place.succeed(&[&["plan", "-o", job, "--chunks", "5"], &SMALL[..], more].concat());
    };
    plan("job", &[]);
    // The same plan once more is the same job; another one is not.
    plan("job", &[]);
    place.refuse(2, &[&["plan", "-o", "job", "--chunks", "4"], &SMALL[..]].concat(), &["holds another job"]);
    place.refuse(75, &["merge", "job"], &["missing: 0-4"]);
    place.refuse(2, &["chunk", "job", "5"], &["no chunk 5", "0 to 4"]);
    place.succeed(&["chunk", "job", "0..3"]);
    place.refuse(75, &["merge", "job"], &["missing: 4"]);
    let again = place.succeed(&["chunk", "job", "2"]);
    assert!(again.stderr.contains("there already"), "{}", again.stderr);
    place.succeed(&["chunk", "job", "4"]);
    let part = |job: &str, chunk: u32| place.path(&format!("{job}/{chunk:06}.part"));
    let good = std::fs::read(part("job", 3)).unwrap();
    let mut bad = good.clone();
    bad[good.len() / 2] ^= 1;
    std::fs::write(part("job", 3), &bad).unwrap();
    place.refuse(2, &["merge", "job"], &["chunk 3", "damaged"]);
    let anew = place.succeed(&["chunk", "job", "3"]);
    assert!(anew.stderr.contains("begins anew"), "{}", anew.stderr);
    assert!(place.run(&["merge", "job", "-o", "whole.exr"]).code == 0);
    // A chunk of another job, or another chunk of this one.
    plan("other", &["--seed", "7"]);
    place.succeed(&["chunk", "other", "3"]);
    std::fs::copy(part("other", 3), part("job", 3)).unwrap();
    place.refuse(2, &["merge", "job", "-o", "no.exr"], &["chunk 3", "seed 7, not 0"]);
    std::fs::copy(part("job", 1), part("job", 3)).unwrap();
    place.refuse(2, &["merge", "job", "-o", "no.exr"], &["chunk 3", "another job"]);
    assert!(!place.path("no.exr").exists());
    for (more, why) in [
        (&["--adaptive"][..], "whole picture"),
        (&["--error", "0.1"], "whole picture"),
        (&["--resume", "x"], "its own state"),
        (&["--time", "3s"], "machines"),
        (&["--integrator", "path:reuse=4"], "reuse"),
    ] {
        place.refuse(2, &[&["plan", "-o", "no", "--chunks", "2"], &SMALL[..], more].concat(), &[why]);
    }
    place.refuse(2, &[&["plan", "-o", "no", "--chunks", "99"], &SMALL[..]].concat(), &["9 pieces only"]);
}

/// A job is bound to what its scene's files hold.
#[test]
fn a_scene_that_has_changed_is_refused() {
    let place = Place::new();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    place.file("a.ply", ply);
    let options = ["a.ply", "--size", "16x16", "--spp", "1", "--chunks", "1"];
    place.succeed(&[&["plan", "-o", "job"], &options[..]].concat());
    place.file("a.ply", &ply.replace("0 1 0\n", "0 2 0\n"));
    place.refuse(2, &["chunk", "job", "0"], &["another scene"]);
    // Where it lies elsewhere it is named.
    place.file("b.ply", ply).succeed(&["chunk", "job", "0", "--scene", "b.ply"]);
    place.succeed(&["merge", "job", "--scene", "b.ply", "-o", "out.png"]);
}

/// Renders with several seeds have the mean of all their samples; parts of a frame come to the bits of the whole.
#[test]
fn pictures_are_merged() {
    let place = Place::new();
    for (name, more) in [
        ("a.exr", &["--seed", "1"][..]),
        ("b.exr", &["--seed", "2"]),
        ("left.exr", &["--crop", "0,0,17,36"]),
        ("right.exr", &["--crop", "17,0,40,36"]),
        ("whole.exr", &[]),
    ] {
        place.succeed(&[&["render", "-o", name, "--aov", "variance,cryptomatte"], &SMALL[..], more].concat());
    }
    let merged = place.succeed(&["merge", "a.exr", "b.exr", "-o", "both.exr", "--json"]);
    assert_eq!(merged.json()["parts"], 2);
    let [a, b, both] = ["a.exr", "b.exr", "both.exr"].map(|name| place.picture(name));
    for channel in ["R", "variance.R"] {
        let [a, b, both] = [&a, &b, &both].map(|image| image.channel(channel).unwrap());
        let divisor = if channel == "R" { 2.0 } else { 4.0 };
        assert!((0..a.len()).all(|k| (both[k] - (a[k] + b[k]) / divisor).abs() <= 1e-6 * both[k].abs()));
    }
    place.succeed(&["merge", "right.exr", "left.exr", "-o", "joined.exr"]);
    same(&place.picture("joined.exr"), &place.picture("whole.exr"));
    place.refuse(2, &["merge", "a.exr", "whole.exr", "a.exr", "-o", "no.exr"], &["same seed (1)"]);
    place.refuse(2, &["merge", "a.exr", "b.exr"], &["-o OUT.exr"]);
    place.refuse(2, &["merge", "a.exr", "b.exr", "-o", "b.exr"], &["would be overwritten"]);
    place.refuse(2, &["merge", "a.exr", "nothing.exr", "-o", "no.exr"], &["nothing.exr"]);
}

/// A scene and its files in one archive are the same scene, whichever command reads it.
#[test]
fn a_packed_scene_is_the_scene() {
    let place = Place::new();
    std::fs::create_dir_all(place.path("scenes/maps")).unwrap();
    let texture = Image::from_rgb(2, 1, &[[0.8, 0.2, 0.1], [0.1, 0.3, 0.9]]).unwrap();
    steradian::image::write(&place.path("scenes/maps/t.png"), &texture, &Default::default()).unwrap();
    place.file(
        "scenes/scene.pbrt",
        "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 10\nCamera \"perspective\"\nWorldBegin\n\
        LightSource \"infinite\"\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"maps/t.png\"\n\
        Material \"diffuse\" \"texture reflectance\" \"t\"\nTranslate 0 0 3\nInclude \"ball.pbrt\"\n",
    );
    place.file("scenes/ball.pbrt", "Shape \"sphere\" \"float radius\" 1\n");
    let packed = place.succeed(&["pack", "scenes/scene.pbrt", "-o", "scene.zip", "--json"]).json();
    assert_eq!(packed["files"], 3);
    let render = |scene: &str, out: &str| {
        place.succeed(&["render", scene, "--spp", "2", "-o", out]);
        place.picture(out)
    };
    let plain = render("scenes/scene.pbrt", "plain.exr");
    same(&plain, &render("scene.zip", "zip.exr"));
    same(&plain, &render("scene.zip/scene.pbrt", "inside.exr"));
    place.succeed(&["info", "scene.zip"]);
    place.refuse(2, &["render", "scene.zip/sceen.pbrt"], &["no file 'sceen.pbrt'"]);
    place.refuse(2, &["pack", "scenes/scene.pbrt", "-o", "scene.tar"], &[".zip"]);
    place.refuse(2, &["pack", "builtin:cornell-box", "-o", "c.zip"], &["no scene file"]);
    place.file("broken.zip", "PK").refuse(2, &["render", "broken.zip"], &["no zip archive"]);
    place.succeed(&["plan", "scene.zip", "--spp", "2", "--chunks", "1", "-o", "job"]);
    place.succeed(&["chunk", "job", "0"]);
    place.succeed(&["merge", "job", "-o", "merged.exr"]);
    same(&place.picture("merged.exr"), &plain);
}

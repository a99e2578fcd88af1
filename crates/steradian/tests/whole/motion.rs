//! The layer of motion against closed forms: what moves, turns or deforms, before cameras that do. With one sample in
//! each pixel the layer of positions tells exactly which point it is of.

use std::sync::Arc;
use steradian::{
    ColorMode, CompileOptions, Control, History, Layer, Quality, Scene, compile, develop,
    image::Image,
    load,
    math::{Vec2, Vec3},
};

/// Pixels of the edges of frames, and of the focal length: the angle of view is 90°.
const SIZE: u32 = 64;
const FOCAL: f32 = 32.0;
const LAYERS: [Layer; 3] = [Layer::POSITION, Layer::MOTION, Layer::IDS];
/// A wall that is wider than the view, 4 units away, and the triangles of squares.
const WALL: &str = "Shape \"bilinearmesh\" \"point3 P\" [ -40 -40 4  40 -40 4  -40 40 4  40 40 4 ]\n";
const SQUARE: &str = "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2  2 1 3 ] \
    \"point3 P\" [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]\n";

/// A scene of some shapes before a camera in a place, which turns to the right by an angle in radians.
fn scene(eye: Vec3, turn: f32, shapes: &str) -> Arc<Scene> {
    let at = eye + Vec3::new(turn.sin(), 0.0, turn.cos());
    let text = format!(
        "LookAt {} {} {}  {} {} {}  0 1 0\nCamera \"perspective\" \"float fov\" 90\nPixelFilter \"box\"\n\
         Film \"rgb\" \"integer xresolution\" {SIZE} \"integer yresolution\" {SIZE}\nWorldBegin\n\
         LightSource \"infinite\"\n{shapes}",
        eye.x, eye.y, eye.z, at.x, at.y, at.z
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("frame.pbrt");
    std::fs::write(&path, text).expect("a file");
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    Arc::new(compile(&load(&path, &Default::default()).desc, &options).scene.expect("a scene"))
}

/// The layers of a frame, and what it leaves to the next one.
fn frame(scene: &Arc<Scene>, integrator: &str, before: Option<&History>) -> (Image, Option<History>) {
    let quality = Quality { layers: LAYERS.to_vec(), threads: 2, ..Quality::of(integrator).spp(1) };
    let mut session = quality.render(scene).expect("a method").session(scene).expect("a session");
    before.iter().for_each(|history| session.follow(history));
    session.step(u32::MAX, &Control::default());
    assert_eq!(session.failure(), None);
    (develop(scene, &session.film(), &LAYERS), session.take_history())
}

/// The layers of the second of two frames.
fn second(scenes: [&Arc<Scene>; 2], integrator: &str) -> Image {
    let (_, history) = frame(scenes[0], integrator, None);
    frame(scenes[1], integrator, Some(&history.expect("layers of motion leave a history"))).0
}

fn vectors<'a>(image: &'a Image, layer: &str) -> impl Iterator<Item = Vec3> + 'a {
    let [x, y, z] = ["X", "Y", "Z"].map(|axis| image.channel(&format!("{layer}.{axis}")).expect("a layer"));
    x.iter().zip(y).zip(z).map(|((x, y), z)| Vec3::new(*x, *y, *z))
}

/// Holds the motion of what is seen against that of its points, which `before` tells: points relative to the camera,
/// before and now. Gives how many pixels show something, and the largest motion.
fn check(image: &Image, before: impl Fn(Vec3) -> [Vec3; 2]) -> (usize, f32) {
    let place = |p: Vec3| Vec2::new(p.x, -p.y) / p.z * FOCAL;
    let (mut count, mut largest) = (0, 0.0_f32);
    let seen = image.channel("object_id.Y").expect("a layer").iter().zip(vectors(image, "P"));
    for ((_, p), found) in seen.zip(vectors(image, "motion")).filter(|((id, _), _)| **id > 0.0) {
        let [then, now] = before(p);
        let expected = place(now) - place(then);
        let off = (found.truncate() - expected).length();
        assert!(off < 1e-3 + 1e-4 * expected.length(), "{found} for {expected} at {p}");
        assert!((found.z - (now.z - then.z)).abs() < 1e-4, "{found} at {p}");
        (count, largest) = (count + 1, largest.max(expected.length()));
    }
    (count, largest)
}

/// A camera that turns moves all by the same angle, near and far; one that goes ahead moves a wall from the middle on.
#[test]
fn cameras_that_turn_and_go_ahead() {
    let turned = |v: Vec3, turn: f32| {
        let (sin, cos) = turn.sin_cos();
        Vec3::new(cos * v.x - sin * v.z, v.y, sin * v.x + cos * v.z)
    };
    let turn = 0.05;
    let [still, right] = [0.0, turn].map(|turn| scene(Vec3::ZERO, turn, WALL));
    let (count, largest) = check(&second([&still, &right], "path"), |p| [p, turned(p, turn)]);
    assert!(count == 64 * 64 && largest > 2.0, "{count} {largest}");
    let [still, right] = [0.0, turn].map(|turn| scene(Vec3::ZERO, turn, ""));
    let sky = second([&still, &right], "path");
    for (k, found) in vectors(&sky, "motion").enumerate() {
        let at = Vec2::new((k as u32 % SIZE) as f32 + 0.5, (k as u32 / SIZE) as f32 + 0.5) - FOCAL;
        let then = turned(at.extend(FOCAL), -turn);
        let expected = at - then.truncate() / then.z * FOCAL;
        // A sample may be half a pixel from the middle.
        assert!((found.truncate() - expected).length() < 0.12 && found.z == 0.0, "{found} for {expected} at {at}");
    }
    for (ahead, up) in [(0.5, 0.0), (-0.3, 0.1)] {
        let eye = Vec3::new(0.0, up, ahead);
        let [still, moved] = [Vec3::ZERO, eye].map(|eye| scene(eye, 0.0, WALL));
        let (count, largest) = check(&second([&still, &moved], "path"), |p| [p, p - eye]);
        assert!(count == 64 * 64 && largest > 2.0, "{count} {largest}");
    }
}

/// Squares and balls that move and turn, placed as groups and by their vertices, at several rates of frames; all
/// methods have the same layers.
#[test]
fn objects_that_move_and_turn() {
    let turned = |v: Vec3, degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    };
    let ball = "Shape \"sphere\" \"float radius\" 0.8\n";
    for shape in [SQUARE, ball] {
        for placed in [true, false] {
            for rate in [12.0, 24.0, 60.0] {
                // A unit and a quarter of a turn in a second.
                let at = |frame: f32| (frame / rate, 90.0 * frame / rate);
                let made = |frame: f32| {
                    let (x, degrees) = at(frame);
                    let place = format!("Translate {x} 0 3 Rotate {degrees} 0 0 1\n");
                    let shapes = match placed {
                        true => format!("ObjectBegin \"a\"\n{shape}ObjectEnd\n{place}ObjectInstance \"a\"\n"),
                        false => format!("{place}{shape}"),
                    };
                    scene(Vec3::ZERO, 0.0, &shapes)
                };
                // Balls of the world have no triangles to be known by.
                if !placed && shape == ball {
                    continue;
                }
                let ([x0, x1], [a0, a1]) = ([at(3.0).0, at(4.0).0], [at(3.0).1, at(4.0).1]);
                let middle = |x: f32| Vec3::new(x, 0.0, 3.0);
                let image = second([&made(3.0), &made(4.0)], "path");
                let (count, largest) = check(&image, |p| [middle(x0) + turned(p - middle(x1), a0 - a1), p]);
                assert!(count > 100 && largest > FOCAL / rate / 3.5, "{count} {largest}");
            }
        }
    }
    let made = |x: f32| scene(Vec3::ZERO, 0.0, &format!("{WALL}Translate {x} 0 3\n{SQUARE}"));
    let scenes = [made(0.0), made(0.2)];
    for method in ["direct", "volpath", "ao", "path:reuse=4", "bdpt", "raster", "raster:frame=hybrid"] {
        let image = second([&scenes[0], &scenes[1]], method);
        let (count, _) = check(&image, |p| [if p.z < 3.5 { p - Vec3::X * 0.2 } else { p }, p]);
        assert_eq!(count, 64 * 64, "{method}");
        let still = vectors(&image, "P").zip(vectors(&image, "motion")).filter(|(p, _)| p.z > 3.5);
        let still: Vec<Vec3> = still.map(|(_, motion)| motion).collect();
        assert!(still.len() > 1000 && still.iter().all(|m| *m == Vec3::ZERO), "{method}");
    }
}

/// Points of meshes whose vertices move are those of the same places on triangles.
#[test]
fn meshes_that_deform() {
    let mesh = |shear: f32| {
        let point = |k: u32| [(k % 9) as f32 / 4.0 - 1.0, (k / 9) as f32 / 4.0 - 1.0];
        let points = (0..81).map(point).map(|[x, y]| format!("{} {y} {}", x + shear * y, 2.5 + shear * x));
        let faces = (0..64)
            .map(|k| k / 8 * 9 + k % 8)
            .map(|k| format!("{k} {} {} {} {} {}", k + 1, k + 9, k + 9, k + 1, k + 10));
        let [points, faces] = [points.collect::<Vec<_>>(), faces.collect()].map(|list| list.join(" "));
        let shapes = format!("Shape \"trianglemesh\" \"integer indices\" [ {faces} ] \"point3 P\" [ {points} ]\n");
        scene(Vec3::ZERO, 0.0, &shapes)
    };
    let (then, now) = (0.1, 0.25);
    let (count, largest) = check(&second([&mesh(then), &mesh(now)], "path"), |p| {
        let x = p.x - now * p.y;
        [Vec3::new(x + then * p.y, p.y, 2.5 + then * x), p]
    });
    assert!(count > 500 && largest > 1.0, "{count} {largest}");
}

/// Before the first frame, after one of another size, and where a point was behind the camera, nothing moves; the scene
/// is kept only where the layer is asked for.
#[test]
fn what_is_not_known_does_not_move() {
    let [first, other] = [Vec3::ZERO, Vec3::Z * 5.0].map(|eye| scene(eye, 0.0, WALL));
    let (image, history) = frame(&first, "path", None);
    assert!(vectors(&image, "motion").all(|m| m == Vec3::ZERO));
    let (image, _) = frame(&other, "path", history.as_ref());
    // Only the sky is seen from behind the wall; from before it the wall was behind.
    assert!(vectors(&image, "motion").all(|m| m == Vec3::ZERO));
    let back = second([&other, &first], "path");
    assert!(vectors(&back, "P").all(|p| (p.z - 4.0).abs() < 1e-4));
    assert!(vectors(&back, "motion").all(|m| m == Vec3::ZERO));
    let mut small = (*first).clone();
    small.change(|parts| (parts.film.width, parts.film.crop.x1) = (32, 32));
    let (image, _) = frame(&Arc::new(small), "path", history.as_ref());
    assert!(vectors(&image, "motion").all(|m| m == Vec3::ZERO));
    let quality = Quality { layers: vec![Layer::POSITION], ..Quality::of("path").spp(1) };
    let mut session = quality.render(&first).expect("a method").session(&first).expect("a session");
    session.step(u32::MAX, &Control::default());
    assert!(session.take_history().is_none());
}

/// Layers of motion change nothing else.
#[test]
fn other_layers_keep_their_bits() {
    let scenes = [0.0, 0.1].map(|x| scene(Vec3::X * x, 0.0, WALL));
    let alone = frame(&scenes[1], "path", None).0;
    let after = second([&scenes[0], &scenes[1]], "path");
    for channel in ["R", "G", "B", "P.X", "P.Y", "P.Z", "object_id.Y"] {
        assert_eq!(alone.channel(channel), after.channel(channel), "{channel}");
    }
    assert_ne!(alone.channel("motion.X"), after.channel("motion.X"));
}

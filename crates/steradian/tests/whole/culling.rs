//! The culling of the integrator `raster`: pictures that it leaves as they are, and what rays say about its verdicts
//! (M237, M245, M246, M247).

use steradian::{CompileOptions, Control, Quality, Scene, compile, load, math::Vec2};
use steradian_accel::bounding::{Answers, Class};
use steradian_realtime::{
    BoundsKind, Culling, Projected, Visibility, Wanted,
    culling::{Chunks, Selection, Tally, Verdict, classify, judge},
    draw_list::DrawList,
};

/// The head of scenes of 160 × 120 pixels.
const HEAD: &str = r#"
LookAt 0 -6 1  0 0 1  0 0 1
Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 160 "integer yresolution" 120
WorldBegin
LightSource "distant" "rgb L" [1 1 1] "point3 from" [-1 -2 3] "point3 to" [0 0 0]
Material "diffuse" "rgb reflectance" [0.6 0.5 0.4]
"#;

/// A wall before many balls, some of which stick out beside it, behind the eye, and before it.
fn wall() -> String {
    let mut text = HEAD.to_owned();
    text +=
        r#"Shape "trianglemesh" "point3 P" [-1.5 -2 -1 1.5 -2 -1 1.5 -2 3 -1.5 -2 3] "integer indices" [0 1 2 0 2 3]"#;
    for (i, j, k) in (0..12).flat_map(|i| (0..6).flat_map(move |j| (0..5).map(move |k| (i, j, k)))) {
        let [x, y, z] = [i as f32 * 0.9 - 5.0, j as f32 * 1.7 - 0.8, k as f32 * 0.7 - 0.4];
        text +=
            &format!("\nAttributeBegin\nTranslate {x} {y} {z}\nShape \"sphere\" \"float radius\" 0.3\nAttributeEnd");
    }
    text += "\nAttributeBegin\nTranslate 0.4 -3.5 1.2\nShape \"sphere\" \"float radius\" 0.2\nAttributeEnd";
    text + "\nAttributeBegin\nTranslate 0 -9 1\nShape \"sphere\" \"float radius\" 0.5\nAttributeEnd\n"
}

/// A terrain of 20 000 triangles before and behind a ridge, and a placed group of it, mirrored.
fn terrain() -> String {
    let side = 100;
    let at = |i: i32, j: i32| {
        let [x, y] = [i as f32 * 0.3 - 15.0, j as f32 * 0.3 - 8.0];
        format!("{x} {y} {} ", (x * 1.3).sin() * 0.3 + 2.2 * (-(y - 1.0) * (y - 1.0)).exp() - 0.6)
    };
    let points: String = (0..=side).flat_map(|j| (0..=side).map(move |i| at(i, j))).collect();
    let cell = |i: i32, j: i32| {
        let a = j * (side + 1) + i;
        let [b, c, d] = [a + 1, a + side + 1, a + side + 2];
        format!("{a} {b} {d} {a} {d} {c} ")
    };
    let indices: String = (0..side).flat_map(|j| (0..side).map(move |i| cell(i, j))).collect();
    format!(
        "{HEAD}ObjectBegin \"land\"\nShape \"trianglemesh\" \"point3 P\" [{points}] \"integer indices\" [{indices}]\n\
         ObjectEnd\nObjectInstance \"land\"\nAttributeBegin\nTranslate 0 4 -0.2\nScale -1 1 1\n\
         ObjectInstance \"land\"\nAttributeEnd\n"
    )
}

/// Balls of a twentieth to two pixels, scattered, and some behind a disk.
fn tiny() -> String {
    let mut text = HEAD.to_owned();
    text += "AttributeBegin\nTranslate 0 -2 1\nRotate 90 1 0 0\nShape \"disk\" \"float radius\" 0.5\nAttributeEnd";
    let turn = |i: i32, step: f32| (i as f32 * step).fract() - 0.5;
    for i in 0..400 {
        let [x, y, z] = [turn(i, 0.618) * 5.0, turn(i, 0.755) * 2.0, turn(i, 0.57) * 3.0 + 1.0];
        let radius = 0.001 + 0.04 * (turn(i, 0.237) + 0.5);
        text += &format!(
            "\nAttributeBegin\nTranslate {x} {y} {z}\nShape \"sphere\" \"float radius\" {radius}\nAttributeEnd"
        );
    }
    text + "\n"
}

fn scene_of(text: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.pbrt");
    std::fs::write(&path, text).unwrap();
    let loaded = load(path.to_str().unwrap(), &Default::default());
    assert!(!loaded.diagnostics.has_errors());
    let options = CompileOptions { mode: Some(steradian::ColorMode::Rgb), ..CompileOptions::default() };
    compile(&loaded.desc, &options).scene.unwrap()
}

/// Pixels of a render on so many threads, and what it notes.
fn render(scene: &Scene, options: &str, threads: usize) -> (Vec<[f64; 3]>, Vec<String>) {
    let integrator = Some(format!("raster:frame=forward,shadows=none,{options}"));
    let quality = Quality { integrator, threads, ..Quality::default() };
    let scene = std::sync::Arc::new(scene.clone());
    let mut session = quality.render(&scene).unwrap().session(&scene).unwrap();
    session.step(u32::MAX, &Control::default());
    assert_eq!(session.failure(), None);
    (session.film().pixels.iter().map(|p| p.mean()).collect(), session.notes())
}

/// The verdicts of a method about a scene, counted, and compared with rays.
fn judged(scene: &Scene, culling: Culling, bounds: BoundsKind) -> (Tally, Answers) {
    let list = DrawList::new(scene);
    let projected = Projected::new(scene, Vec2::splat(0.5)).unwrap();
    let chunks = Chunks::new(scene, &list, &projected, bounds);
    let verdicts = judge(scene, &list, &projected, &chunks, culling).unwrap();
    let draw = |selection| {
        Visibility::draw_wanted(scene, &list, &projected, Wanted { selection, ..Wanted::default() }).unwrap()
    };
    let (all, some) = (draw(Selection::All), draw(Selection::Chunks(&chunks, &verdicts)));
    assert!(culling == Culling::ScreenSize || all.differing(&some) == 0, "{culling:?} {bounds:?}");
    let classified = classify(scene, &list, &projected, &chunks, &verdicts, culling).unwrap();
    (Tally::new(culling, &chunks, &verdicts), classified.answers)
}

const CONSERVATIVE: [Culling; 3] = [Culling::Frustum, Culling::Hiz, Culling::Occlusion];
const BOUNDS: [BoundsKind; 5] =
    [BoundsKind::Aabb, BoundsKind::Sphere, BoundsKind::Obb, BoundsKind::KDop, BoundsKind::Hull];

/// Conservative culling changes no bit of a picture, nor do numbers of threads; notes tell what was left out.
#[test]
fn pictures_stay_as_they_are() {
    for text in [wall(), terrain(), tiny()] {
        let scene = scene_of(&text);
        let (all, notes) = render(&scene, "culling=none", 2);
        assert_eq!(notes, Vec::<String>::new());
        let (primitives, _) = render(&scene, "culling=none,show=primitives", 2);
        for name in ["items", "frustum", "hiz", "occlusion", "portals", "pvs"] {
            let (some, notes) = render(&scene, &format!("culling={name}"), 2);
            assert!(all == some, "{name}");
            assert_eq!(notes.len(), usize::from(name != "items"), "{notes:?}");
            assert!(notes.iter().all(|note| note.contains("outside the view")), "{notes:?}");
            assert!(primitives == render(&scene, &format!("culling={name},show=primitives"), 1).0, "{name}");
        }
        let view = "culling=hiz,show=culling";
        assert_eq!(render(&scene, view, 1), render(&scene, view, 3));
    }
}

/// Behind a wall, each method leaves out no more than is hidden; depths leave out more than planes, and more than
/// volumes.
#[test]
fn walls_hide_what_is_behind_them() {
    let scene = scene_of(&wall());
    for bounds in BOUNDS {
        let [frustum, hiz, occlusion] = CONSERVATIVE.map(|culling| judged(&scene, culling, bounds));
        for (tally, answers) in [frustum, hiz, occlusion] {
            assert_eq!(answers.false_negatives, 0, "{tally} {answers:?}");
            assert!(matches!(answers.class(), Class::Exact | Class::Conservative), "{tally}");
            assert!(tally.chunks(Verdict::Outside) > 0, "{tally}");
        }
        assert!(
            hiz.0.chunks(Verdict::Hidden) > 50 && occlusion.0.chunks(Verdict::Hidden) > 50,
            "{} {}",
            hiz.0,
            occlusion.0
        );
        let wrong = [frustum, hiz, occlusion].map(|(_, answers)| answers.false_positives);
        assert!(wrong[1] * 2 < wrong[0] && wrong[2] * 2 < wrong[0], "{bounds:?} {wrong:?}");
    }
    let (_, items) = judged(&scene, Culling::None, BoundsKind::Aabb);
    assert_eq!((items.true_negatives, items.false_negatives), (0, 0));
}

/// Ridges hide chunks of meshes, in the world and in mirrored groups.
#[test]
fn ridges_hide_chunks_of_meshes() {
    let scene = scene_of(&terrain());
    let [frustum, hiz, occlusion] = CONSERVATIVE.map(|culling| judged(&scene, culling, BoundsKind::Aabb));
    for (tally, answers) in [frustum, hiz, occlusion] {
        assert_eq!(answers.false_negatives, 0, "{tally} {answers:?}");
    }
    assert!(hiz.1.false_positives < frustum.1.false_positives, "{:?} {:?}", hiz.1, frustum.1);
}

/// The size in the picture alone leaves out what is seen.
#[test]
fn sizes_leave_out_what_is_seen() {
    let (tally, answers) = judged(&scene_of(&tiny()), Culling::ScreenSize, BoundsKind::Aabb);
    assert!(answers.false_negatives > 0 && answers.true_positives > 0, "{tally} {answers:?}");
    assert!(matches!(answers.class(), Class::Aggressive | Class::Approximate));
    let (pixels, notes) = render(&scene_of(&tiny()), "culling=screen-size,show=culling", 2);
    assert!(notes.iter().any(|note| note.contains("aggressive") || note.contains("approximate")), "{notes:?}");
    assert!(pixels.iter().any(|p| p[0] > 0.4 && p[1] == 0.0 && p[2] > 0.4), "no pixel is magenta");
}

/// `scenes/rooms.pbrt` from another place, with some more text.
fn rooms(head: &str, more: &str) -> Scene {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/rooms.pbrt");
    let text = std::fs::read_to_string(path).unwrap();
    let (_, world) = text.split_once("WorldBegin").unwrap();
    let film = "Film \"rgb\" \"integer xresolution\" 120 \"integer yresolution\" 80";
    scene_of(&format!("{head}\n{film}\nWorldBegin{world}\n{more}"))
}

/// From everywhere in a flat, in doors, on planes between cells, outside, and with parallel rays, portals and sets hide
/// nothing that is seen; they hide more than planes, and portals more than sets.
#[test]
fn portals_hide_other_rooms() {
    let perspective = "Camera \"perspective\" \"float fov\" 70";
    let parallel = "Camera \"orthographic\" \"float screenwindow\" [-3 3 -2 2]";
    let mut hidden = [0, 0];
    for (camera, look) in [
        (perspective, "2.2 0.4 1.6  2.6 6 1.3"),
        (perspective, "2.5 4.1 1  2.4 9 1"),
        (perspective, "2.5 4.1 1  12 5 1.2"),
        (perspective, "0.5 5 1.6  17 5 1.4"),
        (perspective, "7.5 4 1  7.5 8 1"),
        (perspective, "5 5.8 1.5  14 4.2 1"),
        (perspective, "6 8.4 1.6  14 9.2 1.2"),
        (perspective, "17.5 1 1.6  17 9 1"),
        (perspective, "18 5 1.6  2 5 1"),
        (perspective, "13 2 2.6  12.4 9 0"),
        (perspective, "-8 -6 4  5 5 1"),
        (perspective, "9 5 12  9 5.1 0"),
        (parallel, "2.5 0.5 1.4  2.5 9 1.4"),
        (parallel, "-6 4.9 1.2  9 5.2 1.2"),
    ] {
        let scene = rooms(&format!("LookAt {look}  0 0 1\n{camera}"), "");
        let [frustum, portals, pvs] =
            [Culling::Frustum, Culling::Portals, Culling::Pvs].map(|culling| judged(&scene, culling, BoundsKind::Aabb));
        for (tally, answers) in [&frustum, &portals, &pvs] {
            assert_eq!(answers.false_negatives, 0, "{look}: {tally} {answers:?}");
        }
        let drawn = [frustum, portals, pvs].map(|(tally, _)| tally.chunks(Verdict::Drawn));
        assert!(drawn[1] <= drawn[2] && drawn[2] <= drawn[0], "{look}: {drawn:?}");
        hidden = [hidden[0] + drawn[0] - drawn[1], hidden[1] + drawn[0] - drawn[2]];
    }
    assert!(hidden[0] > 1000 && hidden[1] > 500, "{hidden:?}");
}

/// A door that is closed hides the room behind it, and pictures stay as they are.
#[test]
fn closed_doors_hide_rooms() {
    let head = "LookAt 2.2 0.4 1.6  2.6 6 1.3  0 0 1\nCamera \"perspective\" \"float fov\" 60";
    let door = r#"Shape "trianglemesh" "point3 P" [2 4 0 3 4 0 3 4 2.1 2 4 2.1] "integer indices" [0 1 2 0 2 3]"#;
    let counts = ["", door].map(|more| {
        let scene = rooms(head, more);
        let (all, _) = render(&scene, "culling=none", 2);
        ["portals", "pvs"].map(|name| {
            let (some, notes) = render(&scene, &format!("culling={name}"), 2);
            assert!(all == some, "{name}");
            assert!(notes[0].contains("portals") && notes[0].contains(" cells"), "{notes:?}");
            let culling = if name == "pvs" { Culling::Pvs } else { Culling::Portals };
            judged(&scene, culling, BoundsKind::Hull).0.chunks(Verdict::Drawn)
        })
    });
    assert!(counts[1].iter().zip(counts[0]).all(|(closed, open)| 2 * closed < open), "{counts:?}");
}

/// Without walls nothing but the view decides, which the notes say.
#[test]
fn scenes_without_walls_say_so() {
    let scene = scene_of(&terrain());
    for culling in [Culling::Portals, Culling::Pvs] {
        let [some, frustum] = [culling, Culling::Frustum].map(|culling| judged(&scene, culling, BoundsKind::Aabb).0);
        assert_eq!(some.chunks(Verdict::Drawn), frustum.chunks(Verdict::Drawn));
        assert!(some.to_string().contains("no wall"), "{some}");
    }
}

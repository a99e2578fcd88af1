//! The integrator `structure`: steps by hand and by the structure's own counters, boxes and cells, and hits that are
//! the same in every structure.

use std::sync::Arc;
use steradian::{
    Accelerator, CompileOptions, Control, Layer, Quality, Scene, compile, develop, load, math::Vec2, scene::Family,
};

/// The head of scenes of 48 × 36 pixels.
const HEAD: &str = r#"
LookAt 0 -6 1  0 0 1  0 0 1
Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 48 "integer yresolution" 36
WorldBegin
"#;

/// A triangle in the middle of the view.
const TRIANGLE: &str = r#"Shape "trianglemesh" "point3 P" [-1 0 0 1 0 0 0 0 2] "integer indices" [0 1 2]"#;

/// Balls, disks, a mesh that casts holes, placed groups, and curves over a floor.
fn many() -> String {
    let mut text = HEAD.to_owned();
    text += "Shape \"trianglemesh\" \"point3 P\" [-3 -2 0 3 -2 0 3 4 0 -3 4 0] \"integer indices\" [0 1 2 0 2 3]\n";
    text += &format!("ObjectBegin \"pair\"\n{TRIANGLE}\nShape \"sphere\" \"float radius\" 0.4\nObjectEnd\n");
    for k in 0..12 {
        let [x, y] = [(k % 4) as f32 * 1.2 - 1.8, (k / 4) as f32 * 1.1 - 0.7];
        text += &format!("AttributeBegin\nTranslate {x} {y} 0.4\nRotate {} 0 0 1\n", 25 * k);
        text += match k % 3 {
            0 => "Scale 0.6 0.6 0.6\nObjectInstance \"pair\"\n",
            1 => "Shape \"sphere\" \"float radius\" 0.35\n",
            _ => {
                "Shape \"trianglemesh\" \"point3 P\" [-.5 0 0 .5 0 0 0 .2 1.5 0 .6 0] \"float alpha\" 0.7 \
                  \"integer indices\" [0 1 2 0 3 2 1 2 3]\n"
            }
        };
        text += "AttributeEnd\n";
    }
    text + "Shape \"curve\" \"point3 P\" [-2 -1 0 -1 -1 2 1 -1 2 2 -1 0] \"float width\" 0.1\n"
}

fn scene_of(text: &str, accelerator: Accelerator) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.pbrt");
    std::fs::write(&path, text).unwrap();
    let loaded = load(path.to_str().unwrap(), &Default::default());
    assert!(!loaded.diagnostics.has_errors());
    compile(&loaded.desc, &CompileOptions { accelerator, ..CompileOptions::default() }).scene.unwrap()
}

/// Pixels of a render, and what it notes.
fn render(scene: &Scene, options: &str, threads: usize) -> (Vec<[f64; 3]>, Vec<String>) {
    let quality = Quality { threads, ..Quality::of(&format!("structure:{options}")) };
    let scene = Arc::new(scene.clone());
    let mut session = quality.render(&scene).unwrap().session(&scene).unwrap();
    session.step(u32::MAX, &Control::default());
    (session.film().pixels.iter().map(|p| p.mean()).collect(), session.notes())
}

fn names() -> [&'static str; Accelerator::ALL.len()] {
    Accelerator::ALL.map(|a| a.about().0)
}

/// The rays through the centres of pixels.
fn rays(scene: &Scene) -> impl Iterator<Item = steradian::math::Ray> + '_ {
    let at = |k: u32| Vec2::new((k % 48) as f32 + 0.5, (k / 48) as f32 + 0.5);
    (0..48 * 36).map(move |k| scene.camera().ray(scene.film(), at(k), Vec2::splat(0.5)))
}

/// One triangle is one leaf and one test, half of the scale to 4: green. A ray beside its box, which cells end with,
/// takes no step: black. Without a structure every ray takes the test. The grid has several cells.
#[test]
fn steps_of_one_triangle() {
    let scene = scene_of(&format!("{HEAD}{TRIANGLE}"), Accelerator::Bvh);
    let is_hit: Vec<bool> = rays(&scene).map(|ray| scene.intersect(&ray).is_some()).collect();
    let (black, green) = ([0.0; 3], [0.0, 1.0, 0.0]);
    let hits = is_hit.iter().filter(|is| **is).count();
    for (name, outside) in [("kdtree", black), ("grid", black), ("octree", black), ("none", green)] {
        let (pixels, notes) = render(&scene, &format!("structure={name},most=4"), 2);
        assert!(pixels.iter().zip(&is_hit).all(|(p, is_hit)| !is_hit || *p == green || name == "grid"), "{name}");
        // The corners of the picture.
        assert_eq!([pixels[0], pixels[48 * 36 - 1]], [outside; 2], "{name}");
        assert!(notes[0].ends_with("the colours end at 4"), "{notes:?}");
    }
    let notes = render(&scene, "structure=none", 1).1;
    // The area of the triangle is that of 105 pixels at its distance: 2 / (2 · 6 tan 22.5° / 36)².
    let every = "a ray visits 1.00 nodes and tests 1.00 primitives on average, 2 together at most";
    assert!(notes[0].starts_with(every) && (90..120).contains(&hits), "{notes:?} {hits}");
}

/// The mean and the largest cost are those that each structure counts itself in a scene that is compiled with it; the
/// structure that `--accelerator` chose is the default.
#[test]
fn sums_are_those_of_the_counters() {
    let (text, plain) = (many(), scene_of(&many(), Accelerator::Bvh));
    let mut means = std::collections::BTreeSet::new();
    for (accelerator, name) in Accelerator::ALL.into_iter().zip(names()) {
        let own = scene_of(&text, accelerator);
        let costs: Vec<_> = rays(&own).map(|ray| own.intersect_cost(&ray)).collect();
        let mean = |sum: u64| sum as f64 / costs.len() as f64;
        let expected = format!(
            "a ray visits {:.2} nodes and tests {:.2} primitives on average, {} together at most; the colours end at 100",
            mean(costs.iter().map(|c| c.steps).sum()),
            mean(costs.iter().map(|c| c.tests).sum()),
            costs.iter().map(|c| c.steps + c.tests).max().unwrap()
        );
        let (pixels, notes) = render(&plain, &format!("structure={name}"), 2);
        assert_eq!(notes, [expected.as_str()], "{name}");
        assert_eq!(render(&own, "", 2), (pixels, notes), "{name}");
        means.insert(expected);
    }
    // Ropes aside, structures differ.
    assert!(means.len() >= 10, "{means:#?}");
}

/// The positions and objects that pixels see have the same bits through every structure.
#[test]
fn hits_are_the_same() {
    let scene = Arc::new(scene_of(&many(), Accelerator::Bvh));
    let layers = vec![Layer::POSITION, Layer::IDS];
    let seen = |integrator: &str| {
        let quality = Quality { layers: layers.clone(), ..Quality::of(integrator) };
        let mut session = quality.render(&scene).unwrap().session(&scene).unwrap();
        session.step(u32::MAX, &Control::default());
        let image = develop(&scene, &session.film(), &layers);
        let planes = image.channels().iter().filter(|c| c.name.contains('.')).map(|c| c.data.clone());
        planes.collect::<Vec<_>>()
    };
    let first = seen("structure:show=cells");
    assert!(first.len() >= 4 && first.iter().all(|plane| plane.iter().any(|v| *v != plane[0])));
    for name in names() {
        assert!(seen(&format!("structure:structure={name},show=cells")) == first, "{name}");
    }
}

/// Pictures and notes have the same bits on one thread and on two to four.
#[test]
fn threads_change_nothing() {
    let scene = scene_of(&many(), Accelerator::Bvh);
    for name in names() {
        for show in ["steps", "cells", "boxes"] {
            if (name, show) == ("bsp", "boxes") {
                continue;
            }
            let options = format!("structure={name},show={show}");
            let one = render(&scene, &options, 1);
            assert!((2..=4).all(|threads| render(&scene, &options, threads) == one), "{options}");
        }
    }
}

/// Cells part the picture where the structure parts space, and a structure without cells shows one colour.
#[test]
fn cells_have_colours() {
    let scene = scene_of(&many(), Accelerator::Bvh);
    let hues = |name: &str| {
        let (pixels, _) = render(&scene, &format!("structure={name},show=cells"), 2);
        // Without the shade: ratios of channels.
        let hue = |p: &[f64; 3]| {
            let most = p[0].max(p[1]).max(p[2]);
            (most > 0.0).then(|| p.map(|c| (c / most * 1000.0).round() as i32))
        };
        pixels.iter().filter_map(hue).collect::<std::collections::BTreeSet<_>>().len()
    };
    // One of the world and one of each of four instances, up to rounding.
    assert!((5..=10).contains(&hues("none")), "{}", hues("none"));
    for name in ["bvh", "grid", "octree", "kdtree", "bsp"] {
        assert!(hues(name) > 15, "{name}: {}", hues(name));
    }
}

/// At level 0 there is the one box around all, and further down there are no fewer. Boxes of a BSP are refused.
#[test]
fn boxes_are_those_of_the_level() {
    let scene = scene_of(&many(), Accelerator::Bvh);
    for name in names().into_iter().filter(|name| *name != "bsp") {
        let counts = [0, 1, 2, 1000].map(|level| {
            let notes = render(&scene, &format!("structure={name},show=boxes,level={level}"), 2).1;
            notes[0].strip_prefix(&format!("level {level} has ")).unwrap().replace(" boxes", "").parse::<u32>().unwrap()
        });
        assert!(counts[0] == 1 && counts.is_sorted(), "{name}: {counts:?}");
        assert!(name == "none" || counts[3] > 5, "{name}: {counts:?}");
    }
    let scene = Arc::new(scene_of(&many(), Accelerator::Bsp));
    let refused = Quality::of("structure:show=boxes").render(&scene).unwrap().session(&scene);
    assert!(refused.unwrap_err().to_string().contains("show=cells"));
}

/// Options are refused that do nothing, and those of the structure are the names of all structures.
#[test]
fn options_go_together() {
    for (options, part) in [
        ("level=2", "of show=boxes, not of show=steps"),
        ("show=cells,most=9", "of show=steps, not of show=cells"),
        ("structure=bsp,show=boxes", "polyhedra"),
        ("structure=quadtree", "octree"),
    ] {
        let refused = Quality::of(&format!("structure:{options}")).request().unwrap_err().to_string();
        assert!(refused.contains(part), "{options}: {refused}");
    }
    let row = Family::Integrator.models().iter().find(|model| model.kind == "structure").unwrap();
    assert!(row.parameter("structure").unwrap().words().eq(names()));
}

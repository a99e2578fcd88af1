//! A scene that is compiled anew after an edit is the scene that is compiled from nothing, and what it had that did not
//! change is not made again.

use std::path::{Path, PathBuf};
use steradian::{
    ColorMode, CompileOptions, Kept, Scene, compile,
    formats::Options,
    load, recompile,
    scene::{Family, Instance, Node, NodeId, SceneDesc, Transform, Value},
};
use steradian_math::DVec3;

fn scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let verify = std::fs::read_dir(root.join("verify")).unwrap().map(|e| e.unwrap().path());
    let mut all: Vec<_> = verify.chain([root.join("motion.pbrt"), root.join("shadows.pbrt")]).collect();
    all.sort();
    all
}

fn read(path: &Path) -> SceneDesc {
    let loaded = load(path, &Options::default());
    assert!(!loaded.diagnostics.has_errors(), "{}", path.display());
    loaded.desc
}

/// Everything a compilation gives, as text.
fn all(compiled: steradian::Compiled) -> String {
    let said: Vec<_> = compiled.diagnostics.iter().map(ToString::to_string).collect();
    format!("{said:?} {:#?}", compiled.scene)
}

/// Another value of the same kind.
fn edited(value: &Value) -> Option<Value> {
    Some(match value {
        Value::Float(v) => Value::Float(v * 0.9),
        Value::Int(v) => Value::Int(v + 1),
        Value::Bool(v) => Value::Bool(!v),
        Value::Vec3(v) => Value::Vec3(v.map(|v| v * 0.9)),
        Value::Floats(v) => Value::Floats(v.iter().map(|v| v * 0.9).collect()),
        _ => return None,
    })
}

#[test]
fn every_edit_gives_the_scene_that_is_compiled_from_nothing() {
    let options = CompileOptions::default();
    let mut edits = 0;
    for path in scenes() {
        let mut desc = read(&path);
        let mut kept = Kept::default();
        recompile(&desc, &options, &mut kept);
        let mut check = |desc: &SceneDesc, what: &str| {
            let (new, old) = (all(recompile(desc, &options, &mut kept)), all(compile(desc, &options)));
            let differs = new.lines().zip(old.lines()).find(|(a, b)| a != b);
            assert!(new == old, "{}: {what}: {differs:?}", path.display());
            edits += 1;
        };
        check(&desc, "nothing");
        for node in 0..desc.nodes.len() {
            for param in 0..desc.nodes[node].params.len() {
                let before = desc.nodes[node].params[param].clone();
                if let Some(value) = edited(&before.value) {
                    desc.nodes[node].params[param].value = value;
                    check(&desc, &before.name);
                    desc.nodes[node].params[param] = before;
                }
            }
        }
        let up = Transform::translate(DVec3::Y * 0.1);
        if let Some(shape) = desc.shapes.first_mut() {
            shape.world_from_object = up * shape.world_from_object;
            check(&desc, "a shape that moved");
        }
        if let Some(Instance { world_from_group, .. }) = desc.instances.first_mut() {
            *world_from_group = up * *world_from_group;
            check(&desc, "an instance that moved");
        }
        if let Some(shape) = desc.shapes.pop() {
            check(&desc, "a shape that is gone");
            desc.shapes.insert(0, shape);
            check(&desc, "shapes in another order");
        }
    }
    assert!(edits > 200, "{edits}");
}

/// A change of the camera and of the size of the picture alone takes what an earlier compilation made as it is, but for
/// shapes that were divided for the camera.
#[test]
fn another_view_gives_the_scene_that_is_compiled_from_nothing() {
    let steps = [
        (Some((40, 30)), None),
        (None, Some([1, 2, 9, 8])),
        (Some((8, 9)), None),
        (None, None),
        (Some((50, 20)), None),
    ];
    let mut divided = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/verify/textured.pbrt"));
    let bumps = divided.add(Node::new(Family::Texture, "checker", None));
    let mesh = divided.shapes.iter().position(|s| s.mesh.is_some()).expect("a mesh");
    let node = divided.shapes[mesh].node;
    divided.node_mut(node).set("displacement", Value::Node(bumps), None);
    divided.node_mut(node).set("edge_pixels", 1.5, None);
    for desc in scenes().iter().map(|path| read(path)).chain([divided]) {
        let (mut desc, mut kept) = (desc, Kept::default());
        recompile(&desc, &CompileOptions::default(), &mut kept);
        let camera = desc.cameras[0];
        for (k, (size, crop)) in steps.into_iter().enumerate() {
            let place = desc.node(camera).get("to_world").cloned();
            let Some(Value::Transform(place)) = place.or(Some(Value::Transform(Transform::IDENTITY))) else { panic!() };
            let moved = Transform::translate(DVec3::new(0.01, 0.02, -0.2)) * place;
            desc.node_mut(camera).set("to_world", Value::Transform(moved), None);
            desc.node_mut(camera).set("fov", 30.0 + k as f64, None);
            // Previews in other colours come between.
            let mode = [ColorMode::Rgb, ColorMode::Spectral][k % 2];
            let options = CompileOptions { size, crop, mode: Some(mode), ..CompileOptions::default() };
            let (new, old) = (all(recompile(&desc, &options, &mut kept)), all(compile(&desc, &options)));
            let differs = new.lines().zip(old.lines()).find(|(a, b)| a != b);
            assert!(new == old && !new.ends_with("None"), "{:?}: {k}: {differs:?}", desc.path);
        }
    }
}

#[test]
fn what_did_not_change_is_not_made_again() {
    let desc = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/verify/textured.pbrt"));
    let options = CompileOptions::default();
    let mut kept = Kept::default();
    let scene = |desc: &SceneDesc, kept: &mut Kept| -> Scene { recompile(desc, &options, kept).scene.unwrap() };
    let first = scene(&desc, &mut kept);
    let is_same = |scene: &Scene| {
        let shapes = scene.geometries().iter().zip(first.geometries()).all(|(a, b)| a.shape.is_same(&b.shape));
        (shapes, std::ptr::eq(scene.accel(), first.accel()))
    };
    assert_eq!(is_same(&scene(&desc, &mut kept)), (true, true));
    let mut dim = desc.clone();
    let materials: Vec<u32> =
        (0..).zip(&dim.nodes).filter(|(_, n)| n.family == Family::Material).map(|n| n.0).collect();
    materials.into_iter().for_each(|m| _ = dim.node_mut(NodeId(m)).set("reflectance", 0.25, None));
    assert_eq!(is_same(&scene(&dim, &mut kept)), (true, true));
    let mut moved = desc.clone();
    moved.shapes[0].world_from_object = Transform::translate(DVec3::Y) * moved.shapes[0].world_from_object;
    assert_eq!(is_same(&scene(&moved, &mut kept)), (false, false));
}

#[test]
fn a_picture_that_changed_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("p.pfm");
    let write = |header: &str, values: &[f32]| {
        let mut bytes = header.as_bytes().to_vec();
        values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        std::fs::write(&picture, bytes).unwrap();
    };
    let path = folder.path().join("s.pbrt");
    let text = r#"Camera "perspective" WorldBegin LightSource "infinite"
        Texture "t" "spectrum" "imagemap" "string filename" "p.pfm"
        Material "diffuse" "texture reflectance" "t" Shape "sphere""#;
    std::fs::write(&path, text).unwrap();
    let (options, mut kept) = (CompileOptions::default(), Kept::default());
    write("PF\n1 1\n-1.0\n", &[0.5, 0.5, 0.5]);
    let desc = read(&path);
    recompile(&desc, &options, &mut kept);
    write("PF\n2 1\n-1.0\n", &[0.25, 0.5, 0.5, 0.1, 0.2, 0.3]);
    assert_eq!(all(recompile(&desc, &options, &mut kept)), all(compile(&desc, &options)));
    std::fs::remove_file(&picture).unwrap();
    assert!(recompile(&desc, &options, &mut kept).scene.is_none());
}

//! Steradian's own language: what it takes, what it says of slips, and that writing and reading are inverse.

use super::{Given, import_bytes, import_with, set, write};
use crate::{Import, Options};
use std::path::Path;
use steradian_scene::{Attribute, Domain, Family, Format, Mesh, Node, NodeId, SceneDesc, Shape, SpectrumValue, Value};

fn read(text: &str) -> Import {
    import_bytes(Path::new("test.steradian"), text.as_bytes().to_vec(), &Options::default())
}

fn sound(text: &str) -> SceneDesc {
    let import = read(text);
    assert!(import.diagnostics.is_empty(), "{:?}", import.diagnostics);
    import.desc
}

/// Diagnostics of a text, as one string.
fn said(text: &str) -> String {
    read(text).diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

const BY_HAND: &str = r#"
steradian: 1
// Names need no quotes, commas are a matter of taste.
materials: {
    gold: {material: conductor, eta: {spectrum: metal-Au-eta}, alpha_u: 0.2}
    floor: {material: diffuse, reflectance: {texture: checkerboard, a: {rgb: [.5 .5 .5]}, b: 0.1}}
}
camera: {camera: perspective, fov: 40, to_world: {look_at: [0, 0, 0], from: [0, 1, -5]}}
shapes: [
    {shape: sphere, radius: 1, material: gold, to_world: [{scale: 2}, {translate: [0, 1, 0]}]}
    {shape: mesh, material: @floor, mesh: {positions: [0 0 0  1 0 0  0 1 0], triangles: [0 1 2]}} /* a triangle */
]
"#;

#[test]
fn a_scene_by_hand() {
    let d = sound(BY_HAND);
    assert_eq!((d.shapes.len(), d.cameras.len(), d.meshes.len()), (2, 1, 1));
    let gold = d.node(d.shapes[0].material.unwrap());
    assert_eq!((gold.name.as_deref(), gold.float("alpha_u")), (Some("gold"), Some(0.2)));
    assert_eq!(gold.get("eta"), Some(&Value::Spectrum(SpectrumValue::Named("metal-Au-eta".into()))));
    // The first map is applied first: the centre is moved by one, not by two.
    let t = d.shapes[0].world_from_object;
    assert_eq!(t.point([1.0, 0.0, 0.0].into()), [2.0, 1.0, 0.0].into());
    let floor = d.node(d.shapes[1].material.unwrap());
    let checks = d.node(floor.node("reflectance").unwrap());
    assert_eq!((checks.family, checks.kind.as_str()), (Family::Texture, "checkerboard"));
}

#[test]
fn json_is_a_scene() {
    let d = sound(
        r#"{"steradian": 1, "lights": {"lamp": {"light": "point", "intensity": {"rgb": [1, 2, 3]}, "position": [0, 1e0, -2]}}}"#,
    );
    let lamp = d.node(d.lights[0]);
    assert_eq!((lamp.name.as_deref(), lamp.vec3("position")), (Some("lamp"), Some([0.0, 1.0, -2.0])));
}

#[test]
fn slips_have_places_and_advice() {
    for (text, parts) in [
        ("steradian: 2", vec!["1:12", "not version 1"]),
        ("shapes: []", vec!["begins with 'steradian: 1'"]),
        ("steradian: 1\nshaeps: []", vec!["2:1", "unknown section 'shaeps'", "did you mean 'shapes'?"]),
        ("steradian: 1\nlights: [{light point}]", vec!["2:17", "a ':' is expected"]),
        ("steradian: 1\nlights: [{lihgt: point}]", vec!["2:11", "did you mean 'light'?"]),
        ("steradian: 1\nlights: [{light: point, scael: 2}]", vec!["2:25", "unused", "did you mean 'scale'?"]),
        ("steradian: 1\nshapes: [{shape: sphere, material: god}]", vec!["2:36", "no node 'god'"]),
        ("steradian: 1\nlights: [{light: point, scale: {rbg: [1,1,1]}}]", vec!["'rbg'"]),
        (
            "steradian: 1\nlights: [{light: point, intensity: {rgb: [1, 1]}}]",
            vec!["3 numbers are expected here, not 2"],
        ),
        ("steradian: 1\nlights: {a: {light: point}, a: {light: point}}", vec!["there is a node 'a' already"]),
        ("steradian: 1\nlights: [{material: diffuse}]", vec!["a light is expected here, not a material"]),
        ("steradian: 1\nmeshes: {a: {positions: [0 0 0], triangles: [0 0 7]}}", vec!["refers to vertex 7"]),
        ("steradian: 1\nmeshes: {a: {file: \"none.ply\"}}", vec!["2:20", "cannot find 'none.ply'"]),
        ("steradian: 1\nfilm: {film: rgb, width: 1x0}", vec!["'1x0' is not a number"]),
        ("steradian: 1\nshapes: [ /* ", vec!["2:11", "not closed"]),
        ("steradian: 1\nfilm: \"rgb", vec!["lacks its closing"]),
        ("steradian: 1\ninstances: [{group: a}]", vec!["no group 'a'"]),
        (
            "steradian: 1\nshapes: [{shape: sphere, to_world: {shear: [1 0 1 0 0 0]}}]",
            vec!["2:44", "this shear leaves no volume"],
        ),
        ("steradian: 1\nshapes: [{shape: sphere, to_world: {yaw_pitch_roll: [1, 2]}}]", vec!["3 numbers"]),
    ] {
        let said = said(text);
        for part in parts {
            assert!(said.contains(part), "{text:?} lacks {part:?}:\n{said}");
        }
        assert!(!said.is_empty(), "{text:?} passes");
    }
}

/// Quarter turns and shears by hand: roll takes x to y, pitch then y to z, yaw then z to x; `xy` adds y to x.
#[test]
fn angles_and_shears_are_transforms() {
    let place = |value: &str, p: [f64; 3]| {
        let d = sound(&format!("steradian: 1\nshapes: [{{shape: sphere, to_world: {value}}}]"));
        d.shapes[0].world_from_object.point(p.into())
    };
    for (value, from, to) in [
        ("{yaw_pitch_roll: [0, 0, 90]}", [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ("{yaw_pitch_roll: [0, 90, 90]}", [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ("{yaw_pitch_roll: [90, 90, 90]}", [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ("{yaw_pitch_roll: [90, 0, 0]}", [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ("{shear: [2, 0, 0, 0, 0, 0]}", [1.0, 3.0, 5.0], [7.0, 3.0, 5.0]),
        ("{shear: [0, 0.5, 0, 1, 0, 0]}", [1.0, 3.0, 4.0], [3.0, 7.0, 4.0]),
        ("{shear: [0, 0, 0, 0, -1, 2]}", [1.0, 3.0, 5.0], [1.0, 3.0, 10.0]),
        ("[{shear: [1, 0, 0, 0, 0, 0]}, {translate: [0, 0, 1]}]", [0.0, 2.0, 0.0], [2.0, 2.0, 1.0]),
    ] {
        let found = place(value, from);
        assert!(
            (found - steradian_math::DVec3::from(to)).length() < 1e-12,
            "{value}: {from:?} goes to {found}, not {to:?}"
        );
    }
}

#[test]
fn reading_goes_on_after_a_slip() {
    let said = said("steradian: 1\nlights: [{light: 3} {lihgt: point}]\nshapes: [{shape: sphere, mesh: no}]");
    assert_eq!(said.matches("error").count(), 3, "{said}");
}

/// Three numbers are a colour where one is taken, in any node and when set later, and a vector elsewhere.
#[test]
fn three_numbers_are_a_colour_where_one_is_taken() {
    let colour = |v| Some(Value::Spectrum(SpectrumValue::Rgb(v, steradian_scene::ColorSpace::Srgb)));
    let mut d = sound(
        "steradian: 1\nmaterials: {m: {material: diffuse, reflectance: {texture: checkerboard, a: [1, 0.5, 0]}}}\n\
         lights: {l: {light: point, position: [1, 2, 3], intensity: [4, 5, 6]}}",
    );
    assert_eq!(d.nodes[0].get("a").cloned(), colour([1.0, 0.5, 0.0]));
    assert_eq!(d.nodes[2].get("position"), Some(&Value::Vec3([1.0, 2.0, 3.0])));
    assert_eq!(d.nodes[2].get("intensity").cloned(), colour([4.0, 5.0, 6.0]));
    set(&mut d, NodeId(1), "reflectance", "[0.1, 0.2, 0.3]", &Options::default()).expect("a colour");
    assert_eq!(d.nodes[1].get("reflectance").cloned(), colour([0.1, 0.2, 0.3]));
    let d =
        sound("steradian: 1\nmedia: {a: {medium: uniformgrid, Le: [1, 2, 3]}, b: {medium: uniformgrid, Le: [1, 2]}}");
    assert_eq!(d.nodes[0].get("Le").cloned(), colour([1.0, 2.0, 3.0]));
    assert_eq!(d.nodes[1].get("Le"), Some(&Value::Floats(vec![1.0, 2.0])));
    let said = said("steradian: 1\nlights: [{light: point, intensity: [4, 5]}]");
    assert!(said.contains("'intensity' takes a colour of 3 numbers, not a list of 2"), "{said}");
}

/// Shapes in a map have names; meshes and pictures may be in memory.
#[test]
fn shapes_have_names_and_files_may_be_in_memory() {
    let text = "steradian: 1\n\
                materials: {m: {material: diffuse, reflectance: {texture: image, file: {file: \"p.png\"}}}}\n\
                shapes: {tri: {shape: mesh, mesh: t, material: m}, ball: {shape: sphere}}";
    let mesh = Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]].into(),
        ..Mesh::default()
    };
    let read = |mesh: Mesh| {
        let files = [("p.png".to_owned(), b"bytes".to_vec())].into();
        let given = Given { meshes: vec![("t".into(), mesh)], files };
        import_with("scene.steradian".as_ref(), text.as_bytes().to_vec(), given, &Options::default())
    };
    let import = read(mesh.clone());
    assert!(!import.diagnostics.has_errors(), "{:?}", import.diagnostics);
    let d = import.desc;
    let named: Vec<_> = d.shapes.iter().map(|s| d.node(s.node).name.as_deref()).collect();
    assert_eq!(named, [Some("tri"), Some("ball")]);
    assert_eq!((d.shapes[0].mesh, &*d.meshes[0]), (Some(0), &mesh));
    assert_eq!(d.embedded.get(Path::new("p.png")).map(|b| &b[..]), Some(&b"bytes"[..]));
    let import = read(Mesh { triangles: vec![[0, 1, 7]].into(), ..mesh });
    let said: String = import.diagnostics.iter().map(ToString::to_string).collect();
    assert!(said.contains("the mesh 't' is faulty: triangle 0 refers to vertex 7"), "{said}");
}

/// Everything that a description can hold.
fn everything() -> SceneDesc {
    let mut d = SceneDesc { format: Format::Pbrt, ..SceneDesc::default() };
    let spectra = [
        SpectrumValue::Constant(0.1),
        SpectrumValue::Rgb([0.1, 1.0, 2e-7], steradian_scene::ColorSpace::Aces),
        SpectrumValue::Sampled { lambdas: vec![400.0, 500.25], values: vec![0.1, 1e-9] },
        SpectrumValue::Blackbody(6500.0),
        SpectrumValue::Named("metal-Ag-eta".into()),
    ];
    let mut all = Node::new(Family::Texture, "constant", None);
    for (i, s) in spectra.into_iter().enumerate() {
        all.set(format!("s{i}"), s, None);
    }
    let values = [
        Value::Bool(true),
        Value::Int(-3),
        Value::Float(3.0),
        Value::Float(f64::INFINITY),
        Value::Float(-0.0),
        Value::String("two words \"and\" a line\n".into()),
        Value::String("true".into()),
        Value::Vec3([1.0, 0.1, -2.0]),
        Value::Floats(vec![]),
        Value::Floats(vec![1.0, 2.0, 3.0]),
        Value::Floats(vec![0.1; 4]),
        Value::Ints(vec![1, 2, 3]),
        Value::Transform(steradian_math::Transform::rotate([1.0, 2.0, 3.0].into(), 0.3)),
    ];
    for (i, v) in values.into_iter().enumerate() {
        all.set(format!("v{i}"), v, None);
    }
    let all = d.add(all);
    let mut named = |name: Option<&str>| {
        let mut node = Node::new(Family::Material, "diffuse", None).with("reflectance", Value::Node(all));
        node.name = name.map(str::to_owned);
        d.add(node)
    };
    let twins = [named(Some("a b")), named(Some("a b")), named(Some("x#1")), named(None), named(Some("true"))];
    let mix = Node::new(Family::Material, "mix", None).with("materials", Value::Nodes(twins[..2].to_vec()));
    let mix = d.add(mix);
    let film = Node::new(Family::Film, "rgb", None).with("crop", Value::Ints(vec![1, 2, 3, 4]));
    d.film = Some(d.add(film));
    let grid: Vec<[f32; 3]> = (0..50).map(|i| [i as f32 * 0.1, 1.0 / (i + 1) as f32, -7.3e-12]).collect();
    let big = Mesh { normals: grid.clone(), positions: grid, triangles: vec![[0, 1, 2]; 9].into(), ..Mesh::default() };
    let attribute = Attribute { name: "color".into(), domain: Domain::Vertex, channels: 3, data: vec![0.3; 150] };
    let patches = Mesh { patches: vec![[3, 4, 5, 6]], ..big.clone() };
    for mesh in [big.clone(), patches, Mesh { attributes: vec![attribute], ..big }] {
        let mesh = d.add_mesh(mesh);
        let node = d.add(Node::new(Family::Shape, "mesh", None));
        d.shapes.push(Shape { mesh: Some(mesh), material: Some(mix), ..Shape::new(node) });
    }
    d.shapes[0].is_medium_boundary = true;
    d.shapes[1].reverse_orientation = true;
    let group = steradian_scene::Group { name: "g".into(), shapes: d.shapes.clone() };
    d.groups = vec![group.clone(), group];
    let place = steradian_math::Transform::translate([1.0, 2.0, 3.0].into());
    d.instances.push(steradian_scene::Instance::new(1, place));
    d
}

#[test]
fn what_is_written_is_read() {
    let d = everything();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("all.steradian");
    let written = write(&d, &path).unwrap();
    for (name, bytes) in &written.files {
        std::fs::create_dir_all(folder.path().join(name).parent().unwrap()).unwrap();
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    assert_eq!(written.files.len(), 2, "large meshes without attributes are files");
    let import = import_bytes(&path, written.text.clone().into_bytes(), &Options::default());
    assert!(!import.diagnostics.has_errors(), "{:?}\n{}", import.diagnostics, written.text);
    let again = import.desc;
    assert_eq!(write(&again, &path).unwrap().text, written.text);
    assert_eq!((again.meshes.as_slice(), again.format), (d.meshes.as_slice(), d.format));
    let texture = |d: &SceneDesc| {
        let node = d.nodes.iter().find(|n| n.kind == "constant").unwrap();
        node.params.iter().map(|p| (p.name.clone(), format!("{:?}", p.value))).collect::<Vec<_>>()
    };
    assert_eq!(texture(&again), texture(&d));
    let names = |d: &SceneDesc| {
        let mut names: Vec<_> = d.nodes.iter().filter(|n| n.kind == "diffuse").map(|n| n.name.clone()).collect();
        names.sort();
        names
    };
    // What nothing refers to is kept as well.
    assert_eq!(names(&again), names(&d));
    assert_eq!(again.instances[0].world_from_group, d.instances[0].world_from_group);
    let flags = |d: &SceneDesc| {
        let shapes = d.shapes.iter().chain(d.groups.iter().flat_map(|g| &g.shapes));
        shapes.map(|s| (s.is_medium_boundary, s.reverse_orientation, s.mesh)).collect::<Vec<_>>()
    };
    assert_eq!(flags(&again), flags(&d));
}

#[test]
fn parameters_are_set_by_text() {
    let mut d = sound(BY_HAND);
    let gold = NodeId(d.nodes.iter().position(|n| n.name.as_deref() == Some("gold")).unwrap() as u32);
    let options = Options::default();
    set(&mut d, gold, "alpha_u", "{texture: constant, value: 0.5}", &options).unwrap();
    let texture = d.node(gold).node("alpha_u").unwrap();
    assert_eq!(d.node(texture).float("value"), Some(0.5));
    set(&mut d, gold, "alpha_u", "null", &options).unwrap();
    assert_eq!(d.node(gold).get("alpha_u"), None);
    let before = d.nodes.len();
    let fault = set(&mut d, gold, "eta", "{spectrum: [1]}", &options).unwrap_err();
    assert!(fault.iter().next().unwrap().to_string().contains("gold.eta:1:12"), "{fault:?}");
    assert_eq!(d.nodes.len(), before);
}

/// Texts that are cut or changed anywhere are read or refused, never more.
#[test]
fn no_text_does_harm() {
    for end in 0..BY_HAND.len() {
        read(&BY_HAND[..end]);
    }
    let mut state = 1_u32;
    for _ in 0..20_000 {
        let mut bytes = BY_HAND.as_bytes().to_vec();
        for _ in 0..3 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let at = (state >> 8) as usize % bytes.len();
            let odd = b"{}[]:,@\"\\#-.e019/*ux\xff\n";
            bytes[at] = odd[(state >> 3) as usize % odd.len()];
        }
        import_bytes(Path::new("test.steradian"), bytes, &Options::default());
    }
    assert!(said(&("steradian: 1 shapes: ".to_owned() + &"[".repeat(1_000_000))).contains("nested more than"));
    assert!(said("steradian: 1 lights: \"\\ud800\\u").contains("hexadecimal"));
}

/// A film, or another node that stands alone, may refer to nodes, even in parameters that it does not have.
#[test]
fn nodes_of_nodes_that_stand_alone_are_written() {
    for film in
        ["{film: rgb, odd: {light: sky, hour: 12}}", "{film: rgb, odd: [@clay, {shape: sphere, material: @clay}]}"]
    {
        let text = format!("steradian: 1\nmaterials: {{clay: {{material: diffuse}}}}\nfilm: {film}\n");
        let read = |bytes: Vec<u8>| {
            let import = import_bytes(Path::new("a.steradian"), bytes, &Options::default());
            assert!(!import.diagnostics.has_errors(), "{:?}", import.diagnostics);
            import.desc
        };
        let written = write(&read(text.into_bytes()), Path::new("a.steradian")).unwrap();
        let again = write(&read(written.text.clone().into_bytes()), Path::new("a.steradian")).unwrap();
        assert_eq!(again.text, written.text);
    }
}

//! Every parameter of the vocabulary, as the schema has it, set to every value that it should not have, in a scene made
//! in code. What the schema names is what is tried, so nothing can be forgotten.

use crate::{
    case::{Case, Expect},
    images,
};
use std::{collections::HashMap, path::PathBuf, sync::Arc};
use steradian::{
    cornell,
    math::{DVec3, Transform},
    scene::{ColorSpace, Family, Format, Group, Instance, Mesh, Node, NodeId, SceneDesc, Shape, SpectrumValue, Value},
    schema::FAMILIES,
};
use steradian_testkit::nanovdb;

/// Integrators that are tried: hostile options of others are tried by those of the command line.
const METHODS: [&str; 4] = ["path", "volpath", "direct", "whitted"];

/// Kinds of a family that have a parameter of the same name take turns with its values, at most so many of them: each
/// value of each name is tried with a fortieth of the kinds at least, and once. Parameters whose names one kind has
/// take turns with the odd and the even values.
const TURNS: usize = 40;

/// A kind of node and its parameters.
struct Row {
    family: Family,
    kind: &'static str,
    parameters: Vec<&'static str>,
}

/// All kinds of all families.
fn rows() -> Vec<Row> {
    let models = FAMILIES.into_iter().flat_map(|family| family.models().iter().map(move |m| (family, m)));
    let models = models.filter(|(family, m)| *family != Family::Integrator || METHODS.contains(&m.kind));
    let models = models.map(|(family, m)| Row { family, kind: m.kind, parameters: m.all().map(|p| p.name).collect() });
    models.collect()
}

/// Values of every type, none of which belongs in a scene. `own` is the node that gets them, `other` one of a family
/// that fits nowhere.
fn poison(own: NodeId, other: NodeId) -> Vec<(String, Value)> {
    let rgb = |v: [f64; 3]| SpectrumValue::Rgb(v, ColorSpace::Srgb);
    let sampled =
        |lambdas: &[f32], values: &[f32]| SpectrumValue::Sampled { lambdas: lambdas.into(), values: values.into() };
    let spectra = [
        SpectrumValue::Constant(f64::NAN),
        SpectrumValue::Constant(1e39),
        SpectrumValue::Constant(-1.0),
        rgb([f64::NAN, 0.0, 1.0]),
        rgb([1e39; 3]),
        rgb([3e38, 0.0, 1e-45]),
        rgb([-1.0, 7.0, 0.0]),
        SpectrumValue::Rgb([0.0, 1.0, 0.0], ColorSpace::Aces),
        sampled(&[], &[]),
        sampled(&[500.0, 400.0], &[1.0, 1.0]),
        sampled(&[400.0, f32::NAN], &[1.0, 1.0]),
        sampled(&[400.0, 500.0], &[f32::NAN, f32::INFINITY]),
        sampled(&[400.0], &[1.0, 2.0]),
        sampled(&[400.0, 700.0], &[3e38, 3e38]),
        sampled(&[-1e30, 1e30], &[-1.0, 1.0]),
        SpectrumValue::Blackbody(f64::NAN),
        SpectrumValue::Blackbody(0.0),
        SpectrumValue::Blackbody(1e-30),
        SpectrumValue::Blackbody(1e30),
        SpectrumValue::Named("nothing".into()),
        SpectrumValue::Named(String::new()),
    ];
    let floats = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e39,
        3e38,
        -3e38,
        1e30,
        1e-30,
        1e-45,
        -1.0,
        -0.0,
        0.0,
        0.9999999,
        7.0,
        180.0,
        1e9,
    ];
    let vectors = [[f64::NAN; 3], [0.0; 3], [1e39; 3], [3e38, -3e38, 0.0], [1e-30; 3]];
    let lists: [&[f64]; 6] = [&[], &[f64::NAN], &[0.0; 4], &[0.0; 12], &[3e38; 12], &[1.0, f64::INFINITY, 0.0, 2.0]];
    let scales = [0.0, f64::NAN, 1e30, 1e-30, 1e38, -1.0];
    let transforms = scales.map(|s| Transform::scale(DVec3::new(s, s, 1.0)));
    let values = floats
        .map(Value::Float)
        .into_iter()
        .chain([i64::MIN, -1, 0, 1, 1 << 31, i64::MAX].map(Value::Int))
        .chain(spectra.map(Value::Spectrum))
        .chain(vectors.map(Value::Vec3))
        .chain(lists.map(|l| Value::Floats(l.into())))
        .chain([vec![], vec![i64::MAX; 4], vec![5, 5, 1, 1], vec![-3, 4, -3, 4]].map(Value::Ints))
        .chain(transforms.map(Value::Transform))
        .chain([
            Value::Node(own),
            Value::Node(other),
            Value::Nodes(vec![]),
            Value::Nodes(vec![own; 2]),
            Value::Nodes(vec![other; 2]),
        ])
        .chain([Value::Bool(true), Value::String("nothing".into()), Value::String(String::new())])
        .chain(["nothing.exr", "", "i.pfm", "nan.pfm"].map(|f| Value::Path(PathBuf::from(f))));
    values.map(|v| (format!("{v:?}"), v)).collect()
}

/// A triangle mesh of two faces, and a closed one for subdivision.
fn meshes() -> [Mesh; 2] {
    let square = Mesh {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Mesh::default()
    };
    let tetrahedron = Mesh {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]].into(),
        ..Mesh::default()
    };
    [square, tetrahedron]
}

/// The box of the lab with one more thing in it, of the family and kind given.
fn scene_of(family: Family, kind: &str, format: Format) -> (SceneDesc, NodeId) {
    let mut scene = SceneDesc { format, ..cornell::point_light() };
    let diffuse = scene.add(Node::new(Family::Material, "diffuse", None));
    let mut node = Node::new(family, kind, None);
    match (family, kind) {
        (Family::Texture, "image" | "distance_field") | (Family::Light, "goniometric" | "projection") => {
            _ = node.set("file", PathBuf::from("i.pfm"), None)
        }
        // Light that is scattered again takes half a second to find: one format in three has it.
        (Family::Light, "atmosphere") if format != Format::Native => _ = node.set("scattering", "single", None),
        (Family::Texture, "mesh_attribute") => _ = node.set("name", "color", None),
        (Family::Material, "mask") => _ = node.set("material", diffuse, None),
        (Family::Material, "two_sided") => _ = node.set("front", diffuse, None),
        (Family::Material, "mix") => {
            let metal = scene.add(Node::new(Family::Material, "conductor", None));
            node.set("materials", vec![diffuse, metal], None);
        }
        (Family::Texture, "ramp") => _ = node.set("colors", vec![0.0, 0.0, 0.0, 1.0, 0.5, 0.2], None),
        (Family::Texture, "curve") => _ = node.set("values", vec![0.0, 1.0], None),
        (Family::Medium, "vdb") => _ = node.set("file", PathBuf::from("v.nvdb"), None),
        (Family::Medium, "uniformgrid") => _ = node.set("density", vec![1.0], None),
        (Family::Shape, "height_field") => {
            node.set("heights", vec![0.0, 0.1, 0.2, 0.0], None).set("nu", 2_i64, None).set("nv", 2_i64, None);
        }
        (Family::Shape, "curve") => {
            _ = node.set("points", vec![-1.0, 0.0, 0.0, -0.5, 1.0, 0.0, 0.5, 1.0, 0.0, 1.0, 0.0, 0.0], None)
        }
        (Family::Shape, "implicit") => _ = node.set("expression", "x^2 + y^2 + sin(4*z) - 0.5", None),
        (Family::Shape, "polygon") => {
            _ = node.set("points", vec![-0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.5, 0.5, 0.0, -0.5, 0.5, 0.0], None)
        }
        (Family::Shape, "bezier_patch") => {
            let points = (0..16).flat_map(|k| [f64::from(k % 4) - 1.5, f64::from(k / 4) - 1.5, f64::from(k % 3) * 0.3]);
            _ = node.set("points", points.collect::<Vec<_>>(), None)
        }
        (Family::Shape, "quadric") => {
            _ = node.set("coefficients", vec![1.0, 1.0, 1.0, 0.2, 0.1, 0.0, 0.0, 0.0, 0.0, -0.5], None)
        }
        (Family::Shape, "sphere") => _ = node.set("radius", 0.4, None),
        _ => {}
    }
    let id = scene.add(node);
    let sphere = scene.add(Node::new(Family::Shape, "sphere", None).with("radius", 0.5));
    let mut more = Shape::new(sphere);
    match family {
        Family::Texture => {
            let material = Node::new(Family::Material, "conductor", None).with("reflectance", id).with("alpha_u", id);
            more.material = Some(scene.add(material));
            scene.node_mut(sphere).set("alpha", id, None);
        }
        Family::Material => more.material = Some(id),
        Family::Light if kind == "area" || kind == "directional_area" => more.emission = Some(id),
        Family::Light => scene.lights.push(id),
        Family::Medium | Family::Phase => {
            let medium = match family {
                Family::Medium => id,
                _ => {
                    let node = Node::new(Family::Medium, "homogeneous", None).with("phase", id);
                    scene.add(node.with("sigma_s", 1.0))
                }
            };
            more.material = Some(scene.add(Node::new(Family::Material, "interface", None)));
            (more.interior, more.is_medium_boundary) = (Some(medium), true);
            scene.node_mut(scene.integrator.expect("the box has one")).kind = "volpath".into();
        }
        Family::Camera => {
            let place = scene.node(scene.cameras[0]).transform("to_world").unwrap_or_default();
            scene.node_mut(id).set("to_world", place, None);
            scene.cameras = vec![id];
        }
        Family::Film => {
            scene.node_mut(id).set("width", 8_i64, None).set("height", 8_i64, None);
            scene.film = Some(id);
        }
        Family::Filter => scene.filter = Some(id),
        Family::Sampler => scene.sampler = Some(id),
        Family::Integrator => scene.integrator = Some(id),
        Family::Shape => {
            more = Shape::new(id);
            let [square, closed] = meshes();
            let mesh = scene.add_mesh(if kind == "loop_subdivision" { closed } else { square });
            more.mesh = Some(mesh);
            // It also shines, and stands in a group that is placed twice.
            let light = scene.add(Node::new(Family::Light, "area", None));
            let shining = Shape { emission: Some(light), ..more.clone() };
            scene.shapes.push(shining);
            if kind != "plane" {
                scene.groups.push(Group { name: "group".into(), shapes: vec![more.clone()] });
                let at = |x: f64| Transform::translate(DVec3::new(x, 0.0, 0.0));
                let instance = |x| Instance::new(0, at(x));
                scene.instances.extend([instance(-0.5), instance(0.5)]);
            }
        }
        Family::Accelerator => {}
    }
    scene.shapes.push(more);
    (scene, id)
}

/// A case of a description. Films of the scene count where the film is what is tried.
fn case(name: String, scene: SceneDesc, small: bool, expect: Expect) -> Case {
    let case = Case::new(name, "i.pfm", images::pfm(0.5), expect).with("nan.pfm", images::pfm(f32::NAN));
    let mut case = case.with("v.nvdb", nanovdb("density", [2; 3], &[1.0; 8]));
    (case.description, case.small) = (Some(scene), small);
    case
}

/// Descriptions whose parts do not fit together.
fn unsound() -> Vec<Case> {
    let nowhere = NodeId(u32::MAX);
    type Break = fn(&mut SceneDesc, NodeId);
    let faults: [(&str, Break); 14] = [
        ("a parameter", |d, n| _ = d.node_mut(NodeId(0)).set("reflectance", n, None)),
        ("a list of nodes", |d, n| _ = d.node_mut(NodeId(0)).set("materials", vec![n], None)),
        ("a shape", |d, n| d.shapes[0].node = n),
        ("a material", |d, n| d.shapes[0].material = Some(n)),
        ("an emission", |d, n| d.shapes[0].emission = Some(n)),
        ("a medium", |d, n| d.shapes[0].interior = Some(n)),
        ("a light", |d, n| d.lights.push(n)),
        ("a camera", |d, n| d.cameras = vec![n]),
        ("a film", |d, n| d.film = Some(n)),
        ("an integrator", |d, n| d.integrator = Some(n)),
        ("a mesh", |d, _| d.shapes[0].mesh = Some(7)),
        ("no mesh", |d, _| {
            let mesh = d.add(Node::new(Family::Shape, "mesh", None));
            d.shapes.push(Shape::new(mesh));
        }),
        ("a corner", |d, _| {
            let [square, _] = meshes();
            let mesh = d.add_mesh(Arc::new(Mesh { triangles: vec![[0, 1, u32::MAX]].into(), ..square }));
            let node = d.add(Node::new(Family::Shape, "mesh", None));
            d.shapes.push(Shape { mesh: Some(mesh), ..Shape::new(node) });
        }),
        ("a group", |d, _| {
            let instance = Instance::new(3, Transform::IDENTITY);
            d.instances.push(instance);
        }),
    ];
    let case = |(name, break_it): (&str, Break)| {
        let mut scene = cornell::point_light();
        break_it(&mut scene, nowhere);
        case(format!("{name} that is not there"), scene, true, Expect::Refused(""))
    };
    faults.into_iter().map(case).collect()
}

/// Each kind as it is, and then with each of its parameters poisoned.
pub fn table() -> impl Iterator<Item = Case> {
    let rows = rows();
    let mut kinds: HashMap<(Family, &str), usize> = HashMap::new();
    for row in &rows {
        row.parameters.iter().for_each(|p| *kinds.entry((row.family, *p)).or_default() += 1);
    }
    let mut turns = HashMap::new();
    unsound().into_iter().chain(rows.into_iter().flat_map(move |row| {
        let Row { family, kind, parameters } = row;
        let sound = Format::Native;
        let first = case(format!("{family:?} {kind}"), scene_of(family, kind, sound).0, true, Expect::Either);
        let mut whose_turn = |(i, parameter)| {
            let key = (family, parameter);
            let turn = turns.entry(key).or_insert(0);
            *turn += 1;
            if kinds[&key] == 1 { (i, 2) } else { (*turn, kinds[&key].min(TURNS)) }
        };
        let parameters: Vec<_> = parameters.into_iter().enumerate().map(|(i, p)| (whose_turn((i, p)), p)).collect();
        let poisoned = parameters.into_iter().enumerate().flat_map(move |(i, ((turn, turns), parameter))| {
            // Formats differ in defaults and in colour: they take turns.
            let format = [Format::Native, Format::Pbrt, Format::Mitsuba][i % 3];
            let (_, id) = scene_of(family, kind, format);
            let values = poison(id, NodeId(0)).into_iter().enumerate();
            let values = values.filter(move |(v, _)| (turn + v).is_multiple_of(turns));
            values.map(move |(_, (value_name, value))| {
                let (mut scene, id) = scene_of(family, kind, format);
                scene.node_mut(id).set(parameter, value, None);
                // A film without a limit on components clamps nothing.
                let means_none = parameter == "max_component" && value_name == "Float(inf)";
                let wild = (value_name.contains("NaN") || value_name.contains("inf")) && !means_none;
                let expect = if wild { Expect::Told } else { Expect::Either };
                let name = format!("{family:?} {kind}: {parameter} = {value_name} ({format:?})");
                case(name, scene, family != Family::Film, expect)
            })
        });
        std::iter::once(first).chain(poisoned)
    }))
}

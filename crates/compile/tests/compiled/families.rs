//! The schema of textures, lights, media, cameras, films, shapes and so on is what the compiler reads, and its ranges
//! are what the compiler checks.

use super::said;
use std::path::Path;
use steradian_compile::{Options, compile};
use steradian_math::Transform;
use steradian_scene::{ColorSpace, Family, Mesh, Node, NodeId, SceneDesc, Shape, SpectrumValue, Value};
use steradian_schema::{Condition, Model, Parameter, texture};
use steradian_testkit::nanovdb;

const FAMILIES: [Family; 9] = {
    use Family::*;
    [Texture, Light, Medium, Phase, Camera, Film, Filter, Sampler, Shape]
};

/// True if the compiler does not read a parameter, or takes any value of it without a word.
fn is_unread(family: Family, kind: &str, name: &str) -> bool {
    match (family, name) {
        // Readers of other formats set it.
        (Family::Film, "filename") => true,
        // The reader of pbrt's files sets it of every light, and slides have no use for it.
        (Family::Light, "normalize") => kind == "projection",
        _ => false,
    }
}

/// A folder with a picture and a grid.
fn files() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
    let mut picture = b"PF\n2 2\n-1.0\n".to_vec();
    picture.extend(floats(&[0.5; 12]));
    std::fs::write(folder.path().join("i.pfm"), picture).unwrap();
    let mut grid = b"VOL\x03\x01\0\0\0".to_vec();
    [2_i32, 2, 2, 1].iter().for_each(|v| grid.extend(v.to_le_bytes()));
    grid.extend(floats(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, -0.25, -0.25, -0.25, -0.25, 0.75, 0.75, 0.75, 0.75]));
    std::fs::write(folder.path().join("g.vol"), grid).unwrap();
    let volumes = [("density", 1.0), ("temperature", 1000.0)].map(|(name, v)| nanovdb(name, [2; 3], &[v; 8]));
    std::fs::write(folder.path().join("v.nvdb"), volumes.concat()).unwrap();
    folder
}

/// Parameters that a model needs to be compiled.
fn needs(family: Family, kind: &str, files: &Path) -> Vec<(&'static str, Value)> {
    let (picture, grid) = (Value::Path(files.join("i.pfm")), Value::Path(files.join("g.vol")));
    match (family, kind) {
        (Family::Texture, "image" | "distance_field") | (Family::Light, "goniometric") => vec![("file", picture)],
        (Family::Texture, "grid") | (Family::Shape, "sdf_grid") => vec![("file", grid)],
        (Family::Texture, "ramp") => vec![("colors", vec![0.0; 6].into())],
        (Family::Texture, "curve") => vec![("values", vec![0.0, 1.0].into())],
        (Family::Texture, "mesh_attribute") => vec![("name", "color".into())],
        (Family::Phase, "tabulated") => vec![("values", vec![1.0, 2.0].into())],
        (Family::Medium, "vdb") => vec![("file", Value::Path(files.join("v.nvdb")))],
        (Family::Medium, "uniformgrid") => vec![("density", vec![1.0].into())],
        // Without either, a size that is none leaves the medium out without a word.
        (Family::Medium, "rgbgrid") => vec![("sigma_a", vec![1.0; 3].into()), ("sigma_s", vec![1.0; 3].into())],
        (Family::Shape, "curve") => {
            vec![("points", vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0].into())]
        }
        (Family::Shape, "implicit") => vec![("expression", "x^2 + y^2 + z^2 - 0.5".into())],
        (Family::Texture, "expression") => vec![("expression", "0.5*u".into())],
        (Family::Shape, "polygon") => {
            vec![("points", vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].into())]
        }
        (Family::Shape, "bezier_patch") => {
            let points = (0..16).flat_map(|k| [f64::from(k % 4), f64::from(k / 4), 0.0]).collect::<Vec<_>>();
            vec![("points", points.into())]
        }
        (Family::Shape, "quadric") => {
            let mut sphere = vec![1.0, 1.0, 1.0];
            sphere.extend([0.0; 6].into_iter().chain([-0.5]));
            vec![("coefficients", sphere.into())]
        }
        (Family::Shape, "height_field") => {
            vec![("heights", vec![0.0; 4].into()), ("nu", 2_i64.into()), ("nv", 2_i64.into())]
        }
        _ => Vec::new(),
    }
}

/// Parameters that a parameter needs beside it to count.
fn company(family: Family, kind: &str, p: &Parameter, files: &Path) -> Vec<(&'static str, Value)> {
    let picture = || Value::Path(files.join("i.pfm"));
    let mut company = match p.condition {
        Condition::Always => Vec::new(),
        Condition::Is(name, word) => vec![(name, word.into())],
        Condition::Given("file") => vec![("file", picture())],
        Condition::Given("to_world_end") => vec![("to_world_end", Transform::IDENTITY.into())],
        Condition::Given(name) => vec![(name, 0.1.into())],
    };
    let is_in = |group: &[Parameter]| group.iter().any(|q| q.name == p.name);
    let of_picture = is_in(texture::PICTURE.parameters) || is_in(texture::MAPPING.parameters);
    if family == Family::Light && emits_from_shapes(kind) && of_picture {
        company.push(("file", picture()));
    }
    let of_glow = ["Lescale", "temperatureoffset", "temperaturescale", "nx", "ny", "nz"].contains(&p.name);
    if family == Family::Medium && kind != "vdb" && of_glow {
        let le = Value::Spectrum(SpectrumValue::Rgb([1.0; 3], ColorSpace::Srgb));
        company.push(if kind == "homogeneous" { ("Le", le) } else { ("temperature", vec![1000.0].into()) });
    }
    company
}

fn emits_from_shapes(light: &str) -> bool {
    ["area", "directional_area"].contains(&light)
}

/// A value that nothing can use.
fn nonsense(family: Family, kind: &str, p: &Parameter) -> Value {
    match (family, p.name) {
        // Emission of another type than these is ignored.
        (Family::Medium, "Le") if kind == "homogeneous" => {
            let (lambdas, values) = (vec![500.0, 400.0], vec![1.0, 1.0]);
            Value::Spectrum(SpectrumValue::Sampled { lambdas, values })
        }
        (Family::Medium, "Le") => vec![1.0, 1.0].into(),
        _ => Value::Ints(vec![1, 2, 3]),
    }
}

/// The messages that compiling a model with one parameter gives.
fn messages(family: Family, model: &Model, files: &Path, set: Option<(&Parameter, Value)>) -> Vec<String> {
    let mut d = SceneDesc::default();
    let mut node = Node::new(family, model.kind, None);
    for (name, value) in needs(family, model.kind, files) {
        node.set(name, value, None);
    }
    if (family, model.kind) == (Family::Phase, "blend") {
        for name in ["first", "second"] {
            node.set(name, d.add(Node::new(family, "isotropic", None)), None);
        }
    }
    if let Some((p, value)) = set {
        for (name, value) in company(family, model.kind, p, files) {
            node.set(name, value, None);
        }
        node.set(p.name, value, None);
    }
    let node = d.add(node);
    stage(&mut d, family, model.kind, node);
    said(&d, &Options::default())
}

/// A scene around a node.
fn stage(d: &mut SceneDesc, family: Family, kind: &str, node: NodeId) {
    let of = |family, kind| Node::new(family, kind, None);
    let sphere = d.add(of(Family::Shape, "sphere"));
    let mut shape = Shape::new(sphere);
    let mut camera = None;
    match family {
        Family::Texture => shape.material = Some(d.add(of(Family::Material, "diffuse").with("reflectance", node))),
        Family::Light if emits_from_shapes(kind) => shape.emission = Some(node),
        Family::Light => d.lights.push(node),
        Family::Medium | Family::Phase => {
            let medium = if family == Family::Medium {
                node
            } else {
                d.add(of(Family::Medium, "homogeneous").with("sigma_s", 1.0).with("phase", node))
            };
            shape.material = Some(d.add(of(Family::Material, "interface")));
            (shape.interior, shape.is_medium_boundary) = (Some(medium), true);
        }
        Family::Camera => camera = Some(node),
        Family::Film => d.film = Some(node),
        Family::Filter => d.filter = Some(node),
        Family::Sampler => d.sampler = Some(node),
        Family::Integrator => d.integrator = Some(node),
        Family::Shape => {
            shape = Shape::new(node);
            if ["mesh", "loop_subdivision"].contains(&kind) {
                let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
                shape.mesh = Some(d.add_mesh(Mesh { positions, triangles: vec![[0, 1, 2]].into(), ..Mesh::default() }));
            }
        }
        Family::Material | Family::Accelerator => panic!("{family:?}"),
    }
    d.shapes.push(shape);
    let camera = camera.unwrap_or_else(|| d.add(of(Family::Camera, "perspective")));
    d.cameras.push(camera);
    let light = d.add(of(Family::Light, "point"));
    d.lights.push(light);
}

fn models() -> impl Iterator<Item = (Family, &'static Model)> {
    FAMILIES.into_iter().flat_map(|family| family.models().iter().map(move |m| (family, m)))
}

/// Nothing is said of any kind as it is.
#[test]
fn every_kind_is_known() {
    let files = files();
    for (family, model) in models() {
        let said = messages(family, model, files.path(), None);
        assert!(said.is_empty(), "{} '{}': {said:?}", family.noun(), model.kind);
    }
}

/// Every default that a kind reads is in the schema, whichever word a parameter has.
#[test]
fn every_default_is_in_the_schema() {
    let files = files();
    for (family, model) in models() {
        for p in model.all() {
            for word in p.words() {
                messages(family, model, files.path(), Some((p, word.into())));
            }
        }
    }
}

/// Parameters named by the tables are those that the compiler reads: a value that nothing can use is noticed.
#[test]
fn every_parameter_of_other_families_is_read() {
    let files = files();
    for (family, model) in models() {
        for p in model.all() {
            let said = messages(family, model, files.path(), Some((p, nonsense(family, model.kind, p))));
            let quoted = format!("'{}'", p.name);
            let is_told = said.iter().any(|m| m.contains(&quoted) || (p.name.len() > 3 && m.contains(p.name)));
            let at = format!("{} '{}': {}", family.noun(), model.kind, p.name);
            assert_eq!(is_told, !is_unread(family, model.kind, p.name), "{at}: {said:?}");
        }
    }
}

/// Numbers outside their range are reported, with the parameter's name or the number.
#[test]
fn ranges_of_other_families_are_checked() {
    let files = files();
    for (family, model) in models() {
        for p in model.all().filter(|p| p.kind.is_numeric()) {
            for (bound, outside) in [(p.range.0, p.range.0 - 1.0), (p.range.1, p.range.1 + 6.0)] {
                if bound.is_finite() {
                    let said = messages(family, model, files.path(), Some((p, Value::Float(outside))));
                    let is_told = said.iter().any(|m| m.contains(p.name) || m.contains(&outside.to_string()));
                    let at = format!("{} '{}': {} = {outside}", family.noun(), model.kind, p.name);
                    assert!(is_told, "{at}: {said:?}");
                }
            }
        }
    }
}

/// Names that a kind does not have are told with the nearest that it has.
#[test]
fn misspelt_names_of_other_families_are_told() {
    for (family, model) in models() {
        for p in model.parameters.iter().filter(|p| p.name.len() > 4) {
            let (first, rest) = p.name.split_at(1);
            let misspelt = format!("{first}{first}{rest}");
            let mut d = SceneDesc::default();
            let node = d.add(Node::new(family, model.kind, None).with(misspelt.as_str(), 1.0));
            stage(&mut d, family, model.kind, node);
            let said = compile(&d, &Options::default()).diagnostics;
            let is_told =
                |m: &String| m.contains(&format!("no parameter '{misspelt}'")) && m.contains(&format!("'{}'?", p.name));
            assert!(said.iter().map(ToString::to_string).any(|m| is_told(&m)), "{}: {misspelt}", model.kind);
        }
    }
}

//! A single material, from words: the scene in which instruments look at it and pictures of it are taken.

use steradian_math::DVec3;
use steradian_scene::{
    ColorSpace, Family, Format, Mesh, Node, NodeId, SceneDesc, Shape, SpectrumValue, Transform, Value, names,
};
use steradian_schema::{Kinds, Parameter, Type};

/// Deepest nesting of materials in a parameter.
const MAX_DEPTH: usize = 8;

/// The scene of a material of a kind with parameters as text: a ball (the first shape) on a tiled floor in a studio of
/// three lamps under a dim sky.
///
/// Numbers are written `0.5`, colours `0.8,0.2,0.1`, spectra by name (`metal-Au-eta`), pictures and measured data as
/// file names, materials as `KIND` or `KIND(name=value;name=value)`, lists of them separated by `|`.
///
/// # Errors
/// A message where a name is unknown or a value is not what the parameter takes.
pub fn describe(kind: &str, params: &[(String, String)]) -> Result<SceneDesc, String> {
    describe_of(&Kinds::default(), kind, params)
}

/// [`describe`] where a program has materials of its own.
///
/// # Errors
/// As [`describe`].
pub fn describe_of(kinds: &Kinds, kind: &str, params: &[(String, String)]) -> Result<SceneDesc, String> {
    let mut d = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let material = add_material(&mut d, kinds, kind, params, 0)?;
    let ball = d.add(Node::new(Family::Shape, "sphere", None).with("radius", 1.0).with("center", [0.0, 1.0, 0.0]));
    place(&mut d, ball, Some(material), None);
    furnish(&mut d);
    Ok(d)
}

/// The geometry of a scene, all of it made of a material of a kind with parameters as text, under an even sky: what
/// [`crate::instruments::goniometer::geometry`] looks at.
///
/// # Errors
/// As [`describe`].
pub fn cover(mut d: SceneDesc, kind: &str, params: &[(String, String)]) -> Result<SceneDesc, String> {
    let material = add_material(&mut d, &Kinds::default(), kind, params, 0)?;
    for s in &mut d.shapes {
        (s.material, s.emission, s.interior, s.exterior) = (Some(material), None, None, None);
    }
    let sky = d.add(Node::new(Family::Light, "environment", None));
    d.lights = vec![sky];
    if d.cameras.is_empty() {
        let camera = d.add(Node::new(Family::Camera, "perspective", None));
        d.cameras.push(camera);
    }
    Ok(d)
}

/// One mesh in its own coordinates, without a material.
pub fn bare(mesh: Mesh) -> SceneDesc {
    let mut d = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let mesh = d.add_mesh(mesh);
    let node = d.add(Node::new(Family::Shape, "mesh", None));
    place(&mut d, node, None, None);
    d.shapes[0].mesh = Some(mesh);
    d
}

fn add_material(
    d: &mut SceneDesc,
    kinds: &Kinds,
    kind: &str,
    params: &[(String, String)],
    depth: usize,
) -> Result<NodeId, String> {
    if depth > MAX_DEPTH {
        return Err(format!("materials are nested more than {MAX_DEPTH} deep"));
    }
    let unknown = |what: &str, name: &str, known: Vec<&str>| {
        let hint = names::did_you_mean(name, known.iter().copied()).map(|h| format!("; {h}")).unwrap_or_default();
        format!("there is no {what} '{name}'{hint} (known: {})", known.join(", "))
    };
    let model = kinds
        .model(Family::Material, kind)
        .ok_or_else(|| unknown("material", kind, kinds.names(Family::Material).collect()))?;
    let mut node = Node::new(Family::Material, kind, None);
    for (name, text) in params {
        let parameter = model
            .parameter(name)
            .ok_or_else(|| unknown(&format!("parameter of '{kind}'"), name, model.all().map(|p| p.name).collect()))?;
        let value = value(d, kinds, parameter, text, depth)?;
        node.set(name.as_str(), value, None);
    }
    node.name = Some(kind.into());
    Ok(d.add(node))
}

fn value(d: &mut SceneDesc, kinds: &Kinds, p: &Parameter, text: &str, depth: usize) -> Result<Value, String> {
    let fault = || format!("'{text}' is no value of '{}', which is {}", p.name, p.values());
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    Ok(match p.kind {
        Type::Number => Value::Float(number(text).ok_or_else(fault)?),
        Type::Integer => Value::Int(text.parse().map_err(|_| fault())?),
        Type::List => {
            let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
            Value::Floats(numbers.ok_or_else(fault)?)
        }
        Type::Flag => Value::Bool(text.parse().map_err(|_| fault())?),
        Type::Word(_) => Value::String(text.into()),
        Type::File => Value::Path(text.into()),
        Type::Vector => {
            let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
            Value::Vec3(numbers.and_then(|v| v.try_into().ok()).ok_or_else(fault)?)
        }
        Type::Texture | Type::Scalar | Type::Spectrum => {
            let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
            match numbers.as_deref() {
                Some([v]) => Value::Float(*v),
                Some([r, g, b]) => Value::Spectrum(SpectrumValue::Rgb([*r, *g, *b], ColorSpace::Srgb)),
                Some(_) => return Err(fault()),
                None if p.kind != Type::Spectrum && std::path::Path::new(text).is_file() => {
                    let image = Node::new(Family::Texture, "image", None).with("file", Value::Path(text.into()));
                    Value::Node(d.add(image))
                }
                None => Value::Spectrum(SpectrumValue::Named(text.into())),
            }
        }
        Type::Map => {
            let image = Node::new(Family::Texture, "image", None).with("file", Value::Path(text.into()));
            Value::Node(d.add(image.with("encoding", "linear").with("raw", true)))
        }
        Type::Text => Value::String(text.into()),
        // No material has any of these.
        Type::Medium
        | Type::Phase
        | Type::Transform
        | Type::WordOrNumber(_)
        | Type::Integers
        | Type::Maps
        | Type::NumberOrList
        | Type::ScalarOrList
        | Type::SpectrumOrList => return Err(fault()),
        Type::Material => Value::Node(nested(d, kinds, text, depth)?),
        Type::Materials => {
            let parts: Result<Vec<_>, _> = text.split('|').map(|part| nested(d, kinds, part, depth)).collect();
            Value::Nodes(parts?)
        }
    })
}

/// `KIND` or `KIND(name=value;…)`.
fn nested(d: &mut SceneDesc, kinds: &Kinds, text: &str, depth: usize) -> Result<NodeId, String> {
    let text = text.trim();
    let Some((kind, rest)) = text.split_once('(') else { return add_material(d, kinds, text, &[], depth + 1) };
    let inside = rest.strip_suffix(')').ok_or_else(|| format!("'{text}' lacks its closing parenthesis"))?;
    let mut params = Vec::new();
    for part in inside.split(';').filter(|p| !p.trim().is_empty()) {
        let (name, value) = part.split_once('=').ok_or_else(|| format!("'{part}' is not name=value"))?;
        params.push((name.trim().to_owned(), value.trim().to_owned()));
    }
    add_material(d, kinds, kind, &params, depth + 1)
}

fn place(d: &mut SceneDesc, node: NodeId, material: Option<NodeId>, emission: Option<NodeId>) {
    d.shapes.push(Shape { material, emission, ..Shape::new(node) });
}

/// The lamps: corners, and radiance. A large one from the left and behind the viewer, a cool strip on the right, one
/// behind the ball.
const LAMPS: [([[f32; 3]; 4], [f64; 3]); 3] = [
    ([[-3.4, 1.6, -2.6], [-2.2, 4.4, -3.0], [-2.2, 4.4, -0.6], [-3.4, 1.6, -0.2]], [11.0, 10.0, 8.6]),
    ([[3.4, 3.4, -2.0], [3.4, 0.4, -2.0], [3.6, 0.4, -1.4], [3.6, 3.4, -1.4]], [5.5, 6.4, 8.0]),
    ([[-1.6, 4.6, 2.2], [1.6, 4.6, 2.2], [1.6, 5.2, 1.2], [-1.6, 5.2, 1.2]], [6.0, 6.0, 6.4]),
];

/// Floor, lamps, sky and camera.
fn furnish(d: &mut SceneDesc) {
    let color = |rgb: [f64; 3]| Value::Spectrum(SpectrumValue::Rgb(rgb, ColorSpace::Srgb));
    let tiles = Node::new(Family::Texture, "checkerboard", None);
    let tiles = tiles.with("a", color([0.42, 0.41, 0.39])).with("b", color([0.16, 0.16, 0.17]));
    let tiles = d.add(tiles.with("scale_u", 24.0).with("scale_v", 24.0));
    let floor = d.add(Node::new(Family::Material, "diffuse", None).with("reflectance", Value::Node(tiles)));
    quad(d, [[-12.0, 0.0, -12.0], [-12.0, 0.0, 12.0], [12.0, 0.0, 12.0], [12.0, 0.0, -12.0]], Some(floor), None);
    let black = d.add(Node::new(Family::Material, "diffuse", None).with("reflectance", 0.0));
    for (corners, radiance) in LAMPS {
        let lamp = Node::new(Family::Light, "area", None).with("radiance", color(radiance)).with("two_sided", true);
        let lamp = d.add(lamp);
        quad(d, corners, Some(black), Some(lamp));
    }
    let sky = d.add(Node::new(Family::Light, "environment", None).with("radiance", color([0.20, 0.24, 0.30])));
    d.lights.push(sky);
    let (from, to) = (DVec3::new(0.0, 2.1, -5.2), DVec3::new(0.0, 0.92, 0.0));
    let view = Transform::look_at(from, to, DVec3::Y).unwrap_or_default();
    let camera =
        Node::new(Family::Camera, "perspective", None).with("fov", 27.0).with("to_world", Value::Transform(view));
    let camera = d.add(camera);
    d.cameras.push(camera);
}

fn quad(d: &mut SceneDesc, corners: [[f32; 3]; 4], material: Option<NodeId>, emission: Option<NodeId>) {
    let mesh = d.add_mesh(Mesh {
        positions: corners.to_vec(),
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Mesh::default()
    });
    let node = d.add(Node::new(Family::Shape, "mesh", None));
    place(d, node, material, emission);
    if let Some(shape) = d.shapes.last_mut() {
        shape.mesh = Some(mesh);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CompileOptions, compile};

    fn params(list: &[(&str, &str)]) -> Vec<(String, String)> {
        list.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
    }

    #[test]
    fn words_become_a_scene_with_the_material_on_its_first_shape() {
        let gold = params(&[("eta", "metal-Au-eta"), ("k", "metal-Au-k"), ("alpha_u", "0.2")]);
        let d = describe("conductor", &gold).expect("sound");
        let scene = compile(&d, &CompileOptions::default()).scene.expect("it compiles");
        assert_eq!(scene.material_names()[scene.geometries()[0].material as usize], "conductor");
        let mixed = params(&[("materials", "diffuse(reflectance=0.8,0.1,0.1)|conductor(alpha_u=0.1;alpha_v=0.3)")]);
        let d = describe("mix", &mixed).expect("sound");
        assert!(compile(&d, &CompileOptions::default()).scene.is_some());
    }

    #[test]
    fn geometry_is_covered_and_nothing_else_is_left() {
        let triangle = Mesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]].into(),
            ..Mesh::default()
        };
        let d = cover(bare(triangle), "diffuse", &params(&[("reflectance", "0.3")])).expect("sound");
        let scene = compile(&d, &CompileOptions::default()).scene.expect("it compiles");
        assert_eq!((scene.geometries().len(), d.lights.len()), (1, 1));
        assert_eq!(scene.material_names()[scene.geometries()[0].material as usize], "diffuse");
    }

    #[test]
    fn slips_are_named() {
        let fails = |kind: &str, list: &[(&str, &str)], part: &str| {
            let said = describe(kind, &params(list)).err().unwrap_or_default();
            assert!(said.contains(part), "{said:?} lacks {part:?}");
        };
        fails("difuse", &[], "did you mean 'diffuse'?");
        fails("diffuse", &[("reflectence", "1")], "did you mean 'reflectance'?");
        fails("diffuse", &[("reflectance", "1,2")], "is no value of 'reflectance'");
        fails("coated_diffuse", &[("max_depth", "deep")], "is no value of 'max_depth'");
        fails("two_sided", &[("front", "diffuse(reflectance=1")], "closing parenthesis");
        let deep = "two_sided(front=".repeat(20);
        fails("two_sided", &[("front", &format!("{deep}diffuse{}", ")".repeat(20)))], "nested more than");
    }
}

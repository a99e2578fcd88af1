//! Test cards: an orientation card under every wrap, transform and projector, and tangent frames, against what must be
//! seen. The gallery (`examples/texture_gallery.rs`) has the same as pictures.

#![expect(clippy::type_complexity, reason = "tables of cases are lists of tuples")]

use super::one_shape;
use std::path::PathBuf;
use steradian_compile::{Options, compile};
use steradian_core::{Scene, material::Model};
use steradian_image::{Image, Precision, WriteOptions, write};
use steradian_math::{
    DVec3, Ray, Transform, Vec2, Vec3,
    spectra::{Wavelengths, role::Role},
};
use steradian_scene::{Family, Mesh, Node, NodeId, SceneDesc, Value};
use steradian_texture::{SpectrumTexture, TextureContext, card};

const LAMBDA: Wavelengths = Wavelengths::RGB;

/// The card as a file of this test's own.
struct Card(PathBuf);

impl Card {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("steradian-card-{name}-{}.exr", std::process::id()));
        let n = 64;
        let at = |i: usize| (i as f32 + 0.5) / n as f32;
        let pixels: Vec<[f32; 3]> =
            (0..n).flat_map(|y| (0..n).map(move |x| card::orientation(Vec2::new(at(x), at(y))).to_array())).collect();
        let image = Image::from_rgb(n, n, &pixels).unwrap();
        write(&path, &image, &WriteOptions { exr_precision: Precision::Float, ..WriteOptions::default() }).unwrap();
        Self(path)
    }

    fn node(&self) -> Node {
        Node::new(Family::Texture, "image", None).with("file", self.0.as_path().to_path_buf()).with("filter", "nearest")
    }
}

impl Drop for Card {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn quad(uvs: [[f32; 2]; 4]) -> Mesh {
    Mesh {
        positions: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]],
        uvs: uvs.to_vec(),
        triangles: vec![[0, 1, 3], [0, 3, 2]].into(),
        ..Mesh::default()
    }
}

const UNIT: [[f32; 2]; 4] = [[0., 0.], [1., 0.], [0., 1.], [1., 1.]];

fn scene(texture: Node, mesh: Mesh, wrap: impl FnOnce(&mut Node, &mut SceneDesc, NodeId)) -> Scene {
    let mut desc = SceneDesc::default();
    let texture = desc.add(texture);
    let mut material = Node::new(Family::Material, "diffuse", None);
    wrap(&mut material, &mut desc, texture);
    one_shape::add(&mut desc, Node::new(Family::Shape, "mesh", None), Some(mesh), Some(material));
    one_shape::compiled(&desc).unwrap_or_else(|said| panic!("{said:?}"))
}

fn textured(texture: Node, mesh: Mesh) -> Scene {
    scene(texture, mesh, |m, _, t| {
        m.set("reflectance", t, None);
    })
}

/// The colour of the surface below (x, y, 1).
fn seen(scene: &Scene, x: f32, y: f32) -> Vec3 {
    let ray = Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z);
    let hit = scene.intersect(&ray).expect("a surface");
    let at: TextureContext = scene.texture_context(&scene.interaction(&ray, &hit));
    let Model::Diffuse(SpectrumTexture::Texture(id, _)) = &scene.materials()[1].model else { panic!("no texture") };
    Vec3::from(scene.textures().spectrum(*id, &at, Role::Albedo, &LAMBDA).to_rgb())
}

/// The card's value in the middle of the texel that holds (x right, y down).
fn shows(x: f32, y: f32) -> Vec3 {
    card::orientation(((Vec2::new(x, y) * 64.0).floor() + 0.5) / 64.0)
}

/// Places of the card that tell its symmetries apart, away from texels' edges.
const PLACES: [(f32, f32); 6] = [(0.05, 0.04), (0.76, 0.06), (0.07, 0.71), (0.9, 0.87), (0.33, 0.58), (0.61, 0.12)];

/// Holds a scene against the card at (x, y) of the unit square; `to` gives where on the card it must be (x right, y
/// down).
fn holds(name: &str, scene: &Scene, to: impl Fn(f32, f32) -> Option<(f32, f32)>) {
    for (x, y) in PLACES {
        let expected = to(x, y).map_or(Vec3::ZERO, |(x, y)| shows(x, y));
        assert!((seen(scene, x, y) - expected).length() < 1e-6, "{name} at {x} {y}: {} {expected}", seen(scene, x, y));
    }
}

fn set(node: Node, values: &[(&str, Value)]) -> Node {
    values.iter().fold(node, |n, (k, v)| n.with(*k, v.clone()))
}

#[test]
fn origins_flips_and_transforms() {
    let card = Card::new("transforms");
    let affine = |t: Transform| Value::Transform(t);
    let pair = |a: f64, b: f64| Value::Floats(vec![a, b]);
    let turn = Transform::rotate(DVec3::Z, 90.0_f64.to_radians());
    let cases: &[(&str, &[(&str, Value)], fn(f32, f32) -> (f32, f32))] = &[
        ("bottom origin: v up", &[], |x, y| (x, 1.0 - y)),
        ("top origin: v down", &[("origin", "top".into())], |x, y| (x, y)),
        ("mirrored u", &[("scale_u", (-1.0).into()), ("delta_u", 1.0.into())], |x, y| (1.0 - x, 1.0 - y)),
        ("moved", &[("delta_u", 0.25.into())], |x, y| ((x + 0.25).fract(), 1.0 - y)),
        ("matrix", &[("origin", "top".into()), ("to_uv", affine(turn))], |x, y| (1.0 - y, x)),
        ("glTF rotation", &[("origin", "top".into()), ("khr_rotation", 90.0.into())], |x, y| (y, 1.0 - x)),
        (
            "glTF scale and offset",
            &[("origin", "top".into()), ("khr_scale", pair(0.5, 0.25)), ("khr_offset", pair(0.5, 0.25))],
            |x, y| (0.5 * x + 0.5, 0.25 * y + 0.25),
        ),
    ];
    for (name, values, to) in cases {
        holds(name, &textured(set(card.node(), values), quad(UNIT)), |x, y| Some(to(x, y)));
    }
}

#[test]
fn wraps() {
    let card = Card::new("wraps");
    // Coordinates from −1 to 2: the card in the middle of nine.
    let wide = UNIT.map(|uv| uv.map(|v| 3.0 * v - 1.0));
    let mirror = |v: f32| {
        let k = v.rem_euclid(2.0);
        if k < 1.0 { k } else { 2.0 - k }
    };
    let edge = |v: f32| v.clamp(0.0, 0.9999);
    // An edge that was crossed turns the other coordinate round.
    let turned = |v: f32, other: f32| if (0.0..1.0).contains(&other) { mirror(v) } else { 1.0 - mirror(v) };
    let cases: [(&str, &dyn Fn(f32, f32) -> Option<(f32, f32)>); 5] = [
        ("repeat", &|u, v| Some((u.rem_euclid(1.0), v.rem_euclid(1.0)))),
        ("mirror", &|u, v| Some((mirror(u), mirror(v)))),
        ("clamp", &|u, v| Some((edge(u), edge(v)))),
        ("octahedral", &|u, v| Some((turned(u, v), turned(v, u)))),
        ("black", &|u, v| ((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v)).then_some((u, v))),
    ];
    for (name, to) in cases {
        let node = card.node().with("origin", "top").with("wrap_u", name).with("wrap_v", name);
        holds(name, &textured(node, quad(wide)), |x, y| to(3.0 * x - 1.0, 3.0 * y - 1.0));
    }
    // Borders of other colours.
    for (name, border) in [("one", Vec3::ONE), ("border", Vec3::new(0.25, 0.5, 0.75))] {
        let node = card.node().with("origin", "top").with("wrap_u", name).with("wrap_v", name);
        let scene = textured(node.with("border", border.as_dvec3().to_array()), quad(wide));
        assert_eq!((seen(&scene, 0.05, 0.5), seen(&scene, 0.5, 0.9)), (border, border));
        assert!((seen(&scene, 0.45, 0.4) - shows(0.35, 0.2)).length() < 1e-6);
    }
    // Each axis has its own.
    let node = card.node().with("origin", "top").with("wrap_u", "clamp").with("wrap_v", "mirror");
    holds("clamp, mirror", &textured(node, quad(wide)), |x, y| Some((edge(3.0 * x - 1.0), mirror(3.0 * y - 1.0))));
}

#[test]
fn projectors_and_sets() {
    let card = Card::new("projectors");
    let node = || card.node().with("origin", "top");
    let planar = node().with("mapping", "planar").with("v1", [0.0, 1.0, 0.0]).with("v2", [1.0, 0.0, 0.0]);
    holds("planar", &textured(planar, quad(UNIT)), |x, y| Some((y, x)));
    let corners = Value::Floats(vec![0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let to = Value::Floats(vec![1., 0., 0., 0., 1., 1.]);
    let triangle = node().with("mapping", "triangle").with("corners", corners).with("corner_uvs", to);
    holds("triangle", &textured(triangle, quad(UNIT)), |x, y| Some((1.0 - x, y)));
    // The square seen as the top of a cube of twice its size.
    let cube =
        node().with("mapping", "cube").with("texture_from_world", Transform::translate(DVec3::new(-0.5, -0.5, 0.5)));
    holds("cube", &textured(cube, quad(UNIT)), |x, y| Some((x, y)));
    let mut mesh = quad(UNIT);
    let data = vec![1., 1., 0., 1., 1., 0., 0., 0.];
    let domain = steradian_scene::Domain::Vertex;
    mesh.attributes = vec![steradian_scene::Attribute { name: "second".into(), domain, channels: 2, data }];
    holds("second set", &textured(node().with("uv_set", "second"), mesh), |x, y| Some((1.0 - x, 1.0 - y)));
}

#[test]
fn tangent_frames() {
    // A map that leans to red everywhere, on squares whose coordinates are turned and mirrored.
    let lean = |uvs: [[f32; 2]; 4], normal: [f64; 3]| {
        let color = Value::Floats(normal.map(|v| (v + 1.0) * 0.5).to_vec().repeat(2));
        let ramp = Node::new(Family::Texture, "ramp", None).with("colors", color).with("input", 0.5);
        let scene = scene(ramp, quad(uvs), |m, _, t| {
            m.set("normal_map", t, None);
        });
        let ray = Ray::new(Vec3::new(0.3, 0.4, 1.0), -Vec3::Z);
        let i = scene.interaction(&ray, &scene.intersect(&ray).expect("a surface"));
        let (_, frame) = scene.scattering(&i, 0.5, &mut LAMBDA.clone()).expect("it scatters");
        frame.z
    };
    let (red, green) = ([0.6, 0.0, 0.8], [0.0, 0.6, 0.8]);
    let close = |a: Vec3, x: f32, y: f32| assert!((a - Vec3::new(x, y, 0.8)).length() < 1e-5, "{a} {x} {y}");
    close(lean(UNIT, red), 0.6, 0.0);
    close(lean(UNIT, green), 0.0, 0.6);
    // u along +y, v along −x.
    let turned = [[0., 1.], [0., 0.], [1., 1.], [1., 0.]];
    close(lean(turned, red), 0.0, 0.6);
    close(lean(turned, green), -0.6, 0.0);
    // v runs down: green leans down.
    let mirrored = UNIT.map(|[u, v]| [u, 1.0 - v]);
    close(lean(mirrored, red), 0.6, 0.0);
    close(lean(mirrored, green), 0.0, -0.6);
}

#[test]
fn meshes_are_displaced_by_their_textures() {
    // Heights of a ramp along u: the square becomes a slope, and its normals lean back.
    let mut desc = SceneDesc::default();
    let ramp = desc.add(Node::new(Family::Texture, "gradient", None));
    let shape = Node::new(Family::Shape, "mesh", None).with("displacement", ramp).with("displacement_scale", 0.75);
    let node = one_shape::add(&mut desc, shape.with("edge_length", 0.1), Some(quad(UNIT)), None);
    let scene = compile(&desc, &Options::default()).scene.expect("a scene");
    for (x, y) in PLACES {
        let ray = Ray::new(Vec3::new(x, y, 2.0), -Vec3::Z);
        let hit = scene.intersect(&ray).expect("the slope");
        let s = scene.interaction(&ray, &hit).surface;
        assert!((s.p.z - 0.75 * x).abs() < 1e-5 && (s.n - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-4, "{s:?}");
    }
    let fine = |n: f64| {
        let mut desc = desc.clone();
        desc.node_mut(node).set("edge_length", n, None);
        compile(&desc, &Options::default())
    };
    assert!(fine(1e-5).diagnostics.iter().any(|d| d.message.contains("triangles")));
}

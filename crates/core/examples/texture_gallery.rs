//! Makes the pictures of `docs/textures-gallery.md`: `cargo run -p steradian-core --example texture_gallery -- [FOLDER [NAME…]]`.
//! Without names it makes all of them, and the page.

use std::{
    f32::consts::TAU,
    fmt::Write as _,
    path::{Path, PathBuf},
};
use steradian_core::{
    Scene,
    compile::{Options, compile},
    relief::{
        HeightField,
        field::Line,
        parallax,
        search::{self, ConeMap, DistanceField},
    },
    texture::card,
};
use steradian_image::{Image, WriteOptions, write};
use steradian_math::{DVec3, Ray, Transform, Vec2, Vec3, spectra::Wavelengths};
use steradian_scene::{ColorSpace, Family, Mesh, Node, SceneDesc, Shape, SpectrumValue, Value};

/// Pixels along a side of a tile.
const SIZE: usize = 120;
/// Samples along a side of a pixel.
const GRID: usize = 4;

type Params = &'static [(&'static str, P)];

/// A parameter of a texture.
#[derive(Clone, Copy)]
enum P {
    N(f64),
    I(i64),
    S(&'static str),
    C(f64, f64, f64),
    L(&'static [f64]),
    V([f64; 3]),
    /// Another texture.
    T(&'static str, Params),
}

use P::{C, I, L, N, S, T, V};

/// What is seen.
enum Tile {
    /// A texture over [0, 4]², flat.
    Flat(&'static str, Params),
    /// The orientation card on a unit sphere, by a mapping.
    Sphere(Params),
    /// The card over [−1, 2]².
    Wrapped(Params),
    /// A wrapper of the material (name, texture) on a lit plane.
    Detail(&'static str, &'static str, Params),
    /// A displaced sphere, with the edges' length.
    Displaced(&'static str, Params),
    /// A relief, by a search.
    Relief(fn(&Relief, &Line, Vec2) -> Option<Vec2>),
}

struct Relief {
    field: HeightField,
    cones: ConeMap,
    relaxed: ConeMap,
    distances: DistanceField,
}

const BRICK: Params =
    &[("a", C(0.6, 0.57, 0.5)), ("b", C(0.45, 0.12, 0.07)), ("width", N(1.0)), ("height", N(0.5)), ("mortar", N(0.08))];
const BUMPS: Params = &[("frequency", N(3.0)), ("gain", N(0.12)), ("octaves", I(4))];

const TILES: &[(&str, &str, Tile)] = &[
    ("checkerboard", "Patterns", Tile::Flat("checkerboard", &[])),
    ("checkerboard3", "Patterns", Tile::Flat("checkerboard", &[("dimension", I(3))])),
    (
        "tiles",
        "Patterns",
        Tile::Flat("tiles", &[("a", C(0.3, 0.3, 0.3)), ("b", C(0.3, 0.55, 0.7)), ("mortar", N(0.06))]),
    ),
    ("bricks", "Patterns", Tile::Flat("bricks", BRICK)),
    ("brick_shade", "Patterns", Tile::Flat("brick_shade", &[("height", N(0.5)), ("mortar", N(0.0))])),
    ("dots", "Patterns", Tile::Flat("dots", &[("a", C(0.8, 0.8, 0.7)), ("b", C(0.6, 0.1, 0.1))])),
    ("stripes", "Patterns", Tile::Flat("stripes", &[("duty", N(0.3))])),
    ("gradient_u", "Patterns", Tile::Flat("gradient", &[("scale_u", N(0.25))])),
    (
        "gradient_radial",
        "Patterns",
        Tile::Flat("gradient", &[("type", S("radial")), ("scale_u", N(0.25)), ("scale_v", N(0.25))]),
    ),
    (
        "gradient_angular",
        "Patterns",
        Tile::Flat("gradient", &[("type", S("angular")), ("scale_u", N(0.25)), ("scale_v", N(0.25))]),
    ),
    (
        "bilerp",
        "Patterns",
        Tile::Flat(
            "bilerp",
            &[
                ("v00", C(0.8, 0.1, 0.1)),
                ("v10", C(0.1, 0.8, 0.1)),
                ("v01", C(0.1, 0.1, 0.8)),
                ("v11", C(0.8, 0.8, 0.1)),
                ("scale_u", N(0.25)),
                ("scale_v", N(0.25)),
            ],
        ),
    ),
    (
        "noise_value",
        "Noise",
        Tile::Flat("noise", &[("basis", S("value")), ("frequency", N(3.0)), ("gain", N(0.5)), ("offset", N(0.5))]),
    ),
    ("noise_gradient", "Noise", Tile::Flat("noise", &[("frequency", N(3.0)), ("gain", N(0.5)), ("offset", N(0.5))])),
    ("fbm", "Noise", Tile::Flat("fbm", &[("frequency", N(2.0)), ("gain", N(0.5)), ("offset", N(0.5))])),
    ("wrinkled", "Noise", Tile::Flat("wrinkled", &[("frequency", N(2.0))])),
    ("ridged", "Noise", Tile::Flat("ridged", &[("frequency", N(2.0))])),
    ("windy", "Noise", Tile::Flat("windy", &[("frequency", N(4.0)), ("gain", N(2.0)), ("offset", N(0.5))])),
    ("worley_f1", "Noise", Tile::Flat("worley", &[("frequency", N(2.0)), ("dimension", I(2))])),
    (
        "worley_f2",
        "Noise",
        Tile::Flat("worley", &[("feature", S("f2")), ("frequency", N(2.0)), ("dimension", I(2)), ("gain", N(0.7))]),
    ),
    (
        "worley_border",
        "Noise",
        Tile::Flat("worley", &[("feature", S("border")), ("frequency", N(2.0)), ("dimension", I(2)), ("gain", N(2.0))]),
    ),
    (
        "worley_manhattan",
        "Noise",
        Tile::Flat("worley", &[("metric", S("manhattan")), ("frequency", N(2.0)), ("dimension", I(2))]),
    ),
    ("voronoi", "Noise", Tile::Flat("voronoi", &[("frequency", N(2.0)), ("dimension", I(2))])),
    (
        "wood",
        "Noise",
        Tile::Flat(
            "wood",
            &[("frequency", N(2.0)), ("grain", N(0.3)), ("a", C(0.32, 0.16, 0.06)), ("b", C(0.58, 0.36, 0.18))],
        ),
    ),
    ("marble", "Noise", Tile::Flat("marble", &[("scale", N(4.0)), ("variation", N(3.0))])),
    (
        "scale",
        "Combinators",
        Tile::Flat(
            "scale",
            &[("texture", T("bricks", BRICK)), ("scale", T("fbm", &[("gain", N(0.5)), ("offset", N(0.7))]))],
        ),
    ),
    (
        "add",
        "Combinators",
        Tile::Flat(
            "add",
            &[
                ("a", T("stripes", &[("a", C(0.0, 0.0, 0.0)), ("b", C(0.5, 0.0, 0.0))])),
                ("b", T("dots", &[("a", C(0.0, 0.0, 0.0)), ("b", C(0.0, 0.4, 0.5))])),
            ],
        ),
    ),
    (
        "mix",
        "Combinators",
        Tile::Flat(
            "mix",
            &[
                ("a", T("bricks", BRICK)),
                ("b", T("checkerboard", &[])),
                ("amount", T("gradient", &[("scale_u", N(0.25))])),
            ],
        ),
    ),
    (
        "ramp",
        "Combinators",
        Tile::Flat(
            "ramp",
            &[
                ("input", T("fbm", &[("gain", N(0.7)), ("offset", N(0.5)), ("frequency", N(2.0))])),
                ("colors", L(&[0.02, 0.05, 0.3, 0.1, 0.3, 0.6, 0.7, 0.65, 0.4, 0.15, 0.4, 0.1, 0.9, 0.9, 0.9])),
            ],
        ),
    ),
    (
        "curve",
        "Combinators",
        Tile::Flat(
            "curve",
            &[
                ("input", T("gradient", &[("scale_u", N(0.25))])),
                ("values", L(&[0.0, 0.8, 0.2, 1.0])),
                ("interpolation", S("catmull_rom")),
            ],
        ),
    ),
    ("channel", "Combinators", Tile::Flat("channel", &[("input", T("bricks", BRICK)), ("channel", S("r"))])),
    (
        "color_space",
        "Combinators",
        Tile::Flat(
            "color_space",
            &[("input", T("bricks", BRICK)), ("matrix", L(&[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]))],
        ),
    ),
    ("hsv", "Combinators", Tile::Flat("hsv", &[("input", T("bricks", BRICK)), ("hue", N(120.0))])),
    ("wrap_repeat", "Mapping", Tile::Wrapped(&[("wrap_u", S("repeat")), ("wrap_v", S("repeat"))])),
    ("wrap_mirror", "Mapping", Tile::Wrapped(&[("wrap_u", S("mirror")), ("wrap_v", S("mirror"))])),
    ("wrap_clamp", "Mapping", Tile::Wrapped(&[("wrap_u", S("clamp")), ("wrap_v", S("clamp"))])),
    ("wrap_black", "Mapping", Tile::Wrapped(&[("wrap_u", S("black")), ("wrap_v", S("black"))])),
    ("khr_transform", "Mapping", Tile::Wrapped(&[("khr_rotation", N(30.0)), ("khr_scale", L(&[0.7, 0.7]))])),
    ("uv", "Mapping", Tile::Sphere(&[("mapping", S("uv"))])),
    (
        "planar",
        "Mapping",
        Tile::Sphere(&[
            ("mapping", S("planar")),
            ("v1", V([0.5, 0.0, 0.0])),
            ("v2", V([0.0, 0.0, 0.5])),
            ("delta_u", N(0.5)),
            ("delta_v", N(0.5)),
        ]),
    ),
    ("spherical", "Mapping", Tile::Sphere(&[("mapping", S("spherical"))])),
    (
        "cylindrical",
        "Mapping",
        Tile::Sphere(&[("mapping", S("cylindrical")), ("scale_v", N(0.5)), ("delta_v", N(0.5))]),
    ),
    ("cube", "Mapping", Tile::Sphere(&[("mapping", S("cube"))])),
    ("reflection", "Mapping", Tile::Sphere(&[("mapping", S("two_part")), ("object_map", S("reflection"))])),
    (
        "normal_cylinder",
        "Mapping",
        Tile::Sphere(&[("mapping", S("two_part")), ("object_map", S("normal")), ("surface", S("cylinder"))]),
    ),
    (
        "centroid_cube",
        "Mapping",
        Tile::Sphere(&[("mapping", S("two_part")), ("object_map", S("centroid")), ("surface", S("cube"))]),
    ),
    (
        "proxy_plane",
        "Mapping",
        Tile::Sphere(&[("mapping", S("two_part")), ("object_map", S("proxy_normal")), ("surface", S("plane"))]),
    ),
    ("bump", "Surface detail", Tile::Detail("bump", "fbm", BUMPS)),
    (
        "bump_bricks",
        "Surface detail",
        Tile::Detail(
            "bump",
            "bricks",
            &[("width", N(1.0)), ("height", N(0.5)), ("mortar", N(0.08)), ("width_filter", N(0.06)), ("gain", N(0.04))],
        ),
    ),
    (
        "normal_map",
        "Surface detail",
        Tile::Detail(
            "normal_map",
            "ramp",
            &[
                ("input", T("voronoi", &[("dimension", I(2)), ("frequency", N(3.0))])),
                ("colors", L(&[0.3, 0.5, 0.95, 0.5, 0.3, 0.95, 0.7, 0.5, 0.95, 0.5, 0.7, 0.95])),
            ],
        ),
    ),
    (
        "displacement",
        "Surface detail",
        Tile::Displaced("ridged", &[("frequency", N(2.0)), ("gain", N(0.4)), ("octaves", I(5))]),
    ),
    (
        "displacement_vector",
        "Surface detail",
        Tile::Displaced(
            "ramp",
            &[
                ("input", T("noise", &[("frequency", N(3.0)), ("gain", N(0.5)), ("offset", N(0.5))])),
                ("colors", L(&[0.0, 0.0, 0.0, 0.4, 0.0, 0.1, 0.0, 0.4, 0.2])),
            ],
        ),
    ),
    ("relief_flat", "Relief", Tile::Relief(|_, _, uv| Some(uv))),
    ("parallax", "Relief", Tile::Relief(|r, l, uv| Some(parallax::single_step(uv, r.field.at(uv), -l.direction)))),
    (
        "parallax_limited",
        "Relief",
        Tile::Relief(|r, l, uv| Some(parallax::offset_limited(uv, r.field.at(uv), -l.direction))),
    ),
    (
        "parallax_slope",
        "Relief",
        Tile::Relief(|r, l, uv| {
            Some(parallax::with_slope_limited(uv, r.field.at(uv), r.field.normal(uv), -l.direction))
        }),
    ),
    (
        "parallax_iterated",
        "Relief",
        Tile::Relief(|r, l, uv| Some(parallax::iterated(uv, -l.direction, 3, |p| (r.field.at(p), r.field.normal(p))))),
    ),
    ("march", "Relief", Tile::Relief(|r, l, _| search::linear(&r.field, l, 12).map(|i| l.at(i.1).truncate()))),
    (
        "march_binary",
        "Relief",
        Tile::Relief(|r, l, _| {
            search::linear(&r.field, l, 12).map(|i| l.at(search::binary(&r.field, l, i, 6)).truncate())
        }),
    ),
    (
        "march_secant",
        "Relief",
        Tile::Relief(|r, l, _| {
            search::linear(&r.field, l, 12).map(|i| l.at(search::secant(&r.field, l, i, 3)).truncate())
        }),
    ),
    ("cones", "Relief", Tile::Relief(|r, l, _| r.cones.trace(&r.field, l, 400).map(|h| l.at(h.0).truncate()))),
    ("cones_relaxed", "Relief", Tile::Relief(|r, l, _| r.relaxed.trace(&r.field, l, 40).map(|h| l.at(h.0).truncate()))),
    ("spheres", "Relief", Tile::Relief(|r, l, _| r.distances.trace(&r.field, l, 100).map(|h| l.at(h.0).truncate()))),
    ("relief_exact", "Relief", Tile::Relief(|r, l, _| r.field.first_hit(l).map(|t| l.at(t).truncate()))),
];

fn texture(desc: &mut SceneDesc, kind: &str, params: Params) -> steradian_scene::NodeId {
    let mut node = Node::new(Family::Texture, kind, None);
    for (name, p) in params {
        let value: Value = match *p {
            N(v) => v.into(),
            I(v) => v.into(),
            S(v) => v.into(),
            C(r, g, b) => Value::Spectrum(SpectrumValue::Rgb([r, g, b], ColorSpace::Srgb)),
            L(v) => Value::Floats(v.to_vec()),
            V(v) => v.into(),
            T(kind, params) => texture(desc, kind, params).into(),
        };
        node.set(*name, value, None);
    }
    desc.add(node)
}

/// A scene of one shape whose material is made by `material`.
fn scene(
    shape: Node,
    mesh: Option<Mesh>,
    make: impl FnOnce(&mut SceneDesc, &mut Node, &mut Node),
) -> Result<Scene, String> {
    let mut desc = SceneDesc::default();
    let mut material = Node::new(Family::Material, "diffuse", None).with("reflectance", 0.7);
    let mut shape = shape;
    make(&mut desc, &mut material, &mut shape);
    let (material, node) = (desc.add(material), desc.add(shape));
    let mesh = mesh.map(|m| desc.add_mesh(m));
    desc.shapes.push(Shape {
        node,
        mesh,
        world_from_object: Transform::rotate(DVec3::Z, 0.0),
        reverse_orientation: false,
        material: Some(material),
        emission: None,
        interior: None,
        exterior: None,
        is_medium_boundary: false,
    });
    let light = desc.add(Node::new(Family::Light, "point", None));
    desc.lights.push(light);
    let camera = desc.add(Node::new(Family::Camera, "perspective", None));
    desc.cameras.push(camera);
    let compiled = compile(&desc, &Options::default());
    compiled.scene.ok_or_else(|| compiled.diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; "))
}

fn plane(uv: f32) -> Mesh {
    let corner = |x: f32, y: f32| ([4.0 * x, 4.0 * y, 0.0], [uv * x, uv * y]);
    let all = [corner(0., 0.), corner(1., 0.), corner(0., 1.), corner(1., 1.)];
    Mesh {
        positions: all.map(|c| c.0).to_vec(),
        uvs: all.map(|c| c.1).to_vec(),
        triangles: vec![[0, 1, 3], [0, 3, 2]],
        ..Mesh::default()
    }
}

/// Light from the upper left over a little from all around, on the albedo that the surface has.
fn shade(scene: &Scene, ray: &Ray, lit: bool) -> Vec3 {
    let Some(hit) = scene.intersect(ray) else { return Vec3::splat(0.03) };
    let i = scene.interaction(ray, &hit);
    let mut lambda = Wavelengths { lambda: [0.0; 4], pdf: [1.0; 4] };
    let Some((s, frame)) = scene.scattering(&i, 0.5, &mut lambda) else { return Vec3::ZERO };
    let up = Vec3::new(0.0, 0.0, 1.0);
    let e = s.bsdf.eval(up, up, steradian_core::bsdf::TransportMode::Radiance);
    let albedo = Vec3::from(e.value.to_rgb()) * std::f32::consts::PI;
    let light = Vec3::new(-0.5, -0.55, 0.67);
    if lit { albedo * (0.12 + 0.88 * frame.z.dot(light.normalize()).max(0.0)) } else { albedo }
}

fn render(tile: &Tile, card: &Path, relief: &Relief) -> Result<Vec<[f32; 3]>, String> {
    let with_card = |params: Params| {
        move |desc: &mut SceneDesc, m: &mut Node, _: &mut Node| {
            let t = texture(desc, "image", params);
            desc.node_mut(t).set("file", card.to_path_buf(), None).set("origin", "top", None);
            m.set("reflectance", t, None);
        }
    };
    let mesh = || Node::new(Family::Shape, "mesh", None);
    let (made, is_round) = match tile {
        Tile::Flat(kind, params) => (
            Some(scene(mesh(), Some(plane(4.0)), |desc, m, _| {
                let t = texture(desc, kind, params);
                m.set("reflectance", t, None);
            })?),
            false,
        ),
        Tile::Wrapped(params) => {
            let mut wide = plane(3.0);
            wide.uvs.iter_mut().for_each(|uv| *uv = uv.map(|v| v - 1.0));
            (Some(scene(mesh(), Some(wide), with_card(params))?), false)
        }
        Tile::Sphere(params) => {
            // Seen from −y with z up.
            (Some(scene(Node::new(Family::Shape, "sphere", None), None, with_card(params))?), true)
        }
        Tile::Detail(wrapper, kind, params) => (
            Some(scene(mesh(), Some(plane(4.0)), |desc, m, _| {
                let t = texture(desc, kind, params);
                m.set(*wrapper, t, None);
            })?),
            false,
        ),
        Tile::Displaced(kind, params) => {
            let round = octahedron();
            (
                Some(scene(mesh(), Some(round), |desc, _, shape| {
                    let t = texture(desc, kind, params);
                    shape.set("displacement", t, None).set("edge_length", 0.03, None);
                    shape.set("displacement_vector", *kind == "ramp", None);
                })?),
                true,
            )
        }
        Tile::Relief(_) => (None, false),
    };
    let lit = !matches!(tile, Tile::Flat(..) | Tile::Wrapped(..));
    let mut pixels = Vec::with_capacity(SIZE * SIZE);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let mut sum = Vec3::ZERO;
            for k in 0..GRID * GRID {
                let sub = Vec2::new((k % GRID) as f32 + 0.5, (k / GRID) as f32 + 0.5) / GRID as f32;
                let p = (Vec2::new(x as f32, y as f32) + sub) / SIZE as f32;
                sum += match (tile, &made) {
                    (Tile::Relief(find), _) => relief_color(relief, *find, p),
                    (_, Some(scene)) if is_round => {
                        let q = (p * 2.0 - 1.0) * 1.25;
                        shade(scene, &Ray::new(Vec3::new(q.x, -5.0, -q.y), Vec3::Y), false) * round_light(scene, q)
                    }
                    (_, Some(scene)) => {
                        // Row 0 is v = 0 for the card, whose origin is at the top.
                        shade(scene, &Ray::new(Vec3::new(4.0 * p.x, 4.0 * p.y, 5.0), -Vec3::Z), lit)
                    }
                    _ => Vec3::ZERO,
                };
            }
            pixels.push((sum / (GRID * GRID) as f32).to_array());
        }
    }
    Ok(pixels)
}

/// Light on the round tiles, by the normal that the ray meets.
fn round_light(scene: &Scene, q: Vec2) -> f32 {
    let ray = Ray::new(Vec3::new(q.x, -5.0, -q.y), Vec3::Y);
    let Some(hit) = scene.intersect(&ray) else { return 1.0 };
    let n = scene.interaction(&ray, &hit).surface.ns;
    0.25 + 0.75 * n.dot(Vec3::new(-0.5, -0.7, 0.5).normalize()).max(0.0)
}

fn octahedron() -> Mesh {
    let p: Vec<[f32; 3]> = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].map(|v| v.to_array()).into();
    let triangles = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let flat = Mesh { positions: p.clone(), normals: p, triangles, ..Mesh::default() };
    let round = |v: &steradian_core::shape::displacement::Vertex| v.p.normalize() - v.p;
    let by = |a: Vec3, b: Vec3| (a - b).length() / 0.2;
    steradian_core::shape::displacement::displace(&flat, 1 << 16, by, round).unwrap_or(flat)
}

/// The relief seen obliquely, checked and lit.
fn relief_color(relief: &Relief, find: fn(&Relief, &Line, Vec2) -> Option<Vec2>, p: Vec2) -> Vec3 {
    let line = Line {
        origin: Vec3::new(p.x, p.y, 0.0) + Vec3::new(0.0, 0.85, 0.5) * 0.6,
        direction: Vec3::new(0.0, -0.85, -0.5).normalize(),
    };
    let Some(uv) = find(relief, &line, p) else { return Vec3::splat(0.03) };
    if uv.cmplt(Vec2::ZERO).any() || uv.cmpgt(Vec2::ONE).any() {
        return Vec3::splat(0.03);
    }
    let n = relief.field.normal(uv);
    let checks = ((uv * 12.0).floor().element_sum() as i32 & 1) as f32;
    let light = 0.15 + 0.85 * n.dot(Vec3::new(-0.6, 0.4, 0.7).normalize()).max(0.0);
    Vec3::new(0.75, 0.6 - 0.2 * checks, 0.3 + 0.3 * checks) * light
}

fn main() -> Result<(), String> {
    let mut args = std::env::args().skip(1);
    let folder = PathBuf::from(args.next().unwrap_or_else(|| "docs/textures".into()));
    let names: Vec<String> = args.collect();
    std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let card_file = std::env::temp_dir().join(format!("steradian-card-{}.exr", std::process::id()));
    let n = 128;
    let at = |i: usize| (i as f32 + 0.5) / n as f32;
    let pixels: Vec<[f32; 3]> =
        (0..n).flat_map(|y| (0..n).map(move |x| card::orientation(Vec2::new(at(x), at(y))).to_array())).collect();
    let save = |path: &Path, pixels: &[[f32; 3]], side: usize| {
        let image = Image::from_rgb(side, side, pixels).map_err(|e| e.to_string())?;
        write(path, &image, &WriteOptions::default()).map_err(|e| e.to_string())
    };
    save(&card_file, &pixels, n)?;
    let field = HeightField::sampled(49, 49, |p| {
        let q = (p - 0.5) * 2.0;
        0.09 * (0.5 + 0.5 * (TAU * 2.0 * p.x).sin() * (TAU * 2.0 * p.y).cos())
            + if q.length() < 0.4 { 0.06 } else { 0.0 }
            - 0.08
    })
    .ok_or("the relief has faults")?;
    let (cones, relaxed, distances) =
        (ConeMap::new(&field), ConeMap::relaxed(&field), DistanceField::new(&field, 49, 24));
    let relief = Relief { field, cones, relaxed, distances };
    let mut page = String::from(
        "# Textures: a gallery\n\nEach tile is made by `cargo run -p steradian-core --example texture_gallery -- docs/textures NAME`; the parameters\n\
         stand in that example, their meaning in [the vocabulary](../crates/scene/README.md). The same without a name makes all of them and\n\
         this page. The test card is black in its first corner, has an arrow along u (with the longer head) and one along v.\n",
    );
    let mut section = "";
    for (name, group, tile) in TILES {
        if *group != section {
            section = group;
            let _ = write!(page, "\n## {section}\n\n");
        }
        let _ = writeln!(
            page,
            "<img src=\"textures/{name}.png\" alt=\"{name}\" title=\"{name}\" width=\"{SIZE}\"> `{name}`"
        );
        if names.is_empty() || names.iter().any(|n| n == name) {
            let pixels = render(tile, &card_file, &relief).map_err(|e| format!("{name}: {e}"))?;
            save(&folder.join(format!("{name}.png")), &pixels, SIZE)?;
        }
    }
    let _ = std::fs::remove_file(&card_file);
    if names.is_empty() {
        let at = folder.with_file_name("textures-gallery.md");
        std::fs::write(&at, page).map_err(|e| e.to_string())?;
    }
    Ok(())
}

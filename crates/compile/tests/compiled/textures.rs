//! Texture nodes through the compiler: every kind, what they combine to, and what is wrong with them.

use super::one_shape;
use steradian_compile::{Options, compile};
use steradian_core::{ColorMode, Scene, material::Model};
use steradian_math::{
    Vec2, Vec3,
    hash::HashRng,
    spectra::{
        Wavelengths,
        role::{Color, Role},
    },
};
use steradian_scene::{ColorSpace, Family, Node, NodeId, SceneDesc, SpectrumValue, Value};
use steradian_texture::{SpectrumTexture, Texture, TextureContext, TextureId, Textures};

const LAMBDA: Wavelengths = Wavelengths::RGB;

fn texture(kind: &str) -> Node {
    Node::new(Family::Texture, kind, None)
}

fn rgb(r: f64, g: f64, b: f64) -> Value {
    Value::Spectrum(SpectrumValue::Rgb([r, g, b], ColorSpace::Srgb))
}

fn numbers(v: &[f64]) -> Value {
    Value::Floats(v.to_vec())
}

/// A sphere whose reflectance is a texture: the scene, or what is wrong.
fn scene(desc: &mut SceneDesc, texture: NodeId) -> Result<Scene, Vec<String>> {
    let material = Node::new(Family::Material, "diffuse", None).with("reflectance", texture);
    one_shape::add(desc, Node::new(Family::Shape, "sphere", None), None, Some(material));
    one_shape::compiled(desc)
}

fn compiled(node: Node) -> Result<(Scene, TextureId), Vec<String>> {
    let mut desc = SceneDesc::default();
    let id = desc.add(node);
    compiled_in(desc, id)
}

fn compiled_in(mut desc: SceneDesc, id: NodeId) -> Result<(Scene, TextureId), Vec<String>> {
    let scene = scene(&mut desc, id)?;
    match &scene.materials()[1].model {
        Model::Diffuse(SpectrumTexture::Texture(t, Role::Albedo)) => Ok((scene.clone(), *t)),
        m => panic!("{m:?}"),
    }
}

fn value((scene, id): &(Scene, TextureId), at: &TextureContext) -> Vec3 {
    Vec3::from(scene.textures().spectrum(*id, at, Role::Albedo, &LAMBDA).to_rgb())
}

fn at(u: f32, v: f32) -> TextureContext<'static> {
    TextureContext { n: Vec3::Y, ..TextureContext::new(Vec3::new(u, v, 0.3), Vec2::new(u, v)) }
}

#[test]
fn every_kind_compiles_and_varies() {
    let kinds = [
        "checkerboard",
        "bricks",
        "tiles",
        "brick_shade",
        "stripes",
        "dots",
        "gradient",
        "bilerp",
        "noise",
        "fbm",
        "wrinkled",
        "ridged",
        "windy",
        "worley",
        "voronoi",
        "wood",
        "marble",
    ];
    for kind in kinds {
        let known = |name: &&str| Family::Texture.model(kind).is_some_and(|m| m.parameter(name).is_some());
        let scaled = ["frequency", "scale"].into_iter().find(known);
        let node = scaled.into_iter().fold(texture(kind), |node, name| node.with(name, 2.0));
        let c = compiled(node).unwrap_or_else(|e| panic!("{kind}: {e:?}"));
        let mut rng = HashRng::new(1);
        let values: Vec<Vec3> =
            (0..200).map(|_| value(&c, &at(rng.next_f32() * 4.0 - 2.0, rng.next_f32() * 4.0 - 2.0))).collect();
        assert!(values.iter().all(|v| v.is_finite()) && values.iter().any(|v| *v != values[0]), "{kind}");
    }
}

#[test]
fn patterns_lead_from_one_texture_to_another() {
    let c = compiled(texture("stripes").with("a", rgb(0.1, 0.2, 0.3)).with("b", rgb(0.5, 0.6, 0.7)).with("duty", 0.25))
        .unwrap();
    assert_eq!(value(&c, &at(0.2, 0.0)), Vec3::new(0.5, 0.6, 0.7));
    assert_eq!(value(&c, &at(0.3, 0.0)), Vec3::new(0.1, 0.2, 0.3));
    let c = compiled(texture("direction_mix").with("a", 0.25).with("b", 0.75).with("dir", [0.0, 2.0, 0.0])).unwrap();
    assert_eq!(value(&c, &at(0.0, 0.0)), Vec3::splat(0.25));
    assert_eq!(value(&c, &TextureContext { n: Vec3::X, ..at(0.0, 0.0) }), Vec3::splat(0.75));
    let corners = texture("bilerp").with("v00", 0.0).with("v10", 0.4).with("v01", 0.8).with("v11", rgb(1.0, 0.0, 0.0));
    let c = compiled(corners).unwrap();
    let by_hand = |r11: f32| 0.4 * 0.75 * 0.75 + 0.8 * 0.25 * 0.25 + r11 * 0.75 * 0.25;
    assert!((value(&c, &at(0.75, 0.25)) - Vec3::new(by_hand(1.0), by_hand(0.0), by_hand(0.0))).length() < 1e-6);
}

#[test]
fn combinators_by_hand() {
    let color = rgb(0.2, 0.4, 0.6);
    let of = |node: Node| value(&compiled(node).unwrap(), &at(0.5, 0.5));
    assert!((of(texture("add").with("a", color.clone()).with("b", 0.1)) - Vec3::new(0.3, 0.5, 0.7)).length() < 1e-6);
    assert!(
        (of(texture("scale").with("texture", color.clone()).with("scale", 0.5)) - Vec3::new(0.1, 0.2, 0.3)).length()
            < 1e-6
    );
    assert_eq!(of(texture("channel").with("input", color.clone()).with("channel", "b")), Vec3::splat(0.6));
    let turned = of(texture("hsv").with("input", color.clone()).with("hue", 120.0));
    assert!((turned - Vec3::new(0.6, 0.2, 0.4)).length() < 1e-6, "{turned}");
    let ramp = texture("ramp").with("input", 0.25).with("colors", numbers(&[0.0, 0.0, 0.0, 1.0, 0.5, 0.25]));
    assert_eq!(of(ramp), Vec3::new(0.25, 0.125, 0.0625));
    let curve = texture("curve").with("input", color.clone()).with("values", numbers(&[1.0, 0.0]));
    assert!((of(curve) - Vec3::new(0.8, 0.6, 0.4)).length() < 1e-6);
    let swap =
        texture("color_space").with("input", color).with("matrix", numbers(&[0., 1., 0., 0., 0., 1., 1., 0., 0.]));
    assert!((of(swap) - Vec3::new(0.4, 0.6, 0.2)).length() < 1e-6);
    // White is white in every space; a display's green is less than all of a wider space's.
    let wide = |c: Value| of(texture("color_space").with("input", c).with("to", "rec2020"));
    assert!((wide(rgb(1.0, 1.0, 1.0)) - Vec3::ONE).length() < 1e-4);
    assert!((wide(rgb(0.0, 1.0, 0.0)) - Vec3::new(0.3293, 0.9195, 0.0880)).length() < 1e-3);
}

#[test]
fn triplanar_takes_the_plane_that_the_surface_faces() {
    let mut desc = SceneDesc::default();
    let checks = desc.add(texture("checkerboard"));
    let id = desc.add(texture("triplanar").with("texture", checks));
    let c = compiled_in(desc, id).unwrap();
    let seen = |p: Vec3, n: Vec3| value(&c, &TextureContext { n, ..TextureContext::new(p, Vec2::ZERO) }).x;
    // Across z by (x, y); across x by (y, z).
    assert_eq!(seen(Vec3::new(1.5, 0.5, 1.5), Vec3::Z), 0.0);
    assert_eq!(seen(Vec3::new(1.5, 0.5, 1.5), Vec3::X), 0.0);
    assert_eq!(seen(Vec3::new(1.5, 0.5, 0.5), Vec3::X), 1.0);
    // Across y by (−x, z): the picture is not mirrored.
    assert_eq!(seen(Vec3::new(0.5, 0.5, 1.5), Vec3::Y), 1.0);
    assert!((seen(Vec3::new(1.5, 0.5, 0.5), Vec3::new(1.0, 0.0, 1.0).normalize()) - 0.5).abs() < 1e-6);
}

#[test]
fn chains_may_be_a_million_long() {
    let mut textures = Textures::new(ColorMode::Rgb);
    let one = textures.add(Texture::Constant(Color::constant(1.0)));
    let small = textures.add(Texture::Constant(Color::constant(1e-6)));
    // To the left, and to the right, where intermediate results pile up.
    for right in [false, true] {
        let mut sum = one;
        for _ in 0..1_000_000 {
            sum = textures.add(if right { Texture::Add(small, sum) } else { Texture::Add(sum, small) });
        }
        let v = textures.float(sum, &at(0.0, 0.0));
        assert!((v - 2.0).abs() < 0.05, "{v}");
    }
}

#[test]
fn long_chains_in_files_compile_and_longer_ones_are_refused() {
    let chain = |n: usize| {
        let mut desc = SceneDesc::default();
        let mut id = desc.add(texture("fbm"));
        for _ in 0..n {
            id = desc.add(texture("scale").with("texture", id).with("scale", 1.0));
        }
        compiled_in(desc, id)
    };
    assert!(value(&chain(20_000).unwrap(), &at(0.3, 0.4)).is_finite());
    assert!(chain(200_000).unwrap_err()[0].contains("to evaluate this takes more than"));
    // Constants in constants have no end either.
    let mut desc = SceneDesc::default();
    let mut id = desc.add(texture("constant").with("value", 0.25));
    for _ in 0..200_000 {
        id = desc.add(texture("constant").with("value", id));
    }
    assert!(scene(&mut desc, id).is_ok());
}

#[test]
fn what_is_wrong_is_said() {
    let mut desc = SceneDesc::default();
    let first = desc.add(texture("add").with("b", 0.0));
    let second = desc.add(texture("scale").with("texture", first));
    desc.node_mut(first).set("a", second, None);
    assert_eq!(compiled_in(desc, first).unwrap_err(), ["this texture contains itself"]);
    let mut desc = SceneDesc::default();
    let mut id = desc.add(texture("fbm"));
    for _ in 0..40 {
        id = desc.add(texture("add").with("a", id).with("b", id));
    }
    assert!(compiled_in(desc, id).unwrap_err()[0].contains("counting shared ones"));
    for (node, words) in [
        (texture("ramp"), "a ramp needs stops"),
        (texture("ramp").with("colors", numbers(&[1.0, 2.0])), "a ramp needs stops"),
        (texture("ramp").with("colors", numbers(&[1.0; 7])), "three numbers each"),
        (texture("curve").with("values", numbers(&[1.0; 2])).with("places", numbers(&[1.0, 0.0])), "increase"),
        (texture("color_space").with("matrix", numbers(&[1.0; 8])), "9 numbers"),
        (texture("fbm").with("octaves", -1_i64), "octaves"),
        (texture("fbm").with("roughness", 1e9), "roughness"),
        (texture("bricks").with("width", 0.0), "greater than zero"),
        (texture("stripes").with("duty", 2.0), "between 0 and 1"),
        (texture("worley").with("feature", "f3"), "known are f1, f2, border"),
        (texture("facing").with("dir", [0.0; 3]), "no length"),
        (texture("checkerboard").with("mapping", "triangle"), "9 numbers as 'corners'"),
        (texture("checkerboard").with("khr_offset", numbers(&[1.0])), "two numbers"),
        (texture("grid"), "needs a file"),
    ] {
        let kind = node.kind.clone();
        let said = compiled(node).unwrap_err();
        assert!(said.iter().any(|s| s.contains(words)), "{kind}: {said:?}");
    }
}

/// M213: a detail texture of mean one, here as twice one of mean a half, multiplies a base finely and keeps its mean.
#[test]
fn detail_textures_keep_the_mean() {
    let mut desc = SceneDesc::default();
    let base = desc.add(texture("gradient").with("a", rgb(0.2, 0.3, 0.4)).with("b", rgb(0.4, 0.5, 0.2)));
    let detail =
        desc.add(texture("checkerboard").with("a", 0.25).with("b", 0.75).with("scale_u", 64.0).with("scale_v", 64.0));
    let doubled = desc.add(texture("scale").with("texture", detail).with("scale", 2.0));
    let id = desc.add(texture("scale").with("texture", base).with("scale", doubled));
    let c = compiled_in(desc, id).unwrap();
    let n = 256;
    let points =
        (0..n * n).map(|i| value(&c, &at(((i % n) as f32 + 0.5) / n as f32, ((i / n) as f32 + 0.5) / n as f32)));
    let (mut mean, mut seen) = (Vec3::ZERO, std::collections::BTreeSet::new());
    for v in points {
        mean += v / (n * n) as f32;
        seen.insert((v.x * 1e4) as i32);
    }
    assert!((mean - Vec3::new(0.3, 0.4, 0.3)).length() < 1e-3, "{mean}");
    assert!(seen.len() > 300, "it varies: {}", seen.len());
    // Over a footprint of many of its periods the detail is gone.
    let mut far = at(0.5, 0.5);
    (far.footprint.duvdx, far.footprint.duvdy) = (Vec2::X * 0.5, Vec2::Y * 0.5);
    assert!((value(&c, &far) - Vec3::new(0.3, 0.4, 0.3)).length() < 2e-3, "{}", value(&c, &far));
}

/// Masks are passed by chance, with the mean opacity of the footprint: from afar as much is hit as from near, pixel by
/// pixel, and no ray is needed for each hole.
#[test]
fn masks_from_afar_keep_their_coverage() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mask.pfm");
    // Holes of one texel at random: a third is there.
    let n = 64_u32;
    let there = |i: u32| f32::from(steradian_math::hash::mix32(i).is_multiple_of(3));
    let coverage = (0..n * n).map(there).sum::<f32>() / (n * n) as f32;
    let image =
        steradian_image::Image::from_rgb(64, 64, &(0..n * n).map(|i| [there(i); 3]).collect::<Vec<_>>()).unwrap();
    steradian_image::write(&file, &image, &Default::default()).unwrap();
    let scene = |filter: &str| {
        let mut desc = SceneDesc::default();
        let mask =
            texture("image").with("file", Value::Path(file.clone())).with("filter", filter).with("scale_u", 2000.0);
        let mask = desc.add(mask.with("scale_v", 2000.0).with("raw", true));
        // A square of 100 × 100, seen from the origin at a distance of 50: a pixel sees more than all 64² texels.
        let quad = steradian_scene::Mesh {
            positions: vec![[-50., -50., 50.], [50., -50., 50.], [50., 50., 50.], [-50., 50., 50.]],
            uvs: vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]],
            triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
            ..Default::default()
        };
        let shape = Node::new(Family::Shape, "mesh", None).with("alpha", mask);
        one_shape::add(&mut desc, shape, Some(quad), Some(Node::new(Family::Material, "diffuse", None)));
        one_shape::compiled(&desc).unwrap()
    };
    // Rays to one and the same place, from places around the eye: what varies is the hash alone.
    let hits = |scene: &Scene, spot: Vec3| {
        let mut rng = HashRng::new(7);
        let count = 2000;
        let hit = (0..count).filter(|_| {
            let eye = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 0.01;
            scene.occluded(&steradian_math::Ray::new(eye, (spot - eye).normalize()))
        });
        hit.count() as f32 / count as f32
    };
    let (far, points) = (scene("trilinear"), scene("nearest"));
    let mut uneven = 0;
    for k in 0..6 {
        let spot = Vec3::new(3.0 * k as f32 - 7.3, 1.7 * k as f32 - 3.1, 50.0);
        // Four standard errors of 2000 chances of a third are 0.042.
        let seen = hits(&far, spot);
        assert!((seen - coverage).abs() < 0.042, "{k}: {seen} {coverage}");
        uneven += i32::from((hits(&points, spot) - coverage).abs() > 0.2);
    }
    assert!(uneven > 3, "without footprints each spot is a hole or not: {uneven}");
}

/// The alpha of a picture without alpha is 1, before scale and inversion; only glTF has that as a rule, so others are
/// told.
#[test]
fn pictures_without_alpha_are_opaque() {
    let folder = tempfile::tempdir().unwrap();
    let black = steradian_image::Image::from_rgb(2, 2, &[[0.0; 3]; 4]).unwrap();
    for name in ["rgb.png", "rgb.jpg", "rgb.pfm"] {
        let file = folder.path().join(name);
        steradian_image::write(&file, &black, &Default::default()).unwrap();
        for (scale, invert, alpha) in [(1.0, false, 1.0), (0.25, false, 0.25), (0.25, true, 0.75)] {
            let image = texture("image").with("file", Value::Path(file.clone())).with("channel", "a");
            let mut desc = SceneDesc::default();
            let id = desc.add(image.with("scale", scale).with("invert", invert));
            let said = compiled_in(desc.clone(), id).unwrap_err().concat();
            assert!(said.contains("no alpha channel: its alpha is 1"), "{said}");
            desc.format = steradian_scene::Format::Gltf;
            let value = value(&compiled_in(desc, id).unwrap(), &at(0.3, 0.3));
            assert_eq!(value, Vec3::splat(alpha), "{name} {scale} {invert}");
        }
    }
}

/// Memory for pictures is added up before one of them is read, from the sizes that their files declare; a limit on
/// textures in memory makes room.
#[test]
fn pictures_that_do_not_fit_are_refused_beforehand() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("large.png");
    // A header alone: 8000 x 6000 pixels of three bytes, 183 MiB with all sizes.
    let mut header = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR".to_vec();
    header.extend([8000_u32, 6000].map(u32::to_be_bytes).concat());
    header.extend([8, 2, 0, 0, 0]);
    header.extend(0xbe06_7369_u32.to_be_bytes());
    std::fs::write(&file, &header).unwrap();
    let said = |memory: Option<u64>, texture_limit: Option<usize>| {
        let mut desc = SceneDesc::default();
        let id = desc.add(texture("image").with("file", Value::Path(file.clone())));
        let material = Node::new(Family::Material, "diffuse", None).with("reflectance", id);
        one_shape::add(&mut desc, Node::new(Family::Shape, "sphere", None), None, Some(material));
        let options = Options { memory, texture_limit, ..Options::default() };
        compile(&desc, &options).diagnostics.iter().map(|d| format!("{} {:?}", d.message, d.help)).collect::<String>()
    };
    let refused = said(Some(250 << 20), None);
    assert!(refused.contains("about 0.3 GiB") && refused.contains("--texture-limit"), "{refused}");
    // Else it is read, and found to be cut off.
    for (memory, limit) in [(None, None), (Some(1 << 30), None), (Some(150 << 20), Some(1 << 20))] {
        let read = said(memory, limit);
        assert!(read.contains("large.png") && !read.contains("GiB"), "{read}");
    }
}

/// A mask as a field of distances: opacity that is 0 or 1 at points, a ramp as wide as a pixel over its edge, and the
/// mask's mean from afar; inverted, wrapped, and with its channel.
#[test]
fn distance_fields_cut_out_masks() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mask.pfm");
    // The right three quarters are there, in red.
    let texels: Vec<[f32; 3]> = (0..128 * 128).map(|i| [f32::from(i % 128 >= 32), 0.0, 0.0]).collect();
    let image = steradian_image::Image::from_rgb(128, 128, &texels).unwrap();
    steradian_image::write(&file, &image, &Default::default()).unwrap();
    let mask = |size: i64| {
        let node = texture("distance_field").with("file", Value::Path(file.clone())).with("channel", "r");
        node.with("size", size).with("wrap_u", "clamp").with("spread", 3.0)
    };
    let plain = compiled(mask(16)).unwrap();
    let seen = |c: &(Scene, TextureId), u: f32, width: f32| {
        let mut at = at(u, 0.4);
        (at.footprint.duvdx, at.footprint.duvdy) = (Vec2::X * width, Vec2::Y * width);
        value(c, &at).x
    };
    for (u, wanted) in [(0.0, 0.0), (0.248, 0.0), (0.252, 1.0), (1.0, 1.0), (-3.0, 0.0)] {
        assert_eq!(seen(&plain, u, 0.0), wanted, "{u}");
    }
    // A hundredth wide: half at the edge, and the slope of a box there.
    assert!((seen(&plain, 0.25, 0.01) - 0.5).abs() < 1e-2);
    assert!((seen(&plain, 0.251, 0.01) - seen(&plain, 0.249, 0.01) - 0.2).abs() < 1e-2);
    assert!((seen(&plain, 0.5, 1.0) - 0.75).abs() < 1e-3);
    let inverted = compiled(mask(16).with("invert", true)).unwrap();
    assert!((seen(&inverted, 0.25, 0.004) - 1.0 + seen(&plain, 0.25, 0.004)).abs() < 1e-6);
    // The mean of the colour is a third, below the cut.
    let mean = texture("distance_field").with("file", Value::Path(file.clone()));
    assert_eq!(seen(&compiled(mean.clone()).unwrap(), 0.5, 0.0), 0.0);
    assert_eq!(seen(&compiled(mean.with("cut", 0.3)).unwrap(), 0.5, 0.0), 1.0);
    for (node, part) in [
        (mask(0), "'size' is from 1 to 4096"),
        (mask(16).with("spread", 0.1), "'spread' is from 0.5 to 64"),
        (texture("distance_field"), "needs a file"),
    ] {
        let said = compiled(node).unwrap_err().concat();
        assert!(said.contains(part), "{said}");
    }
}

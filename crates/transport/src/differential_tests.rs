//! Ray differentials along paths, held against neighbouring paths that are traced.

use crate::{Arrival, Depth, GuidedDirection, PathState, Vertex, arrive};
use steradian_bsdf::TransportMode;
use steradian_compile::{Options, compile};
use steradian_core::{
    ColorMode, Scene,
    sampler::{Sampler, SamplerKind},
    scene::Interaction,
};
use steradian_engine::{Counters, PathContext};
use steradian_math::{DVec3, Transform, Vec2, hash::ONE_MINUS_EPSILON, spectra::Wavelengths};
use steradian_scene::{Family, Format, Node, SceneDesc, Shape, Value};

/// A camera at (0, 1, 0) that looks along z, a floor at y = 0 and a wall at z = 8 with a texture that asks for
/// footprints, and what is placed between them.
fn scene(between: &[(Node, &Node)]) -> Scene {
    let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let film = Node::new(Family::Film, "rgb", None).with("width", 64i64).with("height", 64i64);
    desc.film = Some(desc.add(film));
    let place = Transform::look_at(DVec3::Y, DVec3::new(0.0, 1.0, 8.0), DVec3::Y).unwrap();
    let camera = Node::new(Family::Camera, "perspective", None).with("fov", 40.0).with("to_world", place);
    desc.cameras = vec![desc.add(camera)];
    let texture = desc.add(Node::new(Family::Texture, "checkerboard", None));
    let checks = Node::new(Family::Material, "diffuse", None).with("reflectance", Value::Node(texture));
    let plane = |normal: [f64; 3], offset: f64| {
        Node::new(Family::Shape, "plane", None).with("normal", normal).with("distance", -offset)
    };
    let walls = [(plane([0.0, 1.0, 0.0], 0.0), &checks), (plane([0.0, 0.0, -1.0], -8.0), &checks)];
    for (shape, material) in walls.iter().chain(between) {
        let (node, material) = (desc.add(shape.clone()), desc.add((*material).clone()));
        desc.shapes.push(Shape { material: Some(material), ..Shape::new(node) });
    }
    compile(&desc, &Options { mode: Some(ColorMode::Rgb), spp: Some(1), ..Options::default() }).scene.unwrap()
}

/// The first diffuse point of a path that draws the same numbers everywhere, and the differential with which it is met.
fn follow(scene: &Scene, pixel: Vec2, events: u32, lobe: f32) -> (Interaction, PathState) {
    let ray = scene.camera().ray(scene.film(), pixel, Vec2::splat(0.5));
    let sampler = Sampler { kind: SamplerKind::Independent, spp: 1, seed: 0 }.pixel(0, 0, 0);
    let depth = Depth { max: u32::MAX, roulette_after: u32::MAX, hide_emitters: false };
    let mut lambda = Wavelengths::RGB;
    let (mut path_state, mut sum, mut arrival) =
        (PathState::camera(scene, ray), steradian_math::Spectrum::ZERO, Arrival::End);
    let (sampler, lambda, counters) = (&sampler, &mut lambda, &mut Counters::default());
    let context = &mut PathContext { scene, sampler, lambda, counters };
    loop {
        arrive::<false>(&mut path_state, &depth, &mut sum, &mut arrival, context);
        let Arrival::Vertex(v @ Vertex::Surface { i, scattering, frame, .. }) = arrival else {
            panic!("{pixel} is lost")
        };
        if path_state.events == events {
            return (i, path_state);
        }
        let u2 = Vec2::new(0.3, 0.6);
        let s = scattering.bsdf.sample(frame.to_local(i.wo), lobe, u2, TransportMode::Radiance).unwrap();
        path_state.turn::<false>(scene, &v, &GuidedDirection::by_surface(s));
    }
}

/// M65: the footprint of a point that is seen in a mirror, through a pane or a ball of glass, or in a mirror that is
/// not quite smooth, is that of paths through neighbouring places on the film, in points and in parameters.
#[test]
fn footprints_are_differences_of_neighbouring_paths() {
    let material = |kind: &str| Node::new(Family::Material, kind, None);
    let plane = |offset: f64, facing: f64| {
        Node::new(Family::Shape, "plane", None).with("normal", [0.0, 0.0, facing]).with("distance", -offset * facing)
    };
    let ball = Node::new(Family::Shape, "sphere", None).with("center", [0.0, 0.9, 4.0]).with("radius", 0.8);
    let (mirror, glass) = (material("conductor"), material("dielectric").with("eta", 1.5));
    let satin = material("conductor").with("alpha_u", 0.03).with("alpha_v", 0.03);
    let frosted = material("dielectric").with("eta", 1.5).with("alpha_u", 0.03).with("alpha_v", 0.03);
    // What is in the way, the events there, and the end of the lobe choice: reflection or transmission.
    let cases = [
        ("nothing", vec![], 0, 0.0),
        ("mirror", vec![(plane(5.0, -1.0), &mirror)], 1, 0.0),
        ("mirror ball", vec![(ball.clone(), &mirror)], 1, 0.0),
        ("pane", vec![(plane(3.0, -1.0), &glass), (plane(3.5, 1.0), &glass)], 2, ONE_MINUS_EPSILON),
        ("glass ball", vec![(ball, &glass)], 2, ONE_MINUS_EPSILON),
        ("satin mirror", vec![(plane(5.0, -1.0), &satin)], 1, 0.0),
        ("frosted pane", vec![(plane(3.0, -1.0), &frosted), (plane(3.5, 1.0), &frosted)], 2, ONE_MINUS_EPSILON),
    ];
    for (name, between, events, lobe) in &cases {
        let scene = scene(between);
        for pixel in [Vec2::new(33.5, 35.5), Vec2::new(28.25, 37.0), Vec2::new(36.5, 39.75)] {
            let (i, path_state) = follow(&scene, pixel, *events, *lobe);
            let footprint =
                scene.footprint(&i, Some(path_state.differential.as_ref().unwrap_or_else(|| panic!("{name} {pixel}"))));
            let h = 1.0 / 16.0;
            for (axis, dp, duv) in
                [(Vec2::X, footprint.dpdx, footprint.duvdx), (Vec2::Y, footprint.dpdy, footprint.duvdy)]
            {
                let [a, b] = [-h, h].map(|h| follow(&scene, pixel + axis * h, *events, *lobe).0.surface);
                let (p, uv) = ((b.p - a.p) / (2.0 * h), (b.uv - a.uv) / (2.0 * h));
                let what = format!("{name} {pixel} {axis}: {dp} for {p}, {duv} for {uv}");
                assert!((dp - p).length() < 0.02 * p.length(), "{what}");
                assert!((duv - uv).length() < 0.02 * uv.length(), "{what}");
            }
        }
    }
}

/// A lobe that blurs by far more than a pixel ends a differential.
#[test]
fn broad_lobes_follow_no_differential() {
    let rough = Node::new(Family::Material, "conductor", None).with("alpha_u", 0.4).with("alpha_v", 0.4);
    let wall = Node::new(Family::Shape, "plane", None).with("normal", [0.0, 0.0, -1.0]).with("distance", 5.0);
    let scene = scene(&[(wall, &rough)]);
    assert!(follow(&scene, Vec2::new(33.5, 35.5), 1, 0.0).1.differential.is_none());
}

//! Shapes that shine, wherever they are placed: their direct light at a point against closed forms, and against the
//! light that scattering alone finds.
//!
//! A body of radiance L that is seen from a point as a disk of half angle θ around the normal gives E = π L sin² θ.

use crate::{
    shot::{Estimate, Shot, mean},
    stage::{Stage, diffuse, found_by_scattering_alone, light, plane, rectangle, shape, sphere},
};
use std::f64::consts::PI;
use steradian_core::Scene;
use steradian_math::{DVec3, spectra::photometry::photometric_from_y};
use steradian_scene::{Family, Group, Instance, Movement, Node, Transform};

/// A white floor, whose point at the origin is looked at.
fn floor() -> Stage {
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
    stage.probe([0.03, 0.02, 0.04], [0.0; 3]);
    stage
}

/// A white floor below a black shape of radiance one that is placed by a transform.
fn below(node: Node, place: Transform) -> Stage {
    let mut stage = floor();
    stage.lamp(node, 1.0).world_from_object = place;
    stage
}

/// As [`below`], of a shape that shines to both sides.
fn two_sided(node: Node, place: Transform) -> Stage {
    let mut stage = floor();
    let emission = stage.add(light("area").with("two_sided", true));
    let lamp = stage.solid(node, diffuse(0.0));
    (lamp.emission, lamp.world_from_object) = (Some(emission), place);
    stage
}

/// Makes the shape that was placed last a group, placed as often as there are transforms.
fn instanced(mut stage: Stage, places: &[(Transform, Option<Transform>)]) -> Stage {
    let shape = stage.desc.shapes.pop().expect("a shape");
    stage.desc.groups.push(Group { name: String::new(), shapes: vec![shape] });
    for (start, end) in places {
        let movement = end.map(|end| Movement { end, times: [0.0, 1.0] });
        stage.desc.instances.push(Instance { movement, ..Instance::new(0, *start) });
    }
    stage
}

/// Irradiance at the origin by an integrator.
fn irradiance(scene: &Scene, integrator: &'static str, spp: u32) -> Estimate {
    mean(&Shot::of(integrator, spp).depth(1).take(scene)).times(PI)
}

/// Light samples find what scattering alone finds, with less noise by a factor at equal samples, and so do paths from
/// the light.
#[track_caller]
fn found_both_ways(scene: Scene, what: &str, less: f64) {
    let by_light = irradiance(&scene, "path", 1 << 16);
    irradiance(&scene, "bdpt", 1 << 14).agrees(&format!("{what}, bidirectional"), by_light, 0.02);
    let by_chance = irradiance(&found_by_scattering_alone(scene), "path", 1 << 16);
    by_light.agrees(what, by_chance, 0.05);
    let ratio = by_chance.sigma[0] / by_light.sigma[0];
    assert!(ratio > less, "{what}: noise is less by {ratio:.2} alone");
}

fn up(z: f64) -> Transform {
    Transform::translate(DVec3::new(0.0, 0.0, z))
}

fn turned(axis: DVec3, degrees: f64) -> Transform {
    Transform::rotate(axis, degrees.to_radians())
}

fn scaled(x: f64, y: f64, z: f64) -> Transform {
    Transform::scale(DVec3::new(x, y, z))
}

/// Quadrics on the axis, upright and squeezed along it, which changes no disk, only heights.
#[test]
fn quadrics_on_the_axis() {
    let disk = |r: f64, z: f64| PI * r * r / (r * r + z * z);
    let down = turned(DVec3::X, 180.0);
    for squeeze in [1.0, 0.5] {
        let by = scaled(1.0, 1.0, squeeze);
        let high = |z: f64| up(3.0) * by * up(z);
        // Of an ellipsoid the circle of tangents is seen.
        let ellipsoid = PI * 0.64 / (0.64 + 9.0 - 0.64 * squeeze * squeeze);
        let cases = [
            ("sphere", below(sphere([0.0; 3], 0.8), high(0.0)), ellipsoid),
            ("cone", below(shape("cone").with("radius", 0.7), high(0.0) * down), disk(0.7, 3.0)),
            (
                "paraboloid",
                below(shape("paraboloid").with("radius", 0.9).with("z_min", 0.25), high(0.0)),
                disk(0.9, 3.0 + squeeze) - disk(0.45, 3.0 + 0.25 * squeeze),
            ),
            (
                "cylinder",
                two_sided(shape("cylinder").with("radius", 0.6), high(0.0)),
                disk(0.6, 3.0 - squeeze) - disk(0.6, 3.0 + squeeze),
            ),
            (
                "hyperboloid",
                two_sided(shape("hyperboloid").with("p1", [1.0, 0.0, -1.0]).with("p2", [0.5, 0.4, 1.0]), high(0.0)),
                disk(1.0, 3.0 - squeeze) - disk(0.41_f64.sqrt(), 3.0 + squeeze),
            ),
        ];
        for (what, stage, expected) in cases {
            let scene = stage.scene();
            irradiance(&scene, "path", 1 << 15).is_near_grey(&format!("{what}, {squeeze}"), expected, 0.01);
            found_both_ways(scene, what, 1.2);
        }
    }
}

/// Parts of quadrics in any place.
#[test]
fn quadrics_aside() {
    let place = up(2.0) * turned(DVec3::new(1.0, 2.0, -1.0), 70.0) * scaled(0.5, 1.0, 0.7);
    for kind in ["cone", "paraboloid", "hyperboloid", "sphere", "cylinder"] {
        let node = shape(kind).with("phi_max", 250.0);
        found_both_ways(two_sided(node.clone(), up(2.0) * turned(DVec3::X, 110.0)).scene(), kind, 1.2);
        found_both_ways(two_sided(node, place).scene(), kind, 1.2);
    }
}

/// A straight curve of width w and half length a at a height h: E = L w (a/(h²+a²) + atan(a/h)/h). A ribbon that faces
/// the point differs by the cosine alone: as a rectangle.
#[test]
fn curves() {
    let points = vec![-1.0, 0.0, 0.0, -1.0 / 3.0, 0.0, 0.0, 1.0 / 3.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let node = |kind: &str| {
        shape("curve").with("points", points.clone()).with("type", kind).with("width0", 0.01).with("width1", 0.01)
    };
    let (a, h, w) = (1.0_f64, 2.0_f64, 0.01);
    let expected = w * (a / (h * h + a * a) + (a / h).atan() / h);
    for kind in ["flat", "cylinder"] {
        let e = irradiance(&below(node(kind), up(h)).scene(), "path", 1 << 18);
        // Nine sides leave 0.8 parts in a hundred.
        assert!((e.mean[0] / expected - 1.0).abs() < 0.012 && e.sigma[0] < 0.002 * expected, "{kind}: {e:?}");
    }
    let down = vec![0.0, 0.0, -1.0, 0.0, 0.0, -1.0];
    let ribbon = irradiance(&below(node("ribbon").with("normals", down), up(h)).scene(), "path", 1 << 14);
    let mut strip = floor();
    strip.mesh_lamp(rectangle([-1.0, -0.005, h], [0.0, 0.01, 0.0], [2.0, 0.0, 0.0]), 1.0);
    ribbon.agrees("ribbon", irradiance(&strip.scene(), "path", 1 << 14), 0.01);
}

/// Spheres of a group, E = π L (r/d)² cos θ each; the light of all is one group.
#[test]
fn placed_spheres() {
    let places = [(-0.5, 2.0, 1.0), (1.0, 3.0, 2.0), (0.0, 4.0, 0.5)];
    let transforms = places.map(|(x, z, s)| (Transform::translate(DVec3::new(x, 0.0, z)) * scaled(s, s, s), None));
    let scene = instanced(below(sphere([0.0; 3], 0.3), Transform::IDENTITY), &transforms).scene();
    let each = places.map(|(x, z, s): (f64, f64, f64)| PI * (0.3 * s).powi(2) * z / (x * x + z * z).powf(1.5));
    irradiance(&scene, "path", 1 << 14).is_near_grey("three spheres", each.iter().sum(), 0.01);
    assert_eq!(scene.light_groups().of_lights, [0; 3]);
    found_both_ways(scene, "three spheres", 5.0);
}

/// Meshes, whole and textured spheres, disks and quadrics of revolution in groups that are turned, mirrored, sheared.
#[test]
fn placed_shapes() {
    let shear = Transform::from_rows([1., 0.4, 0., 0., 0., 1., 0., 0., 0., 0.2, 1., 0., 0., 0., 0., 1.]);
    let places = [
        up(2.0) * turned(DVec3::X, 160.0),
        Transform::translate(DVec3::new(1.0, 0.5, 2.0)) * scaled(-0.6, 0.6, 0.6) * turned(DVec3::Y, 140.0),
        Transform::translate(DVec3::new(-1.0, 0.5, 2.0)) * shear * turned(DVec3::Y, 200.0),
    ];
    for kept in [2, 3] {
        let places: Vec<_> = places[..kept].iter().map(|t| (*t, None)).collect();
        for kind in ["sphere", "disk", "cone", "cylinder"] {
            let size = if kind == "sphere" { 0.5 } else { 0.8 };
            let stage = two_sided(shape(kind).with("radius", size), Transform::IDENTITY);
            found_both_ways(instanced(stage, &places).scene(), kind, 1.2);
        }
        let mut stage = floor();
        stage.mesh_lamp(rectangle([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), 1.0);
        found_both_ways(instanced(stage, &places).scene(), "rectangle", 1.5);
    }
}

/// A sphere that passes from -a to a at a height h: the mean of its light is π L r² / (h √(h² + a²)). So do other
/// shapes that turn and grow, found both ways.
#[test]
fn moving_lights() {
    let (a, h, r) = (1.5_f64, 2.0, 0.3);
    let [start, end] = [-a, a].map(|x| Transform::translate(DVec3::new(x, 0.0, h)));
    let scene = instanced(below(sphere([0.0; 3], r), Transform::IDENTITY), &[(start, Some(end))]).scene();
    irradiance(&scene, "path", 1 << 16).is_near_grey("sphere", PI * r * r / (h * h.hypot(a)), 0.01);
    found_both_ways(scene, "sphere", 5.0);
    let moves = [
        (start * turned(DVec3::X, 180.0), Some(end * turned(DVec3::new(0.6, 0.8, 0.0), 120.0) * scaled(0.5, 0.5, 0.5))),
        (end * turned(DVec3::X, 180.0), Some(up(3.0) * turned(DVec3::X, 200.0) * scaled(1.5, 0.7, 1.0))),
    ];
    for kept in [1, 2] {
        for kind in ["sphere", "disk", "cone"] {
            let stage = below(shape(kind).with("radius", 0.5), Transform::IDENTITY);
            found_both_ways(instanced(stage, &moves[..kept]).scene(), kind, 1.2);
        }
        let mut stage = floor();
        stage.mesh_lamp(rectangle([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), 1.0);
        found_both_ways(instanced(stage, &moves[..kept]).scene(), "rectangle", 1.2);
    }
}

/// An emitter that a mask cuts away does not shine there, nor what rays pass from behind; pictures on spheres are where
/// they are seen.
#[test]
fn masked_and_textured() {
    let checks = |stage: &mut Stage| {
        let node = Node::new(Family::Texture, "checkerboard", None).with("scale_u", 4.0).with("scale_v", 4.0);
        stage.add(node.with("a", 0.1).with("b", 1.0))
    };
    let down = up(1.5) * turned(DVec3::X, 180.0);
    for kind in ["disk", "sphere", "rectangle"] {
        for masked in [true, false] {
            let mut stage = floor();
            let pattern = checks(&mut stage);
            let mut emission = light("area");
            if !masked {
                emission.set("radiance", pattern, None);
            }
            let emission = stage.add(emission);
            let black = stage.add(diffuse(0.0));
            let lamp = match kind {
                "rectangle" => {
                    let mut mesh = rectangle([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
                    mesh.uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
                    stage.place_mesh(mesh)
                }
                kind => stage.place(shape(kind).with("radius", 0.6)),
            };
            (lamp.emission, lamp.material, lamp.world_from_object) = (Some(emission), Some(black), down);
            let node = lamp.node;
            if masked {
                stage.desc.node_mut(node).set("alpha", pattern, None);
            }
            found_both_ways(stage.scene(), &format!("{kind}, masked: {masked}"), 1.2);
        }
    }
    let single = |degrees: f64| {
        let mut stage = floor();
        let emission = stage.add(light("area").with("two_sided", true));
        let lamp = stage.solid(shape("disk").with("single_sided", true), diffuse(0.0));
        (lamp.emission, lamp.world_from_object) = (Some(emission), up(2.0) * turned(DVec3::X, degrees));
        irradiance(&stage.scene(), "path", 1 << 12)
    };
    single(180.0).is_near_grey("the front of a disk", PI / 5.0, 0.01);
    assert_eq!(single(0.0).mean, [0.0; 3]);
    let half = below(shape("disk").with("alpha", 0.5), up(2.0) * turned(DVec3::X, 180.0));
    irradiance(&half.scene(), "path", 1 << 14).is_near_grey("half of a disk", PI / 10.0, 0.01);
}

/// Surfaces no point of which can be drawn are met by chance, without bias.
#[test]
fn by_chance() {
    let ball = shape("implicit").with("expression", "x^2 + y^2 + z^2 - 0.64");
    let e = irradiance(&below(ball, up(2.0)).scene(), "path", 1 << 16);
    e.is_near_grey("implicit ball", PI * 0.16, 0.02);
}

/// The power of a light is what it sends out: of a cone of lateral area π r √(r² + h²).
#[test]
fn power_of_a_cone() {
    let of = |parameter: &str, value: f64| {
        let mut stage = floor();
        let emission = stage.add(light("area").with(parameter, value));
        let lamp = stage.solid(shape("cone").with("radius", 0.7).with("height", 1.3), diffuse(0.0));
        (lamp.emission, lamp.world_from_object) = (Some(emission), up(3.0) * turned(DVec3::X, 180.0));
        irradiance(&stage.scene(), "path", 1 << 14)
    };
    let area = PI * 0.7 * 0.7_f64.hypot(1.3);
    of("power", 10.0 * photometric_from_y(1.0)).agrees("power", of("radiance", 1.0).times(10.0 / (PI * area)), 0.02);
}

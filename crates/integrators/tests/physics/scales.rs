//! No acne and no leaks at any scale (M64): a convex body under a constant sky of one shows its reflectance in every
//! single sample. A ray that met its own surface again would come back darker, one that slipped through brighter.

use crate::{
    shot::{Shot, is_exactly},
    stage::{Stage, cuboid, diffuse, icosphere, rectangle, shape, sphere, white},
};
use steradian_math::{DVec3, Transform};
use steradian_scene::Mesh;

/// Scales, and distances from the origin in units of the scale.
const PLACES: [(f64, f64); 10] = [
    (1e-3, 0.0),
    (1.0, 0.0),
    (1e3, 0.0),
    (1e6, 0.0),
    (1.0, 100.0),
    (1.0, 1000.0),
    (1.0, 10_000.0),
    (1e-3, 1000.0),
    (1e3, 1000.0),
    (1e6, 1000.0),
];

/// One sample per pixel is either the sky or the body.
#[track_caller]
fn every_sample_is_sky_or_body(stage: &Stage, what: &str) {
    const SKY: f64 = 1.0;
    const BODY: f64 = 0.5;
    let film = Shot::of("path", 1).roulette_after(100).take(&stage.scene());
    let near = |v: f64, to: f64| (v - to).abs() < 1e-5;
    let wrong: Vec<f64> =
        film.pixels.iter().map(|p| p.mean()[0]).filter(|v| !near(*v, SKY) && !near(*v, BODY)).collect();
    let body = film.pixels.iter().filter(|p| near(p.mean()[0], BODY)).count();
    assert!(
        wrong.is_empty(),
        "{what}: {} samples of {body} are wrong, such as {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(4)]
    );
    assert!(body * 4 > film.pixels.len(), "{what}: the body is not in the picture");
}

/// Spheres, closed meshes, boxes, cylinders and disks.
#[test]
fn convex_bodies_have_no_acne() {
    type Add = fn(&mut Stage, f64, Transform);
    let bodies: [(&str, Add); 7] = [
        ("sphere", |s, r, at| s.solid(sphere([0.0; 3], r), diffuse(0.5)).world_from_object = at),
        ("scaled unit sphere", |s, r, at| {
            let scale = Transform::scale(DVec3::new(r, 0.7 * r, 1.2 * r));
            s.solid(sphere([0.0; 3], 1.0), diffuse(0.5)).world_from_object = at * scale;
        }),
        ("icosphere", |s, r, at| {
            let made_of = s.add(diffuse(0.5));
            let mesh = s.place_mesh(icosphere([0.0; 3], r, 3));
            (mesh.material, mesh.world_from_object) = (Some(made_of), at);
        }),
        ("box", |s, r, at| {
            let made_of = s.add(diffuse(0.5));
            let mesh = s.place_mesh(cuboid([-r, -r, -0.6 * r], [r, 0.6 * r, r]));
            (mesh.material, mesh.world_from_object) =
                (Some(made_of), at * Transform::rotate(DVec3::new(1.0, 0.3, 0.2), 0.6));
        }),
        ("cylinder", |s, r, at| {
            let node = shape("cylinder").with("radius", 0.8 * r).with("z_min", -r).with("z_max", r);
            // Upright, seen from the side: the inside is out of sight.
            s.solid(node, diffuse(0.5)).world_from_object =
                at * Transform::rotate(DVec3::X, std::f64::consts::FRAC_PI_2);
        }),
        ("disk", |s, r, at| {
            s.solid(shape("disk").with("radius", r), diffuse(0.5)).world_from_object =
                at * Transform::rotate(DVec3::Y, 0.9);
        }),
        ("instanced sphere", |s, r, at| {
            s.solid(sphere([0.0; 3], 1.0), diffuse(0.5));
            let shapes = vec![s.desc.shapes.pop().expect("the sphere")];
            s.desc.groups.push(steradian_scene::Group { name: String::new(), shapes });
            let world_from_group = at * Transform::rotate(DVec3::Z, 0.3) * Transform::scale(DVec3::new(r, 0.8 * r, r));
            let group = s.desc.groups.len() - 1;
            s.desc.instances.push(steradian_scene::Instance::new(group, world_from_group));
        }),
    ];
    for (name, add) in bodies {
        for (scale, far) in PLACES {
            let mut stage = Stage::new();
            let center = DVec3::new(0.6, -0.64, 0.48) * far * scale;
            add(&mut stage, scale, Transform::translate(center));
            let eye = center + DVec3::new(0.0, 0.0, -4.0 * scale);
            stage.sky(1.0).film(48, 48).look(eye.to_array(), center.to_array(), 26.0);
            every_sample_is_sky_or_body(&stage, &format!("{name} of {scale} at {far} radii"));
        }
    }
}

/// A floor of 10⁴ at y = 0, as rectangle, bilinear patch, disk and infinite plane, with the camera near it, far above
/// it, and at grazing angles: exactly ρ.
#[test]
fn large_floors_are_flat() {
    let e = 1e4;
    for kind in ["rectangle", "patch", "disk", "plane"] {
        let mut stage = Stage::new();
        match kind {
            "rectangle" => {
                let made_of = stage.add(diffuse(0.8));
                stage.place_mesh(rectangle([-e, 0.0, -e], [0.0, 0.0, 2.0 * e], [2.0 * e, 0.0, 0.0])).material =
                    Some(made_of);
            }
            "patch" => {
                let made_of = stage.add(diffuse(0.8));
                let positions = vec![[-e, 0.0, -e], [e, 0.0, -e], [-e, 0.0, e], [e, 0.0, e]];
                let positions = positions.into_iter().map(|p| p.map(|x| x as f32)).collect();
                let floor = stage.place_mesh(Mesh { positions, patches: vec![[0, 1, 2, 3]], ..Mesh::default() });
                (floor.material, floor.reverse_orientation) = (Some(made_of), true);
            }
            "disk" => {
                let turn = Transform::rotate(DVec3::X, -std::f64::consts::FRAC_PI_2);
                stage.solid(shape("disk").with("radius", e), diffuse(0.8)).world_from_object = turn;
            }
            _ => {
                stage.solid(crate::stage::plane([0.0, 1.0, 0.0], 0.0), diffuse(0.8));
            }
        }
        stage.sky(1.0).film(32, 32);
        for (from, to, fov) in [
            ([0.0, 1.0, 0.0], [1.0, 0.0, 1.0], 30.0),
            ([300.0, 0.01, -200.0], [301.0, 0.0, -200.5], 0.5),
            ([-5000.0, 1000.0, 0.0], [0.0, 0.0, 0.0], 12.0),
            ([7000.0, 3.0, 7000.0], [6990.0, 0.0, 7000.0], 20.0),
        ] {
            stage.look(from, to, fov);
            is_exactly(&Shot::of("path", 4).take(&stage.scene()), &format!("{kind} from {from:?}"), [0.8; 3]);
        }
    }
}

/// A point light close to the surface, and parallel light, show no acne and no gap either: every sample is lit, at all
/// scales.
#[test]
fn lights_reach_convex_bodies() {
    for (scale, far) in PLACES {
        let center = DVec3::new(0.6, -0.64, 0.48) * far * scale;
        for mesh in [false, true] {
            let mut stage = Stage::new();
            if mesh {
                let made_of = stage.add(diffuse(1.0));
                let body = stage.place_mesh(icosphere([0.0; 3], scale, 3));
                (body.material, body.world_from_object) = (Some(made_of), Transform::translate(center));
            } else {
                stage.solid(sphere([0.0; 3], scale), diffuse(1.0)).world_from_object = Transform::translate(center);
            }
            stage.light(crate::stage::light("distant").with("direction", [0.0, 0.0, 1.0]).with("radiance", white(1.0)));
            let eye = center + DVec3::new(0.0, 0.0, -4.0 * scale);
            // The half angle of view stays within the part that faces the light by more than 30°.
            stage.film(48, 48).look(eye.to_array(), center.to_array(), 15.0);
            let film = Shot::of("direct", 1).take(&stage.scene());
            let dark = film.pixels.iter().filter(|p| p.mean()[0] < 0.1).count();
            assert_eq!(dark, 0, "scale {scale}, {far} radii away, mesh: {mesh}");
        }
    }
}

//! Projectors against the parametrisations that they invert, and derivatives across seams.

use super::*;
use crate::Footprint;
use std::f32::consts::{PI, TAU};

fn at(p: Vec3) -> TextureContext<'static> {
    TextureContext::new(p, Vec2::ZERO)
}

fn by(projector: Projector) -> Mapping {
    Mapping { projector, ..Mapping::default() }
}

fn close(a: Vec2, b: Vec2) -> bool {
    (a - b).abs().max_element() < 2e-6
}

/// M206, E31: azimuths in [0, 1), polar angles of all directions, and places for the poles.
#[test]
fn spheres_and_cylinders_are_inverted() {
    for i in 0..24 {
        for j in 1..12 {
            let (u, v) = (i as f32 / 24.0, j as f32 / 12.0);
            let (s, c) = (u * TAU).sin_cos();
            let p = Vec3::new(c * (v * PI).sin(), s * (v * PI).sin(), (v * PI).cos()) * 2.5;
            assert!(close(by(Projector::Spherical).uv(&at(p)), Vec2::new(v, u)), "{u} {v}");
            let on_sphere = by(Projector::TwoPart(ObjectMap::Centroid, Intermediary::Sphere));
            assert!(close(on_sphere.uv(&at(p)), Vec2::new(u, v)));
            let p = Vec3::new(3.0 * c, 3.0 * s, 7.0 * v);
            assert!(close(by(Projector::Cylindrical).uv(&at(p)), Vec2::new(u, 7.0 * v)));
        }
    }
    // Directions so near the pole that the cosine z/r may exceed one by rounding, which has no arc cosine.
    for k in 0..2000 {
        let p = Vec3::new(1e-4 * (k as f32).sin(), 1e-4 * (k as f32).cos(), 0.1 + 1e-3 * k as f32);
        let v = by(Projector::Spherical).uv(&at(p)).x;
        assert!((0.0..4e-4).contains(&v), "{p}: {v}");
    }
    // Poles and the axis have a place, and the seam is at u = 0.
    assert_eq!(by(Projector::Spherical).uv(&at(Vec3::Z)), Vec2::ZERO);
    assert_eq!(by(Projector::Spherical).uv(&at(-Vec3::Z)), Vec2::X);
    assert!(by(Projector::Spherical).uv(&at(Vec3::ZERO)).is_finite());
    assert_eq!(by(Projector::Cylindrical).uv(&at(Vec3::new(1.0, -0.0, 0.0))), Vec2::ZERO);
    assert_eq!(by(Projector::Cylindrical).uv(&at(Vec3::new(1.0, -1e-30, 0.0))).x, 0.0);
}

#[test]
fn derivatives_do_not_see_seams() {
    // One step across the seam of azimuths is as long as any other.
    let (a, b) = (Vec3::new(5.0, -0.01, 0.2), Vec3::new(0.0, 0.02, 0.0));
    let footprint = Footprint { dpdx: b, dpdy: -b, ..Footprint::default() };
    let expected = (0.01_f32).atan2(5.0) * 2.0 / TAU;
    let cylinder = by(Projector::Cylindrical).coordinates(&TextureContext { footprint, ..at(a) });
    assert!((cylinder.dx.x - expected).abs() < 1e-6 && cylinder.uv.x > 0.99, "{cylinder:?}");
    let sphere = by(Projector::Spherical).coordinates(&TextureContext { footprint, ..at(a) });
    assert!((sphere.dx.y - expected).abs() < 1e-5, "{sphere:?}");
    // Nor do they see the edges of a cube.
    let edge = Vec3::new(1.0, 0.999, 0.1);
    let footprint = Footprint { dpdx: Vec3::new(-0.004, 0.004, 0.0), ..Footprint::default() };
    for projector in [Projector::Cube, Projector::TwoPart(ObjectMap::Centroid, Intermediary::Cube)] {
        let c = by(projector).coordinates(&TextureContext { footprint, ..at(edge) });
        assert!(c.dx.length() < 0.01 && c.dx.length() > 0.001, "{c:?}");
    }
}

#[test]
fn derivatives_of_affine_maps_are_exact() {
    let mapping = Mapping {
        projector: Projector::Planar(Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec2::new(0.5, 0.0)),
        scale: Vec2::new(4.0, 1.0),
        delta: Vec2::new(1.0, 2.0),
        matrix: [Vec2::new(0.0, 1.0), Vec2::new(-1.0, 0.0), Vec2::new(10.0, 20.0)],
        ..Mapping::default()
    };
    let footprint =
        Footprint { dpdx: Vec3::new(0.25, 0.0, 0.0), dpdy: Vec3::new(0.0, 0.5, 0.5), ..Footprint::default() };
    let c = mapping.coordinates(&TextureContext { footprint, ..at(Vec3::new(1.0, 2.0, 3.0)) });
    // (2.5, 5) → ×(4, 1) + (1, 2) = (11, 7) → (−7, 11) + (10, 20).
    assert_eq!((c.uv, c.dx, c.dy), (Vec2::new(3.0, 31.0), Vec2::new(0.0, 2.0), Vec2::new(-1.0, 0.0)));
    // The surface's own parameters take the footprint's.
    let footprint = Footprint { duvdx: Vec2::new(0.5, 0.25), ..Footprint::default() };
    let own =
        Mapping { projector: Projector::Uv, ..mapping }.coordinates(&TextureContext { footprint, ..at(Vec3::ZERO) });
    assert_eq!((own.dx, own.dy), (Vec2::new(-0.25, 2.0), Vec2::ZERO));
}

#[test]
fn triangles_are_mapped_corner_to_corner() {
    let x = [Vec3::new(1.0, 0.0, 2.0), Vec3::new(4.0, 1.0, 0.0), Vec3::new(0.0, 3.0, 1.0)];
    let uv = [Vec2::new(0.1, 0.2), Vec2::new(0.9, 0.3), Vec2::new(0.4, 0.8)];
    let map = by(Projector::triangle(x, uv).unwrap());
    for (x, uv) in x.into_iter().zip(uv) {
        assert!(close(map.uv(&at(x)), uv));
    }
    assert!(close(map.uv(&at((x[0] + x[1]) * 0.5)), (uv[0] + uv[1]) * 0.5));
    assert!(Projector::triangle([Vec3::ZERO, Vec3::X, Vec3::X * 2.0], uv).is_none());
}

#[test]
fn object_maps_by_hand() {
    let two = |o, s| by(Projector::TwoPart(o, s));
    // A point inside the sphere whose normal points along +y meets it straight above.
    let p = TextureContext { n: Vec3::Y, ..at(Vec3::new(0.6, 0.0, 0.0)) };
    let q = Vec3::new(0.6, 0.8, 0.0);
    assert!(close(two(ObjectMap::Normal, Intermediary::Sphere).uv(&p), Vec2::new(q.y.atan2(q.x) / TAU, 0.5)));
    // Seen along −y the same ray is the reflection; seen askew it goes the other way.
    let seen = TextureContext { wo: Vec3::Y, ..p };
    assert_eq!(
        two(ObjectMap::Reflection, Intermediary::Sphere).uv(&seen),
        two(ObjectMap::Normal, Intermediary::Sphere).uv(&p)
    );
    let askew = TextureContext { wo: Vec3::new(0.6, 0.8, 0.0), ..at(Vec3::ZERO) };
    let askew = TextureContext { n: Vec3::Y, ..askew };
    let u = (0.8_f32).atan2(-0.6) / TAU;
    assert!(close(two(ObjectMap::Reflection, Intermediary::Cylinder).uv(&askew), Vec2::new(u, 0.5)));
    // From the centre through the point.
    let p = at(Vec3::new(0.25, 0.25, 0.125));
    assert!(close(
        two(ObjectMap::Centroid, Intermediary::Cylinder).uv(&p),
        Vec2::new(0.125, 0.5 + 0.25 * 2.0_f32.sqrt() * 0.5)
    ));
    // Shrink-wrapping: heights stay, angles stay.
    assert!(close(two(ObjectMap::ProxyNormal, Intermediary::Cylinder).uv(&p), Vec2::new(0.125, 0.5625)));
    // The plane's normals are parallel: a slide projector.
    assert!(close(two(ObjectMap::ProxyNormal, Intermediary::Plane).uv(&p), Vec2::new(0.625, 0.625)));
    // +y is the second column's upper cell, and a face's middle its middle.
    let up = at(Vec3::new(0.0, 0.5, 0.0));
    assert!(close(two(ObjectMap::Centroid, Intermediary::Cube).uv(&up), Vec2::new(0.5, 0.25)));
    assert!(close(
        two(ObjectMap::ProxyNormal, Intermediary::Cube).uv(&at(Vec3::new(0.2, 0.5, 0.1))),
        Vec2::new(0.5 - 0.2 / 6.0, 0.25 + 0.1 / 4.0)
    ));
    assert!(close(
        two(ObjectMap::Centroid, Intermediary::Cube).uv(&at(Vec3::new(0.2, 0.5, 0.1))),
        Vec2::new(0.5 - 0.4 / 6.0, 0.25 + 0.2 / 4.0)
    ));
}

#[test]
fn faces_of_the_cube_are_seen_the_right_way_round() {
    // From outside, u to the right and v up: ∂p/∂u × ∂p/∂v points out.
    for d in [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z] {
        let map = by(Projector::Cube);
        let uv = |p: Vec3| map.uv(&at(p));
        let (a, b) = d.any_orthonormal_pair();
        let (du, dv) = ((uv(d + a * 0.1) - uv(d)), (uv(d + b * 0.1) - uv(d)));
        assert_eq!(uv(d), Vec2::splat(0.5));
        // (a, b, d) is right-handed, so (du, dv) keeps its orientation.
        assert!(a.cross(b).dot(d) * du.perp_dot(dv) > 0.0, "{d}");
    }
}

#[test]
fn nothing_gives_nan_for_finite_points() {
    let objects = [ObjectMap::Reflection, ObjectMap::Normal, ObjectMap::Centroid, ObjectMap::ProxyNormal];
    let surfaces = [Intermediary::Plane, Intermediary::Cylinder, Intermediary::Sphere, Intermediary::Cube];
    let points = [Vec3::ZERO, Vec3::X, -Vec3::Z, Vec3::splat(1e-30), Vec3::splat(-3e9), Vec3::new(0.0, 1.0, 1.0)];
    for o in objects {
        for s in surfaces {
            for p in points {
                for n in [Vec3::ZERO, Vec3::Z, -Vec3::X] {
                    let c = TextureContext { n, wo: Vec3::Z, ..at(p) };
                    assert!(by(Projector::TwoPart(o, s)).uv(&c).is_finite(), "{o:?} {s:?} {p} {n}");
                }
            }
        }
    }
}

#[test]
fn khr_texture_transform() {
    let m = Mapping::khr_texture_transform(Vec2::new(0.5, 0.25), std::f32::consts::FRAC_PI_2, Vec2::new(2.0, 3.0));
    let map = Mapping { matrix: m, ..Mapping::default() };
    // Scale first, a quarter turn from +u to −v next, offset last.
    for (uv, to) in
        [(Vec2::X, Vec2::new(0.5, -1.75)), (Vec2::Y, Vec2::new(3.5, 0.25)), (Vec2::ZERO, Vec2::new(0.5, 0.25))]
    {
        assert!(close(map.uv(&TextureContext::new(Vec3::ZERO, uv)), to));
    }
}

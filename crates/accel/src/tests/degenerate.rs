//! Whatever goes in: building and tracing end, and what can be hit is hit.

use super::{Mesh, assorted_rays, build, direction, in_cube, levels, soup};
use crate::{Bvh, Geometry};
use steradian_math::{Bounds3, Ray, Vec3, hash::HashRng};

/// Traces rays of all kinds on all levels, which must agree; gives the number of hits.
fn trace(bvh: &Bvh, size: f32) -> usize {
    let rays = assorted_rays(Vec3::ZERO, size, 400, 9);
    let levels: Vec<_> = levels().map(|isa| bvh.clone().with_isa(isa)).collect();
    let count = |ray: &&Ray| {
        let hits: Vec<_> = levels.iter().map(|bvh| bvh.intersect(ray, &()).map(|h| (h.t.to_bits(), h.id))).collect();
        assert!(hits.iter().all(|hit| *hit == hits[0]), "{ray:?} {hits:?}");
        assert!(levels.iter().all(|bvh| bvh.occluded(ray, &()) == hits[0].is_some()), "{ray:?}");
        hits[0].is_some()
    };
    rays.iter().filter(count).count()
}

#[test]
fn nothing_gives_no_hits() {
    for bvh in [Bvh::build(&[]), Bvh::build(&[Geometry::triangles(&[], &[]), Geometry::boxes(&[])])] {
        let bvh = bvh.expect("few primitives");
        assert!(bvh.bounds().is_empty());
        assert_eq!(trace(&bvh, 1.0), 0);
    }
}

#[test]
fn triangles_that_cannot_be_hit_are_left_out() {
    let (mut positions, mut indices): Mesh = soup(100, 0.3, 1);
    let clean = build(&(positions.clone(), indices.clone()));
    for (i, bad) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter().enumerate() {
        positions.push(Vec3::ZERO.with_x(bad));
        indices.push([0, 1, 300 + i as u32]);
    }
    indices.extend([[0, 1, 1], [2, 2, 2], [5, 4, 5], [0, 1, 303], [u32::MAX, 0, 1]]);
    let bvh = build(&(positions, indices));
    assert_eq!(bvh.bounds(), clean.bounds());
    for ray in assorted_rays(Vec3::ZERO, 1.0, 1000, 2) {
        assert_eq!(bvh.intersect(&ray, &()), clean.intersect(&ray, &()));
    }
}

#[test]
fn many_equal_triangles_neither_loop_nor_overflow_the_stack() {
    let positions = vec![Vec3::new(-1.0, -1.0, 0.1), Vec3::new(3.0, -1.0, 0.2), Vec3::new(-1.0, 3.0, -0.3)];
    let bvh = build(&(positions, vec![[0, 1, 2]; 100_000]));
    let hit = bvh.intersect(&Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z), &());
    assert_eq!(hit.map(|hit| hit.id.prim), Some(0), "the smallest index wins the tie");
    assert!(trace(&bvh, 1.0) > 50);
}

#[test]
fn sizes_that_shrink_by_halves_stay_within_the_depth() {
    // Each cut by bins parts one triangle from the rest: the deepest tree there is.
    let triangle = |i: i32| {
        let s = 2.0_f32.powi(-i);
        [Vec3::new(s, 0.0, 0.0), Vec3::new(0.0, s, 0.0), Vec3::new(0.0, 0.0, s)]
    };
    let positions: Vec<Vec3> = (-120..140).flat_map(triangle).collect();
    let bvh = build(&(positions, (0..260).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()));
    let ray = Ray::new(Vec3::splat(1e-30), Vec3::ONE);
    assert!(bvh.intersect(&ray, &()).is_some());
    assert!(trace(&bvh, 1.0) > 50);
}

#[test]
fn huge_tiny_flat_and_collinear_geometry_is_traced() {
    let mut rng = HashRng::new(4);
    let mut mesh = |scale: Vec3, len: usize| -> Mesh {
        let positions = (0..3 * len).map(|_| in_cube(&mut rng) * scale).collect();
        (positions, (0..len as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
    };
    let cases = [
        (mesh(Vec3::splat(f32::MAX), 500), f32::MAX / 4.0),
        (mesh(Vec3::splat(1e38), 500), 1e38),
        (mesh(Vec3::splat(1e30), 500), 1e30),
        (mesh(Vec3::splat(1e-20), 500), 1e-20),
        (mesh(Vec3::splat(1e-42), 500), 1e-42),
        (mesh(Vec3::new(1.0, 1.0, 0.0), 500), 1.0),
        (mesh(Vec3::new(1.0, 0.0, 0.0), 500), 1.0),
        (mesh(Vec3::new(1e30, 1e-30, 1.0), 500), 1.0),
    ];
    for (mesh, size) in &cases {
        trace(&build(mesh), *size);
    }
    // A flat mesh is hit from the side.
    let flat = build(&cases[5].0);
    let hits = (0..100).filter(|_| flat.occluded(&Ray::new(in_cube(&mut rng) * 0.5 + Vec3::Z * 2.0, Vec3::NEG_Z), &()));
    assert!(hits.count() > 90);
}

#[test]
fn boxes_that_are_not_boxes_are_left_out() {
    let nan = Vec3::splat(f32::NAN);
    let boxes = [
        Bounds3::EMPTY,
        Bounds3 { min: nan, max: nan },
        Bounds3 { min: Vec3::ONE, max: -Vec3::ONE },
        Bounds3 { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY },
    ];
    let bvh = Bvh::build(&[Geometry::boxes(&boxes)]).expect("few primitives");
    assert!(bvh.bounds().is_empty());
}

#[test]
fn rays_that_are_not_rays_hit_nothing() {
    let bvh = build(&soup(200, 0.5, 3));
    let mut rng = HashRng::new(8);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut o, mut d) = (in_cube(&mut rng), direction(&mut rng));
            o[axis] = bad;
            d[axis] = bad;
            for ray in [Ray::new(o, Vec3::X), Ray::new(Vec3::ZERO, d), Ray::new(o, d)] {
                assert!(bvh.intersect(&ray, &()).is_none() && !bvh.occluded(&ray, &()));
            }
        }
    }
    let still = Ray::new(Vec3::ZERO, Vec3::ZERO);
    assert!(bvh.intersect(&still, &()).is_none() && !bvh.occluded(&still, &()));
}

//! No ray slips through a closed mesh.

use super::{Mesh, build, direction, icosphere, in_cube, levels};
use steradian_math::{Ray, Vec3, hash::HashRng};

/// Shoots rays from within a closed mesh around `center`: at vertices, at points of edges, and anywhere.
fn assert_closed(mesh: &Mesh, center: Vec3, inner: f32, rays: usize, seed: u64) {
    let bvh = build(mesh);
    let levels: Vec<_> = levels().map(|isa| bvh.clone().with_isa(isa)).collect();
    let mut rng = HashRng::new(seed);
    for i in 0..rays {
        let origin = center + if i % 2 == 0 { in_cube(&mut rng) * inner } else { Vec3::ZERO };
        let [a, b, _] = mesh.1[(rng.next_u64() % mesh.1.len() as u64) as usize].map(|v| mesh.0[v as usize]);
        let target = match i % 5 {
            0 => a,
            1 => a + (b - a) * rng.next_f32(),
            2 => (a + b) * 0.5,
            _ => origin + direction(&mut rng),
        };
        let ray = Ray::new(origin, target - origin);
        let bvh = &levels[i % levels.len()];
        let hit = bvh.intersect(&ray, &());
        assert!(hit.is_some() && bvh.occluded(&ray, &()), "ray {i} escapes: {ray:?} {hit:?}");
    }
}

/// A cube of side 2 around the origin with a grid of `n × n` squares on each face: many coplanar triangles in flat
/// boxes.
fn cube(n: u32) -> Mesh {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for face in 0..6 {
        let first = positions.len() as u32;
        let side = if face < 3 { 1.0 } else { -1.0 };
        let at = |i: u32| 2.0 * i as f32 / n as f32 - 1.0;
        for i in 0..=n {
            positions.extend((0..=n).map(|j| match face % 3 {
                0 => Vec3::new(side, at(i), at(j)),
                1 => Vec3::new(at(j), side, at(i)),
                _ => Vec3::new(at(i), at(j), side),
            }));
        }
        for i in 0..n {
            for j in 0..n {
                let a = first + i * (n + 1) + j;
                indices.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
            }
        }
    }
    (positions, indices)
}

const FAR: Vec3 = Vec3::new(148_376.0, 1234.0, -223_423.0);

#[test]
fn a_sphere_is_closed() {
    assert_closed(&icosphere(5), Vec3::ZERO, 0.5, 300_000, 1);
}

#[test]
fn a_sphere_far_from_the_origin_is_closed() {
    // Vertices are rounded to 1/64; moved alike they stay shared.
    let mut mesh = icosphere(4);
    for p in &mut mesh.0 {
        *p = *p * 25.0 + FAR;
    }
    assert_closed(&mesh, FAR, 10.0, 200_000, 2);
}

#[test]
fn cubes_are_closed_at_any_size() {
    for (scale, seed) in [(1.0, 3), (1e-3, 4), (1e6, 5), (1e-12, 6)] {
        let mut mesh = cube(8);
        for p in &mut mesh.0 {
            *p *= scale;
        }
        assert_closed(&mesh, Vec3::ZERO, 0.9 * scale, 100_000, seed);
    }
}

#[test]
fn a_cube_far_from_the_origin_is_closed() {
    let mut mesh = cube(16);
    for p in &mut mesh.0 {
        *p = *p * 3.0 + FAR;
    }
    assert_closed(&mesh, FAR, 2.0, 200_000, 7);
}

#[test]
fn rays_along_axes_hit_the_seams_of_a_cube() {
    // Rays that run within the planes of boxes and through shared vertices: every number in the test is zero or exact.
    let bvh = build(&cube(8));
    for isa in levels() {
        let bvh = bvh.clone().with_isa(isa);
        for i in -8..=8 {
            for j in -8..=8 {
                let (a, b) = (i as f32 / 8.0, j as f32 / 8.0);
                for origin in [Vec3::new(-3.0, a, b), Vec3::new(a, -3.0, b), Vec3::new(a, b, -3.0)] {
                    let axis = (0..3).find(|&axis| origin[axis] == -3.0).unwrap_or(0);
                    for zero in [0.0, -0.0] {
                        let mut d = Vec3::splat(zero);
                        d[axis] = 1.0;
                        let hit = bvh.intersect(&Ray::new(origin, d), &());
                        assert!(hit.is_some(), "{origin} {d}");
                        // On the rim faces that are seen edge-on cannot be hit; elsewhere the face in front is.
                        assert_eq!(hit.map(|hit| hit.t), Some(2.0), "{origin} {d}");
                    }
                }
            }
        }
    }
}

/// Number of rays of a long run: `STERADIAN_RAYS`, or else `usual`.
fn rays_wanted(usual: usize) -> usize {
    std::env::var("STERADIAN_RAYS").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

/// Shoots rays from within a closed mesh in batches, on every processor: at corners, edges and anywhere.
fn assert_closed_for_batches(mesh: &Mesh, rays: usize) {
    use rayon::prelude::*;
    const BATCH: usize = 1 << 14;
    let bvh = build(mesh);
    (0..rays.div_ceil(BATCH) as u64).into_par_iter().for_each(|number| {
        let mut rng = HashRng::new(number);
        let mut ray = |i: usize| {
            let origin = in_cube(&mut rng) * 0.5;
            let [a, b, _] = mesh.1[(rng.next_u64() % mesh.1.len() as u64) as usize].map(|v| mesh.0[v as usize]);
            let target = match i % 4 {
                0 => a,
                1 => a + (b - a) * rng.next_f32(),
                2 => (a + b) * 0.5,
                _ => origin + direction(&mut rng),
            };
            Ray::new(origin, target - origin)
        };
        let rays: Vec<_> = (0..BATCH).map(&mut ray).collect();
        let (mut hits, mut occluded) = (vec![None; BATCH], vec![false; BATCH]);
        bvh.intersect_stream(&rays, &(), &mut hits);
        bvh.occluded_batch(&rays, &(), &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            assert!(hits[i].is_some() && occluded[i], "batch {number}, ray {i} escapes: {ray:?}");
        }
    });
}

#[test]
fn no_ray_of_many_escapes() {
    assert_closed_for_batches(&icosphere(4), 10_000_000);
}

/// A thousand million rays, or as many as `STERADIAN_RAYS` says: a quarter of an hour of a processor at least.
#[test]
#[ignore = "long: for nightly runs"]
fn no_ray_of_very_many_escapes() {
    let rays = rays_wanted(1_000_000_000);
    assert_closed_for_batches(&icosphere(6), rays / 2);
    assert_closed_for_batches(&cube(40), rays / 2);
}

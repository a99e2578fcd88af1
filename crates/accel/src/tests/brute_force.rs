//! The hierarchy finds what a look at every triangle finds.

use super::{Mesh, assorted_rays, build, direction, icosphere, in_cube, levels, soup};
use crate::Hit;
use steradian_math::ray::{gamma, offset_ray_origin};
use steradian_math::{DVec3, Ray, Vec3, hash::HashRng};

/// The nearest of the hits on every triangle alone, ties to the smaller index.
fn one_by_one(mesh: &Mesh) -> impl Fn(&Ray) -> Option<Hit> {
    let alone: Vec<_> = mesh.1.iter().map(|&triangle| build(&(mesh.0.clone(), vec![triangle]))).collect();
    move |ray| {
        let hits = alone.iter().enumerate().filter_map(|(prim, bvh)| {
            let mut hit = bvh.intersect(ray, &())?;
            hit.id.prim = prim as u32;
            Some(hit)
        });
        hits.min_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)))
    }
}

#[test]
fn nearest_hits_are_those_of_single_triangles() {
    // Big overlapping triangles, small sparse ones, and a mesh where every triangle is there twice, so that all hits
    // tie.
    let mut doubled = icosphere(2);
    doubled.1 = doubled.1.iter().flat_map(|&t| [t, t]).collect();
    for (mesh, seed) in [(soup(300, 0.7, 1), 1), (soup(700, 0.05, 2), 2), (doubled, 3)] {
        let expected = one_by_one(&mesh);
        let bvh = build(&mesh);
        let rays = assorted_rays(Vec3::ZERO, 1.2, 4000, seed);
        let mut hits = 0;
        for ray in &rays {
            let hit = expected(ray);
            hits += usize::from(hit.is_some());
            for isa in levels() {
                let bvh = bvh.clone().with_isa(isa);
                assert_eq!(bvh.intersect(ray, &()), hit, "{isa:?} {ray:?}");
                assert_eq!(bvh.occluded(ray, &()), hit.is_some(), "{isa:?} {ray:?}");
            }
        }
        assert!(hits > 150 && hits < rays.len(), "{hits} hits do not test much");
    }
}

/// Möller and Trumbore's test in `f64`: `t`, `u`, `v`.
fn precise(mesh: &Mesh, prim: usize, ray: &Ray) -> Option<[f64; 3]> {
    let [a, b, c] = mesh.1[prim].map(|i| mesh.0[i as usize].as_dvec3());
    let (o, d): (DVec3, DVec3) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    let (u, q) = ((o - a).dot(p) / det, (o - a).cross(e1));
    let (v, t) = (d.dot(q) / det, e2.dot(q) / det);
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < f64::from(ray.t_max);
    inside.then_some([t, u, v])
}

#[test]
fn hits_agree_with_another_test_in_double_precision() {
    let mesh = soup(400, 0.4, 5);
    let bvh = build(&mesh);
    let mut compared = 0;
    for ray in assorted_rays(Vec3::ZERO, 1.2, 4000, 6) {
        let all = (0..mesh.1.len()).filter_map(|prim| Some((prim, precise(&mesh, prim, &ray)?)));
        let nearest = all.min_by(|a, b| a.1[0].total_cmp(&b.1[0]));
        let hit = bvh.intersect(&ray, &());
        // Rounding may decide otherwise only at the rim of a triangle, or where two of them are at the same distance.
        let Some(((prim, [t, u, v]), hit)) = nearest.zip(hit) else {
            let lone = nearest.map(|(_, [_, u, v])| u.min(v).min(1.0 - u - v)).unwrap_or(0.0);
            assert!(lone < 1e-4, "{ray:?} {nearest:?} {hit:?}");
            continue;
        };
        assert!((f64::from(hit.t) - t).abs() < 1e-4 * t.max(1e-3), "{ray:?} {hit:?} {t}");
        if hit.id.prim as usize == prim {
            compared += 1;
            assert!(
                (f64::from(hit.u) - u).abs() < 2e-3 && (f64::from(hit.v) - v).abs() < 2e-3,
                "{ray:?} {hit:?} {u} {v}"
            );
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn the_interval_is_open_at_both_ends() {
    let mesh =
        (vec![Vec3::new(-1.0, -1.0, 2.0), Vec3::new(3.0, -1.0, 2.0), Vec3::new(-1.0, 3.0, 2.0)], vec![[0, 1, 2]]);
    let bvh = build(&mesh);
    let ray = |t_max| Ray { t_max, ..Ray::new(Vec3::ZERO, Vec3::Z) };
    assert_eq!(bvh.intersect(&ray(f32::INFINITY), &()).map(|hit| hit.t), Some(2.0));
    assert!(bvh.intersect(&ray(2.0), &()).is_none() && !bvh.occluded(&ray(2.0), &()));
    assert!(bvh.intersect(&ray(2.0_f32.next_up()), &()).is_some() && bvh.occluded(&ray(2.0_f32.next_up()), &()));
    let on_it = Ray::new(Vec3::new(0.0, 0.0, 2.0), Vec3::Z);
    assert!(bvh.intersect(&on_it, &()).is_none() && !bvh.occluded(&on_it, &()));
    for t_max in [0.0, -1.0, f32::NAN] {
        assert!(bvh.intersect(&ray(t_max), &()).is_none() && !bvh.occluded(&ray(t_max), &()));
    }
}

#[test]
fn rays_that_leave_a_triangle_do_not_meet_it_again() {
    let mut rng = HashRng::new(31);
    for i in 0..60_000 {
        let size = [1e-3, 1.0, 1e4][i % 3];
        let shape = if i % 4 < 2 { Vec3::ONE } else { Vec3::new(1.0, 0.01, 0.01) };
        let center = in_cube(&mut rng) * size * 3.0;
        let corners = [0; 3].map(|_| center + in_cube(&mut rng) * size * shape);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        if normal == Vec3::ZERO {
            continue;
        }
        let bvh = build(&(corners.to_vec(), vec![[0, 1, 2]]));
        // A point as rendering would find it: interpolated, and moved off the surface by the bound on its error.
        let (a, b) = (rng.next_f32(), rng.next_f32());
        let (u, v) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        let parts = [corners[0] * (1.0 - u - v), corners[1] * u, corners[2] * v];
        let error = (parts[0].abs() + parts[1].abs() + parts[2].abs()) * gamma(7);
        let d = direction(&mut rng);
        let d =
            if i % 2 == 0 { d } else { (d - normal * d.dot(normal) * [0.999, 0.999999, 1.0][i / 18 % 3]).normalize() };
        let origin = offset_ray_origin(parts[0] + parts[1] + parts[2], error, normal, d);
        let ray = Ray::new(origin, d * [1.0, 1e-4, 1e4][i / 3 % 3]);
        assert!(bvh.intersect(&ray, &()).is_none(), "{i}: {corners:?} {ray:?} {:?}", bvh.intersect(&ray, &()));
    }
}

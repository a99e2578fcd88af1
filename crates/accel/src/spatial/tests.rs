//! Every structure finds what the hierarchy finds, and what a look at every primitive finds.

use super::testing::{Mesh, assorted_rays, direction, icosphere, in_cube, soup};
use crate::{Accel, Accelerator, Geometry, Hit, Instance, Object, PrimId, UserHit, UserPrimitives};
use std::sync::Arc;
use steradian_math::{Bounds3, DVec3, Motion, Ray, Transform, Vec3, hash::HashRng};

fn build(accelerator: Accelerator, geometries: &[Geometry]) -> Accel {
    Accel::build(accelerator, geometries, Vec::new(), &[]).expect("few primitives")
}

fn over(mesh: &Mesh) -> [Geometry<'_>; 1] {
    [Geometry::triangles(&mesh.0, &mesh.1)]
}

fn bits(hit: Option<Hit>) -> Option<([u32; 3], PrimId)> {
    hit.map(|h| ([h.t, h.u, h.v].map(f32::to_bits), h.id))
}

/// Compares all structures with brute force and the hierarchy; gives the number of hits.
fn assert_equal<U: UserPrimitives>(geometries: &[Geometry], rays: &[Ray], user: &U) -> usize {
    let all = Accelerator::ALL.map(|a| (a, build(a, geometries)));
    let brute = &all[all.len() - 1].1;
    let mut hits = 0;
    for ray in rays {
        let expected = bits(brute.intersect(ray, user));
        hits += usize::from(expected.is_some());
        for (name, accel) in &all {
            assert_eq!(bits(accel.intersect(ray, user)), expected, "{name:?} {ray:?}");
            assert_eq!(accel.occluded(ray, user), expected.is_some(), "{name:?} {ray:?}");
        }
    }
    // Many at once.
    let expected: Vec<_> = rays.iter().map(|ray| brute.intersect(ray, user)).collect();
    for (name, accel) in &all[..5] {
        let (mut found, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
        accel.intersect_batch(rays, user, &mut found);
        accel.occluded_batch(rays, user, &mut any);
        let same = |(a, b): (&Option<Hit>, &Option<Hit>)| bits(*a) == bits(*b);
        assert!(found.iter().zip(&expected).all(same), "{name:?}");
        assert!(any.iter().zip(&expected).all(|(any, hit)| *any == hit.is_some()), "{name:?}");
    }
    hits
}

#[test]
fn all_structures_find_the_same_hits() {
    let mut doubled = icosphere(2);
    doubled.1 = doubled.1.iter().flat_map(|&t| [t, t]).collect();
    let mut flat = soup(300, 0.2, 3);
    flat.0.iter_mut().for_each(|p| p.y = 0.0);
    let long: Mesh = {
        let mut mesh = soup(400, 0.25, 4);
        mesh.0.iter_mut().for_each(|p| p.x *= 1000.0);
        mesh
    };
    for (mesh, seed, size) in
        [(soup(300, 0.7, 1), 1, 1.2), (soup(700, 0.05, 2), 2, 1.2), (doubled, 3, 1.2), (flat, 4, 1.2), (long, 5, 30.0)]
    {
        let mut rays = assorted_rays(Vec3::ZERO, size, 3000, seed);
        if seed == 4 {
            // Onto the sheet from above, and along it.
            let mut rng = HashRng::new(5);
            rays.extend((0..500).map(|_| Ray::new(in_cube(&mut rng), Vec3::new(0.0, -1.0, 0.0))));
        }
        if seed == 5 {
            // Between points among the long triangles.
            let (mut rng, size) = (HashRng::new(6), Vec3::new(1000.0, 1.0, 1.0));
            let mut point = || in_cube(&mut rng) * size * 1.2;
            rays.extend((0..2000).map(|_| (point(), point())).map(|(a, b)| Ray::new(a, b - a)));
        }
        let hits = assert_equal(&over(&mesh), &rays, &());
        assert!(hits > 100 && hits < rays.len(), "{hits} hits of mesh {seed} do not test much");
    }
}

#[test]
fn rays_from_far_away_find_the_same_hits() {
    let mesh = soup(500, 0.3, 6);
    let mut rng = HashRng::new(7);
    for distance in [30.0, 1e3, 1e5] {
        let mut ray = || {
            let origin = direction(&mut rng) * distance;
            Ray::new(origin, in_cube(&mut rng) - origin)
        };
        let rays: Vec<Ray> = (0..1500).map(|_| ray()).collect();
        let hits = assert_equal(&over(&mesh), &rays, &());
        assert!(hits > 300, "{hits} at {distance}");
    }
}

#[test]
fn seams_that_lie_in_the_planes_of_cells_are_closed() {
    // A cube of squares whose edges are where grids, octrees and medians like to put their planes.
    let n = 8;
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for face in 0..6 {
        let first = positions.len() as u32;
        for i in 0..=n {
            for j in 0..=n {
                let (a, b) = (i as f32 / n as f32 * 2.0 - 1.0, j as f32 / n as f32 * 2.0 - 1.0);
                let c = if face < 3 { 1.0 } else { -1.0 };
                positions.push([Vec3::new(a, b, c), Vec3::new(c, a, b), Vec3::new(b, c, a)][face % 3]);
            }
        }
        for i in 0..n {
            for j in 0..n {
                let a = first + i * (n + 1) + j;
                indices.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
            }
        }
    }
    let mesh = (positions, indices);
    let mut rng = HashRng::new(8);
    let on_lattice = |rng: &mut HashRng| (in_cube(rng) * 8.0).round() / 8.0;
    let mut rays = Vec::new();
    for i in 0..3000 {
        let origin = on_lattice(&mut rng) * 0.5;
        let target = on_lattice(&mut rng) * 2.0;
        let d = if i % 2 == 0 { Vec3::AXES[i / 2 % 3] } else { target - origin };
        if d != Vec3::ZERO {
            rays.push(Ray::new(origin, d));
        }
    }
    let hits = assert_equal(&over(&mesh), &rays, &());
    assert_eq!(hits, rays.len(), "rays from inside hit the cube");
}

/// Spheres as user primitives, and a filter that lets only even triangles count.
struct Mixed(Vec<(Vec3, f32)>);

impl UserPrimitives for Mixed {
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        let (center, radius) = self.0[id.prim as usize];
        let (o, d) = ((ray.origin - center).as_dvec3(), ray.direction.as_dvec3());
        let (a, b) = (d.dot(d), o.dot(d));
        let root = (b * b - a * (o.dot(o) - f64::from(radius * radius))).sqrt();
        let inside = |t: &f32| *t > 0.0 && *t < ray.t_max;
        let t = [(-b - root) / a, (-b + root) / a].map(|t| t as f32).into_iter().find(inside)?;
        Some(UserHit { t, u: 0.25, v: 0.75 })
    }

    fn accept(&self, hit: &Hit, _: &Ray) -> bool {
        hit.id.prim.is_multiple_of(2)
    }
}

#[test]
fn user_primitives_filters_and_instances_are_the_same() {
    let mut rng = HashRng::new(9);
    let spheres: Vec<_> = (0..80).map(|_| (in_cube(&mut rng), 0.01 + 0.1 * rng.next_f32())).collect();
    let boxes: Vec<_> = spheres.iter().map(|&(c, r)| Bounds3 { min: c - r * 1.001, max: c + r * 1.001 }).collect();
    let (mesh, masked) = (soup(200, 0.1, 10), soup(200, 0.2, 11));
    let geometries = [over(&mesh)[0], Geometry::boxes(&boxes), over(&masked)[0].filtered(true)];
    let user = Mixed(spheres);
    let rays = assorted_rays(Vec3::ZERO, 1.2, 3000, 12);
    assert!(assert_equal(&geometries, &rays, &user) > 400);

    let place = |_| {
        let scale = DVec3::new(0.3, 0.4, 0.5) * (0.5 + f64::from(rng.next_f32()));
        let turn = Transform::rotate_y(f64::from(rng.next_f32()) * 6.0) * Transform::scale(scale);
        let m = Transform::translate(in_cube(&mut rng).as_dvec3() * 3.0) * turn;
        let still = Instance::new(0, m.affine().expect("not singular"));
        // Some move, and turn by up to three quarters.
        let turn = Transform::rotate_y(f64::from(rng.next_f32()) * 4.5);
        let end = Transform::translate(in_cube(&mut rng).as_dvec3()) * m * turn * Transform::scale(scale + 0.5);
        let motion = (rng.next_f32() < 0.4).then(|| Motion::new([(-0.2, m), (0.9, end)]).expect("not singular"));
        Instance { motion: motion.map(Arc::new), ..still }
    };
    let instances: Vec<Instance> = (0..40).map(place).collect();
    let all = Accelerator::ALL.map(|a| {
        let object = Object::build(a, &geometries).expect("few primitives");
        (a, Accel::build(a, &geometries, vec![object], &instances).expect("valid"))
    });
    let expected = &all[0].1;
    let (mut instanced, mut moved) = (0, 0);
    let rays = assorted_rays(Vec3::ZERO, 3.0, 3000, 13).into_iter();
    let rays: Vec<Ray> = rays.map(|ray| Ray { time: rng.next_f32(), ..ray }).collect();
    let mut batch = vec![None; rays.len()];
    expected.intersect_batch(&rays, &user, &mut batch);
    for (ray, of_batch) in rays.into_iter().zip(batch) {
        let hit = bits(expected.intersect(&ray, &user));
        assert_eq!(bits(of_batch), hit, "{ray:?}");
        instanced += usize::from(hit.is_some_and(|h| h.1.instance < 40));
        moved +=
            usize::from(hit.is_some_and(|h| instances.get(h.1.instance as usize).is_some_and(|i| i.motion.is_some())));
        for (name, accel) in &all[1..] {
            assert_eq!(bits(accel.intersect(&ray, &user)), hit, "{name:?} {ray:?}");
            assert_eq!(accel.occluded(&ray, &user), hit.is_some(), "{name:?} {ray:?}");
        }
    }
    assert!(instanced > 300 && moved > 100, "{instanced} {moved}");
    let unknown = Accel::build(Accelerator::Grid, &geometries, Vec::new(), &instances);
    assert!(unknown.is_err());
}

#[test]
fn garbage_builds_and_traces() {
    let mut rng = HashRng::new(14);
    let nasty = [0.0, -0.0, 1.0, f32::NAN, f32::INFINITY, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, 1e30, -1e-30];
    for round in 0..60 {
        let any = |rng: &mut HashRng| match rng.next_u64() % 3 {
            0 => nasty[rng.next_u64() as usize % nasty.len()],
            1 => rng.next_f32() * 2.0 - 1.0,
            _ => (rng.next_f32() * 2.0 - 1.0) * 10.0_f32.powi(round % 30),
        };
        let point = |rng: &mut HashRng| Vec3::new(any(rng), any(rng), any(rng));
        let positions: Vec<Vec3> = (0..60).map(|_| point(&mut rng)).collect();
        let indices: Vec<[u32; 3]> = (0..50).map(|_| [0; 3].map(|_| (rng.next_u64() % 62) as u32)).collect();
        let boxes: Vec<Bounds3> = (0..10).map(|_| Bounds3 { min: point(&mut rng), max: point(&mut rng) }).collect();
        let geometries = [Geometry::triangles(&positions, &indices), Geometry::boxes(&boxes)];
        let all = Accelerator::ALL.map(|a| build(a, &geometries));
        let user = Mixed(vec![(Vec3::ZERO, 1.0); 10]);
        for _ in 0..60 {
            let ray = Ray { t_max: any(&mut rng), ..Ray::new(point(&mut rng), point(&mut rng)) };
            for accel in &all {
                let hit = accel.intersect(&ray, &user);
                assert!(hit.is_none_or(|h| h.t > 0.0 && h.t < ray.t_max), "{hit:?} {ray:?}");
                accel.occluded(&ray, &user);
            }
        }
    }
}

#[test]
fn empty_scenes_and_rays_that_are_none() {
    let nan = Ray::new(Vec3::NAN, Vec3::X);
    for accelerator in Accelerator::ALL {
        let accel = build(accelerator, &[]);
        assert!(accel.bounds().is_empty() && accel.intersect(&Ray::new(Vec3::ZERO, Vec3::X), &()).is_none());
        let mesh = icosphere(1);
        let accel = build(accelerator, &over(&mesh));
        for ray in [
            nan,
            Ray::new(Vec3::ZERO, Vec3::ZERO),
            Ray::new(Vec3::ZERO, Vec3::new(f32::INFINITY, 0.0, 0.0)),
            Ray { t_max: f32::NAN, ..Ray::new(Vec3::ZERO, Vec3::X) },
            Ray { t_max: -1.0, ..Ray::new(Vec3::ZERO, Vec3::X) },
        ] {
            assert!(accel.intersect(&ray, &()).is_none() && !accel.occluded(&ray, &()), "{accelerator:?} {ray:?}");
        }
        assert!(accel.occluded(&Ray::new(Vec3::ZERO, Vec3::X), &()));
        assert_eq!(Accelerator::by_name(accelerator.about().0), Some(accelerator));
        assert!(accel.bytes() > 0);
    }
}

#[test]
fn early_exit_and_structure_save_steps() {
    let mesh = icosphere(4);
    let rays = assorted_rays(Vec3::ZERO, 0.6, 500, 15);
    for accelerator in Accelerator::ALL {
        let accel = build(accelerator, &over(&mesh));
        let (mut closest, mut any) = (0, 0);
        for ray in &rays {
            let (steps, fewer) = (accel.intersect_cost(ray, &()), accel.occluded_cost(ray, &()));
            // The hierarchy looks for any hit in an order of its own.
            let is_fewer = fewer.tests <= steps.tests || accelerator.builder().is_some();
            assert!(steps.steps > 0 && is_fewer, "{accelerator:?} {ray:?}");
            closest += steps.tests;
            any += fewer.tests;
        }
        assert!(any < closest, "{accelerator:?}");
        let share = closest as f64 / (rays.len() * mesh.1.len()) as f64;
        assert!(accelerator == Accelerator::None || share < 0.02, "{accelerator:?} tests {share} of all");
    }
}

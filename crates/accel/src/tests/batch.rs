//! Batches give every ray what it gets alone.

use super::{assorted_rays, icosphere, in_cube, levels, soup};
use crate::{Bvh, Geometry, Hit, Instance, PrimId, TopLevel, UserHit, UserPrimitives};
use steradian_math::{Bounds3, DVec3, Ray, Transform, Vec3, hash::HashRng, transform::Affine};

/// Bits of a hit.
fn bits(hit: Option<Hit>) -> Option<([u32; 3], PrimId)> {
    hit.map(|h| ([h.t, h.u, h.v].map(f32::to_bits), h.id))
}

/// Compares a batch with single rays; gives how many hit.
fn same<U: UserPrimitives>(top: &TopLevel, rays: &[Ray], user: &U) -> usize {
    let mut hits = vec![None; rays.len()];
    let mut occluded = vec![false; rays.len()];
    let mut count = 0;
    for isa in levels() {
        let top = top.clone().with_isa(isa);
        hits.fill(None);
        occluded.fill(true);
        top.intersect_batch(rays, user, &mut hits);
        top.occluded_batch(rays, user, &mut occluded);
        for width in [4, 8, 16] {
            let top = top.clone().with_packet_width(width);
            let (mut narrow_hits, mut narrow_occluded) = (vec![None; rays.len()], vec![true; rays.len()]);
            top.intersect_batch(rays, user, &mut narrow_hits);
            top.occluded_batch(rays, user, &mut narrow_occluded);
            assert!(narrow_hits.iter().zip(&hits).all(|(a, b)| bits(*a) == bits(*b)), "{isa:?} {width}");
            assert_eq!(narrow_occluded, occluded, "{isa:?} {width}");
        }
        let (mut sorted_hits, mut sorted_occluded) = (vec![None; rays.len()], vec![true; rays.len()]);
        top.intersect_stream(rays, user, &mut sorted_hits);
        top.occluded_stream(rays, user, &mut sorted_occluded);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(bits(sorted_hits[i]), bits(hits[i]), "{isa:?} {i} {ray:?}");
            assert_eq!(sorted_occluded[i], occluded[i], "{isa:?} {i} {ray:?}");
            let alone = top.intersect(ray, user);
            assert_eq!(bits(hits[i]), bits(alone), "{isa:?} {i} {ray:?}");
            assert_eq!(occluded[i], top.occluded(ray, user), "{isa:?} {i} {ray:?}");
        }
        count = hits.iter().flatten().count();
    }
    count
}

/// Rays in small groups that stay together: from one point or from near ones, in cones of several widths.
fn bundles(count: usize, size: f32, seed: u64) -> Vec<Ray> {
    let mut rng = HashRng::new(seed);
    let mut rays = Vec::new();
    while rays.len() < count {
        let origin = in_cube(&mut rng) * size;
        let target = in_cube(&mut rng) * size * 0.5;
        let spread = [0.0, 0.003, 0.03, 0.3][rng.next_u64() as usize % 4] * size;
        let (from_one, bounded) = (rng.next_u64().is_multiple_of(2), rng.next_u64().is_multiple_of(3));
        for _ in 0..1 + rng.next_u64() % 40 {
            let start = if from_one { origin } else { origin + in_cube(&mut rng) * spread };
            let direction = target + in_cube(&mut rng) * spread - start;
            let t_max = if bounded { rng.next_f32() * 1.5 } else { f32::INFINITY };
            rays.push(Ray { t_max, ..Ray::new(start, direction) });
        }
    }
    rays
}

/// All kinds of rays, garbage among them.
fn rays(size: f32, seed: u64) -> Vec<Ray> {
    let mut rays = bundles(4000, size, seed);
    rays.extend(assorted_rays(Vec3::ZERO, size, 2003, seed));
    for (i, bad) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0, f32::MAX, 1e-45].into_iter().enumerate() {
        for axis in 0..3 {
            rays[91 * i + axis].origin[axis] = bad;
            rays[91 * i + axis + 3].direction[axis] = bad;
            rays[91 * i + axis + 6].t_max = bad;
        }
    }
    rays[7].direction = Vec3::ZERO;
    rays
}

fn placement(rng: &mut HashRng) -> Affine {
    let mut vector = |size: f64| in_cube(rng).as_dvec3() * size;
    let m = Transform::translate(vector(3.0)) * Transform::rotate(vector(1.0), 40.0 * vector(1.0).x);
    (m * Transform::scale(DVec3::new(0.7, -1.2, 1.0))).affine().expect("not singular")
}

#[test]
fn triangles() {
    // Doubled triangles tie.
    let mut doubled = icosphere(3);
    doubled.1 = doubled.1.iter().flat_map(|&t| [t, t]).collect();
    for (mesh, seed) in
        [(soup(3000, 0.1, 1), 1), (soup(50, 0.9, 2), 2), (doubled, 3), (soup(1, 0.9, 4), 4), (soup(0, 0.9, 4), 5)]
    {
        let geometry = [Geometry::triangles(&mesh.0, &mesh.1)];
        let top = TopLevel::build(&geometry, Vec::new(), &[]).expect("valid");
        let rays = rays(1.2, seed);
        let hits = same(&top, &rays, &());
        assert!(mesh.1.len() < 50 || hits > 1000, "{hits}");
        // A hierarchy alone answers alike, and so do short batches.
        let bvh = Bvh::build(&geometry).expect("few primitives");
        for len in [0, 1, 2, 5, 16, 17, 33] {
            let (mut alone, mut of_top, mut occluded) = (vec![None; len], vec![None; len], vec![false; len]);
            bvh.intersect_batch(&rays[300..300 + len], &(), &mut alone);
            top.intersect_batch(&rays[300..300 + len], &(), &mut of_top);
            bvh.occluded_batch(&rays[300..300 + len], &(), &mut occluded);
            assert_eq!(alone, of_top);
            assert!(alone.iter().zip(&occluded).all(|(hit, &occluded)| hit.is_some() == occluded));
        }
    }
}

/// Boxes that are hit where the ray enters them, and triangles that count by their index.
struct Mixed(Vec<Bounds3>);

impl UserPrimitives for Mixed {
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        let b = &self.0[id.prim as usize];
        let (low, high) = ((b.min - ray.origin) / ray.direction, (b.max - ray.origin) / ray.direction);
        let (enter, leave) = (low.min(high).max_element(), low.max(high).min_element());
        (enter <= leave && enter > 0.0 && enter < ray.t_max).then_some(UserHit { t: enter, u: 0.125, v: leave })
    }

    fn accept(&self, hit: &Hit, ray: &Ray) -> bool {
        assert!(hit.t > 0.0 && hit.t < ray.t_max);
        !(hit.id.prim + hit.id.geom).is_multiple_of(3)
    }
}

#[test]
fn instances_user_primitives_and_filters() {
    let mut rng = HashRng::new(8);
    let (mesh, sphere) = (soup(400, 0.2, 9), icosphere(2));
    let boxes = (0..200).map(|_| in_cube(&mut rng)).map(|c| Bounds3 { min: c - 0.05, max: c + 0.04 }).collect();
    let mixed = Mixed(boxes);
    let object = [
        Geometry::triangles(&sphere.0, &sphere.1).filtered(true),
        Geometry::boxes(&mixed.0),
        Geometry::triangles(&mesh.0, &mesh.1),
    ];
    let objects = vec![
        Bvh::build(&object).expect("few primitives"),
        Bvh::build(&[Geometry::triangles(&sphere.0, &sphere.1)]).expect("few primitives"),
    ];
    let mut places: Vec<_> = (0..30).map(|_| placement(&mut rng)).collect();
    // Instances at one place tie.
    places.extend_from_within(0..10);
    let instances: Vec<_> = places
        .iter()
        .enumerate()
        .map(|(i, &world_from_object)| Instance::new(u32::from(i % 10 >= 5), world_from_object))
        .collect();
    let world = [Geometry::triangles(&mesh.0, &mesh.1).filtered(true), Geometry::boxes(&mixed.0)];
    let top = TopLevel::build(&world, objects, &instances).expect("valid");
    let hits = same(&top, &rays(4.0, 10), &mixed);
    assert!(hits > 2000, "{hits}");
}

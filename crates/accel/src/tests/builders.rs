//! Differences between the builders, and invariants that all keep.

use super::{Mesh, assorted_rays, in_cube, soup};
use crate::{Accel, Accelerator, Builder, Bvh, Geometry, Hit, TopLevel};
use steradian_math::{Ray, Vec3, hash::HashRng};

fn built(builder: Builder, mesh: &Mesh) -> Bvh {
    Bvh::build_by(builder, &[Geometry::triangles(&mesh.0, &mesh.1)]).expect("few primitives")
}

/// Long thin triangles across each other: those that want to be cut.
fn needles(count: u32, seed: u64) -> Mesh {
    let mut rng = HashRng::new(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let (a, b) = (in_cube(&mut rng), in_cube(&mut rng));
        positions.extend([a, b, b + in_cube(&mut rng) * 0.01]);
    }
    (positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

#[test]
fn every_builder_gives_the_same_hits() {
    for (mesh, seed) in [(needles(3000, 51), 1), (soup(20_000, 0.03, 52), 2)] {
        let rays = assorted_rays(Vec3::ZERO, 1.2, 8000, seed);
        let all = Builder::ALL.map(|builder| built(builder, &mesh));
        let bits = |h: Option<Hit>| h.map(|h| ([h.t, h.u, h.v].map(f32::to_bits), h.id));
        let mut hits = 0;
        for ray in &rays {
            let expected = bits(all[0].intersect(ray, &()));
            hits += usize::from(expected.is_some());
            for (bvh, builder) in all.iter().zip(Builder::ALL) {
                assert_eq!(bits(bvh.intersect(ray, &())), expected, "{builder:?} {ray:?}");
                assert_eq!(bvh.occluded(ray, &()), expected.is_some(), "{builder:?} {ray:?}");
            }
        }
        assert!(hits > 1000, "{hits}");
        // A triangle in several leaves is one hit, in lists too.
        for ray in &rays[..1000] {
            let expected = all[0].all_hits(ray, &());
            assert!(all[1..].iter().all(|bvh| bvh.all_hits(ray, &()) == expected), "{ray:?}");
        }
    }
}

/// Steps and tests of rays through a mesh.
fn cost(builder: Builder, mesh: &Mesh, rays: &[Ray]) -> u64 {
    let geometry = [Geometry::triangles(&mesh.0, &mesh.1)];
    let accel = Accel::Bvh(TopLevel::build_by(builder, &geometry, Vec::new(), &[]).expect("few primitives"));
    rays.iter().map(|ray| accel.intersect_cost(ray, &()).steps).sum()
}

#[test]
fn what_takes_longer_to_build_saves_steps() {
    let rays = assorted_rays(Vec3::ZERO, 1.0, 4000, 3);
    let mesh = needles(4000, 53);
    let [sah, reinsertion, spatial, ploc] = Builder::ALL.map(|builder| cost(builder, &mesh, &rays) as f64);
    let found = format!("{reinsertion}, {spatial} and {ploc} steps instead of {sah}");
    assert!(reinsertion < sah && spatial < sah && ploc < 1.3 * sah, "{found}");
}

#[test]
fn a_triangle_far_away_costs_little() {
    let mesh = soup(6000, 0.03, 55);
    let rays = assorted_rays(Vec3::ZERO, 1.0, 1500, 5);
    let steps = |accelerator: Accelerator, (positions, indices): &Mesh| {
        let geometry = [Geometry::triangles(positions, indices)];
        let accel = Accel::build(accelerator, &geometry, Vec::new(), &[]).expect("few primitives");
        rays.iter().map(|ray| accel.intersect_cost(ray, &()).steps).sum::<u64>() as f64 / rays.len() as f64
    };
    // Quantised boxes have the steps of their parent's, and grids, octrees and trees of planes divide the extent of
    // all: beside a primitive far away they are coarse by their nature (docs/benchmarks.md tells users).
    for accelerator in &Accelerator::ALL[..7] {
        let alone = steps(*accelerator, &mesh);
        for size in [1e3, 1e6, 1e9, 1e15, 1e20, 1e30, 1e33] {
            // Below all, and to one side of all.
            for offset in [Vec3::ZERO, Vec3::new(3.0, 0.0, 2.0)] {
                let (mut positions, mut indices) = mesh.clone();
                let corners = [Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::new(0.0, 0.0, 1.0)];
                positions.extend(corners.map(|corner| (corner + offset) * size - Vec3::Y * 50.0));
                indices.push([18_000, 18_001, 18_002]);
                let found = steps(*accelerator, &(positions, indices));
                let name = accelerator.about().0;
                assert!(found < 1.5 * alone + 3.0, "{name}: {found} steps instead of {alone}, {size} {offset}");
            }
        }
    }
}

#[test]
fn chains_of_boxes_do_not_grow_too_deep() {
    // Each triangle is a little larger than the one before: clustering merges one after the other.
    let mut mesh: Mesh = (Vec::new(), Vec::new());
    for i in 0..600_u32 {
        let r = 1.1_f32.powi(i as i32 - 300);
        mesh.0.extend([Vec3::new(r, 0.0, 0.0), Vec3::new(0.0, r, 0.0), Vec3::new(0.0, 0.0, r)]);
        mesh.1.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let ray = Ray::new(Vec3::splat(1e-20), Vec3::splat(1.0));
    for builder in Builder::ALL {
        let bvh = built(builder, &mesh);
        assert_eq!(bvh.all_hits(&ray, &()).len(), 600, "{builder:?}");
        assert_eq!(bvh.intersect(&ray, &()).map(|hit| hit.id.prim), Some(0), "{builder:?}");
    }
}

#[test]
fn what_was_cut_can_move() {
    let mut mesh = needles(2000, 54);
    let mut bvh = built(Builder::Spatial, &mesh);
    mesh.0.iter_mut().for_each(|p| *p = Vec3::new(p.y * 2.0, p.z, p.x) + 1.0);
    let geometry = [Geometry::triangles(&mesh.0, &mesh.1)];
    assert_eq!(bvh.update(&geometry), Ok(true), "the shape is kept");
    let fresh = built(Builder::Sah, &mesh);
    for ray in assorted_rays(Vec3::ONE, 2.0, 3000, 4) {
        assert_eq!(bvh.intersect(&ray, &()), fresh.intersect(&ray, &()), "{ray:?}");
    }
}

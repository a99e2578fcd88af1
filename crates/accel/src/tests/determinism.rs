//! Determinism: equal input gives equal bits, for any number of threads and on any instruction set.

use super::{assorted_rays, build, levels, soup};
use crate::{Builder, Bvh, Geometry};
use steradian_math::Vec3;

fn built_by(threads: usize, builder: Builder, mesh: &super::Mesh) -> Bvh {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| Bvh::build_by(builder, &[Geometry::triangles(&mesh.0, &mesh.1)]).expect("few primitives"))
}

#[test]
fn the_number_of_threads_changes_nothing() {
    // Long enough that ranges are binned and cut by several threads; equal centres and signed zeros among the rest.
    let mut mesh = soup(60_000, 0.02, 11);
    for p in mesh.0.iter_mut().take(30_000) {
        *p = (*p * 8.0).round() / 8.0;
    }
    for builder in Builder::ALL {
        let one = built_by(1, builder, &mesh);
        for threads in [2, 7] {
            let many = built_by(threads, builder, &mesh);
            assert_eq!(one.bytes(), many.bytes());
            assert!(one.same_bits(&many), "{builder:?} with {threads} threads");
        }
    }
}

#[test]
fn every_level_gives_the_same_bits() {
    let bvh = build(&soup(20_000, 0.05, 12));
    let rays = assorted_rays(Vec3::ZERO, 1.5, 50_000, 13);
    let trace = |isa| {
        let bvh = bvh.clone().with_isa(isa);
        assert_eq!(bvh.isa(), isa);
        let bits = |ray| {
            let hit = bvh.intersect(ray, &()).map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.id));
            (hit, bvh.occluded(ray, &()))
        };
        rays.iter().map(bits).collect::<Vec<_>>()
    };
    let results: Vec<_> = levels().map(trace).collect();
    assert!(results[0].iter().filter(|(hit, _)| hit.is_some()).count() > 10_000);
    for other in &results[1..] {
        assert!(results[0] == *other);
    }
}

//! Sizes, compaction, deferred builds.

use crate::worlds::{in_cube, instances, ray, soup, two_geometries};
use std::sync::Arc;
use steradian_math::{Bounds3, Vec3, hash::HashRng};
use steradian_rt::{
    BottomLevel, BoxGeometry, BuildError, BuildOptions, BuildSizes, DeferredBuild, DeferredError, Geometries, Instance,
    Join, MAX_GEOMETRIES, MAX_PRIMITIVES, Preference, PrimitiveCounts, RayFlags, RayQuery, TopLevel, TriangleGeometry,
};

const SIZES: [usize; 5] = [0, 1, 2, 1000, 100_000];
const COMPACTED: BuildOptions =
    BuildOptions { allow_update: false, allow_compaction: true, preference: Preference::Balanced };

fn build(geometries: &[TriangleGeometry], options: BuildOptions) -> BottomLevel {
    BottomLevel::build(Geometries::Triangles(geometries), options).expect("valid")
}

#[test]
fn nothing_is_larger_than_said() {
    let mut rng = HashRng::new(30);
    for preference in [Preference::Balanced, Preference::FastTrace, Preference::FastBuild] {
        let options = BuildOptions { preference, ..COMPACTED };
        for count in SIZES {
            let corners = soup(&mut rng, count, 0.1);
            let said = BottomLevel::sizes(PrimitiveCounts::Triangles(&[count as u64]), options).expect("few");
            let level = build(&[TriangleGeometry::new(&corners)], options);
            assert!(level.bytes() as u64 <= said.structure, "{count} triangles: {} of {said:?}", level.bytes());
            let boxes: Vec<_> = corners.chunks(3).map(|c| Bounds3::from_points([c[0], c[1], c[2]])).collect();
            let said = BottomLevel::sizes(PrimitiveCounts::Boxes(&[count as u64]), options).expect("few");
            let built = BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&boxes)]), options).expect("valid");
            assert!(built.bytes() as u64 <= said.structure, "{count} boxes: {} of {said:?}", built.bytes());

            let placed = instances(&mut rng, &[Arc::new(level)], count);
            let said = TopLevel::sizes(count as u64, options).expect("few");
            let top = TopLevel::build(&placed, options).expect("valid");
            assert!(top.bytes() as u64 <= said.structure, "{count} instances: {} of {said:?}", top.bytes());
        }
    }
}

/// Triangles that each lie far outside of those before, so that splits take one at a time; and points at one place,
/// where a node of two children is as good as one of eight, so that what is said is all but reached.
#[test]
fn geometry_of_the_worst_kind_is_not_larger_than_said() {
    let points = [Bounds3 { min: Vec3::ONE, max: Vec3::ONE }; 900];
    for preference in [Preference::Balanced, Preference::FastTrace, Preference::FastBuild] {
        let options = BuildOptions { preference, ..COMPACTED };
        for growth in [1.1_f32, 1.5, 2.0, 3.0] {
            let size = |i| growth.powi(i % 40);
            let corners = (0..900).flat_map(|i| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| (p + i as f32) * size(i)));
            let corners: Vec<_> = corners.collect();
            let many: Vec<_> = corners.chunks(3).map(TriangleGeometry::new).collect();
            let said = BottomLevel::sizes(PrimitiveCounts::Triangles(&[1; 900]), options).expect("few");
            let level = build(&many, options);
            assert!(level.bytes() as u64 <= said.structure, "{} of {said:?}", level.bytes());
        }
        let said = BottomLevel::sizes(PrimitiveCounts::Boxes(&[900]), options).expect("few");
        let level = BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&points)]), options).expect("valid");
        let share = level.bytes() as f64 / said.structure as f64;
        assert!(share > 0.5 && share <= 1.0, "{share} of {said:?}");
    }
}

#[test]
fn sizes_of_too_much_are_errors() {
    let sizes = |counts: &[u64]| BottomLevel::sizes(PrimitiveCounts::Triangles(counts), COMPACTED).err();
    let too_many = |what, count, limit| Some(BuildError::TooMany { what, count, limit });
    assert_eq!(sizes(&[MAX_PRIMITIVES]), None);
    assert_eq!(sizes(&[MAX_PRIMITIVES, 1]), too_many("primitives", MAX_PRIMITIVES + 1, MAX_PRIMITIVES));
    assert_eq!(sizes(&[u64::MAX, u64::MAX]), too_many("primitives", u64::MAX, MAX_PRIMITIVES));
    let instances = TopLevel::sizes(MAX_GEOMETRIES + 1, COMPACTED).err();
    assert_eq!(instances, too_many("instances", MAX_GEOMETRIES + 1, MAX_GEOMETRIES));
    let BuildSizes { structure, build_scratch, update_scratch } = TopLevel::sizes(10, COMPACTED).expect("few");
    assert_eq!(update_scratch, 0);
    let update = TopLevel::sizes(10, BuildOptions { allow_update: true, ..COMPACTED }).expect("few");
    assert_eq!(update, BuildSizes { structure, build_scratch, update_scratch: structure + build_scratch });
}

#[test]
fn compacted_copies_have_the_same_hits_in_fewer_bytes() {
    let mut rng = HashRng::new(31);
    let mut saved = 0;
    for count in SIZES {
        let corners = soup(&mut rng, count, 0.3);
        let level = build(&[TriangleGeometry::new(&corners)], COMPACTED);
        let compacted = level.compacted().expect("allowed");
        assert_eq!(Ok(compacted.bytes()), level.compacted_bytes());
        assert!(compacted.bytes() <= level.bytes() && compacted.same_bits(&level));
        assert_eq!(compacted.compacted_bytes(), level.compacted_bytes());
        saved += level.bytes() - compacted.bytes();
        let placed = instances(&mut rng, &[Arc::new(level)], count.min(1000));
        let top = TopLevel::build(&placed, COMPACTED).expect("valid");
        let small = top.compacted().expect("allowed");
        assert_eq!(Ok(small.bytes()), top.compacted_bytes());
        assert!(small.bytes() <= top.bytes() && small.same_bits(&top));
        let compacted = Arc::new(compacted);
        let over_compacted: Vec<_> =
            { placed.into_iter() }.map(|instance| Instance { bottom_level: compacted.clone(), ..instance }).collect();
        let over_compacted = TopLevel::build(&over_compacted, COMPACTED).expect("valid");
        for _ in 0..300 {
            let ray = ray(&mut rng);
            let hits = [&top, &small, &over_compacted].map(|scene| hit(scene, ray));
            assert!(hits[0] == hits[1] && hits[0] == hits[2], "{hits:?}");
        }
    }
    assert!(saved > 1_000_000, "{saved} bytes");
    let plain = two_geometries(&mut rng, 3);
    assert_eq!(plain.compacted_bytes().err(), Some(BuildError::CompactionNotAllowed));
    assert_eq!(plain.compacted().err(), Some(BuildError::CompactionNotAllowed));
    let top = TopLevel::build(&[], BuildOptions::default()).expect("valid");
    assert_eq!(top.compacted().err(), Some(BuildError::CompactionNotAllowed));
    assert_eq!(top.compacted_bytes().err(), Some(BuildError::CompactionNotAllowed));
}

fn hit(scene: &TopLevel, ray: steradian_rt::RayDesc) -> Option<(u32, steradian_rt::PrimitiveId)> {
    let mut query = RayQuery::new(Some(scene), RayFlags::FORCE_OPAQUE, 0xff, ray).expect("legal");
    assert!(query.proceed().is_none());
    query.committed().map(|hit| (hit.t.to_bits(), hit.primitive.id()))
}

#[test]
fn deferred_builds_are_those_of_one_thread() {
    let mut rng = HashRng::new(32);
    let soups: Vec<_> = (0..12).map(|i| soup(&mut rng, [3, 40, 5000][i % 3], 0.2)).collect();
    let boxes = [0; 50].map(|_| Bounds3::from_points([in_cube(&mut rng), in_cube(&mut rng)]));
    let geometries: Vec<_> = soups.iter().map(|corners| TriangleGeometry::new(corners)).collect();
    let boxes = [BoxGeometry::new(&boxes), BoxGeometry::new(&boxes[..20])];
    let builds: Vec<_> = { geometries.chunks(2) }
        .zip([Preference::Balanced, Preference::FastTrace, Preference::FastBuild].into_iter().cycle())
        .map(|(some, preference)| (Geometries::Triangles(some), BuildOptions { preference, ..COMPACTED }))
        .chain([(Geometries::Boxes(&boxes), COMPACTED), (Geometries::Triangles(&[]), COMPACTED)])
        .collect();
    let expected: Vec<_> = { builds.iter() }.map(|(g, options)| BottomLevel::build(*g, *options)).collect();
    for threads in [1, 2, 3, 8] {
        let operation = DeferredBuild::new(builds.clone());
        // Two geometries can be read at once, or one structure be built that has none.
        assert_eq!(operation.max_concurrency(), 2 * 7 + 1);
        assert_eq!(operation.result().err(), Some(DeferredError::NotReady { unfinished: 8 }));
        let work = || loop {
            match operation.join() {
                Join::Idle => std::thread::yield_now(),
                told => return told,
            }
        };
        let told: Vec<Join> = std::thread::scope(|scope| {
            let all: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            all.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        assert!(told.contains(&Join::Done), "{told:?}");
        assert_eq!((operation.join(), operation.max_concurrency()), (Join::Done, 0));
        let built = operation.result().expect("complete");
        assert_eq!(built.len(), expected.len());
        for (built, expected) in built.iter().zip(&expected) {
            assert!(built.same_bits(expected.as_ref().expect("valid")));
        }
    }
}

#[test]
fn a_deferred_build_tells_what_is_wrong() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let (whole, half) = (TriangleGeometry::new(&corners[..3]), TriangleGeometry::new(&corners));
    let (good, bad) = ([whole, whole], [whole, half, half]);
    let builds = [&good[..], &bad, &bad].map(|all| (Geometries::Triangles(all), COMPACTED)).to_vec();
    let operation = DeferredBuild::new(builds);
    assert_eq!(operation.join(), Join::Done);
    let error = BuildError::IncompleteTriangle { geometry: 1, corners: 4 };
    assert_eq!(operation.result().err(), Some(DeferredError::Build { build: 1, error }));
    let none = DeferredBuild::new(Vec::new());
    assert_eq!((none.join(), none.result().map(|all| all.len())), (Join::Done, Ok(0)));
}

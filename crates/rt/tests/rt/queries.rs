//! Ray queries against the model: all flags, all masks.

use crate::model::{Crossing, crossings};
use crate::worlds::{ray, scene};
use steradian_math::{Vec3, hash::HashRng};
use steradian_rt::{HitKind, QueryCandidate, RayDesc, RayError, RayFlags, RayQuery, TopLevel};

/// Runs a query that asks `confirms` about candidates: the hit, and what it was asked about.
fn run(
    scene: &TopLevel,
    (ray, flags, mask): (RayDesc, RayFlags, u32),
    confirms: impl Fn(u32) -> bool,
) -> (Option<(f32, steradian_rt::PrimitiveId, HitKind)>, Vec<steradian_rt::PrimitiveId>) {
    let mut query = RayQuery::new(Some(scene), flags, mask, ray).expect("legal flags");
    let mut asked = Vec::new();
    while let Some(candidate) = query.proceed() {
        let QueryCandidate::Triangle(mut triangle) = candidate else { panic!("there are only triangles") };
        asked.push(triangle.primitive().id());
        if confirms(triangle.primitive().primitive_index()) {
            triangle.confirm();
        }
    }
    (query.committed().map(|hit| (hit.t, hit.primitive.id(), hit.kind)), asked)
}

/// Every third triangle lets rays through.
fn confirms(primitive: u32) -> bool {
    !primitive.is_multiple_of(3)
}

#[test]
fn all_flags_and_masks_give_the_hits_of_the_model() {
    let mut rng = HashRng::new(4);
    let (scene, instances) = scene(&mut rng);
    let (mut hits, mut refused) = (0, 0);
    for bits in (0..=0x3ff_u32).filter(|bits| bits & RayFlags::SKIP_CLOSEST_HIT_SHADER.bits() == 0) {
        let flags = RayFlags::from_bits(bits).expect("known");
        if flags.validated().is_err() {
            assert!(matches!(RayQuery::new(None, flags, 0, ray(&mut rng)), Err(RayError::Flags(_))));
            continue;
        }
        for mask in 0..=0x1ff_u32 {
            let ray = ray(&mut rng).with_extents(0.3 * rng.next_f32(), 0.5 + rng.next_f32());
            let all = crossings(&instances, &[true, false], (ray, flags, mask));
            let counts = |c: &&Crossing| c.is_opaque || confirms(c.id.primitive);
            let nearest = all.iter().find(counts);
            let (hit, asked) = run(&scene, (ray, flags, mask), confirms);
            if flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
                // Any one of those that count.
                assert_eq!(hit.is_some(), nearest.is_some());
                assert!(hit.is_none_or(|(t, id, _)| all.iter().filter(counts).any(|c| (c.t, c.id) == (t, id))));
            } else {
                assert_eq!(hit.map(|(t, id, _)| (t, id)), nearest.map(|c| (c.t, c.id)), "{flags} {ray:?}");
                assert_eq!(hit.map(|hit| hit.2 == HitKind::TRIANGLE_FRONT_FACE), nearest.map(|c| c.is_front));
                // It is asked about all non-opaque ones before the hit, from near to far, and about no other.
                let end = nearest.map_or(f32::INFINITY, |c| c.t);
                let expected = all.iter().filter(|c| !c.is_opaque && c.t <= end).map(|c| c.id);
                assert_eq!(asked, expected.collect::<Vec<_>>());
            }
            hits += usize::from(hit.is_some());
            refused += asked.iter().filter(|id| !confirms(id.primitive)).count();
        }
    }
    assert!(hits > 6000 && refused > 1500, "{hits} hits, {refused} refused");
}

#[test]
fn rays_that_break_rules_are_errors() {
    let error = |ray, flags| RayQuery::new(None, flags, 0xff, ray).err();
    let ray = RayDesc::new(Vec3::ZERO, Vec3::X);
    assert_eq!(error(ray, RayFlags::NONE), None);
    assert_eq!(error(ray, RayFlags::SKIP_CLOSEST_HIT_SHADER), Some(RayError::SkipClosestHitInQuery));
    assert_eq!(error(RayDesc::new(Vec3::NAN, Vec3::X), RayFlags::NONE), Some(RayError::NotANumber));
    assert_eq!(error(ray.with_extents(0.0, f32::NAN), RayFlags::NONE), Some(RayError::NotANumber));
    for (t_min, t_max) in [(-1.0, 1.0), (2.0, 1.0)] {
        let error = error(ray.with_extents(t_min, t_max), RayFlags::NONE);
        assert_eq!(error, Some(RayError::Extents { t_min, t_max }));
    }
}

#[test]
fn a_query_ends_when_it_is_told_to() {
    let mut rng = HashRng::new(5);
    let (scene, _) = scene(&mut rng);
    let mut ended = 0;
    for _ in 0..500 {
        let mut query = RayQuery::new(Some(&scene), RayFlags::FORCE_NON_OPAQUE, 0xff, ray(&mut rng)).expect("legal");
        let mut asked = 0;
        while let Some(QueryCandidate::Triangle(mut triangle)) = query.proceed() {
            asked += 1;
            if asked == 2 {
                triangle.confirm();
                triangle.confirm();
                triangle.terminate();
            }
        }
        assert!(asked <= 2);
        assert_eq!(query.committed().is_some(), asked == 2);
        ended += usize::from(asked == 2);
    }
    assert!(ended > 50);
}

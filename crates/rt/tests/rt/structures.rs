//! Structures: two levels are one, updates are rebuilds, and each broken rule has its error.

use crate::worlds::{in_cube, ray, scene, soup, transform};
use std::sync::Arc;
use steradian_math::{Bounds3, Vec3, hash::HashRng};
use steradian_rt::{
    BottomLevel, BoxGeometry, BuildError, BuildOptions, Geometries, GeometryFlags, Indices, Instance, InstanceFlags,
    Preference, RayFlags, RayQuery, TopLevel, Transform3x4, TriangleGeometry,
};

fn bottom(geometries: &[TriangleGeometry], options: BuildOptions) -> Result<BottomLevel, BuildError> {
    BottomLevel::build(Geometries::Triangles(geometries), options)
}

fn top(instances: &[Instance]) -> TopLevel {
    TopLevel::build(instances, BuildOptions::default()).expect("valid instances")
}

/// The nearest hit where all is opaque.
fn nearest(scene: &TopLevel, ray: steradian_rt::RayDesc) -> Option<(f32, steradian_rt::PrimitiveId)> {
    let mut query = RayQuery::new(Some(scene), RayFlags::FORCE_OPAQUE, 0xff, ray).expect("valid ray");
    assert!(query.proceed().is_none());
    query.committed().map(|hit| (hit.t, hit.primitive.id()))
}

#[test]
fn two_levels_are_the_flattened_scene() {
    let mut rng = HashRng::new(1);
    let (two_levels, instances) = scene(&mut rng);
    let flat: Vec<Vec<Vec3>> = instances
        .iter()
        .flat_map(|instance| (0..2).map(move |geometry| (instance, geometry)))
        .map(|(instance, geometry)| {
            let triangles = (0..).map_while(|i| instance.bottom_level.triangle(geometry, i));
            triangles.flatten().map(|corner| instance.transform.point(corner)).collect()
        })
        .collect();
    let geometries: Vec<_> = flat.iter().map(|vertices| TriangleGeometry::new(vertices)).collect();
    let flat = top(&[Instance::new(Arc::new(bottom(&geometries, BuildOptions::default()).expect("valid")))]);
    // Masks are not part of the flattened scene.
    let all: Vec<_> = instances.into_iter().map(|instance| instance.with_mask(0xff)).collect();
    let two_levels = {
        drop(two_levels);
        top(&all)
    };
    let (mut hits, mut apart) = (0, 0);
    for _ in 0..20_000 {
        let ray = ray(&mut rng);
        let (a, b) = (nearest(&two_levels, ray), nearest(&flat, ray));
        let same = match (a, b) {
            (Some((t, a)), Some((s, b))) => {
                hits += 1;
                (t - s).abs() <= 1e-4 * t && (2 * a.instance + a.geometry, a.primitive) == (b.geometry, b.primitive)
            }
            (a, b) => a.is_none() && b.is_none(),
        };
        apart += usize::from(!same);
    }
    // Vertices are rounded in another space: rays close to edges may differ.
    assert!(hits > 5000 && apart <= 5, "{hits} hits, {apart} apart");
}

#[test]
fn updates_and_preferences_change_no_hit() {
    let mut rng = HashRng::new(2);
    let mut vertices = soup(&mut rng, 200, 0.3);
    let options = |preference| BuildOptions { allow_update: true, preference, ..BuildOptions::default() };
    let mut updated = bottom(&[TriangleGeometry::new(&vertices)], options(Preference::Balanced)).expect("valid");
    for round in 0..3 {
        vertices.iter_mut().for_each(|v| *v += in_cube(&mut rng) * 0.2);
        let kept = updated.update(Geometries::Triangles(&[TriangleGeometry::new(&vertices)])).expect("only moved");
        assert!(kept);
        let same = |preference| {
            let fresh = bottom(&[TriangleGeometry::new(&vertices)], options(preference)).expect("valid");
            top(&[Instance::new(Arc::new(fresh))])
        };
        let updated = top(&[Instance::new(Arc::new(updated.clone()))]);
        let fresh = [Preference::Balanced, Preference::FastTrace, Preference::FastBuild].map(same);
        let mut rng = HashRng::new(10 + round);
        let hits = (0..2000).filter(|_| {
            let ray = ray(&mut rng);
            let hit = nearest(&updated, ray);
            fresh.iter().for_each(|fresh| assert_eq!(nearest(fresh, ray), hit));
            hit.is_some()
        });
        assert!(hits.count() > 300);
    }
}

#[test]
fn moved_instances_are_followed() {
    let mut rng = HashRng::new(3);
    let (_, mut instances) = scene(&mut rng);
    let mut updated =
        TopLevel::build(&instances, BuildOptions { allow_update: true, ..BuildOptions::default() }).expect("valid");
    instances.iter_mut().for_each(|instance| instance.transform = transform(&mut rng));
    instances.swap(0, 1);
    updated.update(&instances).expect("the same number");
    let fresh = top(&instances);
    for _ in 0..2000 {
        let ray = ray(&mut rng);
        assert_eq!(nearest(&updated, ray), nearest(&fresh, ray));
    }
    let fewer = updated.update(&instances[1..]).err();
    assert_eq!(fewer, Some(BuildError::UpdateCount { what: "instances", before: 7, now: 6 }));
}

#[test]
fn an_update_may_change_nothing_but_places() {
    let vertices = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let geometry = TriangleGeometry::indexed(&vertices, &[0, 1, 2]);
    let updatable = BuildOptions { allow_update: true, ..BuildOptions::default() };
    let mut level = bottom(&[geometry], updatable).expect("valid");
    let inactive = [Vec3::new(f32::NAN, 0.0, 0.0), Vec3::X, Vec3::Y, Vec3::Z];
    let changes = |what| Some(BuildError::UpdateChanges { what, geometry: 0 });
    let cases: [(TriangleGeometry, Option<BuildError>); 7] = [
        (geometry, None),
        (TriangleGeometry { vertices: &vertices[..3], ..geometry }, changes("the number of vertices")),
        (TriangleGeometry { indices: Indices::U16(&[0, 1, 2]), ..geometry }, changes("the format of the indices")),
        (TriangleGeometry { indices: Indices::U32(&[0, 1, 3]), ..geometry }, changes("the indices")),
        (geometry.with_transform(Transform3x4::IDENTITY), changes("whether there is a transform")),
        (geometry.with_flags(GeometryFlags::NONE), changes("the flags")),
        (
            TriangleGeometry { vertices: &inactive, ..geometry },
            Some(BuildError::UpdateActivity { geometry: 0, primitive: 0 }),
        ),
    ];
    for (geometry, error) in cases {
        assert_eq!(level.update(Geometries::Triangles(&[geometry])).err(), error);
    }
    let none = level.update(Geometries::Triangles(&[])).err();
    assert_eq!(none, Some(BuildError::UpdateCount { what: "geometries", before: 1, now: 0 }));
    assert_eq!(level.update(Geometries::Boxes(&[])).err(), changes("the kind"));
    let mut fixed = bottom(&[geometry], BuildOptions::default()).expect("valid");
    assert_eq!(fixed.update(Geometries::Triangles(&[geometry])).err(), Some(BuildError::UpdateNotAllowed));
}

#[test]
fn broken_rules_have_names_and_numbers() {
    let vertices = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let error = |geometry| bottom(&[geometry], BuildOptions::default()).err();
    let two = TriangleGeometry::new(&vertices[..2]);
    assert_eq!(error(two), Some(BuildError::IncompleteTriangle { geometry: 0, corners: 2 }));
    let beyond = TriangleGeometry::indexed(&vertices, &[0, 1, 2, 0, 1, 3]);
    let index = BuildError::VertexIndex { geometry: 0, triangle: 1, index: 3, vertices: 3 };
    assert_eq!(error(beyond), Some(index.clone()));
    assert_eq!(index.to_string(), "triangle 1 of geometry 0 names vertex 3, but there are only 3 vertices");
    let flat = TriangleGeometry::new(&vertices).with_transform(Transform3x4::scale(Vec3::new(1.0, 1.0, 0.0)));
    assert_eq!(error(flat), Some(BuildError::GeometryTransform { geometry: 0 }));

    let level = Arc::new(bottom(&[TriangleGeometry::new(&vertices)], BuildOptions::default()).expect("valid"));
    let error = |instance| TopLevel::build(&[Instance::new(level.clone()), instance], BuildOptions::default()).err();
    let instance = Instance::new(level.clone());
    assert_eq!(error(instance.clone()), None);
    let bits = |field, value| Some(BuildError::InstanceBits { instance: 1, field, value });
    assert_eq!(error(instance.clone().with_custom_index(1 << 24)), bits("custom index", 1 << 24));
    assert_eq!(error(instance.clone().with_hit_group_offset(1 << 24)), bits("hit-group offset", 1 << 24));
    let flags = InstanceFlags::FORCE_OPAQUE | InstanceFlags::FORCE_NON_OPAQUE;
    let exclusive = Some(BuildError::ExclusiveInstanceFlags { instance: 1, flags });
    assert_eq!(error(instance.clone().with_flags(flags)), exclusive);
    let nan = Transform3x4::translation(Vec3::new(f32::NAN, 0.0, 0.0));
    assert_eq!(error(instance.with_transform(nan)), Some(BuildError::InstanceTransform { instance: 1 }));
}

#[test]
fn inactive_and_degenerate_primitives_keep_their_numbers() {
    let mut vertices = vec![Vec3::ZERO; 3];
    vertices.extend([Vec3::new(f32::NAN, 0.0, 0.0), Vec3::X, Vec3::Y]);
    vertices.extend([Vec3::ZERO, Vec3::Y, Vec3::X]);
    let level = bottom(&[TriangleGeometry::new(&vertices)], BuildOptions::default()).expect("valid");
    let scene = top(&[Instance::new(Arc::new(level))]);
    let ray = steradian_rt::RayDesc::new(Vec3::new(0.2, 0.2, -1.0), Vec3::Z);
    assert_eq!(nearest(&scene, ray).map(|(t, id)| (t, id.primitive)), Some((1.0, 2)));
    let boxes = [
        Bounds3 { min: Vec3::NAN, max: Vec3::ONE },
        Bounds3 { min: Vec3::ONE, max: Vec3::ZERO },
        Bounds3::new(Vec3::ZERO, Vec3::ONE),
    ];
    let level = BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&boxes)]), BuildOptions::default());
    let scene = top(&[Instance::new(Arc::new(level.expect("valid")))]);
    let mut query = RayQuery::new(Some(&scene), RayFlags::NONE, 0xff, ray).expect("valid");
    let mut met = Vec::new();
    while let Some(candidate) = query.proceed() {
        if let steradian_rt::QueryCandidate::Procedural(candidate) = candidate {
            met.push(candidate.primitive().primitive_index());
        }
    }
    assert_eq!(met, [2]);
}

//! Which side of a triangle is its front.

use std::sync::Arc;
use steradian_math::Vec3;
use steradian_rt::{
    BottomLevel, BuildOptions, Geometries, HitKind, Instance, InstanceFlags, RayDesc, RayFlags, RayQuery, TopLevel,
    Transform3x4, TriangleGeometry,
};

/// Hit kind of a triangle that lies in z = 0, seen along +z.
fn seen(vertices: [Vec3; 3], geometry: Option<Transform3x4>, instance: Transform3x4, flags: InstanceFlags) -> HitKind {
    let geometry = TriangleGeometry { transform: geometry, ..TriangleGeometry::new(&vertices) };
    let level = BottomLevel::build(Geometries::Triangles(&[geometry]), BuildOptions::default()).expect("valid");
    let instance = Instance::new(Arc::new(level)).with_transform(instance).with_flags(flags);
    let scene = TopLevel::build(&[instance], BuildOptions::default()).expect("valid");
    // The two mirrors in x move the triangle to the other side.
    let hits = [-0.2, 0.2].map(|x| {
        let ray = RayDesc::new(Vec3::new(x, 0.2, -1.0), Vec3::Z);
        let kind = |flags| {
            let mut query = RayQuery::new(Some(&scene), flags, 0xff, ray).expect("valid");
            assert!(query.proceed().is_none());
            query.committed().map(|hit| hit.kind)
        };
        let all = kind(RayFlags::NONE);
        // Culling agrees with the kind of the hit.
        let is_front = |kind: &HitKind| *kind == HitKind::TRIANGLE_FRONT_FACE;
        assert_eq!(kind(RayFlags::CULL_BACK_FACING_TRIANGLES), all.filter(is_front));
        assert_eq!(kind(RayFlags::CULL_FRONT_FACING_TRIANGLES), all.filter(|kind| !is_front(kind)));
        all
    });
    hits.into_iter().flatten().next().expect("one of the rays hits")
}

#[test]
fn clockwise_in_left_handed_object_space_is_the_front() {
    // Left-handed: x to the right, y up, z away from the viewer. From below left up and to the right is clockwise.
    let clockwise = [Vec3::ZERO, Vec3::Y, Vec3::X];
    let counterclockwise = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let still = Transform3x4::IDENTITY;
    let (front, back) = (HitKind::TRIANGLE_FRONT_FACE, HitKind::TRIANGLE_BACK_FACE);
    let (none, flipped) = (InstanceFlags::NONE, InstanceFlags::TRIANGLE_FRONT_COUNTERCLOCKWISE);
    assert_eq!(seen(clockwise, None, still, none), front);
    assert_eq!(seen(counterclockwise, None, still, none), back);
    assert_eq!(seen(clockwise, None, still, flipped), back);
    // A mirror of the instance changes nothing; one of the geometry does; both together as that alone.
    let mirror = Transform3x4::scale(Vec3::new(-1.0, 1.0, 1.0));
    assert_eq!(seen(clockwise, None, mirror, none), front);
    assert_eq!(seen(counterclockwise, None, mirror, none), back);
    assert_eq!(seen(clockwise, Some(mirror), still, none), back);
    assert_eq!(seen(clockwise, Some(mirror), mirror, none), back);
    assert_eq!(seen(clockwise, Some(mirror), mirror, flipped), front);
}

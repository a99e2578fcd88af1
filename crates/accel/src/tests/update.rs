//! Updated structures answer like structures built from the moved geometry.

use super::{Mesh, assorted_rays, build, icosphere, in_cube, soup};
use crate::{Bvh, Geometry, Instance, TopLevel};
use steradian_math::{DVec3, Transform, Vec3, hash::HashRng};

/// Both find the same, ray by ray and in batches.
fn assert_same(a: &TopLevel, b: &TopLevel) -> usize {
    let rays = assorted_rays(Vec3::ZERO, 2.5, 6000, 41);
    let (mut together, mut hits) = (vec![None; rays.len()], 0);
    a.intersect_batch(&rays, &(), &mut together);
    for (ray, hit) in rays.iter().zip(together) {
        assert_eq!(hit, b.intersect(ray, &()), "{ray:?}");
        assert_eq!(a.intersect(ray, &()), hit, "{ray:?}");
        assert_eq!(a.occluded(ray, &()), hit.is_some(), "{ray:?}");
        hits += usize::from(hit.is_some());
    }
    hits
}

fn alone(bvh: Bvh) -> TopLevel {
    let still = Transform::translate(DVec3::ZERO).affine().expect("not singular");
    TopLevel::build(&[], vec![bvh], &[Instance::new(0, still)]).expect("valid")
}

#[test]
fn moved_meshes_are_followed() {
    let mut rng = HashRng::new(5);
    let mut mesh: Mesh = soup(3000, 0.1, 6);
    let mut bvh = build(&mesh);
    for size in [0.01, 0.3, 2.0] {
        for p in &mut mesh.0 {
            *p += in_cube(&mut rng) * size;
        }
        assert_eq!(bvh.update(&[Geometry::triangles(&mesh.0, &mesh.1)]), Ok(true));
        let fresh = build(&mesh);
        assert_eq!((bvh.bounds(), bvh.bytes()), (fresh.bounds(), bvh.bytes()));
        assert!(assert_same(&alone(bvh.clone()), &alone(fresh)) > 500);
    }
    // A triangle that cannot be hit any more, another number of them, and none.
    mesh.0[17] = Vec3::splat(f32::NAN);
    assert_eq!(bvh.update(&[Geometry::triangles(&mesh.0, &mesh.1)]), Ok(false));
    assert!(assert_same(&alone(bvh.clone()), &alone(build(&mesh))) > 500);
    mesh.1.truncate(700);
    assert_eq!(bvh.update(&[Geometry::triangles(&mesh.0, &mesh.1)]), Ok(false));
    assert!(assert_same(&alone(bvh.clone()), &alone(build(&mesh))) > 100);
    // One becomes whole while another breaks: the number is the same, the triangles are not.
    mesh.0[17] = Vec3::ZERO;
    mesh.0[23] = Vec3::INFINITY;
    assert_eq!(bvh.update(&[Geometry::triangles(&mesh.0, &mesh.1)]), Ok(false));
    assert!(assert_same(&alone(bvh.clone()), &alone(build(&mesh))) > 100);
    assert_eq!(bvh.update(&[]), Ok(false));
    assert!(bvh.bounds().is_empty());
}

#[test]
fn moved_instances_are_followed() {
    let mut rng = HashRng::new(7);
    let mut sphere = icosphere(2);
    let mesh = soup(200, 0.1, 8);
    let mut places = |count: usize| -> Vec<Instance> {
        let place = |_| {
            let m = Transform::translate(in_cube(&mut rng).as_dvec3() * 2.0) * Transform::scale(DVec3::splat(0.3));
            Instance::new(0, m.affine().expect("not singular"))
        };
        (0..count).map(place).collect()
    };
    let world = [Geometry::triangles(&mesh.0, &mesh.1)];
    let mut top = TopLevel::build(&world, vec![build(&sphere)], &places(50)).expect("valid");
    for (count, kept) in [(50, true), (50, true), (60, false)] {
        for p in &mut sphere.0 {
            *p *= 1.1;
        }
        let instances = places(count);
        let [object] = top.objects_mut() else { panic!("one object") };
        assert_eq!(object.update(&[Geometry::triangles(&sphere.0, &sphere.1)]), Ok(true));
        assert_eq!(top.update(&world, &instances), Ok(kept));
        let fresh = TopLevel::build(&world, vec![build(&sphere)], &instances).expect("valid");
        assert!(assert_same(&top, &fresh) > 1000);
    }
    let unknown = Instance { object: 1, ..places(1)[0].clone() };
    assert!(top.update(&world, &[unknown]).is_err());
}

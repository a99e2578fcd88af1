//! Instances are hit where a copy of their triangles would be.

use super::{Mesh, assorted_rays, build, icosphere, levels, soup};
use crate::{Bvh, Error, Geometry, Instance, TopLevel, WORLD};
use steradian_math::{DVec3, Ray, Transform, Vec3, hash::HashRng, transform::Affine};

/// Rotated, stretched and mirrored placements.
fn placements(count: usize) -> Vec<Affine> {
    let mut rng = HashRng::new(3);
    let mut number = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_f32());
    let mut placement = |_| {
        let mut vector = |low, high| DVec3::new(number(low, high), number(low, high), number(low, high));
        let m = Transform::translate(vector(-4.0, 4.0))
            * Transform::rotate(vector(-1.0, 1.0), vector(0.0, 6.0).x)
            * Transform::scale(vector(-1.5, 1.5));
        m.affine().expect("not singular")
    };
    (0..count).map(&mut placement).collect()
}

fn instance(object: u32, world_from_object: Affine) -> Instance {
    Instance::new(object, world_from_object)
}

#[test]
fn instances_are_hit_like_copies() {
    let objects: [Mesh; 2] = [icosphere(2), soup(200, 0.3, 5)];
    let places = placements(40);
    let instances: Vec<_> = places.iter().enumerate().map(|(i, m)| instance(i as u32 % 2, *m)).collect();
    let world = soup(100, 0.5, 6);
    let world_geometry = [Geometry::triangles(&world.0, &world.1)];
    let top = TopLevel::build(&world_geometry, objects.iter().map(build).collect(), &instances).expect("valid");

    let copies: Vec<Mesh> = instances
        .iter()
        .map(|i| {
            let (positions, indices) = &objects[i.object as usize];
            (positions.iter().map(|&p| i.world_from_object.point(p)).collect(), indices.clone())
        })
        .collect();
    let geometries: Vec<_> = copies.iter().chain([&world]).map(|mesh| Geometry::triangles(&mesh.0, &mesh.1)).collect();
    let flat = Bvh::build(&geometries).expect("few primitives");

    let rays = assorted_rays(Vec3::ZERO, 5.0, 20_000, 7);
    let tops: Vec<_> = levels().map(|isa| top.clone().with_isa(isa)).collect();
    let mut differ = 0;
    for (i, ray) in rays.iter().enumerate() {
        let (a, b) = (tops[i % tops.len()].intersect(ray, &()), flat.intersect(ray, &()));
        assert_eq!(top.occluded(ray, &()), a.is_some(), "{ray:?}");
        // Transformed rays round otherwise than transformed vertices; that shows at silhouettes only.
        let same = match (a, b) {
            (None, None) => true,
            (Some(a), Some(b)) => {
                let instance = if b.id.geom == 40 { WORLD } else { b.id.geom };
                (a.t - b.t).abs() < 1e-4 * b.t && (a.id.instance, a.id.prim) == (instance, b.id.prim)
            }
            _ => false,
        };
        differ += usize::from(!same);
    }
    assert!(differ < rays.len() / 1000, "{differ} of {} rays differ", rays.len());
}

#[test]
fn a_scene_without_instances_is_its_world() {
    let mesh = soup(500, 0.2, 1);
    let geometry = [Geometry::triangles(&mesh.0, &mesh.1)];
    let top = TopLevel::build(&geometry, Vec::new(), &[]).expect("valid");
    let bvh = build(&mesh);
    assert_eq!(top.bounds(), bvh.bounds());
    for ray in assorted_rays(Vec3::ZERO, 1.2, 2000, 2) {
        assert_eq!(top.intersect(&ray, &()), bvh.intersect(&ray, &()));
        assert_eq!(top.occluded(&ray, &()), bvh.occluded(&ray, &()));
    }
}

#[test]
fn ties_go_to_the_smaller_name() {
    // The same object at the same place, four times: the first instance wins, whatever the order of traversal.
    let objects = vec![build(&icosphere(1))];
    let instances = [0; 4].map(|object| instance(object, Affine::IDENTITY));
    let top = TopLevel::build(&[], objects, &instances).expect("valid");
    for ray in assorted_rays(Vec3::ZERO, 0.5, 500, 4) {
        if let Some(hit) = top.intersect(&ray, &()) {
            assert_eq!(hit.id.instance, 0);
        }
    }
}

#[test]
fn bad_instances_are_refused_or_left_out() {
    let top = TopLevel::build(&[], vec![build(&icosphere(0))], &[instance(1, Affine::IDENTITY)]);
    assert_eq!(top.err(), Some(Error::UnknownObject { instance: 0, object: 1, objects: 1 }));

    let mut broken = Affine::IDENTITY;
    broken.m.w_axis.x = f32::NAN;
    let mut collapsed = Affine::IDENTITY;
    collapsed.inv = Transform::IDENTITY.matrix.as_mat4() * f32::INFINITY;
    let instances = [instance(0, broken), instance(0, collapsed), instance(0, Affine::IDENTITY)];
    let top = TopLevel::build(&[], vec![build(&icosphere(0))], &instances).expect("valid");
    let hit = top.intersect(&Ray::new(Vec3::new(0.1, 0.2, 5.0), Vec3::NEG_Z), &());
    assert_eq!(hit.map(|hit| hit.id.instance), Some(2));

    let empty = Bvh::build(&[]).expect("few primitives");
    let top = TopLevel::build(&[], vec![empty], &[instance(0, Affine::IDENTITY)]).expect("valid");
    assert!(top.bounds().is_empty() && top.intersect(&Ray::new(Vec3::ZERO, Vec3::X), &()).is_none());
}

#[test]
fn instanced_spheres_stay_closed() {
    let places = placements(30);
    let instances: Vec<_> = places.iter().map(|m| instance(0, *m)).collect();
    let top = TopLevel::build(&[], vec![build(&icosphere(3))], &instances).expect("valid");
    let mut rng = HashRng::new(17);
    for i in 0..100_000 {
        let origin = places[i % places.len()].point(Vec3::ZERO);
        let ray = Ray::new(origin, super::direction(&mut rng));
        assert!(top.occluded(&ray, &()), "ray {i} escapes: {ray:?}");
    }
}

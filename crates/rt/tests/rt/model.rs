//! A model of the search, written from the tables of the specification: every triangle of every instance by itself.

use steradian_accel::{Bvh, Geometry};
use steradian_math::{Ray, Vec3};
use steradian_rt::{Instance, InstanceFlags, PrimitiveId, RayDesc, RayFlags};

/// A triangle that a ray passes through, whatever its flags.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub t: f32,
    pub id: PrimitiveId,
    pub is_front: bool,
    pub is_opaque: bool,
}

/// All crossings that count by flags, mask and interval, nearest first. `opaque` says which geometries are built so.
pub fn crossings(
    instances: &[Instance],
    opaque: &[bool],
    (ray, flags, mask): (RayDesc, RayFlags, u32),
) -> Vec<Crossing> {
    let mut all = Vec::new();
    for (index, instance) in instances.iter().enumerate() {
        if u32::from(instance.mask) & mask & 0xff == 0 || flags.contains(RayFlags::SKIP_TRIANGLES) {
            continue;
        }
        for geometry in 0..instance.bottom_level.geometry_count() as u32 {
            let mut primitive = 0;
            while let Some(corners) = instance.bottom_level.triangle(geometry, primitive) {
                let id = PrimitiveId { instance: index as u32, geometry, primitive };
                primitive += 1;
                let Some((t, is_front)) = cross(instance, corners, &ray) else { continue };
                let is_opaque = opacity(opaque[geometry as usize], instance.flags, flags);
                if t > ray.t_min && t < ray.t_max && counts(is_front, is_opaque, instance.flags, flags) {
                    all.push(Crossing { t, id, is_front, is_opaque });
                }
            }
        }
    }
    all.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
    all
}

/// Ray parameter of the intersection with a triangle, and true if its front is seen.
fn cross(instance: &Instance, corners: [Vec3; 3], ray: &RayDesc) -> Option<(f32, bool)> {
    let inverse = instance.transform.to_mat4().as_dmat4().inverse().as_mat4();
    let (origin, direction) = (inverse.transform_point3(ray.origin), inverse.transform_vector3(ray.direction));
    let alone = Bvh::build(&[Geometry::triangles(&corners, &[[0, 1, 2]])]).expect("one triangle");
    let hit = alone.intersect(&Ray::new(origin, direction), &())?;
    let [a, b, c] = corners;
    // In a left-handed system the cross product of two edges of a clockwise triangle points to the viewer.
    let is_clockwise = (b - a).cross(c - a).dot(direction) < 0.0;
    Some((hit.t, is_clockwise != instance.flags.contains(InstanceFlags::TRIANGLE_FRONT_COUNTERCLOCKWISE)))
}

/// True if a hit is opaque: the ray decides, else the instance, else the geometry.
pub fn opacity(geometry: bool, instance: InstanceFlags, ray: RayFlags) -> bool {
    if ray.contains(RayFlags::FORCE_OPAQUE) {
        true
    } else if ray.contains(RayFlags::FORCE_NON_OPAQUE) {
        false
    } else if instance.contains(InstanceFlags::FORCE_OPAQUE) {
        true
    } else if instance.contains(InstanceFlags::FORCE_NON_OPAQUE) {
        false
    } else {
        geometry
    }
}

/// True if no flag culls a hit.
fn counts(is_front: bool, is_opaque: bool, instance: InstanceFlags, ray: RayFlags) -> bool {
    let faces_matter = !instance.contains(InstanceFlags::TRIANGLE_CULL_DISABLE);
    let culled = [
        faces_matter && is_front && ray.contains(RayFlags::CULL_FRONT_FACING_TRIANGLES),
        faces_matter && !is_front && ray.contains(RayFlags::CULL_BACK_FACING_TRIANGLES),
        is_opaque && ray.contains(RayFlags::CULL_OPAQUE),
        !is_opaque && ray.contains(RayFlags::CULL_NON_OPAQUE),
    ];
    culled.into_iter().all(|culled| !culled)
}

//! Intersections of rays with single primitives of the draw list.

use crate::draw_list::Item;
use steradian_accel::{PrimId, WORLD};
use steradian_core::{
    Scene,
    scene::{Hit, Shape},
};
use steradian_math::{Ray, Vec3};

/// Treatment of rays that narrowly miss a triangle, as a hit on its border or as none: the pipeline rounds corners to
/// 1/256 pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Border {
    Included,
    Excluded,
}

/// The ray in the space of an item.
pub(crate) fn local(scene: &Scene, item: &Item, ray: &Ray) -> Ray {
    if item.instance == WORLD { *ray } else { item.place(scene).inverse().ray(ray) }
}

/// Intersection of a world-space ray with a part of an item: the nearest hit that counts, of the hit and the ray in the
/// space of the item. Triangles have one hit.
pub(crate) fn meet(
    scene: &Scene,
    item: &Item,
    part: u32,
    ray: &Ray,
    border: Border,
    counts: impl Fn(&Hit, &Ray) -> bool,
) -> Option<Hit> {
    let id = PrimId { instance: item.instance, geom: item.in_group, prim: part };
    let ray = local(scene, item, ray);
    let hit = |h: steradian_accel::UserHit| Hit { t: h.t, u: h.u, v: h.v, id };
    match &scene.geometries()[item.geometry as usize].shape {
        Shape::Mesh(mesh) => {
            let found = triangle(&ray, mesh.corners(part), border).map(|(t, u, v)| Hit { t, u, v, id });
            found.filter(|h| counts(h, &ray))
        }
        // The nearer of two roots may be masked away; then the farther one counts.
        Shape::Quadric(q) => {
            let first = q.intersect(&ray)?;
            if counts(&hit(first), &ray) {
                return Some(hit(first));
            }
            q.intersect_after(&ray, first.t).map(hit).filter(|h| counts(h, &ray))
        }
        Shape::Patches(m) => m.intersect(part, &ray).map(hit).filter(|h| counts(h, &ray)),
        Shape::Curves(c) => c.intersect(part, &ray).map(hit).filter(|h| counts(h, &ray)),
        Shape::Field(f) => f.intersect(part, &ray, |h| counts(&hit(*h), &ray)).map(hit),
        Shape::Sdf(s) => s.intersect(part, &ray, |h| counts(&hit(*h), &ray)).map(hit),
        Shape::Level(l) => l.intersect(&ray, |h| counts(&hit(*h), &ray)).map(hit),
        Shape::Plane(p) => {
            let t = p.intersect(&ray)?;
            // The plane's hits have its geometry for a number.
            let id = PrimId { geom: item.geometry, ..id };
            Some(Hit { t, u: 0.0, v: 0.0, id }).filter(|h| counts(h, &ray))
        }
    }
}

/// Distance and weights of the second and third corner (Möller, Trumbore 1997).
fn triangle(ray: &Ray, [a, b, c]: [Vec3; 3], border: Border) -> Option<(f32, f32, f32)> {
    // Cramer's rule for o + t d = a + u e1 + v e2.
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let det = e1.dot(p);
    let s = ray.origin - a;
    let q = s.cross(e1);
    let (u, v, t) = (s.dot(p) / det, ray.direction.dot(q) / det, e2.dot(q) / det);
    let is_within = |t: f32| t > 0.0 && t.is_finite() && t < ray.t_max;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && is_within(t);
    if inside {
        return Some((t, u, v));
    }
    if border == Border::Excluded {
        return None;
    }
    // The nearest weights; where the triangle is seen edge on, those of its middle.
    let clamp = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 1.0 / 3.0 };
    let (u, v) = (clamp(u), clamp(v));
    let (u, v) = if u + v > 1.0 { (u / (u + v), v / (u + v)) } else { (u, v) };
    // Distance of the closest point of the triangle, along the ray.
    let at = a + e1 * u + e2 * v;
    let t = (at - ray.origin).dot(ray.direction) / ray.direction.length_squared();
    is_within(t).then_some((t, u, v))
}
